# SPDX-License-Identifier: MIT
"""What must not change the answer: the unit system; and what an element patch must not be able to do."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from skfem import ElementQuad2, MeshQuad

from fem_reference import AxisymmetricSolid, Elastic
from sam.scene import Result, Scene, Solver
from verification.cases.case import (
    FEM,
    SAM,
    Case,
    Context,
    Measured,
    SmallTable,
    with_grid,
    with_loading,
    with_mesh,
)

YOUNG_FACTOR, LENGTH_FACTOR = 7.3e-5, 3.1e4  # no powers of two or ten: rounding differs everywhere
FAR = 1e-3
"""solver.tolerance of the solves whose iterations are compared in SAM: residuals of the contact end at 1e-7,
which rounding moves by 1e-5 of themselves. At 1e-10 it moves them by up to 1e-2, and an iteration more or
less would be chance.
"""
SCALED = {"p_max_Pa": (1, 0), "approach_m": (0, 1), "contact_area_m2": (0, 2), "mises_max_Pa": (1, 0)}
STRESSES = ("young", "B", "yield_stress", "modulus")
COUNTER = {SAM: "contact_iterations", FEM: "newton_iterations"}
SHORT = {SAM: "sam", FEM: "fem"}
ZERO_MODE = 1e-10  # eigenvalue over the largest: rounding is 1e-16 times a few hundred


def scaled(scene: Scene, stress: float, length: float) -> Scene:
    """The same problem with stresses and lengths in other units."""
    body = with_stresses(scene.body, stress)
    if body.plasticity is not None:
        body = body.model_copy(update={"plasticity": with_stresses(body.plasticity, stress)})
    other = scene.counterbody.model_copy(update={"radius": scene.counterbody.radius * length})
    scene = with_loading(scene, force=scene.loading.force * stress * length**2)
    lengths = {name: getattr(scene.grid, name) for name in ("extent", "depths")}
    lengths = {name: tuple(each * length for each in values) for name, values in lengths.items() if values}
    return with_grid(scene.model_copy(update={"body": body, "counterbody": other}), **lengths)


def with_stresses(section, factor: float):
    """A section of a scene with its stresses multiplied."""
    known = {name: getattr(section, name, None) for name in STRESSES}
    return section.model_copy(update={name: value * factor for name, value in known.items() if value})


def in_units(powers: Mapping[str, tuple[int, int]]) -> dict[str, float]:
    """The factor of each quantity, from its powers of stress and length."""
    return {name: YOUNG_FACTOR**p * LENGTH_FACTOR**q for name, (p, q) in powers.items()}


def differences(base: Result, other: Result, factors: Mapping[str, float]) -> float:
    """Largest relative difference of the quantities, after division by their factors."""
    pairs = ((base.quantities[name], other.quantities[name] / factor) for name, factor in factors.items())
    return max(abs(found / expected - 1.0) for expected, found in pairs)


def zero_modes(element=None) -> int:
    """Zero eigenvalues of the stiffness of a free patch of 3 x 3 elements that touches the axis."""
    mesh = MeshQuad.init_tensor(np.linspace(0.0, 1.0, 4), np.linspace(0.0, 1.2, 4))
    values = np.linalg.eigvalsh(
        AxisymmetricSolid(mesh, Elastic(1.0, 0.3), element=element).stiffness.toarray()
    )
    return int(np.count_nonzero(np.abs(values) < ZERO_MODE * values.max()))


@dataclass(frozen=True)
class Scaled:
    """One model in two unit systems: the largest difference, and the iterations in each."""

    lost: float
    iterations: tuple[int, int]


class Invariances(Case):
    """One scene in two unit systems by both models, and the zero modes of an element patch."""

    def solve(self, context: Context) -> dict[str, Scaled]:
        scene = with_mesh(with_grid(context.scene("hertz-sphere"), cells=(65, 65)), 16)
        pair = {"si": scene, "scaled": scaled(scene, YOUNG_FACTOR, LENGTH_FACTOR)}
        found = {}
        for model, counter in COUNTER.items():
            results = [context.solve(model, each, f"{model}-{name}") for name, each in pair.items()]
            lost = differences(*results, in_units(SCALED))
            if model == SAM:
                far = {"solver": Solver(tolerance=FAR)}
                results = [
                    context.solve(model, each.model_copy(update=far), f"{model}-{name}-far")
                    for name, each in pair.items()
                ]
            found[model] = Scaled(lost, tuple(result.cost[counter] for result in results))
        return found

    def measure(self, found: dict[str, Scaled]) -> dict[str, Measured]:
        values = {"zero-modes": Measured(zero_modes(), 1)}
        for model, name in SHORT.items():
            first, second = found[model].iterations
            values |= {
                f"{name}-digits": Measured(found[model].lost),
                f"{name}-iterations": Measured(second, first),
            }
        return values

    def setup(self, found: dict[str, Scaled]) -> list[tuple[str, str]]:
        return [
            ("Scene", "rigid sphere, 65 x 65 cells, FEM at a/16"),
            ("Iterations", f"SAM: at solver.tolerance {FAR:g}, far above rounding"),
            ("Unit systems", f"stresses times {YOUNG_FACTOR:g}, lengths times {LENGTH_FACTOR:g}"),
            ("Patch", "3 x 3 elements with an edge on the axis, no support, ν = 0.3"),
        ]

    def tables(self, found: dict[str, Scaled]) -> Iterator[SmallTable]:
        yield SmallTable(
            "The same contact in two unit systems",
            ("model", "iterations", "iterations, scaled", "difference"),
            [(model, *map(str, each.iterations), f"{each.lost:.1e}") for model, each in found.items()],
        )

    def notes(self, found: dict[str, Scaled]) -> Iterator[str]:
        yield (
            f"The free patch of 8-node elements with 2 x 2 points has {zero_modes()} zero mode, the rigid "
            "displacement along the axis; 9-node elements with the same points have "
            f"{zero_modes(ElementQuad2())}, which a contact solution would not show."
        )


CASES = (Invariances(name="invariances"),)
