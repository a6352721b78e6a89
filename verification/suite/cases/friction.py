# SPDX-License-Identifier: MIT
"""A rigid sphere in full slip on Swift steel: SAM with and without coupling, with the loop of the paper, and FEM in 3D.

The comparison of Bosman & Schipper (2011), Fig. 8: plastic strain over depth for three friction coefficients.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np

from sam.scene import Friction, Result, Scene
from verification.compare.sliding_measures import (
    SHALLOWEST,
    Plane,
    contours,
    depths_compared,
    nodal_pressures,
    patch_distance,
    pressure_distance,
    profile_difference,
)
from verification.figures.friction import COUPLED, DECOUPLED, PAPER, compared_planes, curves, profile_of
from verification.runs.models import FEM_3D, SAM
from verification.suite.cases.case import (
    Case,
    Context,
    Outcome,
    SmallTable,
    grid_text,
    mesh_text,
    with_loading,
)
from verification.suite.cases.hertz import contact_of
from verification.suite.cases.plastic import EQUATIONS, at_ratio, initial_yield
from verification.suite.cases.resolution import Resolution, resolved_at
from verification.suite.gates import Measured
from verification.text.console import number

SCENE = "plastic-swift-rigid"
FRICTION = (0.0, 0.2, 0.4)
BOX = 6.0  # elastic contact radii: the far field of the point forces is prescribed there
LEVELS = (0.002, 0.02)
DEEP = 1.4
PATCH = 0.2  # elastic contact radii: half width of the hats over which the pressures of both forms are held against FEM
FORMS = {
    COUPLED: (True, {}),
    DECOUPLED: (False, {}),
    PAPER: (False, {"method": "paper", "stop": "stress"}),
}
"""What SAM is asked for: coupling, and other keys of [solver]. The paper has neither coupling nor the backward Euler loop."""
SHORT = {COUPLED: "coupled", DECOUPLED: "decoupled", PAPER: "paper"}


@dataclass(frozen=True)
class Level:
    """A load, p0 of the elastic contact over the initial yield stress; fine, coarse: grids, the latter for the trend.

    steps: None takes those of the scene file; level: of the verification; shown: what is in the tables and not gated.
    """

    name: str
    ratio: float
    fine: Resolution
    coarse: Resolution | None = None
    friction: tuple[float, ...] = FRICTION
    forms: tuple[str, ...] = tuple(FORMS)
    steps: int | None = None
    level: str = "full"
    shown: tuple[str, ...] = ()


@dataclass(frozen=True)
class Sliding:
    """The results at one friction coefficient. sam: form -> result; a: contact radius of the elastic contact in m."""

    sam: Mapping[str, Result]
    fem: Result
    a: float

    def planes(self) -> dict[str, Plane]:
        """Of FEM and of every form of SAM."""
        return {"FEM": Plane.of(self.fem, self.a)} | {
            name: Plane.of(r, self.a) for name, r in self.sam.items()
        }


def sliding_scene(
    base: Scene, ratio: float, friction: float, resolution: Resolution, coupling: bool = True
) -> Scene:
    """Loading to p0 = ratio sigma_y0 with friction, on these grids."""
    scene = resolved_at(with_loading(at_ratio(base, ratio), unload=False), resolution)
    fem = scene.fem.model_copy(update={"box": BOX})
    rubbed = Friction(coefficient=friction, coupling=coupling) if friction else None
    return scene.model_copy(update={"friction": rubbed, "fem": fem})


def solved(
    context: Context, base: Scene, ratio: float, friction: float, at: Resolution, forms=tuple(FORMS)
) -> Sliding:
    """Every form of SAM and FEM. The loop of the paper need not converge in our sense."""
    label = f"{friction:g}".replace(".", "") + f"-{at.sam}-{at.fem}"
    scene = sliding_scene(base, ratio, friction, at)
    found = {}
    for name in forms:
        coupling, keys = FORMS[name]
        if not friction and name == DECOUPLED:
            continue
        chosen = sliding_scene(base, ratio, friction, at, coupling)
        chosen = chosen.model_copy(update={"solver": scene.solver.model_copy(update=keys)})
        found[name] = context.solve(SAM, chosen, f"{SHORT[name]}-{label}", demand=name != PAPER)
    return Sliding(found, context.solve(FEM_3D, scene, f"fem-{label}"), contact_of(scene).contact_radius)


def run(context: Context, level: Level) -> Outcome:
    """Solve, compare and draw one load at every friction coefficient."""
    base = context.scene(SCENE)
    base = with_loading(base, steps=level.steps or base.loading.steps)
    results = {mu: solved(context, base, level.ratio, mu, level.fine, level.forms) for mu in level.friction}
    outcome = Outcome(setup=setup(sliding_scene(base, level.ratio, 0.0, level.fine), level, results))
    for mu, found in results.items():
        values = {name: value for name, value in compared(found, mu).items() if name not in level.shown}
        outcome.values |= {f"{context.case}.{spelt(mu)}-{name}": value for name, value in values.items()}
    outcome.tables += [numbers(results), depths_table(results)]
    if level.coarse:
        coarser = {
            mu: solved(context, base, level.ratio, mu, level.coarse, (COUPLED,)) for mu in level.friction
        }
        outcome.tables.append(trend(coarser, results, level))
    draw(context, outcome, results)
    return outcome


def spelt(friction: float) -> str:
    """For the id of a gate."""
    return f"mu-{friction:g}".replace(".", "-")


def compared(found: Sliding, friction: float) -> dict[str, Measured]:
    """SAM against FEM: strain over depth, contours, pressure; with friction also what the coupling does."""
    sam, planes = found.sam[COUPLED], found.planes()
    own, fem = planes[COUPLED], planes["FEM"]
    p_sam, p_fem, area = nodal_pressures(sam, found.fem)
    values = {
        "axis": Measured(profile_difference(own, fem, 0.0)),
        "column": Measured(profile_difference(own, fem, fem.place_of_maximum())),
        "p-max": Measured(p_sam.max(), p_fem.max(), unit="Pa"),
        "pressure": Measured(p_sam, p_fem, area),
    }
    values |= contour_extents(own, fem)
    if friction:
        values |= {
            "centroid": Measured(shift(sam, found.a), shift(found.fem, found.a), unit="a"),
            "decoupled": Measured(
                further(found, lambda result: pressure_distance(*nodal_pressures(result, found.fem)))
            ),
            "decoupled-hats": Measured(
                further(found, lambda result: patch_distance(result, found.fem, PATCH * found.a))
            ),
        }
    return values


def further(found: Sliding, distance: Callable[[Result], float]) -> float:
    """Distance of the decoupled form from FEM over that of the coupled one."""
    return distance(found.sam[DECOUPLED]) / distance(found.sam[COUPLED])


def contour_extents(sam: Plane, fem: Plane) -> dict[str, Measured]:
    """Depth and length of the parts of y = 0 beyond 0.2 % and 2 % of plastic strain, where either model has them."""
    values = {}
    for level in LEVELS:
        one, other = contours((sam, fem), level)
        if one or other:
            name = f"contour-{1e2 * level:g}".replace(".", "-")
            values[f"{name}-depth"] = Measured(one and one.depth, other and other.depth, unit="a")
            values[f"{name}-length"] = Measured(one and one.length, other and other.length, unit="a")
    return values


def shift(result: Result, a: float) -> float:
    """x of the centre of pressure in contact radii."""
    return result.quantities["pressure_centroid_x_m"] / a


def setup(scene: Scene, level: Level, results: Mapping[float, Sliding]) -> list[tuple[str, str]]:
    """The numbers of the case for the reader."""
    elastic, found = contact_of(scene), next(iter(results.values()))
    a, loading = elastic.contact_radius, scene.loading
    return [
        (
            "Half-space",
            f"E = {scene.body.young / 1e9:g} GPa, ν = {scene.body.poisson:g}; Swift, as in {SCENE}",
        ),
        ("Initial yield stress", f"{initial_yield(scene) / 1e6:.1f} MPa; p₀/σ_y0 = {level.ratio:g}"),
        ("Sphere", f"R = {scene.counterbody.radius * 1e6:g} µm, rigid"),
        (
            "Friction",
            ", ".join(f"μ = {mu:g}" for mu in results) + "; q = μp along +x on the body, in every step",
        ),
        ("Force", f"{loading.force:.5g} N in {loading.steps} equal steps"),
        ("Elastic contact (a, p₀)", f"{a * 1e6:.4f} µm, {elastic.peak_pressure / 1e9:.4f} GPa"),
        ("SAM", grid_text(found.sam[COUPLED], a)),
        (
            "FEM",
            f"{mesh_text(found.fem)}, {level.fine.fem} elements in a, box {BOX:g} a, half of the contact",
        ),
    ]


def numbers(results: Mapping[float, Sliding]) -> SmallTable:
    """Pressures, centroid, distance in pressure, largest strain (which at the surface depends on the mesh), and cost."""
    rows = []
    for mu, found in results.items():
        for name, result in ({"FEM": found.fem} | found.sam).items():
            q = result.quantities
            apart = ("", "") if result is found.fem else pressures_apart(result, found)
            rows.append(
                (
                    f"{mu:g}",
                    name,
                    number(q["p_max_Pa"] * 1e-9, 5),
                    f"{shift(result, found.a):+.4f} a",
                    *apart,
                    f"{1e2 * q['peeq_max']:.3f} %",
                    f"{q['peeq_max_depth_m'] / found.a:.3f} a",
                    number(result.cost["solve_s"], 3),
                )
            )
    columns = (
        *("μ", "model", "largest pressure [GPa]", "centre of pressure", "pressure off FEM, L2"),
        *("over hats of 0.2 a", "largest plastic strain", "its depth", "solution [s]"),
    )
    return SmallTable(
        "Pressure and the largest strain; where that lies in the surface it depends on the mesh",
        columns,
        rows,
    )


def pressures_apart(result: Result, found: Sliding) -> tuple[str, str]:
    """Distance from FEM in % at the nodes, and over hats."""
    at_nodes = pressure_distance(*nodal_pressures(result, found.fem))
    return f"{1e2 * at_nodes:.2f} %", f"{1e2 * patch_distance(result, found.fem, PATCH * found.a):.2f} %"


def depths_table(results: Mapping[float, Sliding]) -> SmallTable:
    """The figure as numbers: plastic strain at fixed depths on the axis and at the x of the largest, FEM and every form."""
    rows = []
    for mu, found in results.items():
        planes = found.planes()
        for x in dict.fromkeys((0.0, planes["FEM"].place_of_maximum())):
            for z in depths_compared(planes["FEM"], x):
                at = {name: plane.at(np.array([x]), np.array([z]))[0, 0] for name, plane in planes.items()}
                cells = (f"{1e2 * at[name]:.4f}" if name in at else "" for name in ("FEM", *FORMS))
                off = f"{1e2 * (at[COUPLED] / at['FEM'] - 1.0):+.2f} %"
                rows.append((f"{mu:g}", f"{x:.2f}", f"{z:.1f}", *cells, off))
    return SmallTable(
        "Plastic strain in % over depth", ("μ", "x/a", "z/a", "FEM", *FORMS, "SAM off FEM"), rows
    )


def trend(coarse: Mapping[float, Sliding], fine: Mapping[float, Sliding], level: Level) -> SmallTable:
    """The differences between the models on coarse and fine grids, and the largest strain of each."""
    rows = []
    for mu in fine:
        for at, found in ((level.coarse, coarse[mu]), (level.fine, fine[mu])):
            planes = found.planes()
            own, fem = planes[COUPLED], planes["FEM"]
            strains = (f"{1e2 * r.quantities['peeq_max']:.3f} %" for r in (found.sam[COUPLED], found.fem))
            differences = (
                pressure_distance(*nodal_pressures(found.sam[COUPLED], found.fem)),
                profile_difference(own, fem, 0.0),
                profile_difference(own, fem, fem.place_of_maximum()),
            )
            rows.append(
                (f"{mu:g}", f"a/{at.sam}, a/{at.fem}", *(f"{1e2 * d:.2f} %" for d in differences), *strains)
            )
    columns = (
        *("μ", "cells, elements", "pressure, L2", "strain on the axis", "strain at its largest"),
        *("largest strain, SAM", "largest strain, FEM"),
    )
    caption = "Refinement: differences of the models at z ≥ 0.3 a, and the largest strain anywhere"
    return SmallTable(caption, columns, rows)


def draw(context: Context, outcome: Outcome, results: Mapping[float, Sliding]) -> None:
    """Strain over depth for every friction coefficient, and the planes beside each other."""
    planes = {mu: found.planes() for mu, found in results.items()}
    for name, words, place in (
        ("axis", "on the axis", lambda fem: 0.0),
        ("column", "where it is largest", lambda fem: fem.place_of_maximum()),
    ):
        panels = {}
        for mu, each in planes.items():
            x = place(each["FEM"])
            panels[f"μ = {mu:g}, x = {x:.2f} a"] = {
                key: profile_of(plane, x, DEEP) for key, plane in each.items()
            }
        drawing = curves(panels, "$z/a$", "plastic strain [%]", (0.0, SHALLOWEST))
        outcome.figures.append(
            context.save(
                drawing,
                name,
                f"Plastic strain over depth {words}",
                "Curves of the plastic strain over depth for each friction coefficient: FEM, SAM with coupling on it, SAM "
                "decoupled and with the loop of the paper beside it.",
                "In y = 0 at the peak. Grey: too near the surface to be compared, where the strain depends on the mesh.",
            )
        )
    for mu, found in results.items():
        edge = found.fem.quantities["contact_radius_m"] / found.a
        outcome.figures.append(
            context.save(
                compared_planes(planes[mu][COUPLED], planes[mu]["FEM"], ("SAM", "FEM"), edge),
                f"plane-{spelt(mu)}",
                f"Plastic strain in the plane y = 0, μ = {mu:g}",
                "Three maps of the plastic strain over x/a and z/a: SAM, FEM and their difference; with friction the zone "
                "leans towards where the traction pushes, and rises to the surface.",
                "Labelled iso-lines: 0.2 % and 2 % where reached. The body is pulled along +x. The strip that FEM has no "
                "element centre in is blank.",
                embedded=mu > 0.0,
            )
        )


FIGURE_8 = (
    Level(
        "quick", 4.0, Resolution(14, 8), friction=(0.2,), forms=(COUPLED, DECOUPLED), steps=5, level="quick"
    ),
    Level("3", 3.0, Resolution(16, 12), Resolution(10, 6)),
    Level("4", 4.0, Resolution(16, 12), Resolution(10, 6)),
    Level("6-2", 6.2, Resolution(16, 12), shown=("axis", "column", "decoupled")),
)
"""At 6.2 the zone reaches 1.7 a, into elements that grow, where the strain is a tenth of the largest: its profile is shown, its
contours are gated; and the coupled form is off by more of the steeper pressure at the edge, the decoupled one by no more."""


def _cases() -> Iterator[Case]:
    sources = (
        *EQUATIONS,
        (
            "Full slip",
            "q = μp along +x on the body, in every load step",
            "Bosman & Schipper (2011), section 3",
        ),
        (
            "Coupling",
            "u_z(q) = (1 − 2ν)/(4πμ) ∫ q ξ/ρ² dA for a rigid counter-body; none in the decoupled form",
            "Cerruti; Johnson, Contact Mechanics (1985), section 3.6",
        ),
    )
    for level in FIGURE_8:
        yield Case(
            f"figure-8-{level.name}",
            f"Sliding sphere, Swift, p₀/σ_y0 = {level.ratio:g}"
            + f", {level.steps} steps" * bool(level.steps),
            "Do SAM and FEM give the same plastic strain and pressure in full slip, and what does the decoupled form cost?",
            partial(run, level=level),
            sources,
            (level.level,),
        )


CASES = tuple(_cases())
