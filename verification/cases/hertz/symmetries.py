# SPDX-License-Identifier: MIT
"""Contacts in other units, of similar bodies and in other load steps: each pair solved, and compared."""

from collections.abc import Iterator

from sam.scene import Friction, Scene
from verification.cases.case import FEM, SAM, Context, with_body, with_grid, with_keys, with_loading
from verification.cases.recipes import Resolution, at_ratio, resolved_at

STRESS, LENGTH = 7.3e-5, 3.1e4  # new units: no powers of two or ten, rounding differs everywhere
BLUNTER, RATIO, FRICTION = 2.7, 4.0, 0.2
POWERS = {"p_max_Pa": (1, 0), "mises_max_Pa": (1, 0), "approach_m": (0, 1), "contact_area_m2": (0, 2)} | {
    "peeq_max": (0, 0)
}
"""Quantity -> its powers of stress and length."""
COUNTER = {SAM: "contact_iterations", FEM: "newton_iterations"}


def in_units(scene: Scene) -> Scene:
    """The same problem with stresses and lengths in other units."""
    body, grid, other = scene.body, scene.grid, scene.counterbody
    law = body.plasticity.model_copy(update={"yield_stress": body.plasticity.yield_stress * STRESS})
    scene = with_body(scene, young=body.young * STRESS, plasticity=law)
    scene = with_keys(scene, "counterbody", radius=other.radius * LENGTH)
    scene = with_loading(scene, force=scene.loading.force * STRESS * LENGTH**2)
    lengths = {name: tuple(each * LENGTH for each in getattr(grid, name)) for name in ("extent", "depths")}
    return with_grid(scene, **lengths)


def blunter(scene: Scene) -> Scene:
    """Young's modulus and radius times a factor at equal force and yield stress: equal pressures, strains
    over the factor, without hardening (Johnson 1985, section 6.3: E* a/(sigma_y R) alone counts).
    """
    stiff = with_body(scene, young=scene.body.young * BLUNTER)
    return with_keys(stiff, "counterbody", radius=scene.counterbody.radius * BLUNTER)


def frame(context: Context) -> Iterator[dict[str, object]]:
    """The largest relative difference of the quantities of each pair, over their factors, by each model."""
    for model, name in ((SAM, "sam"), (FEM, "fem")):
        for kind, base, other, factors in pairs(context, model):
            label = f"{name}-{kind}"
            first, second = context.solve(model, base, label), context.solve(model, other, f"{label}-changed")
            shares = (second.quantities[of] / by / first.quantities[of] for of, by in factors.items())
            row = {"kind": kind, "model": name, "difference": max(abs(share - 1.0) for share in shares)}
            before, after = (each.cost[COUNTER[model]] for each in (first, second))
            yield row | {"iterations": after, "iterations expected": before}


def pairs(context: Context, model: str) -> list[tuple[str, Scene, Scene, dict[str, float]]]:
    """(name, scene, changed scene, quantity -> its factor)."""
    scene = with_loading(at_ratio(context.scene("plastic-perfect"), RATIO), steps=3, unload=False)
    scene = resolved_at(scene, Resolution(7, 8))
    if model == SAM:
        scene = scene.model_copy(update={"friction": Friction(coefficient=FRICTION)})
    elastic = with_body(scene, plasticity=None)
    units = {name: STRESS**p * LENGTH**q for name, (p, q) in POWERS.items()}
    similar = dict.fromkeys(POWERS, 1.0) | {"approach_m": 1 / BLUNTER, "peeq_max": 1 / BLUNTER}
    same = {name: 1.0 for name in POWERS if name != "peeq_max"}
    return [
        ("units", scene, in_units(scene), units),
        ("similarity", scene, blunter(scene), similar),
        ("steps", with_loading(elastic, steps=1), with_loading(elastic, steps=7), same),
    ]
