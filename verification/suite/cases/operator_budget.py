# SPDX-License-Identifier: MIT
"""What an elasto-plastic solution of SAM costs, counted in applications of its residual-stress operator."""

from __future__ import annotations

from sam.scene import Scene
from verification.runs.models import FEM, SAM
from verification.suite.cases.case import Case, Context, Outcome, SmallTable, with_loading
from verification.suite.cases.plastic import at_ratio
from verification.suite.cases.resolution import Resolution, resolved_at
from verification.suite.gates import Measured

TOLERANCE, CELLS, RATIO = 1e-5, 14, 4.0
REFINED = {"quick": 16, "full": 32}


def run(context: Context) -> Outcome:
    """Ten steps to p0/sigma_y0 = 4 on Swift steel with 14 cells in the elastic contact radius."""
    scene = at_ratio(context.scene("plastic-swift-rigid"), RATIO)
    scene = with_tolerance(with_loading(scene, unload=False), TOLERANCE)
    scene = resolved_at(scene, Resolution(CELLS, REFINED[context.level]))
    sam, fem = context.solve(SAM, scene, "sam"), context.solve(FEM, scene, "refined")
    applications, found = sam.cost["operator_applications"], sam.quantities["peeq_max"]
    refined = fem.quantities["peeq_max"]
    return Outcome(
        {
            f"{context.case}.applications": Measured(applications),
            f"{context.case}.peeq-max": Measured(found, refined),
        },
        [
            (
                "Scene",
                f"rigid sphere on Swift steel, p₀/σ_y0 = {RATIO:g}, {scene.loading.steps} steps, tolerance {TOLERANCE:g}",
            ),
            (
                "Cells",
                f"{CELLS} in the elastic contact radius; refined value: FEM, {REFINED[context.level]} elements in it",
            ),
        ],
        tables=[
            SmallTable("Over the load steps", ("step", "force [N]", "iterations", "residual"), steps_of(sam))
        ],
    )


def with_tolerance(scene: Scene, tolerance: float) -> Scene:
    return scene.model_copy(update={"solver": scene.solver.model_copy(update={"tolerance": tolerance})})


def steps_of(sam) -> list[tuple[str, ...]]:
    """One row a load step."""
    history = sam.tables["history"]
    columns = (history[name] for name in ("step", "force_N", "iterations", "residual"))
    return [
        (f"{k}", f"{force:.4f}", f"{n}", f"{left:.1e}") for k, force, n, left in zip(*columns, strict=True)
    ]


CASES = (
    Case(
        "operator-budget",
        "Cost of the plastic loop",
        "How often is the residual-stress operator applied, and is the plastic strain right with 14 cells in the contact "
        "radius?",
        run,
        (
            (
                "One-level iteration",
                "x = return(σ(x) + 2m x), Anderson accelerated, contact solved inside",
                "Anderson, J. ACM 12 (1965) 547; Walker & Ni, SIAM J. Numer. Anal. 49 (2011) 1715",
            ),
        ),
    ),
)
