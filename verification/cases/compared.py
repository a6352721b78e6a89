# SPDX-License-Identifier: MIT
"""The case of a file: one scene or variants of one, solved by the models that the file names, each held
against the reference, and SAM against finite elements; and the points of its sweeps. What is shown follows
from the vocabulary.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import reduce
from numbers import Real
from typing import Any

import numpy as np

from sam.scene import Result, Scene, Section, unit_of_key, with_units
from verification.cases.case import Case, Context, Plot, SmallTable, View
from verification.cases.recipes import RECIPES, beside, changed
from verification.cases.sweep import MODELS, differences, framed, label_of, points, spelt, tables_of, taken
from verification.compare.measures import nodal_pressures
from verification.judging import Measured, relative_l2
from verification.quantities import QUANTITIES, Quantity, Reference, Solved, of_passes
from verification.references import REFERENCES
from verification.rows import CaseFile, merged
from verification.runs.models import SAM
from verification.text.console import number


def scene_of(context: Context, file: CaseFile, *changes: Mapping[str, Any]) -> Scene:
    """The scene of a case at this level, changed by a variant and a run: keys, then RECIPES in order."""
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
        file = self.file
        if not file.scene:
            return Solved(None, None, {}, framed(context, file, None))
        scene, results = scene_of(context, file, variant), {}
        answer = beside(file, file.reference, REFERENCES)(scene) if file.reference else None
        given = Reference(file.values, {}) if file.values else None
        models = {model.partition("-")[0]: MODELS[model] for model in file.models}
        for run, model in models.items():
            results[run] = context.solve(model, scene, "-".join(filter(None, (name, run))))
        for run, said in (file.runs | variant.get("runs", {})).items():
            other, label = scene_of(context, file, variant, said), "-".join(filter(None, (name, run)))
            results[run] = context.solve(MODELS[said["model"]], other, label, demand=False)
        frame = framed(context, file, scene) if file.taken else None
        found = Solved(scene, answer or given, results, frame)
        if not file.allowance:
            return found
        coarse = scene_of(context, file, {"vary": {"resolution": file.coarser}})
        cell, larger = (each.grid.extent[0] / each.grid.cells[0] for each in (scene, coarse))
        ratios = larger / cell, scene.fem.cells_per_radius / coarse.fem.cells_per_radius
        before = [context.solve(model, coarse, f"{run}-coarser") for run, model in models.items()]
        return replace(found, coarser=tuple(zip(before, ratios, strict=True)))

    def ahead(self, context: Context) -> Iterator[Scene]:
        """Of the sweeps."""
        sweeps = [sweep for sweep in self.file.sweeps.values() if "sam" in sweep.models]
        base = scene_of(context, self.file) if sweeps else None
        for sweep in sweeps:
            yield from (changed(base, changes, self.file) for _, changes in points(sweep, context.level))

    def scenes(self, context: Context) -> Iterator[Scene]:
        """All that the file has solved at this level. Raises SceneError: a key that makes none."""
        file = self.file
        for variant in file.variants.values() or ({},):
            yield scene_of(context, file, variant)
            yield from (
                scene_of(context, file, variant, said)
                for said in (file.runs | variant.get("runs", {})).values()
            )
        for sweep in file.sweeps.values():
            for _, changes in points(sweep, context.level):
                yield changed(scene_of(context, file), changes, file)

    def measure(self, found: Mapping[str, Solved]) -> dict[str, Measured]:
        """The rows of the file: by the vocabulary, by what is between both or all runs, and of the sweeps."""
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
            elif quantity.whole:
                whole = quantity.whole(solved)
                measured = whole if isinstance(whole, Measured) else Measured(whole)
            elif quantity.between and not (quantity.row and claim.row.metric == "at_most"):
                measured = quantity.between(solved.scene, solved.results["sam"], solved.results["fem"])
            else:
                measured = Measured(differences(solved)[quantity.row])
            values[claim.name] = measured
        return values

    def setup(self, found: Mapping[str, Solved]) -> Iterator[tuple[str, str]]:
        """The keys of the scene, what the reference says of it, and the discretisation."""
        yield from self.file.setting
        first = next(iter(found.values()))
        if first.scene is None:
            return
        scene = first.scene if first.results else first.frame["scene"].iloc[0]
        for name in ("body", "counterbody", "loading", "friction"):
            if (section := getattr(scene, name)) is not None:
                yield name.capitalize(), keys_of(section)
        if self.file.variants:
            yield "Variants", "; ".join(self.file.variants[name]["words"] for name in found)
        if first.reference:
            known = {**first.reference.units, **first.reference.values}
            numbers = (f"{name} = {value:.5g}" for name, value in known.items() if isinstance(value, Real))
            yield "reference, SI", ", ".join(numbers)
        for run, result in [*first.results.items()][: len(self.file.models) or 1]:
            size = result.discretisation
            cells = f"{size['cells'][0]} × {size['cells'][1]} cells" if result.model == SAM else ""
            if cells and (cell := size.get("cell_m")):
                cells += f" of {1e9 * cell[0]:.1f} nm"
            yield run.upper(), cells or f"{size['elements']} elements, {size['dofs']} degrees of freedom"
        for name, sweep in self.file.sweeps.items():
            rows = first.frame[first.frame["sweep"] == name]
            axes = (f"{axis} {', '.join(dict.fromkeys(map(spelt, rows[axis])))}" for axis in sweep.axes)
            yield f"Points, {', '.join(map(str.upper, sweep.models))}", "; ".join(axes)

    def tables(self, found: Mapping[str, Solved]) -> Iterator[SmallTable]:
        words = {name: self.file.variants[name]["words"] if name else "" for name in found}
        for name, solved in found.items():
            if solved.frame is not None:
                yield from (beside(self.file, table, {})(solved.frame) for table in self.file.tables)
                yield from tables_of(self.file, solved.frame)
            if len(solved.results) > 1:
                yield _results(words[name], self.file, solved)
                yield from _passes(words[name], solved.results)
        if self.file.allowance:
            named = [QUANTITIES[name] for name in self.file.allowance]
            rows = [(q.words, *(f"{1e2 * share:.2f} %" for share in refinement(found[""], q))) for q in named]
            columns = "quantity", "uncertainty of SAM", "of FEM", "difference", "largest of 1 % and their sum"
            yield SmallTable("Refinement uncertainties", columns, rows)

    def data(self, found: Mapping[str, Solved]) -> dict[str, Any]:
        """Under `pairs` SAM beside FEM, of variants the largest values; and what the file hands on."""
        pairs: list[tuple[str, float, float]] = []
        handed = beside(self.file, self.file.data, {})(found[""].frame) if self.file.data else {}
        for name, solved in found.items():
            if {"sam", "fem"} <= set(solved.results):
                said = f" ({self.file.variants[name]['words']})" if name else ""
                for words, values in _in_words([solved.results[run] for run in ("sam", "fem")]):
                    where = words.startswith("depth of")  # a place, which the mesh decides
                    if all(values) and (words.startswith("largest ") or not (name or where)):
                        pairs.append((words + said, *values))
        return {"pairs": pairs} | handed

    def figures(self, found: Mapping[str, Solved]) -> Iterator[Plot]:
        from verification.cases.kinds import KINDS, OVER_VARIANTS, SWEPT, of_kind  # noqa: PLC0415 - loads matplotlib

        words = {name: each["words"] for name, each in self.file.variants.items()}
        for kind in self.file.figures:
            if kind in OVER_VARIANTS:
                yield from OVER_VARIANTS[kind](self.file, found)
                continue
            first, *more = kind.split()
            draw = beside(self.file, first, KINDS | SWEPT)
            for name, solved in found.items():
                plot = of_kind(first, solved) if first in KINDS else draw(self.file, solved.frame, *more)
                if plot is None:  # too few points at this level
                    continue
                if name:
                    plot = replace(plot, name=f"{plot.name}-{name}", title=f"{plot.title}, {words[name]}")
                yield replace(plot, caption=self.file.captions.get(plot.name, plot.caption))

    def views(self, found: Mapping[str, Solved]) -> Iterator[View]:
        from verification.cases.kinds import VIEWS  # noqa: PLC0415 - loads matplotlib

        yield from (VIEWS[name] for name in self.file.views)


def keys_of(section: Section, above: str = "") -> str:
    """Keys and values of a table of a scene that are not left at their defaults, numbers with their unit."""
    said = []
    for name in sorted(section.model_fields_set, key=list(type(section).model_fields).index):
        value = getattr(section, name)
        if isinstance(value, Section):
            said.append(keys_of(value, f"{above}{name}."))
        elif value is not None and value != type(section).model_fields[name].default:
            shown = spelt(value) if isinstance(value, str | float | tuple) else str(value).lower()
            if unit := unit_of_key(type(section), name):
                alone = isinstance(value, float)
                shown = with_units(float(f"{value:.6g}"), unit) if alone else f"{shown} {unit}"
            said.append(f"{above}{name} = {shown}".replace(" um", " µm"))
    return ", ".join(filter(None, said))


def refinement(found: Solved, quantity: Quantity) -> tuple[float, float, float, float]:
    """Refinement uncertainties of SAM and FEM, their difference, and what is allowed: 1 %, or both
    uncertainties where that is more. Uncertainty: change from a coarser grid over (ratio - 1), the rest of a
    first-order error (Roache, Verification and Validation in Computational Science and Engineering, 1998, Eq.
    5.10.5.1 without its factor of safety). Fields in the L2 norm, over that of FEM.
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


def _in_words(results: list[Result]) -> Iterator[tuple[str, list[float]]]:
    """The quantities that one of the results has, in words, with their values."""
    for quantity in QUANTITIES.values():
        values = [each.quantities.get(quantity.row) for each in results]
        if any(value is not None for value in values):
            yield f"{quantity.words} [{quantity.unit}]" if quantity.unit else quantity.words, values


def _results(words: str, file: CaseFile, solved: Solved) -> SmallTable:
    """The quantities of every run; of one of each model their difference, and beside a decoupled one how far
    the pressure is off that of FEM, and where it acts.
    """
    rows, results = [], solved.results
    for quantity, values in _in_words(list(results.values())):
        apart = [f"{1e2 * (values[0] / values[1] - 1.0):+.2f} %" if all(values) else ""] * (len(values) == 2)
        rows.append((quantity, *(number(value, 5) for value in values), *apart))
    if "decoupled" in results:
        fem, a = results["fem"], solved.reference.units["a"]
        others = (None if each is fem else nodal_pressures(each, fem) for each in results.values())
        off = (number(each and 1e2 * relative_l2(*each), 3) for each in others)
        at = (number(each.quantities["pressure_centroid_x_m"] / a, 3) for each in results.values())
        rows += [("deviation of the pressure from FEM (L2 at the nodes of FEM) [%]", *off)]
        rows += [("centre of pressure [a]", *at)]
    heads = [label_of(file, "run", name) for name in results]
    caption = ", ".join(filter(None, ("Results", words)))
    return SmallTable(caption, ("quantity", *heads, *["difference"] * (len(heads) == 2)), rows)


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
