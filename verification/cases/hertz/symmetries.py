# SPDX-License-Identifier: MIT
"""What turns, moves and scales with a contact: each transformation solved both ways, and the largest
difference.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

import sam
from sam.contact import Contact, Counters, Search, solve_contact
from sam.grid import CellGrid
from sam.scene import Friction, Scene
from verification.cases.case import (
    SAM,
    Case,
    Context,
    Measured,
    SmallTable,
    with_body,
    with_keys,
    with_loading,
)
from verification.cases.hertz.invariances import (
    COUNTER,
    LENGTH_FACTOR,
    SHORT,
    YOUNG_FACTOR,
    differences,
    in_units,
    scaled,
)
from verification.cases.recipes import Resolution, at_ratio, resolved_at

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


def contact_of(gap: np.ndarray, h: tuple[float, float], force: float, coupling: float = 0.0) -> Contact:
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
    base, sliding = contact_of(gap, h, force), contact_of(gap, h, force, COUPLING)
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
        contact_of(place, h, force).pressure[window] for place, window in zip(places, windows, strict=True)
    )
    return {
        "translation": change(there, here),
        "mirror": change(contact_of(gap[::-1], h, force).pressure[::-1], base.pressure),
        "quarter-turn": change(
            contact_of(np.ascontiguousarray(gap.T), h[::-1], force).pressure.T, base.pressure
        ),
        "sliding-mirror": change(contact_of(gap[::-1], h, force, -COUPLING).pressure[::-1], sliding.pressure),
        "sliding-mirror-y": change(
            contact_of(gap[:, ::-1], h, force, COUPLING).pressure[:, ::-1], sliding.pressure
        ),
    }


def blunter(scene: Scene, factor: float) -> Scene:
    """Young's modulus and radius times a factor at equal force and yield stress: equal pressures, strains
    over the factor.

    For perfect plasticity (Johnson 1985, section 6.3: E* a/(sigma_y R) alone counts).
    """
    stiff = with_body(scene, young=scene.body.young * factor)
    return with_keys(stiff, "counterbody", radius=scene.counterbody.radius * factor)


@dataclass(frozen=True)
class Transformed:
    """A scene and its transform by one model: the largest difference, and the iterations of both."""

    model: str
    kind: str
    lost: float
    iterations: tuple[int, int]


@dataclass(frozen=True)
class Transformations:
    """grid: of the rough patch; rough: transformation of it -> change of the pressure; solved: the other
    scenes.
    """

    grid: CellGrid
    rough: dict[str, float]
    solved: list[Transformed]


class Symmetries(Case):
    """A rough patch turned and moved; yielding spheres in other units, blunter, and elastic ones by other
    steps.
    """

    def solve(self, context: Context) -> Transformations:
        scene = context.scene("rough-patch")
        grid = sam.choose_grid(scene)
        rough = turned(sam.plan(scene).problem(Counters()).gap(), (grid.hx, grid.hy), scene.loading.force)
        solved = []
        for model, name in SHORT.items():
            for kind, base, other, factors in scenes(context, model):
                first = context.solve(model, base, f"{name}-{kind}")
                second = context.solve(model, other, f"{name}-{kind}-changed")
                counts = tuple(each.cost[COUNTER[model]] for each in (first, second))
                solved.append(Transformed(model, kind, differences(first, second, factors), counts))
        return Transformations(grid, rough, solved)

    def measure(self, found: Transformations) -> dict[str, Measured | float]:
        values = dict(found.rough)
        for each in found.solved:
            name = f"{SHORT[each.model]}-{each.kind}"
            values[name] = each.lost
            if each.kind == "units":
                values[f"{name}-iterations"] = Measured(*reversed(each.iterations))
        return values

    def setup(self, found: Transformations) -> list[tuple[str, str]]:
        return [
            (
                "Rough patch",
                f"{found.grid.nx} × {found.grid.ny} cells, elastic, moved by {SHIFT} cells; sliding with 2βμ "
                f"= {COUPLING:g}",
            ),
            ("Yielding", f"perfectly plastic, p₀ = {RATIO:g} σ_y; in SAM sliding with μ = {FRICTION:g}"),
            ("Units", f"stresses times {YOUNG_FACTOR:g}, lengths times {LENGTH_FACTOR:g}"),
            ("Similarity", f"E and R times {BLUNTER:g}: equal pressures, strains and approach less by that"),
            ("Steps", "elastic, in one step and in seven"),
        ]

    def tables(self, found: Transformations) -> Iterator[SmallTable]:
        rows = [
            (f"rough patch, {name.replace('-', ' ')}", "SAM", "-", f"{value:.1e}")
            for name, value in found.rough.items()
        ]
        rows += [
            (e.kind.replace("-", " "), e.model, " / ".join(map(str, e.iterations)), f"{e.lost:.1e}")
            for e in found.solved
        ]
        yield SmallTable(
            "Largest change", ("transformation", "model", "iterations before / after", "difference"), rows
        )


def scenes(context: Context, model: str) -> list[tuple[str, Scene, Scene, dict[str, float]]]:
    """(name, scene, transformed scene, quantity -> its factor)."""
    scene = with_loading(at_ratio(context.scene("plastic-perfect"), RATIO), steps=3, unload=False)
    scene = resolved_at(scene, Resolution(7, 8))
    if model == SAM:
        scene = scene.model_copy(update={"friction": Friction(coefficient=FRICTION)})
    elastic = with_body(scene, plasticity=None)
    similar = dict.fromkeys(POWERS, 1.0) | {"approach_m": 1 / BLUNTER, "peeq_max": 1 / BLUNTER}
    same = {name: 1.0 for name in POWERS if name != "peeq_max"}
    return [
        ("units", scene, scaled(scene, YOUNG_FACTOR, LENGTH_FACTOR), in_units(POWERS)),
        ("similarity", scene, blunter(scene, BLUNTER), similar),
        ("steps", with_loading(elastic, steps=1), with_loading(elastic, steps=7), same),
    ]


CASES = (Symmetries(name="symmetries"),)
