# SPDX-License-Identifier: MIT
"""The work of the surface tractions is what is stored and dissipated, in both models, over loading and unloading."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from sam.scene import Friction, Scene
from verification.cases.case import Case, Context, Outcome, SmallTable, with_loading
from verification.cases.hertz import contact_of
from verification.cases.plastic import at_ratio
from verification.cases.resolution import Resolution, resolved_at
from verification.console import number
from verification.convergence import fit_order
from verification.energy import of_fem, of_sam
from verification.energy.balance import Balance
from verification.gates import Measured
from verification.models import FEM, FEM_3D

RATIO, FRICTION = 4.0, 0.2
STEPS = (6, 12, 24)  # of the loading; the first for all grids, the coarsest grid for all of them
CELLS = {"quick": (5, 7, 10), "full": (6, 10, 14)}
ELEMENTS = {FEM: 16, FEM_3D: 6}


@dataclass(frozen=True)
class Contact:
    """A sphere that yields. scene: file; reference: the finite-element model that takes part, by level."""

    title: str
    scene: str
    friction: float = 0.0
    levels: tuple[str, ...] = ("quick", "full")
    reference: dict[str, str] = field(default_factory=lambda: {"quick": FEM, "full": FEM})


CONTACTS = {
    "perfect": Contact("perfectly plastic", "plastic-perfect"),
    "sliding": Contact(f"Swift steel, μ = {FRICTION:g}", "plastic-swift-rigid", FRICTION, reference={"full": FEM_3D}),
    "swift": Contact("Swift steel", "plastic-swift-rigid", levels=("full",)),
}
COLUMNS = ("contact", "model", "resolution", "steps", "work [nJ]", "stored", "locked", "dissipated", "error of cells", "of steps")


@dataclass
class Ladder:
    """Balances of a contact in SAM by cells in the contact radius, and by steps on the coarsest of these grids; and of FEM."""

    cells: dict[int, Balance]
    steps: dict[int, Balance]
    fem: dict[int, Balance]


def scene_of(context: Context, contact: Contact, steps: int, cells: int, elements: int = 8) -> Scene:
    """Loaded to RATIO times the yield stress in `steps`, and unloaded."""
    scene = with_loading(at_ratio(context.scene(contact.scene), RATIO), steps=steps, unload=True)
    scene = resolved_at(scene, Resolution(cells, elements))
    return scene.model_copy(update={"friction": Friction(coefficient=contact.friction)}) if contact.friction else scene


def unyielding(scene: Scene) -> Scene:
    """The same contact of a body that stays elastic."""
    return scene.model_copy(update={"body": scene.body.model_copy(update={"plasticity": None})})


def ladder_of(context: Context, name: str) -> Ladder:
    """All solutions of a contact."""
    contact, cells = CONTACTS[name], CELLS[context.level]

    def sam(n: int, steps: int) -> Balance:
        context.progress(f"{context.case}, {name}: {n} cells, {steps} steps", 1, 1)
        return of_sam.balance_of(scene_of(context, contact, steps, n))

    by_cells = {n: sam(n, STEPS[0]) for n in cells}
    by_steps = {STEPS[0]: by_cells[cells[0]]} | {steps: sam(cells[0], steps) for steps in STEPS[1:]}
    model = contact.reference.get(context.level)
    fem = {}
    if model:
        size = ELEMENTS[model]
        ladder = STEPS if model == FEM and context.level == "full" else STEPS[:1]
        fem = {n: of_fem.balance_of(scene_of(context, contact, n, cells[0], size), model) for n in ladder}
    return Ladder(by_cells, by_steps, fem)


def largest(errors: np.ndarray) -> float:
    return float(np.abs(errors).max())


def order(ladder: dict[int, Balance], error: Callable[[Balance], float]) -> float:
    """Observed order of an error in 1/n, n the keys of the ladder."""
    return fit_order(1 / np.array(list(ladder)), [error(one) for one in ladder.values()]).order


def of_cells(one: Balance) -> float:
    return largest(one.error_of_cells)


def of_steps(one: Balance) -> float:
    return largest(one.error_of_steps)


def of_pressing(one: Balance) -> float:
    """What the work F delta of the counter-body differs by from that of the pressure, up to the peak; without friction."""
    return abs(one.pressing[one.peak] / one.work[one.peak] - 1)


def gates(prefix: str, ladder: Ladder, friction: float) -> dict[str, Measured]:
    """Values of a contact's gates, by id."""
    finest, most = ladder.cells[max(ladder.cells)], ladder.steps[max(ladder.steps)]
    out = {
        "sam-cells": Measured(of_cells(finest)),
        "sam-cells-order": Measured(order(ladder.cells, of_cells)),
        "sam-steps": Measured(of_steps(most)),
        "sam-steps-order": Measured(order(ladder.steps, of_steps)),
    }
    if not friction:
        out["sam-pressing"] = Measured(of_pressing(most))
        out["sam-pressing-order"] = Measured(order(ladder.steps, of_pressing))
    if ladder.fem:
        fem = ladder.fem[min(ladder.fem)]
        out["fem-cells"] = Measured(max(of_cells(one) for one in ladder.fem.values()))
        out["work"] = Measured(finest.work[finest.peak], fem.work[fem.peak], unit="J")
        out["dissipated"] = Measured(finest.dissipated[-1], fem.dissipated[-1], unit="J")
        if not friction:
            out["locked"] = Measured(finest.elastic[-1], fem.elastic[-1], unit="J")
            out["fem-pressing"] = Measured(of_pressing(ladder.fem[max(ladder.fem)]))
    if len(ladder.fem) == len(STEPS):
        out["fem-steps"] = Measured(of_steps(ladder.fem[max(STEPS)]))
        out["fem-steps-order"] = Measured(order(ladder.fem, of_steps))
    return {f"{prefix}-{name}": value for name, value in out.items()}


def run(context: Context) -> Outcome:
    """Energy of elastic contacts to rounding, of yielding ones on ladders of cells and steps."""
    outcome, rows, panels = Outcome(), [], {}
    _elastic(context, outcome, rows)
    for name, contact in CONTACTS.items():
        if context.level not in contact.levels:
            continue
        ladder = ladder_of(context, name)
        outcome.values |= gates(f"{context.case}.{name}", ladder, contact.friction)
        first, model = CELLS[context.level][0], contact.reference.get(context.level)
        rows += [_row(contact.title, "SAM", f"a/{n}", one) for n, one in ladder.cells.items()]
        rows += [_row(contact.title, "SAM", f"a/{first}", ladder.steps[n]) for n in STEPS[1:]]
        rows += [_row(contact.title, model, f"a/{ELEMENTS[model]}", one) for one in ladder.fem.values()]
        panels[contact.title] = ladder.cells[CELLS[context.level][-1]], ladder.fem.get(STEPS[0])
    outcome.setup = [
        ("Contacts", f"rigid sphere, p₀ = {RATIO:g} σ_y0 of the elastic contact, loaded in equal steps and unloaded"),
        ("SAM", f"{', '.join(map(str, CELLS[context.level]))} cells in the elastic contact radius"),
        ("Steps", f"{', '.join(map(str, STEPS))} to the peak"),
    ]
    outcome.tables.append(SmallTable("Shares of the work at the peak; errors over the whole path", COLUMNS, rows))
    outcome.notes.append(
        "The error of the cells is W − E − D with both integrals over the path summed by the trapezoidal rule: it closes at "
        "any number of steps where the discrete operators are reciprocal, as the finite elements are by construction, "
        "and measures how far the displacement at a cell's centre is from the mean that its stress is. The "
        "error of the steps is what that D lacks of the work of the yield stress, a function of the plastic strain reached alone."
    )
    outcome.figures.append(_draw(context, panels))
    return outcome


def _elastic(context: Context, outcome: Outcome, rows: list) -> None:
    """Nothing is dissipated: at rest the work is 2/5 F delta of Hertz, sliding the couplings have to be reciprocal."""
    case, cells = context.case, CELLS[context.level][-1]
    for name in ("perfect", "sliding"):
        contact = CONTACTS[name]
        scene = unyielding(scene_of(context, contact, STEPS[0], cells, ELEMENTS[FEM]))
        found = of_sam.balance_of(scene)
        rows.append(_row(f"elastic, μ = {contact.friction:g}", "SAM", f"a/{cells}", found))
        outcome.values[f"{case}.elastic-{'sliding' if contact.friction else 'rest'}"] = Measured(of_cells(found))
        if contact.friction:
            continue
        exact = contact_of(scene)
        hertz = 2 / 5 * exact.force * exact.approach
        fem = of_fem.balance_of(scene, FEM)
        rows.append(_row("elastic, μ = 0", FEM, f"a/{ELEMENTS[FEM]}", fem))
        for model, one in (("sam", found), ("fem", fem)):
            outcome.values[f"{case}.elastic-{model}-work"] = Measured(one.work[one.peak], hertz, unit="J")
        outcome.values[f"{case}.elastic-fem"] = Measured(of_cells(fem))


def _row(contact: str, model: str, resolution: str, one: Balance) -> tuple[str, ...]:
    k, unloads = one.peak, one.force[-1] == 0
    share = one.work[k]
    locked = f"{1e2 * one.elastic[-1] / share:.2f} %" if unloads else "-"
    parts = (f"{1e2 * each / share:.2f} %" for each in (one.elastic[k] + one.beyond[k], one.dissipated[-1]))
    stored, dissipated = parts
    errors = (number(each(one), 2) for each in (of_cells, of_steps))
    return contact, model, resolution, f"{k}", f"{share * 1e9:.5g}", stored, locked, dissipated, *errors


def _draw(context: Context, panels: dict[str, tuple[Balance, Balance | None]]):
    from verification.figures.energy import over_path  # loads matplotlib

    return context.save(
        over_path(panels),
        "path",
        "Energy over the load path",
        "Stacked areas of dissipated, locked and recoverable energy, and the work of the tractions on top of them.",
        "Work of the tractions (line) and where it is (areas), SAM on its finest grid; crosses: FEM. After unloading the work "
        "that was not given back is dissipated or locked by residual stress.",
    )


CASES = (
    Case(
        "energy",
        "Energy over the load path",
        "Is the work of the surface tractions what is stored and dissipated, in both models?",
        run,
        (
            ("Balance", "∫ (p du_z + q du_x) dA = ½ ∫ σ:C⁻¹:σ dV + ∫∫ σ:dεᵖ dV", "virtual work with σ in equilibrium"),
            (
                "Stored, half-space",
                "½ ∫ (p u_z + q u_x)_elastic dA − ½ ∫ σ_res:εᵖ dV",
                "Colonnetti: own stress and stress of the load share no energy",
            ),
            ("Dissipated", "∫ Φ(ε_p) dV,  Φ = ∫ σ_y dε_p", "von Mises flow: σ:dεᵖ = σ_y dε_p"),
            ("Elastic sphere", "W = 2/5 F δ", "Johnson (1985), Eq. 4.23: F ~ δ^(3/2)"),
        ),
    ),
)
