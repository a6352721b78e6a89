# SPDX-License-Identifier: MIT
"""The work of the surface tractions is what is stored and dissipated, in both models, over loading and
unloading.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from sam.scene import Friction, Scene
from verification.cases.case import (
    FEM,
    FEM_3D,
    SAM,
    Case,
    Context,
    Measured,
    Plot,
    SmallTable,
    number,
    with_body,
    with_loading,
)
from verification.cases.recipes import Resolution, at_ratio, resolved_at
from verification.energy import of_fem, of_sam
from verification.energy.balance import Balance
from verification.figures.specials import over_path
from verification.reference.convergence import fit_order
from verification.references import contact_of

RATIO = 4.0
STEPS = (6, 12, 24)  # of the loading; the first for all grids, the coarsest grid for all of them
CELLS = {"quick": (5, 7, 10), "full": (6, 10, 14)}
ELEMENTS = {FEM: 16, FEM_3D: 6}
CONTACTS = {
    "perfect": ("perfectly plastic", "plastic-perfect", 0.0),
    "steel": ("Swift steel", "plastic-swift-rigid", 0.0),
    "sliding": ("Swift steel, μ = 0.2", "plastic-swift-rigid", 0.2),
}
"""Title, file of the scene and coefficient of friction of a sphere that yields."""
# Of a pressure in place, over the yield stress: 1.5 times Melan's limit for Prager's back-stress. Its modulus
# in Pa: with a tenth of it the mean strain settles for longer.
ALTERNATING, MODULUS, YIELD = 4.84, 150e9, 1e9
IN_RADIUS = {SAM: 5, FEM: 3}  # cells or elements in the radius of that pressure

Runs = Mapping[tuple[str, int, int], Balance]
"""Model, cells or elements in the radius, steps -> balance."""
Found = tuple[Mapping[str, Runs], float]


def of_cells(one: Balance) -> float:
    """The largest error of the cells over the states."""
    return float(np.abs(one.error_of_cells).max())


def of_steps(one: Balance) -> float:
    """The largest error of the steps over the states."""
    return float(np.abs(one.error_of_steps).max())


def within(one: Balance) -> float:
    """The largest plastic work of stresses that vary within the cells over the largest work; 0 in FEM."""
    return float(np.abs(one.within).max() / np.abs(one.work).max())


def pressing(one: Balance) -> float:
    """What the work F delta of the counter-body differs by from that of the pressure, up to the peak; without
    friction.
    """
    return abs(one.pressing[one.peak] / one.work[one.peak] - 1)


def _in_last_cycle(one: Balance, energy: np.ndarray) -> float:
    """What the last cycle, between two states without force, adds to an energy, over what it dissipates."""
    before, end = np.flatnonzero(one.force == 0)[-2:]
    return float((energy[end] - energy[before]) / (one.dissipated[end] - one.dissipated[before]))


def cycle(one: Balance) -> float:
    """The work of a last cycle less what is dissipated, over that; elastic energy and the energy of the
    back-stresses are to come back.
    """
    return abs(_in_last_cycle(one, one.work - one.beyond) - 1)


def flow(one: Balance) -> float:
    """The plastic work of a last cycle less what is dissipated and stored by back-stresses, over the former
    of the two.
    """
    return abs(_in_last_cycle(one, one.flowed - one.back) - 1)


def gates(runs: Runs, friction: float) -> dict[str, Measured]:
    """The rows of a contact: of ladders their finest balance and the order, of both models after the same
    steps what they have in common.
    """
    values: dict[str, Measured] = {}

    def ladder(lead: str, by: Mapping[int, Balance], **errors: Callable[[Balance], float]) -> None:
        for name, error in errors.items() if len(by) > 1 else ():
            each = [error(one) for one in by.values()]
            values[f"{lead}-{name}"] = Measured(each[-1])
            values[f"{lead}-{name}-order"] = Measured(fit_order([1 / n for n in by], each).order)

    sizes = sorted({n for model, n, _ in runs if model == SAM})
    in_steps = {"steps": of_steps} | ({} if friction else {"pressing": pressing})
    ladder("sam", {n: runs[SAM, n, STEPS[0]] for n in sizes}, cells=of_cells, within=within)
    if sizes and (SAM, sizes[0], STEPS[1]) in runs:
        ladder("sam", {n: runs[SAM, sizes[0], n] for n in STEPS}, **in_steps)
    of_fem = next(((model, n) for model, n, _ in runs if model != SAM), None)
    if of_fem and (*of_fem, STEPS[1]) in runs:
        ladder("fem", {n: runs[*of_fem, n] for n in STEPS}, **in_steps)
    if of_fem and sizes:
        sam, fem = runs[SAM, sizes[-1], STEPS[0]], runs[*of_fem, STEPS[0]]
        values["fem-cells"] = Measured(of_cells(fem))
        values["work"] = Measured(sam.work[sam.peak], fem.work[fem.peak], unit="J")
        values["dissipated"] = Measured(sam.dissipated[-1], fem.dissipated[-1], unit="J")
        values["locked"] = Measured(sam.elastic[-1], fem.elastic[-1], unit="J")
    return values


def scene_of(context: Context, contact: str, steps: int, size: int) -> Scene:
    """Loaded to RATIO times the yield stress in `steps`, and unloaded; cells or elements of a/size."""
    _, file, friction = CONTACTS[contact]
    scene = with_loading(at_ratio(context.scene(file), RATIO), steps=steps, unload=True)
    scene = resolved_at(scene, Resolution(size, size))
    return scene.model_copy(update={"friction": Friction(coefficient=friction)}) if friction else scene


def alternating(steps: int, size: int, radius: float = 10e-6) -> Scene:
    """A given pressure that comes and goes three times, on cells or elements of radius/size; perfect
    plasticity with Prager's back-stress.
    """
    plasticity = {"law": "perfect", "yield_stress": YIELD, "kinematic": {"modulus": (MODULUS,)}}
    pressure = {"prescribed": "hertz", "p0": ALTERNATING * YIELD, "radius": radius}
    side, count = 5 * radius, 5 * size
    return Scene(
        body={"young": 210e9, "poisson": 0.3, "plasticity": plasticity},
        loading={**pressure, "steps": steps, "unload": True, "cycles": 3},
        grid={"cells": (count, count), "extent": (side, side), "layers": 4 * size, "depth": 3.4 * radius},
        fem={"cells_per_radius": size, "box": 6.0},
        solver={"tolerance": 1e-4},
    )


def balanced(context: Context, words: str, scene: Scene, model: str) -> Balance:
    """The balance of a scene by a model."""
    context.progress(f"{context.case}, {words}: {model}, {scene.loading.steps} steps", 1, 1)
    return of_sam.balance_of(scene) if model == SAM else of_fem.balance_of(scene, model)


@dataclass(frozen=True)
class Energy(Case):
    """Yielding contacts on ladders of cells and steps. ladders: contact -> models that take each number of
    steps, SAM on each number of cells too; once: contact -> models that take the fewest steps, SAM on the
    finest cells; elastic, cycles: whether elastic contacts, and bodies that alternate, are balanced too.
    """

    ladders: Mapping[str, tuple[str, ...]] | None = None
    once: Mapping[str, tuple[str, ...]] | None = None
    elastic: bool = False
    cycles: bool = False

    def asked(self, cells: tuple[int, ...]) -> Iterator[tuple[str, str, int, int]]:
        """Contact, model, cells or elements in the radius and steps of all that is solved."""
        for contact, models in self.ladders.items():
            for model in models:
                size = cells[0] if model == SAM else ELEMENTS[model]
                yield from ((contact, model, size, n) for n in STEPS)
                yield from ((contact, model, n, STEPS[0]) for n in cells[1:] if model == SAM)
        for contact, models in self.once.items():
            for model in models:
                yield contact, model, cells[-1] if model == SAM else ELEMENTS[model], STEPS[0]

    def solve(self, context: Context) -> tuple[dict[str, dict[tuple[str, int, int], Balance]], float]:
        """Contact -> balances, and 2/5 F delta of Hertz, the work of an elastic contact at rest. Nothing is
        dissipated by elastic ones: sliding the couplings have to be reciprocal.
        """
        cells, found = CELLS[context.level], dict[str, dict[tuple[str, int, int], Balance]]()
        for contact, *run in self.asked(cells):
            model, size, steps = run
            scene = scene_of(context, contact, steps, size)
            found.setdefault(contact, {})[model, size, steps] = balanced(context, contact, scene, model)
        for name, contact, model in (
            ("elastic-rest", "perfect", SAM),
            ("elastic-sliding", "sliding", SAM),
            ("elastic-fem", "perfect", FEM),
        ):
            if self.elastic:
                size = cells[-1] if model == SAM else ELEMENTS[model]
                scene = with_body(scene_of(context, contact, STEPS[0], size), plasticity=None)
                found[name] = {(model, size, STEPS[0]): balanced(context, name, scene, model)}
        for model in (SAM, FEM) if self.cycles else ():
            size, name = IN_RADIUS[model], f"alternating-{'sam' if model == SAM else 'fem'}"
            found[name] = {
                (model, size, n): balanced(context, name, alternating(n, size), model) for n in STEPS
            }
        exact = contact_of(scene_of(context, "perfect", STEPS[0], cells[-1]))
        return found, 2 / 5 * exact.force * exact.approach

    def measure(self, found: Found) -> dict[str, Measured]:
        balances, hertz = found
        values: dict[str, Measured] = {}
        for contact, runs in balances.items():
            *_, last = runs.values()
            if contact in CONTACTS:
                values |= {f"{contact}-{n}": v for n, v in gates(runs, CONTACTS[contact][2]).items()}
            elif contact.startswith("elastic"):
                values[contact] = Measured(of_cells(last))
                if contact != "elastic-sliding":
                    name = "elastic-sam-work" if contact == "elastic-rest" else "elastic-fem-work"
                    values[name] = Measured(last.work[last.peak], hertz, unit="J")
            else:
                order = fit_order([1 / n for n in STEPS], [flow(one) for one in runs.values()]).order
                values |= {
                    f"{contact}-cycle": Measured(cycle(last)),
                    f"{contact}-cycle-order": Measured(order),
                }
        return values

    def tables(self, found: Found) -> Iterator[SmallTable]:
        columns = ("contact", "model", "resolution", "steps", "work [nJ]", "stored", "locked", "dissipated")
        yield SmallTable(
            (
                "Shares of the work at the peak (locked: stored as cold work, and dissipated, after "
                "unloading); largest errors over the path"
            ),
            (*columns, "error of cells", "of steps", "within cells"),
            [row(contact, run, one) for contact, runs in found[0].items() for run, one in runs.items()],
        )

    def notes(self, found: Found) -> Iterator[str]:
        yield (
            "The error of the cells is W − E − D with both integrals over the path summed by the trapezoidal "
            "rule. It closes at any number of steps where the discrete operators are reciprocal, as finite "
            "elements are by construction; in SAM it is the distance of the displacement at a cell's centre "
            "from the mean over the cell. The error of the steps is what that D lacks of the work of the "
            "yield stress, which depends on the plastic strain reached alone. Within cells is the plastic "
            "work of stresses that vary over a cell of SAM, whose law is fulfilled at four points; the "
            "tractions do not do it, as the operators take the strain of a cell as uniform. Back-stresses "
            "store a part of the plastic work, and give it back."
        )

    def figures(self, found: Found) -> Iterator[Plot]:
        panels = {}
        for contact, (title, *_) in CONTACTS.items():
            same = {run[0]: one for run, one in found[0].get(contact, {}).items() if run[2] == STEPS[0]}
            if SAM in same:
                panels[title] = same[SAM], next((one for model, one in same.items() if model != SAM), None)
        words = (
            "Work of the tractions (line) and where it is (areas), SAM on its finest grid; crosses: FEM. "
            "After unloading the work that was not given back is dissipated or stored by residual stress."
        )
        yield Plot(over_path(panels), "path", "Energy over the load path", words, words)


def row(contact: str, run: tuple[str, int, int], one: Balance) -> tuple[str, ...]:
    """Of the table."""
    k, (model, size, steps) = one.peak, run
    shares = (one.elastic[k] + one.beyond[k], one.elastic[-1], one.dissipated[-1])
    percent = (f"{1e2 * each / one.work[k]:.2f} %" for each in shares)
    errors = (number(each(one), 2) for each in (of_cells, of_steps, within))
    title = CONTACTS[contact][0] if contact in CONTACTS else contact
    return title, model, f"a/{size}", f"{steps}", f"{one.work[k] * 1e9:.5g}", *percent, *errors


CASES = (
    Energy("energy", ladders={"perfect": (SAM,), "sliding": (SAM,)}, once={"perfect": (FEM,)}, elastic=True),
    Energy(
        "energy-fem",
        ladders={"perfect": (FEM,), "steel": (SAM, FEM)},
        once={"sliding": (SAM, FEM_3D)},
        cycles=True,
    ),
)
