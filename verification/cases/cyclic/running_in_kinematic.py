# SPDX-License-Identifier: MIT
"""Five materials that run in with back-stresses, as a test of whether wear goes on linearly.

They have one curve of first loading, hardened isotropically, kinematically and by halves. The shares are
assumed, not measured: no cyclic curve of the steel is known. Swift's law less its start is fitted by five
Armstrong-Frederick back-stresses, see `MODULI`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from sam.scene import Plasticity, Result, Scene
from verification.cases.case import SAM, Case, Context, Measured, Plot, SmallTable, number
from verification.cases.running_in.running_in_scenes import Effort, reduced
from verification.cases.running_in.running_in_statements import NAMES
from verification.figures.friction import CYCLES, Curve, curves

MODULI = (35648.8e9, 13721.5e9, 1895.4e9, 227.18e9, 37.371e9)
RECOVERY = (3e5, 3e4, 3e3, 300.0, 30.0)
"""Fit of Swift's law with B = 1780 MPa, C = 4, n = 0.095 less its start, within 0.5 % from 1e-6 to 0.03."""
SHARES = {"isotropic": 0.0, "half and half": 0.5, "kinematic": 1.0}
EFFORT = Effort((), (), cycles=10, steps=4, cells=48)
FITTED = 1e-6, 0.03
LARGEST, POINTS = 0.2, 60  # of the plastic strain in the table of a yield stress, and its rows
HALF = EFFORT.cycles // 2


def swift(law: Plasticity, peeq: np.ndarray) -> np.ndarray:
    """Yield stress of the isotropic law in Pa."""
    return law.B * (law.C + law.alpha * peeq) ** law.n


def back_stress(peeq: np.ndarray) -> np.ndarray:
    """Of all back-stresses on first loading, in Pa."""
    parts = [-c / g * np.expm1(-g * peeq) for c, g in zip(MODULI, RECOVERY, strict=True)]
    return np.sum(parts, axis=0)


def hardened(law: Plasticity, share: float) -> Plasticity:
    """The law with so much of its hardening by back-stresses, and the rest as a table that ends flat."""
    peeq = np.append(0.0, np.geomspace(1e-7, LARGEST, POINTS))
    first = float(swift(law, np.zeros(1))[0])
    stress = first + (1 - share) * (swift(law, peeq) - first)
    place = law.model_dump(include={"profile", "layer_thickness"}, exclude_none=True)
    isotropic = (
        {"law": "perfect", "yield_stress": first}
        if share == 1
        else {"law": "table", "file": tuple(zip(peeq.tolist(), stress.tolist(), strict=True))}
    )
    moduli = tuple(share * modulus for modulus in MODULI)
    kinematic = {"kinematic": {"modulus": moduli, "recovery": RECOVERY}} if share else {}
    return Plasticity(**isotropic, **kinematic, **place)


def varied(base: Scene, share: float) -> Scene:
    """A running-in scene with a share of kinematic hardening, judged."""
    scene = reduced(base, EFFORT)
    body = scene.body.model_copy(update={"plasticity": hardened(base.body.plasticity, share)})
    solver = scene.solver.model_copy(update={"verdict": True})
    return scene.model_copy(update={"body": body, "solver": solver})


@dataclass(frozen=True)
class Run:
    """A result by cycle."""

    result: Result

    def of(self, column: str) -> np.ndarray:
        """A column of the table cycles."""
        return np.array(self.result.tables["cycles"][column], dtype=float)

    @property
    def late(self) -> float:
        """Wear of the second half of the cycles over that of the first: 1 where wear is linear."""
        wear = self.of("wear_of_cycle_m3")
        return float(wear[HALF:].sum() / wear[:HALF].sum()) if wear[:HALF].any() else 0.0

    @property
    def first_loading(self) -> float:
        """Largest plastic strain at the first peak."""
        history = self.result.tables["history"]
        return float(history["peeq_max"][EFFORT.steps - 1])


@dataclass(frozen=True)
class Found:
    """fit: largest relative error of the back-stresses; runs: material -> share -> run."""

    fit: float
    runs: Mapping[str, Mapping[str, Run]]


class RunningInKinematic(Case):
    """Five materials, three ways to harden."""

    def solve(self, context: Context) -> Found:
        runs: dict[str, dict[str, Run]] = {}
        peeq, fit = np.geomspace(*FITTED, 200), 0.0
        for case, name in NAMES.items():
            base = context.scene(f"running-in-{case}")
            law = base.body.plasticity
            start = float(swift(law, np.zeros(1))[0])
            fit = float(np.abs((start + back_stress(peeq)) / swift(law, peeq) - 1).max())
            runs[name] = {
                way: Run(context.solve(SAM, varied(base, share), f"{case}-{share:g}".replace(".", "")))
                for way, share in SHARES.items()
            }
        return Found(fit, runs)

    def measure(self, found: Found) -> dict[str, Measured | float]:
        first = [
            abs(run.first_loading / ways["isotropic"].first_loading - 1)
            for ways in found.runs.values()
            for run in ways.values()
            if ways["isotropic"].first_loading <= FITTED[1]
        ]
        every = [run for ways in found.runs.values() for run in ways.values()]
        return {
            "fit": found.fit,
            "first-loading": max(first),
            "converged": Measured(float(sum(run.result.converged for run in every)), float(len(every))),
        }

    def setup(self, found: Found) -> list[tuple[str, str]]:
        return [
            ("Materials", "; ".join(found.runs)),
            ("Hardening", "assumed: one curve of first loading, isotropic, by back-stresses, and by halves"),
            ("Back-stresses", f"C = {', '.join(f'{c / 1e9:g}' for c in MODULI)} GPa"),
            ("Their recovery", ", ".join(f"{g:g}" for g in RECOVERY)),
            ("Patch", f"{EFFORT.cells} × {EFFORT.cells} cells of 1 µm, one surface, printed inputs"),
            ("Cycles", f"{EFFORT.cycles} of {EFFORT.steps} steps up and down"),
        ]

    def tables(self, found: Found) -> Iterator[SmallTable]:
        rows = [(name, way, *_numbers(run)) for name, ways in found.runs.items() for way, run in ways.items()]
        columns = (
            *("material", "hardening", "wear [µm³]", "cycle 1", "cycle 5", "last cycle", "late over early"),
            *("friction, cycle 1", "last", "flowing volume [µm³], cycle 2", "last"),
        )
        yield SmallTable("Wear in all and in cycles, friction and flowing volume", columns, rows)

    def notes(self, found: Found) -> Iterator[str]:
        late = {name: {way: run.late for way, run in ways.items()} for name, ways in found.runs.items()}
        values = [value for ways in late.values() for value in ways.values()]
        linear = sum(0.9 <= value <= 1.1 for value in values)
        yield (
            f"Wear is linear, within 10 % between both halves of the {EFFORT.cycles} cycles, in {linear} of "
            f"{len(values)} runs; the second half wears {min(values):.2g} to {max(values):.2g} "
            "times the first."
        )
        beyond = [name for name, ways in found.runs.items() if ways["isotropic"].first_loading > FITTED[1]]
        if beyond:
            yield (
                f"The first loading strains the surface of {' and of '.join(beyond)} beyond {FITTED[1]:g}, "
                "where the curves of the three ways part: back-stresses are saturated there."
            )

    def figures(self, found: Found) -> Iterator[Plot]:
        cycles = np.arange(EFFORT.cycles + 1)
        wear = {
            name: {way: np.append(0.0, np.cumsum(run.of("wear_of_cycle_m3"))) for way, run in ways.items()}
            for name, ways in found.runs.items()
        }
        panels = {
            name: {way: Curve(cycles, total / total[-1]) for way, total in ways.items()}
            for name, ways in wear.items()
            if all(total[-1] > 0 for total in ways.values())
        }
        looks = dict(zip(SHARES, CYCLES, strict=False))
        yield Plot(
            curves(panels, "cycle", "wear over that of all cycles", looks=looks, count=True),
            "wear",
            "Wear up to each cycle",
            "Wear up to each cycle over that of all cycles, for the materials that wear and three ways to "
            "harden: it slows down in each of them.",
            "Linear wear would be a straight line. Materials that do not wear are left out.",
        )


def _numbers(run: Run) -> Iterator[str]:
    wear, friction, flow = (
        run.of(name) for name in ("wear_of_cycle_m3", "friction_coefficient", "flowing_volume_m3")
    )
    yield number(1e18 * wear.sum(), 3)
    yield from (number(1e18 * wear[k], 3) for k in (0, HALF - 1, -1))
    yield f"{run.late:.2g}"
    yield from (f"{friction[k]:.3f}" for k in (0, -1))
    yield from (number(1e18 * flow[k], 3) for k in (1, -1))


CASES = (RunningInKinematic("running-in-kinematic"),)
