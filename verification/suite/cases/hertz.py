# SPDX-License-Identifier: MIT
"""Hertz contact of a sphere, rigid and of steel: SAM, FEM and the closed form."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from sam.scene import Result, Scene
from verification.compare.smooth import compare_results
from verification.figures.profiles import Profile, profiles
from verification.figures.views import compared_mises, compared_pressure, pressure_map
from verification.reference.elliptic import EllipticContact
from verification.reference.hertz import CircularContact, axis_stress, effective_modulus, largest_von_mises
from verification.reference.stress import von_mises
from verification.runs.sampling import peak, pressure_on
from verification.suite.cases.case import (
    FEM,
    SAM,
    Case,
    Context,
    Measured,
    Plot,
    elastic_text,
    grid_text,
    mesh_text,
)

EQUATIONS = (
    (
        "Contact radius, pressure, approach",
        "a³ = 3FR/(4E*),  p₀ = 3F/(2πa²),  δ = a²/R",
        "Johnson, Contact Mechanics (1985), Eq. 4.22-4.24",
    ),
    (
        "Contact modulus",
        "1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂  (the second term is absent for a rigid sphere)",
        "Johnson (1985), section 4.2",
    ),
    ("Pressure", "p(r) = p₀ √(1 − r²/a²)", "Hertz (1882); Johnson (1985), Eq. 3.39"),
    (
        "Surface",
        "u(r) = πp₀(2a² − r²)/(4aE') inside the contact, E' = E/(1 − ν²) of the body",
        "Johnson (1985), Eq. 3.42",
    ),
    (
        "Stresses on the axis",
        "σzz = −p₀/(1 + z²/a²),  σxx = σyy = −p₀[(1 + ν)(1 − (z/a) atan(a/z)) − ½/(1 + z²/a²)]",
        "Huber (1904); Johnson (1985), Eq. 3.45",
    ),
)


def contact_of(scene: Scene) -> CircularContact:
    """The closed form of a scene with a sphere."""
    body, other = scene.body, scene.counterbody
    modulus = effective_modulus(body.young, body.poisson, other.young, other.poisson)
    return CircularContact(scene.loading.force, other.radius, modulus)


def body_share(scene: Scene, contact: CircularContact) -> float:
    """The body's part of the surface displacement of both."""
    return contact.modulus * (1.0 - scene.body.poisson**2) / scene.body.young


@dataclass(frozen=True)
class SphereResults:
    """A scene solved by both models, and its closed form."""

    scene: Scene
    exact: CircularContact
    sam: Result
    fem: Result

    @property
    def results(self) -> dict[str, Result]:
        """Both models by name."""
        return {"SAM": self.sam, "FEM": self.fem}


class HertzSphere(Case):
    """The scene named like the case by both models, every field compared."""

    def solve(self, context: Context) -> SphereResults:
        scene = context.scene(self.name)
        results = context.solve(SAM, scene, "sam"), context.solve(FEM, scene, "fem")
        return SphereResults(scene, contact_of(scene), *results)

    def measure(self, found: SphereResults) -> dict[str, Measured]:
        arguments = found.exact, found.scene
        return sam_values(found.sam, *arguments) | fem_values(found.fem, *arguments) | between(found)

    def setup(self, found: SphereResults) -> list[tuple[str, str]]:
        scene, exact, sam, fem = found.scene, found.exact, found.sam, found.fem
        other, a = scene.counterbody, exact.contact_radius
        elastic = elastic_text(other) if other.elastic else "rigid"
        return [
            ("Half-space", elastic_text(scene.body)),
            ("Sphere", f"R = {other.radius * 1e6:g} µm, {elastic}"),
            ("Force", f"{scene.loading.force:g} N in {scene.loading.steps} steps, then unloaded"),
            ("Contact radius a, peak pressure p₀", f"{a * 1e6:.4f} µm, {exact.peak_pressure / 1e9:.4f} GPa"),
            ("SAM", f"{grid_text(sam, a)}, apex on a cell centre"),
            ("SAM stresses", f"{sam.discretisation['depths']} output depths in the plane y = 0"),
            ("FEM", f"{mesh_text(fem)}, {scene.fem.cells_per_radius} elements in a, box {scene.fem.box:g} a"),
        ]

    def figures(self, found: SphereResults) -> list[Plot]:
        a, p0 = found.exact.contact_radius, found.exact.peak_pressure
        return [
            Plot(
                compared_pressure(found.sam, found.fem.tables, a, p0),
                "pressure-maps",
                "Contact pressure",
                "Three maps of the contact pressure over x/a and y/a: SAM, FEM and their difference. The "
                "first two look the same, a cap inside the circle r = a; the difference is confined to the "
                "edge of that circle.",
                "p/p₀ of SAM on its cells and of the axisymmetric FEM mapped to (x, y), and their "
                "difference. Dashed: r = a. Only the ring of cells that the circle cuts differs: there the "
                "pressure falls with a vertical tangent.",
            ),
            Plot(
                compared_mises(found.sam, found.fem, a, p0),
                "mises-maps",
                "Von Mises stress in the plane y = 0",
                "Three maps of the von Mises stress over x/a and z/a: SAM, FEM and their difference. Both "
                "have a maximum of 0.62 p0 below the centre at z = 0.48 a.",
                "Iso-lines every 0.1 p₀; the cross marks the maximum as each solver quotes it, the bar on "
                "top the contact. FEM is linear between its Gauss points and left blank above the first of "
                "them.",
            ),
            Plot(
                profiles(surface_panels(found)),
                "surface",
                "Surface: pressure, displacement, gap",
                "Curves of the pressure, the displacement of the body and the gap along the surface for SAM, "
                "FEM and the closed form, which coincide, with the errors underneath.",
                "Along y = 0 (FEM: r). Underneath: computed minus closed form in % of p₀ and of the approach "
                "δ.",
            ),
            Plot(
                profiles(axis_panels(found)),
                "axis",
                "Stresses under the centre",
                "Curves of the normal, lateral and von Mises stress over depth on the axis for SAM, FEM and "
                "the closed form, which coincide, with the errors underneath.",
                "On the axis r = 0. Underneath: computed minus closed form in % of p₀.",
            ),
            Plot(
                profiles([loading_panel(found)]),
                "loading",
                "Load and approach",
                "Approach against force at each load step for SAM and FEM on the curve of the closed form, "
                "with the errors.",
                "Every load step, and the unloaded state (elastic: back to the origin in one step).",
            ),
        ]


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


def between(found: SphereResults) -> dict[str, Measured]:
    """SAM against FEM: the rows of `compare`, and the pressure over the cells of SAM."""
    x, y, p = pressure_map(found.sam)
    difference = {row.quantity: row.difference for row in compare_results(found.sam, found.fem)}
    return {
        "pressure": Measured(p, pressure_on(x, y, found.fem.tables)),
        "approach": Measured(difference["approach_m"]),
        "displacement": Measured(difference["uz_m on the line"]),
        "mises-axis": Measured(difference["mises_Pa on the axis"]),
        "mises-plane": Measured(difference["mises_Pa in the plane y = 0"]),
    }


def surface_panels(found: SphereResults) -> list[Profile]:
    """Pressure, displacement of the body and gap along the surface."""
    exact = found.exact
    a, p0, delta, share = (
        exact.contact_radius,
        exact.peak_pressure,
        exact.approach,
        body_share(found.scene, exact),
    )

    def panel(labels: tuple[str, str], column: str, scale: tuple[float, str], function: Callable) -> Profile:
        (title, ylabel), (unit, name) = labels, scale
        series = scaled_columns(found.results, "line", ("x_m", column), (a, unit))
        return Profile(
            title, "$x/a$", ylabel, lambda x: function(np.abs(x) * a) / unit, series, 1.0, name, (0.0, 1.98)
        )

    of_p, of_delta = (p0, "$p_0$"), (delta, r"$\delta$")
    return [
        panel(("Pressure", "$p/p_0$"), "p_Pa", of_p, exact.pressure),
        panel(
            ("Displacement of the body", r"$u_z/\delta$"),
            "uz_m",
            of_delta,
            lambda r: share * exact.displacement(r),
        ),
        panel(("Gap", r"gap$/\delta$"), "gap_m", of_delta, exact.gap),
    ]


def scaled_columns(
    results: Mapping[str, Result], table: str, columns: tuple[str, str], units: tuple[float, float]
) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Name of a model -> (place, value) at the peak in a table, each divided by its unit."""
    found = {name: peak(result.tables[table], *columns) for name, result in results.items()}
    return {name: (x / units[0], y / units[1]) for name, (x, y) in found.items()}


def axis_panels(found: SphereResults) -> list[Profile]:
    """Stresses on the axis against the closed form."""
    nu = found.scene.body.poisson
    units = found.exact.contact_radius, found.exact.peak_pressure
    return stress_panels(found.results, units, lambda zeta: axis_stress(zeta, 1.0, 1.0, nu), "$z/a$")


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


def loading_panel(found: SphereResults) -> Profile:
    """Approach over force: delta = (9 F^2/(16 R E*^2))^(1/3)."""
    exact = found.exact
    factor = np.cbrt(9.0 / (16.0 * exact.radius * exact.modulus**2))
    histories = {name: result.tables["history"] for name, result in found.results.items()}
    return Profile(
        "Approach",
        "force [N]",
        r"approach [$\mu$m]",
        lambda force: 1e6 * factor * force ** (2.0 / 3.0),
        {n: (np.array(h["force_N"]), 1e6 * np.array(h["approach_m"])) for n, h in histories.items()},
        1e6 * exact.approach,
        r"$\delta$ at the peak",
        (0.0, exact.force),
        points=True,
    )


CASES = (
    HertzSphere(
        "hertz-sphere",
        "Rigid sphere on a steel half-space",
        "Do SAM and FEM, from one scene, each reproduce the pressure, surface and subsurface stresses of "
        "Hertz, and each other?",
        EQUATIONS,
    ),
    HertzSphere(
        "hertz-steel",
        "Steel sphere on a steel half-space",
        "Does the same hold with an elastic counter-body, which is part of the contact modulus in SAM and a "
        "second meshed body in FEM?",
        EQUATIONS,
    ),
)
