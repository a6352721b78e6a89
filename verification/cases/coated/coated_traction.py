# SPDX-License-Identifier: MIT
"""Hertz pressure and traction given on a coated body, no contact searched: both solvers at the faces of the
film, in closed form.

With high friction the largest von Mises stresses lie at faces: of the film at its surface, of the body where
it meets the film. A model that is read short of the faces, at the centres of its elements say, misses them by
percents however fine it is inside.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from sam.scene import Friction, Loading, Result, Scene
from verification.cases.case import (
    FEM_3D,
    SAM,
    Case,
    Context,
    Measured,
    SmallTable,
    elastic_text,
    grid_text,
    mesh_text,
    number,
    off_text,
    with_grid,
    with_keys,
)
from verification.cases.coated.coated_sliding import FILM_SIDE
from verification.reference.coated_changes import LargestChange
from verification.reference.coated_traction import coated_sliding_stress, largest_von_mises
from verification.reference.layered_axisymmetric import CoatedHalfSpace
from verification.reference.stress import von_mises
from verification.references import contact_of
from verification.runs.sampling import plane_field

SCENE = "coated-sliding"
FRICTION, THICKNESS = 0.4, 0.1
"""The thickness in contact radii: the largest stress of the body is at the interface, below the trailing half
of the contact.
"""
CELLS, ELEMENTS, BOX = 24, 6, 6.0
"""Cells (SAM) and elements (FEM) in the contact radius; half side of the block of FEM in that."""
REACH = 1.6
"""Half extent of the grid in contact radii."""
DEPTHS = (0.0, 0.25, 0.5, 0.75, FILM_SIDE, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0)
"""Of SAM, in thicknesses."""
WIDE = 1.5
"""Half width of the part of the interface that is compared, in contact radii."""
LARGEST = {"film": "mises_max_film_Pa", "body": "mises_max_substrate_Pa"}


def scene_of(base: Scene) -> Scene:
    """The scene with the Hertz pressure of the contact without film in place of the counter-body."""
    hertz = contact_of(base)
    a, n = hertz.contact_radius, 2 * round(REACH * CELLS) + 1
    thickness = THICKNESS * a
    changed = {
        "counterbody": None,
        "loading": Loading(prescribed="hertz", p0=hertz.peak_pressure, radius=a, steps=1),
        "friction": Friction(coefficient=FRICTION),
    }
    scene, side = (
        with_keys(base, "body.coating", thickness=thickness).model_copy(update=changed),
        n * a / CELLS,
    )
    scene = with_grid(
        scene, cells=(n, n), extent=(side, side), depths=tuple(share * thickness for share in DEPTHS)
    )
    return with_keys(scene, "fem", box=BOX, cells_per_radius=ELEMENTS)


@dataclass(frozen=True)
class TractionResults:
    """Both models ("SAM", "FEM"); right: largest von Mises stress of "film" and "body" in closed form."""

    scene: Scene
    results: Mapping[str, Result]
    right: Mapping[str, LargestChange]


class CoatedTraction(Case):
    """SAM and FEM against the closed form."""

    def solve(self, context: Context) -> TractionResults:
        scene = scene_of(context.scene(SCENE))
        results = {"SAM": context.solve(SAM, scene, "sam"), "FEM": context.solve(FEM_3D, scene, "fem")}
        return TractionResults(scene, results, largest(scene))

    def measure(self, found: TractionResults) -> dict[str, Measured]:
        return {
            f"{model.lower()}-{name}": value
            for model, result in found.results.items()
            for name, value in measured(found.scene, result, found.right).items()
        }

    def setup(self, found: TractionResults) -> list[tuple[str, str]]:
        load, body, film = found.scene.loading, found.scene.body, found.scene.body.coating
        sam, fem = found.results.values()
        return [
            ("Half-space", f"{elastic_text(body)}, elastic"),
            ("Film", f"{elastic_text(film)}, {THICKNESS:g} a thick"),
            ("Tractions", f"p = p₀ √(1 − r²/a²), q = {FRICTION:g} p along +x, given; no contact is solved"),
            ("Size (a, p₀)", f"{load.radius * 1e6:.4f} µm, {load.p0 / 1e9:.4f} GPa"),
            ("SAM", grid_text(sam, load.radius)),
            ("FEM", f"{mesh_text(fem)}, {ELEMENTS} elements in a, two over the film; box {BOX:g} a"),
        ]

    def tables(self, found: TractionResults) -> Iterator[SmallTable]:
        rows, a = [], found.scene.loading.radius
        for part, name in LARGEST.items():
            peak = found.right[part]
            values = [result.quantities[name] for result in found.results.values()]
            cells = (f"{number(1e-9 * value, 5)} ({off_text(value, peak.value)})" for value in values)
            rows.append(
                (part, number(1e-9 * peak.value, 5), (f"{peak.r / a:+.3f}, {peak.z / a:.3f}"), *cells)
            )
        yield SmallTable(
            "Largest von Mises stress [GPa]", ("of the", "closed form", "at x/a, z/a", *found.results), rows
        )


def layers_of(scene: Scene) -> CoatedHalfSpace:
    """The layered body of the closed forms."""
    film, body = scene.body.coating, scene.body
    return CoatedHalfSpace(film.young, film.poisson, film.thickness, body.young, body.poisson)


def largest(scene: Scene) -> dict[str, LargestChange]:
    """Largest von Mises stress of film and body in closed form."""
    load, layers = scene.loading, layers_of(scene)
    return {
        name: largest_von_mises(layers, load.p0, load.radius, scene.coefficient, film=name == "film")
        for name in LARGEST
    }


def measured(scene: Scene, result: Result, right: Mapping[str, LargestChange]) -> dict[str, Measured]:
    """A model against the closed form: the largest von Mises stress of film and body, and the body's along
    the interface.
    """
    values = {
        part: Measured(result.quantities[name], right[part].value, unit="Pa")
        for part, name in LARGEST.items()
    }
    return values | {"interface": Measured(*at_interface(scene, result))}


def at_interface(scene: Scene, result: Result) -> tuple[np.ndarray, np.ndarray]:
    """Von Mises stress of the body along y = 0 where it meets the film, of a model at its places and in
    closed form.
    """
    load, thickness = scene.loading, scene.body.coating.thickness
    x, z, field = plane_field(result.tables, "mises_Pa")
    x, field = x[use := np.abs(x) <= WIDE * load.radius], field[use]
    (row,) = np.flatnonzero(np.isclose(z, thickness, rtol=1e-9, atol=0.0))
    exact = coated_sliding_stress(layers_of(scene), load.p0, load.radius, scene.coefficient, x=x, z=thickness)
    return field[:, row], von_mises(exact[:, 0])


CASES = (CoatedTraction("coated-traction"),)
