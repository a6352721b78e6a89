# SPDX-License-Identifier: MIT
"""A case without code: one scene or variants of one, solved by the models that its file names, each held
against the reference, and SAM against finite elements. Everything that is shown follows from the vocabulary.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import reduce
from typing import Any

from sam.scene import Result, Scene
from verification.cases.case import (
    Case,
    Context,
    Plot,
    SmallTable,
    elastic_text,
    grid_text,
    mesh_text,
    with_keys,
)
from verification.cases.recipes import RECIPES
from verification.compare.comparison import compare_scene
from verification.quantities import QUANTITIES, Measured, Solved, of_passes
from verification.references import REFERENCES
from verification.rows import CaseFile, error_of, head_of, merged
from verification.runs.models import FEM, FEM_3D, SAM
from verification.text.console import number

MODELS = {"sam": SAM, "fem": FEM, "fem-3d": FEM_3D}


def scene_of(context: Context, file: CaseFile, *changes: Mapping[str, Any]) -> Scene:
    """The scene of a case at the level of the context, changed by a variant and a run of it: keys set, then
    recipes applied in their order.
    """
    quick = file.quick if context.level == "quick" else {}
    said = reduce(merged, ({"set": file.set, "vary": file.vary}, quick, *changes))
    scene = context.scene(file.scene)
    for key, value in said["set"].items():
        section, _, name = key.rpartition(".")
        scene = with_keys(scene, section, **{name: tuple(value) if isinstance(value, list) else value})
    for name, value in said["vary"].items():
        scene = RECIPES[name](scene, value)
    return scene


@dataclass(frozen=True)
class Compared(Case):
    """The case of a file with a scene. What was solved: variant -> results, "" where there are none."""

    file: CaseFile | None = None

    def solve(self, context: Context) -> dict[str, Solved]:
        asked = {head_of(table, self.file.variants)[0] for table in self.file.claims} | {*self.file.also}
        return {
            name: self._solved(context, name, self.file.variants.get(name, {}))
            for name in self.file.variants or [""]
            if name in asked
        }

    def _solved(self, context: Context, name: str, variant: Mapping[str, Any]) -> Solved:
        scene = scene_of(context, self.file, variant)
        reference, results = REFERENCES[self.file.reference](scene) if self.file.reference else None, {}
        for model in self.file.models:
            run = model.partition("-")[0]
            results[run] = context.solve(MODELS[model], scene, "-".join(filter(None, (name, run))))
        for run, said in ({} if "alone" in variant else self.file.runs | variant.get("runs", {})).items():
            other, label = scene_of(context, self.file, variant, said), "-".join(filter(None, (name, run)))
            results[run] = context.solve(MODELS[said["model"]], other, label, demand=False)
        return Solved(scene, reference, results)

    def measure(self, found: Mapping[str, Solved]) -> dict[str, Measured]:
        """The rows of the file: `sam/exact` and the like by the vocabulary, `sam/fem` by the rows of
        `compare` where that says nothing else.
        """
        values = {}
        for table, names in self.file.claims.items():
            variant, model, against = head_of(table, self.file.variants)
            solved, lead = found[variant], f"{variant}-" * bool(variant)
            for name in names:
                if against == "fem" or not model:
                    values[lead + name] = between(name, solved)
                else:
                    measured = QUANTITIES[name].against(name, solved.results[model], solved.reference)
                    alone = against == "bound"
                    values[f"{lead}{model}-{name}"] = Measured(measured.value) if alone else measured
        return values

    def setup(self, found: Mapping[str, Solved]) -> Iterator[tuple[str, str]]:
        first = next(iter(found.values()))
        scene, other, loading, units = first.scene, first.scene.counterbody, first.scene.loading, {}
        units = first.reference.units if first.reference else {}
        a = units.get("a") or first.results["sam"].quantities["contact_radius_m"]
        plasticity = scene.body.plasticity
        law = (
            f"; {plasticity.law}, {plasticity.curve().stress(0.0) / 1e6:.1f} MPa at first yield"
            if plasticity
            else ""
        )
        yield "Half-space", elastic_text(scene.body) + law
        if other:
            sizes = ("radius", "radius_x", "radius_y", "flat_radius")
            size = ", ".join(
                f"{n.replace('_', ' ')} {v * 1e6:g} µm" for n in sizes if (v := getattr(other, n))
            )
            yield other.shape.capitalize(), f"{size}, {elastic_text(other) if other.elastic else 'rigid'}"
        again = f", {loading.cycles} times" * (loading.cycles > 1)
        load = f"{loading.force:.5g} N" if other else f"given, {loading.p0 / 1e9:.4f} GPa in the centre"
        steps = f"{load} in {loading.steps} equal steps{', then unloaded' * loading.unload}{again}"
        yield "Force" if other else "Pressure", steps
        if loading.path:
            ends = " a to ".join(f"{end[0] / a:g}" for end in (loading.path.start, loading.path.end))
            yield "Way", f"from {ends} a along x in {loading.path.steps} steps"
        if self.file.variants:
            yield "Solved", "; ".join(self.file.variants[name]["words"] for name in found)
        if any(each.scene.friction for each in found.values()):
            yield "Traction", "full slip along +x on the body in every step"
        yield from first.reference.facts if first.reference else ()
        for run, result in [*first.results.items()][: len(self.file.models) or 1]:
            yield run.upper(), grid_text(result, a) if result.model == SAM else mesh_text(result)

    def tables(self, found: Mapping[str, Solved]) -> Iterator[SmallTable]:
        if [*found] == [""] and set(found[""].results) == {"sam", "fem"}:
            rows = _side_by_side(*found[""].results.values())
            yield SmallTable("Results", ("quantity", "SAM", "FEM", "difference"), rows)
            return
        also = {name: found[name] for name in self.file.also}
        yield _results("Results", self.file, {name: found[name] for name in found if name not in also})
        for name, solved in found.items():
            yield from _passes(self.file.variants[name]["words"] if name else "", solved.results)
        if also:
            yield _results("Refinement", self.file, also)
            yield _differences(self.file, found)

    def figures(self, found: Mapping[str, Solved]) -> Iterator[Plot]:
        from verification.cases.kinds import KINDS, OVER_VARIANTS  # noqa: PLC0415 - loads matplotlib

        words = {name: each["words"] for name, each in self.file.variants.items()}
        shown = {name: each for name, each in found.items() if name not in self.file.also}
        for kind in self.file.figures:
            if kind in OVER_VARIANTS:
                yield from OVER_VARIANTS[kind](shown, words)
                continue
            for name, solved in shown.items():
                plot = KINDS[kind](solved)
                if name:
                    plot = replace(plot, name=f"{plot.name}-{name}", title=f"{plot.title}, {words[name]}")
                yield plot


def between(name: str, solved: Solved) -> Measured:
    """A quantity of all runs of a scene, or of SAM against finite elements."""
    quantity = QUANTITIES[name]
    if quantity.whole:
        measured = quantity.whole(solved)
        return measured if isinstance(measured, Measured) else Measured(measured)
    pair = solved.results["sam"], solved.results["fem"]
    if quantity.between and (measured := quantity.between(solved.scene, *pair)):
        return measured
    rows = {row.quantity: row.difference for row in compare_scene(solved.scene, *pair)}
    return Measured(rows[quantity.row])


def _results(caption: str, file: CaseFile, found: Mapping[str, Solved]) -> SmallTable:
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
    return SmallTable(caption, (head or "variant", "model", *columns), rows)


def _passes(words: str, results: Mapping[str, Result]) -> Iterator[SmallTable]:
    """What each pass of a counter-body that moves does, in every run."""
    moving = {run: each for run, each in results.items() if "passes" in each.tables}
    for name, head, scale in (
        ("strain", "Largest strain that a pass adds [1e-3]", 1e3),
        ("energy", "Energy that a pass dissipates [nJ]", 1e9),
    ):
        rows = [
            (
                run,
                *(number(scale * v) for v in of_passes(each, name)),
                str((each.verdict or {}).get("class", "")),
            )
            for run, each in moving.items()
        ]
        if rows:
            passes = (f"pass {k + 1}" for k in range(len(rows[0]) - 2))
            yield SmallTable(f"{head}, {words}", ("run", *passes, "verdict"), rows)


def _differences(file: CaseFile, found: Mapping[str, Solved]) -> SmallTable:
    """What rows hold of one variant, in their metric, of every one."""
    metrics, of = {}, {row.id.partition(".")[2]: row.metric for row in file.rows}
    for table, names in file.claims.items():
        variant, model, against = head_of(table, file.variants)
        if against == "fem" or not model:
            metrics |= {name: of[f"{variant}-{name}"] for name in names}

    def error(name: str, solved: Solved) -> str:
        try:
            return number(error_of(metrics[name], between(name, solved)), 3)
        except (KeyError, ValueError):  # nothing of it in this variant
            return number(None)

    rows = [
        (file.variants[name]["words"], *(error(q, solved) for q in metrics)) for name, solved in found.items()
    ]
    return SmallTable("What rows hold, of every variant", ("", *(QUANTITIES[q].words for q in metrics)), rows)


def _side_by_side(sam: Result, fem: Result) -> list[tuple[str, ...]]:
    rows = []
    for quantity in QUANTITIES.values():
        values = [each.quantities.get(quantity.row) for each in (sam, fem)]
        if all(values):
            off = f"{1e2 * (values[0] / values[1] - 1.0):+.2f} %"
            words = f"{quantity.words} [{quantity.unit}]" if quantity.unit else quantity.words
            rows.append((words, *(number(value, 5) for value in values), off))
    return rows
