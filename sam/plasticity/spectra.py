# SPDX-License-Identifier: MIT
"""The half-space as seen from a box of cells: stresses and surface displacements from pressure and plastic
strain.

Paper Eq. 6 and 7, second sums, and the stress part of the first. In the plane the sums are convolutions (FFT,
exactly as in `sam.contact.convolution`), over depth they are a dense matrix for each wave number, so layers
may have any thickness.

A traction q_x on the surface enters like the pressure; its coefficients are made when one is first given.

Each coefficient is even or odd in x and in y. Its transform over the lags -N .. N-1 is then (-i)^(o_x + o_y)
times a real number, o = 1 for odd, that is even or odd in the wave number. With phases (-i)^x_I, x_I the
number of indices 1 in component I (and y_I likewise), taken out of the strains and put into the stresses,
only real matrices for wave numbers >= 0 are stored.
"""

from __future__ import annotations

from functools import cached_property, lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sam.arrays import Array
from sam.contact.convolution import Counters, Transforms, real_spectrum
from sam.contact.operators import PeriodicHalfSpaces
from sam.kernels.eigenstrain import EXCHANGED, surface_displacement_coefficients
from sam.kernels.layer_stress import LayerStress, functions_of
from sam.kernels.patches import ODD_X, ODD_Y, STRESS, Cuboids, Lags
from sam.kernels.store import kept
from sam.kernels.waves import load_waves, strain_displacement_waves
from sam.plasticity.cell_means import (
    CellMeans,
    CellSpectra,
    Parities,
    first_lags,
    gauss_depths,
    mean_stress_of_load,
)
from sam.plasticity.swept import GAUSS, Images, PeriodImages, SweptLayers

Reals = NDArray[Any]
"""Real numbers in the precision of the operator, single or double."""
TWICE = ((np.outer(ODD_X, ODD_X) + np.outer(ODD_Y, ODD_Y)) % 2 == 1).ravel()  # 6 I + J, where (-i)^2 is left
ODD_LAGS = [(x, y) for x, y in zip(*(np.not_equal.outer(o, o).ravel() for o in (ODD_X, ODD_Y)), strict=True)]
"""Of 6 I + J, whether the coefficient is odd in the lag in x and in y."""
SIGN = np.where(TWICE, -1.0, 1.0)  # of what is stored
EVEN = np.zeros(1, int), np.zeros(1, int)  # parities in x and y of pressure and u_z
CACHED_BOXES = 4  # spectra that are kept: the boxes of a history, or of both grids of an extrapolation
# tolerance of the plastic loop from which single precision, 1e-7 of the largest stress, is enough
SINGLE = 5e-5


class BoxSpectra:
    """Real transforms of coefficients of cuboids, with mu = 1; stored: of which wave numbers; images: of the
    strain in (nx, ny) `cells` where its stress is swept, to an error of it; period: where all repeats with
    the transforms, and nothing is to be taken off.
    """

    def __init__(
        self,
        cuboids: Cuboids,
        single: bool,
        exchange: bool = False,
        *,
        cells: tuple[int, int] = (0, 0),
        error: float = 0.0,
        period: PeriodicHalfSpaces | None = None,
    ):
        self.period = period
        self.cuboids, self.half = cuboids, cuboids.lags.shape
        self.real = np.float32 if single else np.float64
        every = np.ones((self.half[0] + 1, self.half[1] + 1), dtype=bool)
        self.stored = np.flatnonzero(np.triu(every)) if exchange else slice(None)
        self.waves = every.ravel()[self.stored].size
        self.images: PeriodImages | None = None
        lengths = 2 * self.half[0], 2 * self.half[1]
        self.all_cells = Lags(*lengths, 1.0, cuboids.lags.hy)
        if error:
            if period is None:
                self.images = PeriodImages(cuboids, cells, lengths, error)
            self.repeated = self.images or Images(cuboids, lengths, error)
            kx, ky = (np.arange(n + 1) * np.pi / n for n in self.half)
            waves = np.array(np.broadcast_arrays(kx[:, None], ky / cuboids.lags.hy)).reshape(2, -1)
            waves = waves[:, self.stored]
            self.layers: Reals | SweptLayers = SweptLayers(self, waves, cuboids, error=error, real=self.real)
        else:
            shape = self.waves, 6 * cuboids.layers, 6 * cuboids.layers
            self.layers = kept(repr((cuboids, exchange)), shape, self.real, lambda: self._dense(shape))

    def _dense(self, shape: tuple[int, int, int]) -> Reals:
        """The matrices between all layers, (waves, 6 layers, 6 layers)."""
        layers, exchange = self.cuboids.layers, not isinstance(self.stored, slice)
        out = np.empty(shape, dtype=self.real)
        spectrum = np.zeros((36, layers, *np.add(self.half, 1)), dtype=self.real)
        rows = spectrum.reshape(6, 6 * layers, *spectrum.shape[2:])
        stress = self._layer_stress(slice(None), slice(None))
        for i in range(layers):
            stress.of(i, spectrum)
            start = 0
            for k in range(rows.shape[2]):  # one row of wave numbers at a time stays in the cache
                of_row = rows[:, :, k, k * exchange :].transpose(2, 0, 1)
                out[start : start + len(of_row), i::layers] = of_row
                start += len(of_row)
        return out

    def _layer_stress(self, observed: slice, sources: slice) -> LayerStress:
        """Spectra of the means over the cells of some layers by strain in some, with their sign."""
        faces, lags = self.cuboids.depths, self.cuboids.lags
        some = np.append(faces[:-1][sources], faces[1:][sources][-1])
        square = lags.nx == lags.ny and lags.hx == lags.hy and not lags.period
        return LayerStress(
            *(
                CellSpectra(lags, self.period is not None),
                gauss_depths(faces)[observed],
                some,
                self.cuboids.nu,
            ),
            scale=SIGN,
            exchanged=square,
        )

    def full_space(self, observed: int, sources: slice) -> Array:
        """See `sam.plasticity.swept.Exact`."""
        found = self._layer_stress(slice(observed, observed + 1), sources).of_part(0, image=False)
        parts = [self._periodic(part, False, observed, j) for j, part in enumerate(found, sources.start)]
        return np.stack(parts, axis=2)

    def image(self, layers: int) -> Array:
        """See `sam.plasticity.swept.Exact`."""
        some = slice(0, layers)
        stress, out = self._layer_stress(some, some), np.empty((6, layers, 6, layers, self.waves))
        for i in range(layers):
            for j, part in enumerate(stress.of_part(i, image=True)):
                out[:, i, :, j] = self._periodic(part, True, i, j)
        return out

    def _periodic(self, spectrum: Array, image: bool, observed: int, source: int) -> Array:
        """The spectrum of a coefficient, (36, N_x + 1, N_y + 1), with that of its periodic images, (6, 6,
        waves).
        """
        (top, bottom), (upper, lower) = (self.cuboids.faces[i : i + 2] for i in (observed, source))
        more = self.repeated.between(image, (top, bottom), (upper, lower), lags=self.half)
        nx, ny = np.add(self.half, self.period is not None)
        out = spectrum.reshape(36, -1)[:, self.stored].copy()
        for row, odd in enumerate(ODD_LAGS):
            periodic = real_spectrum(more[row, :nx, :ny], self.half, odd)
            out[row] += SIGN[row] * periodic.ravel()[self.stored]
        return out.reshape(6, 6, -1)

    def stress(self, strain: Reals) -> Reals:
        """Stress/mu of strain in wave numbers, both (waves, 6 layers, r): paper Eq. 7, second sum."""
        if isinstance(self.layers, SweptLayers):
            out = self.layers(strain)
            if self.period is not None:
                out[0] = self.period.mean_residual(strain[0], self.cuboids.nu)
            return out
        if strain.shape[-1] == 1:  # bound by the memory of the matrices: einsum reads them faster than matmul
            return np.asarray(np.einsum("pij,pj->pi", self.layers, strain[..., 0])[..., None])
        return np.asarray(self.layers @ strain)

    @cached_property
    def own_stress(self) -> Array:
        """Stress/mu of plastic strain in its own cell, (6, 6, n_layers)."""
        faces, means = self.cuboids.depths, functions_of(first_lags(self.cuboids.lags, (1, 1)), CellMeans)
        stress = LayerStress(means, gauss_depths(faces), faces, self.cuboids.nu)
        out = np.zeros((36, len(faces) - 1, 1, 1))
        for i in range(len(faces) - 1):
            own = slice(i, i + 1)
            stress.of(i, out[:, own], own)
        return out.reshape(6, 6, -1)

    def _of_waves(self, waves: Array) -> Reals:
        """Spectra (6, n_layers, N_x + 1, N_y + 1) as `_of_surface` has them."""
        rows = waves.reshape(-1, *waves.shape[2:])
        return np.ascontiguousarray(np.moveaxis(rows, 0, -1), dtype=self.real)

    def _of_load(self, load: int) -> Reals:
        """Spectra of the stress of a load, (N_x + 1, N_y + 1, 6 n_layers)."""
        cuboids, period = self.cuboids, self.period
        if period is None:
            return self._of_surface(mean_stress_of_load(cuboids, load), ODD_X ^ int(load == 1))
        cells, nu, points = self.all_cells, cuboids.nu, gauss_depths(cuboids.depths)
        each = [
            load_waves("stress", STRESS, cells, nu, load=load, depths=z, point=GAUSS[1] / 2) for z in points
        ]
        waves = np.stack(each, axis=1)
        waves[:, :, 0, 0] = period.mean_stress({load: 1.0}, nu)[:, None]
        return self._of_waves(waves)

    def _of_surface(self, kernel: Array, odd_x: Parities) -> Reals:
        """Spectra of (6, n_layers, nx, ny) between layers and surface, (N_x + 1, N_y + 1, 6 n_layers)."""
        rows = [real_spectrum(part, self.half, odd) for part, *odd in zip(kernel, odd_x, ODD_Y, strict=True)]
        return np.ascontiguousarray(np.moveaxis(np.concatenate(rows), 0, -1), dtype=self.real)

    @cached_property
    def strain_to_displacement(self) -> Reals:
        """Spectra of the displacement of the surface by strain, (N_x + 1, N_y + 1, 6 n_layers)."""
        cuboids = self.cuboids
        if self.period is None:
            return self._of_surface(surface_displacement_coefficients(cuboids), ODD_X)
        return self._of_waves(strain_displacement_waves(self.all_cells, cuboids.faces, cuboids.nu))

    @cached_property
    def pressure_to_stress(self) -> Reals:
        """Spectra of the stress of a pressure, (N_x + 1, N_y + 1, 6 n_layers, 1)."""
        return self._of_load(3)[..., None]

    @cached_property
    def loads_to_stress(self) -> Reals:
        """The same, (..., 2), also of a traction along x, odd in x: its phase is -i, and (-i)^2 is left where
        both are.
        """
        spectrum = self._of_load(1) * np.repeat((-1.0) ** ODD_X, self.cuboids.layers).astype(self.real)
        return np.concatenate([self.pressure_to_stress, spectrum[..., None]], axis=-1)


@lru_cache(maxsize=CACHED_BOXES)
def spectra_of(cuboids: Cuboids, single: bool, exchange: bool, **keys: Any) -> BoxSpectra:
    """Spectra by content: boxes with equal transforms, layers (in cells) and Poisson's ratio share them."""
    return BoxSpectra(cuboids, single, exchange, **keys)


class InWaves(NamedTuple):
    """Tensors in the layers: in wave numbers, (N_x + 1, N_y + 1, 6 n_layers, r), and what periodic images of
    the box need of them or make of them, see `PeriodImages`.
    """

    columns: Reals
    images: Array | None = None


class BoxOperator:
    """Stress in the cells of a box and u_z of its surface, of plastic strain and loads, on the cells that
    `keep` leaves. box: cells as lags, in m, layers from 0; mu in Pa; tolerance: of the iteration, from
    which the precision follows; mirror: of all fields in x (with y) and y; exchange: of x and y, half of the
    wave numbers give all; swept: error of the stress/mu of a unit strain by sweeps over the layers in place
    of matrices between all of them.
    """

    period: PeriodicHalfSpaces | None = None

    def __init__(
        self,
        box: Cuboids,
        mu: float,
        counters: Counters,
        *,
        tolerance: float = 0.0,
        mirror: tuple[bool, bool] = (False, False),
        exchange: bool = False,
        swept: float = 0.0,
    ):
        lags, single = box.lags, tolerance >= SINGLE
        self.transforms = Transforms(
            lags.shape, mirror, single=single, counters=counters, periodic=self.period is not None
        )
        self.transforms.wraps = lags.period == lags.ny > 1
        self.shape, self.layers = lags.shape, box.layers
        self.mu, self.hx, self.counters = mu, lags.hx, counters
        # rounded, so that equal boxes in other units are one entry
        aspect = float(f"{lags.hy / lags.hx:.12g}")
        in_cells = tuple(float(f"{z / lags.hx:.12g}") for z in box.faces)
        in_cells_of_hx = Cuboids(Lags(*self.transforms.half, 1.0, aspect, lags.period), in_cells, box.nu)
        cells = lags.shape if swept else (0, 0)
        self.spectra = spectra_of(
            in_cells_of_hx, single, exchange, cells=cells, error=swept, period=self.period
        )
        self.exchange, self.real = exchange, self.transforms.real

    @property
    def memory(self) -> int:
        """Bytes of the stored coefficients."""
        images = self.spectra.images
        return self.spectra.layers.nbytes + (0 if images is None else images.nbytes)

    @property
    def own_stress(self) -> Array:
        """Stress in Pa of a unit plastic strain in its own cell, see `BoxSpectra.own_stress`."""
        return self.mu * self.spectra.own_stress

    def keep(self, field: Reals) -> Reals:
        """The part of (..., nx, ny) on the box that fields here have; a view."""
        return self.transforms.keep(field)

    def whole(self, field: Reals) -> Reals:
        """A kept field on all of the box: tensors (6, ...) or (N, 6, ...), or anything even in x and y."""
        if field.ndim == 5:
            return np.stack([self.whole(each) for each in field])
        if field.ndim == 4:
            return self.transforms.whole(field, ODD_X, ODD_Y)
        return self.transforms.whole(field[None], *EVEN)[0]

    def transformed(self, strain: Reals) -> InWaves:
        """Plastic strain (6, n_layers, nx, ny) in wave numbers."""
        columns = self.transforms.columns(strain, ODD_X, ODD_Y)
        columns = columns.reshape(*columns.shape[:2], 6 * self.layers, -1)
        images = self.spectra.images
        return InWaves(columns, None if images is None else images.moments(self.whole(strain)))

    def displacement(self, transformed: InWaves) -> Reals:
        """u_z of the surface due to plastic strain, (nx, ny) in m, > 0 into the body: paper Eq. 6."""
        # paper Eq. 6 in the wave numbers
        columns = np.einsum("xyj,xyjr->xyr", self.spectra.strain_to_displacement, transformed.columns)
        self.counters.displacement_applications += 1
        return self.transforms.fields(columns[:, :, None], *EVEN)[0] * self.hx

    def response(self, transformed: InWaves) -> InWaves:
        """Transform of the stress of plastic strain: paper Eq. 7, second sum."""
        self.counters.operator_applications += 1
        shape, images = transformed.columns.shape, None
        product = self.spectra.stress(transformed.columns.reshape(-1, *shape[2:])[self.spectra.stored])
        if self.exchange:
            product = self._exchanged(product)
        if self.spectra.images is not None and transformed.images is not None:
            images = -self.mu * self.spectra.images.values(transformed.images)
        product *= self.real(self.mu)
        return InWaves(product.reshape(shape), images)

    def _exchanged(self, product: Reals) -> Reals:
        """The product at all wave numbers from k_x <= k_y: 11 and 22, 23 and 13 change places with them."""
        n, layers = self.transforms.half[0] + 1, np.arange(self.layers)
        below, left = np.triu_indices(n)
        out = np.empty((n, n, *product.shape[1:]), dtype=product.dtype)
        out[left, below] = product[:, np.add.outer(self.layers * EXCHANGED, layers).ravel()]
        out[below, left] = product
        return out

    def stress(
        self,
        pressure: Array | None,
        response: InWaves | None = None,
        traction: Array | None = None,
    ) -> Reals:
        """Stress of pressure, traction (Pa) and plastic strain, (6, n_layers, nx, ny) in Pa: paper Eq. 7."""
        if pressure is not None and pressure.any():
            columns = self._of_loads(pressure[None] if traction is None else np.stack([pressure, traction]))
            if response is not None:
                columns += response.columns  # paper Eq. 4: elastic and residual stress
        elif response is not None:
            columns = response.columns
        else:
            return np.zeros((6, self.layers, *self.transforms.shape))
        columns = columns.reshape(*columns.shape[:2], 6, self.layers, -1)
        stress = self.transforms.fields(columns, ODD_X, ODD_Y)
        if self.spectra.images is not None and response is not None and response.images is not None:
            stress += self.keep(self.spectra.images.fields(response.images.astype(self.real)))
        return stress

    def _of_loads(self, loads: Array) -> Reals:
        """Transform of the stress of a pressure, or of one and a traction (odd in x), (r, nx, ny) in Pa."""
        which = np.arange(len(loads))
        columns = self.transforms.columns(loads, which, np.zeros_like(which))
        spectra = self.spectra.loads_to_stress if len(loads) > 1 else self.spectra.pressure_to_stress
        return np.asarray(spectra @ columns)  # paper Eq. 7, first sum


class PeriodicOperator(BoxOperator):
    """The same where all repeats with the box, of an even number of cells each way."""

    def __init__(self, period: PeriodicHalfSpaces, *of_cells: Any, **keys: Any):
        self.period = period
        super().__init__(*of_cells, **keys)
