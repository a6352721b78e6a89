# SPDX-License-Identifier: MIT
"""Hertz pressure and traction given, no contact searched: stresses of both solvers in the closed form, then plastic flow."""

from __future__ import annotations

import numpy as np

from sam.scene import Friction, Grid, Loading, Result, Scene
from verification.compare.sliding_measures import SHALLOWEST, Plane, depths_compared, profile_difference
from verification.figures.friction import compared_planes, curves, profile_of
from verification.reference.hamilton import sliding_stress
from verification.reference.stress import von_mises
from verification.runs.models import FEM_3D, SAM
from verification.runs.sampling import peak
from verification.suite.cases.case import Case, Context, Outcome, SmallTable, grid_text, mesh_text
from verification.suite.cases.friction import BOX, DEEP, SCENE, contour_extents
from verification.suite.cases.hertz import contact_of
from verification.suite.cases.plastic import EQUATIONS, at_ratio, initial_yield
from verification.suite.cases.resolution import Resolution, resolved_at
from verification.suite.gates import Measured
from verification.text.console import number

COMPONENTS = ("sxx", "syy", "szz", "syz", "sxz", "sxy")
ZERO_ON_THE_AXIS = ("syz", "sxy")
"""By symmetry, whatever SAM does: they are gated off the axis, in the case sliding-sphere."""
FRICTION = 0.4
ELASTIC = Resolution(36, 10)  # 72 cells across
INTERIOR = (0.25, 1.5)  # depths at which stresses are compared, in contact radii
WIDE = 1.2  # the same to all sides
RATIO = 4.0
PLASTIC = (0.2, 0.4)
AT = Resolution(16, 10)


def given(scene: Scene, friction: float, steps: int) -> Scene:
    """The scene with the Hertz pressure of its elastic contact in place of the counter-body, and traction."""
    elastic = contact_of(scene)
    loading = Loading(
        prescribed="hertz", p0=elastic.peak_pressure, radius=elastic.contact_radius, steps=steps
    )
    fem = scene.fem.model_copy(update={"box": BOX})
    rubbed = Friction(coefficient=friction)
    return scene.model_copy(update={"counterbody": None, "loading": loading, "friction": rubbed, "fem": fem})


def run_elastic(context: Context) -> Outcome:
    """Every component at interior points, against Hamilton's closed form."""
    base = at_ratio(context.scene(SCENE), 1.0)
    scene = given(resolved_at(base, ELASTIC), FRICTION, 1)
    depths = tuple(float(z) * scene.loading.radius for z in np.linspace(0.0, 2.0, 81))
    grid = Grid(cells=scene.grid.cells, extent=scene.grid.extent, depths=depths)
    scene = scene.model_copy(
        update={"body": scene.body.model_copy(update={"plasticity": None}), "grid": grid}
    )
    sam, fem = context.solve(SAM, scene, "sam"), context.solve(FEM_3D, scene, "fem")
    errors = {
        "sam": axis_errors(sam, scene),
        "fem": element_errors(fem, scene),
        "sam-plane": plane_error(sam, scene),
    }
    outcome = Outcome(setup=setup(scene, sam, fem, ELASTIC))
    for name, error in zip(COMPONENTS, errors["fem"], strict=True):
        outcome.values[f"{context.case}.fem-{name}"] = Measured(error)
    for name, error in zip(COMPONENTS, errors["sam"], strict=True):
        if name not in ZERO_ON_THE_AXIS:
            outcome.values[f"{context.case}.sam-{name}"] = Measured(error)
    outcome.values[f"{context.case}.sam-plane"] = Measured(errors["sam-plane"])
    rows = [
        (words, *(f"{1e2 * e:.3f}" for e in errors[key])) for words, key in (("SAM", "sam"), ("FEM", "fem"))
    ]
    outcome.tables.append(
        SmallTable("Largest error of each component in % of p₀", ("model", *COMPONENTS), rows)
    )
    return outcome


def exact_stress(scene: Scene, x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Hamilton's stresses over p0 at places in m, (..., 6)."""
    loading, body = scene.loading, scene.body
    return sliding_stress(x, y, z, 1.0, loading.radius, body.poisson, scene.coefficient)


def element_errors(fem: Result, scene: Scene) -> np.ndarray:
    """Largest error of each component over the elements inside, at their centres, in p0: (6,)."""
    a, fields = scene.loading.radius, fem.fields
    x, y, z = (fields.points[fields.cells["hexahedron"]].mean(axis=1)).T
    low, high = (limit * a for limit in INTERIOR)
    use = (z >= low) & (z <= high) & (np.abs(x) <= WIDE * a) & (np.abs(y) <= WIDE * a)
    found = np.asarray(fields.cell_data["stress_Pa"])[use] / scene.loading.p0
    return np.abs(found - exact_stress(scene, x[use], y[use], z[use])).max(axis=0)


def axis_errors(sam: Result, scene: Scene) -> np.ndarray:
    """Largest error of each component on the axis, in p0: (6,)."""
    table = sam.tables["axis"]
    z, *found = peak(table, "z_m", *(f"{name}_Pa" for name in COMPONENTS))
    use = (z >= INTERIOR[0] * scene.loading.radius) & (z <= INTERIOR[1] * scene.loading.radius)
    zero = np.zeros(use.sum())
    exact = exact_stress(scene, zero, zero, z[use])
    return np.abs(np.stack(found, axis=1)[use] / scene.loading.p0 - exact).max(axis=0)


def plane_error(sam: Result, scene: Scene) -> float:
    """Largest error of the von Mises stress in y = 0 inside, in p0."""
    a = scene.loading.radius
    x, z, mises = peak(sam.tables["plane"], "x_m", "z_m", "mises_Pa")
    use = (z >= INTERIOR[0] * a) & (z <= INTERIOR[1] * a) & (np.abs(x) <= WIDE * a)
    exact = von_mises(exact_stress(scene, x[use], np.zeros(use.sum()), z[use]))
    return float(np.abs(mises[use] / scene.loading.p0 - exact).max())


def setup(scene: Scene, sam: Result, fem: Result, at: Resolution) -> list[tuple[str, str]]:
    """The numbers of a case for the reader."""
    loading = scene.loading
    return [
        ("Half-space", f"E = {scene.body.young / 1e9:g} GPa, ν = {scene.body.poisson:g}"),
        ("Tractions", "p = p₀ √(1 − r²/a²), q = μp along +x, given; no contact is solved"),
        (
            "Size (a, p₀)",
            f"{loading.radius * 1e6:.4f} µm, {loading.p0 / 1e9:.4f} GPa in {loading.steps} step(s)",
        ),
        ("Interior points", f"z from {INTERIOR[0]:g} a to {INTERIOR[1]:g} a, |x| and |y| up to {WIDE:g} a"),
        ("SAM", grid_text(sam, loading.radius)),
        ("FEM", f"{mesh_text(fem)}, {at.fem} elements in a, box {BOX:g} a"),
    ]


def run_plastic(context: Context) -> Outcome:
    """The plastic loop alone: strain over depth under given tractions, SAM against FEM."""
    base = at_ratio(context.scene(SCENE), RATIO)
    outcome, rows, panels = Outcome(), [], {}
    for friction in PLASTIC:
        scene = given(resolved_at(base, AT), friction, base.loading.steps)
        label = f"{friction:g}".replace(".", "")
        sam, fem = context.solve(SAM, scene, f"sam-{label}"), context.solve(FEM_3D, scene, f"fem-{label}")
        own, reference = (Plane.of(result, scene.loading.radius) for result in (sam, fem))
        x = reference.place_of_maximum()
        name = f"{context.case}.mu-{friction:g}".replace("0.", "0-")
        outcome.values[f"{name}-axis"] = Measured(profile_difference(own, reference, 0.0))
        outcome.values[f"{name}-column"] = Measured(profile_difference(own, reference, x))
        outcome.values |= {f"{name}-{key}": value for key, value in contour_extents(own, reference).items()}
        rows += strain_rows(own, reference, friction, x)
        panels[f"μ = {friction:g}, x = {x:.2f} a"] = {
            "FEM": profile_of(reference, x, DEEP),
            "SAM": profile_of(own, x, DEEP),
        }
        outcome.figures.append(maps(context, own, reference, friction))
    outcome.setup = [
        ("Yield", f"Swift, as in {SCENE}; p₀/σ_y0 = {RATIO:g}, σ_y0 = {initial_yield(base) / 1e6:.1f} MPa"),
        *(row for row in setup(scene, sam, fem, AT) if row[0] != "Interior points"),
    ]
    columns = ("μ", "x/a", "z/a", "FEM", "SAM", "difference")
    outcome.tables.append(SmallTable("Plastic strain in % over depth", columns, rows))
    drawing = curves(panels, "$z/a$", "plastic strain [%]", (0.0, SHALLOWEST))
    words = "Curves of the plastic strain over depth of FEM with SAM on them, for two friction coefficients."
    caption = "In y = 0 at the x of the largest strain. Grey: too near the surface to be compared."
    outcome.figures.insert(0, context.save(drawing, "depth", "Plastic strain over depth", words, caption))
    return outcome


def strain_rows(own: Plane, reference: Plane, friction: float, x: float) -> list[tuple[str, ...]]:
    """The plastic strains that are compared, on the axis and at x."""
    rows = []
    for at in dict.fromkeys((0.0, x)):
        for z in depths_compared(reference, at):
            one, other = (plane.at(np.array([at]), np.array([z]))[0, 0] for plane in (own, reference))
            cells = (number(1e2 * other, 4), number(1e2 * one, 4), f"{1e2 * (one / other - 1.0):+.2f} %")
            rows.append((f"{friction:g}", f"{at:.2f}", f"{z:.1f}", *cells))
    return rows


def maps(context: Context, own: Plane, reference: Plane, friction: float):
    """The planes beside each other."""
    return context.save(
        compared_planes(own, reference, ("SAM", "FEM"), 1.0),
        f"plane-mu-{friction:g}".replace("0.", "0-"),
        f"Plastic strain in the plane y = 0, μ = {friction:g}",
        "Three maps of the plastic strain over x/a and z/a: SAM, FEM and their difference.",
        "Labelled iso-lines: 0.2 % and 2 % where reached. The strip that FEM has no element centre in is blank.",
    )


HAMILTON = (
    "Stresses",
    "Hertz pressure and q = μp in full slip",
    "Hamilton (1983), Proc. I. Mech. E. 197C, 53-59",
)
CASES = (
    Case(
        "sliding-given-elastic",
        "Given pressure and traction, elastic",
        "Do both solvers, given the tractions of a sliding sphere, reproduce Hamilton's stresses inside the body?",
        run_elastic,
        (HAMILTON,),
    ),
    Case(
        "sliding-given",
        "Given pressure and traction on Swift steel",
        "Does the plastic loop alone, without a contact search, give the same strain in SAM and in FEM?",
        run_plastic,
        EQUATIONS,
        ("full",),
    ),
)
