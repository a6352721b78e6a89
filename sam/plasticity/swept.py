# SPDX-License-Identifier: MIT
"""Stress of plastic strain in the layers below a box by sweeps over depth, for each wave number: work and
memory grow with the number of layers, not with its square.

In axes along the wave vector (k = |k|, L along it, T across it in the plane) a strain e at the depth z' makes
at z, with w = W^T e and 1/R in wave numbers,

    full space, below:     k V (1 + k zeta a b^T) e^{-k zeta} w,                 zeta = z - z' > 0,
    above:                 the same with S V, S W and -zeta; S: signs under z -> -z,
    free surface:          k V (1 + k z a b^T)(F + k z' f b^T) e^{-k (z + z')} W^T S e,                    (h)

with three modes: two of P and SV waves, in the components LL, TT, 33, L3, one of SH waves, in T3 and LT,

    V = (LL + 2 nu TT + 33,   -2 LL - 2 nu TT + L3,   T3 + LT),
    W = (-(LL + 2 nu TT + 33)/2/(1 - nu),   (-LL - nu TT + L3)/(1 - nu),   T3 + LT),
    a = (1, 1, 0),   b = (1, -1, 0),   F = diag(-1, 1, 1),   f = (-1, 1, 0).

So all that a layer has to know of what lies on one side of it are four numbers at its face,

    P = k sum w e^{-k s},    Q = k sum k s b . w e^{-k s},    s: distance of the source from the face,

which cross a layer of thickness t as P -> e^{-kt} P, Q -> e^{-kt} (Q + kt b . P). One sweep up, the
reflection P -> F P + f Q, Q -> 0 at the free surface, and one sweep down give the stress in all layers.

Derived from the tables of `sam.kernels.eigenstrain`, which tests compare. In the plane the strain is uniform
in each cell, the stress its mean at 2 x 2 points; in depth likewise, exactly as in `sam.plasticity.spectra`.
What that leaves out are waves shorter than the cells (aliases), which reach about a cell: `NearBand` has
them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from math import log, pi
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from sam.arrays import Array, Mask
from sam.kernels.patches import Cuboids

Reals = NDArray[Any]
"""Real numbers in the precision of the operator, single or double."""
WAVES_AT_ONCE = 512  # that are swept together, so that they stay in the cache
GAUSS = np.array([-1.0, 1.0]) / np.sqrt(3)  # points of the mean over a cell, in each direction
# The largest stress/mu that waves two cells long leave of (h) between layers r cells apart, over e^{-pi r}:
# 5 to 8 for r = 1 to 3.
WORST = 8.0
DIGITS = 9  # to which thicknesses are compared


class Sweeps:
    """The operator (h) over mu, real as in `sam.plasticity.spectra`, without the full space in the layer of
    the strain. waves: k_x, k_y, (2, n) per hx; box: in hx, from z = 0.
    """

    def __init__(self, waves: Array, box: Cuboids, real: type[np.floating[Any]]):
        self.nu, self.real, (kx, ky), k = box.nu, real, waves, np.hypot(*waves)
        aspect = box.lags.hy / box.lags.hx
        c, s = np.divide(waves, k, out=np.zeros(waves.shape), where=k > 0)
        # cos, sin, cos^2, sin^2, cos sin and cos^2 - sin^2 of the direction of k
        self.direction = np.array([c, s, c * c, s * s, c * s, c * c - s * s], dtype=real)
        once, self.which = np.unique(np.round(np.diff(box.depths), DIGITS), return_inverse=True)
        kt = k * once[:, None]
        near, far = kt / 2 * (1 - GAUSS[1]), kt / 2 * (1 + GAUSS[1])  # k times the distance of both points
        crossed, at_near, at_far = np.exp(-kt), np.exp(-near), np.exp(-far)
        # strain uniform in the cell, stress at its points
        plane = np.sinc(kx / (2 * np.pi)) * np.sinc(ky * aspect / (2 * np.pi))
        plane *= np.cos(kx * GAUSS[1] / 2) * np.cos(ky * aspect * GAUSS[1] / 2)
        self.layers = np.array(
            [
                crossed,
                kt * crossed,
                (at_near + at_far) / 2,  # means of e^{-k s} and of k s e^{-k s} over the points
                (near * at_near + far * at_far) / 2,
                plane * -np.expm1(-kt),  # k times the integrals of them over the layer
                plane * (-np.expm1(-kt) - kt * crossed),
            ],
            dtype=real,
        )

    def __call__(self, strain: Reals, *, reflected: bool = True) -> Reals:
        """Stress/mu (n, 6 layers, r) of strain (n, 6 layers, r); reflected: with that of the free surface."""
        out = np.empty(strain.shape, dtype=self.real)
        for start in range(0, len(strain), WAVES_AT_ONCE):
            some = slice(start, start + WAVES_AT_ONCE)
            x = np.ascontiguousarray(np.moveaxis(strain[some], 0, -1), dtype=self.real)
            x = x.reshape(6, len(self.which), *x.shape[1:])
            out[some] = np.moveaxis(self._swept(x, some, reflected).reshape(-1, *x.shape[2:]), -1, 0)
        return out

    def matrices(self, reflected: bool) -> Iterator[tuple[slice, Reals]]:
        """The operator itself, some waves at a time: (n, 6, layers, 6, layers)."""
        layers = len(self.which)
        unit = np.eye(6 * layers, dtype=self.real).reshape(6, layers, -1, 1)
        for start in range(0, self.direction.shape[1], WAVES_AT_ONCE):
            some = slice(start, start + WAVES_AT_ONCE)
            x = unit.repeat(len(self.direction[0, some]), axis=-1)
            found = self._swept(x, some, reflected)
            yield some, np.moveaxis(found, -1, 0).reshape(-1, 6, layers, 6, layers)

    def _swept(self, x: Reals, some: slice, reflected: bool) -> Reals:
        """The same of (6, layers, r, n)."""
        nu, (c, s, cc, ss, cs, cc_ss) = self.nu, self.direction[:, some]
        along = cc * x[0] + ss * x[1] - 2 * cs * x[5]  # (-i)^2 was taken out of 12
        across = x[0] + x[1] - along
        even, odd = np.empty((3, *x.shape[1:]), dtype=self.real), np.zeros((3, *x.shape[1:]), dtype=self.real)
        even[0] = (along + 2 * nu * across + x[2]) / (-2 * (1 - nu))  # W^T e of (h)
        even[1] = (along + nu * across) / (nu - 1)
        even[2] = cs * (x[0] - x[1]) + cc_ss * x[5]
        odd[1] = (c * x[4] + s * x[3]) / (1 - nu)
        odd[2] = c * x[3] - s * x[4]
        numbers, layers = np.zeros((4, *x.shape[2:]), dtype=self.real), range(len(self.which))
        up = self._one_way(even - odd, numbers, reversed(layers), some)
        numbers[:2] += np.multiply.outer([-1, 1], numbers[3]) - [2 * numbers[0], 0 * numbers[1]]  # F P + f Q
        numbers[3] = 0
        down = self._one_way(even + odd, numbers if reflected else 0 * numbers, layers, some)
        y, odd = down + up, down - up
        out = np.empty_like(x)
        along, across = y[0] - 2 * y[1], 2 * nu * (y[0] - y[1])  # V y of (h)
        out[0] = cc * along + ss * across + 2 * cs * y[2]
        out[1] = along + across - out[0]
        out[2] = y[0]
        out[3] = c * odd[2] + s * odd[1]
        out[4] = c * odd[1] - s * odd[2]
        out[5] = cc_ss * y[2] - cs * (along - across)
        return out

    def _one_way(self, w: Reals, numbers: Reals, layers: Iterable[int], some: slice) -> Reals:
        """The modes (3, layers, r, n) in each layer by those swept before; numbers: P and Q, are moved on."""
        y, p, q = np.empty_like(w), numbers[:3], numbers[3]
        for i in layers:
            crossed, moved, mean, moment, source, of_source = self.layers[:, self.which[i], some]
            difference = p[0] - p[1]  # b . P
            np.multiply(mean, p, out=y[:, i])
            y[:2, i] += mean * q + moment * difference
            q *= crossed
            q += moved * difference + of_source * (w[0, i] - w[1, i])
            p *= crossed
            p += source * w[:, i]
        return y


class Exact(Protocol):
    """Spectra of the coefficients of cells and their periodic images, real as above, over mu."""

    def full_space(self, observed: int, sources: slice) -> Array:
        """Of strain in some layers on one, in the full space: (6, 6, sources, n)."""

    def image(self, layers: int) -> Array:
        """Of strain in the uppermost layers, what the free surface adds: (6, layers, 6, layers, n)."""


@dataclass
class Run:
    """Layers in a row, from `first` on, that have alike neighbours at the same offsets. keys: of an offset,
    both thicknesses and the distance; made: of which layer; matrices: (n, 6, 6 offsets).
    """

    first: int
    count: int = 0
    keys: dict[int, tuple[float, ...]] = field(default_factory=dict)
    made: dict[int, int] = field(default_factory=dict)
    matrices: Reals = field(default_factory=lambda: np.empty(0))

    def takes(self, keys: Mapping[int, tuple[float, ...]], layers: int) -> bool:
        """Whether the next layer has the same neighbours, but for those beyond either end."""
        i, known = self.first + self.count, self.keys
        alike = all(known[d] == keys[d] if d in known else i - 1 + d < 0 for d in keys)
        return not self.count or (alike and not any(0 <= i + d < layers for d in known if d not in keys))

    def stress(self, strain: Reals, some: slice) -> Reals:
        """Stress/mu (n, 6, count, r) in the run by its neighbours; strain: (n, 6, layers, r), some waves."""
        n, _, layers, r = strain.shape
        begin, offsets = self.first + min(self.keys), len(self.keys)
        end = begin + offsets + self.count - 1
        x = strain[:, :, max(begin, 0) : end]
        if begin < 0 or end > layers:  # nothing beyond the ends
            x = np.pad(x, [(0, 0), (0, 0), (max(-begin, 0), max(end - layers, 0)), (0, 0)])
        windows = np.lib.stride_tricks.sliding_window_view(x, offsets, axis=2).transpose(0, 1, 4, 2, 3)
        product = self.matrices[some] @ windows.reshape(n, 6 * offsets, self.count * r)
        return np.asarray(product.reshape(n, 6, self.count, r))


def runs_of(faces: Array, within: Mask) -> list[Run]:
    """The layers in runs; within: (layers, layers), which are neighbours."""
    thick, centre = np.round(np.diff(faces), DIGITS), (faces[1:] + faces[:-1]) / 2
    apart, out = np.round(np.subtract.outer(centre, centre), DIGITS), [Run(0)]
    for i, near in enumerate(within):
        keys = {int(j) - i: (thick[i], thick[j], apart[i, j]) for j in np.flatnonzero(near)}
        if not out[-1].takes(keys, len(within)):
            out.append(Run(i))
        out[-1].made |= {d: i for d in keys if d not in out[-1].keys}
        out[-1].keys |= keys
        out[-1].count += 1
    return out


def neighbours(faces: Array, error: float, aspect: float = 1.0) -> tuple[list[Run], int]:
    """Which layers are so close that (h) leaves more than an error, in runs; and how many of the uppermost
    are as close to the mirror image of the first. faces: in hx; aspect: hy/hx.
    """
    reach = log(WORST / error) / pi * max(1.0, aspect) - 10.0**-DIGITS
    gap = np.subtract.outer(faces[:-1], faces[1:])
    return runs_of(faces, np.maximum(gap, gap.T) < reach), int(np.searchsorted(faces[:-1], reach))


class SweptLayers:
    """The operator of a box, strain to stress/mu in its layers: by `Sweeps`, and between layers less than
    some cells apart by the `exact` coefficients less (h). waves, box: as there; error: of the stress/mu of a
    unit strain, what the shortest waves leave of (h) between the other layers.
    """

    def __init__(
        self, exact: Exact, waves: Array, box: Cuboids, *, error: float, real: type[np.floating[Any]]
    ):
        faces = box.depths

        def matrices(some: slice, reflected: bool) -> Iterator[tuple[slice, Array]]:
            layers = faces[some.start : some.stop + 1] - faces[some.start]
            return Sweeps(waves, replace(box, faces=tuple(layers)), np.float64).matrices(reflected)

        self.sweeps = Sweeps(waves, box, real)
        self.runs, self.top = neighbours(faces, error, box.lags.hy / box.lags.hx)
        for run in self.runs:
            offsets = sorted(run.made)
            found = np.empty((waves.shape[1], 6, 6, len(offsets)), dtype=real)
            for i in dict.fromkeys(run.made.values()):
                new = [k for k, d in enumerate(offsets) if run.made[d] == i]
                sources = slice(i + offsets[new[0]], i + offsets[new[-1]] + 1)
                first = min(sources.start, i)
                columns = slice(sources.start - first, sources.stop - first)
                spectra = exact.full_space(i, sources)
                for some, swept in matrices(slice(first, max(sources.stop, i + 1)), False):
                    left = np.moveaxis(spectra[..., some], -1, 0) - swept[:, :, i - first, :, columns]
                    found[some, ..., new[0] : new[-1] + 1] = left
            run.matrices = found.reshape(len(found), 6, -1)
        self.image = np.empty((waves.shape[1], 6, self.top, 6, self.top), dtype=real)
        spectra = exact.image(self.top)
        whole, alone = (matrices(slice(0, self.top), reflected) for reflected in (True, False))
        for (some, both), (_, full) in zip(whole, alone, strict=True):
            self.image[some] = np.moveaxis(spectra[..., some], -1, 0) - (both - full)

    @property
    def nbytes(self) -> int:
        """Bytes of the stored coefficients."""
        return self.image.nbytes + self.sweeps.layers.nbytes + sum(run.matrices.nbytes for run in self.runs)

    def __call__(self, strain: Reals) -> Reals:
        """Stress/mu (n, 6 layers, r) of strain (n, 6 layers, r)."""
        out = self.sweeps(strain)
        shape = len(strain), 6, -1, strain.shape[-1]
        x, y, top = strain.reshape(shape), out.reshape(shape), 6 * self.top
        for start in range(0, len(strain), WAVES_AT_ONCE):
            some = slice(start, start + WAVES_AT_ONCE)
            for run in self.runs:
                y[some, :, run.first : run.first + run.count] += run.stress(x[some], some)
            image, uppermost = self.image[some], x[some, :, : self.top]
            product = image.reshape(-1, top, top) @ uppermost.reshape(-1, top, uppermost.shape[-1])
            y[some, :, : self.top] += product.reshape(uppermost.shape)
        return out
