# SPDX-License-Identifier: MIT
"""What is checked of a solution in each model: condition -> value, see `verification.checks`."""

from collections.abc import Mapping
from itertools import groupby, pairwise

import numpy as np

from fem_reference import load_steps
from sam import choose_grid
from sam.scene import Attempt, Result, Scene
from verification.checks import (
    axisymmetric as fem_checks,
    cells as cell_checks,
    coated as coated_checks,
    conditions as contact_checks,
    film as film_checks,
    spatial as spatial_checks,
)
from verification.runs import models


def solved(scene: Scene, model: str) -> tuple[Result, list]:
    """The result of a model, and all that it handed out after its load steps."""
    records: list = []
    result = models.solve(scene, model, checkpoint=records.append)
    if not result.converged:
        raise RuntimeError(f"{model} ended {result.status}: {result.message}")
    return result, records


def of_sam(scene: Scene, result: Result, records: list) -> dict[str, float]:
    """All conditions of a result of SAM, smooth or rough, without film."""
    plastic, rough = scene.body.plasticity is not None, scene.surface is not None
    values = common(scene, result) | {"displacement": cell_checks.displaced(scene, result, records)}
    if scene.friction is not None:
        values["friction"] = contact_checks.slips(scene, result)
    elif not rough:
        values["planes"] = float(np.abs(contact_checks.sam_planes(scene, result)).max())
    if not (rough and plastic):  # half a cell is too thick to extrapolate below spots of a few cells
        values["surface"] = contact_checks.sam_surface(scene, result)
    if not plastic:
        return values | {"stress": cell_checks.stress(scene, result)}
    values = larger(values, contact_checks.flow(scene, records, choose_grid(scene).depths))
    values["yield"] = max(
        values["yield"], *(contact_checks.yields(scene, result, state) for state in ("peak", "unloaded"))
    )
    values["displacement"] = max(values["displacement"], cell_checks.left(scene, result, records))
    if scene.friction is not None and scene.friction.film:
        values["film"] = film_checks.states(scene, records)
    if not rough:  # the line y = 0 need not be where a rough body touches first
        values = larger(values, contact_checks.unloaded(scene, result))
    return values


def of_coated(scene: Scene, result: Result, _records: list) -> dict[str, float]:
    """All conditions of a result of SAM with an elastic film."""
    values = common(scene, result) | {
        "surface": contact_checks.sam_surface(scene, result),
        "displacement": coated_checks.displaced(scene, result),
        "interface": coated_checks.interface(scene, result),
    }
    if scene.friction is not None:
        values["friction"] = contact_checks.slips(scene, result)
    return values


def of_fem(scene: Scene, result: Result, records: list) -> dict[str, float]:
    """All conditions of the axisymmetric FEM; an elastic body hands out no steps: they are taken again."""
    values = common(scene, result)
    model, steps = load_steps(scene, records[-1] if records else None)
    finite = [fem_checks.Finite(scene, model, step) for step in steps]
    last = [each for each, step in zip(finite, steps, strict=True) if not step.unloads][-1]
    values = larger(values, last.equilibrium())
    if scene.body.coating is None:
        depths, errors = last.planes()
        values["planes"] = float(np.abs(errors[depths < fem_checks.DEEPEST]).max())
        values["surface"] = last.surface()
    if scene.body.plasticity is not None:
        values = larger(
            values | {"yield": max(each.yields() for each in finite)}, contact_checks.unloaded(scene, result)
        )
        for before, now, step in zip(finite, finite[1:], steps[1:], strict=False):
            if not step.cuts:
                values = larger(values, now.flow(before))
    return values


def of_spatial(scene: Scene, result: Result, records: list) -> dict[str, float]:
    """All conditions of a result of the three-dimensional FEM, in every step."""
    values, steps = spatial_checks.surface(scene, result), spatial_checks.steps_of(scene, records)
    for each in steps:
        values = larger(values, each.equilibrium())
    values |= late(result) | {"fields": spatial_checks.fields(steps, result)}
    if scene.body.plasticity is not None:
        values["yield"] = max(each.yields() for each in steps)
        for before, now in pairwise(steps):
            values = larger(values, now.flow(before))
    return values


OF_GROUP = {"sam": of_sam, "fem": of_fem, "coated": of_coated, "rough": of_sam, "fem-3d": of_spatial}
"""Group of scenes of the case `certificates` -> how they are measured."""


def larger(one: Mapping[str, float], other: Mapping[str, float]) -> dict[str, float]:
    """The larger of both values of each condition."""
    return {what: max(each[what] for each in (one, other) if what in each) for what in {**one, **other}}


def common(scene: Scene, result: Result) -> dict[str, float]:
    """Conditions that are measured alike in SAM and the axisymmetric FEM."""
    contact = contact_checks.complementarity(scene, result)
    return {"load": contact_checks.load(scene, result), "complementarity": contact} | late(result)


def late(result: Result) -> dict[str, float]:
    """Steps that were accepted above the residual where they may stop."""
    curves = [each for _, each in curves_of(result) if each.residuals]
    return {"histories": float(sum(each.accepted and each.residuals[-1] > each.goal for each in curves))}


def curves_of(result: Result) -> list[tuple[str, Attempt]]:
    """The attempts in the residual histories of a result: (load step, attempt)."""
    columns = ("cycle", "step", "attempt", "accepted", "goal", "residual")
    rows = zip(*(result.tables["residuals"][name] for name in columns), strict=True)
    return [
        (f"step {step}", Attempt(bool(accepted), tuple(row[-1] for row in same), goal))
        for (_, step, _, accepted, goal), same in groupby(rows, key=lambda row: row[:5])
    ]
