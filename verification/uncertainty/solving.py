# SPDX-License-Identifier: MIT
"""A result with the numerical uncertainty of its quantities."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import Any

from sam.grid import Room
from sam.scene import COLUMNS, Problem, Result, Scene, SceneError, spelling
from verification.runs import models
from verification.uncertainty.members import (
    LEAST_IN_RADIUS,
    Family,
    Member,
    NoFamilyError,
    alone,
    cells_in_radius,
    cells_to_edge,
    depths_of_maxima,
    family,
)
from verification.uncertainty.quantities import (
    BOX_ORDERS,
    EDGES,
    OF_ELEMENTS,
    ORDERS,
    OUTLINE_FACTOR,
    STEP_ORDER,
    is_given,
    why_not,
)
from verification.uncertainty.rule import EDGE, FACTOR, STEP_FACTOR, bound, converging, of_edge, order_seen

Solve = Callable[[Scene, str], Result]
"""Solves a scene of the family; the text says which it is."""
NOT_CONVERGING = "not converging: the last refinement changed more than the one before"


@dataclass(frozen=True)
class Solved:
    """The results of a family: those of its cells, of its load steps, and of its boxes. edge: cells in the
    radius of a contact whose edge falls between them, else infinite.
    """

    family: Family
    cells: Sequence[Result]
    steps: Sequence[Result] = ()
    box: Sequence[Result] = ()
    edge: float = inf

    @property
    def reason(self) -> str:
        """Why the results are not of one family; empty if they are."""
        members = (*self.family.cells, *self.family.steps, *self.family.box)
        pairs = list(zip(members, (*self.cells, *self.steps, *self.box), strict=True))
        for member, result in pairs:
            if not result.converged:
                return f"{member.label}: {result.status}"
        cuts = [result.cost.get("step_cuts") or 0 for _, result in pairs]
        if len(set(cuts)) > 1:
            words = ", ".join(f"{cut} with {each.label}" for each, cut in zip(members, cuts, strict=True))
            return f"load steps were cut differently ({words}): raise loading.steps"
        return ""


def solve(scene: Scene, model: str, solver: Solve | None = None) -> Result:
    """The result of a scene, and if it asks for its uncertainty, of its coarser companions what they say.

    solver: of every scene, `models.solve` by default. Raises what that raises. The finest is solved first.
    Where it does not converge, or nothing can be said, the others are not solved.
    """
    how = solver or (lambda each, _: models.solve(each, model))
    if not scene.solver.uncertainty:
        return how(scene, "")
    fine = how(alone(scene), "the scene itself")
    if not fine.converged:
        return replace(fine, uncertainty={})
    room = fine.discretisation.get("grid_enlarged")
    try:
        found = family(scene, model, None if room is None else Room(**room), depths_of_maxima(scene, fine))
    except NoFamilyError as error:
        return _reported(fine, scene, str(error))
    if words := under_resolved(scene, fine, found):
        return _reported(fine, scene, words)

    def rest(members: Sequence[Member], first: Result) -> list[Result]:
        return [first, *(how(member.scene, member.label) for member in members[1:])] if members else []

    cells = rest(found.cells, fine)
    steps = rest(found.steps, cells[-1])
    return assessed(scene, Solved(found, cells, steps, rest(found.box, (steps or cells)[-1])))


def asked_of(scene: Scene, source: str) -> Scene:
    """The scene, asked for its uncertainty. SceneError where there is none; source: names it in errors."""
    solver = scene.solver.model_copy(update={"uncertainty": True})
    asked = scene.model_copy(update={"solver": solver})
    own = ((f"solver.{key}", words) for key, words in solver.conflicts(solver.model_dump(exclude_none=True)))
    if found := [*own, *asked.excesses()]:
        raise SceneError([Problem(key, spelling(True), words) for key, words in found], source)
    return asked


def under_resolved(scene: Scene, fine: Result, found: Family) -> str:
    """Why the coarsest grid of a family is too coarse for an uncertainty; empty if it is not."""
    resolved = cells_in_radius(scene, fine, found)
    if resolved >= LEAST_IN_RADIUS:
        return ""
    words = f"{found.cells[-1].label}, {resolved:.2g} in the contact radius, {LEAST_IN_RADIUS:g} needed"
    return f"the coarsest grid is under-resolved: {words}"


def assessed(scene: Scene, solved: Solved) -> Result:
    """The finest result of a family, with the uncertainty of its quantities and the cost of all solves."""
    fine = solved.cells[0]
    reason = solved.reason or under_resolved(scene, fine, solved.family)
    solved = replace(solved, edge=cells_to_edge(scene, fine, solved.family))
    members = (*solved.cells[1:], *solved.steps[1:], *solved.box[1:])
    return replace(_reported(fine, scene, reason, solved), cost=cost_of(fine, members))


def _reported(fine: Result, scene: Scene, reason: str, solved: Solved | None = None) -> Result:
    """The result with the uncertainty of each quantity that the scene does not give, or why there is none;
    reason: of all that have none of their own.
    """
    entries: dict[str, dict[str, Any]] = {}
    for name, value in fine.quantities.items():
        if value is None or is_given(name, scene):
            continue
        words = why_not(name, scene) or reason
        known = None if words or solved is None else entry(name, solved, scene.solver.tolerance)
        entries[name] = known or {"u_num": None, "flag": words}
    rows = [{"quantity": name, "value": fine.quantities[name]} | each for name, each in entries.items()]
    table = {column: [row.get(column) for row in rows] for column in COLUMNS["quantities"]}
    return replace(fine, uncertainty=entries, tables={**fine.tables, "quantities": table})


def entry(name: str, solved: Solved, tolerance: float) -> dict[str, Any]:
    """What the members say about a quantity.

    u_cells, u_steps, u_box: bounds by each; u_num: their sum, as errors of one sign are usual, at least the
    tolerance of the solvers. Bounds by steps and box are relative changes on the coarsest cells; that by
    cells is at least what the edge of the contact leaves.
    """
    value = solved.cells[0].quantities[name]
    outline = name in EDGES and solved.edge < inf and solved.cells[0].model == models.SAM
    factor = OUTLINE_FACTOR if outline else FACTOR
    of_cells, values = _bound(name, solved.family.cells, solved.cells, ORDERS[name], factor=factor)
    of_steps, on_steps = _bound(name, solved.family.steps, solved.steps, STEP_ORDER, factor=STEP_FACTOR)
    of_box, in_boxes = _bound(name, solved.family.box, solved.box, BOX_ORDERS.get(name, 2.0))
    if of_cells is None:
        return {"u_num": None, "flag": "a coarser solve does not have it"}
    left = solved.cells[0].model == models.SAM or name in OF_ELEMENTS
    edge = of_edge(value, solved.edge, EDGES.get(name, EDGE)) if ORDERS[name] == 2.0 and left else 0.0
    parts = {"u_cells": max(of_cells, edge), "u_steps": _carried(of_steps, on_steps, value)}
    parts["u_box"] = _carried(of_box, in_boxes, value)
    total = max(sum(parts.values()), tolerance * abs(value))
    sizes = [member.size for member in solved.family.cells]
    return {
        "u_num": total,
        "relative": total / abs(value) if value else None,
        **parts,
        "order_seen": order_seen(values, sizes),
        "values": values,
        "cells": [member.number for member in solved.family.cells],
        "values_of_steps": on_steps,
        "steps": [member.number for member in solved.family.steps],
        "flag": "" if converging(values, sizes) else NOT_CONVERGING,
    }


def _carried(part: float | None, values: Sequence[float], value: float) -> float:
    """A bound of the first of some values as the same share of another value."""
    if part is None:
        return 0.0
    return part * abs(value / values[0]) if values[0] else part


def _bound(
    name: str, members: Sequence[Member], results: Sequence[Result], order: float, *, factor: float = FACTOR
) -> tuple[float | None, list[float]]:
    """The bound of a quantity along one direction, None where there is none, and its values."""
    values = [result.quantities[name] for result in results]
    if len(values) < 2 or None in values:
        return None, []
    return bound(values, [member.size for member in members], order, factor), values


def cost_of(fine: Result, members: Sequence[Result]) -> dict[str, float | int | None]:
    """Of all solves together, which are made one after the other."""
    total = dict(fine.cost)
    for name, value in total.items():
        others = [member.cost.get(name) or 0 for member in members]
        if name == "peak_memory_bytes":
            total[name] = max(value or 0, *others)
        elif value is not None:
            total[name] = value + sum(others)
    return total
