# SPDX-License-Identifier: MIT
"""What a rough body adds to the semi-analytical model: its heights on the grid, where stresses are looked for, warnings.

Loaded for rough scenes only. The whole grid may come into contact, and the largest stress lies anywhere, not in y = 0.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from scipy import ndimage

from sam.contact.convolution import Window
from sam.contact.fit import FEWEST_IN_SPOT
from sam.contact.normal import Contact
from sam.contact.stress import von_mises
from sam.grid import LAYERS_IN_PROFILE, CellGrid
from sam.scene import Plasticity, Scene
from sam.scene.remedies import either, finer_cells, larger_patch, less_load
from sam.scene.result import SURFACE
from sam.scene.surface import (
    Roughness,
    Surface,
    border_cells,
    heights,
    mean_deviation,
    patch_of,
    roughness,
    with_relief,
)

if TYPE_CHECKING:
    from sam.record import Snapshot

FINE_DEPTH, FINEST = 2.0, 0.25  # cells: down to the first depth levels are the second apart
# of the distances between deeper levels; down to this share of the shorter side
GROWTH, DEPTH_SHARE = 1.2, 1 / 8
LAYER_GROWTH = 1.25  # ratio of the thicknesses of layers
WELL_RESOLVED = 4.0  # cells in the shortest wavelength; below it maxima depend on where the cells lie
BYTES_AT_ONCE = 2e8  # of the spectra of a block of depths


def sides_of(scene: Scene) -> tuple[tuple[int, int], tuple[float, float]]:
    """(nx, ny) and (Lx, Ly) in m of a rough scene: of its file, or those that it gives."""
    return patch_of(scene.surface, scene.grid)


def rough_grid(scene: Scene) -> CellGrid:
    """The grid of a rough scene; depths that it does not give are fine near the surface, where small contacts act."""
    (nx, ny), (lx, ly) = sides_of(scene)
    hx, hy = lx / nx, ly / ny
    given, plasticity = scene.grid, scene.body.plasticity
    if given and given.depths:
        depths = np.array(given.depths)
    elif given and given.layers and given.depth:
        depths = np.linspace(0.0, given.depth, given.layers + 1)
    else:
        depths = (
            _depths(min(hx, hy), min(lx, ly))
            if plasticity is None
            else _faces(plasticity, min(hx, hy), min(lx, ly))
        )
        if scene.body.coating is not None:
            from sam.coated_grid import depths_with_film

            depths = depths_with_film(depths, scene.body.coating.thickness)
    border = border_cells((nx, ny)) if given is None or given.border == "free" else (0, 0)
    if plasticity is not None:
        return CellGrid(nx, ny, hx, hy, (depths[1:] + depths[:-1]) / 2, depths, border)
    return CellGrid(nx, ny, hx, hy, depths, border=border)


def _depths(cell: float, side: float) -> np.ndarray:
    """Output depths in m: even ones near the surface, then growing distances."""
    levels, step = [FINEST * cell * k for k in range(round(FINE_DEPTH / FINEST) + 1)], FINEST * cell
    while levels[-1] < DEPTH_SHARE * side:
        step *= GROWTH
        levels.append(levels[-1] + step)
    return np.array(levels)


def _faces(plasticity: Plasticity, cell: float, side: float) -> np.ndarray:
    """Faces of the layers of a body that yields: half a cell thick at the surface, thinner where the yield stress varies."""
    thin = [cell / 2]
    if plasticity.profile is not None:
        thin.append(plasticity.profile[-1][0] / LAYERS_IN_PROFILE or cell / 2)
    if plasticity.layer_thickness is not None:
        thin.append(plasticity.layer_thickness / LAYERS_IN_PROFILE)
    faces, step = [0.0], min(thin)
    while faces[-1] < DEPTH_SHARE * side:
        faces.append(faces[-1] + step)
        step *= LAYER_GROWTH
    return np.array(faces)


def heights_on(scene: Scene, grid: CellGrid) -> np.ndarray:
    """Heights of the body at the cell centres, (nx, ny) in m, positive out of it; read-only."""
    relief = scene.grid is not None and scene.grid.border == "relief"
    return _heights(scene.surface, (grid.nx, grid.ny), sides_of(scene)[1], relief)


@lru_cache(maxsize=1)
def _heights(
    surface: Surface, cells: tuple[int, int], extent: tuple[float, float], relief: bool
) -> np.ndarray:
    x, y = (((np.arange(n) + 0.5) / n - 0.5) * side for n, side in zip(cells, extent, strict=True))
    found = heights(surface, x, y, extent)
    if relief:
        found = with_relief(found, x, y, extent, mean_deviation(surface, extent))
    found.flags.writeable = False
    return found


def roughness_of(scene: Scene, grid: CellGrid) -> Roughness:
    """Of the heights on the grid, but for a border that falls off."""
    return roughness_now(scene, grid, np.zeros((grid.nx, grid.ny)))


def roughness_now(scene: Scene, grid: CellGrid, lowered: np.ndarray) -> Roughness:
    """The same of a surface that wear and plastic strain have lowered, (nx, ny) in m."""
    bx, by = (0, 0) if scene.grid is None or scene.grid.border == "free" else border_cells((grid.nx, grid.ny))
    inner = (heights_on(scene, grid) - lowered)[bx : grid.nx - bx, by : grid.ny - by]
    return roughness(inner, grid.hx, grid.hy)


def rough_gap(scene: Scene, grid: CellGrid, profile: np.ndarray) -> np.ndarray:
    """Initial gap, (nx, ny) in m: that of the smooth bodies less the heights, zero where they touch first."""
    gap = profile - heights_on(scene, grid)
    return gap - gap.min()


def depths_at_once(grid: CellGrid) -> int:
    """How many depths a block has: six spectra each, of complex numbers on a grid twice as long each way."""
    return int(max(1, BYTES_AT_ONCE // (6 * 16 * 2 * grid.nx * (grid.ny + 1))))


def largest_mises(
    stress_at: Callable[[np.ndarray, Window], np.ndarray], grid: CellGrid, window: Window, row: int | None
) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
    """Stress in the rows of cells that touch y = 0, at each depth the largest von Mises stress in a window, stress in a row.

    stress_at: (depths, window) -> (6, nz, nx, ny) in Pa; called for blocks of depths, so that the memory is bounded.
    Returns (stress, largest, stress of the row or None), (6, nz, nx, rows), (nz, 1) and (6, nz, nx) in Pa.
    """
    block = depths_at_once(grid)
    rows, whole = grid.axis_rows.slices[1], Window(0, 0, grid.nx, grid.ny)
    largest, plane, cut = [], [], []
    for k in range(0, len(grid.depths), block):
        stress = stress_at(grid.depths[k : k + block], whole)
        largest.append(von_mises(stress[(..., *window.slices)]).max(axis=(-2, -1)))
        plane.append(stress[..., rows].copy())
        if row is not None:
            cut.append(stress[..., row].copy())
    in_row = np.concatenate(cut, axis=1) if cut else None
    return np.concatenate(plane, axis=1), np.concatenate(largest)[:, None], in_row


def warnings_of(scene: Scene, grid: CellGrid, contact: Contact) -> tuple[str, ...]:
    """What a user should know about the peak, in words."""
    out, touching = [], contact.pressure > 0
    if scene.surface.kind != "file":
        cells = [short / h for short, h in zip(scene.surface.shortest, (grid.hx, grid.hy), strict=True)]
        if min(cells) < WELL_RESOLVED * (1 - 1e-6):
            out.append(
                f"{min(cells):.3g} cells in the shortest wavelength of the surface: with fewer than {WELL_RESOLVED:g} the "
                f"largest pressure depends on where the cells lie{_then(finer_cells(scene))}"
            )
    if touching.any():
        spots, _ = ndimage.label(touching)
        top = np.unravel_index(contact.pressure.argmax(), touching.shape)
        count = int(np.count_nonzero(spots == spots[top]))
        if count < FEWEST_IN_SPOT:
            out.append(
                f"{count} cells in contact where the pressure is largest, {np.count_nonzero(touching)} in all: "
                f"with fewer than {FEWEST_IN_SPOT} p_max_Pa is off by some percent{_then(finer_cells(scene))}"
            )
    if touching[[0, -1], :].any() or touching[:, [0, -1]].any():
        out.append(
            f"the contact touches the edge of the grid, where the half-space is cut{_at_edge(scene, grid)}"
        )
    return tuple(out)


def _then(remedy: str) -> str:
    """A remedy behind a warning, if there is one."""
    return f": {remedy}" if remedy else ""


def _at_edge(scene: Scene, grid: CellGrid) -> str:
    """What becomes of the edge, and what to change."""
    if not any(grid.border):  # the heights fall off already, and all cells count
        words = f' although the heights fall off there (grid.border = "{scene.grid.border}")'
        return f"{words}: {either(larger_patch(scene), less_load(scene))}"
    bx, by = grid.border
    return (
        f": the outer {bx} x {by} cells do not count for p_max_Pa and mises_max_Pa; "
        'grid.border = "relief" lets the heights fall off'
    )


def surface_table(scene: Scene, grid: CellGrid, snapshots: Sequence[Snapshot]) -> dict:
    """The table surface: for each state a row a cell, y running first. Heights are the original ones."""
    x, y = np.meshgrid(grid.x, grid.y, indexing="ij")
    height = heights_on(scene, grid)
    parts = [
        {
            "state": np.full(x.size, each.state),
            "x_m": x.ravel(),
            "y_m": y.ravel(),
            "height_m": height.ravel(),
            "p_Pa": each.contact.pressure.ravel(),
            "worn_m": np.zeros(x.size) if each.worn is None else each.worn.ravel(),
            "friction": each.local_friction.ravel(),
        }
        for each in snapshots
    ]
    table = {name: np.concatenate([part[name] for part in parts]) for name in SURFACE}
    return table | {"state": table["state"].tolist()}
