# SPDX-License-Identifier: MIT
"""Conditions of a chemical film in the states that SAM hands out after each load step of its first cycle.

Its plastic strain by `closed_forms.film_flow`, six strains and a root search in each cell; the strain of the
surface below it linearly from the two uppermost layers, elastic by Hooke's law plus plastic.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from sam import choose_grid
from sam.scene import Checkpoint, Scene
from verification.checks.material import around, fields_at_points, in_plane
from verification.reference.film_flow import Film, FlowPoint


def states(scene: Scene, records: Sequence[Checkpoint]) -> float:
    """The largest, of the cells in contact whose film is whole, in every step of loading, the first one from
    a film without strain, of: plastic strain less that of a backward-Euler step, thinning and traction beyond
    what the film bears, each over its limit; and the number of cells that had failed before. Why a cell
    failed cannot be seen here: more friction then changed its pressure.
    """
    law = scene.friction
    film = Film(law.film_young, law.film_poisson, law.film_yield)
    trees, depths = [record.tree() for record in records], choose_grid(scene).depths
    before = {name: np.zeros_like(values) for name, values in trees[0]["tribofilm"]["film"].items()}
    limit, bears = law.thinning_limit, film.yield_stress / np.sqrt(3.0) / law.low
    worst, healed = 0.0, 0.0
    for now in [tree for tree in trees if tree["state"]["load"]["force"] > 0.0]:
        state = now["tribofilm"]["film"]
        failed, window = state["failed"], now["extent"]["window"]
        pressure, strain = (
            around(values, window, failed.shape)
            for values in (pressure_of(scene, now), surface_strain(scene, now, depths))
        )
        healed += float((before["failed"] & ~failed).sum())
        worst = max(worst, float(pressure[~failed].max(initial=0.0)) / bears - 1.0)
        for i, j in np.argwhere((pressure > 0) & (pressure < bears) & ~failed):
            point = FlowPoint(
                strain[:, i, j], pressure[i, j], -now["state"]["load"]["sign"] * law.low * pressure[i, j]
            )
            own = film.implicit_step(before["plastic"][:, i, j], point)
            flow = float(np.abs(own - state["plastic"][:, i, j]).max()) / limit
            worst = max(worst, flow, -own[2] / limit - 1.0)
        before = state
    return max(worst, healed)


def pressure_of(scene: Scene, tree: Mapping) -> np.ndarray:
    """(nx, ny) in Pa on the box; E/(1 - nu^2)/2 is the unit of the record."""
    return tree["state"]["pressure"] * scene.body.young / (1 - scene.body.poisson**2) / 2


def surface_strain(scene: Scene, tree: Mapping, depths: np.ndarray) -> np.ndarray:
    """exx, eyy, exy (3, nx, ny) at z = 0 of a record."""
    elastic = in_plane(tree["last"]["stress"][:, :2], scene.body.young, scene.body.poisson)
    total = elastic + fields_at_points(tree["state"]["material"])["strain"].mean(axis=1)[[0, 1, 5], :2]
    return total[:, 0] + (total[:, 0] - total[:, 1]) * depths[0] / (depths[1] - depths[0])
