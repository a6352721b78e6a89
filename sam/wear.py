# SPDX-License-Identifier: MIT
"""Wear at the end of a cycle: of each column strained material is removed from the surface down, and what was
below it moves up.

Nelias, Boucly & Brunet 2006; Bosman & Schipper 2011, section 5: a crack runs along the border of the volume
that both reaches the surface and is strained beyond the limit; what it encloses becomes a wear particle in
the cycle that strained it. What is above the limit under a sound roof does not reach the surface: it stays,
and is counted. Or the roof falls, as the crack "will then grow toward the surface enclosing a volume which
will form a wear particle" (section 1): each column goes down to the deepest point that is above the limit.

The worn depth is smoothed by local polynomials (Savitzky & Golay 1964). In a window of n x n cells, a
polynomial of total degree <= m is fitted by least squares; its value in the middle is the smoothed value.
With p_i, the polynomials of degree i = 0 ... m that are orthonormal over the n lags, it is

    sum over lags k, l of w(k, l) f(k, l),    w(k, l) = sum_{i + j <= m} p_i(k) p_i(0) p_j(l) p_j(0).    (a)

The total degree is bounded, not the degree in each direction (the filter along x and then along y would take
i, j <= m): those polynomials are the same in a turned frame, and the negative weights at the corners of the
window are smaller. The filter keeps the volume. As printed it therefore also leaves, or raises above the old
surface, what it digs from the flanks; by default it takes nowhere less than the raw depth.

Layers are counted from the current surface: when it wears, the material moves up through them. New layer k of
a column worn by w holds the mean of what was between z_k + w and z_{k+1} + w, the old layers being uniform;
below the deepest face the material is fresh. With h the thicknesses of the layers and overlaps by interval
arithmetic,

    sum_k h_k new_k + integral over 0 ... w of old = sum_k h_k old_k                                       (b)

for each column and component, to rounding. A column that is raised (w < 0) has fresh material on top, and
what it pushes below the deepest face is gone with the integral. Means of plastic strains are free of volume
change again, and the accumulated strain stays at least their norm. A shift by a fraction t of a uniform layer
h smears like a diffusion, with second moment t (1 - t) h^2 per remap (first-order upwind); whole layers move
without it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.polynomial.legendre import legvander
from numpy.typing import NDArray

from sam.arrays import Array, Mask
from sam.grid.cells import Window
from sam.scene import Wear

Wraps = tuple[bool, bool]
UNREACHED = 1e300  # a strain, in place of inf: differences stay numbers


@dataclass(frozen=True)
class StrainLimits:
    """Plastic strain beyond which material is removed: `layer` at z < thickness (m), `bulk` below."""

    bulk: float
    layer: float
    thickness: float

    def __call__(self, z: Array) -> Array:
        """The limit at depths z in m."""
        return np.where(np.asarray(z) < self.thickness, self.layer, self.bulk)


def limit_by_depth(wear: Wear, layer_thickness: float | None) -> StrainLimits:
    """The limits of a scene; layer_thickness in m, of its plasticity, for a limit of the layer."""
    if wear.strain_limit_layer is None or layer_thickness is None:
        return StrainLimits(wear.strain_limit, wear.strain_limit, 0.0)
    return StrainLimits(wear.strain_limit, wear.strain_limit_layer, layer_thickness)


class Worn(NamedTuple):
    """What is removed of each column, (nx, ny): depth in m; above its limit below sound material, in m, which
    stays, or falls with so much of that; whether it is all.
    """

    depth: Array
    roofed: Array
    roof: Array
    at_bottom: Mask


def worn_depth(
    alpha: Array, faces: Array, limits: StrainLimits, interpolate: bool, *, roof_falls: bool = False
) -> Worn:
    """What is removed: all above its limit that reaches the surface, or with the roof. alpha: accumulated
    plastic strain (n_layers, nx, ny), mean of each cell; faces: (n_layers + 1,) in m from the current
    surface, 0, downwards. interpolate: the strain is linear between the centres of the layers. At the
    surface it is extrapolated from the two uppermost ones, never below 0 (a single layer: constant); from the
    lowest centre to the deepest face it is constant. The depth is the first crossing with the limit, or the
    last, which steps where the layer ends: a crossing at the step is found exactly. Error O(dz^2). Without,
    whole layers are removed whose mean is above the limit at their centre: error O(dz). Raises ValueError for
    faces that do not fit the layers or do not descend from 0, and for alpha that is not finite.
    """
    faces = np.asarray(faces, dtype=float)
    if faces.shape != (len(alpha) + 1,) or faces[0] != 0 or not np.all(np.diff(faces) > 0):
        raise ValueError(f"faces = {faces.tolist()}: {len(alpha) + 1} depths, ascending from 0, are needed")
    if not np.isfinite(alpha).all():
        raise ValueError("alpha: all of it must be finite")
    centres = (faces[:-1] + faces[1:]) / 2
    if not interpolate:
        start = alpha - np.minimum(limits(centres), UNREACHED)[:, None, None]
        return _from_surface(start, start, np.diff(faces), roof_falls)
    surface, thickness = alpha[0], limits.thickness
    if len(alpha) > 1:
        surface = np.maximum(alpha[0] - (alpha[1] - alpha[0]) * (centres[0] / (centres[1] - centres[0])), 0.0)
    nodes, strain = np.append(np.append(0.0, centres), faces[-1]), np.stack([surface, *alpha, alpha[-1]])
    k = int(np.searchsorted(nodes, thickness))
    if 0 < thickness < faces[-1] and nodes[k] != thickness:  # one more node where the limit steps
        share = (thickness - nodes[k - 1]) / (nodes[k] - nodes[k - 1])
        there = strain[k - 1] + share * (strain[k] - strain[k - 1])
        nodes, strain = np.insert(nodes, k, thickness), np.insert(strain, k, there, axis=0)
    limit = np.minimum(limits((nodes[:-1] + nodes[1:]) / 2), UNREACHED)[:, None, None]
    return _from_surface(strain[:-1] - limit, strain[1:] - limit, np.diff(nodes), roof_falls)


def _from_surface(start: Array, end: Array, lengths: Array, roof_falls: bool) -> Worn:
    """Columns of segments (n, nx, ny) of linear excess; of exactly 0 removes nothing."""
    open_top, full = start > 0, (start > 0) & (end >= 0)
    crossing = (open_top != (end > 0)) & ~full
    share = np.divide(np.maximum(start, end), np.abs(start - end), out=full.astype(float), where=crossing)
    above = share * lengths[:, None, None]  # of each segment; it holds on to the end that is above
    reached = np.ones_like(full)
    np.logical_and.accumulate(full[:-1], axis=0, out=reached[1:])
    removed = np.where(reached & open_top, above, 0.0)
    depth, roofed = removed.sum(axis=0), (above - removed).sum(axis=0)
    if not roof_falls:
        return Worn(depth, roofed, np.zeros_like(depth), np.asarray(full.all(axis=0)))
    lower = np.cumsum(lengths)[:, None, None]
    deepest = np.where((end > 0) | full, lower, lower - lengths[:, None, None] + above)
    falling = np.where(above > 0, deepest, 0.0).max(axis=0)
    roof = np.where(roofed > 0, falling - above.sum(axis=0), 0.0)
    return Worn(np.where(roofed > 0, falling, depth), roofed, roof, falling == lower[-1])


@cache
def weights(window: int, order: int) -> Array:
    """w(k, l) of (a) at the lags k, l = 0 ... (window - 1)/2; even in both, symmetric.

    Their sum over all lags is 1.

    Raises ValueError for an even window, or an order that the window does not determine.

    >>> (weights(3, 2) * 9).round(3)  # of the cell itself, of its neighbours, of the corners
    array([[ 5.,  2.],
           [ 2., -1.]])
    """
    if window < 1 or window % 2 == 0:
        raise ValueError(f"window = {window}: an odd number of cells is needed")
    if not 0 <= order < window:
        raise ValueError(f"order = {order}: from 0 to {window - 1} for a window of {window}")
    half = window // 2
    lags = np.arange(-half, half + 1) / max(half, 1)
    orthonormal = np.linalg.qr(legvander(lags, order))[0]  # column i: p_i, up to its sign
    terms = orthonormal * orthonormal[half]  # p_i(k) p_i(0)
    degrees = np.add.outer(np.arange(order + 1), np.arange(order + 1))
    w = (terms @ (degrees <= order) @ terms.T)[half:, half:]
    w.flags.writeable = False
    return w


def filtered(field: Array, window: int, order: int, *, wraps: Wraps = (False, False)) -> Array:
    """The smoothed field (nx, ny), mirrored at the border or, along x and along y, repeated (wraps): its sum
    and its symmetry stay, bit by bit.
    """
    w, half = weights(window, order), window // 2
    padded = np.pad(field, ((half, half), (0, 0)), mode="wrap" if wraps[0] else "symmetric")
    padded = np.pad(padded, ((0, 0), (half, half)), mode="wrap" if wraps[1] else "symmetric")
    out = np.zeros(field.shape)
    for k in range(half + 1):
        for other in range(k + 1):
            cells = 1 if k == 0 else 4 if other in (0, k) else 8
            repeated = _four(padded, half, k, other) + _four(
                padded, half, other, k
            )  # each cell 8/cells times
            out += w[k, other] * (repeated * (cells / 8))
    return out


def _four(padded: Array, half: int, k: int, l: int) -> Array:  # noqa: E741
    """f(k, l) + f(-k, -l) + (f(k, -l) + f(-k, l)) around each cell."""
    nx, ny = padded.shape[0] - 2 * half, padded.shape[1] - 2 * half

    def at(i: int, j: int) -> Array:
        return padded[half + i : half + i + nx, half + j : half + j + ny]

    return (at(k, l) + at(-k, -l)) + (at(k, -l) + at(-k, l))


def smoothed(
    depth: Array, window: int, order: int, all_removed: bool = False, *, wraps: Wraps = (False, False)
) -> Array:
    """Smoothed worn depth (nx, ny) in m, never below 0: smoothing adds no material. window = 0: as it is. The
    filter keeps the volume (see `filtered`). Around a scar its weights of order >= 2 ask for negative depths;
    these are set to 0, so the worn volume grows by what they held. Flanks within half a window of the raw
    scar are dug where the filter says so. Within the scar less than the raw depth may go: the material that
    stays is removed in the next cycle even if nothing is strained, and flanks are dug again. A scar of few
    cells may lose several times its raw volume that way, over tens of cycles. all_removed: nowhere less than
    the raw depth, which ends that, up to the error of the remap. Raises ValueError for a depth that is
    negative or not finite, and as `weights` does.
    """
    check_depth(depth)
    if window == 0 or not depth.any():
        return depth
    return np.maximum(filtered(depth, window, order, wraps=wraps), depth if all_removed else 0.0)


def check_depth(depth: Array) -> None:
    """Raises ValueError unless all depths are finite and >= 0."""
    if not (np.isfinite(depth) & (depth >= 0)).all():
        raise ValueError(f"depth from {np.min(depth)} to {np.max(depth)} m: finite depths >= 0 are needed")


def remapped(field: Array, faces: Array, depth: Array) -> tuple[Array, Array]:
    """A field (..., n_layers, nx, ny) with each column moved up by its depth (nx, ny) in m, down where that
    is negative, and the integral of what is gone; unworn columns keep every bit. ValueError for a depth
    that is not finite.
    """
    check_depth(np.abs(depth))
    worn, leading = depth != 0, field.shape[:-3]
    removed = np.zeros((*leading, *depth.shape))
    if worn.any():
        columns = field[..., worn]
        field = field.copy()
        moved, gone = _moved_up(
            columns.reshape(-1, *columns.shape[-2:]), np.asarray(faces, float), depth[worn]
        )
        field[..., worn], removed[..., worn] = moved.reshape(columns.shape), gone.reshape(*leading, -1)
    return field, removed


def _moved_up(state: Array, faces: Array, depth: Array) -> tuple[Array, Array]:
    """The new columns (n, n_layers, m) of (b), worn by depth (m,), and integrals (n, m) of what is gone."""
    new = np.empty_like(state)
    above, below = faces[:-1, None], faces[1:, None]
    raised = bool((depth < 0).any())
    for k, (top, bottom) in enumerate(pairwise(faces)):
        j = 0 if raised else k  # where nothing moves down: only the layers from k on
        overlap = np.minimum(bottom + depth, below[j:]) - np.maximum(top + depth, above[j:])
        np.einsum("cjm,jm->cm", state[:, j:], np.maximum(overlap, 0.0) / (bottom - top), out=new[:, k])
    gone = np.clip(depth - above, 0.0, below - above)
    if raised:
        gone += np.clip(below - (faces[-1] + depth), 0.0, below - above)
    return new, np.einsum("cjm,jm->cm", state, gone)


def closing_residual(before: Array, after: Array, removed: Array, faces: Array) -> float:
    """Largest difference of both sides of (b) over the largest integral of |before|; 0 without strain."""
    h = np.diff(faces)[:, None, None]
    scale = (np.abs(before) * h).sum(axis=-3).max(initial=0.0)
    difference = (after * h).sum(axis=-3) + removed - (before * h).sum(axis=-3)
    return float(np.abs(difference).max() / scale) if scale > 0 else 0.0


T = TypeVar("T", bound=np.generic)


@dataclass(frozen=True, eq=False)
class WearState:
    """Wear so far on the grid: depth (nx, ny) in m; by cycle volumes in m3: removed, raw (before smoothing),
    roofed and roof (see `Worn`) and filled (which smoothing leaves or raises); columns removed to the bottom;
    residuals of the remap.
    """

    cell_area: float
    depth: Array
    volumes: tuple[float, ...] = ()
    raw_volumes: tuple[float, ...] = ()
    roofed_volumes: tuple[float, ...] = ()
    roof_volumes: tuple[float, ...] = ()
    filled_volumes: tuple[float, ...] = ()
    bottom_columns: tuple[int, ...] = ()
    residuals: tuple[float, ...] = ()

    @property
    def volume(self) -> float:
        """Removed so far, in m3."""
        return sum(self.volumes)

    def volume_of(self, thickness: Array) -> float:
        """Volume in m3 of a layer of this thickness in m on the cells, (nx, ny)."""
        return float(self.cell_area * thickness.sum())


@dataclass(frozen=True)
class WearLaw:
    """Wear of a grid of `shape` (nx, ny) cells hx, hy in m, at limits of the plastic strain. rule: of the
    scene; wraps: whether all repeats along x and along y.
    """

    shape: tuple[int, int]
    hx: float
    hy: float
    limits: StrainLimits
    rule: Wear
    wraps: Wraps = (False, False)

    def fresh(self) -> WearState:
        """The surface before the first cycle."""
        return WearState(self.hx * self.hy, np.zeros(self.shape))

    def margin(self, peeq: Array, faces: Array) -> float:
        """1 less the largest plastic strain of cells, (n_layers, nx, ny), over its limit; faces in m."""
        return 1.0 - float((peeq / self.limits((faces[:-1] + faces[1:]) / 2)[:, None, None]).max())

    def removed(
        self,
        state: WearState,
        fields: dict[str, Array],
        faces: Array,
        window: Window,
        *,
        cells: Mask,
        peeq: Array,
    ) -> tuple[WearState, Mask, dict[str, Array]]:
        """Wear after one more cycle; below the new surface the cells of a window that are not fresh,
        (n_layers, nx, ny), and the fields (..., n) of these. peeq: the accumulated strain that decides.
        """
        rule, filter_by = self.rule, (self.rule.smoothing_window, self.rule.smoothing_order)
        raw = worn_depth(peeq, faces, self.limits, rule.interpolate, roof_falls=rule.roof == "falls")
        depth, roofed, roof = (self._on_grid(each, window) for each in raw[:3])
        whole = Worn(depth, roofed, roof, self._on_grid(raw.at_bottom, window))
        if rule.smoothing_fills:
            depth = filtered(whole.depth, *filter_by, wraps=self.wraps)
        else:
            depth = smoothed(whole.depth, *filter_by, all_removed=True, wraps=self.wraps)
        columns = cells.any(axis=0)  # all others are fresh, and stay so
        below, worst, worn = {}, 0.0, depth[window.slices][columns][:, None]
        before, after = cells[:, columns], cells.copy()
        after[:, columns] = remapped(before[..., None].astype(float), faces, worn)[0][..., 0] > 0
        for name, values in fields.items():
            field = np.zeros((*values.shape[:-1], *before.shape, 1))
            field[..., before, 0] = values
            moved, gone = remapped(field, faces, worn)
            worst = max(worst, closing_residual(field, moved, gone, faces))
            below[name] = np.ascontiguousarray(moved[..., after[:, columns], 0])
        return with_cycle(state, whole, depth, worst), after, below

    def _on_grid(self, field: NDArray[T], window: Window) -> NDArray[T]:
        """A field of the window on the whole grid, zero outside of it."""
        out: NDArray[T] = np.zeros(self.shape, dtype=field.dtype)
        out[window.slices] = field
        return out


def with_cycle(state: WearState, raw: Worn, depth: Array, residual: float) -> WearState:
    """The wear state after one more cycle; the same array of depths where nothing is removed."""
    return replace(
        state,
        depth=state.depth + depth if depth.any() else state.depth,
        volumes=(*state.volumes, state.volume_of(depth)),
        raw_volumes=(*state.raw_volumes, state.volume_of(raw.depth)),
        roofed_volumes=(*state.roofed_volumes, state.volume_of(raw.roofed)),
        roof_volumes=(*state.roof_volumes, state.volume_of(raw.roof)),
        filled_volumes=(*state.filled_volumes, state.volume_of(np.maximum(raw.depth - depth, 0.0))),
        bottom_columns=(*state.bottom_columns, int(raw.at_bottom.sum())),
        residuals=(*state.residuals, residual),
    )
