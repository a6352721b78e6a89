# SPDX-License-Identifier: MIT
"""Every condition of a solution, measured after the solve on what was returned, by `verification.certify`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from sam.grid import choose_grid
from sam.scene import Result, Scene
from sam.scene.friction import Friction
from sam.scene.residuals import Attempt
from verification import certify, certify_fem, models
from verification.cases.case import Case, Context, Outcome, SmallTable, with_loading
from verification.cases.plastic import at_ratio
from verification.cases.resolution import Resolution, resolved_at
from verification.figures.residuals import histories
from verification.gates import Measured
from verification.models import FEM, SAM

LEVEL = {"quick": Resolution(8, 10), "full": Resolution(12, 20)}
STEPS, RATIO, PERFECT_RATIO, COEFFICIENT = 5, 4.0, 3.0, 0.2
NAMES = {
    "load": "load: |sum of p - F|/F",
    "complementarity": "contact: |gap| where p > 0, penetration elsewhere, over the approach",
    "equilibrium": "equilibrium: nodal forces on free degrees of freedom over F",
    "yield": "yield: (σ_vM - σ_y)/σ_y",
    "flow": "flow rule: 2G |Δεᵖ - 3/2 Δγ s/σ_vM| over σ_y0, Δεᵖ without volume, Δγ its length and never negative",
    "consistency": "consistency: |σ_vM - σ_y|/σ_y where Δγ > 0",
    "surface": "surface: tractions extrapolated to z = 0 less those returned, away from the edge of contact, over p_max",
    "planes": "planes: force through z = const over the load, less 1",
    "histories": "histories: steps that were accepted above the residual where they may stop",
}


@dataclass
class Found:
    """What is measured of a scene with one model: condition (of NAMES) -> value; curves: see `histories`."""

    values: dict[str, float] = field(default_factory=dict)
    curves: list[tuple[str, Attempt]] = field(default_factory=list)


def scenes(context: Context) -> dict[str, Scene]:
    """Elastic, hardening and perfectly plastic; at rest, and one that slides."""
    swift, perfect = context.scene("plastic-swift-rigid"), context.scene("plastic-perfect")
    swift, perfect = (
        with_loading(at_ratio(scene, ratio), steps=STEPS, unload=True)
        for scene, ratio in ((swift, RATIO), (perfect, PERFECT_RATIO))
    )
    elastic = perfect.model_copy(update={"body": perfect.body.model_copy(update={"plasticity": None})})
    elastic = elastic.model_copy(update={"solver": type(elastic.solver)()})
    sliding = swift.model_copy(update={"friction": Friction(coefficient=COEFFICIENT)})
    found = {"elastic": elastic, "Swift": swift, "perfect": perfect, "Swift, sliding": sliding}
    return {name: resolved_at(scene, LEVEL[context.level]) for name, scene in found.items()}


def run(context: Context) -> Outcome:
    """Solve each scene with both models where both apply, and measure every condition."""
    found: dict[tuple[str, str], Found] = {}
    for name, scene in scenes(context).items():
        found[name, SAM] = of_sam(scene, *solved(scene, SAM))
        if scene.friction is None:
            found[name, FEM] = of_fem(scene, *solved(scene, FEM))
    worst = {(model, what): 0.0 for model in (SAM, FEM) for what in NAMES}
    for (_, model), each in found.items():
        for what, value in each.values.items():
            worst[model, what] = max(worst[model, what], value)
    short = {SAM: "sam", FEM: "fem"}
    outcome = Outcome()
    for (model, what), value in worst.items():
        if not (model == SAM and what == "equilibrium"):  # nodal forces are of FEM only
            gate = f"{context.case}.{short[model]}-{what}"
            outcome.values[gate] = Measured(value, 0 if what == "histories" else None)
    resolution = LEVEL[context.level]
    outcome.setup = [
        ("Scenes", f"rigid sphere, unloaded again: elastic, Swift (p₀/σ_y0 = {RATIO:g}), perfectly plastic ({PERFECT_RATIO:g})"),
        ("Sliding", f"Swift steel, coefficient {COEFFICIENT:g}, SAM"),
        ("Resolution", f"{resolution.sam} cells, {resolution.fem} elements in the elastic contact radius; {STEPS} load steps"),
    ]
    outcome.tables.append(table_of(found))
    curves = [(f"{name}, {short[model].upper()}", each) for (name, model), each in found.items()]
    outcome.figures.append(
        context.save(
            histories({title: each.curves for title, each in curves}),
            "residuals",
            "Residuals over the iterations",
            "Semi-logarithmic curves of the residual of each load step, falling to the tolerance of the model",
            "Each curve is one attempt at a load step; the dotted line is where it may stop. Elastic SAM: contact; plastic SAM: "
            "yield and flow rule, the contact inside; FEM: forces of Newton's method.",
        )
    )
    return outcome


def solved(scene: Scene, model: str) -> tuple[Result, list]:
    """The result of a model, and all that it handed out after its load steps."""
    records: list = []
    result = models.solve(scene, model, checkpoint=records.append)
    if not result.converged:
        raise RuntimeError(f"{model} ended {result.status}: {result.message}")
    return result, records


def of_sam(scene: Scene, result: Result, records: list) -> Found:
    """All conditions of a result of SAM."""
    values = common(scene, result)
    if scene.friction is None:
        values["planes"] = float(np.abs(certify.sam_planes(scene, result)).max())
    values["surface"] = max(certify.sam_surface(scene, result).values())
    if scene.body.plasticity is None:
        values["complementarity"] = max(values["complementarity"], *certify.elastic_surface(scene, result).values())
    else:
        values["yield"] = certify.yields(scene, result)
        values = larger(values, by_rule(certify.flow(scene, records, choose_grid(scene).depths)))
        values = larger(values, certify.unloaded(scene, result))
    return Found(values, curves_of(result))


def larger(one: Mapping[str, float], other: Mapping[str, float]) -> dict[str, float]:
    """The larger of both values of each condition."""
    return {what: max(each[what] for each in (one, other) if what in each) for what in {**one, **other}}


def of_fem(scene: Scene, result: Result, records: list) -> Found:
    """All conditions of a result of FEM; its steps are taken again for an elastic body, which hands out none."""
    values = common(scene, result)
    model, steps = certify_fem.steps_of(scene, records)
    last = certify_fem.Finite(model, [step for step in steps if not step.unloads][-1])
    values = larger(values, last.equilibrium() | {"surface": max(last.surface().values())})
    depths, errors = last.planes()
    values["planes"] = float(np.abs(errors[depths < certify_fem.DEEPEST]).max())
    if scene.body.plasticity is not None:
        values = larger(values | {"yield": certify.yields(scene, result)}, certify.unloaded(scene, result))
        for before, now in pairwise(steps):
            if not now.cuts:
                found = certify_fem.Finite(model, now).flow(scene, certify_fem.Finite(model, before))
                values = larger(values, by_rule(found))
    return Found(values, curves_of(result))


def common(scene: Scene, result: Result) -> dict[str, float]:
    """Conditions that are measured alike in both models."""
    load, contact = certify.load(scene, result), certify.complementarity(scene, result)
    late = sum(each.accepted and each.residuals[-1] > each.goal for _, each in curves_of(result) if each.residuals)
    return {"load": max(load.values()), "complementarity": max(contact.values()), "histories": float(late)}


def by_rule(found: Mapping[str, float]) -> dict[str, float]:
    """The values of `certify.flow_of` in three."""
    parts = ("direction", "length", "volume", "backwards")
    return {"flow": max(found[name] for name in parts), "consistency": found["consistency"], "yield": found["yield"]}


def curves_of(result: Result) -> list[tuple[str, Attempt]]:
    """The attempts in the residual histories of a result: (load step, attempt)."""
    table = result.tables["residuals"]
    keys = list(zip(table["cycle"], table["step"], table["attempt"], strict=True))
    out: list[tuple[str, Attempt]] = []
    for key in dict.fromkeys(keys):
        rows = [k for k, each in enumerate(keys) if each == key]
        residuals = tuple(table["residual"][k] for k in rows)
        out.append((f"step {key[1]}", Attempt(bool(table["accepted"][rows[0]]), residuals, table["goal"][rows[0]])))
    return out


def table_of(found: Mapping[tuple[str, str], Found]) -> SmallTable:
    """One row a condition, a column for each scene and model."""
    rows = []
    for what, words in NAMES.items():
        values = [each.values.get(what) for each in found.values()]
        rows.append((words, *("" if value is None else f"{value:.1e}" if value else "0" for value in values)))
    titles = [f"{name}, {'SAM' if model == SAM else 'FEM'}" for name, model in found]
    return SmallTable("Conditions, measured on what was returned", ("condition", *titles), rows)


CASES = (
    Case(
        "certificates",
        "Conditions of a returned solution",
        "Do the returned fields satisfy contact, load, yield, flow rule and equilibrium, by formulas that are not the solvers'?",
        run,
        (
            ("Displacement", "u = (1-ν²)/(πE) Σ p ∬ dA/r over each cell", "Love, Phil. Trans. R. Soc. A 228 (1929) 377"),
            ("Flow rule", "Δεᵖ = 3/2 Δγ s/σ_vM at the end of the step", "Simo & Hughes, Computational Inelasticity (1998)"),
            ("Beyond the last radius", "∫σ_zz dA = F z³/(R²+z²)^(3/2) + …", "Johnson, Contact Mechanics (1985), Eq. 3.19"),
        ),
    ),
)
