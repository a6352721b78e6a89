# SPDX-License-Identifier: MIT
"""What must not change the answer: the unit system; and what an element patch must not be able to do."""

from __future__ import annotations

import numpy as np
from skfem import ElementQuad2, MeshQuad

from fem_reference.elasticity import AxisymmetricSolid
from sam.scene import Result, Scene
from verification.cases.case import Case, Context, Outcome, SmallTable, with_grid, with_mesh
from verification.gates import Measured
from verification.models import FEM, SAM

YOUNG_FACTOR, LENGTH_FACTOR = 7.3e-5, 3.1e4  # no powers of two or ten: rounding differs everywhere
SCALED = {"p_max_Pa": (1, 0), "approach_m": (0, 1), "contact_area_m2": (0, 2), "mises_max_Pa": (1, 0)}
COUNTER = {SAM: "contact_iterations", FEM: "newton_iterations"}
ZERO_MODE = 1e-10  # eigenvalue over the largest: rounding is 1e-16 times a few hundred


def scaled(scene: Scene, young: float, length: float) -> Scene:
    """The same problem with stresses and lengths in other units."""
    body = scene.body.model_copy(update={"young": scene.body.young * young})
    other = scene.counterbody.model_copy(update={"radius": scene.counterbody.radius * length})
    loading = scene.loading.model_copy(update={"force": scene.loading.force * young * length**2})
    scene = scene.model_copy(update={"body": body, "counterbody": other, "loading": loading})
    return with_grid(scene, extent=tuple(side * length for side in scene.grid.extent))


def digits_lost(base: Result, other: Result) -> float:
    """Largest relative difference of the quantities after scaling back."""
    differences = []
    for name, (p, q) in SCALED.items():
        back = other.quantities[name] / (YOUNG_FACTOR**p * LENGTH_FACTOR**q)
        differences.append(abs(back / base.quantities[name] - 1.0))
    return max(differences)


def zero_modes(element=None) -> int:
    """Zero eigenvalues of the stiffness of a free patch of 3 x 3 elements that touches the axis."""
    mesh = MeshQuad.init_tensor(np.linspace(0.0, 1.0, 4), np.linspace(0.0, 1.2, 4))
    values = np.linalg.eigvalsh(AxisymmetricSolid(mesh, 1.0, 0.3, element).stiffness.toarray())
    return int(np.count_nonzero(np.abs(values) < ZERO_MODE * values.max()))


def run(context: Context) -> Outcome:
    """Solve one scene in two unit systems with both models, and count the zero modes of an element patch."""
    scene = with_mesh(with_grid(context.scene("hertz-sphere"), cells=(65, 65)), 16)
    other = scaled(scene, YOUNG_FACTOR, LENGTH_FACTOR)
    outcome = Outcome(
        setup=[
            ("Scene", "rigid sphere, 65 x 65 cells, FEM at a/16"),
            ("Unit systems", f"stresses times {YOUNG_FACTOR:g}, lengths times {LENGTH_FACTOR:g}"),
            ("Patch", "3 x 3 elements with an edge on the axis, no support, ν = 0.3"),
        ]
    )
    rows = []
    for model, counter in COUNTER.items():
        base, again = context.solve(model, scene, f"{model}-si"), context.solve(model, other, f"{model}-scaled")
        lost, first, second = digits_lost(base, again), base.cost[counter], again.cost[counter]
        name = "sam" if model == SAM else "fem"
        outcome.values[f"{context.case}.{name}-digits"] = Measured(lost)
        outcome.values[f"{context.case}.{name}-iterations"] = Measured(second, first)
        rows.append((model, f"{first}", f"{second}", f"{lost:.1e}"))
    outcome.tables.append(
        SmallTable(
            "The same contact in two unit systems", ("model", "iterations", "iterations, scaled", "difference"), rows
        )
    )
    modes, spurious = zero_modes(), zero_modes(ElementQuad2())
    outcome.values[f"{context.case}.zero-modes"] = Measured(modes, 1)
    outcome.notes.append(
        f"The free patch of 8-node elements with 2 x 2 points has {modes} zero mode, the rigid displacement along the axis; "
        f"9-node elements with the same points have {spurious}, which a contact solution would not show."
    )
    return outcome


CASES = (
    Case(
        name="invariances",
        title="Unit systems and rigid modes",
        question="Do the units change the iterations or the digits, and can an element deform without resistance?",
        run=run,
    ),
)
