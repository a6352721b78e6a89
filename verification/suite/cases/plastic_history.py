# SPDX-License-Identifier: MIT
"""What the load history must not do: yield below the limit of elasticity, and yield again on reloading."""

from __future__ import annotations

import numpy as np

from sam.scene import Result, Scene
from verification.runs.models import FEM, SAM
from verification.runs.sampling import peak
from verification.suite.cases.case import Case, Context, Outcome, SmallTable, with_loading
from verification.suite.cases.plastic import at_ratio, initial_yield
from verification.suite.cases.resolution import Resolution, resolved_at
from verification.suite.gates import Measured

AT = Resolution(10, 16)
ELASTIC, RELOADED = 1.5, 4.0  # p0 over the initial yield stress; first yield is at 1.613
SAME = ("approach_m", "contact_area_m2", "p_max_Pa")
SURFACE = ("p_Pa", "uz_m", "gap_m")


def run_elastic(context: Context) -> Outcome:
    """Solve below first yield with and without [body.plasticity]."""
    scene = context.scene("plastic-swift-rigid")
    scene = resolved_at(at_ratio(scene, ELASTIC), AT)
    bare = scene.model_copy(update={"body": scene.body.model_copy(update={"plasticity": None})})
    outcome, rows = Outcome(setup=_setup(scene, ELASTIC)), []
    for model in (SAM, FEM):
        plastic = context.solve(model, scene, f"{model}-plastic")
        elastic = context.solve(model, bare, f"{model}-elastic")
        peeq, lost = plastic.quantities["peeq_max"], largest_change(plastic, elastic)
        outcome.values[f"{context.case}.{_short(model)}-peeq"] = Measured(peeq, 0.0)
        outcome.values[f"{context.case}.{_short(model)}-change"] = Measured(lost)
        rows.append((model, f"{peeq:g}", f"{lost:.1e}"))
    outcome.tables.append(
        SmallTable("With a yield stress that is not reached", ("model", "plastic strain", "change"), rows)
    )
    return outcome


def largest_change(plastic: Result, elastic: Result) -> float:
    """Largest difference of quantities and surface fields, relative to the largest value of each."""
    pairs = [(plastic.quantities[name], elastic.quantities[name]) for name in SAME]
    pairs += [
        (peak(plastic.tables["line"], name)[0], peak(elastic.tables["line"], name)[0]) for name in SURFACE
    ]
    return max(float(np.max(np.abs(np.subtract(a, b))) / np.max(np.abs(b))) for a, b in pairs)


def run_reload(context: Context) -> Outcome:
    """Load, unload and load again to the same force."""
    scene = context.scene("plastic-swift-rigid")
    scene = with_loading(resolved_at(at_ratio(scene, RELOADED), AT), cycles=2)
    outcome, rows = Outcome(setup=_setup(scene, RELOADED)), []
    for model in (SAM, FEM):
        first, second, approach = cycles(context.solve(model, scene, model))
        outcome.values[f"{context.case}.{_short(model)}-peeq"] = Measured(second, first)
        outcome.values[f"{context.case}.{_short(model)}-approach"] = Measured(approach)
        rows.append((model, f"{1e2 * first:.6f} %", f"{second / first - 1.0:.1e}", f"{approach:.1e}"))
    columns = ("model", "largest plastic strain, first load", "added by the second", "change of the approach")
    outcome.tables.append(SmallTable("The second cycle against the first", columns, rows))
    return outcome


def cycles(result: Result) -> tuple[float, float, float]:
    """Largest plastic strain at the peak of the first and at the end of the second cycle, relative change of the approach."""
    history = {
        name: np.asarray(result.tables["history"][name])
        for name in ("cycle", "force_N", "approach_m", "peeq_max")
    }
    tops = [
        np.flatnonzero(history["cycle"] == k)[np.argmax(history["force_N"][history["cycle"] == k])]
        for k in (1, 2)
    ]
    first, second = (float(history["approach_m"][row]) for row in tops)
    return float(history["peeq_max"][tops[0]]), float(history["peeq_max"][-1]), abs(second / first - 1.0)


def _setup(scene: Scene, ratio: float) -> list[tuple[str, str]]:
    loading = scene.loading
    return [
        ("Scene", "rigid sphere on Swift steel, as in plastic-swift-rigid-4"),
        ("Initial yield stress", f"{initial_yield(scene) / 1e6:.1f} MPa"),
        (
            "Level",
            f"p₀/σ_y0 = {ratio:g}; {loading.force:.5g} N in {loading.steps} steps, {loading.cycles} cycle(s)",
        ),
    ]


def _short(model: str) -> str:
    return "sam" if model == SAM else "fem"


CASES = (
    Case(
        "plastic-elastic-limit",
        "Below first yield",
        "Does a body that does not yield give the elastic answer to rounding, without plastic strain?",
        run_elastic,
        (
            (
                "First yield",
                "p₀ = 1.613 σ_y0 (ν = 0.3)",
                "Johnson (1985), section 6.1, with 0.620 p₀ as largest von Mises stress",
            ),
        ),
    ),
    Case(
        "plastic-reload",
        "Unloading and reloading",
        "Does a second loading to the same force stay elastic on Swift steel?",
        run_reload,
        (
            (
                "Shakedown",
                "no plastic strain in the second cycle where residual stress and hardening keep f ≤ 0",
                "Johnson (1985), section 9.2",
            ),
        ),
    ),
)
