# SPDX-License-Identifier: MIT
"""Extremes of back-stresses: stiff, vanishing, saturated at once, many; and traction that alternates."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any

from verification.robustness.matrix.checks import as_other_model, hertz, same_as
from verification.robustness.matrix.elastic import both
from verification.robustness.matrix.plastic import P0, compared, yields
from verification.robustness.matrix.row import Deviation, Expectation, Refused, Right, Row, Trial
from verification.robustness.matrix.scenes import HERTZ, YOUNG, scene_with
from verification.robustness.matrix.sliding import NO_FRICTION
from verification.runs.models import FEM, FEM_3D, SAM

YIELD = P0 / 3
STRAINED = ("approach_m", "p_center_Pa", "peeq_max")
KEYS = "body.plasticity.kinematic"


def law(*, share: float = 1.0, **kinematic: Any) -> dict[str, Any]:
    """Perfect plasticity with back-stresses. share: of the yield stress."""
    return {"law": "perfect", "yield_stress": share * YIELD} | ({"kinematic": kinematic} if kinematic else {})


def row(name: str, what: str, plasticity: dict, expected: dict[str, Expectation], **changes: Any) -> Row:
    """The base with a law. changes: other keys, with __ for the dot."""
    quick = changes.pop("quick", False)
    dotted = {"loading.steps": 5} | {key.replace("__", "."): value for key, value in changes.items()}
    made = partial(scene_with, {"body.plasticity": plasticity} | dotted)
    return Row(name, "back-stress", what, made, expected, quick)


def rows() -> Iterator[Row]:
    """All of them."""
    yield from limits()
    yield from refused()
    yield from alternating()


def limits() -> Iterator[Row]:
    """Laws that are another law in the limit."""
    stiff = Right("so stiff that it stays elastic", [hertz(mises=0.015)])
    what = "a back-stress with a modulus of 1e6 E: elastic in the limit"
    yield row("back-stiff", what, law(modulus=(1e6 * YOUNG,)), both(stiff))
    reason = "a back-stress of 1e-9 yield stresses; both within their tolerance"
    none = Right("as without", [same_as({"body.plasticity": law()}, 1e-5, reason, STRAINED), yields])
    yield row("back-vanishing", "a modulus of 1 Pa", law(modulus=(1.0,)), both(none), quick=True)
    reason = "saturated after a strain of 1e-6 at a fifth of the yield stress"
    higher = Right(
        "a higher yield stress", [same_as({"body.plasticity": law(share=1.2)}, 0.01, reason, STRAINED)]
    )
    saturated = law(modulus=(0.2 * YIELD * 1e6,), recovery=(1e6,))
    yield row("back-saturated", "C/g = σy/5, g = 1e6", saturated, both(higher))
    reason = "equal ones add: rounding and tolerance"
    once = law(modulus=(8e9,), recovery=(300.0,))
    sums = Right(
        "one with the sum of the moduli", [same_as({"body.plasticity": once}, 1e-5, reason, STRAINED)]
    )
    yield row(
        "back-eight", "eight equal back-stresses", law(modulus=(1e9,) * 8, recovery=(300.0,) * 8), both(sums)
    )
    three = law(modulus=(400e9, 60e9, 6e9), recovery=(2000.0, 300.0, 0.0))
    what = "three back-stresses, two cycles of 10 steps"
    again = {"loading__steps": 10, "loading__unload": True, "loading__cycles": 2}
    yield row("back-three", what, three, dict(compared()), **again)


def refused() -> Iterator[Row]:
    """Constants that are none, and what has no form with back-stresses."""
    wrong: tuple[tuple[str, dict[str, Any], list[str]], ...] = (
        ("modulus-0", {"modulus": (0.0,)}, [f"{KEYS}.modulus"]),
        ("recovery-1e8", {"modulus": (1e9,), "recovery": (1e8,)}, [f"{KEYS}.recovery"]),
        ("nine", {"modulus": (1e9,) * 9}, [f"{KEYS}.modulus", "8"]),
        ("lengths", {"modulus": (1e9,), "recovery": (1.0, 2.0)}, [f"{KEYS}.recovery"]),
    )
    for name, constants, words in wrong:
        error = Refused("no such law", words)
        yield row(f"back-{name}", f"{name.replace('-', ' ')}", law(**constants), both(error, spatial=error))
    paper = Refused("the loops of the paper have no back-stress", ["solver.method"])
    wanted = both(paper, paper)
    yield row("back-paper", "the loops of the paper", law(modulus=(1e9,)), wanted, solver__method="paper")


def alternating() -> Iterator[Row]:
    """Traction in place whose sign changes from cycle to cycle."""
    h = HERTZ / 8
    given = {
        "body.plasticity": law(share=1e9 / YIELD, modulus=(0.05 * YOUNG,)),
        "friction": {"coefficient": 0.2, "direction": "alternating"},
        "counterbody": None,
        "loading": {"prescribed": "hertz", "radius": HERTZ, "steps": 3, "unload": True, "cycles": 4},
        "fem.cells_per_radius": 4,
        "fem.box": 4.0,
        "grid": {"cells": (33, 33), "extent": (33 * h, 33 * h), "depths": tuple(h * k for k in range(19))},
    }
    near = {"peeq_max": 0.15, "residual_uz_center_m": 0.15}
    reason = "cells of a/8, elements of a/4 in a box of 4 a; both err by some per cent, to opposite sides"
    for name, p0, checks in (
        ("elastic", 1e9, [signs]),
        ("flows", 3.4e9, [signs, yields]),
    ):
        other = {SAM: as_other_model(FEM_3D, near, reason), FEM_3D: as_other_model(SAM, near, reason)}
        right = {
            model: Right("one convex problem a step", [*checks, *([check] if name == "flows" else [])])
            for model, check in other.items()
        }
        made = partial(scene_with, given | {"loading.p0": p0})
        what = f"traction that alternates, p given, p₀ = {p0 / 1e9:g} GPa"
        yield Row(
            f"alternating-{name}", "alternating", what, made, {**right, FEM: NO_FRICTION}, name == "elastic"
        )


def signs(trial: Trial) -> Iterator[Deviation]:
    """The coefficient of friction is never negative; the sign of the traction is a column of its own."""
    cycles, mu = trial.result.tables["cycles"], trial.scene.friction.coefficient
    for k, found in enumerate(cycles["friction_coefficient"], start=1):
        yield Deviation(f"coefficient of cycle {k}", abs(found - mu), 1e-9, "q = mu p: rounding")
    wanted = [1, -1] * (len(cycles["cycle"]) // 2)
    wrong = float(list(cycles.get("friction_sign", [])) != wanted)
    yield Deviation("sign of the traction by cycle", wrong, 0.5, "+x in odd cycles, -x in even ones")
