# SPDX-License-Identifier: MIT
"""Extremes of friction: none to all, incompressible, and more than a perfectly plastic surface carries."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from typing import Any

from sam.scene import Status
from verification.robustness.matrix.checks import as_other_model, balanced, hertz, relative
from verification.robustness.matrix.elastic import INCOMPRESSIBLE
from verification.robustness.matrix.row import TOLERANCE, Deviation, Expectation, Refused, Right, Row, Trial
from verification.robustness.matrix.scenes import scene_with
from verification.runs.models import FEM, FEM_3D, SAM

NO_FRICTION = Refused("friction leaves no symmetry of rotation", ["friction.coefficient"])
NEAR = {"approach_m": 0.015, "p_max_Pa": 0.02}  # of hexahedra of a/4 in a box of 5 a
SHEARED = "no traction beyond yield_stress/sqrt(3)"


def carries(trial: Trial) -> Iterator[Deviation]:
    """Sum of q over sum of p is the coefficient."""
    found, expected = trial.quantities["friction_coefficient"], trial.scene.friction.coefficient
    yield relative("sum of q over sum of p", found, expected, 1e-9, reason="q = mu p in each cell: rounding")


def frictionless(trial: Trial) -> Iterator[Deviation]:
    """Without friction there is no tangential traction."""
    yield Deviation(
        "sum of q over sum of p", abs(trial.quantities["friction_coefficient"]), 1e-300, "there is no q"
    )


def row(
    name: str,
    what: str,
    changes: Mapping[str, Any],
    sam: Expectation,
    *,
    spatial: Expectation | None,
    quick=False,
) -> Row:
    """The axisymmetric model knows no friction; spatial: None where the three-dimensional one is not
    asked.
    """
    mesh = {"fem.cells_per_radius": 4, "fem.box": 5.0} if spatial else {}
    expected = {SAM: sam, FEM: NO_FRICTION} | ({FEM_3D: spatial} if spatial else {})
    return Row(name, "friction", what, partial(scene_with, changes | mesh), expected, quick)


def rows() -> Iterator[Row]:
    """All of them."""
    for mu in (0.1, 0.5, 1.0):
        compared = as_other_model(FEM_3D, NEAR, "4 elements in the radius, a box of 5 radii")
        sam = Right(
            "a contraction: each pass leaves b/sqrt(1 + b^2) of the error, b = beta mu",
            [carries, balanced, compared],
        )
        spatial = Right(
            "one linear problem for each set of nodes", [as_other_model(SAM, NEAR, "the same comparison")]
        )
        yield row(
            f"friction-{mu:g}",
            f"μ = {mu:g} against a rigid sphere",
            {"friction.coefficient": mu},
            sam,
            spatial=spatial,
        )
        apart = {"friction.coefficient": mu, "friction.coupling": False}
        right = Right("q moves nothing normally: Hertz", [hertz(mises=None), carries])
        yield row(
            f"friction-{mu:g}-uncoupled",
            f"μ = {mu:g}, without coupling",
            apart,
            right,
            spatial=None,
            quick=mu == 1.0,
        )
    none = Right("as without [friction]", [hertz(), frictionless])
    what = "μ = 0"
    changes = {"friction.coefficient": 0.0}
    yield Row(
        "friction-0", "friction", what, partial(scene_with, changes), {SAM: none, FEM: none}, quick=True
    )
    incompressible = {"friction.coefficient": 1.0, "body.poisson": 0.5}
    right = Right("(1 - 2 nu)/mu = 0: q moves the surface along x only", [hertz(mises=None), carries])
    yield row("friction-1-poisson-0.5", "μ = 1, ν = 0.5", incompressible, right, spatial=INCOMPRESSIBLE)
    reason = "q moves the surface three times as far as p does: said, with what to change"
    endless = Refused(reason, ["friction.coefficient, 10"], Status.NOT_CONVERGED)
    yield row("friction-10", "μ = 10", {"friction.coefficient": 10.0}, endless, spatial=None)
    beyond = Refused("nothing slides so", ["friction.coefficient", "0 to 10"])
    changes = partial(scene_with, {"friction.coefficient": 10.5})
    yield Row("friction-10.5", "friction", "μ = 10.5", changes, {SAM: beyond, FEM: beyond})
    yield from sheared()


def sheared() -> Iterator[Row]:
    """Tractions near and beyond the shear strength of a perfectly plastic body."""
    strength = 1e9
    given = {
        "body.plasticity": {"law": "perfect", "yield_stress": strength},
        "friction.coefficient": 1.0, "counterbody": None,
        "loading": {"prescribed": "hertz", "radius": 4e-6, "steps": 4},
    }  # fmt: skip
    within = Right("within yield_stress/sqrt(3): elastic but for the edge", [carries, holds_yield])
    changes = given | {"loading.p0": 0.5 * strength}
    yield row("shear-0.5", "q up to half of the yield stress, p given", changes, within, spatial=None)
    no_end = Refused(f"{SHEARED}: no equilibrium", ["loading.p0", "friction.coefficient"])
    changes = partial(scene_with, given | {"loading.p0": 2 * strength})
    all_models = dict.fromkeys((SAM, FEM, FEM_3D), no_end)
    yield Row("shear-2", "friction", "q up to twice the yield stress, p given", changes, all_models)
    flows = Refused(f"{SHEARED}: the contact must spread to p <= 0.58 of it, and is sheared without end", [
        "grid.extent", "loading.force"], Status.PLASTIC_ZONE_AT_GRID_EDGE)  # fmt: skip
    contact = {"body.plasticity": {"law": "perfect", "yield_stress": 1.8687e9}, "friction.coefficient": 1.0}
    yield row("shear-contact", "μ = 1, perfectly plastic, p0/σy = 3", contact, flows, spatial=None)


def holds_yield(trial: Trial) -> Iterator[Deviation]:
    """No stress beyond yield where it was measured."""
    found = trial.result.certificate.get("yield_excess", 0.0)
    yield Deviation("stress beyond yield", found, trial.scene.solver.tolerance, TOLERANCE)
