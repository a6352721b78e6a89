# SPDX-License-Identifier: MIT
"""Contact with a rough body in three dimensions: the heights of the scene at the nodes, any number of spots.

The surface nodes of the patch are the centres of the scene's cells, so that a node stands for a cell: its height, its local
coefficient of friction. Beyond the patch the surface is free. The whole body is modelled, and lengths are in half of the longer
side of the patch: nothing else is known of the size of the contact.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from fem_reference.axisymmetric.mesh import grow, uniform_then_growing
from fem_reference.axisymmetric.model import material, profile_of
from fem_reference.common.contact import Equilibrium
from fem_reference.common.hertz import Scales, relative_moduli
from fem_reference.common.messages import FEWEST_NODES
from fem_reference.spatial.area import area_of_spots
from fem_reference.spatial.hexahedra import HexSolid, Lines, block
from fem_reference.spatial.model import Model, friction_weights, slide, surface_nodes
from fem_reference.spatial.problem import SlidingProblem
from sam.scene.schema import Scene
from sam.scene.surface import heights, mean_deviation, patch_of, with_relief

UNIFORM_DEPTH = 0.2
"""Of the shorter side of a patch of square cells: so deep are the elements cubes. Spots of a few asperities take a tenth."""
DEPTH_GROWTH, SIDE_GROWTH = 1.6, 2.2
"""Ratios of neighbouring elements below, and beside the patch; 1.2 and 1.4 change pressures and loads of spots by 3e-4."""
UNLOADED = 0.01
"""Unit of displacement over that of length when there is no force."""
OVERLAP_LENGTH = 0.75 * np.pi
"""Overlapping volume of a sphere and a plane times E* over the force, in contact radii: 3 pi/4 by Hertz."""


@dataclass(frozen=True)
class RoughModel(Model):
    """As Model; gap: (nx + 1, ny + 1) initial gap, infinite outside of the patch."""

    gap: np.ndarray | None = None

    @property
    def initial_gap(self) -> np.ndarray:
        """(nx + 1, ny + 1), zero where the bodies touch first."""
        return self.gap

    def area(self, state: Equilibrium) -> float:
        """Area of all spots."""
        gap = np.clip(self.on_surface(state.gap), 0.0, None)
        pressure = np.clip(self.nodal_pressure(state), 0.0, None)
        return area_of_spots(self.lines.x, self.lines.y, pressure, gap)

    def outgrown(self, state: Equilibrium) -> bool:
        """Never: a patch may be cut, and its contact end where it does."""
        return False

    def too_coarse(self, states: Sequence[Equilibrium]) -> bool:
        """Whether fewer nodes ever touch than resolve one spot."""
        return max(int(state.active.sum()) for state in states) < FEWEST_NODES

    def starting_set(self, force: float, previous: Equilibrium) -> np.ndarray:
        """Nodes (bool) that probably touch: from no contact see `overlapping`, else as many more or fewer as the force.

        Those in contact in the order of their pressure, then the others in that of their gap.
        """
        if previous.force == 0.0:
            return overlapping(self.gap, self.lines.areas, force).ravel()[self.candidates]
        areas = self.lines.areas.ravel()[self.candidates]
        order = np.lexsort((previous.gap, -previous.multipliers / areas))
        exponent = 1.0 if previous.yielded and force > previous.force else 2.0 / 3.0
        wanted = areas[previous.active].sum() * (force / previous.force) ** exponent
        chosen = np.zeros(order.size, dtype=bool)
        chosen[order] = np.cumsum(areas[order]) <= wanted
        return chosen


def overlapping(gap: np.ndarray, areas: np.ndarray, force: float) -> np.ndarray:
    """Nodes (bool, as gap) in contact under `force`, by Hertz's formulas for the mean of the spots; E* = 1.

    A rigid plane lowered by delta overlaps the heights in spots of twice the area of contact, and by the volume V;
    F = V/(3 pi/4 a), a: radius of the mean spot. Of each the lower half is in contact. gap, areas: (nx, ny).
    """
    low, high = 0.0, float(gap[np.isfinite(gap)].max())
    for _ in range(60):
        depth = 0.5 * (low + high)
        inside = gap < depth
        spots = max(1, ndimage.label(inside)[1])
        volume = float(((depth - gap[inside]) * areas[inside]).sum())
        radius = np.sqrt(areas[inside].sum() / (2.0 * np.pi * spots))
        low, high = (low, depth) if volume > OVERLAP_LENGTH * radius * force else (depth, high)
    return gap < 0.5 * high


def build(scene: Scene) -> RoughModel:
    """Mesh, body, material and contact candidates of a rough scene that passed `support.check`."""
    units, lines, (cells, _) = scales(scene), choose_lines(scene), sides(scene)
    solid = HexSolid(block(lines), units.young[0], scene.body.poisson)
    surface, weights = surface_nodes(solid, lines), friction_weights(scene, lines, units)
    gap = np.full(surface.shape, np.inf)
    patch = tuple(
        slice((nodes - n) // 2, (nodes + n) // 2) for nodes, n in zip(gap.shape, cells, strict=True)
    )
    gap[patch] = gap_of(scene) / units.displacement
    candidates = np.argsort(gap, axis=None, kind="stable")[: cells[0] * cells[1]]
    problem = SlidingProblem(
        solid,
        (units.young[0], scene.body.poisson),
        lines.share,
        surface.ravel()[candidates],
        gap.ravel()[candidates],
        material(scene, units, solid),
        weights=weights.ravel()[candidates],
        anchored=False,
    )
    x, y = lines.x[patch[0]], lines.y[patch[1]]
    fixed = (
        units,
        lines,
        problem,
        (1.0, 1.0),
        (float(x[0]), float(x[-1]), float(y[-1])),
        (0.0, 0.0),
        candidates,
        surface,
    )
    return RoughModel(
        *fixed, None, slide(scene), prescribed=False, weights=weights, profile=profile_of(scene), gap=gap
    )


def sides(scene: Scene) -> tuple[tuple[int, int], tuple[float, float]]:
    """Cells (nx, ny) of the patch, and its sides in m: of its file, or those that the scene gives."""
    return patch_of(scene.surface, scene.grid)


def cell_centres(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """x (nx,) and y (ny,) in m."""
    return tuple(((np.arange(n) + 0.5) / n - 0.5) * side for n, side in zip(*sides(scene), strict=True))


def gap_of(scene: Scene) -> np.ndarray:
    """(nx, ny) initial gap in m at the centres of the cells: counter-body less heights, zero where they touch first."""
    (x, y), counter, gap = cell_centres(scene), scene.counterbody, -heights_of(scene)
    if counter.shape != "flat":
        rx, ry = counter.radii
        gap = gap + x[:, None] ** 2 / (2.0 * rx) + y[None, :] ** 2 / (2.0 * ry)
    return gap - gap.min()


def heights_of(scene: Scene) -> np.ndarray:
    """(nx, ny) heights of the body in m at the centres of the cells, positive out of it."""
    (x, y), (_, extent) = cell_centres(scene), sides(scene)
    found = heights(scene.surface, x, y, extent)
    if scene.grid is not None and scene.grid.border == "relief":
        return with_relief(found, x, y, extent, mean_deviation(scene.surface, extent))
    return found


def scales(scene: Scene) -> Scales:
    """Units of a rough contact: half of the longer side, and the displacement that makes the force 4/3, as of a sphere."""
    young, force, length = relative_moduli(scene), scene.loading.force, 0.5 * max(sides(scene)[1])
    modulus = scene.body.young / young[0]
    displacement = 0.75 * force / (modulus * length) if force > 0.0 else UNLOADED * length
    return Scales(length, displacement, modulus, 4.0 / 3.0 if force > 0.0 else 0.0, young)


def choose_lines(scene: Scene) -> Lines:
    """Mesh planes: through the centres of the cells, and growing from there to the box, of so many half sides."""
    unit, box = scales(scene).length, scene.fem.box
    x, y = (widened(line / unit, box) for line in cell_centres(scene))
    size, depth = cubes(scene)
    return Lines(x, y, uniform_then_growing(size, depth, box, DEPTH_GROWTH), half=False)


def cubes(scene: Scene) -> tuple[float, float]:
    """Height of the elements next to the surface, that of the shorter side of a cell, and the depth to which it stays."""
    (cells, extent), unit = sides(scene), scales(scene).length
    size = min(side / n for side, n in zip(extent, cells, strict=True)) / unit
    return size, UNIFORM_DEPTH * (min(cells) - 1) * size


def widened(core: np.ndarray, box: float) -> np.ndarray:
    """Equidistant lines continued by growing ones over `box` beyond both ends."""
    outside = grow(0.0, box, core[1] - core[0], SIDE_GROWTH)
    return np.concatenate([core[0] - outside[::-1], core, core[-1] + outside])
