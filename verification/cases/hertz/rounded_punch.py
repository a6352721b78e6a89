# SPDX-License-Identifier: MIT
"""A punch with a flat end and a rounded edge: SAM, FEM and the closed form, at several sizes of the cells."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from sam.scene import Grid, Result, Scene
from verification.cases.case import (
    FEM,
    SAM,
    Case,
    Context,
    Measured,
    Plot,
    elastic_text,
    grid_text,
    mesh_text,
    with_keys,
)
from verification.cases.hertz.flat_punch import plot
from verification.cases.hertz.hertz import mises_on_axis
from verification.figures.profiles import convergence
from verification.reference.convergence import Order, fit_order
from verification.reference.hertz import effective_modulus
from verification.reference.rounded_punch import RoundedPunch
from verification.runs.sampling import peak

WIDER = 100e-6
"""Radius of the edge in m with which cells are refined: the ring of contact is 2.7 times as wide."""
SIZES = {"quick": (53, 79, 129), "full": (53, 79, 129, 193, 257)}
SIDE = 2.6
"""Sides of the grid in contact radii."""
REFINED = {"approach": "approach", "p-center": "pressure in the centre", "p-max": "largest pressure"}


@dataclass(frozen=True)
class Punches:
    """A scene solved by both models ("SAM", "FEM"), and its closed form; refined: SAM with a wider edge ->
    errors by cells in the contact radius.
    """

    scene: Scene
    exact: RoundedPunch
    results: Mapping[str, Result]
    refined: Mapping[float, Mapping[str, float]]

    def order(self, name: str) -> Order:
        """Of an error of SAM over the sizes of the cells."""
        return fit_order([1.0 / n for n in self.refined], [errors[name] for errors in self.refined.values()])


class RoundedPunchCase(Case):
    """Both models: approach, contact radius, pressure and axis; the order of SAM."""

    def solve(self, context: Context) -> Punches:
        scene = context.scene(self.name)
        results = {"SAM": context.solve(SAM, scene, "sam"), "FEM": context.solve(FEM, scene, "fem")}
        wider = with_keys(scene, "counterbody", radius=WIDER)
        exact, refined = closed_form(wider), {}
        for n in SIZES[context.level]:
            side = SIDE * exact.contact_radius
            on_grid = wider.model_copy(update={"grid": Grid(cells=(n, n), extent=(side, side))})
            values = against_closed_form(context.solve(SAM, on_grid, f"sam-{n}"), exact)
            errors = {name: abs(values[name].value / values[name].expected - 1.0) for name in REFINED}
            refined[n / SIDE] = errors
        return Punches(scene, closed_form(scene), results, refined)

    def measure(self, found: Punches) -> dict[str, Measured]:
        nu, deepest = found.scene.body.poisson, 2.0 * found.exact.contact_radius
        values = {"fem-load": Measured(found.results["FEM"].certificate["force_balance"])}
        for name, result in found.results.items():
            against = against_closed_form(result, found.exact)
            against["mises-axis"] = mises_on_axis(result, deepest, lambda z: found.exact.axis_stress(z, nu))
            values |= {f"{name.lower()}-{key}": value for key, value in against.items()}
        return values | {f"sam-order-{name}": Measured(found.order(name).order, 2.0) for name in REFINED}

    def setup(self, found: Punches) -> list[tuple[str, str]]:
        exact, sam = found.exact, found.results["SAM"]
        a, b = exact.contact_radius, exact.flat
        cell = sam.discretisation["cell_m"][0]
        return [
            ("Half-space", elastic_text(found.scene.body)),
            ("Punch", f"flat to b = {b * 1e6:g} µm, edge R = {exact.radius * 1e6:g} µm, rigid"),
            ("Force", f"{exact.force:g} N"),
            ("Contact radius a, b/a", f"{a * 1e6:.5f} µm, {b / a:.5f}"),
            ("Approach δ", f"{exact.approach * 1e9:.4f} nm"),
            ("Pressure: centre, largest", f"{exact.pressure(0.0) / 1e9:.4f}, {largest(exact) / 1e9:.4f} GPa"),
            ("SAM", f"{grid_text(sam, a)}, {(a - b) / cell:.1f} in a − b"),
            ("FEM", mesh_text(found.results["FEM"])),
            (
                "Order of SAM",
                f"with R = {WIDER * 1e6:g} µm: {', '.join(f'a/{n:.0f}' for n in found.refined)}",
            ),
        ]

    def figures(self, found: Punches) -> Iterator[Plot]:
        yield plot(
            found.results,
            found.exact,
            nu=found.scene.body.poisson,
            until=1.2 * found.exact.contact_radius,
            caption="The pressure rises just outside the flat end and falls to zero within the rounded edge: "
            "there the cells of SAM and the elements differ from the closed form.",
        )
        sizes = np.array([1.0 / n for n in found.refined])
        curves = {
            label: (sizes, np.array([errors[name] for errors in found.refined.values()]), found.order(name))
            for name, label in REFINED.items()
        }
        yield Plot(
            convergence({"SAM, wider edge": curves}),
            "order",
            "Error of SAM against the size of its cells",
            "Approach, pressure in the centre and largest pressure against the cell size, with fitted lines.",
            "Each falls with the second power of the cell size.",
        )


def closed_form(scene: Scene) -> RoundedPunch:
    """The closed form of a scene."""
    body, other = scene.body, scene.counterbody
    modulus = effective_modulus(body.young, body.poisson)
    return RoundedPunch(scene.loading.force, other.flat_radius, other.radius, modulus)


def largest(exact: RoundedPunch) -> float:
    """The largest pressure in Pa, on 4000 places in the edge: within 1e-6."""
    return float(exact.pressure(np.linspace(exact.flat, exact.contact_radius, 4001)).max())


def against_closed_form(result: Result, exact: RoundedPunch) -> dict[str, Measured]:
    """One model against the closed form; the pressure to the flat end, weighted with r dr."""
    x, p = peak(result.tables["line"], "x_m", "p_Pa")
    x, p = x[inside := (x >= 0.0) & (x <= exact.flat)], p[inside]
    found = result.quantities
    return {
        "approach": Measured(found["approach_m"], exact.approach, unit="m"),
        "radius": Measured(found["contact_radius_m"], exact.contact_radius, unit="m"),
        "p-center": Measured(found["p_center_Pa"], float(exact.pressure(0.0)), unit="Pa"),
        "p-max": Measured(found["p_max_Pa"], largest(exact), unit="Pa"),
        "pressure": Measured(p, exact.pressure(x), x * np.gradient(x)),
    }


CASES = (RoundedPunchCase("rounded-punch"),)
