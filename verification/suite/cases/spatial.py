# SPDX-License-Identifier: MIT
"""Without friction the three-dimensional finite elements must give what the axisymmetric ones give."""

from __future__ import annotations

from sam.scene import Scene
from verification.runs.models import FEM, FEM_3D
from verification.suite.cases.case import Case, Context, Outcome, SmallTable, mesh_text
from verification.suite.cases.friction import BOX, SCENE, sliding_scene
from verification.suite.cases.plastic import EQUATIONS
from verification.suite.cases.resolution import Resolution
from verification.suite.gates import Measured
from verification.text.console import number

RATIOS = (3.0, 4.0)
# in the elastic contact radius, and the box of the axisymmetric model in it
ELEMENTS, AXISYMMETRIC, WIDE = 8, 32, 10.0
SHOWN = {
    "approach_m": ("approach [nm]", 1e9),
    "p_max_Pa": ("largest pressure [GPa]", 1e-9),
    "contact_radius_m": ("contact radius [µm]", 1e6),
    "peeq_max": ("largest plastic strain [%]", 1e2),
    "peeq_max_depth_m": ("its depth [µm]", 1e6),
    "mises_max_Pa": ("largest von Mises stress [GPa]", 1e-9),
}


def run(context: Context) -> Outcome:
    """The same contacts with both models."""
    base = context.scene(SCENE)
    outcome, rows = Outcome(), []
    for ratio in RATIOS:
        spatial = context.solve(
            FEM_3D, sliding_scene(base, ratio, 0.0, Resolution(8, ELEMENTS)), f"spatial-{ratio:g}"
        )
        flat = context.solve(
            FEM, boxed(sliding_scene(base, ratio, 0.0, Resolution(8, AXISYMMETRIC))), f"flat-{ratio:g}"
        )
        for gate, name, unit in (("strain", "peeq_max", ""), ("p-max", "p_max_Pa", "Pa")):
            value = Measured(spatial.quantities[name], flat.quantities[name], unit=unit)
            outcome.values[f"{context.case}.{gate}-{ratio:g}"] = value
        for name, (words, unit) in SHOWN.items():
            a, b = spatial.quantities[name], flat.quantities[name]
            rows.append(
                (
                    f"{ratio:g}",
                    words,
                    number(a * unit, 5),
                    number(b * unit, 5),
                    f"{1e2 * (a / b - 1.0):+.2f} %",
                )
            )
    outcome.setup = [
        ("Scene", f"{SCENE}, loading to p₀/σ_y0 = " + " and ".join(f"{ratio:g}" for ratio in RATIOS)),
        ("Three-dimensional", f"{mesh_text(spatial)}, {ELEMENTS} elements in a, box {BOX:g} a"),
        ("Axisymmetric", f"{mesh_text(flat)}, {AXISYMMETRIC} elements in a, box {WIDE:g} a"),
    ]
    columns = ("p₀/σ_y0", "quantity", "three-dimensional", "axisymmetric", "difference")
    outcome.tables.append(SmallTable("Both finite-element models", columns, rows))
    return outcome


def boxed(scene: Scene) -> Scene:
    """With the box of the axisymmetric model."""
    return scene.model_copy(update={"fem": scene.fem.model_copy(update={"box": WIDE})})


CASES = (
    Case(
        "spatial-axisymmetric",
        "Three-dimensional against axisymmetric finite elements",
        "Does the three-dimensional model without friction reproduce the axisymmetric one?",
        run,
        EQUATIONS,
        ("full",),
    ),
)
