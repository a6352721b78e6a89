# SPDX-License-Identifier: MIT
"""A case without code: one scene, solved by the models that its file names, each held against the
reference, and SAM against finite elements. Everything that is shown follows from the vocabulary.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from sam.scene import Scene
from verification.cases.case import (
    Case,
    Context,
    Plot,
    SmallTable,
    elastic_text,
    grid_text,
    mesh_text,
)
from verification.cases.recipes import beside, changed
from verification.cases.sweep import MODELS, framed, points, ran, tables_of, taken
from verification.compare.comparison import compare_scene
from verification.judging import Measured
from verification.quantities import QUANTITIES, Reference, Solved
from verification.references import REFERENCES
from verification.rows import CaseFile
from verification.runs.models import SAM
from verification.text.console import number


def scene_of(context: Context, file: CaseFile) -> Scene:
    """The scene of a case at the level of the context: keys set, then recipes applied."""
    quick = file.quick if context.level == "quick" else {}
    place = str(file.path.parent / file.scene) if file.scene.endswith(".toml") else file.scene
    changes = file.set | quick.get("set", {}) | file.vary | quick.get("vary", {})
    return changed(context.scene(place), changes, file)


@dataclass(frozen=True)
class Compared(Case):
    """The case of a file with a scene."""

    def solve(self, context: Context) -> Solved:
        scene = scene_of(context, self.file)
        answer = beside(self.file, self.file.reference, REFERENCES) if self.file.reference else None
        runs = {run.partition("-")[0]: MODELS[run] for run in self.file.models}
        results = {run: context.solve(model, scene, run) for run, model in runs.items()}
        frame = framed(context, self.file, scene) if self.file.sweeps else None
        given = Reference(self.file.values, {}) if self.file.values else None
        return Solved(scene, answer(scene) if answer else given, results, frame)

    def ahead(self, context: Context) -> Iterator[Scene]:
        sweeps = [sweep for sweep in self.file.sweeps.values() if "sam" in sweep.models]
        base = scene_of(context, self.file) if sweeps else None
        for sweep in sweeps:
            yield from (changed(base, changes, self.file) for _, changes in points(sweep, context.level))

    def measure(self, found: Solved) -> dict[str, Measured]:
        """The rows of the file: `sam/exact` and the like by the vocabulary, `sam/fem` by the rows of
        `compare`, and what they take of the sweeps.
        """
        values, difference = taken(self.file, found.frame) if self.file.sweeps else {}, None
        for table, names in self.file.claims.items():
            model, against = table.split("/")
            for name in names:
                quantity = QUANTITIES[name]
                if against != "fem":
                    measured = quantity.against(name, found.results[model], found.reference)
                    alone = against == "bound"
                    values[f"{model}-{name}"] = Measured(measured.value) if alone else measured
                elif quantity.between:
                    values[name] = quantity.between(found.scene, *found.results.values())
                else:
                    difference = difference or rows_of_compare(found)
                    values[name] = Measured(difference[quantity.row])
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

    def figures(self, found: Solved) -> Iterator[Plot]:
        from verification.cases.kinds import KINDS, SWEPT  # noqa: PLC0415 - loads matplotlib

        for kind in self.file.figures:
            name, *words = kind.split()
            draw = beside(self.file, name, KINDS | SWEPT)
            yield draw(self.file, found.frame, *words) if name not in KINDS else draw(found)

    def notes(self, found: Solved) -> tuple[str, ...]:
        return self.file.notes


def rows_of_compare(found: Solved) -> dict[str, Any]:
    """Name of a row of `compare` -> the difference of both models."""
    rows = compare_scene(found.scene, *found.results.values())
    return {row.quantity: row.error for row in rows}
