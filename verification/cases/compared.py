# SPDX-License-Identifier: MIT
"""A case without code: one scene, solved by the models that its file names, each held against the
reference, and SAM against finite elements. Everything that is shown follows from the vocabulary.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
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
)
from verification.cases.recipes import RECIPES, beside, changed
from verification.cases.sweep import MODELS, framed, points, ran, tables_of, taken
from verification.compare.comparison import compare_scene
from verification.judging import Measured
from verification.quantities import QUANTITIES, Quantity, Reference, Solved
from verification.references import REFERENCES
from verification.rows import CaseFile
from verification.runs.models import SAM
from verification.text.console import number

COUNTED = {
    "plastic_iterations": "plastic iterations",
    "operator_applications": "applications of the residual-stress operator",
    "newton_iterations": "Newton iterations",
    "step_cuts": "load steps cut",
    "setup_s": "set-up [s]",
    "solve_s": "solution [s]",
}


def scene_of(context: Context, file: CaseFile, **vary: Any) -> Scene:
    """The scene of a case at the level of the context: keys set, then recipes applied in the order of
    RECIPES; vary: other values.
    """
    quick = file.quick if context.level == "quick" else {}
    place = str(file.path.parent / file.scene) if file.scene.endswith(".toml") else file.scene
    vary, places = file.vary | quick.get("vary", {}) | vary, list(RECIPES)
    ordered = sorted(vary, key=lambda name: places.index(name) if name in places else len(places))
    changes = file.set | quick.get("set", {}) | {name: vary[name] for name in ordered}
    return changed(context.scene(place), changes, file)


@dataclass(frozen=True)
class Compared(Case):
    """The case of a file with a scene."""

    def solve(self, context: Context) -> Solved:
        scene = scene_of(context, self.file)
        answer = beside(self.file, self.file.reference, REFERENCES) if self.file.reference else None
        given = Reference(self.file.values, {}) if self.file.values else None
        runs = {run.partition("-")[0]: MODELS[run] for run in self.file.models}
        results = {run: context.solve(model, scene, run) for run, model in runs.items()}
        frame = framed(context, self.file, scene) if self.file.sweeps else None
        found = Solved(scene, answer(scene) if answer else given, results, frame)
        if self.file.against:
            other = scene_of(context, self.file, **self.file.against)
            others = {run: context.solve(model, other, f"{run}-other") for run, model in runs.items()}
            return replace(found, others=others)
        if not self.file.allowance:
            return found
        coarse = scene_of(context, self.file, resolution=self.file.coarser)
        cell, larger = (each.grid.extent[0] / each.grid.cells[0] for each in (scene, coarse))
        ratios = larger / cell, scene.fem.cells_per_radius / coarse.fem.cells_per_radius
        before = [context.solve(model, coarse, f"{run}-coarser") for run, model in runs.items()]
        return replace(found, coarser=tuple(zip(before, ratios, strict=True)))

    def ahead(self, context: Context) -> Iterator[Scene]:
        sweeps = [sweep for sweep in self.file.sweeps.values() if "sam" in sweep.models]
        base = scene_of(context, self.file) if sweeps else None
        for sweep in sweeps:
            yield from (changed(base, changes, self.file) for _, changes in points(sweep, context.level))

    def measure(self, found: Solved) -> dict[str, Measured]:
        """The rows of the file: `sam/exact` and the like by the vocabulary; `sam/fem`, and what is said of
        both models, by what is between them, where only the difference is held by the rows of `compare`; and
        what they take of the sweeps.
        """
        values, difference = taken(self.file, found.frame) if self.file.sweeps else {}, None
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
        a = found.reference.units.get("a", 0.0) if found.reference else 0.0
        if not a and found.results:
            a = found.results["sam"].quantities["contact_radius_m"]
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
        yield from ran(self.file, found.frame) if self.file.sweeps else ()

    def tables(self, found: Solved) -> Iterator[SmallTable]:
        yield from tables_of(self.file, found.frame) if self.file.sweeps else ()
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
        from verification.cases.kinds import KINDS, SWEPT  # noqa: PLC0415 - loads matplotlib

        for kind in self.file.figures:
            name, *words = kind.split()
            draw = beside(self.file, name, KINDS | SWEPT)
            yield draw(self.file, found.frame, *words) if name not in KINDS else draw(found)

    def notes(self, found: Solved) -> tuple[str, ...]:
        return self.file.notes

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
    return {row.quantity: row.error for row in rows}
