# SPDX-License-Identifier: MIT
"""Hertz pressure and traction given on a coated body, no contact searched: both solvers at the faces of the film, in closed form.

With high friction the largest von Mises stresses lie at faces: of the film at its surface, of the body where it meets the film.
A model that is read short of the faces, at the centres of its elements say, misses them by percents however fine it is inside.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from sam.grid.coated import FILM_SIDE
from sam.scene import Friction, Loading, Result, Scene
from verification.reference.coated_changes import LargestChange
from verification.reference.coated_traction import coated_sliding_stress, largest_von_mises
from verification.reference.layered_axisymmetric import CoatedHalfSpace
from verification.reference.stress import von_mises
from verification.runs.models import FEM_3D, SAM
from verification.runs.sampling import plane_field
from verification.suite.cases.case import (
    Case,
    Context,
    Outcome,
    SmallTable,
    grid_text,
    mesh_text,
    with_grid,
    with_mesh,
)
from verification.suite.cases.hertz import contact_of
from verification.suite.gates import Measured
from verification.text.console import number

SCENE = "coated-sliding"
FRICTION, THICKNESS = 0.4, 0.1
"""The thickness in contact radii: the largest stress of the body is at the interface, below the trailing half of the contact."""
CELLS, ELEMENTS, BOX = 24, 6, 6.0
"""Cells (SAM) and elements (FEM) in the contact radius; half side of the block of FEM in that."""
REACH = 1.6
"""Half extent of the grid in contact radii."""
DEPTHS = (0.0, 0.25, 0.5, 0.75, FILM_SIDE, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0)
"""Of SAM, in thicknesses."""
WIDE = 1.5
"""Half width of the part of the interface that is compared, in contact radii."""


def scene_of(base: Scene) -> Scene:
    """The scene with the Hertz pressure of the contact without film in place of the counter-body."""
    hertz = contact_of(base)
    a, n = hertz.contact_radius, 2 * round(REACH * CELLS) + 1
    thickness = THICKNESS * a
    coating = base.body.coating.model_copy(update={"thickness": thickness})
    changed = {
        "body": base.body.model_copy(update={"coating": coating}),
        "counterbody": None,
        "loading": Loading(prescribed="hertz", p0=hertz.peak_pressure, radius=a, steps=1),
        "friction": Friction(coefficient=FRICTION),
        "fem": base.fem.model_copy(update={"box": BOX}),
    }
    scene, side = base.model_copy(update=changed), n * a / CELLS
    scene = with_grid(
        scene, cells=(n, n), extent=(side, side), depths=tuple(share * thickness for share in DEPTHS)
    )
    return with_mesh(scene, ELEMENTS)


def run(context: Context) -> Outcome:
    """SAM and FEM against the closed form."""
    scene = scene_of(context.scene(SCENE))
    results = {"sam": context.solve(SAM, scene, "sam"), "fem": context.solve(FEM_3D, scene, "fem")}
    right, outcome = largest(scene), Outcome(setup=setup(scene, results))
    for model, result in results.items():
        for name, value in measured(scene, result, right).items():
            outcome.values[f"{context.case}.{model}-{name}"] = value
    outcome.tables.append(table(scene, results, right))
    return outcome


def layers_of(scene: Scene) -> CoatedHalfSpace:
    """The layered body of the closed forms."""
    film, body = scene.body.coating, scene.body
    return CoatedHalfSpace(film.young, film.poisson, film.thickness, body.young, body.poisson)


def largest(scene: Scene) -> dict[str, LargestChange]:
    """Largest von Mises stress of film and body in closed form."""
    load, layers = scene.loading, layers_of(scene)
    return {
        name: largest_von_mises(layers, load.p0, load.radius, scene.coefficient, film=name == "film")
        for name in ("film", "body")
    }


def measured(scene: Scene, result: Result, right: Mapping[str, LargestChange]) -> dict[str, Measured]:
    """A model against the closed form: the largest von Mises stress of film and body, and the body's along the interface."""
    q = result.quantities
    return {
        "film": Measured(q["mises_max_film_Pa"], right["film"].value, unit="Pa"),
        "body": Measured(q["mises_max_substrate_Pa"], right["body"].value, unit="Pa"),
        "interface": Measured(*at_interface(scene, result)),
    }


def at_interface(scene: Scene, result: Result) -> tuple[np.ndarray, np.ndarray]:
    """Von Mises stress of the body along y = 0 where it meets the film, of a model at its places and in closed form."""
    load, thickness = scene.loading, scene.body.coating.thickness
    x, z, field = plane_field(result.tables, "mises_Pa")
    x, field = x[use := np.abs(x) <= WIDE * load.radius], field[use]
    (row,) = np.flatnonzero(np.isclose(z, thickness, rtol=1e-9, atol=0.0))
    exact = coated_sliding_stress(layers_of(scene), load.p0, load.radius, scene.coefficient, x, thickness)
    return field[:, row], von_mises(exact[:, 0])


def table(scene: Scene, results: Mapping[str, Result], right: Mapping[str, LargestChange]) -> SmallTable:
    """The largest stresses of both models and of the closed form, with its place."""
    names = {"film": "mises_max_film_Pa", "body": "mises_max_substrate_Pa"}
    rows, a = [], scene.loading.radius
    for part, name in names.items():
        peak = right[part]
        found = (
            f"{number(1e-9 * q[name], 5)} ({1e2 * (q[name] / peak.value - 1.0):+.2f} %)"
            for q in (result.quantities for result in results.values())
        )
        rows.append((part, number(1e-9 * peak.value, 5), f"{peak.r / a:+.3f}, {peak.z / a:.3f}", *found))
    columns = ("of the", "closed form", "at x/a, z/a", "SAM", "FEM")
    return SmallTable("Largest von Mises stress [GPa]", columns, rows)


def setup(scene: Scene, results: Mapping[str, Result]) -> list[tuple[str, str]]:
    """The numbers of the case for the reader."""
    load, body, film = scene.loading, scene.body, scene.body.coating
    return [
        ("Half-space", f"E = {body.young / 1e9:g} GPa, ν = {body.poisson:g}, elastic"),
        ("Film", f"E = {film.young / 1e9:g} GPa, ν = {film.poisson:g}, {THICKNESS:g} a thick"),
        ("Tractions", f"p = p₀ √(1 − r²/a²), q = {FRICTION:g} p along +x, given; no contact is solved"),
        ("Size (a, p₀)", f"{load.radius * 1e6:.4f} µm, {load.p0 / 1e9:.4f} GPa"),
        ("SAM", grid_text(results["sam"], load.radius)),
        ("FEM", f"{mesh_text(results['fem'])}, {ELEMENTS} elements in a, two over the film; box {BOX:g} a"),
    ]


CASES = (
    Case(
        "coated-traction",
        "Given sliding tractions on a coated body",
        "Are the largest stresses of film and body, which lie at the faces of the film, those of the closed form in both models?",
        run,
        (
            (
                "Closed form",
                "Hankel integrals of the layered half-space under p₀ √(1 − r²/a²) and μ times it, by quadrature",
                "Burmister (1945); O'Sullivan & King (1988)",
            ),
        ),
    ),
)
