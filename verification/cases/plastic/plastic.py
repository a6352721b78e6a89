# SPDX-License-Identifier: MIT
"""A sphere pressed beyond yield and unloaded: SAM against FEM, for each hardening law and level of load."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import RegularGridInterpolator

from sam.scene import Result, Scene
from verification.cases.case import (
    FEM,
    SAM,
    Case,
    Context,
    Measured,
    Plot,
    SmallTable,
    View,
    elastic_text,
    grid_text,
    mesh_text,
    number,
    quantity_rows,
    with_loading,
)
from verification.cases.recipes import Resolution, resolved_at
from verification.compare.comparison import compare_scene
from verification.figures.plastic import axis_profiles, compared_peeq, residual_surface
from verification.figures.views import compared_pressure
from verification.reference.hertz import CircularContact
from verification.references import contact_of
from verification.runs.sampling import (
    means_of_cells,
    means_of_line,
    peak,
    pressure_map,
    pressure_on,
    ring_edges,
)

LEVEL = {"quick": Resolution(16, 32), "full": Resolution(20, 32)}
COARSER = Resolution(14, 16)
ALLOWED = {"peeq-max": "largest plastic strain", "pressure": "pressure on the cells of SAM, L2"}
RING = 0.1  # width of the rings over which the pressure is averaged, in elastic contact radii


GATED_SCALARS = {"peeq-max": ("peeq_max", ""), "residual-centre": ("residual_uz_center_m", "m")}
GATED_FIELDS = {
    "peeq-axis": "peeq on the axis",
    "peeq-plane": "peeq in the plane y = 0",
}
SHOWN = {
    "approach_m": ("approach [nm]", 1e9),
    "contact_radius_m": ("contact radius [µm]", 1e6),
    "p_max_Pa": ("largest pressure [GPa]", 1e-9),
    "peeq_max": ("largest plastic strain [%]", 1e2),
    "peeq_max_depth_m": ("its depth [µm]", 1e6),
    "residual_uz_center_m": ("residual displacement in the centre [nm]", 1e9),
    "residual_mises_max_Pa": ("largest residual von Mises stress [GPa]", 1e-9),
}
COUNTED = {
    "plastic_iterations": "plastic iterations",
    "operator_applications": "applications of the residual-stress operator",
    "newton_iterations": "Newton iterations",
    "step_cuts": "load steps cut",
    "setup_s": "set-up [s]",
    "solve_s": "solution [s]",
}


@dataclass(frozen=True)
class Sphere:
    """A case: its scene file, and the peak pressure of the elastic contact in initial yield stresses.

    ratio: None takes the force of the file; body, load: in words; allowance: gates that are judged with the
    refinement uncertainties of both models.
    """

    name: str
    scene: str
    body: str
    load: str
    ratio: float | None = None
    allowance: tuple[str, ...] = ()
    levels: tuple[str, ...] = ("full",)


def initial_yield(scene: Scene) -> float:
    """Yield stress of the virgin body in Pa."""
    return float(scene.body.plasticity.curve().stress(0.0))


def at_ratio(scene: Scene, ratio: float) -> Scene:
    """The scene with the force that gives the elastic contact the peak pressure ratio * initial yield
    stress.
    """
    elastic, p0 = contact_of(scene), ratio * initial_yield(scene)
    return with_loading(
        scene, force=CircularContact.from_peak_pressure(p0, elastic.radius, elastic.modulus).force
    )


@dataclass(frozen=True)
class PlasticResults:
    """A scene beyond yield, solved by both models; the allowances of its gates with their table, where there
    are any.
    """

    scene: Scene
    sam: Result
    fem: Result
    few: bool
    allowed: tuple[Mapping[str, Measured], SmallTable] | None = None

    @property
    def elastic(self) -> CircularContact:
        """The contact of Hertz at the same force."""
        return contact_of(self.scene)


@dataclass(frozen=True)
class PlasticSphere(Case):
    """A sphere of SPHERES by both models; every field that plasticity adds is compared and drawn."""

    sphere: Sphere | None = None

    def solve(self, context: Context) -> PlasticResults:
        scene, ratio = context.scene(self.sphere.scene), self.sphere.ratio
        scene = scene if ratio is None else at_ratio(scene, ratio)
        fine = resolved_at(scene, LEVEL[context.level])
        found = {model: context.solve(model, fine, name) for model, name in ((SAM, "sam"), (FEM, "fem"))}
        allowed = with_allowance(context, scene, found) if self.sphere.allowance else None
        return PlasticResults(fine, found[SAM], found[FEM], context.level == "quick", allowed)

    def measure(self, found: PlasticResults) -> dict[str, Measured]:
        shares = {gate: found.allowed[0][gate] for gate in self.sphere.allowance}
        return compared(found.scene, found.sam, found.fem) | shares

    def setup(self, found: PlasticResults) -> list[tuple[str, str]]:
        scene, elastic, other, loading = (
            found.scene,
            found.elastic,
            found.scene.counterbody,
            found.scene.loading,
        )
        a = elastic.contact_radius
        size = f"{a * 1e6:.4f} µm, {elastic.peak_pressure / 1e9:.4f} GPa"
        box = f"{scene.fem.cells_per_radius} elements in a, box {scene.fem.box:g} a"
        material = elastic_text(other) if other.elastic else "rigid"
        return [
            ("Half-space", f"{elastic_text(scene.body)}; {self.sphere.body}"),
            ("Initial yield stress", f"{initial_yield(scene) / 1e6:.1f} MPa"),
            ("Sphere", f"R = {other.radius * 1e6:g} µm, {material}"),
            ("Force", f"{loading.force:.5g} N in {loading.steps} equal steps, then unloaded"),
            ("Elastic contact (a, p₀)", f"{size} ({self.sphere.load})"),
            ("SAM", grid_text(found.sam, a)),
            ("FEM", f"{mesh_text(found.fem)}, {box}"),
        ]

    def tables(self, found: PlasticResults) -> Iterator[SmallTable]:
        yield SmallTable(
            "Results", ("quantity", "SAM", "FEM", "difference"), quantity_rows(SHOWN, found.sam, found.fem)
        )
        costs = (found.sam.cost, found.fem.cost)
        yield SmallTable(
            "Cost",
            ("counter", "SAM", "FEM"),
            [(words, *(number(c.get(name), 3) for c in costs)) for name, words in COUNTED.items()],
        )
        yield from (found.allowed[1],) if found.allowed else ()

    def figures(self, found: PlasticResults) -> list[Plot]:
        return plots(found.sam, found.fem, found.elastic, found.few)

    def views(self, found: PlasticResults) -> list[View]:
        return [ZONE] if self.name in QUICK else []


ZONE = View(
    "sam",
    "plastic-zone",
    "zone",
    "The plastic zone in space",
    "The plastic zone of SAM below the sphere, cut open at y = 0: a bowl that is strained most below the "
    "centre of the contact.",
    "Plastic strain of SAM at the peak load on the cut and, where the zone reaches it, on the surface.",
)


def compared(scene: Scene, sam: Result, fem: Result) -> dict[str, Measured]:
    """The gates: scalars as they are, plastic strains by the rows of `compare`, the pressure on the cells and
    over rings.
    """
    difference = {row.quantity: row.error for row in compare_scene(scene, sam, fem)}
    scalars = {
        gate: Measured(sam.quantities[name], fem.quantities[name], unit=unit)
        for gate, (name, unit) in GATED_SCALARS.items()
    }
    fields = {gate: Measured(difference[name]) for gate, name in GATED_FIELDS.items()}
    pressures = {
        "pressure": Measured(pressure_map(sam)[2], nodal_pressure_on_cells(sam, fem)),
        "pressure-rings": ring_pressure(sam, fem, contact_of(scene).contact_radius),
    }
    return scalars | fields | pressures


def nodal_pressure_on_cells(sam: Result, fem: Result) -> np.ndarray:
    """p of FEM at the cell centres of SAM, (nx, ny)."""
    x, y, _ = pressure_map(sam)
    return pressure_on(x, y, fem.tables, power=1)


def ring_pressure(sam: Result, fem: Result, a: float) -> Measured:
    """Mean pressures over rings of a/10, weighted with their areas."""
    edges = ring_edges(RING * a, 1.2 * fem.quantities["contact_radius_m"])
    cells, line = means_of_cells(*pressure_map(sam), edges), peak(fem.tables["line"], "x_m", "p_Pa")
    return Measured(cells, means_of_line(*line, edges), np.diff(edges**2))


def with_allowance(
    context: Context, scene: Scene, fine: Mapping[str, Result]
) -> tuple[dict[str, Measured], SmallTable]:
    """Differences of the models over what they may be: 1 %, or both refinement uncertainties where that is
    more.

    Uncertainty: change from a coarser grid over (ratio - 1), the rest of a first-order error (Roache,
    Verification and Validation in Computational Science and Engineering, 1998, Eq. 5.10.5.1 without its
    factor of safety). Pressures in the L2 norm over the cells of SAM.
    """
    resolution = LEVEL[context.level]
    ratio = {SAM: resolution.sam / COARSER.sam, FEM: resolution.fem / COARSER.fem}
    coarse = {model: context.solve(model, resolved_at(scene, COARSER), f"{model}-coarser") for model in fine}
    p_sam, p_fem = pressure_map(fine[SAM])[2], nodal_pressure_on_cells(fine[SAM], fine[FEM])
    before = {
        SAM: cells_on_cells(coarse[SAM], fine[SAM]),
        FEM: nodal_pressure_on_cells(fine[SAM], coarse[FEM]),
    }
    best = {model: result.quantities["peeq_max"] for model, result in fine.items()}
    changes = {
        "peeq-max": {model: abs(best[model] / coarse[model].quantities["peeq_max"] - 1.0) for model in fine},
        "pressure": {SAM: l2(p_sam - before[SAM], p_fem), FEM: l2(p_fem - before[FEM], p_fem)},
    }
    apart = {"peeq-max": abs(best[SAM] / best[FEM] - 1.0), "pressure": l2(p_sam - p_fem, p_fem)}
    shares, rows = {}, []
    for gate, change in changes.items():
        uncertainty = {model: change[model] / (ratio[model] - 1.0) for model in fine}
        allowed = max(0.01, sum(uncertainty.values()))
        shares[gate] = Measured(apart[gate] / allowed)
        values = (uncertainty[SAM], uncertainty[FEM], apart[gate], allowed)
        rows.append((ALLOWED[gate], *(f"{1e2 * value:.2f} %" for value in values)))
    return shares, SmallTable(
        "Refinement uncertainties",
        ("quantity", "uncertainty of SAM", "of FEM", "difference", "largest of 1 % and their sum"),
        rows,
    )


def cells_on_cells(coarse: Result, fine: Result) -> np.ndarray:
    """p of a coarser SAM result at the cell centres of a finer one, (nx, ny), bilinear; zero beyond its
    outermost.
    """
    (x, y, p), (u, v, _) = pressure_map(coarse), pressure_map(fine)
    at = np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1)
    return RegularGridInterpolator((x, y), p, bounds_error=False, fill_value=0.0)(at)


def l2(difference: np.ndarray, reference: np.ndarray) -> float:
    """Relative L2 norm."""
    return float(np.linalg.norm(difference) / np.linalg.norm(reference))


def plots(sam: Result, fem: Result, elastic: CircularContact, few: bool) -> list[Plot]:
    """The figures of a sphere; where there are many cases, surfaces are linked and pressure maps left out."""
    a = elastic.contact_radius
    edge = fem.quantities["contact_radius_m"] / a
    shown = [
        Plot(
            compared_peeq(sam, fem, a),
            "peeq-maps",
            "Plastic strain in the plane y = 0",
            "Three maps of the accumulated plastic strain over x/a and z/a: SAM, FEM and their difference. "
            f"Both have a maximum of {100 * fem.quantities['peeq_max']:.3g} % below the centre.",
            "Iso-lines at round values and, where reached, 0.2 % (labelled); the cross marks the maximum as "
            "each solver quotes it. FEM is linear between its Gauss points and left blank above the first of "
            "them.",
        ),
        Plot(
            axis_profiles(sam, fem, a),
            "axis",
            "Under the centre, at the peak and unloaded",
            "Curves over depth of the plastic strain and von Mises stress at the peak, and of the von Mises "
            "and lateral stress after unloading; SAM on the curves of FEM, with the differences underneath.",
            "On the axis r = 0. Underneath: SAM minus FEM in % of the largest value of FEM.",
        ),
        Plot(
            residual_surface(sam, fem, elastic),
            "surface",
            "Residual surface, load and approach",
            "Left: the surface after unloading over x/a, SAM on the curve of FEM, with the difference. "
            "Right: force over approach with unloading of both models beside the elastic curve of Hertz.",
            "Left: displacement that stays after unloading, along y = 0. Right: every load step; elastic "
            "unloading is one step, of which only the end is a point of the curve.",
            embedded=few,
        ),
    ]
    if few:
        shown.append(
            Plot(
                compared_pressure(
                    sam, fem.tables, a, elastic.peak_pressure, reach=1.2 * max(edge, 1.0), edge=edge, power=1
                ),
                "pressure-maps",
                "Contact pressure at the peak",
                "Three maps of the contact pressure over x/a and y/a: SAM, FEM and their difference, flatter "
                "than Hertz.",
                "p/p₀ of SAM on its cells and of FEM mapped to (x, y); dashed: the contact of FEM.",
            )
        )
    return shown


SWIFT = "Swift, σ_y = 945 MPa (20 + 10⁶ε)^0.121"
LAWS = (
    ("swift-rigid", SWIFT, (2.0, 3.0, 4.0, 6.2)),
    ("swift-steel", SWIFT, (2.0, 3.0, 4.0, 6.2)),
    ("linear", "linear hardening, modulus E/20", (3.0, 4.0)),
    ("perfect", "perfectly plastic", (3.0, 4.0)),
)
ALLOWANCE = {
    "plastic-linear-4": ("pressure",),
    "plastic-perfect-3": ("peeq-max", "pressure"),
    "plastic-perfect-4": ("peeq-max", "pressure"),
}
"""Without hardening the surroundings alone bound the strain. Where a contact ends in a jump of the pressure
(at 4 times the yield stress without or with weak hardening), the L2 norm of an edge that is off by a share of
a cell falls with its root.
"""
QUICK = ("plastic-swift-rigid-4",)


def _spheres() -> Iterator[Sphere]:
    for law, body, ratios in LAWS:
        for ratio in ratios:
            name = f"plastic-{law}-{f'{ratio:g}'.replace('.', '-')}"
            levels = ("quick", "full") if name in QUICK else ("full",)
            allowance = ALLOWANCE.get(name, ())
            yield Sphere(name, f"plastic-{law}", body, f"p₀/σ_y0 = {ratio:g}", ratio, allowance, levels)
    for B in (1780, 1280):
        name = f"plastic-paper-{B}"
        yield Sphere(name, name, f"Swift (B = {B} MPa), σ_y = B (4 + 10⁶ε)^0.095", "p₀ = 6.5 GPa")


SPHERES = tuple(_spheres())
CASES = tuple(PlasticSphere(sphere.name, sphere=sphere) for sphere in SPHERES)
