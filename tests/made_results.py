# SPDX-License-Identifier: MIT
"""Results that no solver made or that are changed, the gates that turn red on them; cases of a function."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from sam.scene import FieldMesh
from verification.cases import all_cases
from verification.cases.case import Case, Context, Outcome
from verification.judging import Row, evaluate
from verification.quantities import Solved
from verification.rows import load_rows


@dataclass(frozen=True)
class Made:
    """A result that no solver made."""

    quantities: dict = field(default_factory=dict)
    tables: dict = field(default_factory=dict)
    fields: FieldMesh | None = None
    cost: dict = field(default_factory=dict)
    model: str = "sam"
    discretisation: dict = field(default_factory=lambda: {"cells": (0, 0)})
    converged: bool = True
    status: str = "converged"
    message: str = ""
    warnings: tuple = ()
    verdict: dict | None = None
    grids: dict = field(default_factory=dict)
    certificate: dict = field(default_factory=dict)


def square_mesh(x: np.ndarray, p: np.ndarray, y: np.ndarray | None = None) -> FieldMesh:
    """A patch of cells with centres x and y, by default x, and the pressure (nx, ny), as SAM returns it."""
    sides = [np.append(c - (h := c[1] - c[0]) / 2, c[-1] + h / 2) for c in (x, x if y is None else y)]
    points, n = np.array([[a, b, 0.0] for a in sides[0] for b in sides[1]]), sides[1].size
    corner = (np.arange(x.size)[:, None] * n + np.arange(n - 1)).ravel()
    quads = np.stack([corner, corner + n, corner + n + 1, corner + 1], axis=1)
    return FieldMesh(points, {"quad": quads}, cell_data={"p_Pa": p.ravel()})


def of_plane(x: np.ndarray, z: np.ndarray, name: str, field) -> dict:
    """The table of a field at peak in y = 0: name -> field(x, z) at the points of a grid."""
    at = [each.ravel() for each in np.meshgrid(x, z, indexing="ij")]
    return {"state": ["peak"] * at[0].size, "x_m": at[0], "z_m": at[1], name: field(*at)}


def column(result, table: str, name: str, state: str = "peak") -> np.ndarray:
    """A column of a table of a result in the rows of one state."""
    return np.asarray(result.tables[table][name])[np.array(result.tables[table]["state"]) == state]


def line(result, name: str, state: str = "peak") -> np.ndarray:
    """The same of the table of the line y = 0."""
    return column(result, "line", name, state)


def with_column(result, table: str, column: str, change, *, states: tuple[str, ...] = ()):
    """The result with a column of a table changed, in the rows of the states, or in all."""
    old = result.tables[table]
    values = np.array(old[column], dtype=float)
    rows = np.isin(old["state"], states) if states else slice(None)
    values[rows] = change(values[rows])
    return replace(result, tables={**result.tables, table: {**old, column: values}})


def with_field(result, kind: str, name: str, change):
    """The result with a field of its mesh changed. kind: point_data or cell_data."""
    fields = {**getattr(result.fields, kind), name: change(np.array(getattr(result.fields, kind)[name]))}
    return replace(result, fields=replace(result.fields, **{kind: fields}))


def last_released(active):
    """The active set without its last node."""
    return active & (np.cumsum(active) < np.count_nonzero(active))


def with_quantities(result, **factors: float):
    """The result with some of its quantities multiplied."""
    changed = {name: result.quantities[name] * factor for name, factor in factors.items()}
    return replace(result, quantities={**result.quantities, **changed})


def of_frame(case: str, frame) -> dict:
    """What the rows of a case take of a frame."""
    return all_cases()[case].measure({"": Solved(None, None, {}, frame)})


def context(case: str, folder, level: str = "quick") -> Context:
    return Context(case, folder, level, lambda *_: None)


def red(case: str, values: dict, prefix: str = "", whole: bool = False) -> set[str]:
    """The gates of a case that are red, without its name and the prefix; whole: those without a value too."""
    named = {
        name if name.startswith(f"{case}.") else f"{case}.{prefix}{name}": v for name, v in values.items()
    }
    verdicts = [v for v in evaluate(load_rows(), {case: named}) if v.row.id in named or whole]
    assert {v.row.id for v in verdicts} >= set(named)
    return {v.row.id.removeprefix(f"{case}.{prefix}") for v in verdicts if v.status.red}


@dataclass(frozen=True)
class FakeCase(Case):
    """A case that runs `does` in place of the parts, for tests of what stands around the cases."""

    does: Callable[[Context], Outcome] | None = None

    def run(self, context):
        return self.does(context)


def row(name: str, case: str = "", **changed) -> Row:
    """A row that holds a value to a tenth of another, or with what is changed of it."""
    said = {"quantity": name, "metric": "relative", "tolerance": 0.1, "reason": "because", "kind": "exact"}
    return Row(id=name, case=case or name.partition(".")[0], **said | changed)
