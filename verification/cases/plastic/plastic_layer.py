# SPDX-License-Identifier: MIT
"""A sphere on a body with a layer that hardens by a law of its own: SAM against FEM in the layer and below
it, and a layer of the same law as the body.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from sam.scene import Plasticity, Result, Scene
from verification.cases.case import (
    FEM,
    SAM,
    Case,
    Context,
    Measured,
    Plot,
    SmallTable,
    grid_text,
    mesh_text,
    off_text,
    with_grid,
    with_keys,
    with_loading,
    with_mesh,
)
from verification.figures.plastic import axis_profiles, compared_peeq
from verification.references import contact_of
from verification.runs.sampling import peak

MODELS = {SAM: "sam", FEM: "fem"}
CELLS, ELEMENTS, STEPS = (17, 17), 8, 2  # of the layer of the same law, where every bit counts at any grid
SHOWN = {"layer": "in the layer", "below": "below it"}


@dataclass(frozen=True)
class LayerResults:
    """scene; found: model -> result; strains: model -> region -> largest plastic strain; changed: model ->
    how many columns a layer of the body's own law changes.
    """

    scene: Scene
    found: Mapping[str, Result]
    strains: Mapping[str, Mapping[str, float]]
    changed: Mapping[str, int]


@dataclass(frozen=True)
class LayeredSphere(Case):
    """One law of the layer. law: its keys, None takes those of the scene."""

    law: Mapping[str, str | float] | None = None

    def solve(self, context: Context) -> LayerResults:
        scene = context.scene("plastic-layer")
        if self.law is not None:
            scene = with_layer(scene, self.law)
        found = {model: context.solve(model, scene, name) for model, name in MODELS.items()}
        thickness = scene.body.plasticity.layer_thickness
        strains = {model: largest_strains(result, thickness) for model, result in found.items()}
        changed = {model: self._changed(context, scene, model) for model in MODELS}
        return LayerResults(scene, found, strains, changed)

    def _changed(self, context: Context, scene: Scene, model: str) -> int:
        """Columns of a small solve that a layer of the body's own law changes."""
        plain = with_keys(scene, "body.plasticity", layer=None)
        plain = with_loading(with_mesh(with_grid(plain, cells=CELLS), ELEMENTS), steps=STEPS)
        own = with_layer(plain, law_of(plain.body.plasticity))
        name = MODELS[model]
        return columns_changed(
            context.solve(model, plain, f"{name}-plain"), context.solve(model, own, f"{name}-same-law")
        )

    def measure(self, found: LayerResults) -> dict[str, Measured | float]:
        own, other = (found.strains[model] for model in MODELS)
        values: dict[str, Measured | float] = {
            f"strain-{part}": Measured(own[part], other[part]) for part in SHOWN
        }
        sam, fem = (found.found[model].quantities for model in MODELS)
        for gate, name, unit in (("p-max", "p_max_Pa", "Pa"), ("approach", "approach_m", "m")):
            values[gate] = Measured(sam[name], fem[name], unit=unit)
        return values | {
            f"same-law-{MODELS[model]}": Measured(float(count), 0.0) for model, count in found.changed.items()
        }

    def setup(self, found: LayerResults) -> list[tuple[str, str]]:
        scene, elastic = found.scene, contact_of(found.scene)
        plasticity, a = scene.body.plasticity, elastic.contact_radius
        share = plasticity.layer_thickness / a
        return [
            ("Body", law_text(plasticity)),
            (
                "Layer",
                f"{law_text(plasticity.layer)}, {plasticity.layer_thickness * 1e6:g} µm ({share:.2f} a)",
            ),
            ("Force", f"{scene.loading.force:g} N in {scene.loading.steps} steps"),
            ("Elastic contact (a, p₀)", f"{a * 1e6:.4f} µm, {elastic.peak_pressure / 1e9:.4f} GPa"),
            ("SAM", grid_text(found.found[SAM], a)),
            ("FEM", mesh_text(found.found[FEM])),
        ]

    def tables(self, found: LayerResults) -> Iterator[SmallTable]:
        own, other = (found.strains[model] for model in MODELS)
        rows = [
            (
                words,
                f"{1e2 * own[part]:.4f} %",
                f"{1e2 * other[part]:.4f} %",
                off_text(own[part], other[part]),
            )
            for part, words in SHOWN.items()
        ]
        yield SmallTable("Largest plastic strain", ("where", "SAM", "FEM", "difference"), rows)

    def figures(self, found: LayerResults) -> list[Plot]:
        sam, fem = (found.found[model] for model in MODELS)
        a = contact_of(found.scene).contact_radius
        return [
            Plot(
                compared_peeq(sam, fem, a),
                "peeq-maps",
                "Plastic strain in the plane y = 0",
                "Three maps of the accumulated plastic strain over x/a and z/a, which jumps at the lower "
                "side of the layer: SAM, FEM and their difference.",
                "FEM is linear between its Gauss points, also across the jump.",
            ),
            Plot(
                axis_profiles(sam, fem, a),
                "axis",
                "Under the centre",
                "Curves over depth of the plastic strain and von Mises stress, SAM on the curves of FEM, "
                "with a jump at the lower side of the layer.",
                "On the axis r = 0. Underneath: SAM minus FEM in % of the largest value of FEM.",
            ),
        ]


def law_of(plasticity: Plasticity) -> dict[str, str | float]:
    """The hardening law of the body, as keys of a layer."""
    layer = set(type(plasticity).model_fields) - {"profile", "layer_thickness", "layer"}
    return plasticity.model_dump(include=layer, exclude_none=True)


def with_layer(scene: Scene, law: Mapping[str, str | float]) -> Scene:
    """The scene with another law of its layer."""
    content = scene.body.plasticity.model_dump() | {"layer": dict(law)}
    return scene.model_copy(
        update={"body": scene.body.model_copy(update={"plasticity": Plasticity(**content)})}
    )


def law_text(law: Plasticity) -> str:
    """The law and its constants for the reader."""
    keys = law_of(law) if isinstance(law, Plasticity) else law.model_dump(exclude_none=True)
    return ", ".join(f"{key} = {value:.4g}" if key != "law" else str(value) for key, value in keys.items())


def largest_strains(result: Result, thickness: float) -> dict[str, float]:
    """The largest plastic strain of the cells or Gauss points in y = 0 in the layer and below it."""
    z, peeq = peak(result.tables["plane"], "z_m", "peeq")
    return {"layer": float(peeq[z < thickness].max()), "below": float(peeq[z >= thickness].max())}


def columns_changed(one: Result, other: Result) -> int:
    """How many columns of two results differ in any digit; repr, as a value that there is none of is NaN."""
    return sum(
        repr(np.asarray(one.tables[table][name]).tolist())
        != repr(np.asarray(other.tables[table][name]).tolist())
        for table in one.tables
        for name in one.tables[table]
    )


LINEAR = {"law": "linear", "yield_stress": 2.2e9, "modulus": 20e9}
CASES = tuple(
    LayeredSphere(f"plastic-layer-{name}", law=law)
    for name, words, law in (
        ("swift", "Swift, nearly without hardening", None),
        ("linear", "linear hardening on a Swift body", LINEAR),
    )
)
