# SPDX-License-Identifier: MIT
"""Repeated sliding: traction of one sign and of alternating sign, and a load that travels to and fro over the
shakedown limit.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from sam.scene import Body, Friction, Grid, Loading, Path, Plasticity, Result, Scene, Solver
from verification.figures.friction import CYCLES, Curve, curves
from verification.reference.hamilton import sliding_stress
from verification.suite.cases.case import (
    FEM_3D,
    SAM,
    Case,
    Context,
    Measured,
    Plot,
    SmallTable,
    grid_text,
    number,
    with_loading,
)
from verification.suite.cases.friction import BOX, SCENE, sliding_scene
from verification.suite.cases.hertz import contact_of
from verification.suite.cases.resolution import Resolution

RATIO, FRICTION, TIMES = 4.0, 0.3, 3
AT = Resolution(10, 6)
DIRECTIONS = ("constant", "alternating")


@dataclass(frozen=True)
class CyclicResults:
    """One direction of the traction by both models, "SAM" and "FEM"."""

    scene: Scene
    results: dict[str, Result]

    @property
    def strains(self) -> dict[str, np.ndarray]:
        """Model -> largest plastic strain of each cycle."""
        return {name: strain_of_cycles(result) for name, result in self.results.items()}

    @property
    def moved(self) -> list[float]:
        """How far the unloaded surface was moved along x, in m."""
        return [result.quantities["residual_ux_center_m"] for result in self.results.values()]


class CyclicSliding(Case):
    """Pressed, slid and unloaded several times, the traction always along +x or changing its sign."""

    def solve(self, context: Context) -> dict[str, CyclicResults]:
        base, found = context.scene(SCENE), {}
        for direction in DIRECTIONS:
            scene = with_loading(sliding_scene(base, RATIO, FRICTION, AT), unload=True, cycles=TIMES)
            rubbed = Friction(coefficient=FRICTION, direction=direction)
            scene = scene.model_copy(update={"friction": rubbed})
            models = {"SAM": SAM, "FEM": FEM_3D}
            found[direction] = CyclicResults(
                scene, {n: context.solve(m, scene, f"{n.lower()}-{direction}") for n, m in models.items()}
            )
        return found

    def measure(self, found: dict[str, CyclicResults]) -> dict[str, Measured | float]:
        return {f"{name}-{gate}": v for name, each in found.items() for gate, v in gates(each).items()}

    def setup(self, found: dict[str, CyclicResults]) -> list[tuple[str, str]]:
        last = found[DIRECTIONS[-1]]
        return [
            ("Scene", f"rigid sphere on Swift steel, p₀/σ_y0 = {RATIO:g}, μ = {FRICTION:g}"),
            (
                "History",
                f"{TIMES} cycles of {last.scene.loading.steps} steps and unloading; the traction lasts "
                "through unloading",
            ),
            ("SAM", grid_text(last.results["SAM"], contact_of(last.scene).contact_radius)),
            ("FEM", f"{AT.fem} elements in a, box {BOX:g} a"),
        ]

    def tables(self, found: dict[str, CyclicResults]) -> Iterator[SmallTable]:
        rows = [
            (direction, name, *(f"{1e2 * e:.4f}" for e in strains), f"{1e9 * moved:+.2f} nm")
            for direction, each in found.items()
            for (name, strains), moved in zip(each.strains.items(), each.moved, strict=True)
        ]
        numbers = (f"cycle {k}" for k in range(1, TIMES + 1))
        yield SmallTable(
            "Largest plastic strain in %, at the peak of each cycle",
            ("direction", "model", *numbers, "residual displacement along x"),
            rows,
        )

    def figures(self, found: dict[str, CyclicResults]) -> Iterator[Plot]:
        series = {
            f"{name}, {direction}": Curve(np.arange(1, TIMES + 1), 1e2 * strains)
            for direction, each in found.items()
            for name, strains in each.strains.items()
        }
        panels = {"Repeated sliding": series}
        yield Plot(
            curves(panels, "cycle", "largest plastic strain [%]", looks=in_order(series), count=True),
            "strain",
            "Plastic strain over the cycles",
            "Largest plastic strain over the cycle: level where the traction keeps its sign, rising where it "
            "alternates.",
            "At the surface, where the value depends on the mesh: SAM and FEM are compared by what a cycle "
            "adds.",
        )


def strain_of_cycles(result: Result) -> np.ndarray:
    """Largest plastic strain at the peak of each cycle."""
    return np.asarray(result.tables["cycles"]["peeq_max"], dtype=float)


def gates(found: CyclicResults) -> dict[str, Measured | float]:
    """What later cycles add, over the strain of the first, in both models; how far the surface was moved
    along x.
    """
    strains = found.strains.items()
    values = {f"{name.lower()}-adds": float(each[-1] / each[0] - 1.0) for name, each in strains}
    return values | {"moved": Measured(*found.moved, unit="m")}


@dataclass(frozen=True)
class Travel:
    """A load that travels, perfect plasticity. ratio: p0 over the yield stress; shakes: below the shakedown
    limit.
    """

    name: str
    ratio: float
    friction: float
    shakes: bool

    @property
    def over_shear(self) -> float:
        """p0 over the shear yield stress k."""
        return self.ratio * np.sqrt(3.0)

    @property
    def share(self) -> float:
        """Of the limit of p0/k."""
        return self.over_shear / shear_limit(self.friction)


TRAVELS = (
    Travel("below", 2.55, 0.0, True),
    Travel("above", 3.0, 0.0, False),
    Travel("below-sliding", 1.95, 0.2, True),
    Travel("above-sliding", 2.9, 0.2, False),
)
PASSES, STEPS, HALF_WAY, RADIUS = 8, 12, 1.5, 1e-5
YOUNG, POISSON, YIELD_STRESS = 210e9, 0.3, 1e9
CELLS = 6  # in the contact radius
BESIDE = (2.0, 1.8, 2.0)  # grid beyond the way of the centre along x, to its sides and in depth, in radii


class TravellingLoad(Case):
    """Hertz pressure with and without traction along a way, over and over; strain that still grows after many
    passes.
    """

    def solve(self, context: Context) -> dict[Travel, Result]:
        return {travel: context.solve(SAM, travelling(travel), travel.name) for travel in TRAVELS}

    def measure(self, found: dict[Travel, Result]) -> dict[str, float]:
        values = {}
        for travel, result in found.items():
            strain = strain_of_cycles(result)
            added = np.diff(strain)
            values[f"{travel.name}-adds"] = float(added[-1] / strain[0])
            if not travel.shakes:
                values[f"{travel.name}-keeps"] = float(added[-1] / added[len(added) // 2])
        return values

    def setup(self, found: dict[Travel, Result]) -> list[tuple[str, str]]:
        return [
            (
                "Body",
                f"E = {YOUNG / 1e9:g} GPa, ν = {POISSON:g}, perfectly plastic, σ_y = k √3 = "
                f"{YIELD_STRESS / 1e9:g} GPa",
            ),
            ("Load", f"p = p₀ √(1 − r²/a²), q = μp along +x, a = {RADIUS * 1e6:g} µm, given"),
            (
                "Way",
                f"from −{HALF_WAY:g} a to {HALF_WAY:g} a in {STEPS} steps, unloaded at the end, {PASSES} "
                "passes",
            ),
            ("SAM", grid_text(found[TRAVELS[-1]], RADIUS)),
        ]

    def tables(self, found: dict[Travel, Result]) -> Iterator[SmallTable]:
        rows = []
        for travel, result in found.items():
            strain, over = strain_of_cycles(result), travel.over_shear
            numbers = (over, shear_limit(travel.friction), travel.share)
            cells = (number(1e2 * strain[k], 4) for k in (0, 1, 3, -1))
            added = f"{np.diff(strain)[-1] / strain[0]:.1e}"
            load = f"{travel.friction:g}", f"{travel.ratio:g}", *(f"{each:.2f}" for each in numbers)
            rows.append((*load, *cells, added))
        yield SmallTable(
            "Largest plastic strain after each pass",
            (
                *("μ", "p₀/σ_y", "p₀/k", "limit of p₀/k", "share"),
                *(
                    "strain [%], pass 1",
                    "pass 2",
                    "pass 4",
                    f"pass {PASSES}",
                    "added by the last, of the first",
                ),
            ),
            rows,
        )

    def figures(self, found: dict[Travel, Result]) -> Iterator[Plot]:
        strains = {travel: strain_of_cycles(result) for travel, result in found.items()}
        series = {
            f"μ = {travel.friction:g}, p₀ = {travel.share:.2f} of the limit": Curve(
                np.arange(1, PASSES + 1), strain / strain[0]
            )
            for travel, strain in strains.items()
        }
        yield Plot(
            curves(
                {"SAM": series},
                "pass",
                "plastic strain over that of pass 1",
                looks=in_order(series),
                count=True,
            ),
            "passes",
            "Plastic strain over the passes",
            "Largest plastic strain over the passes: it settles below the shakedown limit and grows above "
            "it.",
            "Largest in the body.",
        )


def in_order(series: dict[str, Curve]) -> dict[str, dict]:
    """Looks of the series, in their order."""
    return dict(zip(series, CYCLES, strict=True))


def travelling(travel: Travel) -> Scene:
    """The scene of a load that travels along x."""
    h, (ahead, beside, below) = RADIUS / CELLS, BESIDE
    nx, ny = (2 * round(half * CELLS) + 1 for half in (HALF_WAY + ahead, beside))
    path = Path(start=(-HALF_WAY * RADIUS, 0.0), end=(HALF_WAY * RADIUS, 0.0), steps=STEPS)
    pressure = {"prescribed": "hertz", "p0": travel.ratio * YIELD_STRESS, "radius": RADIUS}
    return Scene(
        title=f"Travelling load, {travel.name}",
        body=Body(
            young=YOUNG, poisson=POISSON, plasticity=Plasticity(law="perfect", yield_stress=YIELD_STRESS)
        ),
        loading=Loading(**pressure, path=path, steps=2, unload=True, cycles=PASSES),
        friction=Friction(coefficient=travel.friction) if travel.friction else None,
        grid=Grid(
            cells=(nx, ny), extent=(nx * h, ny * h), depths=tuple(h * np.arange(round(below * CELLS) + 1))
        ),
        solver=Solver(tolerance=1e-4),
    )


def shear_limit(friction: float) -> float:
    """p0/k at which the largest |s_xz| is the shear yield stress k.

    Residual stress that a travelling load leaves is the same along x, and equilibrium then allows it no s_xz:
    beyond this limit nothing shakes down. Without friction 4.68, the limit of Ponter, Hearle and Johnson, J.
    Mech. Phys. Solids 33 (1985) 339-362, from the Hertz stresses here.
    """
    x, z = np.meshgrid(np.linspace(-1.5, 1.5, 301), np.linspace(0.0, 1.5, 151), indexing="ij")
    return 1.0 / float(
        np.abs(
            sliding_stress(x, 0.0, z, 1.0, contact_radius=1.0, nu=POISSON, friction=friction)[..., 4]
        ).max()
    )


CASES = (
    CyclicSliding(
        "cyclic-sliding",
        "Repeated sliding contact",
        "What do further cycles add, where the traction keeps its sign and where it alternates?",
        (
            (
                "Shakedown",
                "hardening and residual stress keep later cycles elastic",
                "Johnson (1985), section 9.2",
            ),
        ),
        ("full",),
    ),
    TravellingLoad(
        "travelling-load",
        "A load that travels over a perfectly plastic body",
        "Does the strain settle below the shakedown limit, and grow with every pass above it?",
        (
            (
                "Shakedown limit",
                "p₀/k = 1/max|σ_xz/p₀|; 4.68 without friction, k = σ_y/√3",
                "Ponter, Hearle & Johnson, J. Mech. Phys. Solids 33 (1985) 339-362; Johnson (1985), section "
                "9.1",
            ),
        ),
        ("full",),
    ),
)
