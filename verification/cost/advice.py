# SPDX-License-Identifier: MIT
"""Which method, and how fine, for a given error: measured by case work-precision, given by `samfem plan` for
a user's scene.

`python -m verification.cost.advice reports/latest` takes the table of a report's work-precision over into
data/advice.csv.
"""

from __future__ import annotations

import csv
import gzip
import math
import sys
from collections.abc import Sequence
from dataclasses import asdict, astuple, dataclass, fields, replace
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

from verification.cost.estimates import SETTLES, peak_pressure
from verification.runs.files import plain
from verification.runs.tables import csv_text
from verification.text.readable import with_time

if TYPE_CHECKING:
    from sam.scene import Scene

ELASTIC, YIELDING, DEEP, SLIDING = "elastic", "yielding", "deeply yielding", "yielding and sliding"
COATED, ROUGH, ROUGH_YIELDING, RUNNING_IN = "coated", "rough, elastic", "rough, yielding", "running-in"
ON_TWO_GRIDS = "sam, solver.extrapolate"
"""Method of the rows of the semi-analytical model that extrapolates from two grids."""
LOAD_STEPS = "load steps"
"""Method of the rows that say how many load steps an error takes."""
BELOW, NEVER = "<", "not reached"
# p0 of the elastic contact over the initial yield stress: DEEPER is between the two spheres of the case, with
# 3 and 6.2; beyond DEEPEST no error was measured; YIELDS: first yield below a sphere, 1.613 (nu = 0.3).
DEEPER, DEEPEST, YIELDS = 4.5, 6.5, 1.6
MOVING = (
    "moving"  # kind of a scene with a path, which has no rows: a press says nothing of the steps along it
)
OF_MOVING = (
    "none, as the cost of an error was not measured for a load that moves; below a sphere at p0 = 4 yield "
    "stresses of Swift steel steps of a quarter of the contact radius leave 1 % of error in the depth of the "
    "groove and 8 % in the largest plastic strain, by case moving-steps; solver.uncertainty = true says what "
    "the cells and steps of this scene leave"
)
ORIGIN = "case work-precision (samfem verify work-precision --level full)"
REPORTED, KEPT = "figures/work-precision-advice.csv", "advice.csv"


@dataclass(frozen=True)
class AdviceRow:
    """What an error takes, as case work-precision measured it. bound: "", BELOW where even the coarsest
    measured is better, NEVER where none is. resolution: in `unit`; load_steps: of the measurement; kernels:
    of the calibration, see verification.cost.measured; relative: time over that of the cheapest method for
    this error.
    """

    kind: str
    quantity: str
    method: str
    error: float
    bound: str
    resolution: float
    unit: str
    load_steps: int
    seconds: float
    kernels: float
    relative: float


COLUMNS = tuple(field.name for field in fields(AdviceRow))
_NUMBERS = ("error", "resolution", "seconds", "kernels", "relative")


def table() -> list[AdviceRow]:
    """The committed table."""
    return read_rows(resources.files("verification").joinpath("data", KEPT).read_text(encoding="utf-8"))


def read_rows(text: str) -> list[AdviceRow]:
    """The rows of a table of advice."""
    rows = []
    for row in csv.DictReader(text.splitlines()):
        numbers = {name: float(row[name] or "nan") for name in _NUMBERS}
        rows.append(AdviceRow(**row | numbers | {"load_steps": int(row["load_steps"])}))
    return rows


def texts_of(row: AdviceRow) -> list[str]:
    """The cells of a row; empty where there is no number."""
    cells = (f"{v:.3g}" if isinstance(v, float) else str(v) for v in astuple(row))
    return ["" if cell in ("nan", "inf") else cell for cell in cells]


def kind_of(scene: Scene) -> str | None:
    """The kind of scene whose measurement is the nearest; None where none was measured."""
    plastic, friction = scene.body.plasticity, scene.friction
    if scene.loading.path is not None:
        return MOVING
    if scene.wear is not None or (friction is not None and friction.film):
        return RUNNING_IN
    if scene.loading.misfit_sphere:
        return None  # no contact
    if scene.patch_surface is not None:
        return ROUGH if plastic is None else ROUGH_YIELDING
    if scene.body.coating is not None:
        return COATED
    if scene.counterbody is not None and scene.counterbody.radii is None:
        return None
    if plastic is None and scene.loading.prescribed is not None:
        return None  # its pressure is no result
    ratio = _load_ratio(scene)
    if ratio is None or ratio < YIELDS * (scene.coefficient == 0.0):
        return ELASTIC
    if scene.coefficient and ratio <= DEEPEST:
        return SLIDING
    limits = {DEEPER: YIELDING, DEEPEST: DEEP, math.inf: None}  # beyond, errors are larger
    return next(kind for limit, kind in limits.items() if ratio <= limit)


def _load_ratio(scene: Scene) -> float | None:
    """p0 of the elastic contact over the least yield stress; None without plasticity or load."""
    plastic = scene.body.plasticity
    if plastic is None or scene.loading.force == 0.0:
        return None
    limit = plastic.strength().least(0.0)
    return peak_pressure(scene) / limit if limit else math.inf


def advice_of(scene: Scene, usable: Sequence[str], rows: Sequence[AdviceRow] | None = None) -> dict:
    """Advice for a scene as a mapping that JSON can hold: its kind, the rows for the `usable` models, words,
    table. usable: names of the models that can solve the scene; rows: of the committed table if None. Seconds
    are scaled with the load steps and cycles of the scene where it yields.
    """
    rows = table() if rows is None else rows
    kind = kind_of(scene)
    chosen = (*usable, LOAD_STEPS)
    own = [row for row in rows if row.kind == kind and row.method.split(",")[0] in chosen]
    content = {"kind": kind, "origin": ORIGIN, "rows": [_entry(row, _scale(scene, row)) for row in own]}
    return content | {"words": _words(kind, own), "table": _table(own, scene)}


def _scale(scene: Scene, row: AdviceRow) -> float:
    """Load steps of the scene over those measured, where each is solved; later cycles settle."""
    if scene.body.plasticity is None or row.method == LOAD_STEPS:
        return 1.0
    return scene.loading.steps * scene.loading.cycles**SETTLES / row.load_steps


def _entry(row: AdviceRow, scale: float) -> dict:
    entry: dict[str, Any] = plain(asdict(replace(row, seconds=row.seconds * scale)))
    del entry["kind"]
    return entry


def _words(kind: str | None, rows: Sequence[AdviceRow]) -> str:
    """What the table is about, for the reader."""
    if kind == MOVING:
        return OF_MOVING
    if kind is None or not rows:
        return "the cost of an error was not measured for this kind of scene"
    steps = ", load steps" * any(row.method == LOAD_STEPS for row in rows)
    what = f"{rows[0].unit}{steps}, processor time (about), ratio to the cheapest"
    return f"cost of an error in the {rows[0].quantity} of {kind} scenes: {what}; by {ORIGIN}"


def _table(rows: Sequence[AdviceRow], scene: Scene) -> dict[str, list]:
    """Columns and rows for the reader: a row for each error and method, with the load steps."""
    steps = {row.error: _resolution(row) for row in rows if row.method == LOAD_STEPS}
    methods = [row for row in rows if row.method != LOAD_STEPS]
    cells = []
    for row in sorted(methods, key=lambda row: -row.error):
        reached = row.bound != NEVER
        time = with_time(row.seconds * _scale(scene, row), 1) if reached else "-"
        over = f"{row.relative:.2g}" if reached and math.isfinite(row.relative) else "-"
        own = [f"{100.0 * row.error:g} %", row.method, _resolution(row)]
        cells.append([*own, *([steps.get(row.error, "-")] if steps else []), time, over])
    columns = ["error", "method", "cells", *(["steps"] if steps else []), "time", "ratio"]
    return {"columns": columns if cells else [], "rows": cells}


def _resolution(row: AdviceRow) -> str:
    """Cells or load steps, rounded up; with "<=" where even the coarsest measured is better."""
    if row.bound == NEVER:
        return NEVER
    return "<= " * (row.bound == BELOW) + str(math.ceil(row.resolution - 1e-6))


def main(folder: Path) -> None:
    """Keep the advice of a report as the committed table."""
    table = folder / REPORTED
    packed = table.with_name(f"{table.name}.gz")  # in what samfem publish wrote
    text = gzip.decompress(packed.read_bytes()) if packed.is_file() else table.read_bytes()
    rows = read_rows(text.decode("utf-8"))
    target = Path(__file__).parents[1] / "data" / KEPT
    target.write_text(csv_text(COLUMNS, list(map(texts_of, rows))), encoding="utf-8")
    print(f"{target}: {len(rows)} rows")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "reports/latest"))
