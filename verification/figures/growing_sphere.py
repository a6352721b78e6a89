# SPDX-License-Identifier: MIT
"""A sphere that grows: plastic strain, deviator and radial stress along a ray through its centre."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from sam.scene import Result
from verification.figures.profiles import Profile, profiles
from verification.figures.style import Drawing
from verification.reference.misfit_sphere import GrowingSphere
from verification.runs.sampling import rows_of

FARTHEST = 1.6  # radii of the sphere: where its plastic zone has ended
GIGA, PERCENT = 1e-9, 1e2


def rays(found: Mapping[str, Result], exact: GrowingSphere, depth: float) -> Drawing:
    """Below the centre, on the axis, at the peak: results by their model over the closed form.

    depth: of the centre in m.
    """
    a = exact.radius
    wanted = (
        ("Plastic strain", "plastic strain [%]", lambda r: PERCENT * exact.fields(r).peeq),
        ("Deviator", r"$\sigma_\theta - \sigma_r$ [GPa]", lambda r: GIGA * exact.fields(r).deviator),
        ("Radial stress", r"$\sigma_r$ [GPa]", lambda r: GIGA * exact.radial_stress(r)),
    )
    panels = []
    for k, (title, label, value) in enumerate(wanted):
        points = {
            name: (ray[0] / a, ray[1][k]) for name, ray in ((n, _ray(r, depth)) for n, r in found.items())
        }
        largest = float(np.abs(value(a * np.linspace(0.01, FARTHEST, 200))).max())
        panels.append(
            Profile(
                title, "$r/a$", label, lambda x, f=value: f(a * x), points, largest, "max", (0.0, FARTHEST)
            )
        )
    return profiles(panels, reference="closed form")


def _ray(result: Result, depth: float) -> tuple[np.ndarray, tuple[np.ndarray, ...]]:
    """Distance below the centre in m; plastic strain in %, deviator and radial stress in GPa."""
    columns = {
        name: rows_of(result.tables["axis"], "peak", "z_m", name) for name in ("peeq", "sxx_Pa", "szz_Pa")
    }
    z = columns["peeq"][0]
    use = z >= depth
    peeq, across, along = (values[use] for _, values in columns.values())
    return z[use] - depth, (PERCENT * peeq, GIGA * (across - along), GIGA * along)
