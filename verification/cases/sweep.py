# SPDX-License-Identifier: MIT
"""Sweeps: the scene of a case solved at points over named axes, a frame with a row for each run, and what the
rows of the case take of its columns.

A frame has the columns sweep, model ("sam/fem" for what is between both), an axis each, h (size of what is
refined), the columns of the file with `NAME value` and `NAME expected` beside each, scene and
result. The function that a case names as `frame` returns such rows as mappings.
"""

import operator
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from itertools import product
from numbers import Real
from typing import Any

import numpy as np

from sam.scene import Result, Scene
from verification.cases.case import Context, DataFrame, SmallTable
from verification.cases.recipes import beside, changed
from verification.compare.comparison import compare_scene
from verification.judging import Measured, error_of
from verification.quantities import QUANTITIES, Quantity, Reference, Solved
from verification.reference.convergence import Power, extrapolate, fit_power
from verification.references import REFERENCES, hertz_sphere
from verification.rows import CaseFile, Claim, SweepFile, Take
from verification.runs.models import FEM, FEM_3D, FEM_LINE, SAM
from verification.text.console import number

MODELS = {"sam": SAM, "fem": FEM, "fem-3d": FEM_3D, FEM_LINE: FEM_LINE}
BOTH = "sam/fem"
MOST = 60
"""Lines of a table for the page."""
SIGNS = {"<": operator.lt, ">": operator.gt}
ERRORS = {
    "value": "",
    "between": ", SAM against FEM",
    "relative": ", relative error",
    "absolute": ", error",
    "relative_l2": ", relative error in L2",
}
LABELS = {
    "sam": "SAM",
    "fem": "FEM",
    "fem-3d": "FEM, 3D",
    FEM_LINE: "FEM, plane strain",
    "swift": "Swift's law",
    "linear": "linear hardening",
    "perfect": "perfect plasticity",
    "prager": "one back-stress (Prager)",
    "chaboche": "three back-stresses (Chaboche)",
    "friction": "μ = {}",
    "loading.steps": "{} load steps",
}
"""What every figure says of a value, or of the values of an axis."""
UNITS = {"%": 1e2, "nm": 1e9, "µm": 1e6, "µm²": 1e12, "µm³": 1e18, "GPa": 1e-9}
"""Unit at the end of a label -> factor of a column in SI."""


def points(sweep: SweepFile, level: str) -> Iterator[tuple[dict[str, Any], dict[str, Any]]]:
    """Of each point: axis -> its value or the name of it, and key of the scene or recipe -> value."""
    axes = sweep.axes | (sweep.quick if level == "quick" else {})
    values = [
        each.items() if isinstance(each, dict) else [(value, {axis: value}) for value in each]
        for axis, each in axes.items()
    ]
    for chosen in product(*values):
        changes = {key: value for _, own in chosen for key, value in own.items()}
        yield dict(zip(axes, (name for name, _ in chosen), strict=True)), changes


def framed(context: Context, file: CaseFile, base: Scene | None) -> DataFrame:
    """All sweeps of a case, solved; or what its module returns."""
    import pandas as pd

    if file.frame:
        rows = beside(file, file.frame, {})(context)
        return pd.DataFrame([{"sweep": "", "model": "", **row} for row in rows])
    return pd.DataFrame([row for name in file.sweeps for row in _runs(context, file, name, base)])


def _runs(context: Context, file: CaseFile, name: str, base: Scene) -> Iterator[dict[str, Any]]:
    """The rows of one sweep: a row a run, and one for what is between both models."""
    sweep = file.sweeps[name]
    every = list(points(sweep, context.level))
    varied = [axis for axis in every[0][0] if len({spelt(where[axis]) for where, _ in every}) > 1]
    between = [column for column, how in sweep.columns.items() if how == "between"]
    for where, changes in every:
        scene = changed(base, changes, file)
        reference = beside(file, file.reference, REFERENCES)(scene) if file.reference else None
        row, results, runs = {"sweep": name, **where, "scene": scene}, {}, []
        for model in sweep.models:
            led = [model] if len(file.sweeps) == 1 or name == model else [model, name]
            label = "-".join([*led, *(spelt(where[axis]) for axis in varied)])
            result = results[model] = context.solve(MODELS[model], scene, label)
            size = size_of(sweep, scene, result, reference)
            own = row | {"model": model, "result": result, "h": size}
            for column, how in sweep.columns.items():
                if how == "between":
                    continue
                of = beside(file, column, QUANTITIES)
                named = isinstance(of, Quantity)
                found = of.against(column, result, reference) if named else of(scene, result, reference)
                found = found if isinstance(found, Measured) else Measured(found)
                own[column] = found.value if how == "value" else error_of(how, found)
                own[f"{column} expected"] = found.expected
                if np.ndim(found.value) == 0:
                    own[f"{column} value"] = found.value
            runs.append(own)
        if between and all(result.converged for result in results.values()):
            runs.append(row | {"model": BOTH} | between_models(scene, *results.values(), names=between))
            for column in between:
                pair = runs[-1][f"{column} pair"]
                if pair and np.ndim(pair.value) == 0:
                    runs[0][column], runs[1][column] = pair.value, pair.expected
        yield from runs


def differences(solved: Solved) -> dict[str, float]:
    """Row of `compare` -> difference of both models."""
    pair = solved.results["sam"], solved.results["fem"]
    return {row.quantity: row.error for row in compare_scene(solved.scene, *pair)}


def between_models(scene: Scene, sam: Result, fem: Result, *, names: list[str]) -> dict[str, Any]:
    """The differences of both models: relative, or as the row of `compare` says; NAME pair: their values."""
    rows, values = differences(Solved(scene, None, {"sam": sam, "fem": fem})), {}
    for name in names:
        between = QUANTITIES[name].between
        measured = values[f"{name} pair"] = between(scene, sam, fem) if between else None
        if measured is None:
            values[name] = rows[QUANTITIES[name].row]
        else:
            metric = "relative_l2" if np.ndim(measured.value) else "relative"
            values[name] = error_of("at_most" if measured.expected is None else metric, measured)
    return values


def size_of(sweep: SweepFile, scene: Scene, result: Result, reference: Reference | None) -> float:
    """Size of a cell or element over the radius of the contact, or of a load step over the load."""
    if sweep.size != "cell":
        return 1.0 / scene.loading.steps
    if result.model != SAM:
        return 1.0 / scene.fem.cells_per_radius
    return result.discretisation["cell_m"][0] / (reference or hertz_sphere(scene)).units["a"]


def spelt(value: Any) -> str:
    """A value of an axis in labels, conditions and tables."""
    if isinstance(value, str):
        return value
    return "-".join(map(spelt, value)) if isinstance(value, (list, tuple)) else f"{value:g}"


def _single(rows: DataFrame, column: str) -> Measured:
    """The value at one point, with what is expected there."""
    if len(rows) != 1:
        raise ValueError(f"{column}: {len(rows)} points where one is meant")
    value, expected = rows.get(f"{column} value", rows[column]), rows.get(f"{column} expected")
    unit = QUANTITIES[column].unit if column in QUANTITIES and f"{column} value" in rows else ""
    return Measured(value.iloc[0], None if expected is None else expected.iloc[0], unit=unit)


STATISTICS: Mapping[str, Callable[[DataFrame, str], float | Measured]] = {
    "value": _single,
    "pair": lambda rows, column: _single(rows, f"{column} pair").value,
    "order": lambda rows, column: fit_power(rows["h"], rows[column]).exponent,
    "limit": lambda rows, column: extrapolate(rows["h"], rows[column]).limit,
    "largest": lambda rows, column: float(np.max(rows[column].to_numpy())),
    "first": lambda rows, column: rows[column].iloc[0],
    "last": lambda rows, column: rows[column].iloc[-1],
    "ratio": lambda rows, column: rows[column].iloc[0] / rows[column].iloc[-1],
    "mean": lambda rows, column: rows[column].mean(),
    "median": lambda rows, column: rows[column].median(),
    "total": lambda rows, column: float(rows[column].sum()),
}
"""Word of a row -> what it takes of a column. pair: the value of SAM beside that of FEM; order, limit: under
refinement; ratio: first over last; nan where one is missing; mean, median, total: of the values that there
are.
"""


def selected(file: CaseFile, frame: DataFrame, take: Take) -> DataFrame:
    """The rows of the frame that a take is about, of the sweeps that have its column."""
    rows = frame[frame[take.column].notna().groupby(frame["sweep"]).transform("any")]
    if file.sweeps:
        hows = [file.sweeps[name].columns.get(take.column) for name in frame["sweep"]]
        both = [
            (how == "between") == (model == BOTH) for how, model in zip(hows, frame["model"], strict=True)
        ]
        rows = frame[[how is not None and own for how, own in zip(hows, both, strict=True)]]
    for name in take.of:
        rows = rows[(rows[["sweep", "model"]] == name).any(axis=1)]
    for axis, sign, value in take.at:
        if sign == "=":
            rows = rows[[spelt(each) == value for each in rows[axis]]]
        else:
            rows = rows[SIGNS[sign](rows[axis].astype(float), float(value))]
    return rows


def evaluated(file: CaseFile, frame: DataFrame, take: Take) -> Measured:
    """What a take says, with what is expected where the frame has it."""
    if take.number is not None:
        return Measured(take.number)
    found = beside(file, take.statistic, STATISTICS)(selected(file, frame, take), take.column)
    return found if isinstance(found, Measured) else Measured(found)


def taken(file: CaseFile, frame: DataFrame, claim: Claim) -> Measured:
    """The value of a row that takes of the sweeps."""
    found, *against = (evaluated(file, frame, take) for take in claim.take)
    alone = claim.row.metric in ("at_most", "at_least")
    return replace(found, expected=None if alone else against[0].value if against else found.expected)


def words_of(file: CaseFile, column: str) -> str:
    """A column for the reader: of the vocabulary, or what its function says of itself."""
    of = beside(file, column, QUANTITIES)
    said = of.words if isinstance(of, Quantity) else of.__doc__.strip().splitlines()[0].rstrip(".")
    return said[0].lower() + said[1:]


def label_of(file: CaseFile, name: str, value: Any = None) -> str:
    """A column for the reader of a figure, or a value of an axis."""
    labels = LABELS | file.labels
    if value is not None:
        return labels.get(spelt(value), labels.get(name, "{}").format(spelt(value)))
    known = any(name in sweep.columns for sweep in file.sweeps.values())
    return labels.get(name) or (words_of(file, name) if known else re.sub("[._-]", " ", name))


def tables_of(file: CaseFile, frame: DataFrame) -> Iterator[SmallTable]:
    """A table for each sweep: a line a run, observed orders in the last; none of a map, which is drawn."""
    for name, rows in frame.groupby("sweep", sort=False):
        if len(rows) > MOST:
            continue
        axes, shown = [], {c: c.replace("-", " ") for c in rows if c not in ("sweep", "model")}
        if sweep := file.sweeps.get(name):
            axes = [axis for axis in sweep.axes if len(set(map(spelt, rows[axis]))) > 1]
            shown = {column: words_of(file, column) + ERRORS[how] for column, how in sweep.columns.items()}
            values = [column for column, how in sweep.columns.items() if how == "value"]
            units = {column: QUANTITIES[column].unit for column in values if column in QUANTITIES}
            shown |= {column: f"{shown[column]} [{unit}]" for column, unit in units.items() if unit}
            shown |= {f"{column} expected": f"{shown[column]}, expected" for column in values}
        known = {c: rows[c].dropna() for c in shown if c in rows}
        shown = {c: shown[c] for c, own in known.items() if len(own) and isinstance(own.iloc[0], str | Real)}
        if not (sweep or any(known[column].any() for column in shown)):  # of zeros only, the gates tell
            continue
        modelled = ["model"] * any(rows["model"])
        lines = [
            (
                *(spelt(row[each]) for each in axes),
                *(row[each].upper() for each in modelled),
                *(_cell(row[c]) for c in shown),
            )
            for _, row in rows.iterrows()
        ]
        for model, own in rows.groupby("model", sort=False):
            orders = [fitted(file, own, column) for column in shown]
            if any(orders):
                cells = (f"order {order.exponent:.2f}" if order else "" for order in orders)
                lines.append((*[""] * len(axes), model.upper(), *cells))
        heads = (re.sub(r"[._-]", " ", axis) for axis in axes)
        yield SmallTable(
            f"Points {name}" if sweep else name or "Values", (*heads, *modelled, *shown.values()), lines
        )


def _cell(value: Any) -> str:
    return value if isinstance(value, str) else number(None if value is None or value != value else value, 5)


def fitted(file: CaseFile, rows: DataFrame, column: str) -> Power | None:
    """The order that a row of the case takes of a column, in the rows of one model in a sweep."""
    takes = [claim.take[0] for claim in file.taken if claim.take[0][:2] == ("order", column)]
    fits = [own for take in takes if len(own := selected(file, rows, take))]
    return fit_power(fits[0]["h"], fits[0][column]) if fits else None
