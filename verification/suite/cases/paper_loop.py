# SPDX-License-Identifier: MIT
"""The plastic loop of Bosman & Schipper (2011), Fig. 7, with either stop, against backward Euler."""

from __future__ import annotations

import numpy as np

from sam.scene import Result, Scene
from verification.figures.plastic import curves_on_axis
from verification.figures.style import BLACK, BLUE, ORANGE, VERMILION
from verification.runs.models import SAM
from verification.runs.sampling import peak
from verification.suite.cases.case import Case, Context, Outcome, SmallTable, with_loading
from verification.suite.cases.hertz import contact_of
from verification.suite.cases.plastic import at_ratio
from verification.suite.cases.resolution import Resolution, resolved_at
from verification.suite.gates import Measured

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


def run(context: Context) -> Outcome:
    """Each law, method and number of load steps once; what each answer violates, and by how much it is off."""
    outcome = Outcome(
        setup=[("Cells", f"{AT.sam} in the elastic contact radius"), ("Tolerance", "1e-5, of either stop")]
    )
    for law, name, ratio in SCENES:
        scene = resolved_at(with_loading(at_ratio(context.scene(name), ratio), unload=False), AT)
        runs = solved(context, law, scene)
        outcome.setup.append((law, f"{scene.title}, p₀/σ_y0 = {ratio:g}, {scene.loading.force:.5g} N"))
        outcome.tables.append(table(law, runs))
        outcome.values |= {f"{context.case}.{law.lower()}-{k}": v for k, v in gates(runs, scene).items()}
        outcome.figures.append(draw(context, law, runs, contact_of(scene).contact_radius))
    return outcome


def solved(context: Context, law: str, scene: Scene) -> Runs:
    """(method, steps) -> result. What the loops of the paper leave is to be shown: they need not converge in our sense."""
    runs = {}
    for words, keys in METHODS.items():
        chosen = scene.model_copy(update={"solver": scene.solver.model_copy(update=keys)})
        for steps in STEPS[context.level]:
            label = f"{law.lower()}-{keys['stop'] or 'euler'}-{steps}"
            runs[words, steps] = context.solve(SAM, with_loading(chosen, steps=steps), label, words == EULER)
    return runs


def gates(runs: Runs, scene: Scene) -> dict[str, Measured]:
    """What each stop promises, and that the certificate says what it leaves."""
    few, many = min(steps for _, steps in runs), max(steps for _, steps in runs)
    excess = [runs[STRESS, steps].certificate["yield_excess"] for steps in (few, many)]
    off = {steps: distance(runs[STRESS, steps], runs[EULER, steps]) for steps in (few, many)}
    stated = [result.certificate["yield_excess"] - excess_of(result, scene) for result in runs.values()]
    return {
        "stress-yield": Measured(max(excess)),
        "stress-shrinks": Measured(off[many] / off[few]),
        "stated": Measured(max(0.0, -min(stated))),
    }


def distance(result: Result, reference: Result) -> float:
    """Relative distance of the largest plastic strains."""
    return abs(result.quantities["peeq_max"] / reference.quantities["peeq_max"] - 1.0)


def excess_of(result: Result, scene: Scene) -> float:
    """max (mises - sigma_y)/sigma_y over the plane y = 0, from the returned table."""
    peeq, mises = peak(result.tables["plane"], "peeq", "mises_Pa")
    limit = scene.body.plasticity.curve().stress(peeq)
    return float(np.max(mises / limit - 1.0))


def table(law: str, runs: Runs) -> SmallTable:
    """One row a run; the largest plastic strain also against backward Euler with as many and with the most steps."""
    best = runs[EULER, max(steps for _, steps in runs)]
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
    columns = (
        *("method", "steps", "largest plastic strain", "off, same steps", "off, most steps"),
        *("yield excess", "flow-rule residual", "applications"),
    )
    return SmallTable(f"{law}: what each loop leaves", columns, rows)


def draw(context: Context, law: str, runs: Runs, a: float):
    few, many = min(steps for _, steps in runs), max(steps for _, steps in runs)
    chosen = [(EULER, many), (EULER, few), (STRESS, few), (STRAIN, few)]
    curves = {f"{words}, {steps} step{'s' * (steps > 1)}": runs[words, steps] for words, steps in chosen}
    return context.save(
        curves_on_axis(curves, a, LOOKS),
        f"{law.lower()}-axis",
        f"Plastic strain under the centre, {law}",
        "Curves of the plastic strain over depth: backward Euler with many load steps and with one, and the loop of the "
        "paper with one step and either stop.",
        "The loop of the paper adds up returns at the pressures and stresses of its iteration, which is no load path, and "
        "takes none of them back: it meets the yield condition, at a larger plastic strain. More load steps help.",
    )


CASES = (
    Case(
        "paper-loop",
        "The plastic loop as printed",
        "What does the loop of the paper's Fig. 7 get wrong with either of its stops, and when does it matter?",
        run,
        (
            (
                "Loop of the paper",
                "Δεᵖ ← Δεᵖ + return(σ), until σ or εᵖ no longer changes",
                "Bosman & Schipper, Tribol. Lett. 41 (2011), Fig. 7",
            ),
            (
                "Yield excess",
                "max (σ_vM − σ_y)/σ_y",
                "the stop on stress looks at it, the stop on strain does not; reported for both",
            ),
            (
                "Flow-rule residual",
                "2μ |Δεᵖ − return(σ + 2μ Δεᵖ)|/σ_y0 over the load step",
                "zero for backward Euler only",
            ),
        ),
    ),
)
