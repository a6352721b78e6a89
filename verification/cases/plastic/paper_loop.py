# SPDX-License-Identifier: MIT
"""The plastic loop of Bosman & Schipper (2011), Fig. 7, with either stop, against backward Euler."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from verification.cases.case import SAM, Context, DataFrame, with_keys, with_loading
from verification.cases.recipes import Resolution, at_ratio, resolved_at
from verification.references import contact_of
from verification.runs.sampling import peak

__all__ = ["largest_excess", "shrinks"]

SCENES = {"perfect": ("plastic-perfect", 2.5), "swift": ("plastic-swift-rigid", 4.0)}
STEPS = {"quick": (1, 10), "full": (1, 2, 5, 10, 20)}
EULER, STRESS = "backward Euler", "paper, stop on stress"
METHODS = {
    EULER: {"method": "backward-euler", "stop": None},
    STRESS: {"method": "paper", "stop": "stress"},
    "paper, stop on strain": {"method": "paper", "stop": "strain"},
}


def frame(context: Context) -> Iterator[dict[str, Any]]:
    """Each law, method and number of load steps once; the loops of the paper need not converge in our sense.
    off: how far the largest plastic strain is from that of backward Euler with as many steps; excess: max
    (mises - sigma_y)/sigma_y as the certificate states it; stated: what the plane y = 0 has beyond it;
    plastic-strain: on the axis, in the fewest load steps.
    """
    for law, (name, ratio) in SCENES.items():
        loaded, euler = with_loading(at_ratio(context.scene(name), ratio), unload=False), {}
        for method, keys in METHODS.items():
            scene = with_keys(resolved_at(loaded, Resolution(8, 8)), "solver", **keys)
            for steps in STEPS[context.level]:
                at, label = with_loading(scene, steps=steps), f"{law}-{keys['stop'] or 'euler'}-{steps}"
                result = context.solve(SAM, at, label, demand=method == EULER)
                strain, said = result.quantities["peeq_max"], result.certificate
                off = abs(strain / euler.setdefault(steps, strain) - 1.0)
                peeq, mises = peak(result.tables["plane"], "peeq", "mises_Pa")
                z, below = peak(result.tables["axis"], "z_m", "peeq")
                near = z <= 1.5 * contact_of(scene).contact_radius
                seen = float(np.max(mises / scene.body.plasticity.curve().stress(peeq) - 1.0))
                yield {
                    "sweep": f"{law}: what each loop leaves",
                    "law": law,
                    "method": method,
                    "steps": steps,
                    "largest plastic strain": f"{1e2 * strain:.4f} %",
                    "off, same steps": f"{1e2 * off:.2f} %",
                    "off": off,
                    "excess": said["yield_excess"],
                    "flow-rule residual": said["flow_residual"],
                    "stated": max(0.0, seen - said["yield_excess"]),
                    "applications": result.cost["operator_applications"],
                    "depth": z[near],
                    "plastic-strain": below[near] if steps == STEPS[context.level][0] else None,
                }


def _of_fewest_and_most(rows: DataFrame, column: str) -> list[float]:
    return list(rows[rows["method"] == STRESS].sort_values("steps")[column].iloc[[0, -1]])


def largest_excess(rows: DataFrame, column: str) -> float:
    """Of the stop on stress, fewest and most load steps."""
    return max(_of_fewest_and_most(rows, column))


def shrinks(rows: DataFrame, column: str) -> float:
    """Of the stop on stress, that of most load steps over that of fewest."""
    few, many = _of_fewest_and_most(rows, column)
    return many / few
