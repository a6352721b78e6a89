# SPDX-License-Identifier: MIT
"""Hertz contact of a sphere, rigid and of steel: SAM, FEM and the closed form."""

from __future__ import annotations

import numpy as np

from sam.scene import Result, Scene
from verification.compare.smooth import compare_results
from verification.figures.profiles import Profile, profiles
from verification.figures.views import compared_mises, compared_pressure, pressure_map
from verification.reference.hertz import CircularContact, axis_stress, effective_modulus, largest_von_mises
from verification.reference.stress import von_mises
from verification.runs.models import FEM, SAM
from verification.runs.sampling import peak, pressure_on
from verification.suite.cases.case import Case, Context, Outcome, grid_text, mesh_text
from verification.suite.gates import Measured

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


def run(context: Context) -> Outcome:
    """Solve the scene named like the case with both models and compare every field."""
    scene = context.scene(context.case)
    exact = contact_of(scene)
    sam, fem = context.solve(SAM, scene, "sam"), context.solve(FEM, scene, "fem")
    values = sam_values(sam, exact, scene) | fem_values(fem, exact, scene) | between(sam, fem)
    outcome = Outcome(
        {f"{context.case}.{name}": value for name, value in values.items()}, setup(scene, exact, sam, fem)
    )
    add_maps(context, outcome, sam, fem, exact)
    add_profiles(context, outcome, {"SAM": sam, "FEM": fem}, exact, scene)
    return outcome


def setup(scene: Scene, exact: CircularContact, sam: Result, fem: Result) -> list[tuple[str, str]]:
    """The numbers of the case for the reader."""
    body, other, a = scene.body, scene.counterbody, exact.contact_radius
    elastic = f"E = {other.young / 1e9:g} GPa, ν = {other.poisson:g}" if other.elastic else "rigid"
    return [
        ("Half-space", f"E = {body.young / 1e9:g} GPa, ν = {body.poisson:g}"),
        ("Sphere", f"R = {other.radius * 1e6:g} µm, {elastic}"),
        ("Force", f"{scene.loading.force:g} N in {scene.loading.steps} steps, then unloaded"),
        ("Contact radius a, peak pressure p₀", f"{a * 1e6:.4f} µm, {exact.peak_pressure / 1e9:.4f} GPa"),
        ("SAM", f"{grid_text(sam, a)}, apex on a cell centre"),
        ("SAM stresses", f"{sam.discretisation['depths']} output depths in the plane y = 0"),
        ("FEM", f"{mesh_text(fem)}, {scene.fem.cells_per_radius} elements in a, box {scene.fem.box:g} a"),
    ]


def sam_values(sam: Result, exact: CircularContact, scene: Scene) -> dict[str, Measured]:
    """SAM against the closed form; the load is summed here over the returned pressure map."""
    found, (largest, depth) = sam.quantities, largest_of(exact, scene)
    x, y, p = pressure_map(sam)
    area = (x[1] - x[0]) * (y[1] - y[0])
    return {
        "sam-p-max": Measured(found["p_max_Pa"], exact.peak_pressure, unit="Pa"),
        "sam-approach": Measured(found["approach_m"], exact.approach, unit="m"),
        "sam-load": Measured(np.sum(p) * area, scene.loading.force, unit="N"),
        "sam-pressure": Measured(p, exact.pressure(np.hypot(x[:, None], y[None, :]))),
        "sam-mises-max": Measured(found["mises_max_Pa"], largest, unit="Pa"),
        "sam-mises-depth": Measured(found["mises_max_depth_m"], depth, unit="m"),
        "sam-mises-axis": axis_mises(sam, exact, scene),
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
    return largest_von_mises(exact.peak_pressure, exact.contact_radius, scene.body.poisson)


def axis_mises(result: Result, exact: CircularContact, scene: Scene) -> Measured:
    """The von Mises stress on the axis down to two contact radii; each point stands for the depth around it."""
    z, mises = peak(result.tables["axis"], "z_m", "mises_Pa")
    use = z <= 2.0 * exact.contact_radius
    z, mises = z[use], mises[use]
    stress = axis_stress(z, exact.peak_pressure, exact.contact_radius, scene.body.poisson)
    return Measured(mises, von_mises(stress), np.gradient(z))


def between(sam: Result, fem: Result) -> dict[str, Measured]:
    """SAM against FEM: the rows of `compare`, and the pressure over the cells of SAM."""
    x, y, p = pressure_map(sam)
    difference = {row.quantity: row.difference for row in compare_results(sam, fem)}
    return {
        "pressure": Measured(p, pressure_on(x, y, fem.tables)),
        "approach": Measured(difference["approach_m"]),
        "displacement": Measured(difference["uz_m on the line"]),
        "mises-axis": Measured(difference["mises_Pa on the axis"]),
        "mises-plane": Measured(difference["mises_Pa in the plane y = 0"]),
    }


def add_maps(context: Context, outcome: Outcome, sam: Result, fem: Result, exact: CircularContact) -> None:
    a, p0 = exact.contact_radius, exact.peak_pressure
    outcome.figures += [
        context.save(
            compared_pressure(sam, fem.tables, a, p0),
            "pressure-maps",
            "Contact pressure",
            "Three maps of the contact pressure over x/a and y/a: SAM, FEM and their difference. The first two look the "
            "same, a cap inside the circle r = a; the difference is confined to the edge of that circle.",
            "p/p₀ of SAM on its cells and of the axisymmetric FEM mapped to (x, y), and their difference. Dashed: r = a. "
            "Only the ring of cells that the circle cuts differs: there the pressure falls with a vertical tangent.",
        ),
        context.save(
            compared_mises(sam, fem, a, p0),
            "mises-maps",
            "Von Mises stress in the plane y = 0",
            "Three maps of the von Mises stress over x/a and z/a: SAM, FEM and their difference. Both have a maximum of "
            "0.62 p0 below the centre at z = 0.48 a.",
            "Iso-lines every 0.1 p₀; the cross marks the maximum as each solver quotes it, the bar on top the contact. FEM "
            "is linear between its Gauss points and left blank above the first of them.",
        ),
    ]


def add_profiles(
    context: Context, outcome: Outcome, results: dict[str, Result], exact: CircularContact, scene: Scene
) -> None:
    outcome.figures += [
        context.save(
            profiles(surface_panels(results, exact, scene)),
            "surface",
            "Surface: pressure, displacement, gap",
            "Curves of the pressure, the displacement of the body and the gap along the surface for SAM, FEM and the "
            "closed form, which coincide, with the errors underneath.",
            "Along y = 0 (FEM: r). Underneath: computed minus closed form in % of p₀ and of the approach δ.",
        ),
        context.save(
            profiles(axis_panels(results, exact, scene)),
            "axis",
            "Stresses under the centre",
            "Curves of the normal, lateral and von Mises stress over depth on the axis for SAM, FEM and the closed form, "
            "which coincide, with the errors underneath.",
            "On the axis r = 0. Underneath: computed minus closed form in % of p₀.",
        ),
        context.save(
            profiles([loading_panel(results, exact)]),
            "loading",
            "Load and approach",
            "Approach against force at each load step for SAM and FEM on the curve of the closed form, with the errors.",
            "Every load step, and the unloaded state (elastic: back to the origin in one step).",
        ),
    ]


def surface_panels(results: dict[str, Result], exact: CircularContact, scene: Scene) -> list[Profile]:
    a, p0, delta = exact.contact_radius, exact.peak_pressure, exact.approach
    share = body_share(scene, exact)

    def own_displacement(r: np.ndarray) -> np.ndarray:
        return share * exact.displacement(r)

    def panel(title: str, ylabel: str, column: str, unit: float, function, name: str) -> Profile:
        series = {key: peak(result.tables["line"], "x_m", column) for key, result in results.items()}
        series = {key: (x / a, y / unit) for key, (x, y) in series.items()}
        return Profile(
            title, "$x/a$", ylabel, lambda x: function(np.abs(x) * a) / unit, series, 1.0, name, (0.0, 1.98)
        )

    return [
        panel("Pressure", "$p/p_0$", "p_Pa", p0, exact.pressure, "$p_0$"),
        panel("Displacement of the body", r"$u_z/\delta$", "uz_m", delta, own_displacement, r"$\delta$"),
        panel("Gap", r"gap$/\delta$", "gap_m", delta, exact.gap, r"$\delta$"),
    ]


def axis_panels(results: dict[str, Result], exact: CircularContact, scene: Scene) -> list[Profile]:
    a, p0 = exact.contact_radius, exact.peak_pressure

    def stress(zeta: np.ndarray) -> np.ndarray:
        return axis_stress(zeta, 1.0, 1.0, scene.body.poisson)

    def panel(title: str, ylabel: str, column: str, function) -> Profile:
        series = {key: peak(result.tables["axis"], "z_m", column) for key, result in results.items()}
        series = {key: (z / a, y / p0) for key, (z, y) in series.items()}
        return Profile(title, "$z/a$", ylabel, function, series, 1.0, "$p_0$", (0.0, 2.0))

    return [
        panel("Normal", r"$\sigma_{zz}/p_0$", "szz_Pa", lambda z: stress(z)[..., 2]),
        panel("Lateral", r"$\sigma_{xx}/p_0$", "sxx_Pa", lambda z: stress(z)[..., 0]),
        panel("Von Mises", r"$\sigma_\mathrm{vM}/p_0$", "mises_Pa", lambda z: von_mises(stress(z))),
    ]


def loading_panel(results: dict[str, Result], exact: CircularContact) -> Profile:
    """Approach over force: delta = (9 F^2/(16 R E*^2))^(1/3)."""
    factor = np.cbrt(9.0 / (16.0 * exact.radius * exact.modulus**2))
    series = {
        name: (
            np.array(result.tables["history"]["force_N"]),
            1e6 * np.array(result.tables["history"]["approach_m"]),
        )
        for name, result in results.items()
    }
    return Profile(
        "Approach",
        "force [N]",
        r"approach [$\mu$m]",
        lambda force: 1e6 * factor * force ** (2.0 / 3.0),
        series,
        1e6 * exact.approach,
        r"$\delta$ at the peak",
        (0.0, exact.force),
        points=True,
    )


CASES = (
    Case(
        "hertz-sphere",
        "Rigid sphere on a steel half-space",
        "Do SAM and FEM, from one scene, each reproduce the pressure, surface and subsurface stresses of Hertz, and each "
        "other?",
        run,
        EQUATIONS,
    ),
    Case(
        "hertz-steel",
        "Steel sphere on a steel half-space",
        "Does the same hold with an elastic counter-body, which is part of the contact modulus in SAM and a second meshed "
        "body in FEM?",
        run,
        EQUATIONS,
    ),
)
