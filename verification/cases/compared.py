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
    with_keys,
)
from verification.cases.recipes import RECIPES
from verification.compare.comparison import compare_scene
from verification.quantities import QUANTITIES, Measured, Solved
from verification.references import REFERENCES
from verification.rows import CaseFile
from verification.runs.models import FEM, FEM_3D, SAM
from verification.text.console import number

MODELS = {"sam": SAM, "fem": FEM, "fem-3d": FEM_3D}


def scene_of(context: Context, file: CaseFile) -> Scene:
    """The scene of a case at the level of the context: keys set, then recipes applied in their order."""
    changed = file.quick if context.level == "quick" else {}
    scene = context.scene(file.scene)
    for key, value in (file.set | changed.get("set", {})).items():
        section, _, name = key.rpartition(".")
        scene = with_keys(scene, section, **{name: tuple(value) if isinstance(value, list) else value})
    for name, value in (file.vary | changed.get("vary", {})).items():
        scene = RECIPES[name](scene, value)
    return scene


@dataclass(frozen=True)
class Compared(Case):
    """The case of a file with a scene."""

    file: CaseFile | None = None

    def solve(self, context: Context) -> Solved:
        scene = scene_of(context, self.file)
        reference = REFERENCES[self.file.reference](scene) if self.file.reference else None
        results = {run: context.solve(MODELS[run], scene, run.partition("-")[0]) for run in self.file.models}
        return Solved(scene, reference, {run.partition("-")[0]: each for run, each in results.items()})

    def measure(self, found: Solved) -> dict[str, Measured]:
        """The rows of the file: `sam/exact` and the like by the vocabulary, `sam/fem` by the rows of
        `compare`.
        """
        values, difference = {}, None
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

    def figures(self, found: Solved) -> Iterator[Plot]:
        from verification.cases.kinds import KINDS  # noqa: PLC0415 - loads matplotlib

        for kind in self.file.figures:
            yield KINDS[kind](found)


def rows_of_compare(found: Solved) -> dict[str, Any]:
    """Name of a row of `compare` -> the difference of both models."""
    rows = compare_scene(found.scene, *found.results.values())
    return {row.quantity: row.difference for row in rows}
