# SPDX-License-Identifier: MIT
"""Hertz pressure and traction given, no contact searched: stresses of both solvers in the closed form, then
plastic flow.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from sam.scene import Friction, Grid, Loading, Result, Scene
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
    with_body,
    with_keys,
)
from verification.cases.recipes import Resolution, at_ratio, initial_yield, resolved_at
from verification.cases.sliding.friction import BOX, DEEP, SCENE, contour_extents, spelt
from verification.cases.sliding.given_limit import FRICTION as LIMIT_FRICTION, Limits, limits
from verification.compare.sliding_measures import SHALLOWEST, Plane, depths_compared, profile_difference
from verification.figures.friction import compared_planes, curves, profile_of
from verification.reference.hamilton import sliding_stress
from verification.reference.stress import von_mises
from verification.references import contact_of
from verification.runs.sampling import peak

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
    changed = {"counterbody": None, "loading": loading, "friction": Friction(coefficient=friction)}
    return with_keys(scene, "fem", box=BOX).model_copy(update=changed)


@dataclass(frozen=True)
class Given:
    """A scene with given tractions, solved by both models."""

    scene: Scene
    sam: Result
    fem: Result

    @property
    def planes(self) -> tuple[Plane, Plane]:
        """The plane y = 0 of SAM and FEM."""
        return tuple(Plane.of(result, self.scene.loading.radius) for result in (self.sam, self.fem))

    def setup(self, at: Resolution) -> list[tuple[str, str]]:
        """The numbers that both cases show. at: the resolution of the scene."""
        loading = self.scene.loading
        return [
            ("Half-space", elastic_text(self.scene.body)),
            ("Tractions", "p = p₀ √(1 − r²/a²), q = μp along +x, given; no contact is solved"),
            (
                "Size (a, p₀)",
                (f"{loading.radius * 1e6:.4f} µm, {loading.p0 / 1e9:.4f} GPa in {loading.steps} step(s)"),
            ),
            ("SAM", grid_text(self.sam, loading.radius)),
            ("FEM", f"{mesh_text(self.fem)}, {at.fem} elements in a, box {BOX:g} a"),
        ]


def solved(context: Context, scene: Scene, label: str = "") -> Given:
    """A scene by both models."""
    sam = context.solve(SAM, scene, f"sam{label}")
    return Given(scene, sam, context.solve(FEM_3D, scene, f"fem{label}"))


class GivenElastic(Case):
    """Every component at interior points, against Hamilton's closed form."""

    def solve(self, context: Context) -> Given:
        scene = given(resolved_at(at_ratio(context.scene(SCENE), 1.0), ELASTIC), FRICTION, 1)
        depths = tuple(float(z) * scene.loading.radius for z in np.linspace(0.0, 2.0, 81))
        grid = Grid(cells=scene.grid.cells, extent=scene.grid.extent, depths=depths)
        return solved(context, with_body(scene, plasticity=None).model_copy(update={"grid": grid}))

    def measure(self, found: Given) -> dict[str, float]:
        values = {f"fem-{n}": e for n, e in zip(COMPONENTS, element_errors(found), strict=True)}
        sam = {f"sam-{n}": e for n, e in zip(COMPONENTS, axis_errors(found), strict=True)}
        gated = {name: e for name, e in sam.items() if name[4:] not in ZERO_ON_THE_AXIS}
        return values | gated | {"sam-plane": plane_error(found)}

    def setup(self, found: Given) -> list[tuple[str, str]]:
        *first, sam, fem = found.setup(ELASTIC)
        return [
            *first,
            (
                "Interior points",
                (f"z from {INTERIOR[0]:g} a to {INTERIOR[1]:g} a, |x| and |y| up to {WIDE:g} a"),
            ),
            sam,
            fem,
        ]

    def tables(self, found: Given) -> Iterator[SmallTable]:
        errors = {"SAM": axis_errors(found), "FEM": element_errors(found)}
        yield SmallTable(
            "Largest error of each component in % of p₀",
            ("model", *COMPONENTS),
            [(name, *(f"{1e2 * e:.3f}" for e in each)) for name, each in errors.items()],
        )


def exact_stress(scene: Scene, x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Hamilton's stresses over p0 at places in m, (..., 6)."""
    loading, body = scene.loading, scene.body
    return sliding_stress(
        x, y, z, 1.0, contact_radius=loading.radius, nu=body.poisson, friction=scene.coefficient
    )


def element_errors(found: Given) -> np.ndarray:
    """Largest error of each component over the elements inside, at their centres, in p0: (6,)."""
    scene, a, fields = found.scene, found.scene.loading.radius, found.fem.fields
    x, y, z = (fields.points[fields.cells["hexahedron"]].mean(axis=1)).T
    use = inside(z, a) & (np.abs(x) <= WIDE * a) & (np.abs(y) <= WIDE * a)
    stress = np.asarray(fields.cell_data["stress_Pa"])[use] / scene.loading.p0
    return np.abs(stress - exact_stress(scene, x[use], y[use], z[use])).max(axis=0)


def inside(z: np.ndarray, a: float) -> np.ndarray:
    """Which depths are compared."""
    return (z >= INTERIOR[0] * a) & (z <= INTERIOR[1] * a)


def axis_errors(found: Given) -> np.ndarray:
    """Largest error of each component on the axis, in p0: (6,)."""
    scene = found.scene
    z, *stress = peak(found.sam.tables["axis"], "z_m", *(f"{name}_Pa" for name in COMPONENTS))
    use = inside(z, scene.loading.radius)
    zero = np.zeros(use.sum())
    exact = exact_stress(scene, zero, zero, z[use])
    return np.abs(np.stack(stress, axis=1)[use] / scene.loading.p0 - exact).max(axis=0)


def plane_error(found: Given) -> float:
    """Largest error of the von Mises stress in y = 0 inside, in p0."""
    scene, a = found.scene, found.scene.loading.radius
    x, z, mises = peak(found.sam.tables["plane"], "x_m", "z_m", "mises_Pa")
    use = inside(z, a) & (np.abs(x) <= WIDE * a)
    exact = von_mises(exact_stress(scene, x[use], np.zeros(use.sum()), z[use]))
    return float(np.abs(mises[use] / scene.loading.p0 - exact).max())


@dataclass(frozen=True)
class GivenPairs:
    """base: the scene that the others vary; pairs: friction coefficient -> the result of both models; limits:
    of both without cells and load steps.
    """

    base: Scene
    pairs: dict[float, Given]
    limits: Limits


class GivenPlastic(Case):
    """The plastic loop alone: strain over depth under given tractions, SAM against FEM."""

    def solve(self, context: Context) -> GivenPairs:
        base = at_ratio(context.scene(SCENE), RATIO)
        scenes = {mu: given(resolved_at(base, AT), mu, base.loading.steps) for mu in PLASTIC}
        labels = {mu: f"-{mu:g}".replace(".", "") for mu in PLASTIC}
        pairs = {mu: solved(context, scene, labels[mu]) for mu, scene in scenes.items()}

        def scene(count: int, steps: int) -> Scene:
            return given(resolved_at(base, Resolution(count, count)), LIMIT_FRICTION, steps)

        return GivenPairs(base, pairs, limits(context, scene, pairs[LIMIT_FRICTION].planes))

    def measure(self, found: GivenPairs) -> dict[str, Measured | float]:
        values = {}
        for mu, pair in found.pairs.items():
            own, reference = pair.planes
            of_pair = {
                "axis": profile_difference(own, reference, 0.0),
                "column": profile_difference(own, reference, reference.place_of_maximum()),
                **contour_extents(own, reference),
            }
            values |= {f"{spelt(mu)}-{name}": value for name, value in of_pair.items()}
        return values | {f"{spelt(LIMIT_FRICTION)}-{n}": v for n, v in found.limits.values().items()}

    def setup(self, found: GivenPairs) -> list[tuple[str, str]]:
        first = (
            "Yield",
            f"Swift, as in {SCENE}; p₀/σ_y0 = {RATIO:g}, σ_y0 = {initial_yield(found.base) / 1e6:.1f} MPa",
        )
        return [first, *found.pairs[PLASTIC[-1]].setup(AT)]

    def tables(self, found: GivenPairs) -> Iterator[SmallTable]:
        yield SmallTable(
            "Plastic strain in % over depth",
            ("μ", "x/a", "z/a", "FEM", "SAM", "difference"),
            [row for mu, pair in found.pairs.items() for row in strain_rows(*pair.planes, mu)],
        )
        yield found.limits.table()

    def figures(self, found: GivenPairs) -> Iterator[Plot]:
        panels = {}
        for mu, pair in found.pairs.items():
            own, reference = pair.planes
            x = reference.place_of_maximum()
            both = {"FEM": reference, "SAM": own}
            panels[f"μ = {mu:g}, x = {x:.2f} a"] = {n: profile_of(p, x, DEEP) for n, p in both.items()}
        yield Plot(
            curves(panels, "$z/a$", "plastic strain [%]", (0.0, SHALLOWEST)),
            "depth",
            "Plastic strain over depth",
            "Curves of the plastic strain over depth of FEM with SAM on them, for two friction coefficients.",
            "In y = 0 at the x of the largest strain. Grey: too near the surface to be compared.",
        )
        for mu, pair in found.pairs.items():
            yield Plot(
                compared_planes(*pair.planes, ("SAM", "FEM"), 1.0, strip=SHALLOWEST),
                f"plane-{spelt(mu)}",
                f"Plastic strain in the plane y = 0, μ = {mu:g}",
                "Three maps of the plastic strain over x/a and z/a: SAM, FEM and their difference.",
                "Iso-lines in %, among them 0.2 % and 2 % where reached. Hatched: too near the surface to be "
                "compared.",
            )


def strain_rows(own: Plane, reference: Plane, friction: float) -> list[tuple[str, ...]]:
    """The plastic strains that are compared, on the axis and at the x of the largest."""
    rows = []
    for at in dict.fromkeys((0.0, reference.place_of_maximum())):
        for z in depths_compared(reference, at):
            one, other = (plane.at(np.array([at]), np.array([z]))[0, 0] for plane in (own, reference))
            cells = number(1e2 * other, 4), number(1e2 * one, 4), off_text(one, other)
            rows.append((f"{friction:g}", f"{at:.2f}", f"{z:.1f}", *cells))
    return rows


CASES = (
    GivenElastic("sliding-given-elastic"),
    GivenPlastic("sliding-given"),
)
