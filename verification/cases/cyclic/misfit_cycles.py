# SPDX-License-Identifier: MIT
"""A sphere that grows and shrinks inside a body with a back-stress, a little above the limit below which it
settles: strain of a period and verdict of both models against the exact solution, which alternates.

With Armstrong and Frederick's law the strain that a period leaves falls to nothing by a few per cent a period
or less: nothing ratchets, and it takes many periods to see that.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from sam.scene import Body, Loading, Plasticity, Result, Scene
from verification.cases.case import (
    FEM,
    SAM,
    Case,
    Context,
    Measured,
    Plot,
    SmallTable,
    with_keys,
    with_mesh,
)
from verification.cases.plastic.misfit_sphere import closed_form, on_grid
from verification.figures.friction import CYCLES, Curve, curves
from verification.reference.misfit_sphere import PROFILES

YOUNG, POISSON, YIELD, RADIUS, DEPTH = 210e9, 0.3, 1e9, 1e-5, 3.2
REACHES = np.linspace(0.3, 3.0, 2701)  # radii at which the exact solution is looked at
LIMIT = 2 * YIELD * (1 - POISSON) / (YOUNG * float(PROFILES["gauss"](REACHES)[1].max()))
"""Misfit at the centre below which the elastic range holds a period everywhere, in the end."""
TOLERANCE = (
    1e-7  # sets the noise of the verdict: at 1e-6 the periods until it is decided are three times as many
)
MODELS = {"sam": SAM, "fem": FEM}
TOLD = 30  # the period after which the number of further periods is read
RIGHT = 1.5  # times the number that was told, at most


@dataclass(frozen=True)
class Run:
    """share: of the misfit above the limit; modulus in Pa, recovery: of the back-stress; size: cells and
    elements in the radius.
    """

    share: float
    modulus: float
    recovery: float
    size: int
    cycles: int

    @property
    def scene(self) -> Scene:
        """Held, so that it is exact."""
        back = {"modulus": (self.modulus,), "recovery": (self.recovery,)}
        scene = Scene(
            title=f"Misfit sphere in cycles, {self.share:g} above the limit, recovery {self.recovery:g}",
            body=Body(
                young=YOUNG,
                poisson=POISSON,
                plasticity=Plasticity(law="perfect", yield_stress=YIELD, kinematic=back),
            ),
            loading=Loading(
                prescribed="misfit-sphere",
                depth=DEPTH * RADIUS,
                radius=RADIUS,
                misfit=LIMIT * (1 + self.share),
                profile="gauss",
                surface="held",
                steps=1,
                unload=True,
                cycles=self.cycles,
            ),
        )
        return with_keys(with_mesh(on_grid(scene, self.size), self.size), "solver", tolerance=TOLERANCE)

    def exact(self) -> np.ndarray:
        """Largest dp and de of each period, (2, cycles)."""
        sphere = closed_form(self.scene, (1.0, 0.0) * self.cycles)
        ends = list(sphere.history(REACHES * RADIUS))[1::2]
        both = np.array([(0 * REACHES, 0 * REACHES), *((each.peeq, 2 * each.plastic) for each in ends)])
        return np.abs(np.diff(both, axis=0)).max(axis=2).T


@dataclass(frozen=True)
class Found:
    """A run by both models, and what is exact of it."""

    run: Run
    exact: np.ndarray
    results: Mapping[str, Result]


def column(result: Result, name: str) -> list:
    """Of the table cycles."""
    return list(result.tables["cycles"][name])


def decided(result: Result) -> float:
    """Period since which the verdict is alternating; infinite if it is not."""
    said = column(result, "verdict")
    others = [number for number, each in enumerate(said, start=1) if each != "alternating"]
    return 1.0 + max(others, default=0) if not others or others[-1] < len(said) else float("inf")


@dataclass(frozen=True, kw_only=True)
class MisfitCycles(Case):
    """strains: by name, whose class and strain are held; near: so near to the limit that the class may be
    undecided at first.
    """

    strains: Mapping[str, Run]
    near: Mapping[str, Run]

    def solve(self, context: Context) -> dict[str, Found]:
        return {
            name: Found(
                run,
                run.exact(),
                {of: context.solve(model, run.scene, f"{of}-{name}") for of, model in MODELS.items()},
            )
            for name, run in (self.strains | self.near).items()
        }

    def measure(self, found: dict[str, Found]) -> dict[str, Measured | float]:
        values: dict[str, Measured | float] = {}
        false = 0
        for name, each in found.items():
            for model, result in each.results.items():
                false += column(result, "verdict").count("ratchetting")
                if name in self.near:
                    told = TOLD + (column(result, "periods_to_decide")[TOLD - 1] or 0)
                    values[f"{model}-{name}-told"] = decided(result) / told
                    continue
                values[f"{model}-{name}-class"] = decided(result)
                for column_name, exact in zip(("peeq_step_max", "strain_step_max"), each.exact, strict=True):
                    if each.run.recovery or column_name != "strain_step_max":  # of Prager's law it is zero
                        gate = f"{model}-{name}-{column_name.removesuffix('_step_max')}"
                        values[gate] = Measured(np.array(column(result, column_name))[1:], exact[1:])
        return values | {"ratchetting": Measured(float(false), 0.0)}

    def setup(self, found: dict[str, Found]) -> list[tuple[str, str]]:
        return [
            ("Body", f"E = {YOUNG / 1e9:g} GPa, ν = {POISSON:g}, σ_y = {YIELD / 1e9:g} GPa, one back-stress"),
            ("Sphere", f"e = e₀ exp(−r²/a²), limit e₀ = {1e2 * LIMIT:.4f} %, held"),
        ]

    def tables(self, found: dict[str, Found]) -> Iterator[SmallTable]:
        rows = [
            (
                f"{1e2 * each.run.share:g} %",
                f"C = {each.run.modulus / 1e9:g} GPa, g = {each.run.recovery:g}",
                f"{model}, a/{each.run.size}",
                *(
                    f"{1e6 * result.verdict[of]:.2f} ({1e6 * exact:.2f})"
                    for of, exact in zip(
                        ("peeq_per_period", "strain_per_period"), each.exact[:, -1], strict=True
                    )
                ),
                f"{decided(result):g} of {each.run.cycles}",
                str((*column(result, "periods_to_decide"), *[""] * TOLD)[TOLD - 1] or ""),
            )
            for each in found.values()
            for model, result in each.results.items()
        ]
        columns = (
            *("above the limit", "back-stress", "model", "dp of the last period in 10⁻⁶ (exact)"),
            *("de likewise", "alternating since period", f"further periods told after period {TOLD}"),
        )
        yield SmallTable("Both models and the exact solution", columns, rows)

    def figures(self, found: dict[str, Found]) -> Iterator[Plot]:
        panels = {}
        for each in (one for one in found.values() if one.run.recovery):
            periods = np.arange(2, each.run.cycles + 1)
            series = {"exact": Curve(periods, 1e6 * each.exact[1, 1:])} | {
                of: Curve(periods, 1e6 * np.array(column(result, "strain_step_max")[1:]))
                for of, result in each.results.items()
            }
            panels[f"{1e2 * each.run.share:g} % above the limit"] = series
        looks = dict(zip(("exact", *MODELS), CYCLES, strict=False))
        yield Plot(
            curves(panels, "period", "strain that a period leaves [$10^{-6}$]", looks=looks, count=True),
            "strain",
            "Strain that a period leaves",
            "The largest strain that a period leaves, over the periods: it falls in both models as the exact "
            "one does.",
            "Armstrong and Frederick's law: to nothing in the end.",
        )


AF, PRAGER = (160e9, 90.0), (160e9, 0.0)
CASES = (
    MisfitCycles(
        "misfit-cycles", strains={"af-20": Run(0.2, *AF, 6, 8), "prager-20": Run(0.2, *PRAGER, 6, 4)}, near={}
    ),
    MisfitCycles(
        "misfit-cycles-near",
        strains={"af-5": Run(0.05, *AF, 8, 30), "prager-5": Run(0.05, *PRAGER, 8, 4)},
        near={"near-2": Run(0.02, *AF, 8, 75), "near-1": Run(0.01, *AF, 6, 240)},
    ),
)
