# SPDX-License-Identifier: MIT
"""Influence coefficients of uniformly loaded rectangles on a coated half-space, without periods and without
aliases.

The response of `Response` to the wave vector k (cos phi, sin phi) is rotated to x and y. What each load and
component holds are terms f(k) cos(m phi) or f(k) sin(m phi), whose inverse transforms are i^m g(r) cos(m
theta) or sin, g the Hankel transform of order m of f (`RadialTable`): STRESS_TABLES and DISPLACEMENT_TABLES
list the radial functions, each made once, and the ENTRIES where they belong. Then `CellIntegrals` integrates
them over the cells.

At a depth z the response decays like e^{-kz}. Where that is slow, at the surface and in the coating less than
a cell deep, the closed forms of a half-space of coating (sam.kernels.patches) are taken out and added after:
the rest decays like e^{-k (2h - z)}. Deeper they would only cost digits, since their corner sums cancel.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from sam.arrays import Array, Mask
from sam.kernels.lags import Lags
from sam.kernels.patches import STRESS, displacement_coefficients, stress_coefficients
from sam.layered.cells import Angular, CellIntegrals
from sam.layered.radial import RadialTable, wave_numbers
from sam.layered.response import Layers, Response, normal_compliance

_ONE = Angular(0)
_COS = Angular(1)
_SIN = Angular(1, sine=True)
_COS2 = Angular(2)
_SIN2 = Angular(2, sine=True)
_COS3 = Angular(3)
_SIN3 = Angular(3, sine=True)

# Radial functions: order m of the Hankel transform and f from the stresses under p, q_L (zz, LL, TT, zL) and
# q_T (zT, LT).
# A load q_x has q_L = cos(phi), q_T = -sin(phi); the signs collect i^m and the phases of the sine components.
STRESS_TABLES: dict[int, dict[str, tuple[int, Callable[[Array, Array, Array], Array]]]] = {
    3: {
        "zz": (0, lambda p, q, t: p[0]),
        "mean": (0, lambda p, q, t: (p[1] + p[2]) / 2),
        "shear": (1, lambda p, q, t: p[3]),
        "deviator": (2, lambda p, q, t: (p[2] - p[1]) / 2),
    },
    1: {
        "zz": (1, lambda p, q, t: -q[0]),
        "mean": (1, lambda p, q, t: -(q[1] + q[2]) / 2),
        "shear": (0, lambda p, q, t: (q[3] + t[0]) / 2),
        "shear2": (2, lambda p, q, t: (t[0] - q[3]) / 2),
        "deviator": (1, lambda p, q, t: (q[2] - q[1]) / 4 - t[1] / 2),
        "deviator3": (3, lambda p, q, t: (q[1] - q[2]) / 4 - t[1] / 2),
    },
}
STRESS_ENTRIES: dict[tuple[str, int], tuple[tuple[str, Angular, int], ...]] = {
    ("33", 3): (("zz", _ONE, 1),),
    ("11", 3): (("mean", _ONE, 1), ("deviator", _COS2, 1)),
    ("22", 3): (("mean", _ONE, 1), ("deviator", _COS2, -1)),
    ("12", 3): (("deviator", _SIN2, 1),),
    ("13", 3): (("shear", _COS, 1),),
    ("23", 3): (("shear", _SIN, 1),),
    ("33", 1): (("zz", _COS, 1),),
    ("11", 1): (("mean", _COS, 1), ("deviator", _COS, 1), ("deviator3", _COS3, 1)),
    ("22", 1): (("mean", _COS, 1), ("deviator", _COS, -1), ("deviator3", _COS3, -1)),
    ("12", 1): (("deviator", _SIN, 1), ("deviator3", _SIN3, 1)),
    ("13", 1): (("shear", _ONE, 1), ("shear2", _COS2, 1)),
    ("23", 1): (("shear2", _SIN2, 1),),
}
# The same of the surface displacement, f from mu_1 k (c_zz, c_zL, c_LL, c_TT).
DISPLACEMENT_TABLES: dict[str, tuple[int, Callable[[Array], Array]]] = {
    "normal": (0, lambda c: c[0]),
    "cross": (1, lambda c: c[1]),
    "along": (0, lambda c: (c[2] + c[3]) / 2),
    "turned": (2, lambda c: (c[3] - c[2]) / 2),
}
DISPLACEMENT_ENTRIES: dict[tuple[int, int], tuple[tuple[str, Angular, int], ...]] = {
    (3, 3): (("normal", _ONE, 1),),
    (1, 3): (("cross", _COS, 1),),
    (2, 3): (("cross", _SIN, 1),),
    (3, 1): (("cross", _COS, -1),),
    (1, 1): (("along", _ONE, 1), ("turned", _COS2, 1)),
    (2, 1): (("turned", _SIN2, 1),),
}
_EXCHANGED = {"11": "22", "22": "11", "33": "33", "23": "13", "13": "23", "12": "12"}
"""Component of a stress -> which it is with x and y exchanged."""
_EXCHANGED_AXES = {1: 2, 2: 1, 3: 3}
"""The same of a direction."""


DISPLACEMENT_BIAS = 0.5
STRESS_BIAS = 1.0
"""q of `RadialTable`: in the middle of what is allowed for all orders m, so that no radius is lost to
rounding; 0.2 and 0.8, or 0.5 and 1.5, change 1e-13 and 3e-13 of the largest coefficient.
"""


class LayeredPatches:
    """Influence coefficients of the cells of a grid on a coated half-space; conventions of
    `sam.kernels.patches`.

    Parameters
    ----------
    layers
        Coating and half-space.
    """

    def __init__(self, layers: Layers):
        self.layers = layers
        self._response = Response(layers, wave_numbers())  # unit of length: the thickness

    def response(self, k: Array) -> Array:
        """c_zz(k), m/Pa: u_z over p of a wave with k > 0 in rad/m; infinite at k = 0."""
        return normal_compliance(self.layers, k)

    def surface_response(self, k: Array) -> Array:
        """k times (c_zz, c_zL, c_LL, c_TT), see `Response.surface`, in 1/Pa, (4, ...); k > 0 in rad/m."""
        return Response(self.layers, k * self.layers.thickness).surface / self.layers.shear

    def displacement(self, lags: Lags, *, component: int = 3, load: int = 3) -> Array:
        """Surface displacement at (i hx, j hy) per unit traction on the cell at the origin.

        Parameters
        ----------
        lags
            Where the displacement is wanted, in m (negative lags: `sam.kernels.patches.parity`).
        component, load
            Directions of the displacement and of the traction on the body: 1, 2 or 3 (> 0 into the body).

        Returns
        -------
        Array
            (nx, ny) in m/Pa.
        """
        if load == 2:
            return self.displacement(lags.exchanged, component=_EXCHANGED_AXES[component], load=1).T
        h = self.layers.thickness
        in_thickness = lags.in_units_of(h)
        cells = CellIntegrals(in_thickness)
        out = displacement_coefficients(in_thickness, self.layers.poisson, component=component, load=load)
        for name, angular, sign in DISPLACEMENT_ENTRIES[component, load]:
            order, pick = DISPLACEMENT_TABLES[name]
            samples = pick(self._response.surface_excess) / wave_numbers()
            out = (
                out + sign * cells.integrate(RadialTable(samples[None], order, DISPLACEMENT_BIAS), angular)[0]
            )
        return out * (h / self.layers.shear)

    def stress(self, lags: Lags, z: ArrayLike, *, load: int = 3, names: Sequence[str] = STRESS) -> Array:
        """Stress at (i hx, j hy, z) per unit traction on the cell at the origin.

        Parameters
        ----------
        lags
            Where the stress is wanted, in m (negative lags: `sam.kernels.patches.parity`).
        z
            Depths (nz,) >= 0 in m; z < thickness lies in the coating, z >= thickness in the body.
        load
            Direction of the traction on the body: 1, 2 or 3.
        names
            Components of the stress, of `sam.kernels.patches.STRESS`.

        Returns
        -------
        Array
            (len(names), nz, nx, ny), without a unit.

        Raises
        ------
        ValueError
            For a depth that is negative or not finite.
        """
        depths = np.atleast_1d(np.asarray(z, dtype=float))
        if not np.all((depths >= 0) & np.isfinite(depths)):
            raise ValueError(f"depths = {depths.tolist()} must be finite and >= 0")
        if load == 2:
            exchanged = [_EXCHANGED[name] for name in names]
            return np.swapaxes(self.stress(lags.exchanged, depths, load=1, names=exchanged), -1, -2)
        h = self.layers.thickness
        in_thickness = lags.in_units_of(h)
        bare = (depths < h) & (depths < max(lags.hx, lags.hy))
        samples = self._stress_samples(depths, bare, load)
        out = self._radial_stress(CellIntegrals(in_thickness), samples, load, names)
        if np.any(bare):
            out[:, bare] += stress_coefficients(
                in_thickness, depths[bare] / h, self.layers.poisson, load=load, names=names
            )
        return out

    def _stress_samples(self, depths: Array, bare: Mask, load: int) -> dict[str, Array]:
        """The functions f of `STRESS_TABLES` at the sampled wave numbers, (nz, wave numbers); bare: less a
        half-space of coating.
        """
        rows: dict[str, list[Array]] = {key: [] for key in STRESS_TABLES[load]}
        for depth, without in zip(depths, bare, strict=True):
            (under_p, under_q), under_t = (
                self._response.coating_excess if without else self._response.stress
            )(depth)
            for key, (_, pick) in STRESS_TABLES[load].items():
                rows[key].append(pick(under_p, under_q, under_t))
        return {key: np.array(values) for key, values in rows.items()}

    @staticmethod
    def _radial_stress(
        cells: CellIntegrals, samples: dict[str, Array], load: int, names: Sequence[str]
    ) -> Array:
        """Sum of `STRESS_ENTRIES`, each radial function and angular one integrated once: (len(names), nz, nx,
        ny).
        """
        tables: dict[str, RadialTable] = {}
        known: dict[tuple[str, Angular], Array] = {}
        nz = len(samples["zz"])
        out = np.zeros((len(names), nz, *cells.shape))
        for row, name in zip(out, names, strict=True):
            for key, angular, sign in STRESS_ENTRIES[name, load]:
                if key not in tables:
                    tables[key] = RadialTable(samples[key], STRESS_TABLES[load][key][0], STRESS_BIAS)
                if (key, angular) not in known:
                    known[key, angular] = cells.integrate(tables[key], angular)
                row += sign * known[key, angular]
        return out
