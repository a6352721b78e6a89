# SPDX-License-Identifier: MIT
"""A rigid sphere in full slip on Swift steel: SAM with and without coupling, with the loop of the paper, and
FEM in 3D.

The comparison of Bosman & Schipper (2011), Fig. 8: plastic strain over depth for three friction coefficients.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from sam.scene import Friction, Result, Scene
from verification.cases.case import (
    FEM_3D,
    SAM,
    Case,
    Context,
    Measured,
    Plot,
    SmallTable,
    elastic_text,
    grid_text,
    mesh_text,
    number,
    off_text,
    with_keys,
    with_loading,
)
from verification.cases.recipes import Resolution, at_ratio, initial_yield, resolved_at
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
from verification.references import contact_of

SCENE = "plastic-swift-rigid"
FRICTION = (0.0, 0.2, 0.4)
BOX = 6.0  # elastic contact radii: the far field of the point forces is prescribed there
LEVELS = (0.002, 0.02)
DEEP = 1.4
PATCH = 0.2  # half width, in elastic contact radii, of the hats over which pressures are held against FEM
FORMS = {
    COUPLED: (True, {}),
    DECOUPLED: (False, {}),
    PAPER: (False, {"method": "paper", "stop": "stress"}),
}
"""What SAM is asked for: coupling, and other keys of [solver]. The paper has neither coupling nor the
backward Euler loop.
"""
SHORT = {COUPLED: "coupled", DECOUPLED: "decoupled", PAPER: "paper"}


@dataclass(frozen=True)
class LoadLevel:
    """A load, p0 of the elastic contact over the initial yield stress; fine, coarse: grids, the latter for
    the trend.

    steps: None takes those of the scene file; level: of the verification; shown: what is in the tables and
    not gated.
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
    """The results at one friction coefficient. sam: form -> result; a: contact radius of the elastic contact
    in m.
    """

    sam: Mapping[str, Result]
    fem: Result
    a: float

    def planes(self) -> dict[str, Plane]:
        """Of FEM and of every form of SAM."""
        return {"FEM": Plane.of(self.fem, self.a)} | {
            name: Plane.of(r, self.a) for name, r in self.sam.items()
        }

    def apart_at_nodes(self, result: Result) -> float:
        """Relative distance of a pressure from that of FEM at its nodes, L2."""
        return pressure_distance(*nodal_pressures(result, self.fem))

    def apart_over_hats(self, result: Result) -> float:
        """The same over hats of the half width PATCH."""
        return patch_distance(result, self.fem, PATCH * self.a)


def sliding_scene(
    base: Scene, ratio: float, friction: float, resolution: Resolution, *, coupling: bool = True
) -> Scene:
    """Loading to p0 = ratio sigma_y0 with friction, on these grids."""
    scene = resolved_at(with_loading(at_ratio(base, ratio), unload=False), resolution)
    rubbed = Friction(coefficient=friction, coupling=coupling) if friction else None
    return with_keys(scene, "fem", box=BOX).model_copy(update={"friction": rubbed})


def solved(
    context: Context, base: Scene, level: LoadLevel, friction: float, *, coarse: bool = False
) -> Sliding:
    """Every form of SAM and FEM, on the coarse grids the coupled one alone. The loop of the paper need not
    converge.
    """
    at, forms = (level.coarse, (COUPLED,)) if coarse else (level.fine, level.forms)
    label = f"{friction:g}".replace(".", "") + f"-{at.sam}-{at.fem}"
    found = {}
    for name in forms:
        coupling, keys = FORMS[name]
        if friction or name != DECOUPLED:
            scene = sliding_scene(base, level.ratio, friction, at, coupling=coupling)
            scene = with_keys(scene, "solver", **keys)
            found[name] = context.solve(SAM, scene, f"{SHORT[name]}-{label}", demand=name != PAPER)
    scene = sliding_scene(base, level.ratio, friction, at)
    return Sliding(found, context.solve(FEM_3D, scene, f"fem-{label}"), contact_of(scene).contact_radius)


@dataclass(frozen=True)
class SolvedFrictions:
    """One load at every friction coefficient. base: the scene that is varied; coarse: on coarse grids, for
    the trend.
    """

    base: Scene
    fine: Mapping[float, Sliding]
    coarse: Mapping[float, Sliding]


@dataclass(frozen=True)
class Figure8(Case):
    """One load at every friction coefficient."""

    level: LoadLevel | None = None

    def solve(self, context: Context) -> SolvedFrictions:
        level, base = self.level, context.scene(SCENE)
        base = with_loading(base, steps=level.steps or base.loading.steps)
        fine = {mu: solved(context, base, level, mu) for mu in level.friction}
        again = level.friction if level.coarse else ()
        return SolvedFrictions(
            base, fine, {mu: solved(context, base, level, mu, coarse=True) for mu in again}
        )

    def measure(self, found: SolvedFrictions) -> dict[str, Measured]:
        return {
            f"{spelt(mu)}-{name}": value
            for mu, each in found.fine.items()
            for name, value in compared(each, mu).items()
            if name not in self.level.shown
        }

    def setup(self, found: SolvedFrictions) -> list[tuple[str, str]]:
        scene = sliding_scene(found.base, self.level.ratio, 0.0, self.level.fine)
        elastic, first = contact_of(scene), next(iter(found.fine.values()))
        a, loading = elastic.contact_radius, scene.loading
        coefficients = ", ".join(f"μ = {mu:g}" for mu in found.fine)
        return [
            ("Half-space", f"{elastic_text(scene.body)}; Swift, as in {SCENE}"),
            (
                "Initial yield stress",
                f"{initial_yield(scene) / 1e6:.1f} MPa; p₀/σ_y0 = {self.level.ratio:g}",
            ),
            ("Sphere", f"R = {scene.counterbody.radius * 1e6:g} µm, rigid"),
            ("Friction", f"{coefficients}; q = μp along +x on the body, in every step"),
            ("Force", f"{loading.force:.5g} N in {loading.steps} equal steps"),
            ("Elastic contact (a, p₀)", f"{a * 1e6:.4f} µm, {elastic.peak_pressure / 1e9:.4f} GPa"),
            ("SAM", grid_text(first.sam[COUPLED], a)),
            (
                "FEM",
                f"{mesh_text(first.fem)}, {self.level.fine.fem} elements in a, box {BOX:g} a, half of the "
                "contact",
            ),
        ]

    def tables(self, found: SolvedFrictions) -> Iterator[SmallTable]:
        yield numbers(found.fine)
        yield depths_table(found.fine)
        if found.coarse:
            yield trend(found, self.level)

    def figures(self, found: SolvedFrictions) -> Iterator[Plot]:
        planes = {mu: each.planes() for mu, each in found.fine.items()}
        for name, words in (("axis", "on the axis"), ("column", "where it is largest")):
            panels = {}
            for mu, each in planes.items():
                x = each["FEM"].place_of_maximum() if name == "column" else 0.0
                profiles = {key: profile_of(plane, x, DEEP) for key, plane in each.items()}
                panels[f"μ = {mu:g}, x = {x:.2f} a"] = profiles
            yield Plot(
                curves(panels, "$z/a$", "plastic strain [%]", (0.0, SHALLOWEST)),
                name,
                f"Plastic strain over depth {words}",
                "Curves of the plastic strain over depth for each friction coefficient: FEM, SAM with "
                "coupling on it, SAM decoupled and with the loop of the paper beside it.",
                "In y = 0 at the peak. Grey: too near the surface to be compared, where the strain depends "
                "on the mesh.",
            )
        for mu, each in found.fine.items():
            edge = each.fem.quantities["contact_radius_m"] / each.a
            yield Plot(
                compared_planes(
                    planes[mu][COUPLED], planes[mu]["FEM"], ("SAM", "FEM"), edge, strip=SHALLOWEST
                ),
                f"plane-{spelt(mu)}",
                f"Plastic strain in the plane y = 0, μ = {mu:g}",
                "Three maps of the plastic strain over x/a and z/a: SAM, FEM and their difference; with "
                "friction the zone leans towards where the traction pushes, and rises to the surface.",
                "Iso-lines in %, among them 0.2 % and 2 % where reached. The body is pulled along +x. "
                "Hatched: too near the surface to be compared, where the strain depends on the mesh.",
                embedded=mu > 0.0,
            )


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
        **contour_extents(own, fem),
    }
    if friction:
        values |= {
            "centroid": Measured(shift(sam, found.a), shift(found.fem, found.a), unit="a"),
            "decoupled": Measured(further(found, found.apart_at_nodes)),
            "decoupled-hats": Measured(further(found, found.apart_over_hats)),
        }
    return values


def further(found: Sliding, distance: Callable[[Result], float]) -> float:
    """Distance of the decoupled form from FEM over that of the coupled one."""
    return distance(found.sam[DECOUPLED]) / distance(found.sam[COUPLED])


def contour_extents(sam: Plane, fem: Plane) -> dict[str, Measured]:
    """Depth and length of the parts of y = 0 beyond 0.2 % and 2 % of plastic strain, where either model has
    them.
    """
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


def numbers(results: Mapping[float, Sliding]) -> SmallTable:
    """Pressures, centroid, distance in pressure, largest strain (which at the surface depends on the mesh),
    and cost.
    """
    rows = []
    for mu, found in results.items():
        for name, result in ({"FEM": found.fem} | found.sam).items():
            q = result.quantities
            apart = (found.apart_at_nodes, found.apart_over_hats)
            rows.append(
                (
                    f"{mu:g}",
                    name,
                    number(q["p_max_Pa"] * 1e-9, 5),
                    f"{shift(result, found.a):+.4f} a",
                    *("" if result is found.fem else f"{1e2 * distance(result):.2f} %" for distance in apart),
                    f"{1e2 * q['peeq_max']:.3f} %",
                    f"{q['peeq_max_depth_m'] / found.a:.3f} a",
                    number(result.cost["solve_s"], 3),
                )
            )
    return SmallTable(
        "Pressure and the largest strain; where that lies in the surface it depends on the mesh",
        (
            *("μ", "model", "largest pressure [GPa]", "centre of pressure", "pressure off FEM, L2"),
            *("over hats of 0.2 a", "largest plastic strain", "its depth", "solution [s]"),
        ),
        rows,
    )


def depths_table(results: Mapping[float, Sliding]) -> SmallTable:
    """The figure as numbers: plastic strain at fixed depths on the axis and at the x of the largest, FEM and
    every form.
    """
    rows = []
    for mu, found in results.items():
        planes = found.planes()
        for x in dict.fromkeys((0.0, planes["FEM"].place_of_maximum())):
            for z in depths_compared(planes["FEM"], x):
                at = {name: plane.at(np.array([x]), np.array([z]))[0, 0] for name, plane in planes.items()}
                cells = (f"{1e2 * at[name]:.4f}" if name in at else "" for name in ("FEM", *FORMS))
                off = off_text(at[COUPLED], at["FEM"])
                rows.append((f"{mu:g}", f"{x:.2f}", f"{z:.1f}", *cells, off))
    return SmallTable(
        "Plastic strain in % over depth", ("μ", "x/a", "z/a", "FEM", *FORMS, "SAM off FEM"), rows
    )


def trend(found: SolvedFrictions, level: LoadLevel) -> SmallTable:
    """The differences between the models on coarse and fine grids, and the largest strain of each."""
    rows = []
    for mu in found.fine:
        for at, each in ((level.coarse, found.coarse[mu]), (level.fine, found.fine[mu])):
            planes = each.planes()
            own, fem = planes[COUPLED], planes["FEM"]
            strains = (f"{1e2 * r.quantities['peeq_max']:.3f} %" for r in (each.sam[COUPLED], each.fem))
            differences = (
                each.apart_at_nodes(each.sam[COUPLED]),
                profile_difference(own, fem, 0.0),
                profile_difference(own, fem, fem.place_of_maximum()),
            )
            rows.append(
                (f"{mu:g}", (f"a/{at.sam}, a/{at.fem}"), *(f"{1e2 * d:.2f} %" for d in differences), *strains)
            )
    return SmallTable(
        ("Refinement: differences of the models at z ≥ 0.3 a, and the largest strain anywhere"),
        (
            *("μ", "cells, elements", "pressure, L2", "strain on the axis", "strain at its largest"),
            *("largest strain, SAM", "largest strain, FEM"),
        ),
        rows,
    )


FIGURE_8 = (
    LoadLevel(
        "quick", 4.0, Resolution(14, 8), friction=(0.2,), forms=(COUPLED, DECOUPLED), steps=5, level="quick"
    ),
    LoadLevel("3", 3.0, Resolution(16, 12), Resolution(10, 6)),
    LoadLevel("4", 4.0, Resolution(16, 12), Resolution(10, 6)),
    LoadLevel("6-2", 6.2, Resolution(16, 12), shown=("axis", "column", "decoupled")),
)
"""At 6.2 the zone reaches 1.7 a, into elements that grow, where the strain is a tenth of the largest: its
profile is shown, its contours are gated; and the coupled form is off by more of the steeper pressure at the
edge, the decoupled one by no more.
"""

CASES = tuple(Figure8(f"figure-8-{level.name}", level=level) for level in FIGURE_8)
