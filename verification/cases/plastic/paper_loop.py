# SPDX-License-Identifier: MIT
"""The plastic loop of Bosman & Schipper (2011), Fig. 7, with either stop, against backward Euler."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from sam.scene import Result, Scene
from verification.cases.case import (
    SAM,
    Case,
    Context,
    Measured,
    Plot,
    SmallTable,
    with_keys,
    with_loading,
)
from verification.cases.recipes import Resolution, at_ratio, resolved_at
from verification.figures.plastic import curves_on_axis
from verification.figures.style import BLACK, BLUE, ORANGE, VERMILION
from verification.references import contact_of
from verification.runs.sampling import peak

SCENES = (("perfect", "plastic-perfect", 2.5), ("Swift", "plastic-swift-rigid", 4.0))
STEPS = {"quick": (1, 10), "full": (1, 2, 5, 10, 20)}
AT = Resolution(8, 8)
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

Runs = dict[tuple[str, int], Result]


@dataclass(frozen=True)
class Law:
    """A hardening law at one load by every method. runs: (method, steps) -> result; of what the loops of the
    paper leave.
    """

    name: str
    ratio: float
    scene: Scene
    runs: Runs

    @property
    def few(self) -> int:
        """The fewest load steps."""
        return min(steps for _, steps in self.runs)

    @property
    def many(self) -> int:
        """The most load steps."""
        return max(steps for _, steps in self.runs)


class PaperLoop(Case):
    """Each law, method and number of load steps once; what each answer violates, and by how much it is
    off.
    """

    def solve(self, context: Context) -> list[Law]:
        laws = []
        for law, name, ratio in SCENES:
            scene = resolved_at(with_loading(at_ratio(context.scene(name), ratio), unload=False), AT)
            laws.append(Law(law, ratio, scene, solved(context, law, scene)))
        return laws

    def measure(self, found: list[Law]) -> dict[str, Measured]:
        return {f"{law.name.lower()}-{k}": v for law in found for k, v in gates(law).items()}

    def setup(self, found: list[Law]) -> list[tuple[str, str]]:
        return [
            ("Cells", f"{AT.sam} in the elastic contact radius"),
            ("Tolerance", "1e-5, of either stop"),
            *(
                (
                    law.name,
                    f"{law.scene.title}, p₀/σ_y0 = {law.ratio:g}, {law.scene.loading.force:.5g} N",
                )
                for law in found
            ),
        ]

    def tables(self, found: list[Law]) -> list[SmallTable]:
        return [table(law) for law in found]

    def figures(self, found: list[Law]) -> Iterator[Plot]:
        for law in found:
            chosen = [(EULER, law.many), (EULER, law.few), (STRESS, law.few), (STRAIN, law.few)]
            curves = {f"{words}, {n} step{'s' * (n > 1)}": law.runs[words, n] for words, n in chosen}
            yield Plot(
                curves_on_axis(curves, contact_of(law.scene).contact_radius, LOOKS),
                f"{law.name.lower()}-axis",
                f"Plastic strain under the centre, {law.name}",
                "Curves of the plastic strain over depth: backward Euler with many load steps and with one, "
                "and the loop of the paper with one step and either stop.",
                "The loop of the paper adds up returns at the pressures and stresses of its iteration, which "
                "is no load path, and takes none of them back: it meets the yield condition, at a larger "
                "plastic strain. More load steps help.",
            )


def solved(context: Context, law: str, scene: Scene) -> Runs:
    """(method, steps) -> result. What the loops of the paper leave is to be shown: they need not converge in
    our sense.
    """
    runs = {}
    for words, keys in METHODS.items():
        chosen = with_keys(scene, "solver", **keys)
        for steps in STEPS[context.level]:
            label = f"{law.lower()}-{keys['stop'] or 'euler'}-{steps}"
            stepped = with_loading(chosen, steps=steps)
            runs[words, steps] = context.solve(SAM, stepped, label, demand=words == EULER)
    return runs


def gates(law: Law) -> dict[str, Measured]:
    """What each stop promises, and that the certificate says what it leaves."""
    runs, few, many = law.runs, law.few, law.many
    off = {steps: distance(runs[STRESS, steps], runs[EULER, steps]) for steps in (few, many)}
    stated = [each.certificate["yield_excess"] - excess_of(each, law.scene) for each in runs.values()]
    return {
        "stress-yield": Measured(
            max(runs[STRESS, steps].certificate["yield_excess"] for steps in (few, many))
        ),
        "stress-shrinks": Measured(off[many] / off[few]),
        "stated": Measured(max(0.0, -min(stated))),
    }


def distance(result: Result, reference: Result) -> float:
    """Relative distance of the largest plastic strains."""
    return abs(result.quantities["peeq_max"] / reference.quantities["peeq_max"] - 1.0)


def excess_of(result: Result, scene: Scene) -> float:
    """max (mises - sigma_y)/sigma_y over the plane y = 0, from the returned table."""
    peeq, mises = peak(result.tables["plane"], "peeq", "mises_Pa")
    return float(np.max(mises / scene.body.plasticity.curve().stress(peeq) - 1.0))


def table(law: Law) -> SmallTable:
    """One row a run; the largest plastic strain also against backward Euler with as many and with the most
    steps.
    """
    runs, best = law.runs, law.runs[EULER, law.many]
    rows = [
        (
            words,
            f"{steps}",
            f"{1e2 * result.quantities['peeq_max']:.4f} %",
            f"{1e2 * distance(result, runs[EULER, steps]):.2f} %",
            f"{1e2 * distance(result, best):.2f} %",
            f"{result.certificate['yield_excess']:.1e}",
            f"{result.certificate['flow_residual']:.1e}",
            f"{result.cost['operator_applications']}",
        )
        for (words, steps), result in runs.items()
    ]
    return SmallTable(
        f"{law.name}: what each loop leaves",
        (
            *("method", "steps", "largest plastic strain", "off, same steps", "off, most steps"),
            *("yield excess", "flow-rule residual", "applications"),
        ),
        rows,
    )


CASES = (PaperLoop("paper-loop"),)
