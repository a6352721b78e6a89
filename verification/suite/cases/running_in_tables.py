# SPDX-License-Identifier: MIT
"""The tables of the running-in case: what was found, what the paper says of it, what decides it, and what it
cost.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from sam.scene import Result
from verification.compare.running_in_measures import History, Limits, Scar, Spread
from verification.reference.regime import Regime, regime
from verification.suite.cases.case import SmallTable
from verification.suite.cases.running_in_statements import EARLY, NAMES, JudgedStatement, Judgement

CUBIC, GIGA = 1e18, 1e-9
FIRST_CYCLES = 5  # of running-in; the later ones are steadier
Found = Mapping[tuple[str, int], History]
"""(name of a case, seed of its surface) -> its history."""


def of_case(found: Found, case: str) -> list[History]:
    """The histories of a case on all surfaces."""
    return [history for (name, _), history in found.items() if name == case]


def cases_of(found: Found) -> list[str]:
    """In the order of the paper."""
    return [case for case in NAMES if of_case(found, case)]


def cases_table(found: Found) -> SmallTable:
    """Median and range over the surfaces."""
    rows, last = [], 0
    for case in cases_of(found):
        histories = of_case(found, case)
        last = int(histories[0].cycle[-1])
        early = min(EARLY, last)

        def spread(column: str, cycle: int, scale: float, histories=histories) -> str:
            return Spread.of([scale * history.at(column, cycle) for history in histories]).text()

        rows.append(
            (
                NAMES[case],
                *(spread("volume", cycle, CUBIC) for cycle in (1, early, last)),
                *(spread("friction", cycle, 1.0) for cycle in (1, last)),
                *(spread("sa", cycle, 1e9) for cycle in (1, last)),
                spread("protected", last, 100.0),
                *(spread("p_max", cycle, GIGA) for cycle in (1, last)),
            )
        )
    columns = (
        *(
            "case",
            "V, first [µm³]",
            "V, early",
            "V, last",
            "μ, first",
            "μ, last",
            "Sa, first [nm]",
            "Sa, last",
        ),
        *("protected, last [%]", "p_max, first [GPa]", "p_max, last"),
    )
    return SmallTable(
        (f"Median and range over the surfaces; early: after {min(EARLY, last)} cycles, last: after {last}"),
        columns,
        rows,
    )


STATEMENT_COLUMNS = (
    *("Fig.", "statement of the paper", "measure", "median (range)", "asked", "surfaces", "verdict"),
    "what decides it",
)


def statements_table(
    judged: Sequence[JudgedStatement], limits: Mapping[str, tuple[Limits, Limits]], found: Found
) -> SmallTable:
    """Each statement with its verdict, and the regimes of the cases that it is about."""
    reached = {case: reached_at_first(found, case) for case in limits}
    rows = []
    for one in judged:
        statement = one.statement
        fates = [
            f"{NAMES[case]}: {fate(limits[case][0], reached[case])}"
            for case in statement.cases
            if case in limits
        ]
        asked = (
            one.spread.text(),
            statement.asked_in_words,
            (f"{one.agreeing} of {len(one.values)}"),
            str(one.judgement),
        )
        rows.append((statement.figure, statement.words, statement.measure, *asked, "; ".join(fates)))
    return SmallTable("What the paper says of Figs. 13–17, on surfaces of our own", STATEMENT_COLUMNS, rows)


def reached_at_first(found: Found, case: str) -> float:
    """Largest pressure in Pa in the first cycle, the median of the surfaces; NaN without any."""
    return Spread.of([history.at("p_max", 1) for history in of_case(found, case)]).median


def fate(limits: Limits, reached: float) -> str:
    """Of the spots with the largest pressure, in words."""
    if limits.removal <= limits.film:
        return "every spot whose film fails is removed, unless it is one of few cells"
    return {
        Regime.WHOLE: "no film fails",
        Regime.BARE: f"films fail, traction removes nothing ({GIGA * reached:.2f} "
        f"< {GIGA * limits.removal:.2f} GPa)",
        Regime.REMOVED: f"failed spots are removed above {GIGA * limits.removal:.2f} GPa only, films fail "
        f"from {GIGA * limits.film:.2f}",
    }[regime(reached, limits.film, limits.removal)]


def findings_note(judged: Sequence[JudgedStatement]) -> str:
    """How many statements came out how, and which not as the paper says."""
    counts = {kind: [one for one in judged if one.judgement is kind] for kind in Judgement}
    words = ", ".join(f"{len(ones)} {kind}" for kind, ones in counts.items())
    named = {
        kind: "; ".join(one.statement.words for one in counts[kind])
        for kind in (Judgement.FAILED, Judgement.OPEN)
    }
    text = f"Of {len(judged)} statements: {words} (held or failed: four surfaces of five agree)."
    text += f" Failed: {named[Judgement.FAILED]}." if named[Judgement.FAILED] else ""
    text += f" Not decided: {named[Judgement.OPEN]}." if named[Judgement.OPEN] else ""
    return (
        text
        + " The measured surface and the curves of the paper's Fig. 9 are not public: a failed statement is "
        "a finding."
    )


def regimes_table(
    limits: Mapping[str, tuple[Limits, Limits]], found: Found, held: Mapping[str, Sequence[tuple[int, int]]]
) -> SmallTable:
    """What decides: the pressures at which films fail and metal is removed, against the largest there is.
    held: see `held_of`.
    """
    rows = []
    for case, (own, other) in limits.items():
        reached = reached_at_first(found, case)
        numbers = (own.strength, own.removal, other.removal, own.first, own.removal_whole, own.film, reached)
        failed, above = (
            (sum(counts) for counts in zip(*held[case], strict=True)) if held.get(case) else (0, 0)
        )
        rows.append(
            (
                NAMES[case],
                *(f"{GIGA * number:.2f}" for number in numbers),
                f"{above} of {failed}",
                fate(own, reached),
            )
        )
    columns = (
        *(
            "case",
            "σ_y(limit) at the surface",
            "removed from, μ high",
            "with the other B",
            "in the first layer of cells",
        ),
        *(
            "removed from, μ low",
            "film fails from",
            "p_max, first cycle",
            "failed cells above it, last peak",
            "so",
        ),
    )
    return SmallTable(
        "What decides: pressures in GPa at which films fail and the traction removes metal", columns, rows
    )


def held_of(scar: Scar, limits: Limits, friction: tuple[float, float]) -> tuple[int, int]:
    """Cells with a failed film at the last peak, and those of them whose pressure removes a wide spot in the
    first layer.
    """
    failed = scar.unprotected(*friction)
    return int(failed.sum()), int((failed & (scar.p > limits.first)).sum())


HELD_NOTE = (
    "Failed cells that bear more than what removes them and yet hold are narrow spots, of a cell or two: "
    "√3 μ p is the stress at z = 0, the first layer of cells lies below it, where such a spot is held by its "
    "neighbours. Worn surfaces touch in many of these: there the criterion is one for wider spots, and the "
    "friction that remains is that of a grid of 1 µm."
)


def varied_table(varied: Mapping[str, tuple[Limits, History]]) -> SmallTable:
    """One surface, other assumptions."""
    rows = []
    for name, (limits, history) in varied.items():
        last = int(history.cycle[-1])
        cells = (
            f"{GIGA * limits.removal:.2f}",
            *(f"{CUBIC * history.volume_after(cycle):.4g}" for cycle in (1, min(EARLY, last), last)),
            *(f"{history.at('friction', cycle):.4f}" for cycle in (1, last)),
            f"{1e9 * history.at('sa', last):.1f}",
            f"{GIGA * history.at('p_max', last):.2f}",
        )
        rows.append((name, *cells))
    return SmallTable(
        "Other assumptions on the surface of the scenes",
        (
            *("run", "removed from [GPa]", "V(1) [µm³]", f"V({EARLY})", "V, last", "μ, first", "μ, last"),
            *("Sa, last [nm]", "p_max, last [GPa]"),
        ),
        rows,
    )


def cost_table(results: Mapping[str, Result]) -> SmallTable:
    """Of each solve, as it was when it was computed."""
    rows = []
    for name, result in results.items():
        cost, cycles = result.cost, len(result.tables["cycles"]["cycle"])
        applied = cost.get("operator_applications")
        rows.append(
            (
                name,
                str(result.status),
                f"{cycles}",
                *(_seconds(cost.get(key)) for key in ("solve_s", "cpu_s")),
                f"{(cost.get('peak_memory_bytes') or 0) / 2**20:.0f}",
                "–" if applied is None else f"{applied / max(1, cycles):.1f}",
                *(f"{np.mean(part):.1f}" if part else "–" for part in iterations_of(result)),
                f"{cost.get('step_cuts') or 0}",
            )
        )
    return SmallTable(
        "Cost of each run, on one core; memory: of the process so far",
        (
            *(
                "run",
                "status",
                "cycles",
                "time [s]",
                "CPU [s]",
                "memory [MiB]",
                "operator applications a cycle",
            ),
            *(f"plastic iterations a cycle, to the {FIRST_CYCLES}th", "later", "halved steps"),
        ),
        rows,
    )


def iterations_of(result: Result) -> tuple[list[float], list[float]]:
    """Plastic iterations of each cycle to the fifth (of a short run: of all but the last), and of those after
    it.
    """
    cycle, iterations = (
        np.asarray(result.tables["history"][name], dtype=float) for name in ("cycle", "iterations")
    )
    per_cycle = [float(iterations[cycle == k].sum()) for k in np.unique(cycle)]
    split = min(FIRST_CYCLES, len(per_cycle) - 1)
    return per_cycle[:split], per_cycle[split:]


def _seconds(value: float | None) -> str:
    return "–" if value is None else f"{value:.1f}"
