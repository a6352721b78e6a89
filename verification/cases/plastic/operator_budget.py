# SPDX-License-Identifier: MIT
"""What an elasto-plastic solution of SAM costs, counted in applications of its residual-stress operator."""

from __future__ import annotations

from collections.abc import Iterator

from sam.scene import Result, Scene
from verification.cases.case import (
    FEM,
    SAM,
    Case,
    Context,
    Measured,
    SmallTable,
    with_keys,
    with_loading,
)
from verification.cases.recipes import Resolution, at_ratio, resolved_at

TOLERANCE, CELLS, RATIO = 1e-5, 14, 4.0
REFINED = {"quick": 16, "full": 32}


class OperatorBudget(Case):
    """Ten steps to p0/sigma_y0 = 4 on Swift steel with 14 cells in the elastic contact radius."""

    def solve(self, context: Context) -> tuple[Scene, Result, Result]:
        scene = at_ratio(context.scene("plastic-swift-rigid"), RATIO)
        scene = with_keys(with_loading(scene, unload=False), "solver", tolerance=TOLERANCE)
        scene = resolved_at(scene, Resolution(CELLS, REFINED[context.level]))
        return scene, context.solve(SAM, scene, "sam"), context.solve(FEM, scene, "refined")

    def measure(self, found: tuple[Scene, Result, Result]) -> dict[str, Measured | float]:
        _, sam, fem = found
        strains = (result.quantities["peeq_max"] for result in (sam, fem))
        return {"applications": sam.cost["operator_applications"], "peeq-max": Measured(*strains)}

    def setup(self, found: tuple[Scene, Result, Result]) -> list[tuple[str, str]]:
        scene = found[0]
        return [
            (
                "Scene",
                f"rigid sphere on Swift steel, p₀/σ_y0 = {RATIO:g}, {scene.loading.steps} steps, tolerance "
                f"{TOLERANCE:g}",
            ),
            (
                "Cells",
                f"{CELLS} in the elastic contact radius; refined value: FEM, {scene.fem.cells_per_radius} "
                "elements in it",
            ),
        ]

    def tables(self, found: tuple[Scene, Result, Result]) -> Iterator[SmallTable]:
        history = found[1].tables["history"]
        yield SmallTable(
            "Over the load steps",
            ("step", "force [N]", "iterations", "residual"),
            [
                (f"{k}", f"{f:.4f}", f"{n}", f"{left:.1e}")
                for k, f, n, left in zip(
                    *(history[name] for name in ("step", "force_N", "iterations", "residual")), strict=True
                )
            ],
        )


CASES = (OperatorBudget("operator-budget"),)
