# SPDX-License-Identifier: MIT
"""What turns, moves and scales with a contact: each transformation solved both ways, and the largest difference."""

from __future__ import annotations

import numpy as np

from sam.contact.normal import Contact, Search, solve_contact
from sam.planner.grids import choose_grid, gap_of
from sam.scene import Friction, Scene
from verification.runs.models import FEM, SAM
from verification.suite.cases.case import Case, Context, Outcome, SmallTable, with_loading
from verification.suite.cases.invariances import (
    COUNTER,
    LENGTH_FACTOR,
    YOUNG_FACTOR,
    differences,
    in_units,
    scaled,
)
from verification.suite.cases.plastic import at_ratio
from verification.suite.cases.resolution import Resolution, resolved_at
from verification.suite.gates import Measured

MODULUS, TOLERANCE, COUPLING = 230e9, 1e-11, 0.1  # of the rough contacts; coupling: 2 beta mu
SHIFT = (7, -12)  # cells
BLUNTER, RATIO, FRICTION = 2.7, 4.0, 0.2
POWERS = {
    "p_max_Pa": (1, 0),
    "mises_max_Pa": (1, 0),
    "approach_m": (0, 1),
    "contact_area_m2": (0, 2),
    "peeq_max": (0, 0),
}


def pressed(gap: np.ndarray, h: tuple[float, float], force: float, coupling: float = 0.0) -> Contact:
    """RuntimeError when it does not converge."""
    found = solve_contact(gap, h, MODULUS, force, coupling=coupling, search=Search(TOLERANCE))
    if not found.converged:
        raise RuntimeError(f"a rough contact did not converge: residual {found.residual:.1e}")
    return found


def change(found: np.ndarray, expected: np.ndarray) -> float:
    """Largest difference over the largest value."""
    return float(np.abs(found - expected).max() / np.abs(expected).max())


def turned(gap: np.ndarray, h: tuple[float, float], force: float) -> dict[str, float]:
    """Changes of the pressure of a rough contact when it is moved, mirrored, turned and slides the other way.

    gap: (nx, ny) in m, cells h in m.
    """
    base, sliding = pressed(gap, h, force), pressed(gap, h, force, COUPLING)
    room = tuple(2 * max(map(abs, SHIFT)) + n for n in gap.shape)
    places = [np.full(room, np.inf) for _ in (0, 1)]
    corners = [
        tuple((n - m) // 2 + s for n, m, s in zip(room, gap.shape, shift, strict=True))
        for shift in ((0, 0), SHIFT)
    ]
    windows = [tuple(slice(i, i + n) for i, n in zip(corner, gap.shape, strict=True)) for corner in corners]
    for place, window in zip(places, windows, strict=True):
        place[window] = gap
    here, there = (
        pressed(place, h, force).pressure[window] for place, window in zip(places, windows, strict=True)
    )
    return {
        "translation": change(there, here),
        "mirror": change(pressed(gap[::-1], h, force).pressure[::-1], base.pressure),
        "quarter-turn": change(
            pressed(np.ascontiguousarray(gap.T), h[::-1], force).pressure.T, base.pressure
        ),
        "sliding-mirror": change(pressed(gap[::-1], h, force, -COUPLING).pressure[::-1], sliding.pressure),
        "sliding-mirror-y": change(
            pressed(gap[:, ::-1], h, force, COUPLING).pressure[:, ::-1], sliding.pressure
        ),
    }


def blunter(scene: Scene, factor: float) -> Scene:
    """Young's modulus and radius times a factor at equal force and yield stress: equal pressures, strains over the factor.

    For perfect plasticity (Johnson 1985, section 6.3: E* a/(sigma_y R) alone counts).
    """
    body = scene.body.model_copy(update={"young": scene.body.young * factor})
    other = scene.counterbody.model_copy(update={"radius": scene.counterbody.radius * factor})
    return scene.model_copy(update={"body": body, "counterbody": other})


def run(context: Context) -> Outcome:
    """A rough patch turned and moved; yielding spheres in other units, blunter, and elastic ones by other steps."""
    scene = context.scene("rough-patch")
    grid = choose_grid(scene)
    found = turned(gap_of(scene, grid), (grid.hx, grid.hy), scene.loading.force)
    rows = [
        (f"rough patch, {name.replace('-', ' ')}", "SAM", "-", f"{value:.1e}")
        for name, value in found.items()
    ]
    outcome = Outcome({f"{context.case}.{name}": Measured(value) for name, value in found.items()})
    for model, name in ((SAM, "sam"), (FEM, "fem")):
        for kind, base, other, factors in scenes(context, model):
            first, second = (
                context.solve(model, base, f"{name}-{kind}"),
                context.solve(model, other, f"{name}-{kind}-changed"),
            )
            lost, counts = (
                differences(first, second, factors),
                [each.cost[COUNTER[model]] for each in (first, second)],
            )
            outcome.values[f"{context.case}.{name}-{kind}"] = Measured(lost)
            if kind == "units":
                outcome.values[f"{context.case}.{name}-units-iterations"] = Measured(*reversed(counts))
            rows.append((kind.replace("-", " "), model, " / ".join(map(str, counts)), f"{lost:.1e}"))
    outcome.setup = [
        (
            "Rough patch",
            f"{grid.nx} × {grid.ny} cells, elastic, moved by {SHIFT} cells; sliding with 2βμ = {COUPLING:g}",
        ),
        ("Yielding", f"perfectly plastic, p₀ = {RATIO:g} σ_y; in SAM sliding with μ = {FRICTION:g}"),
        ("Units", f"stresses times {YOUNG_FACTOR:g}, lengths times {LENGTH_FACTOR:g}"),
        ("Similarity", f"E and R times {BLUNTER:g}: equal pressures, strains and approach less by that"),
        ("Steps", "elastic, in one step and in seven"),
    ]
    outcome.tables.append(
        SmallTable(
            "Largest change", ("transformation", "model", "iterations before / after", "difference"), rows
        )
    )
    return outcome


def scenes(context: Context, model: str) -> list[tuple[str, Scene, Scene, dict[str, float]]]:
    """(name, scene, transformed scene, quantity -> its factor)."""
    scene = with_loading(at_ratio(context.scene("plastic-perfect"), RATIO), steps=3, unload=False)
    scene = resolved_at(scene, Resolution(7, 8))
    if model == SAM:
        scene = scene.model_copy(update={"friction": Friction(coefficient=FRICTION)})
    elastic = scene.model_copy(update={"body": scene.body.model_copy(update={"plasticity": None})})
    equal = dict.fromkeys(POWERS, 1.0)
    similar = equal | {"approach_m": 1 / BLUNTER, "peeq_max": 1 / BLUNTER}
    same = {name: 1.0 for name in POWERS if name != "peeq_max"}
    return [
        ("units", scene, scaled(scene, YOUNG_FACTOR, LENGTH_FACTOR), in_units(POWERS)),
        ("similarity", scene, blunter(scene, BLUNTER), similar),
        ("steps", with_loading(elastic, steps=1), with_loading(elastic, steps=7), same),
    ]


CASES = (
    Case(
        name="symmetries",
        title="Turned, moved, scaled",
        question="Does a contact turn, move and scale with its bodies, and forget the steps of an elastic load?",
        run=run,
        equations=(
            (
                "Similarity",
                "p(x/a) depends on E*a/(σ_y R) alone",
                "Johnson, Contact Mechanics (1985), section 6.3; strains ~ a/R",
            ),
        ),
    ),
)
