# SPDX-License-Identifier: MIT
"""Repeated sliding: traction of one sign and of alternating sign, and a load that travels to and fro over the
shakedown limit.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from sam.scene import UNLOADED, Body, Friction, Grid, Loading, Path, Plasticity, Result, Scene, Solver
from verification.cases.case import (
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
from verification.cases.recipes import Resolution
from verification.cases.sliding.friction import BOX, SCENE, sliding_scene
from verification.checks.conditions import peak_rows
from verification.figures.friction import CYCLES, Curve, curves
from verification.reference.hamilton import sliding_stress
from verification.references import contact_of

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
    """A load that travels, perfect plasticity. over_shear: p0 over the shear yield stress k."""

    over_shear: float
    friction: float

    @property
    def name(self) -> str:
        """Of its runs."""
        return f"{self.over_shear:g}-{self.friction:g}"


SETTLES, GROWS = 4.4, 4.9
"""p0/k, 6 % below and 5 % above the limit without friction."""
FRICTIONS = (0.0, 0.1, 0.2)
TRAVELS = tuple(Travel(over, mu) for mu in FRICTIONS for over in (SETTLES, GROWS))
PASSES, STEPS, HALF_WAY, RADIUS = (10, 12), 20, 2.0, 1e-5
YOUNG, POISSON, YIELD_STRESS = 210e9, 0.3, 1e9
CELLS = 6  # in the contact radius
BESIDE = (2.0, 1.8, 2.0)  # grid beyond the way of the centre along x, to its sides and in depth, in radii
STILL = 1e-9  # growth that counts as none in a ratio: thousandths of what the plastic loop resolves


@dataclass(frozen=True)
class Passes:
    """The results after each number of PASSES."""

    results: tuple[Result, Result]

    @property
    def growth(self) -> float:
        """Plastic strain that a pass adds at last: largest anywhere in y = 0, where the load travels."""
        before, after = (np.asarray(peak_rows(each, "plane", UNLOADED)["peeq"]) for each in self.results)
        return float((after - before).max()) / (PASSES[1] - PASSES[0])


class TravellingLoad(Case):
    """Hertz pressure with and without traction along a way, over and over; strain that still grows after many
    passes.
    """

    def solve(self, context: Context) -> dict[Travel, Passes]:
        found = {}
        for travel in TRAVELS:
            first, last = (
                context.solve(SAM, travelling(travel, passes), f"{travel.name}-{passes}") for passes in PASSES
            )
            found[travel] = Passes((first, last))
        return found

    def measure(self, found: dict[Travel, Passes]) -> dict[str, float]:
        values = {}
        for mu in FRICTIONS:
            settles, grows = (found[Travel(over, mu)].growth for over in (SETTLES, GROWS))
            name = f"{mu:g}".replace(".", "")
            values |= {f"settles-{name}": settles, f"grows-{name}": grows}
            values[f"apart-{name}"] = grows / max(settles, STILL)
        return values

    def setup(self, found: dict[Travel, Passes]) -> list[tuple[str, str]]:
        return [
            (
                "Body",
                f"E = {YOUNG / 1e9:g} GPa, ν = {POISSON:g}, perfectly plastic, σ_y = k √3 = "
                f"{YIELD_STRESS / 1e9:g} GPa",
            ),
            ("Load", f"p = p₀ √(1 − r²/a²), q = μp along +x, a = {RADIUS * 1e6:g} µm, given"),
            (
                "Way",
                f"from −{HALF_WAY:g} a to {HALF_WAY:g} a in {STEPS} steps, unloaded at the end, {PASSES[1]} "
                "passes",
            ),
            ("SAM", grid_text(found[TRAVELS[-1]].results[1], RADIUS)),
        ]

    def tables(self, found: dict[Travel, Passes]) -> Iterator[SmallTable]:
        rows = []
        for travel, passes in found.items():
            strain = strain_of_cycles(passes.results[1])
            cells = (number(1e2 * strain[k], 4) for k in (0, 1, 3, -1))
            bound = f"{upper_bound(travel.friction):.3f}"
            rows.append(
                (f"{travel.friction:g}", f"{travel.over_shear:g}", bound, *cells, f"{passes.growth:.1e}")
            )
        yield SmallTable(
            "Largest plastic strain after each pass, and what the last passes add anywhere in y = 0",
            (
                *("μ", "p₀/k", "upper bound of the limit"),
                *("strain [%], pass 1", "pass 2", "pass 4", f"pass {PASSES[1]}", "added by a pass"),
            ),
            rows,
        )

    def notes(self, found: dict[Travel, Passes]) -> Iterator[str]:
        yield (
            "The largest |σ_xz| over k, which is 1 at p₀/k = 4.13 with μ = 0.1 and at 3.68 with μ = 0.2, is "
            "no bound: residual stress may shift σ_xz(x) at given y and z by a constant, so that half its "
            "range counts."
        )

    def figures(self, found: dict[Travel, Passes]) -> Iterator[Plot]:
        panels: dict[str, dict[str, Curve]] = {f"$p_0/k$ = {over:g}": {} for over in (SETTLES, GROWS)}
        for travel, passes in found.items():
            strain = strain_of_cycles(passes.results[1])
            curve = Curve(np.arange(1, PASSES[1] + 1), strain / strain[0])
            panels[f"$p_0/k$ = {travel.over_shear:g}"][f"μ = {travel.friction:g}"] = curve
        looks = in_order([f"μ = {mu:g}" for mu in FRICTIONS])
        yield Plot(
            curves(panels, "pass", "plastic strain over that of pass 1", looks=looks, count=True),
            "passes",
            "Plastic strain over the passes",
            "Largest plastic strain over the passes: it settles below the shakedown limit and grows above "
            "it.",
            "Largest in the body.",
        )


def in_order(series: Iterable[str]) -> dict[str, dict]:
    """Looks of at most four series, in their order."""
    return dict(zip(series, CYCLES, strict=False))


def travelling(travel: Travel, passes: int) -> Scene:
    """The scene of a load that travels along x."""
    h, (ahead, beside, below) = RADIUS / CELLS, BESIDE
    nx, ny = (2 * round(half * CELLS) + 1 for half in (HALF_WAY + ahead, beside))
    path = Path(start=(-HALF_WAY * RADIUS, 0.0), end=(HALF_WAY * RADIUS, 0.0), steps=STEPS)
    pressure = {
        "prescribed": "hertz",
        "p0": travel.over_shear * YIELD_STRESS / np.sqrt(3.0),
        "radius": RADIUS,
    }
    return Scene(
        title=f"Travelling load, p0/k = {travel.over_shear:g}",
        body=Body(
            young=YOUNG, poisson=POISSON, plasticity=Plasticity(law="perfect", yield_stress=YIELD_STRESS)
        ),
        loading=Loading(**pressure, path=path, steps=2, unload=True, cycles=passes),
        friction=Friction(coefficient=travel.friction) if travel.friction else None,
        grid=Grid(
            cells=(nx, ny), extent=(nx * h, ny * h), depths=tuple(h * np.arange(round(below * CELLS) + 1))
        ),
        solver=Solver(tolerance=1e-4),
    )


def upper_bound(friction: float) -> float:
    """Upper bound of p0/k at which a perfectly plastic body may shake down below a load that travels.

    Residual stress that a travelling load leaves is the same along x, so it shifts s_xz(x) at each depth by a
    constant: half the range of s_xz over x is at most k, and at the surface, where the residual s_xz is zero,
    friction p0 is. Without friction this is the limit of Ponter, Hearle and Johnson, J. Mech. Phys. Solids 33
    (1985) 339, 4.68; from the Hertz stresses here, in the plane y = 0.
    """
    x, z = np.meshgrid(np.linspace(-1.5, 1.5, 301), np.linspace(0.0, 1.5, 151), indexing="ij")
    unit = {"contact_radius": 1.0, "nu": POISSON, "friction": friction}
    shear = sliding_stress(x, 0.0, z, 1.0, **unit)[..., 4]
    half = float((shear[:, 1:].max(axis=0) - shear[:, 1:].min(axis=0)).max()) / 2.0
    return 1.0 / max(half, friction)


CASES = (
    CyclicSliding("cyclic-sliding"),
    TravellingLoad("travelling-load"),
)
