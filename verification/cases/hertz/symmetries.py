# SPDX-License-Identifier: MIT
"""What turns, moves and scales with a contact, other units among it: each transformation solved both ways,
and the largest difference.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

import sam
from sam.contact import Contact, Counters, Search, solve_contact
from sam.scene import Friction, Result, Scene
from verification.cases.case import FEM, SAM, Context, with_body, with_grid, with_keys, with_loading
from verification.cases.recipes import Resolution, at_ratio, resolved_at

YOUNG_FACTOR, LENGTH_FACTOR = 7.3e-5, 3.1e4  # no powers of two or ten: rounding differs everywhere
MODULUS, TOLERANCE, COUPLING = 230e9, 1e-11, 0.1  # of the rough contacts; coupling: 2 beta mu
SHIFT = (7, -12)  # cells
BLUNTER, RATIO, FRICTION = 2.7, 4.0, 0.2
POWERS = {"p_max_Pa": (1, 0), "mises_max_Pa": (1, 0), "approach_m": (0, 1), "contact_area_m2": (0, 2)} | {
    "peeq_max": (0, 0)
}
"""Quantity -> its powers of stress and length."""
STRESSES = ("young", "B", "yield_stress", "modulus")
COUNTER = {SAM: "contact_iterations", FEM: "newton_iterations"}
SHORT = {SAM: "sam", FEM: "fem"}


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


def differences(base: Result, other: Result, factors: Mapping[str, float]) -> float:
    """Largest relative difference of the quantities, after division by their factors."""
    pairs = ((base.quantities[name], other.quantities[name] / factor) for name, factor in factors.items())
    return max(abs(found / expected - 1.0) for expected, found in pairs)


def compared(context: Context, model: str, pair: tuple[str, Scene, Scene, Mapping[str, float]]) -> dict:
    """The largest difference of what `scenes` returns by one model, and the iterations of both."""
    kind, base, other, factors = pair
    label = f"{SHORT[model]}-{kind}"
    results = context.solve(model, base, label), context.solve(model, other, f"{label}-changed")
    first, second = (result.cost[COUNTER[model]] for result in results)
    return {
        "kind": kind,
        "model": SHORT[model],
        "difference": differences(*results, factors),
        "iterations": second,
        "iterations expected": first,
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


def transformed(context: Context) -> Iterator[dict[str, object]]:
    """A rough patch turned and moved; yielding spheres in other units, blunter, and elastic ones by other
    steps.
    """
    scene = context.scene("rough-patch")
    grid = sam.choose_grid(scene)
    rough = turned(sam.plan(scene).problem(Counters()).gap(), (grid.hx, grid.hy), scene.loading.force)
    for kind, value in rough.items():
        yield {"kind": kind, "model": "sam", "difference": value}
    for model in SHORT:
        yield from (compared(context, model, pair) for pair in scenes(context, model))


def scenes(context: Context, model: str) -> list[tuple[str, Scene, Scene, dict[str, float]]]:
    """(name, scene, transformed scene, quantity -> its factor)."""
    scene = with_loading(at_ratio(context.scene("plastic-perfect"), RATIO), steps=3, unload=False)
    scene = resolved_at(scene, Resolution(7, 8))
    if model == SAM:
        scene = scene.model_copy(update={"friction": Friction(coefficient=FRICTION)})
    elastic = with_body(scene, plasticity=None)
    similar = dict.fromkeys(POWERS, 1.0) | {"approach_m": 1 / BLUNTER, "peeq_max": 1 / BLUNTER}
    in_units = {name: YOUNG_FACTOR**p * LENGTH_FACTOR**q for name, (p, q) in POWERS.items()}
    same = {name: 1.0 for name in POWERS if name != "peeq_max"}
    return [
        ("units", scene, scaled(scene, YOUNG_FACTOR, LENGTH_FACTOR), in_units),
        ("similarity", scene, blunter(scene, BLUNTER), similar),
        ("steps", with_loading(elastic, steps=1), with_loading(elastic, steps=7), same),
    ]
