# SPDX-License-Identifier: MIT
"""The half-space as seen from a box of cells: stresses and surface displacements from pressure and plastic strain.

Paper Eq. 6 and 7, second sums, and the stress part of the first. In the plane the sums are convolutions (FFT, exactly as in
`sam.convolution`), over depth they are a dense matrix for each wave number, so layers may have any thickness.

A traction q_x on the surface enters like the pressure; its coefficients are made when one is first given.

Each coefficient is even or odd in x and in y. Its transform over the lags -N .. N-1 is then (-i)^(o_x + o_y) times a real
number, o = 1 for odd, that is even or odd in the wave number. With phases (-i)^x_I, x_I the number of indices 1 in component I
(and y_I likewise), taken out of the strains and put into the stresses, only real matrices for wave numbers >= 0 are stored.
"""

from __future__ import annotations

from functools import cached_property, lru_cache

import numpy as np
from scipy import fft

from sam.convolution import Counters, half_length, real_spectrum
from sam.kernels.eigenstrain import residual_stress_coefficients, surface_displacement_coefficients
from sam.kernels.patches import STRESS, stress_coefficients

ODD_X = np.array([name.count("1") % 2 for name in STRESS])
ODD_Y = np.array([name.count("2") % 2 for name in STRESS])
PHASE = (-1j) ** (ODD_X + ODD_Y)
CACHED_BOXES = 4
SINGLE = 5e-5  # tolerance of the plastic loop from which single precision, 1e-7 of the largest stress, is enough
GAUSS = np.array([-1.0, 1.0]) / np.sqrt(3)  # points of the mean over a cell, in each direction
NEAR = 4  # cells: up to there stresses are means over the observed cell


def _points(faces: np.ndarray) -> np.ndarray:
    """Depths of the Gauss points of each layer, (n_layers, 2)."""
    return ((faces[1:] + faces[:-1])[:, None] + np.diff(faces)[:, None] * GAUSS) / 2


def _mean_stress(nx: int, ny: int, aspect: float, faces: np.ndarray, layer: int, nu: float) -> np.ndarray:
    """Stress in the cells of a layer due to each eigenstrain in each layer, its mean over the observed cell.

    (6, 6, n_layers, nx, ny). Gauss points up to NEAR cells away; beyond, where the stress is smooth, Gauss points over the
    thickness and second differences in the plane.
    """
    points = _points(faces)[layer]
    far = residual_stress_coefficients(nx + 1, ny + 1, 1.0, aspect, points, faces, nu).mean(axis=2)
    odd_x, odd_y = (np.not_equal.outer(odd, odd)[:, :, None] for odd in (ODD_X, ODD_Y))
    out = _plane_mean(far, odd_x, odd_y)
    near = min(NEAR, nx), min(NEAR, ny)
    at = [residual_stress_coefficients(*near, 1.0, aspect, points, faces, nu, s).mean(axis=2) for s in _shifts(aspect)]
    out[..., : near[0], : near[1]] = np.mean(at, axis=0)
    return out


def _mean_stress_of_load(nx: int, ny: int, aspect: float, faces: np.ndarray, nu: float, load: int = 3) -> np.ndarray:
    """Stress in the cells of each layer due to pressure (load 3) or traction along x (1), (6, n_layers, nx, ny), likewise."""
    points = _points(faces)
    depths, shape = points.ravel(), (6, *points.shape)
    far = stress_coefficients(nx + 1, ny + 1, 1.0, aspect, depths, nu, load).reshape(*shape, nx + 1, ny + 1)
    out = _plane_mean(far.mean(axis=2), (ODD_X ^ (load == 1))[:, None], ODD_Y[:, None])
    near = min(NEAR, nx), min(NEAR, ny)
    at = [stress_coefficients(*near, 1.0, aspect, depths, nu, load, shift=s) for s in _shifts(aspect)]
    out[..., : near[0], : near[1]] = np.mean(at, axis=0).reshape(*shape, *near).mean(axis=2)
    return out


def _plane_mean(kernel: np.ndarray, odd_x: np.ndarray, odd_y: np.ndarray) -> np.ndarray:
    """Mean over the cell in x and y to fourth order, K + (d_x^2 K + d_y^2 K)/24, from lags 0 .. n: lags 0 .. n - 1.

    odd_x, odd_y: parity of each kernel, for the lag -1.
    """
    inner = kernel[..., :-1, :-1]
    before_x = np.where(odd_x, -1.0, 1.0)[..., None] * kernel[..., 1, :-1]
    before_y = np.where(odd_y, -1.0, 1.0)[..., None] * kernel[..., :-1, 1]
    along_x = np.concatenate([before_x[..., None, :], kernel[..., :, :-1]], axis=-2)
    along_y = np.concatenate([before_y[..., :, None], kernel[..., :-1, :]], axis=-1)
    return inner + (np.diff(along_x, 2, axis=-2) + np.diff(along_y, 2, axis=-1)) / 24


def _shifts(aspect: float) -> list[tuple[float, float]]:
    """Gauss points of a cell in the plane, from its centre, in the unit of hx."""
    return [(x / 2, aspect * y / 2) for x in GAUSS for y in GAUSS]


class _Spectra:
    """Real transforms of the coefficients of a box, in the unit of its cells hx, with mu = 1."""

    def __init__(self, nx: int, ny: int, aspect: float, faces: tuple[float, ...], nu: float, single: bool):
        self.half, self.real = (half_length(nx), half_length(ny)), np.float32 if single else np.float64
        self.box = nx, ny, aspect, np.array(faces), nu
        faces = np.array(faces)
        layers = len(faces) - 1
        shape = self.half[0] + 1, self.half[1] + 1
        self.strain_to_stress = np.empty((*shape, 6 * layers, 6 * layers), dtype=self.real)
        for i in range(layers):
            kernel = _mean_stress(nx, ny, aspect, faces, i, nu)
            for row in range(6):
                for column in range(6):
                    odd = ODD_X[row] ^ ODD_X[column], ODD_Y[row] ^ ODD_Y[column]
                    both = (-1) ** (ODD_X[row] * ODD_X[column] + ODD_Y[row] * ODD_Y[column])  # (-i)^2
                    spectrum = both * real_spectrum(kernel[row, column], self.half, odd)
                    block = slice(column * layers, (column + 1) * layers)
                    self.strain_to_stress[:, :, row * layers + i, block] = np.moveaxis(spectrum, 0, -1)
        self.pressure_to_stress = self._of_surface(_mean_stress_of_load(*self.box), ODD_X)
        self.strain_to_displacement = self._of_surface(
            surface_displacement_coefficients(nx, ny, 1.0, aspect, faces, nu), ODD_X
        )

    def _of_surface(self, kernel: np.ndarray, odd_x: np.ndarray) -> np.ndarray:
        """Spectra of coefficients (6, n_layers, nx, ny) between layers and surface, (N_x + 1, N_y + 1, 6 n_layers)."""
        rows = [real_spectrum(part, self.half, odd) for part, *odd in zip(kernel, odd_x, ODD_Y, strict=True)]
        return np.ascontiguousarray(np.moveaxis(np.concatenate(rows), 0, -1), dtype=self.real)

    @cached_property
    def traction_to_stress(self) -> np.ndarray:
        """As pressure_to_stress. A traction along x is odd in x: its own phase is -i, and (-i)^2 is left where both are."""
        spectrum = self._of_surface(_mean_stress_of_load(*self.box, load=1), ODD_X ^ 1)
        return spectrum * np.repeat((-1.0) ** ODD_X, len(self.box[3]) - 1).astype(self.real)


@lru_cache(maxsize=CACHED_BOXES)
def _spectra(nx: int, ny: int, aspect: float, faces: tuple[float, ...], nu: float, single: bool) -> _Spectra:
    """Spectra by content: boxes of equal cells, layers (in cells) and Poisson's ratio share them."""
    return _Spectra(nx, ny, aspect, faces, nu, single)


class BoxOperator:
    """Stress in the cells of a box and normal displacement of its surface.

    nx, ny: cells; hx, hy in m; faces: (n_layers + 1,) depths of the layer faces in m, from 0; mu in Pa; fields are
    (nx, ny) and (6, n_layers, nx, ny), components 11 22 33 23 13 12 (tensor). sliding: whether tractions are to come;
    single: coefficients and transforms in single precision, 1e-7 of the largest stress, in half the time and memory.
    """

    def __init__(
        self, nx: int, ny: int, hx: float, hy: float, faces: np.ndarray, mu: float, nu: float, counters: Counters,
        sliding: bool = False, single: bool = False,
    ):  # fmt: skip
        self.shape, self.layers, self.mu, self.hx, self.counters = (nx, ny), len(faces) - 1, mu, hx, counters
        # rounded, so that equal boxes in other units are one entry
        aspect, in_cells = float(f"{hy / hx:.12g}"), tuple(float(f"{z / hx:.12g}") for z in faces)
        self.spectra = _spectra(nx, ny, aspect, in_cells, nu, single)
        self.real, self.complex = (np.float32, np.complex64) if single else (np.float64, np.complex128)
        self._phases = np.stack([PHASE, PHASE * (-1.0) ** ODD_X], axis=-1)[:, None, :].astype(self.complex)
        parts = [self.spectra.pressure_to_stress, *([self.spectra.traction_to_stress] if sliding else [])]
        self.from_surface = np.stack(parts, axis=-1)
        counters.tangential_kernels += sliding
        self.lengths = tuple(2 * n for n in self.spectra.half)
        self._mirror = -np.arange(self.spectra.half[0] + 1) % self.lengths[0]

    @property
    def memory(self) -> int:
        """Bytes of the stored coefficients."""
        return self.spectra.strain_to_stress.nbytes

    def _columns(self, field: np.ndarray) -> np.ndarray:
        """Transform of (..., nx, ny) as (N_x + 1, N_y + 1, ..., 2): wave numbers (k_x, k_y) and (-k_x, k_y), k >= 0."""
        rows = fft.rfft(field.astype(self.real, copy=False), n=self.lengths[1], axis=-1)  # rows of zeros need none
        spectrum = fft.fft(rows, n=self.lengths[0], axis=-2)
        self.counters.ffts += int(np.prod(field.shape[:-2], dtype=int))
        both = np.stack([spectrum[..., : self.spectra.half[0] + 1, :], spectrum[..., self._mirror, :]], axis=-1)
        return np.moveaxis(both, (-3, -2), (0, 1))

    def _field(self, columns: np.ndarray) -> np.ndarray:
        """The inverse of `_columns`, cropped to the box."""
        spectrum = np.empty((*columns.shape[2:-1], self.lengths[0], columns.shape[1]), dtype=self.complex)
        both = np.moveaxis(columns, (0, 1), (-3, -2))
        spectrum[..., self._mirror, :] = both[..., 1]
        spectrum[..., : self.spectra.half[0] + 1, :] = both[..., 0]
        self.counters.ffts += int(np.prod(columns.shape[2:-1], dtype=int))
        rows = fft.ifft(spectrum, axis=-2)[..., : self.shape[0], :]  # no others are wanted
        return fft.irfft(rows, n=self.lengths[1], axis=-1)[..., : self.shape[1]]

    def transformed(self, strain: np.ndarray) -> np.ndarray:
        """Plastic strain as the other methods take it: (N_x + 1, N_y + 1, 6 n_layers, 2), phases taken out."""
        columns = self._columns(strain)  # (kx, ky, 6, layers, 2)
        columns = columns * self._phases
        return columns.reshape(*columns.shape[:2], 6 * self.layers, 2)

    def displacement(self, transformed: np.ndarray) -> np.ndarray:
        """u_z of the surface due to plastic strain, (nx, ny) in m, > 0 into the body (Eq. 6)."""
        columns = (self.spectra.strain_to_displacement[..., None, :] @ transformed.view(self.real))[..., 0, :].view(self.complex)
        self.counters.displacement_applications += 1
        return self._field(columns) * self.hx

    def response(self, transformed: np.ndarray) -> np.ndarray:
        """Transform of the stress due to plastic strain, for `stress`: the one product with the stored matrices."""
        self.counters.operator_applications += 1
        parts = transformed.view(self.real)  # real and imaginary parts as columns: the matrices are real
        return self.real(self.mu) * (self.spectra.strain_to_stress @ parts).view(self.complex)

    def stress(
        self, pressure: np.ndarray | None, response: np.ndarray | None = None, traction: np.ndarray | None = None
    ) -> np.ndarray:
        """Stress due to surface pressure, traction along x (Pa) and plastic strain (`response`), (6, n_layers, nx, ny) in Pa.

        Paper Eq. 7.
        """
        loads = [(p, k) for k, p in enumerate((pressure, traction)) if p is not None and p.any()]
        if not loads and response is None:
            return np.zeros((6, self.layers, *self.shape))
        columns = self._of_loads(loads) if loads else response.copy()
        if loads and response is not None:
            columns += response
        columns = columns.reshape(*columns.shape[:2], 6, self.layers, 2)
        columns *= self._phases
        return self._field(columns)

    def _of_loads(self, loads: list[tuple[np.ndarray, int]]) -> np.ndarray:
        """Transform of the stress due to loads on the surface in Pa, each with 0 (pressure) or 1 (traction along x)."""
        phase = np.array([[1, 1], [-1j, 1j]], dtype=self.complex)  # of a load at k_x and at -k_x
        columns = np.stack([self._columns(load) * phase[k] for load, k in loads], axis=2)
        which = [k for _, k in loads]
        spectra = self.from_surface if len(which) == self.from_surface.shape[-1] else self.from_surface[..., which]
        return (spectra @ columns.view(self.real)).view(self.complex)
