# SPDX-License-Identifier: MIT
"""Five materials that run in with back-stresses, as a test of whether wear goes on linearly.

They have one curve of first loading, hardened isotropically, kinematically and by halves. The shares are
assumed, not measured: no cyclic curve of the steel is known.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from verification.cases.case import SAM, Case, Context, Measured, Plot, SmallTable, number, with_keys
from verification.cases.running_in.study import (
    CUBIC,
    MODULI,
    NAMES,
    RECOVERY,
    SHARES,
    Effort,
    Run,
    hardened,
    printed_scenes,
    swift,
)
from verification.figures.friction import CYCLES, Curve, curves

EFFORT = Effort(cycles=10, steps=4, cells=48)
FITTED, HALF = (1e-6, 0.03), EFFORT.cycles // 2


def back_stress(peeq: np.ndarray) -> np.ndarray:
    """Of all back-stresses on first loading, in Pa."""
    return np.sum([-c / g * np.expm1(-g * peeq) for c, g in zip(MODULI, RECOVERY, strict=True)], axis=0)


def late(run: Run) -> float:
    """Wear of the second half of the cycles over that of the first: 1 where wear is linear."""
    wear = run.of_cycles("wear_of_cycle_m3")
    return float(wear[HALF:].sum() / wear[:HALF].sum()) if wear[:HALF].any() else 0.0


def first_loading(run: Run) -> float:
    """Largest plastic strain at the first peak."""
    return float(run.result.tables["history"]["peeq_max"][EFFORT.steps - 1])


@dataclass(frozen=True)
class Found:
    """fit: largest relative error of the back-stresses; runs: material -> way to harden -> run."""

    fit: float
    runs: Mapping[str, Mapping[str, Run]]

    @property
    def every(self) -> list[tuple[str, str, Run]]:
        """Material, way to harden, and what ran."""
        return [(name, way, run) for name, ways in self.runs.items() for way, run in ways.items()]

    @property
    def beyond(self) -> list[str]:
        """Materials whose first loading is beyond the fit."""
        return [name for name, ways in self.runs.items() if first_loading(ways["isotropic"]) > FITTED[1]]


class RunningInKinematic(Case):
    """Five materials, three ways to harden."""

    def solve(self, context: Context) -> Found:
        runs: dict[str, dict[str, Run]] = {}
        peeq, fit = np.geomspace(*FITTED, 200), 0.0
        for case, base in printed_scenes(context, EFFORT).items():
            law, own = base.body.plasticity, runs.setdefault(NAMES[case], {})
            start = float(swift(law, np.zeros(1))[0])
            fit = float(np.abs((start + back_stress(peeq)) / swift(law, peeq) - 1).max())
            for way, share in SHARES.items():
                scene = with_keys(hardened(base, share), "solver", verdict=True)
                own[way] = Run(scene, context.solve(SAM, scene, f"{case}-{share:g}".replace(".", "")))
        return Found(fit, runs)

    def measure(self, found: Found) -> dict[str, Measured | float]:
        return {
            "fit": found.fit,
            "first-loading": max(
                abs(first_loading(run) / first_loading(found.runs[name]["isotropic"]) - 1)
                for name, _, run in found.every
                if name not in found.beyond
            ),
            "converged": Measured(
                float(sum(run.result.converged for *_, run in found.every)), float(len(found.every))
            ),
        }

    def setup(self, found: Found) -> Iterator[tuple[str, str]]:
        yield "Materials", "; ".join(found.runs)
        yield "Hardening", "assumed: one curve of first loading, isotropic, by back-stresses, and by halves"
        yield "Back-stresses", f"C = {', '.join(f'{c / 1e9:g}' for c in MODULI)} GPa"
        yield "Their recovery", ", ".join(f"{g:g}" for g in RECOVERY)
        yield "Patch", f"{EFFORT.cells} × {EFFORT.cells} cells of 1 µm, one surface, printed inputs"
        yield "Cycles", f"{EFFORT.cycles} of {EFFORT.steps} steps up and down"

    def tables(self, found: Found) -> Iterator[SmallTable]:
        rows = []
        for name, way, run in found.every:
            wear, friction, flow = map(
                run.of_cycles, ("wear_of_cycle_m3", "friction_coefficient", "flowing_volume_m3")
            )
            worn = [number(CUBIC * each, 3) for each in (wear.sum(), *wear[[0, HALF - 1, -1]])]
            rows.append(
                (
                    *(name, way, *worn, f"{late(run):.2g}", *(f"{mu:.3f}" for mu in friction[[0, -1]])),
                    *(number(CUBIC * each, 3) for each in flow[[1, -1]]),
                )
            )
        columns = "material|hardening|wear [µm³]|cycle 1|cycle 5|last cycle|late over early"
        columns += "|friction, cycle 1|last|flowing volume [µm³], cycle 2|last"
        yield SmallTable("Wear in all and in cycles, friction and flowing volume", columns.split("|"), rows)

    def notes(self, found: Found) -> Iterator[str]:
        values = [late(run) for *_, run in found.every]
        linear = sum(0.9 <= value <= 1.1 for value in values)
        yield (
            f"Wear is linear, within 10 % between both halves of the {EFFORT.cycles} cycles, in {linear} of "
            f"{len(values)} runs; the second half wears {min(values):.2g} to {max(values):.2g} "
            "times the first."
        )
        if found.beyond:
            yield (
                f"The first loading strains the surface of {' and of '.join(found.beyond)} beyond "
                f"{FITTED[1]:g}, where the curves of the three ways part: back-stresses are saturated there."
            )

    def figures(self, found: Found) -> Iterator[Plot]:
        cycles, panels = np.arange(EFFORT.cycles + 1), {}
        for name, ways in found.runs.items():
            worn = {
                way: np.append(0.0, run.of_cycles("wear_of_cycle_m3").cumsum()) for way, run in ways.items()
            }
            if all(total[-1] > 0 for total in worn.values()):
                panels[name] = {way: Curve(cycles, total / total[-1]) for way, total in worn.items()}
        looks = dict(zip(SHARES, CYCLES, strict=False))
        yield Plot(
            curves(panels, "cycle", "wear over that of all cycles", looks=looks, count=True),
            "wear",
            "Wear up to each cycle",
            "Wear up to each cycle over that of all cycles, for the materials that wear and three ways to "
            "harden: it slows down in each of them.",
            "Linear wear would be a straight line. Materials that do not wear are left out.",
        )


CASES = (RunningInKinematic("running-in-kinematic"),)
