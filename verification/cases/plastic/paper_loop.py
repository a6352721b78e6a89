# SPDX-License-Identifier: MIT
"""The plastic loop of Bosman & Schipper (2011), Fig. 7, with either stop, against backward Euler."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from sam.scene import Result, Scene
from verification.cases.case import SAM, Case, Context, Measured, Plot, SmallTable, with_keys, with_loading
from verification.cases.recipes import Resolution, at_ratio, resolved_at
from verification.figures.lines import Curve, curves
from verification.figures.style import BLACK, BLUE, ORANGE, VERMILION
from verification.references import contact_of
from verification.runs.sampling import peak, rows_of

SCENES = {"perfect": ("plastic-perfect", 2.5), "Swift": ("plastic-swift-rigid", 4.0)}
STEPS = {"quick": (1, 10), "full": (1, 2, 5, 10, 20)}
METHODS = {
    "backward Euler": {"method": "backward-euler", "stop": None},
    "paper, stop on stress": {"method": "paper", "stop": "stress"},
    "paper, stop on strain": {"method": "paper", "stop": "strain"},
}
EULER, STRESS, STRAIN = METHODS
LOOKS = (
    {"color": BLACK, "linewidth": 1.6},
    {"color": BLUE, "linewidth": 1.4, "linestyle": "--"},
    {"color": VERMILION, "linewidth": 1.4, "linestyle": "-."},
    {"color": ORANGE, "linewidth": 1.6, "linestyle": ":"},
)
COLUMNS = (
    *("method", "steps", "largest plastic strain", "off, same steps", "off, most steps"),
    *("yield excess", "flow-rule residual", "applications"),
)
Runs = Mapping[tuple[str, str, int], tuple[Scene, Result]]
"""(law, method, load steps) -> scene and result."""


class PaperLoop(Case):
    """Each law, method and number of load steps once; what each answer violates, and by how much it is
    off.
    """

    def solve(self, context: Context) -> Runs:
        """What the loops of the paper leave is to be shown: they need not converge in our sense."""
        runs = {}
        for law, (name, ratio) in SCENES.items():
            loaded = with_loading(at_ratio(context.scene(name), ratio), unload=False)
            for method, keys in METHODS.items():
                scene = with_keys(resolved_at(loaded, Resolution(8, 8)), "solver", **keys)
                for steps in STEPS[context.level]:
                    at, label = (
                        with_loading(scene, steps=steps),
                        f"{law.lower()}-{keys['stop'] or 'euler'}-{steps}",
                    )
                    runs[law, method, steps] = at, context.solve(SAM, at, label, demand=method == EULER)
        return runs

    def measure(self, found: Runs) -> dict[str, Measured]:
        """What each stop promises, and that the certificate says what it leaves."""
        values = {}
        for law in SCENES:
            runs = [each for each in left(found) if each.law == law]
            few, *_, many = (each for each in runs if each.method == STRESS)
            values |= {
                f"{law.lower()}-stress-yield": Measured(max(few.excess, many.excess)),
                f"{law.lower()}-stress-shrinks": Measured(many.same / few.same),
                f"{law.lower()}-stated": Measured(max(0.0, *(each.seen - each.excess for each in runs))),
            }
        return values

    def setup(self, found: Runs) -> Iterator[tuple[str, str]]:
        yield "Cells", "8 in the elastic contact radius"
        yield "Tolerance", "1e-5, of either stop"
        for (law, *_), (scene, _) in found.items():
            ratio = SCENES[law][1]
            yield law, f"{scene.title}, p₀/σ_y0 = {ratio:g}, {scene.loading.force:.5g} N"

    def tables(self, found: Runs) -> Iterator[SmallTable]:
        for law in SCENES:
            rows = [
                (
                    run.method,
                    str(run.steps),
                    *(f"{1e2 * x:.{n}f} %" for x, n in ((run.peeq, 4), (run.same, 2), (run.most, 2))),
                    f"{run.excess:.1e}",
                    f"{run.flow:.1e}",
                    str(run.applications),
                )
                for run in left(found)
                if run.law == law
            ]
            yield SmallTable(f"{law}: what each loop leaves", COLUMNS, rows)

    def figures(self, found: Runs) -> Iterator[Plot]:
        for law in SCENES:
            few, *_, many = sorted({steps for _, _, steps in found})
            chosen = (EULER, many), (EULER, few), (STRESS, few), (STRAIN, few)
            a, drawn = contact_of(found[law, EULER, few][0]).contact_radius, {}
            for (m, n), look in zip(chosen, LOOKS, strict=True):
                z, strain = rows_of(found[law, m, n][1].tables["axis"], "peak", "z_m", "peeq")
                shown = Curve(z[z <= 1.5 * a] / a, 1e2 * strain[z <= 1.5 * a], look=look)
                drawn[f"{m}, {n} step{'s' * (n > 1)}"] = shown
            yield Plot(
                curves({"": drawn}, "$z/a$", "plastic strain [%]", looks={}, size=(6.0, 3.6)),
                f"{law.lower()}-axis",
                f"Plastic strain under the centre, {law}",
                "Curves of the plastic strain over depth: backward Euler with many load steps and with one, "
                "and the loop of the paper with one step and either stop.",
                "The loop of the paper adds up returns at the pressures and stresses of its iteration, which "
                "is no load path, and takes none of them back: it meets the yield condition, at a larger "
                "plastic strain. More load steps help.",
            )


class Left(NamedTuple):
    """What a run leaves. same, most: how far the largest plastic strain is from that of backward Euler with
    as many and with the most steps; excess: max (mises - sigma_y)/sigma_y as the certificate states it, seen:
    over the plane y = 0; flow: residual of the flow rule.
    """

    law: str
    method: str
    steps: int
    peeq: float
    same: float
    most: float
    excess: float
    seen: float
    flow: float
    applications: int


def left(found: Runs) -> Iterator[Left]:
    """Of each run, in their order."""
    strains = {at: result.quantities["peeq_max"] for at, (_, result) in found.items()}
    most = max(steps for *_, steps in found)
    for (law, method, steps), (scene, result) in found.items():
        own, said = strains[law, method, steps], result.certificate
        same, far = (abs(own / strains[law, EULER, n] - 1.0) for n in (steps, most))
        peeq, mises = peak(result.tables["plane"], "peeq", "mises_Pa")
        seen = float(np.max(mises / scene.body.plasticity.curve().stress(peeq) - 1.0))
        cost = result.cost["operator_applications"]
        yield Left(
            law, method, steps, own, same, far, said["yield_excess"], seen, said["flow_residual"], cost
        )


CASES = (PaperLoop("paper-loop"),)
