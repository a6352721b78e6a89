# SPDX-License-Identifier: MIT
"""Hertz contact of a sphere, rigid and of steel: SAM, FEM and the closed form."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from sam.scene import Result, Scene
from verification.cases.case import (
    Measured,
)
from verification.figures.profiles import Profile
from verification.reference.elliptic import EllipticContact
from verification.reference.hertz import CircularContact, axis_stress, largest_von_mises
from verification.reference.stress import von_mises
from verification.runs.sampling import peak, pressure_map


def sam_values(sam: Result, exact: CircularContact, scene: Scene) -> dict[str, Measured]:
    """SAM against the closed form."""
    return smooth_values(
        sam,
        exact,
        force=scene.loading.force,
        pressure=lambda x, y: exact.pressure(np.hypot(x, y)),
        largest=largest_of(exact, scene),
        axis=axis_mises(sam, exact, scene),
    )


def smooth_values(
    sam: Result,
    exact: CircularContact | EllipticContact,
    *,
    force: float,
    pressure: Callable,
    largest: tuple[float, float],
    axis: Measured,
) -> dict[str, Measured]:
    """SAM on a smooth contact against its closed form; the load is summed here over the returned pressure
    map.

    force in N; pressure: (x, y) in m -> Pa; largest: von Mises stress in Pa and its depth in m; axis: its
    gate.
    """
    found = sam.quantities
    x, y, p = pressure_map(sam)
    area = (x[1] - x[0]) * (y[1] - y[0])
    return {
        "sam-p-max": Measured(found["p_max_Pa"], exact.peak_pressure, unit="Pa"),
        "sam-approach": Measured(found["approach_m"], exact.approach, unit="m"),
        "sam-load": Measured(np.sum(p) * area, force, unit="N"),
        "sam-pressure": Measured(p, pressure(x[:, None], y[None, :])),
        "sam-mises-max": Measured(found["mises_max_Pa"], largest[0], unit="Pa"),
        "sam-mises-depth": Measured(found["mises_max_depth_m"], largest[1], unit="m"),
        "sam-mises-axis": axis,
    }


def fem_values(fem: Result, exact: CircularContact, scene: Scene) -> dict[str, Measured]:
    """FEM against the closed form; its pressure is weighted with the area 2 pi r dr of each surface node."""
    found, (largest, depth) = fem.quantities, largest_of(exact, scene)
    r, p = peak(fem.tables["line"], "x_m", "p_Pa")
    return {
        "fem-approach": Measured(found["approach_m"], exact.approach, unit="m"),
        "fem-load": Measured(fem.certificate["force_balance"]),
        "fem-pressure": Measured(p, exact.pressure(r), r * np.gradient(r)),
        "fem-mises-max": Measured(found["mises_max_Pa"], largest, unit="Pa"),
        "fem-mises-depth": Measured(found["mises_max_depth_m"], depth, unit="m"),
        "fem-mises-axis": axis_mises(fem, exact, scene),
    }


def largest_of(exact: CircularContact, scene: Scene) -> tuple[float, float]:
    """The largest von Mises stress in Pa and its depth in m."""
    return largest_von_mises(exact.peak_pressure, exact.contact_radius, scene.body.poisson)


def axis_mises(result: Result, exact: CircularContact, scene: Scene) -> Measured:
    """The von Mises stress on the axis down to two contact radii."""
    a, p0, nu = exact.contact_radius, exact.peak_pressure, scene.body.poisson
    return mises_on_axis(result, 2.0 * a, lambda z: axis_stress(z, p0, a, nu))


def mises_on_axis(result: Result, deepest: float, stress: Callable) -> Measured:
    """The von Mises stress on the axis; each point stands for the depth around it. stress: z in m -> (n, 6)
    in Pa.
    """
    z, mises = peak(result.tables["axis"], "z_m", "mises_Pa")
    use = z <= deepest
    return Measured(mises[use], von_mises(stress(z[use])), np.gradient(z[use]))


def scaled_columns(
    results: Mapping[str, Result], table: str, columns: tuple[str, str], units: tuple[float, float]
) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Name of a model -> (place, value) at the peak in a table, each divided by its unit."""
    found = {name: peak(result.tables[table], *columns) for name, result in results.items()}
    return {name: (x / units[0], y / units[1]) for name, (x, y) in found.items()}


def stress_panels(
    results: Mapping[str, Result], units: tuple[float, float], stress: Callable, xlabel: str
) -> list[Profile]:
    """Normal, lateral and von Mises stress on the axis. stress: depths (n,) -> (n, 6), both in `units`."""

    def panel(title: str, ylabel: str, column: str, function: Callable) -> Profile:
        series = scaled_columns(results, "axis", ("z_m", column), units)
        return Profile(title, xlabel, ylabel, function, series, 1.0, "$p_0$", (0.0, 2.0))

    return [
        panel("Normal", r"$\sigma_{zz}/p_0$", "szz_Pa", lambda z: stress(z)[..., 2]),
        panel("Lateral", r"$\sigma_{xx}/p_0$", "sxx_Pa", lambda z: stress(z)[..., 0]),
        panel("Von Mises", r"$\sigma_\mathrm{vM}/p_0$", "mises_Pa", lambda z: von_mises(stress(z))),
    ]
