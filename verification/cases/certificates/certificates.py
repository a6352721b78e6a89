# SPDX-License-Identifier: MIT
"""Every condition of a returned solution, by `verification.checks`, of small scenes in groups."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from sam.scene import Friction, FrictionMap, Grid, Scene, Surface
from verification.cases.case import (
    FEM,
    FEM_3D,
    SAM,
    Context,
    DataFrame,
    with_body,
    with_grid,
    with_loading,
    with_mesh,
)
from verification.cases.recipes import Resolution, at_ratio, resolved_at
from verification.checks.certificates import OF_GROUP, solved

LEVEL = {"quick": Resolution(8, 10), "full": Resolution(12, 20)}
STEPS, RATIO, PERFECT_RATIO, COEFFICIENT = 5, 4.0, 3.0, 0.2
FILM_RATIO, FILM_MESH = 2.5, 8
"""Hertz's p0 over the initial yield stress of the body under a film that yields; elements in the radius."""
SPATIAL_MESH, SPATIAL_STEPS, COATED_CELLS = 4, 3, 41
PATCH, RA, FORCE = 16e-6, 0.04e-6, 0.1
"""Of the rough patch: side and Ra in m, force in N."""
PATCH_CELLS = {SAM: 25, FEM_3D: 21}
LAYERS = 16
LOW, HIGH = 0.1, 0.4
"""Coefficients of friction: in quarters of the patch, and of a film that is whole and that has failed."""
FILM = {
    "film_thickness": 100e-9,
    "film_young": 80e9,
    "film_poisson": 0.3,
    "film_yield": 2e9 / 3,
    "strain_limit": 0.0204,
}
"""The chemical film of Bosman & Schipper (2011), in SI."""
WAVES = {"cutoff_long": 16e-6, "cutoff_short": 8e-6, "hurst": 0.8, "seed": 4}


def rough(context: Context, model: str) -> dict[str, Scene]:
    """A self-affine patch that falls off at its border, under a map of friction; elastic, or with a film."""
    base, cells = context.scene("rough-asperities"), PATCH_CELLS[model]
    grid = Grid(cells=(cells, cells), extent=(PATCH, PATCH), border="relief")
    layered = grid.model_copy(update={"layers": LAYERS, "depth": 0.5 * LAYERS * PATCH / cells})
    scene = base.model_copy(update={"surface": Surface(kind="self-affine", ra=RA, **WAVES), "grid": layered})
    scene = with_loading(scene, force=FORCE, steps=SPATIAL_STEPS, unload=True)
    side = np.arange(cells) < cells // 2
    quarters = FrictionMap(np.where(side[:, None] == side, HIGH, LOW), (PATCH, PATCH))
    slides = scene.model_copy(update={"friction": Friction(law="map", path=quarters)})
    if model == FEM_3D:
        return {"rough, Swift": slides}
    elastic = with_body(slides, plasticity=None).model_copy(update={"grid": grid})
    chemical = scene.model_copy(
        update={"friction": Friction(law="chemical-film", low=LOW, high=HIGH, **FILM)}
    )
    return {"rough, elastic": elastic, "rough, Swift": slides, "rough, film that fails": chemical}


def groups(context: Context) -> Iterator[tuple[str, str, str, Scene]]:
    """(group, name, model, scene) of all that is solved: spheres, elastic and yielding films, patches."""
    quick, friction = context.level == "quick", {"friction": Friction(coefficient=COEFFICIENT)}

    def pressed(name: str, ratio: float, steps: int) -> Scene:
        return with_loading(at_ratio(context.scene(name), ratio), steps=steps, unload=True)

    swift, perfect = (
        resolved_at(pressed(name, ratio, STEPS), LEVEL[context.level])
        for name, ratio in (("plastic-swift-rigid", RATIO), ("plastic-perfect", PERFECT_RATIO))
    )
    elastic = with_body(perfect, plasticity=None).model_copy(update={"solver": type(perfect.solver)()})
    at_rest = {"elastic": elastic, "Swift": swift, "perfect": perfect}
    yields = with_mesh(pressed("film-yield", FILM_RATIO, SPATIAL_STEPS), FILM_MESH)
    films = {"soft film": context.scene("coated-sphere"), "film, sliding": context.scene("coated-sliding")}
    spatial = {
        "Swift, sliding": pressed("plastic-swift-rigid", RATIO, SPATIAL_STEPS).model_copy(update=friction),
        **({} if quick else {"film, sliding": films["film, sliding"]}),
    }
    spatial = {name: with_mesh(scene, SPATIAL_MESH) for name, scene in spatial.items()}
    films = {name: with_grid(scene, cells=(COATED_CELLS,) * 2) for name, scene in films.items()}
    for group, model, scenes in (
        ("sam", SAM, at_rest | {"Swift, sliding": swift.model_copy(update=friction)}),
        ("fem", FEM, at_rest | {"film that yields": yields}),
        ("coated", SAM, films),
        ("rough", SAM, rough(context, SAM)),
        ("fem-3d", FEM_3D, spatial if quick else spatial | rough(context, FEM_3D)),
    ):
        yield from ((group, name, model, scene) for name, scene in scenes.items())


def frame(context: Context) -> Iterator[dict[str, Any]]:
    """Each scene solved with the models that apply, and all conditions measured; a row is GROUP-CONDITION."""
    for group, name, model, scene in groups(context):
        values = OF_GROUP[group](scene, *solved(scene, model))
        yield {"sweep": group, "scene": name, **values, "values": values}


def worst(rows: DataFrame, column: str) -> float:
    """The largest value of a condition over the scenes for which it is measured. ValueError for none."""
    return float(np.max([one[column] for one in rows["values"] if column in one]))
