# SPDX-License-Identifier: MIT
"""A Hertz load with and without traction on a body with Prager's back-stress, on either side of the shakedown
limit: pressed in place, and travelling.

Cells see means of the stress, so that a grid has a limit of its own above that of the body. It follows from
the same theorem, by the smallest ball about the means over each cell: the plastic strain of coarse cells
settles beyond the limit of the body, and rightly so.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from sam.scene import Body, Friction, Grid, Loading, Path, Plasticity, Result, Scene, Solver
from verification.cases.case import FEM_3D, SAM, Case, Context, Measured, Plot, SmallTable, with_keys
from verification.figures.friction import CYCLES, Curve, curves
from verification.reference.shakedown import cell_limit, in_place_limit, travelling_limit

YOUNG, POISSON, YIELD, RADIUS = 210e9, 0.3, 1e9, 1e-5
MODULUS = YOUNG
"""Of the back-stress. The limits are the same for each; a small one only strains more until it settles."""
FRICTIONS = (0.0, 0.1, 0.2)
APART = 0.03
"""Distance of the loads from the limit."""


@dataclass(frozen=True)
class Way:
    """How the load comes back.

    half: of the path along x, in contact radii, None for a load in place; steps: along it; pressing: of
    loading; cells: in the contact radius; cycles: how many; beyond: grid beside the load along x and y, and
    in depth, in contact radii; tolerance: of the solver.
    """

    half: float | None
    steps: int
    pressing: int
    cells: int
    cycles: int
    beyond: tuple[float, float, float]
    tolerance: float

    def limit(self, friction: float) -> float:
        """p0/k of the body, k the shear yield stress."""
        limit = in_place_limit if self.half is None else travelling_limit
        return limit(friction, nu=POISSON)[0]

    def limit_of_cells(self, friction: float) -> float:
        """p0/k of the cells where the body has its own."""
        half, steps = (0.0, 0) if self.half is None else (self.half, self.steps)
        return cell_limit(friction, 1 / self.cells, np.linspace(-half, half, steps + 1), nu=POISSON)

    def scene(self, friction: float, share: float) -> Scene:
        """At a share of the limit."""
        h, half = RADIUS / self.cells, self.half or 0.0
        along, beside, below = self.beyond
        nx, ny = (2 * round(reach * self.cells) + 1 for reach in (half + along, beside))
        path = Path(start=(-half * RADIUS, 0.0), end=(half * RADIUS, 0.0), steps=self.steps) if half else None
        law = Plasticity(law="perfect", yield_stress=YIELD, kinematic={"modulus": (MODULUS,)})
        return Scene(
            title=f"Shakedown limit, friction {friction:g}, {share:g} of it",
            body=Body(young=YOUNG, poisson=POISSON, plasticity=law),
            loading=Loading(
                prescribed="hertz",
                p0=share * self.limit(friction) * YIELD / np.sqrt(3.0),
                radius=RADIUS,
                path=path,
                steps=self.pressing,
                unload=True,
                unload_steps=self.pressing,
                cycles=self.cycles,
            ),
            friction=Friction(coefficient=friction) if friction else None,
            grid=Grid(
                cells=(nx, ny),
                extent=(nx * h, ny * h),
                depths=tuple(h * np.arange(round(below * self.cells) + 1)),
            ),
            solver=Solver(tolerance=self.tolerance),
        )


IN_PLACE = Way(None, 0, 4, 9, 5, (1.6, 1.6, 2.0), 1e-5)
TRAVELLING = Way(1.2, 16, 1, 10, 24, (1.5, 1.5, 1.7), 1e-4)
COARSE = Way(1.2, 16, 1, 6, 24, (1.5, 1.5, 1.7), 1e-4)
IN_SPACE = Way(1.2, 12, 1, 4, 6, (1.5, 1.5, 1.7), 1e-4)
SHARES = {"below": 0.8, "above": 1.15}
"""Of the limit, on either side of those of elements and cells of a/4: at 0.9 the elements still flow, on a/6
less in each pass; at 1.1 all passes are alike in both models, in SAM from the sixth.
"""


@dataclass(frozen=True)
class Sides:
    """The same load below and above the limit."""

    below: Result
    above: Result


@dataclass(frozen=True)
class Found:
    """By the coefficient of friction: sides, and the limits of p0/k of the body and of the cells; coarse:
    above the limit without friction on COARSE cells, not in place.
    """

    sides: Mapping[float, Sides]
    limits: Mapping[float, tuple[float, float]]
    coarse: Result | None = None


def steps_of(result: Result) -> np.ndarray:
    """Largest strain that each cycle adds."""
    return np.array(result.tables["cycles"]["peeq_step_max"], dtype=float)


@dataclass(frozen=True, kw_only=True)
class ShakedownLimits(Case):
    """Loads on both sides of the limits, pressed in place or travelling."""

    way: Way

    def solve(self, context: Context) -> Found:
        def at(way: Way, mu: float, share: float, label: str) -> Result:
            return context.solve(SAM, way.scene(mu, share), f"{label}-{spelt(mu)}")

        sides = {
            mu: Sides(at(self.way, mu, 1 - APART, "below"), at(self.way, mu, 1 + APART, "above"))
            for mu in FRICTIONS
        }
        limits = {mu: (self.way.limit(mu), self.way.limit_of_cells(mu)) for mu in FRICTIONS}
        return Found(sides, limits, None if self.way.half is None else at(COARSE, 0.0, 1 + APART, "coarse"))

    def measure(self, found: Found) -> dict[str, Measured | float]:
        values: dict[str, Measured | float] = {}
        for mu, sides in found.sides.items():
            below, above = steps_of(sides.below), steps_of(sides.above)
            name = spelt(mu)
            values |= {
                f"settles-{name}": float(below[-2:].max() / below[0]),
                f"steady-{name}": Measured(float(above[-1] / above[-2]) if above[-2] else 0.0, 1.0),
                f"class-{name}": Measured(float(sides.above.verdict["class"] == "alternating"), 1.0),
            }
            if found.coarse is not None:
                body, cells = found.limits[mu]
                values[f"cells-{name}"] = cells / body - 1
        return values

    def setup(self, found: Found) -> list[tuple[str, str]]:
        way = self.way
        path = [] if way.half is None else [("Path", f"±{way.half:g} a in {way.steps} steps")]
        return [
            ("Body", f"E = {YOUNG / 1e9:g} GPa, ν = {POISSON:g}, σ_y = k√3 = {YIELD / 1e9:g} GPa"),
            ("Back-stress", f"C = {MODULUS / 1e9:g} GPa, g = 0; no other hardening"),
            ("Load", f"p = p₀ √(1 − r²/a²), q = μp, given; {1e2 * APART:g} % below and above the limit"),
            *path,
            ("Cycles", str(way.cycles)),
            ("Cells", f"a/{way.cells}"),
        ]

    def tables(self, found: Found) -> Iterator[SmallTable]:
        rows = []
        for mu, sides in found.sides.items():
            for share, run in ((1 - APART, sides.below), (1 + APART, sides.above)):
                rows.append(self._row(self.way, (mu, share, *found.limits[mu]), run))
        if found.coarse is not None:
            rows.append(
                self._row(
                    COARSE, (0.0, 1 + APART, COARSE.limit(0.0), COARSE.limit_of_cells(0.0)), found.coarse
                )
            )
        columns = "μ", "cells", "limit of p₀/k", "of the cells", "p₀/k", *self._cycles, "verdict"
        yield SmallTable("Strain that a cycle adds in %", columns, rows)

    @property
    def _cycles(self) -> list[str]:
        return [f"cycle {k}" for k in self._shown]

    @property
    def _shown(self) -> tuple[int, ...]:
        return 1, 2, self.way.cycles // 2, self.way.cycles

    def _row(self, way: Way, at: tuple[float, float, float, float], run: Result) -> tuple[str, ...]:
        """at: coefficient of friction, share of the limit, limits of the body and of the cells."""
        (mu, share, limit, of_cells), strain = at, steps_of(run)
        loads = (f"{each:.3f}" for each in (limit, of_cells, share * limit))
        cells = (f"{1e2 * strain[k - 1]:.2e}" for k in self._shown)
        return f"{mu:g}", f"a/{way.cells}", *loads, *cells, run.verdict["class"]

    def figures(self, found: Found) -> Iterator[Plot]:
        fades = self.way.half is not None
        panels: dict[str, dict[str, Curve]] = {"below": {}, "above": {}}
        for mu, sides in found.sides.items():
            panels["below"][f"μ = {mu:g}"] = over_first(sides.below, fades)
            panels["above"][f"μ = {mu:g}"] = over_first(sides.above, fades)
        if found.coarse is not None:
            panels["above"][f"μ = 0, cells of a/{COARSE.cells}"] = over_first(found.coarse, fades)
        titles = {"below": f"{1e2 * APART:g} % below", "above": f"{1e2 * APART:g} % above"}
        names = list(dict.fromkeys(name for panel in panels.values() for name in panel))
        yield Plot(
            curves(
                {f"{titles[side]} the limit": panel for side, panel in panels.items()},
                "cycle",
                "strain of a cycle over that of the first",
                looks=dict(zip(names, CYCLES, strict=False)),
                count=True,
                logarithmic=fades,
            ),
            "strain",
            "Strain that each cycle adds",
            "Strain of each cycle over the cycle: below the limit it falls to nothing, above it stays.",
            "Cycles that add nothing are not drawn." if fades else "Pressed in place.",
        )


class ShakedownInSpace(Case):
    """A load that travels with friction, in three-dimensional finite elements and SAM: the same classes."""

    friction = 0.2

    def solve(self, context: Context) -> Mapping[str, Sides]:
        scenes = {
            side: with_keys(
                IN_SPACE.scene(self.friction, share), "fem", cells_per_radius=IN_SPACE.cells, box=4.0
            )
            for side, share in SHARES.items()
        }
        return {
            name: Sides(
                **{side: context.solve(model, scene, f"{name}-{side}") for side, scene in scenes.items()}
            )
            for name, model in (("sam", SAM), ("fem", FEM_3D))
        }

    def measure(self, found: Mapping[str, Sides]) -> dict[str, Measured | float]:
        values: dict[str, Measured | float] = {}
        for name, sides in found.items():
            below, above = steps_of(sides.below), steps_of(sides.above)
            values |= {
                f"{name}-settles": float(below[-2:].max() / below[0]),
                f"{name}-steady": Measured(float(above[-1] / above[-2]) if above[-2] else 0.0, 1.0),
                f"{name}-below": Measured(float(sides.below.verdict["class"] == "shakedown"), 1.0),
                f"{name}-above": Measured(float(sides.above.verdict["class"] == "alternating"), 1.0),
            }
        return values

    def tables(self, found: Mapping[str, Sides]) -> Iterator[SmallTable]:
        rows = [
            (
                name,
                f"{SHARES[side]:g}",
                *(f"{1e2 * each:.2e}" for each in steps_of(run)),
                run.verdict["class"],
            )
            for name, sides in zip(("SAM", "FEM"), found.values(), strict=True)
            for side, run in (("below", sides.below), ("above", sides.above))
        ]
        passes = (f"pass {k}" for k in range(1, IN_SPACE.cycles + 1))
        columns = "model", "load over the limit", *passes, "verdict"
        yield SmallTable(
            f"Strain that a pass adds in %, μ = {self.friction:g}, a/{IN_SPACE.cells}", columns, rows
        )


def over_first(run: Result, fades: bool) -> Curve:
    """Strain of each cycle over that of the first; fades: only of the cycles that add any."""
    strain = steps_of(run) / steps_of(run)[0]
    shown = (strain > 0) | (not fades)
    return Curve(np.arange(1, strain.size + 1)[shown], strain[shown])


def spelt(mu: float) -> str:
    """A coefficient of friction in the id of a gate."""
    return f"{mu:g}".replace(".", "")


BALL = (
    "Melan's limit",
    "p₀/k = √2/R, R the radius of the smallest ball about the deviators s(t)/p₀ and 0 at the worst depth",
    "Melan, Ing.-Arch. 9 (1938) 116-126; Ponter, Hearle & Johnson, J. Mech. Phys. Solids 33 (1985) 339-362",
)

CASES = (
    ShakedownLimits("shakedown-limits", way=IN_PLACE),
    ShakedownLimits("shakedown-limits-travelling", way=TRAVELLING),
    ShakedownInSpace("shakedown-limits-space"),
)
