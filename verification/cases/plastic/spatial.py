# SPDX-License-Identifier: MIT
"""Without friction the three-dimensional finite elements must give what the axisymmetric ones give, and on an
elastic body what Hertz gives.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from sam.scene import Result
from verification.cases.case import (
    FEM,
    FEM_3D,
    Case,
    Context,
    Measured,
    SmallTable,
    mesh_text,
    quantity_rows,
    with_keys,
)
from verification.cases.recipes import BOX, Resolution, sliding_scene
from verification.reference.hertz import CircularContact, effective_modulus

SCENE, RATIOS = "plastic-swift-rigid", (3.0, 4.0)
# in the elastic contact radius, and the box of the axisymmetric model in it
ELEMENTS, AXISYMMETRIC, WIDE = 8, 32, 10.0
HERTZ_ELEMENTS = (4, 6, 8, 12)  # in the contact radius
SHOWN = {
    "approach_m": ("approach [nm]", 1e9),
    "p_max_Pa": ("largest pressure [GPa]", 1e-9),
    "contact_radius_m": ("contact radius [µm]", 1e6),
    "peeq_max": ("largest plastic strain [%]", 1e2),
    "peeq_max_depth_m": ("its depth [µm]", 1e6),
    "mises_max_Pa": ("largest von Mises stress [GPa]", 1e-9),
}


class SpatialAxisymmetric(Case):
    """The same contacts with both models: ratio -> (three-dimensional, axisymmetric)."""

    def solve(self, context: Context) -> dict[float, tuple[Result, Result]]:
        base = context.scene(SCENE)
        found = {}
        for ratio in RATIOS:
            spatial = sliding_scene(base, ratio, 0.0, Resolution(8, ELEMENTS))
            flat = sliding_scene(base, ratio, 0.0, Resolution(8, AXISYMMETRIC))
            found[ratio] = (
                context.solve(FEM_3D, spatial, f"spatial-{ratio:g}"),
                context.solve(FEM, with_keys(flat, "fem", box=WIDE), f"flat-{ratio:g}"),
            )
        return found

    def measure(self, found: dict[float, tuple[Result, Result]]) -> dict[str, Measured]:
        return {
            f"{gate}-{ratio:g}": Measured(*(result.quantities[name] for result in pair), unit=unit)
            for ratio, pair in found.items()
            for gate, name, unit in (("strain", "peeq_max", ""), ("p-max", "p_max_Pa", "Pa"))
        }

    def setup(self, found: dict[float, tuple[Result, Result]]) -> list[tuple[str, str]]:
        spatial, flat = found[RATIOS[-1]]
        return [
            ("Scene", f"{SCENE}, loading to p₀/σ_y0 = " + " and ".join(f"{ratio:g}" for ratio in RATIOS)),
            ("Three-dimensional", f"{mesh_text(spatial)}, {ELEMENTS} elements in a, box {BOX:g} a"),
            ("Axisymmetric", f"{mesh_text(flat)}, {AXISYMMETRIC} elements in a, box {WIDE:g} a"),
        ]

    def tables(self, found: dict[float, tuple[Result, Result]]) -> Iterator[SmallTable]:
        yield SmallTable(
            "Both finite-element models",
            ("p₀/σ_y0", "quantity", "three-dimensional", "axisymmetric", "difference"),
            [(f"{ratio:g}", *row) for ratio, pair in found.items() for row in quantity_rows(SHOWN, *pair)],
        )


class SpatialHertz(Case):
    """Approach, pressure and area of an elastic contact, by the elements in its radius."""

    def solve(self, context: Context) -> tuple[CircularContact, dict[int, Result]]:
        base = with_keys(context.scene("hertz-sphere"), "loading", steps=1, unload=False)
        modulus = effective_modulus(base.body.young, base.body.poisson)
        exact = CircularContact(base.loading.force, base.counterbody.radius, modulus)
        return exact, {
            n: context.solve(FEM_3D, with_keys(base, "fem", cells_per_radius=n, box=BOX), f"spatial-{n}")
            for n in HERTZ_ELEMENTS
        }

    def measure(self, found: tuple[CircularContact, dict[int, Result]]) -> dict[str, Measured | float]:
        exact, results = found
        area = math.pi * exact.contact_radius**2
        areas = [results[n].quantities["contact_area_m2"] for n in HERTZ_ELEMENTS]
        coarse, *_, fine = (abs(each / area - 1.0) for each in areas)
        radius = results[HERTZ_ELEMENTS[-1]].quantities["contact_radius_m"]
        return {
            "area": Measured(areas[-1], area, unit="m2"),
            "radius": Measured(radius, exact.contact_radius, unit="m"),
            "area-refined": coarse / fine,
        }

    def setup(self, found: tuple[CircularContact, dict[int, Result]]) -> list[tuple[str, str]]:
        return [("Scene", f"hertz-sphere at peak load in one step, box {BOX:g} a, apex on a node")]

    def tables(self, found: tuple[CircularContact, dict[int, Result]]) -> Iterator[SmallTable]:
        exact, results = found
        expected = {
            "contact_area_m2": math.pi * exact.contact_radius**2,
            "p_max_Pa": exact.peak_pressure,
            "approach_m": exact.approach,
        }
        rows = [
            (
                str(n),
                *(
                    f"{100 * (results[n].quantities[name] / value - 1):+.2f} %"
                    for name, value in expected.items()
                ),
            )
            for n in HERTZ_ELEMENTS
        ]
        yield SmallTable(
            "Error against Hertz", ("elements in a", "area", "largest pressure", "approach"), rows
        )


CASES = (
    SpatialAxisymmetric("spatial-axisymmetric"),
    SpatialHertz("spatial-hertz"),
)
