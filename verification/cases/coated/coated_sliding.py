# SPDX-License-Identifier: MIT
"""A rigid sphere in full slip on an elastic coated body: SAM against finite elements in three dimensions.

Bosman & Schipper (2011), section 2, judge the film in a sliding contact (mu = 0.1). The film is taken thick
enough for two hexahedra to hold it; both models also solve the contact without it, so that the changes by the
film are compared as well.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import RegularGridInterpolator

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
    off_text,
    quantity_rows,
    with_body,
    with_grid,
    with_keys,
)
from verification.compare.sliding_measures import nodal_pressures, pressure_distance
from verification.figures.film import sliding_pressures, sliding_sections
from verification.figures.friction import Curve
from verification.references import contact_of
from verification.runs.sampling import peak, plane_field

SCENE = "coated-sliding"
FRICTION = (0.1, 0.4)
THICKNESSES = (0.1, 0.2)
"""Of the film, in contact radii of the elastic contact without it."""
FILM_SIDE = 1 - 1e-6
"""Thicknesses: the side of the interface on which the stresses are those of the film."""
CELLS = 16
ELEMENTS, COARSER = 10, 6
"""Cells (SAM) and elements (FEM) in that contact radius; the film has two elements over its thickness."""
BOX = 6.0
WIDE = 1.5
"""Half width of the part of the plane y = 0 that is compared, in that contact radius."""
REACH, DEEP, SPACING = 1.6, 1.6, 0.04
"""Half extent of the grid, largest output depth and spacing of the depths, in that contact radius."""
SHOWN = {
    "approach_m": ("approach [nm]", 1e9),
    "contact_radius_m": ("contact radius [µm]", 1e6),
    "p_max_Pa": ("largest pressure [GPa]", 1e-9),
    "mises_max_substrate_Pa": ("largest von Mises stress of the body [GPa]", 1e-9),
    "mises_max_film_Pa": ("of the film, at its surface or near it [GPa]", 1e-9),
    "p_max_bare_Pa": ("largest pressure without film [GPa]", 1e-9),
    "mises_max_bare_Pa": ("largest von Mises stress without film, at the same depths [GPa]", 1e-9),
}
CHANGES = {
    "p_max_change": "change of the largest pressure",
    "mises_max_change": "of the von Mises stress of the body",
}


@dataclass(frozen=True)
class SlidingPair:
    """Both models of one scene. coupled, decoupled: SAM; a: contact radius of the elastic contact without
    film, m.
    """

    scene: Scene
    coupled: Result
    decoupled: Result
    fem: Result
    a: float


def scene_of(
    base: Scene, friction: float, share: float, *, elements: int = ELEMENTS, coupling: bool = True
) -> Scene:
    """The scene with this friction and a film of `share` of the contact radius, on both grids."""
    a = contact_of(base).contact_radius
    thickness = share * a
    n = 2 * round(REACH * CELLS) + 1
    even = SPACING * a * np.arange(round(DEEP / SPACING) + 1)
    faces = [FILM_SIDE * thickness, thickness]
    depths = np.union1d(even[np.abs(even - thickness) > 1e-3 * a], faces)
    scene = with_grid(
        base, cells=(n, n), extent=(n * a / CELLS, n * a / CELLS), depths=tuple(map(float, depths))
    )
    rubbed = scene.model_copy(update={"friction": Friction(coefficient=friction, coupling=coupling)})
    return with_keys(
        with_keys(rubbed, "body.coating", thickness=thickness), "fem", box=BOX, cells_per_radius=elements
    )


@dataclass(frozen=True)
class SlidingFilms:
    """(friction, thickness) -> results. coarser, bare: of the thickest film, by friction: FEM on COARSER, SAM
    without film.
    """

    base: Scene
    pairs: Mapping[tuple[float, float], SlidingPair]
    coarser: Mapping[float, Result]
    bare: Mapping[float, Result]


class CoatedSliding(Case):
    """Every friction coefficient and thickness; a coarser mesh of the thickest film."""

    def solve(self, context: Context) -> SlidingFilms:
        base, share = context.scene(SCENE), THICKNESSES[-1]
        pairs = {(mu, h): solved(context, base, mu, h) for h in THICKNESSES for mu in FRICTION}
        coarser = {mu: scene_of(base, mu, share, elements=COARSER) for mu in FRICTION}
        bare = {mu: with_body(pairs[mu, share].scene, coating=None) for mu in FRICTION}
        return SlidingFilms(
            base,
            pairs,
            {mu: context.solve(FEM_3D, s, f"fem-{spelt(mu, share)}-coarser") for mu, s in coarser.items()},
            {mu: context.solve(SAM, s, f"sam-{spelt(mu, share)}-bare") for mu, s in bare.items()},
        )

    def measure(self, found: SlidingFilms) -> dict[str, Measured]:
        return {
            f"{spelt(mu, share)}-{name}": value
            for (mu, share), pair in found.pairs.items()
            for name, value in compared(pair).items()
        }

    def setup(self, found: SlidingFilms) -> list[tuple[str, str]]:
        base, pair = found.base, next(iter(found.pairs.values()))
        size = f"{pair.a * 1e6:.4f} µm, {contact_of(base).peak_pressure / 1e9:.4f} GPa"
        thicknesses = " and ".join(f"{share:g} a₀ = {1e9 * share * pair.a:.0f} nm" for share in THICKNESSES)
        return [
            ("Half-space", f"{elastic_text(base.body)}, elastic"),
            ("Film", f"{elastic_text(base.body.coating)}, elastic, {thicknesses} thick"),
            ("Sphere", f"R = {base.counterbody.radius * 1e6:g} µm, rigid; {base.loading.force:.5g} N"),
            ("Elastic contact without film (a₀, p₀)", size),
            ("Friction", ", ".join(f"μ = {mu:g}" for mu in FRICTION) + "; q = μp along +x on the body"),
            ("SAM", grid_text(pair.coupled, pair.a)),
            (
                "FEM",
                f"{mesh_text(pair.fem)}, {ELEMENTS} elements in a₀, two over the film; box {BOX:g} a₀, half "
                "of the contact",
            ),
        ]

    def tables(self, found: SlidingFilms) -> list[SmallTable]:
        return [numbers(found.pairs), coupling_table(found.pairs), trend(found)]

    def figures(self, found: SlidingFilms) -> Iterator[Plot]:
        share, p0 = THICKNESSES[-1], contact_of(found.base).peak_pressure
        thickest = {mu: found.pairs[mu, share] for mu in FRICTION}
        panels = {}
        for mu, pair in thickest.items():
            results = {"SAM": pair.coupled, "FEM": pair.fem, "SAM, no film": found.bare[mu]}
            panels[f"μ = {mu:g}"] = {name: along(result, pair.a, p0) for name, result in results.items()}
        yield Plot(
            sliding_pressures(panels),
            "pressure",
            f"Pressure along the sliding direction, h = {share:g} a₀",
            "Pressure over x for each friction coefficient: FEM on the curve of SAM, both below and wider "
            "than the pressure without film, and leaning against the traction where friction is high.",
            "On y = 0. The traction acts on the body along +x.",
        )
        for mu, pair in thickest.items():
            yield Plot(
                sliding_sections(pair.coupled, pair.fem, (pair.a, p0), share * pair.a),
                f"mises-{spelt(mu, share)}",
                f"Von Mises stress in the plane y = 0, μ = {mu:g}, h = {share:g} a₀",
                "Three maps of the von Mises stress of the body below its film over x/a and z/a: SAM, FEM "
                "and their difference; the largest lies below the leading half of the contact and moves up "
                "with friction.",
                "From the lower face of the film on; the cross marks the largest value. FEM is linear "
                "between its lower face and the centres of the elements below.",
            )


def spelt(friction: float, share: float) -> str:
    """For the id of a gate."""
    return f"mu-{friction:g}-h-{share:g}".replace(".", "-")


def solved(context: Context, base: Scene, friction: float, share: float) -> SlidingPair:
    """One friction coefficient and thickness by both models."""
    label = spelt(friction, share)
    scene = scene_of(base, friction, share)
    coupled = context.solve(SAM, scene, f"sam-{label}")
    decoupled = context.solve(SAM, scene_of(base, friction, share, coupling=False), f"decoupled-{label}")
    fem = context.solve(FEM_3D, scene, f"fem-{label}")
    return SlidingPair(scene, coupled, decoupled, fem, contact_of(base).contact_radius)


def compared(pair: SlidingPair) -> dict[str, Measured]:
    """SAM against FEM: pressure, its centre, stress of the body below the film, and what the film changes."""
    sam, fem, a = pair.coupled.quantities, pair.fem.quantities, pair.a
    p_sam, p_fem, area = nodal_pressures(pair.coupled, pair.fem)
    own, reference = below_film(pair)
    return {
        "p-max": Measured(float(p_sam.max()), float(p_fem.max()), unit="Pa"),
        "pressure": Measured(p_sam, p_fem, area),
        "centroid": Measured(sam["pressure_centroid_x_m"] / a, fem["pressure_centroid_x_m"] / a, unit="a"),
        "p-change": Measured(sam["p_max_change"], fem["p_max_change"]),
        "mises-plane": Measured(own, reference),
        "mises-largest": Measured(float(own.max()), float(reference.max()), unit="Pa"),
        "mises-body": Measured(sam["mises_max_substrate_Pa"], fem["mises_max_substrate_Pa"], unit="Pa"),
        "mises-change": Measured(sam["mises_max_change"], fem["mises_max_change"]),
    }


def below_film(pair: SlidingPair) -> tuple[np.ndarray, np.ndarray]:
    """Von Mises stress in y = 0 where FEM gives it, from the interface on: SAM, linear between its points,
    and FEM.
    """
    interface = pair.scene.body.coating.thickness * (1.0 - 1e-9)
    (x, z, own), (u, w, reference) = (
        plane_field(each.tables, "mises_Pa") for each in (pair.coupled, pair.fem)
    )
    body = z >= interface
    columns, rows = np.abs(u) <= WIDE * pair.a, (w >= interface) & (w <= z[-1])
    depths = np.maximum(w[rows], z[body][0])  # the interface to rounding
    at = np.stack(np.meshgrid(u[columns], depths, indexing="ij"), axis=-1)
    return RegularGridInterpolator((x, z[body]), own[:, body])(at), reference[np.ix_(columns, rows)]


def numbers(pairs: Mapping[tuple[float, float], SlidingPair]) -> SmallTable:
    """Both answers and their difference; changes differ by percentage points."""
    rows = []
    for (mu, share), pair in pairs.items():
        sam, fem = pair.coupled.quantities, pair.fem.quantities
        own = quantity_rows(SHOWN, pair.coupled, pair.fem)
        for name, words in CHANGES.items():
            values = (f"{1e2 * q[name]:+.2f} %" for q in (sam, fem))
            own.append((words, *values, f"{1e2 * (sam[name] - fem[name]):+.2f} points"))
        rows += [(f"{mu:g}", f"{share:g}", *row) for row in own]
    return SmallTable("Results", ("μ", "h/a₀", "quantity", "SAM", "FEM", "difference"), rows)


def coupling_table(pairs: Mapping[tuple[float, float], SlidingPair]) -> SmallTable:
    """What the traction does to the pressure, and what is lost without."""
    rows = []
    for (mu, share), pair in pairs.items():
        results = {"FEM": pair.fem, "SAM": pair.coupled, "SAM, decoupled": pair.decoupled}
        for name, result in results.items():
            q = result.quantities
            apart = 0.0 if result is pair.fem else pressure_distance(*nodal_pressures(result, pair.fem))
            centre = f"{q['pressure_centroid_x_m'] / pair.a:+.4f} a₀"
            off = "" if result is pair.fem else f"{1e2 * apart:.2f} %"
            rows.append((f"{mu:g}", f"{share:g}", name, centre, off))
    return SmallTable(
        "Coupling of traction and pressure",
        ("μ", "h/a₀", "model", "centre of pressure", "pressure off FEM, L2"),
        rows,
    )


def trend(found: SlidingFilms) -> SmallTable:
    """FEM on a coarser mesh, for the share of its elements in the differences."""
    rows, share = [], THICKNESSES[-1]
    for mu in FRICTION:
        pair = found.pairs[mu, share]
        for elements, fem in ((COARSER, found.coarser[mu]), (ELEMENTS, pair.fem)):
            values = compared(replace(pair, fem=fem))
            relative = (off_text(values[n].value, values[n].expected) for n in ("p-max", "mises-body"))
            points = (
                f"{1e2 * (values[name].value - values[name].expected):+.2f}"
                for name in ("p-change", "mises-change")
            )
            rows.append((f"{mu:g}", f"a₀/{elements}", *relative, *points))
    return SmallTable(
        f"SAM off FEM over its elements, h = {share:g} a₀",
        (
            *("μ", "elements", "largest pressure", "von Mises of the body", "change of p_max [points]"),
            "of von Mises [points]",
        ),
        rows,
    )


def along(result: Result, a: float, p0: float) -> Curve:
    """p/p0 on y = 0 over x/a0."""
    x, p = peak(result.tables["line"], "x_m", "p_Pa")
    use = np.abs(x) <= 1.4 * a
    return Curve(x[use] / a, p[use] / p0)


CASES = (CoatedSliding("coated-sliding"),)
