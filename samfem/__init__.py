# SPDX-License-Identifier: MIT
"""samfem from Python: a scene, solved by SAM and by finite elements; results as pandas tables and figures.

Quantities and tables are in SI units, with the unit in their name; a scene takes SI numbers or strings with
units.

Examples
--------
>>> import samfem
>>> scene = samfem.Scene(
...     body={"young": "210 GPa", "poisson": 0.3},
...     counterbody={"shape": "sphere", "radius": "105 um"},
...     loading={"force": 0.65},
... )
>>> run = samfem.solve(scene)
>>> run  # doctest: +NORMALIZE_WHITESPACE
<samfem.Run sam, converged: p_max 8.47 GPa, contact_radius 6.05 um, approach 0.349 um;
 model: mean pressure 1.7 % too low>
>>> round(run.quantities["p_max_Pa"] / 1e9, 2)
8.47
>>> run.tables["history"][["force_N", "p_max_Pa"]].shape
(1, 2)
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sam.scene import HeightMap, Scene, SceneError
    from samfem.python import (
        Comparison,
        Run,
        Sweep,
        compare,
        fit,
        load,
        plan,
        plot,
        read,
        solve,
        sweep,
        tensile,
    )
    from samfem.refusals import SeveralError
    from verification.cost.plan import Plan
    from verification.runs.files import FolderError
    from verification.runs.models import MODELS, ModelError

__all__ = [
    "MODELS",
    "Comparison",
    "FolderError",
    "HeightMap",
    "ModelError",
    "Plan",
    "Run",
    "Scene",
    "SceneError",
    "SeveralError",
    "Sweep",
    "__version__",
    "compare",
    "fit",
    "load",
    "plan",
    "plot",
    "read",
    "solve",
    "sweep",
    "tensile",
]


if TYPE_CHECKING:
    __version__: str
else:

    def __getattr__(name: str) -> Any:
        """A name of `__all__`, once it is asked for: the command loads only what it needs."""
        if name not in __all__:
            raise AttributeError(f"module 'samfem' has no attribute {name!r}")
        if name == "__version__":
            return import_module("importlib.metadata").version("samfem")
        module = import_module("samfem.python")  # first: it knows whether the packages are ours
        return getattr(import_module("verification.cost.plan") if name == "Plan" else module, name)


def __dir__() -> list[str]:
    return __all__
