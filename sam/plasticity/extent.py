# SPDX-License-Identifier: MIT
"""The box of cells on which plastic strain is solved: the first guess, and how it grows."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np

from sam.contact.convolution import Counters
from sam.contact.normal import Contact, around
from sam.contact.stress import von_mises
from sam.elastic import load_step, plane_stress, stress_and_mises
from sam.friction import most_friction
from sam.grid.cells import CellGrid, Window
from sam.loading import Load, path_of, peak_force, sign_of
from sam.scene import Scene

GROWTH = 8  # a box grows by at least 1/GROWTH of its size on a side that is reached
LEAST_GROWTH = 3  # cells or layers
CONTAINED = 3.0  # elastic von Mises stress over the yield stress, above which the plastic zone spreads beside the contact
DEEPEST = 1.8  # contact half-widths: the first guess of the depth of the plastic zone is at most this


@dataclass(frozen=True)
class Extent:
    """The box: a window of the grid and its first `layers` layers."""

    window: Window
    layers: int


def widened(first: int, count: int, limit: int, before: bool, after: bool) -> tuple[int, int]:
    """A range of cells with more on the sides that ask for it, inside 0 .. limit."""
    more = max(LEAST_GROWTH, count // GROWTH)
    start, stop = max(first - more * before, 0), min(first + count + more * after, limit)
    return start, stop - start


@dataclass(frozen=True)
class ElasticPeak:
    """The contact at the largest load if the body stayed elastic, and the von Mises stress, (nz, n) in Pa.

    mises: below a smooth body in the plane y = 0, n = nx; below a rough one the largest of the whole grid, n = 1. A chemical
    film may fail and raise the traction: then with its high coefficient everywhere.
    """

    contact: Contact
    mises: np.ndarray


def elastic_peak(scene: Scene, grid: CellGrid, counters: Counters) -> ElasticPeak | None:
    """None without force."""
    peak, high = Load(peak_force(scene)), most_friction(scene)
    if peak.force == 0:
        return None
    contact = load_step(scene, grid, peak, None, counters, coefficient=high)
    if scene.surface is not None:
        return ElasticPeak(
            contact, stress_and_mises(scene, grid, peak, contact, counters, coefficient=high)[1]
        )
    stress = plane_stress(scene, grid, peak, contact, counters, coefficient=high)
    return ElasticPeak(contact, von_mises(stress).max(axis=-1))


def yields(scene: Scene, grid: CellGrid, peak: ElasticPeak | None) -> bool:
    """Whether the elastic stress at the peak exceeds the yield stress anywhere."""
    return peak is not None and bool((peak.mises > initial_yield(scene, grid)[:, None]).any())


def first_extent(scene: Scene, grid: CellGrid, peak: ElasticPeak) -> Extent:
    """Box around the contact and the cells that would yield if the body stayed elastic at the peak.

    A travelling load takes the box of the origin along its path. Below a rough surface islands of plasticity lie anywhere, and
    flattened summits bring others into contact: the box is as wide as the patch, and grows in depth.
    """
    contact, exceeds = peak.contact, peak.mises > initial_yield(scene, grid)[:, None]
    if scene.surface is not None:
        deep = np.flatnonzero(exceeds.any(axis=1))
        layers = min(int(deep[-1]) + 2 if deep.size else 2, len(grid.depths))
        return Extent(Window(0, 0, grid.nx, grid.ny), layers)
    box = around(contact.pressure > 0)
    half_width = min(box.nx * grid.hx, box.ny * grid.hy) / 2
    deep = np.flatnonzero(exceeds.any(axis=1) & (grid.depths <= DEEPEST * half_width))
    # as far beside the contact as the elastic zone, at most a sixth of the contact: the plastic one is narrower, until it spreads
    spreads = (peak.mises > CONTAINED * initial_yield(scene, grid)[:, None]).any()
    least = ceil(box.nx / 8) if spreads else 0
    columns, end = np.flatnonzero(exceeds.any(axis=0)), box.i0 + box.nx
    margins = np.clip([box.i0 + 2 - columns[0], columns[-1] + 3 - end], least, max(box.nx // 6, least))
    widest = int(margins.max())
    before, after = (widest, widest) if sign_of(scene, 2) < 0 else margins
    swept = np.array(path_of(scene)) / (grid.hx, grid.hy)
    (left, low), (right, high) = (
        np.floor(swept.min(axis=0)).astype(int),
        np.ceil(swept.max(axis=0)).astype(int),
    )
    i0, j0 = max(int(box.i0 - before + left), 0), max(int(box.j0 - widest + low), 0)
    i1, j1 = min(int(end + after + right), grid.nx), min(int(box.j0 + box.ny + widest + high), grid.ny)
    layers = min(int(deep[-1]) + 2 if deep.size else 2, len(grid.depths))
    return Extent(Window(i0, j0, i1 - i0, j1 - j0), layers)


def initial_yield(scene: Scene, grid: CellGrid) -> np.ndarray:
    """Yield stress of unstrained material at the depths of the grid, (nz,) in Pa."""
    plasticity = scene.body.plasticity
    return plasticity.depth_profile()(grid.depths) * plasticity.curve().stress(np.zeros(1))
