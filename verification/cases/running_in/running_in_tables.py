# SPDX-License-Identifier: MIT
"""The tables of the running-in case: what was found, what the paper says of it, what decides it, and what it
cost.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from sam.scene import Result, Table
from verification.cases.case import SmallTable
from verification.cases.running_in.running_in_statements import (
    AGREED,
    EARLY,
    NAMES,
    JudgedStatement,
    Judgement,
)
from verification.compare.running_in_measures import History, Limits, Scar, Spread
from verification.reference.regime import Regime, regime

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


def cases_table(reading: str, found: Found) -> SmallTable:
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
        f"{reading.capitalize()}: median and range over the surfaces; early: after {min(EARLY, last)} "
        f"cycles, last: after {last}",
        columns,
        rows,
    )


def statements_table(readings: Mapping[str, Sequence[JudgedStatement]]) -> SmallTable:
    """Each statement with its verdicts. readings: name of a reading -> the statements, each in one order."""
    columns = ["Fig.", "statement of the paper", "measure", "asked"]
    for name in readings:
        columns += [f"{name}: median (range)", "holds on", "by the median", "by agreement"]
    rows = []
    for of_readings in zip(*readings.values(), strict=True):
        statement = of_readings[0].statement
        row = [statement.figure, statement.words, statement.measure, statement.asked_in_words]
        for one in of_readings:
            row += [one.spread.text(), _holds_on(one), _by_median(one), str(one.judgement)]
        rows.append(row)
    return SmallTable(
        "What the paper says of its Figures 13 to 17, on surfaces of our own. By the median: the distance of "
        "the median from the limit in interquartile ranges (IQR) of the surfaces; below 1, the surfaces "
        f"scatter by more. By agreement: of {AGREED:.0%} of the surfaces. None: surfaces without a value",
        columns,
        rows,
    )


def _holds_on(one: JudgedStatement) -> str:
    """None: a run is missing, or the measure says nothing."""
    silent = len(one.values) - one.spread.n
    return f"{one.agreeing} of {len(one.values)}" + (f", none on {silent}" if silent else "")


def _by_median(one: JudgedStatement) -> str:
    if one.by_median is Judgement.OPEN:
        return str(one.by_median)
    margin = one.margin
    return str(one.by_median) if np.isinf(margin) else f"{one.by_median} by {margin:.2g} IQR"


def reached_at_first(found: Found, case: str) -> float:
    """Largest pressure in Pa in the first cycle, the median of the surfaces; NaN without any."""
    return Spread.of([history.at("p_max", 1) for history in of_case(found, case)]).median


def fate(limits: Limits, reached: float) -> str:
    """Of the spots with the largest pressure, in words."""
    if np.isnan(reached):
        return "no run converged"
    if limits.removal <= limits.film:
        return "every spot whose film fails is removed, unless it is one of few cells"
    return {
        Regime.WHOLE: "no film fails",
        Regime.BARE: f"films fail, traction removes nothing ({GIGA * reached:.2f} "
        f"< {GIGA * limits.removal:.2f} GPa)",
        Regime.REMOVED: f"failed spots are removed above {GIGA * limits.removal:.2f} GPa only, films fail "
        f"from {GIGA * limits.film:.2f}",
    }[regime(reached, limits.film, limits.removal)]


def findings_note(reading: str, judged: Sequence[JudgedStatement]) -> str:
    """How many statements came out how, which not as the paper says, and which by less than the surfaces
    scatter.
    """
    verdicts = [one.by_median for one in judged], [one.judgement for one in judged]
    medians, agreement = (", ".join(f"{of.count(each)} {each}" for each in Judgement) for of in verdicts)
    named = {
        "Failed by the median": [one for one in judged if one.by_median is Judgement.FAILED],
        "Not decided by it": [one for one in judged if one.by_median is Judgement.OPEN],
        "Decided by less than the interquartile range": [one for one in judged if one.is_close],
    }
    text = f"{reading.capitalize()}: of {len(judged)} statements {medians} by the median of the surfaces; "
    text += f"{agreement} by agreement of {AGREED:.0%} of them."
    for words, ones in named.items():
        text += f" {words}: {'; '.join(one.statement.words for one in ones)}." if ones else ""
    return text


FINDINGS_NOTE = (
    "The measured surface and the curves of the paper's Fig. 9 are not public: a failed statement is a "
    "finding."
)


def new_strain_table(readings: Mapping[str, Mapping[str, Sequence[Table]]]) -> SmallTable:
    """What the last cycle adds. readings: name of a reading -> case -> the tables of cycles of its runs."""
    columns = ["case"]
    for name in readings:
        columns += [f"{name}: strain anew in", "at rest from cycle", "largest new strain [%]", "cells"]
        columns += ["worn [µm³]"]
    rows = []
    for case in (case for case in NAMES if any(found.get(case) for found in readings.values())):
        row = [NAMES[case]]
        for found in readings.values():
            row += _of_last_cycle(found.get(case, ()))
        rows.append(row)
    return SmallTable(
        "What the last cycle adds: surfaces on which any cell strains plastically again, of the others the "
        "first cycle from which on none does; median and range of the largest new strain, of the number of "
        "cells that yield and of the wear of that cycle",
        columns,
        rows,
    )


def _of_last_cycle(tables: Sequence[Table]) -> list[str]:
    strains, cells, worn = (
        [np.asarray(table[name], dtype=float) for table in tables]
        for name in ("new_strain_max", "yielding_cells", "wear_of_cycle_m3")
    )
    lasts = ((100.0, strains), (1.0, cells), (CUBIC, worn))
    return [
        f"{sum(each[-1] > 0.0 for each in strains)} of {len(strains)}",
        Spread.of([at_rest_from(each) for each in strains]).text(),
        *(Spread.of([scale * each[-1] for each in values]).text() for scale, values in lasts),
    ]


def at_rest_from(new_strain: np.ndarray) -> float:
    """The first cycle from which on no cell strains; NaN if the last one still does."""
    busy = np.flatnonzero(new_strain > 0.0)
    after = int(busy[-1]) + 1 if busy.size else 0
    return after + 1.0 if after < new_strain.size else float("nan")


REST_NOTE = (
    "With the printed inputs, a cycle that neither strains nor wears the body is followed by cycles like it "
    "(gate repeats); from which cycle on that is so is a finding, as nothing in the model bounds it."
)


def regimes_table(
    reading: str,
    limits: Mapping[str, tuple[Limits, Limits]],
    found: Found,
    held: Mapping[str, Sequence[tuple[int, int]]],
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
                *("–" if np.isnan(number) else f"{GIGA * number:.2f}" for number in numbers),
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
        f"What decides, {reading}: pressures in GPa at which films fail and the traction removes metal",
        columns,
        rows,
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


def cost_table(groups: Mapping[str, Sequence[Result]]) -> SmallTable:
    """Of the solves of each group, as they were when they were computed; median and range."""
    rows = []
    for name, results in groups.items():
        parts = [iterations_of(result) for result in results]
        applied = [_a_cycle(result, "operator_applications") for result in results]
        rows.append(
            (
                name,
                f"{sum(result.converged for result in results)} of {len(results)}",
                Spread.of([_a_cycle(result, "solve_s") for result in results]).text(),
                Spread.of([_cost(result, "cpu_s") for result in results]).text(),
                Spread.of([_cost(result, "peak_memory_bytes") / 2**20 for result in results]).text(),
                Spread.of(applied).text(),
                *(Spread.of([_mean(part[k]) for part in parts]).text() for k in (0, 1)),
                Spread.of([_cost(result, "step_cuts") for result in results]).text(),
            )
        )
    return SmallTable(
        "Cost on one core, median and range of the runs; memory: of the process so far",
        (
            *("runs", "converged", "time of a cycle [s]", "CPU [s]", "memory [MiB]"),
            "operator applications a cycle",
            *(f"plastic iterations a cycle, to the {FIRST_CYCLES}th", "later", "halved steps"),
        ),
        rows,
    )


def _cost(result: Result, name: str) -> float:
    return float(result.cost.get(name) or 0.0)


def _a_cycle(result: Result, name: str) -> float:
    cycles = len(result.tables["cycles"]["cycle"])
    return _cost(result, name) / cycles if cycles else float("nan")


def _mean(values: Sequence[float]) -> float:
    return float(np.mean(values)) if len(values) else float("nan")


def lost_height_note(scars: Mapping[str, Scar]) -> str:
    """How much of the relief is worn away where most is. scars: by name of the run, at least one."""
    depths = {name: float(np.nanmax(scar.worn)) for name, scar in scars.items()}
    lost = {name: depth / float(np.ptp(scars[name].height)) for name, depth in depths.items()}
    most = max(lost, key=lambda name: lost[name])
    half, whole = (sum(share > limit for share in lost.values()) for limit in (0.5, 1.0))
    return (
        f"Worn depth over relief (highest less lowest place before any wear): above a half in {half} of "
        f"{len(lost)} runs, above one in {whole}; the most is {lost[most]:.2f}, {1e6 * depths[most]:.3g} of "
        f"{1e6 * np.ptp(scars[most].height):.3g} µm ({most})."
        + " How far the flat surface of the model is off below such scars is not known."
        * (half > 0)
    )


def lost_note(lost: Mapping[str, Result]) -> str:
    """The runs that did not converge, by name, with their status."""
    words = "; ".join(
        f"{name}: {result.status} after {len(result.tables['cycles']['cycle'])} cycles"
        for name, result in lost.items()
    )
    return f"Not converged, and counted as surfaces on which a statement says nothing: {words}."


def deepened_note(depths: Mapping[str, float]) -> str:
    """The runs with more layers than their scene, by name, and their depths in m."""
    words = "; ".join(f"{name}, to {depth * 1e6:g} µm" for name, depth in depths.items())
    return f"The plastic zone reached the last layer, and the run was made again with deeper ones: {words}."


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
