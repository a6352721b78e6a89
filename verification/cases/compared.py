# SPDX-License-Identifier: MIT
"""A case without code: one scene, solved by the models that its file names, each held against the
reference, and SAM against finite elements. Everything that is shown follows from the vocabulary.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from sam.scene import Scene
from verification.cases.case import (
    Case,
    Context,
    Plot,
    SmallTable,
    View,
    elastic_text,
    grid_text,
    mesh_text,
    with_keys,
)
from verification.cases.recipes import RECIPES
from verification.compare.comparison import compare_scene
from verification.quantities import QUANTITIES, Measured, Quantity, Solved
from verification.references import REFERENCES
from verification.rows import CaseFile
from verification.runs.models import FEM, FEM_3D, SAM
from verification.text.console import number

MODELS = {"sam": SAM, "fem": FEM, "fem-3d": FEM_3D}


COUNTED = {
    "plastic_iterations": "plastic iterations",
    "operator_applications": "applications of the residual-stress operator",
    "newton_iterations": "Newton iterations",
    "step_cuts": "load steps cut",
    "setup_s": "set-up [s]",
    "solve_s": "solution [s]",
}


def scene_of(context: Context, file: CaseFile, **vary: Any) -> Scene:
    """The scene of a case at the level of the context: keys set, then recipes applied in their order."""
    changed = file.quick if context.level == "quick" else {}
    scene, vary = context.scene(file.scene), file.vary | changed.get("vary", {}) | vary
    for key, value in (file.set | changed.get("set", {})).items():
        section, _, name = key.rpartition(".")
        scene = with_keys(scene, section, **{name: tuple(value) if isinstance(value, list) else value})
    for name in (name for name in RECIPES if name in vary):
        scene = RECIPES[name](scene, vary[name])
    return scene


@dataclass(frozen=True)
class Compared(Case):
    """The case of a file with a scene."""

    file: CaseFile | None = None

    def solve(self, context: Context) -> Solved:
        scene = scene_of(context, self.file)
        reference = REFERENCES[self.file.reference](scene) if self.file.reference else None
        runs = {run.partition("-")[0]: MODELS[run] for run in self.file.models}
        results = {run: context.solve(model, scene, run) for run, model in runs.items()}
        if self.file.against:
            other = scene_of(context, self.file, **self.file.against)
            others = {run: context.solve(model, other, f"{run}-other") for run, model in runs.items()}
            return Solved(scene, reference, results, others=others)
        if not self.file.allowance:
            return Solved(scene, reference, results)
        coarse = scene_of(context, self.file, resolution=self.file.coarser)
        cell, larger = (each.grid.extent[0] / each.grid.cells[0] for each in (scene, coarse))
        ratios = larger / cell, scene.fem.cells_per_radius / coarse.fem.cells_per_radius
        before = [context.solve(model, coarse, f"{run}-coarser") for run, model in runs.items()]
        return Solved(scene, reference, results, tuple(zip(before, ratios, strict=True)))

    def measure(self, found: Solved) -> dict[str, Measured]:
        """The rows of the file: `sam/exact` and the like by the vocabulary; `sam/fem`, and what is said of
        both models, by what is between them, where only the difference is held by the rows of `compare`.
        """
        values, difference = {}, None
        metrics = {row.id.removeprefix(f"{self.name}."): row.metric for row in self.file.rows}
        for table, names in self.file.claims.items():
            model, _, against = table.rpartition("/")
            for name, of in names.items():
                quantity = QUANTITIES[of]
                if model and against != "fem":
                    result = found.results[model]
                    if quantity.of:
                        measured = quantity.against(of, result, found.reference)
                    else:
                        measured = quantity.between(found.scene, result, found.others[model])
                    alone = against == "bound"
                    values[f"{model}-{name}"] = Measured(measured.value) if alone else measured
                elif name in self.file.allowance:
                    *_, apart, allowed = refinement(found, quantity)
                    values[name] = Measured(apart / allowed)
                elif quantity.row and (metrics[name] == "at_most" or not quantity.between):
                    difference = difference or rows_of_compare(found)
                    values[name] = Measured(difference[quantity.row])
                else:
                    values[name] = quantity.between(found.scene, *found.results.values())
        return values

    def setup(self, found: Solved) -> Iterator[tuple[str, str]]:
        scene, other, loading = found.scene, found.scene.counterbody, found.scene.loading
        a = (
            found.reference.units["a"]
            if found.reference
            else found.results["sam"].quantities["contact_radius_m"]
        )
        plasticity = scene.body.plasticity
        law = (
            f"; {plasticity.law}, {plasticity.curve().stress(0.0) / 1e6:.1f} MPa at first yield"
            if plasticity
            else ""
        )
        yield "Half-space", elastic_text(scene.body) + law
        sizes = ("radius", "radius_x", "radius_y", "flat_radius")
        size = ", ".join(f"{n.replace('_', ' ')} {v * 1e6:g} µm" for n in sizes if (v := getattr(other, n)))
        yield other.shape.capitalize(), f"{size}, {elastic_text(other) if other.elastic else 'rigid'}"
        unloaded = ", then unloaded" * loading.unload
        yield "Force", f"{loading.force:.5g} N in {loading.steps} equal steps{unloaded}"
        yield from found.reference.facts if found.reference else ()
        for run, result in found.results.items():
            yield run.upper(), grid_text(result, a) if result.model == SAM else mesh_text(result)

    def tables(self, found: Solved) -> Iterator[SmallTable]:
        if set(found.results) != {"sam", "fem"}:
            return
        rows = []
        for quantity in QUANTITIES.values():
            values = [each.quantities.get(quantity.row) for each in found.results.values()]
            if all(values):
                off = f"{1e2 * (values[0] / values[1] - 1.0):+.2f} %"
                words = f"{quantity.words} [{quantity.unit}]" if quantity.unit else quantity.words
                rows.append((words, *(number(value, 5) for value in values), off))
        yield SmallTable("Results", ("quantity", "SAM", "FEM", "difference"), rows)
        costs = [each.cost for each in found.results.values()]
        rows = [(words, *(number(cost.get(n), 3) for cost in costs)) for n, words in COUNTED.items()]
        yield SmallTable("Cost", ("counter", "SAM", "FEM"), rows)
        if self.file.allowance:
            named = [QUANTITIES[name] for name in self.file.allowance]
            rows = [(q.words, *(f"{1e2 * share:.2f} %" for share in refinement(found, q))) for q in named]
            columns = "quantity", "uncertainty of SAM", "of FEM", "difference", "largest of 1 % and their sum"
            yield SmallTable("Refinement uncertainties", columns, rows)

    def figures(self, found: Solved) -> Iterator[Plot]:
        from verification.cases.kinds import KINDS  # noqa: PLC0415 - loads matplotlib

        for kind in self.file.figures:
            yield KINDS[kind](found)

    def views(self, found: Solved) -> Iterator[View]:
        from verification.cases.kinds import VIEWS  # noqa: PLC0415 - loads matplotlib

        yield from (VIEWS[name] for name in self.file.views)


def refinement(found: Solved, quantity: Quantity) -> tuple[float, float, float, float]:
    """Refinement uncertainties of SAM and FEM, their difference, and what is allowed: 1 %, or both
    uncertainties where that is more.

    Uncertainty: change from a coarser grid over (ratio - 1), the rest of a first-order error (Roache,
    Verification and Validation in Computational Science and Engineering, 1998, Eq. 5.10.5.1 without its
    factor of safety). Fields in the L2 norm, over that of FEM.
    """
    sam, fem = found.results.values()
    both = quantity.between(found.scene, sam, fem)
    norm = np.linalg.norm
    rests = []
    for now, (result, ratio) in zip((both.value, both.expected), found.coarser, strict=True):
        before = quantity.between(found.scene, sam, result).expected
        rests.append(
            float(norm(now - before) / norm(both.expected if np.ndim(now) else before)) / (ratio - 1.0)
        )
    apart = float(norm(both.value - both.expected) / norm(both.expected))
    return *rests, apart, max(0.01, sum(rests))


def rows_of_compare(found: Solved) -> dict[str, Any]:
    """Name of a row of `compare` -> the difference of both models."""
    rows = compare_scene(found.scene, *found.results.values())
    return {row.quantity: row.difference for row in rows}
