# SPDX-License-Identifier: MIT
"""The work of the surface tractions is what is stored and dissipated, in both models."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from sam.scene import Friction, Scene
from verification.cases.case import FEM, FEM_3D, SAM, Context, DataFrame, Plot, with_body, with_loading
from verification.cases.recipes import Resolution, at_ratio, resolved_at
from verification.energy import Balance, balance_of_fem, balance_of_sam
from verification.figures.specials import over_path
from verification.reference.convergence import fit_power
from verification.references import contact_of
from verification.rows import CaseFile

__all__ = ["balances", "order_in_cells", "order_in_steps"]

RATIO = 4.0
STEPS = (6, 12, 24)  # of the loading; the first for all grids, the coarsest grid for all of them
CELLS = {"quick": (5, 7, 10), "full": (6, 10, 14)}
ELEMENTS = {FEM: 16, FEM_3D: 6}
SHORT = {SAM: "sam", FEM: "fem", FEM_3D: "fem"}
CONTACTS = {
    "perfect": ("perfectly plastic", "plastic-perfect", 0.0),
    "steel": ("Swift steel", "plastic-swift-rigid", 0.0),
    "sliding": ("Swift steel, μ = 0.2", "plastic-swift-rigid", 0.2),
}
"""Title, file of the scene and coefficient of friction of a sphere that yields."""
SOLVED = {
    "energy": (
        *(("perfect", SAM, True), ("sliding", SAM, True), ("perfect", FEM, False)),
        *(("elastic-rest", SAM, False), ("elastic-fem", FEM, False)),
    ),
    "energy-fem": (
        *(("perfect", FEM, True), ("steel", SAM, True), ("steel", FEM, True)),
        *(("sliding", SAM, False), ("sliding", FEM_3D, False)),
        *(("alternating", SAM, True), ("alternating", FEM, True)),
    ),
}
"""Case -> contacts, models, and whether with each number of steps on the coarsest grid, or the fewest."""
# The Hertz pressure that is applied and taken away over the yield stress (Pa), 1.5 times Melan's limit for
# Prager's back-stress, whose modulus is in Pa: with a tenth of it the mean strain settles for longer.
ALTERNATING, MODULUS, YIELD = 4.84, 150e9, 1e9
IN_RADIUS = {SAM: 5, FEM: 3}  # cells or elements in the radius of that pressure


def scene_of(context: Context, contact: str, steps: int, size: int) -> Scene:
    """Loaded to RATIO times the yield stress in `steps`, and unloaded; cells or elements of a/size."""
    _, file, friction = CONTACTS[contact]
    scene = with_loading(at_ratio(context.scene(file), RATIO), steps=steps, unload=True)
    scene = resolved_at(scene, Resolution(size, size))
    return scene.model_copy(update={"friction": Friction(coefficient=friction)}) if friction else scene


def alternating(steps: int, size: int) -> Scene:
    """A given pressure, three times, on cells or elements of radius/size; Prager's perfect plasticity."""
    plasticity = {"law": "perfect", "yield_stress": YIELD, "kinematic": {"modulus": (MODULUS,)}}
    radius, side, count = 10e-6, 50e-6, 5 * size
    pressure = {"prescribed": "hertz", "p0": ALTERNATING * YIELD, "radius": radius}
    return Scene(
        body={"young": 210e9, "poisson": 0.3, "plasticity": plasticity},
        loading={**pressure, "steps": steps, "unload": True, "cycles": 3},
        grid={"cells": (count, count), "extent": (side, side), "layers": 4 * size, "depth": 3.4 * radius},
        fem={"cells_per_radius": size, "box": 6.0},
        solver={"tolerance": 1e-4},
    )


def asked(context: Context) -> Iterator[tuple[str, str, int, Scene]]:
    """Contact, model, cells or elements in the radius, and scene of all that is solved by a case."""
    for contact, model, ladder in SOLVED[context.case]:
        sizes = CELLS[context.level] if model == SAM else (ELEMENTS[model],)
        if contact == "alternating":
            sizes = (IN_RADIUS[model],)
        points = [(n, sizes[0]) for n in STEPS] + [(STEPS[0], size) for size in sizes[1:]]
        for steps, size in points if ladder else [(STEPS[0], sizes[-1])]:
            if contact == "alternating":
                scene = alternating(steps, size)
            else:
                scene = scene_of(context, "perfect" if "elastic" in contact else contact, steps, size)
            yield contact, model, size, with_body(scene, plasticity=None) if "elastic" in contact else scene


def balances(context: Context) -> Iterator[dict[str, Any]]:
    """A row for each balance, cells rising: see `row`; hertz: 2/5 F delta, the work of an elastic contact."""
    exact = contact_of(scene_of(context, "perfect", STEPS[0], CELLS[context.level][-1]))
    for contact, model, size, scene in asked(context):
        steps = scene.loading.steps
        context.progress(f"{context.case}, {contact}: {model}, {steps} steps", 1, 1)
        one = balance_of_sam(scene) if model == SAM else balance_of_fem(scene, model)
        where = {"contact": contact, "model": SHORT[model], "size": size, "steps": steps}
        yield where | row(one, contact) | {"hertz": 2 / 5 * exact.force * exact.approach}


def row(one: Balance, contact: str) -> dict[str, Any]:
    """Energies in J: the work at the peak, dissipated and locked, stored as cold work, after unloading; the
    largest errors of the cells and of the steps over the states. within-cells: plastic work of stresses that
    vary within cells over the largest work, 0 in FEM. pressing: what the work F delta of the counter-body
    differs by from that of the pressure, up to the peak. Of one that alternates, in its last cycle, between
    two states without force, over what that dissipates: cycle, the work less what is dissipated, as elastic
    energy and that of the back-stresses are to come back; flow, the plastic work less what is dissipated and
    stored by back-stresses.
    """
    values = {
        "work": one.work[one.peak],
        "dissipated": one.dissipated[-1],
        "locked": one.elastic[-1],
        "error-of-cells": one.error_of_cells,
        "error-of-steps": one.error_of_steps,
        "within-cells": np.abs(one.within).max() / np.abs(one.work).max(),
        "balance": [one],
    }
    if contact == "alternating":
        before, end = np.flatnonzero(one.force == 0)[-2:]
        for name, energy in (("cycle", one.work - one.beyond), ("flow", one.flowed - one.back)):
            spent = one.dissipated[end] - one.dissipated[before]
            values[name] = abs((energy[end] - energy[before]) / spent - 1)
    elif contact != "sliding":
        values["pressing"] = abs(one.pressing[one.peak] / one.work[one.peak] - 1)
    return values


def order_in_cells(rows: DataFrame, column: str) -> float:
    """The order in which an error falls with the size of the cells or the load step; the other is one."""
    return fit_power(1 / (rows["size"] * rows["steps"]), rows[column]).exponent


order_in_steps = order_in_cells


def path(file: CaseFile, frame: DataFrame) -> Plot:
    """Each energy over the load steps, SAM on its finest grid."""
    panels = {}
    for contact, (title, *_) in CONTACTS.items():
        same = frame[(frame["contact"] == contact) & (frame["steps"] == STEPS[0])]
        found = dict(zip(same["model"], same["balance"], strict=True))
        if one := found.pop("sam", None):
            panels[title] = one[0], next((other for (other,) in found.values()), None)
    words = (
        "The figure shows the work of the tractions (line) and where it goes (areas) by SAM on its finest "
        "grid, and by FEM (crosses). After unloading the rest is dissipated or stored by residual stress."
    )
    return Plot(over_path(panels), "path", "Energy over the load path", words)
