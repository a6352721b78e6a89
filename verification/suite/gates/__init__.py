# SPDX-License-Identifier: MIT
"""The gates: what each case must reach, one file a family of cases, and how a measured value is held against
them.

`<family>.toml` holds a block `[[gate]]` for each value: `id` (led by the name of the case), `case`,
`quantity`, `metric`, `tolerance` and `reason`. Tolerances are set by the discretisation of the case's scene,
for the reason beside them; a gate that fails is a finding, not a reason for a wider tolerance. A block with
`cases`, a list, instead of `case` is one gate for each of them, its id led by the name of the case. The
metrics are listed in `verification.suite.judging`, which reads and judges them.

Used by the harness, which judges what the cases measure, and by the lists of the command line. A new family
is a new file and its name in `FAMILIES`.
"""

from verification.suite.judging import (
    FAMILIES,
    LIMITS,
    Gate,
    GateStatus,
    Measured,
    Verdict,
    error_of,
    evaluate,
    judge,
    load_gates,
)

__all__ = [
    "FAMILIES",
    "LIMITS",
    "Gate",
    "GateStatus",
    "Measured",
    "Verdict",
    "error_of",
    "evaluate",
    "judge",
    "load_gates",
]
