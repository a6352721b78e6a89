# SPDX-License-Identifier: MIT
"""A case without code: one scene or variants of one, solved by the models that its file names, each held
against the reference, and SAM against finite elements; and the points of its sweeps. Everything that is shown
follows from the vocabulary.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import reduce
from typing import Any

import numpy as np

from sam.scene import Result, Scene
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
from verification.quantities import QUANTITIES, Quantity, Reference, Solved, of_passes
from verification.references import REFERENCES
from verification.rows import CaseFile, merged
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


def scene_of(context: Context, file: CaseFile, *changes: Mapping[str, Any]) -> Scene:
    """The scene of a case at the level of the context, changed by a variant and a run of it: keys set, then
    recipes applied in the order of RECIPES.
    """
    quick = file.quick if context.level == "quick" else {}
    said = reduce(merged, ({"set": file.set, "vary": file.vary}, quick, *changes))
    place = str(file.path.parent / file.scene) if file.scene.endswith(".toml") else file.scene
    order = list(RECIPES)
    recipes = sorted(said["vary"], key=lambda name: order.index(name) if name in order else len(order))
    return changed(context.scene(place), {**said["set"], **{n: said["vary"][n] for n in recipes}}, file)


@dataclass(frozen=True)
class Compared(Case):
    """The case of a file with a scene. What was solved: variant -> results, "" where there are none."""

    def solve(self, context: Context) -> dict[str, Solved]:
        asked = {claim.variant for claim in self.file.claims}
        return {
            name: self._solved(context, name, self.file.variants.get(name, {}))
            for name in self.file.variants or [""]
            if name in asked
        }

    def _solved(self, context: Context, name: str, variant: Mapping[str, Any]) -> Solved:
        if not self.file.scene:
            return Solved(None, None, {}, framed(context, self.file, None))
        file, scene = self.file, scene_of(context, self.file, variant)
        answer = beside(file, file.reference, REFERENCES) if file.reference else None
        given, results = Reference(file.values, {}) if file.values else None, {}
        models = {model.partition("-")[0]: MODELS[model] for model in file.models}
        for run, model in models.items():
            results[run] = context.solve(model, scene, "-".join(filter(None, (name, run))))
        for run, said in (file.runs | variant.get("runs", {})).items():
            other, label = scene_of(context, file, variant, said), "-".join(filter(None, (name, run)))
            results[run] = context.solve(MODELS[said["model"]], other, label, demand=False)
        frame = framed(context, file, scene) if file.taken else None
        found = Solved(scene, answer(scene) if answer else given, results, frame)
        if not file.allowance:
            return found
        coarse = scene_of(context, file, {"vary": {"resolution": file.coarser}})
        cell, larger = (each.grid.extent[0] / each.grid.cells[0] for each in (scene, coarse))
        ratios = larger / cell, scene.fem.cells_per_radius / coarse.fem.cells_per_radius
        before = [context.solve(model, coarse, f"{run}-coarser") for run, model in models.items()]
        return replace(found, coarser=tuple(zip(before, ratios, strict=True)))

    def ahead(self, context: Context) -> Iterator[Scene]:
        """Of the sweeps; of a frame what a function `scenes` beside the file says, if there is one."""
        if self.file.frame:
            yield from beside(self.file, "scenes", {"scenes": lambda _: ()})(context)
            return
        sweeps = [sweep for sweep in self.file.sweeps.values() if "sam" in sweep.models]
        base = scene_of(context, self.file) if sweeps else None
        for sweep in sweeps:
            yield from (changed(base, changes, self.file) for _, changes in points(sweep, context.level))

    def measure(self, found: Mapping[str, Solved]) -> dict[str, Measured]:
        """The rows of the file: `sam/exact` and the like by the vocabulary; `sam/fem`, and what is said of
        both models, by what is between them, where only the difference is held by the rows of `compare`; and
        what they take of the sweeps.
        """
        values: dict[str, Measured] = {}
        for claim in self.file.claims:
            solved, quantity = found[claim.variant], QUANTITIES.get(claim.quantity)
            if claim.take:
                measured = taken(self.file, solved.frame, claim)
            elif claim.model and claim.against != "fem":
                result = solved.results[claim.model]
                measured = quantity.against(claim.quantity, result, solved.reference)
                measured = Measured(measured.value) if claim.against == "bound" else measured
            elif claim.quantity in self.file.allowance:
                *_, apart, allowed = refinement(solved, quantity)
                measured = Measured(apart / allowed)
            else:
                measured = between(quantity, solved, claim.row.metric)
            values[claim.name] = measured
        return values

    def setup(self, found: Mapping[str, Solved]) -> Iterator[tuple[str, str]]:
        yield from self.file.setting
        first = next(iter(found.values()))
        if first.scene is None:
            return
        scenes = [first.scene] if first.results else list(first.frame["scene"])
        scene, other, loading = scenes[0], scenes[0].counterbody, scenes[0].loading
        units = first.reference.units if first.reference else {}
        solved = first.results.get("sam")
        a = units.get("a") or loading.radius or (solved and solved.quantities["contact_radius_m"]) or math.nan
        plasticity = scene.body.plasticity
        law = (
            f"; {plasticity.law}, {plasticity.curve().stress(0.0) / 1e6:.1f} MPa at first yield"
            if plasticity
            else ""
        )
        yield "Half-space", elastic_text(scene.body) + law
        if film := scene.body.coating:
            yield "Film", f"{elastic_text(film)}, {1e9 * film.thickness:.4g} nm"
        if other:
            sizes = ("radius", "radius_x", "radius_y", "flat_radius")
            size = "".join(
                f"{n.replace('_', ' ')} {v * 1e6:g} µm, " for n in sizes if (v := getattr(other, n))
            )
            yield other.shape.capitalize(), f"{size}{elastic_text(other) if other.elastic else 'rigid'}"
        again = f", {loading.cycles} times" * (loading.cycles > 1)
        forces = sorted({each.loading.force for each in scenes} - {None})
        if loading.misfit:
            load = f"a sphere that grows, e = {loading.misfit:g} in its centre, radius {1e6 * a:g} µm"
        elif other:
            load = f"{' to '.join(f'{force:.5g}' for force in forces[:: max(1, len(forces) - 1)])} N"
        else:
            load = f"given, {loading.p0 / 1e9:.4f} GPa in the centre"
        steps = f"{load} in {loading.steps} equal steps{', then unloaded' * loading.unload}{again}"
        yield "Force" if other else "Load", steps
        if loading.path:
            ends = " a to ".join(f"{end[0] / a:g}" for end in (loading.path.start, loading.path.end))
            yield "Way", f"from {ends} a along x in {loading.path.steps} steps"
        if self.file.variants:
            yield "Solved", "; ".join(self.file.variants[name]["words"] for name in found)
        if any(each.scene.friction for each in found.values()):
            mu = f"μ = {scene.coefficient:g}; " if scene.friction and scene.friction.law == "constant" else ""
            yield "Traction", f"{mu}full slip along +x on the body in every step"
        yield from first.reference.facts if first.reference else ()
        for run, result in [*first.results.items()][: len(self.file.models) or 1]:
            yield run.upper(), grid_text(result, a) if result.model == SAM else mesh_text(result)
        yield from ran(self.file, first.frame) if self.file.sweeps else ()

    def tables(self, found: Mapping[str, Solved]) -> Iterator[SmallTable]:
        if self.file.variants or self.file.runs:
            yield _results(self.file, found)
            for name, solved in found.items():
                yield from _passes(self.file.variants[name]["words"] if name else "", solved.results)
            return
        solved = found[""]
        yield from (beside(self.file, name, {})(solved.frame) for name in self.file.tables)
        yield from tables_of(self.file, solved.frame) if self.file.taken else ()
        if set(solved.results) != {"sam", "fem"}:
            return
        both = beside_each_other(*solved.results.values())
        rows = [(q, number(a, 5), number(b, 5), f"{1e2 * (a / b - 1.0):+.2f} %") for q, a, b in both]
        yield SmallTable("Results", ("quantity", "SAM", "FEM", "difference"), rows)
        costs = [each.cost for each in solved.results.values()]
        rows = [(words, *(number(cost.get(n), 3) for cost in costs)) for n, words in COUNTED.items()]
        yield SmallTable("Cost", ("counter", "SAM", "FEM"), rows)
        if self.file.allowance:
            named = [QUANTITIES[name] for name in self.file.allowance]
            rows = [(q.words, *(f"{1e2 * share:.2f} %" for share in refinement(solved, q))) for q in named]
            columns = "quantity", "uncertainty of SAM", "of FEM", "difference", "largest of 1 % and their sum"
            yield SmallTable("Refinement uncertainties", columns, rows)

    def data(self, found: Mapping[str, Solved]) -> dict[str, Any]:
        """Under `pairs` each quantity of SAM beside that of FEM, of variants the largest values; and what the
        file hands on of its frame.
        """
        pairs: list[tuple[str, float, float]] = []
        handed = beside(self.file, self.file.data, {})(found[""].frame) if self.file.data else {}
        for name, solved in found.items():
            if {"sam", "fem"} <= set(solved.results):
                said = f" ({self.file.variants[name]['words'].replace('mu = ', 'μ = ')})" if name else ""
                for words, sam, fem in beside_each_other(*(solved.results[run] for run in ("sam", "fem"))):
                    where = words.startswith("depth of")  # a place, which the mesh decides
                    if words.startswith("largest ") or not (name or where):
                        pairs.append((words + said, sam, fem))
        return {"pairs": pairs} | handed

    def figures(self, found: Mapping[str, Solved]) -> Iterator[Plot]:
        from verification.cases.kinds import KINDS, OVER_VARIANTS, SWEPT  # noqa: PLC0415 - loads matplotlib

        words = {name: each["words"] for name, each in self.file.variants.items()}
        for kind in self.file.figures:
            if kind in OVER_VARIANTS:
                yield from OVER_VARIANTS[kind](found, words)
                continue
            first, *more = kind.split()
            draw = beside(self.file, first, KINDS | SWEPT)
            for name, solved in found.items():
                plot = draw(solved) if first in KINDS else draw(self.file, solved.frame, *more)
                if plot is None:  # too few points at this level
                    continue
                if name:
                    plot = replace(plot, name=f"{plot.name}-{name}", title=f"{plot.title}, {words[name]}")
                yield plot

    def views(self, found: Mapping[str, Solved]) -> Iterator[View]:
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


def between(quantity: Quantity, solved: Solved, metric: str) -> Measured:
    """A quantity of all runs of a scene, or of SAM against finite elements."""
    if quantity.whole:
        measured = quantity.whole(solved)
        return measured if isinstance(measured, Measured) else Measured(measured)
    pair = solved.results["sam"], solved.results["fem"]
    by_row = quantity.row and metric == "at_most"
    if quantity.between and not by_row:
        return quantity.between(solved.scene, *pair)
    rows = {row.quantity: row.error for row in compare_scene(solved.scene, *pair)}
    return Measured(rows[quantity.row])


def _results(file: CaseFile, found: Mapping[str, Solved]) -> SmallTable:
    """The quantities of every run."""
    runs = [(name, run, each) for name, solved in found.items() for run, each in solved.results.items()]
    shown = [
        q for q in QUANTITIES.values() if any(each.quantities.get(q.row) is not None for *_, each in runs)
    ]
    words = [file.variants[name]["words"].replace("mu = ", "μ = ") if name else "" for name in found]
    heads = {each.rpartition(" = ")[0] for each in words}
    said = {n: w.rpartition(" = ")[2] if len(heads) == 1 else w for n, w in zip(found, words, strict=True)}
    rows = [
        (
            said[name],
            run.upper() if run in ("sam", "fem") else f"{'SAM' if each.model == SAM else 'FEM'}, {run}",
            *(number(each.quantities.get(q.row), 5) for q in shown),
        )
        for name, run, each in runs
    ]
    columns = (f"{q.words} [{q.unit}]" if q.unit else q.words for q in shown)
    head = heads.pop() if len(heads) == 1 else ""
    return SmallTable("Results", (head or "variant", "model", *columns), rows)


def _passes(words: str, results: Mapping[str, Result]) -> Iterator[SmallTable]:
    """What each pass of a counter-body that moves does, in runs that end with the cells in a radius."""
    moving = {run: each for run, each in results.items() if {"passes", "cycles"} <= set(each.tables)}
    for name, head, scale in (
        ("strain", "Largest strain that a pass adds [1e-3]", 1e3),
        ("energy", "Energy that a pass dissipates [nJ]", 1e9),
    ):
        rows = [
            (
                "SAM" if each.model == SAM else "finite elements",
                run.rpartition("-")[2],
                *(number(scale * value) for value in of_passes(each, name)),
                str((each.verdict or {}).get("class", "")),
            )
            for run, each in moving.items()
        ]
        if rows:
            passes = (f"pass {k + 1}" for k in range(len(rows[0]) - 3))
            yield SmallTable(f"{head}, {words}", ("model", "in a", *passes, "verdict"), rows)


def beside_each_other(sam: Result, fem: Result) -> Iterator[tuple[str, float, float]]:
    """The quantities that both results have and that are not zero, in words."""
    for quantity in QUANTITIES.values():
        values = [each.quantities.get(quantity.row) for each in (sam, fem)]
        if all(values):
            yield f"{quantity.words} [{quantity.unit}]" if quantity.unit else quantity.words, *values
