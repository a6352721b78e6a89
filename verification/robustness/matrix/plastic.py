# SPDX-License-Identifier: MIT
"""Extremes of plasticity: near-perfect and perfect, p0/sigma_y0 from 0.5 to 15, steep and vanishing initial
yield, layers; back-stresses and traction that alternates; a sphere that grows inside the body.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from math import pi
from typing import Any

from sam.scene import Result, Scene, Status
from verification.robustness.matrix.checks import (
    as_other_model,
    balanced,
    hertz,
    residuals_hold,
    same_as,
    within_refinement,
    yields,
)
from verification.robustness.matrix.elastic import NO_FRICTION, UNTOUCHED
from verification.robustness.matrix.row import (
    FORCE,
    HERTZ,
    TOLERANCE,
    YOUNG,
    Absent,
    Deviation,
    Expectation,
    Refused,
    Right,
    Row,
    Trial,
    both,
    every,
    other,
)
from verification.runs.models import FEM, FEM_3D, SAM

P0 = 1.5 * FORCE / (pi * HERTZ**2)  # Hertz's largest pressure in Pa
STEPS = {"loading.steps": 15}
COARSE = "8 cells in the radius in both; the largest strain sits in a few of them"
NEAR = {"approach_m": 0.012, "p_center_Pa": 0.03, "contact_radius_m": 0.03, "peeq_max": 0.06}
SWIFT = {"law": "swift", "B": 945e6, "C": 4.0, "n": 0.121}
YIELDS_FAR = "everything within many radii yields"
AT_EDGE = Refused(YIELDS_FAR, ["grid.extent", "grid.depths"], Status.PLASTIC_ZONE_AT_GRID_EDGE)
OWN_PATH = "one return over the whole path, or many: backward Euler in time"
STRAINED = ("approach_m", "p_center_Pa", "peeq_max")
YIELD = P0 / 3
KEYS = "body.plasticity.kinematic"


def compared(bounds: Mapping[str, float] = NEAR, reason: str = COARSE) -> dict[str, Expectation]:
    """Each model with the other one."""
    words = "a convex problem: one stress, found by return mapping"
    sam = Right(words, [as_other_model(FEM, bounds, reason), balanced, residuals_hold, yields])
    return both(sam, Right(words, [as_other_model(SAM, bounds, reason), residuals_hold, yields]))


def material(**law: Any) -> dict[str, Any]:
    """A law of yield."""
    return {"body.plasticity": law}


def perfect(ratio: float) -> dict[str, Any]:
    """No hardening; p0/sigma_y0 = ratio."""
    return material(law="perfect", yield_stress=P0 / ratio)


def swift(**constants: Any) -> dict[str, Any]:
    """Swift's law with other constants, a layer or a profile."""
    return material(**SWIFT | constants)


def linear(yield_stress: float, modulus: float) -> dict[str, Any]:
    """Linear hardening, moduli in Pa."""
    return material(law="linear", yield_stress=yield_stress, modulus=modulus)


def rows() -> Iterator[Row]:
    """All of them."""
    yield from ratios()
    yield from chosen_grids()
    yield from laws()
    yield from layers()
    yield from steps_and_tolerances()


def wide(radii: float, cells: int, depth: float, thickness: float | None = None, *, even: int = 9) -> dict:
    """A grid over so many Hertz radii, its layers growing below the first `even`; their thickness, of a cell
    if None.
    """
    thickness, faces = thickness or radii * HERTZ / cells, [0.0]
    while faces[-1] < depth * HERTZ:
        faces.append(faces[-1] + thickness * max(1.0, 1.2 ** (len(faces) - even)))
    sides = radii * HERTZ, radii * HERTZ
    return {"grid": {"cells": (cells, cells), "extent": sides, "depths": tuple(faces)}}


def ratios() -> Iterator[Row]:
    """Extremes of the pressure over the yield stress."""
    below = both(Right("the largest stress is 0.62 p0: no yield below p0/σy = 1.61", [hertz(mises=0.015)]))
    for ratio in (0.5, 1.6):
        changes = perfect(ratio) | {"loading.steps": 2}
        yield Row(f"perfect-{ratio:g}", "p0/yield", f"perfect, p0/σy = {ratio:g}", changes, below)
    for ratio in (1.8, 3.0, 6.2):
        expected = compared(NEAR | {"peeq_max": 0.15} if ratio < 2 else NEAR)
        name, what = f"perfect-{ratio:g}", f"perfect, p0/σy = {ratio:g}, 15 steps"
        yield Row(name, "p0/yield", what, perfect(ratio) | STEPS, expected, quick=ratio == 3.0)
    what, nearly = "nearly perfect: modulus 1 MPa, p0/σy = 6.2", linear(P0 / 6.2, 1e6) | STEPS
    yield Row("nearly-perfect-6.2", "perfect", what, nearly, compared())
    far = {"approach_m": 0.03, "p_center_Pa": 0.04, "contact_radius_m": 0.06}
    expected = compared(far, "4 cells in the Hertz radius, 7 in the contact")
    what, changes = "perfect, p0/σy = 15, a grid of 12 radii", perfect(15.0) | STEPS
    yield Row("perfect-15", "p0/yield", what, changes | wide(12, 49, 8), expected)
    beside = Refused(YIELDS_FAR, ["beside the contact", "grid.extent"], Status.PLASTIC_ZONE_AT_GRID_EDGE)
    expected = both(beside, Right("the same mesh as above", [residuals_hold, yields]))
    changes |= {"grid": {"cells": (33, 33), "extent": (4 * HERTZ, 4 * HERTZ)}}
    yield Row("perfect-15-small-grid", "p0/yield", "the same, a grid of 4 radii", changes, expected)


def larger_cells(scene: Scene, fine: Result) -> Scene:
    """The scene on the same sides of the grid in cells 1.5 times as large."""
    cells, sides = fine.discretisation["cells"], fine.discretisation["cell_m"]
    fewer = tuple(2 * round(n / 3) + 1 for n in cells)
    extent = tuple(n * h for n, h in zip(cells, sides, strict=True))
    return other(scene, {"grid": {"cells": fewer, "extent": extent}})


def larger_elements(scene: Scene, fine: Result) -> Scene:
    """The scene with elements 1.5 times as large."""
    return other(scene, {"fem.cells_per_radius": round(scene.fem.cells_per_radius / 1.5)})


def chosen_grids() -> Iterator[Row]:
    """Plastic zones that leave a grid of four Hertz radii: without [grid] the program chooses one that holds
    them.

    The largest strain lies beside the edge of the contact, next to the surface, where both models refine
    slowly: from 16 to 24 elements in the radius FEM falls by 4 % (perfect, p0/sigma_y = 10) to 11 % (8.1),
    SAM from 10 to 16 cells by 2 %, and it rises by 3 % from 24 to 96 steps (2 % hardening, 10). So the bound
    on it is no estimate of the error of one model; without hardening it is the refinement uncertainty of
    both.
    """
    near = {"approach_m": 0.01, "p_center_Pa": 0.04, "contact_radius_m": 0.02}
    reason = "16 cells in the radius of SAM, 24 elements of FEM, 24 steps; see chosen_grids"
    coarser = {SAM: larger_cells, FEM: larger_elements}
    refined = {
        model: replace(right, checks=[*right.checks, within_refinement(twin, "peeq_max", coarser)])
        for (model, right), twin in zip(compared(near, reason).items(), (FEM, SAM), strict=True)
    }
    hardening, modulus = compared(near | {"peeq_max": 0.06}, reason), 0.02 * YOUNG / 0.98
    for kind, what, ratio, law, expected in (
        ("hardening", "2 % hardening", 8.0, linear(P0 / 8.0, modulus), hardening),
        ("hardening", "2 % hardening", 10.0, linear(P0 / 10.0, modulus), hardening),
        ("perfect", "perfect", 7.5, perfect(7.5), refined),
        ("perfect", "perfect", 10.0, perfect(10.0), refined),
    ):
        changes = law | {"grid": None, "fem.cells_per_radius": 24, "loading.steps": 24}
        name, what = f"{kind}-{ratio:g}-chosen-grid", f"{what}, p0/σy = {ratio:g}, no [grid]"
        yield Row(name, "p0/yield", what, changes, expected)


def laws() -> Iterator[Row]:
    """Extremes of the hardening laws: Swift's with ever smaller C, whose slope at zero strain grows without
    bound, and laws that hardly yield or never harden; materials and loads at their limits.
    """
    near = {"approach_m": 0.01, "p_center_Pa": 0.03, "contact_radius_m": 0.04, "peeq_max": 0.08}
    far = compared(near, "4 cells in the radius of SAM")
    box = Refused(YIELDS_FAR, ["fem.box"], Status.PLASTIC_ZONE_AT_GRID_EDGE)
    reason = "the strains at which the curves differ are far below those under the contact"
    limit = same_as({"body.plasticity.C": 1e-3}, 0.005, reason, STRAINED)
    limit = both(AT_EDGE, Right("the limit C -> 0 of the curve exists", [limit, residuals_hold]))
    zero = both(Refused("an infinite slope", ["body.plasticity.C", "1e-15 to 1e+15"]))
    near_elastic = both(Right("so stiff that it stays elastic", [hertz(mises=0.015)]))
    volume = "elastic strain cannot change the volume, nor can plastic strain"
    half = every(Refused(volume, ["body.poisson", "less than 0.5"]))
    two, five, ten = ({"loading.steps": steps} for steps in (2, 5, 10))
    c_3, c_15 = swift(C=1e-3) | five, swift(C=1e-15) | five
    beyond = perfect(1e3) | two | {"solver.beyond_model": True}
    too_far = both(AT_EDGE, Refused(YIELDS_FAR, ["fem.box"]))
    stiff = linear(P0 / 6.2, 1e6 * YOUNG) | two
    poisson = {nu: swift() | {"body.poisson": nu} for nu in (0, 0.4999, 0.5)}
    steep = "Swift, C = 1e-3: p0/σy0 = 14, 52000 TPa; a grid of 12 radii"
    words = "Swift, C = {:g}: a slope of {} TPa at zero strain"
    for name, topic, what, changes, expected in (
        ("swift-C-20", "swift", words.format(20, 8), swift(C=20.0) | ten, compared()),
        ("swift-C-4", "swift", words.format(4, 34), swift() | ten, compared()),
        ("swift-C-1e-3", "C -> 0", steep, c_3 | wide(12, 49, 8), far),
        ("swift-C-1e-15", "C -> 0", "Swift, C = 1e-15: p0/σy0 = 390", c_15, both(AT_EDGE, box)),
        ("swift-C-1e-15-box", "C -> 0", "the same, a box of 40 radii", c_15 | {"fem.box": 40.0}, limit),
        ("swift-C-0", "C -> 0", "Swift, C = 0", swift(C=0.0), zero),
        ("linear-stiff", "stiff", "linear hardening of 1e6 E: elastic in the limit", stiff, near_elastic),
        ("perfect-1000", "p0/yield", "perfect, p0/σy = 1000", beyond, too_far),
        ("plastic-poisson-0.5", "poisson", "ν = 0.5 and plastic", poisson[0.5], half),
        ("plastic-poisson-0", "poisson", "ν = 0 and plastic", poisson[0] | five, compared()),
        ("plastic-poisson-0.4999", "poisson", "ν = 0.4999 and plastic", poisson[0.4999] | five, compared()),
        ("plastic-force-0", "force", "0 N and plastic", swift() | {"loading.force": 0.0}, both(UNTOUCHED)),
    ):
        yield Row(name, topic, what, changes, expected, quick=name == "swift-C-4")


def profile(factor: float, thickness: float) -> tuple[tuple[float, float], ...]:
    """Profile of a layer of so many Hertz radii, with a transition half as thick below it."""
    return (thickness * HERTZ, factor), (1.5 * thickness * HERTZ, 1.0)


def layers() -> Iterator[Row]:
    """A layer with a tenth of the yield stress on a body that stays elastic; one with ten times that of a
    body that yields; a weak one on a body that yields too, p0 some forty times its yield stress.

    The largest strains of both models agree within 0.4 % at equal depths on grids and meshes graded towards
    the kink of the yield stress: at the bottom of a thin weak layer, or below a hard one, the strain is
    largest just there.
    """
    near = {"approach_m": 0.01, "p_center_Pa": 0.03, "contact_radius_m": 0.03}
    weak, strong = "SAM 0.9 % below the limit, FEM 0.3 % above", "SAM 0.7 % and FEM 0.3 % below the limit"
    kink = "taken 0.01 radii above the kink, SAM 2.3 % and FEM 1.4 % below the limit at the kink itself"
    thin = wide(5, 49, 5, 0.025 * HERTZ, even=18)  # faces at 0.3 and 0.45 radii, where the mesh has lines too
    for name, factor, strength, thickness, peeq, reason, grid in (
        ("0.1", 0.1, 9450e6, 1.0, 0.02, weak, wide(5, 49, 5, 0.1 * HERTZ)),
        ("10", 10.0, 945e6, 0.3, 0.02, strong, wide(5, 49, 5, 0.05 * HERTZ)),
        ("0.1-thin", 0.1, 9450e6, 0.3, 0.03, kink, thin | {"fem.cells_per_radius": 20}),
    ):
        changes = swift(C=20.0, B=strength, profile=profile(factor, thickness)) | {"loading.steps": 10} | grid
        what = f"a layer with {factor:g} times the yield stress, {thickness:g} radii thick"
        words = f"8 to 10 cells in the radius; the largest strain: {reason}"
        yield Row(f"layer-{name}", "layer", what, changes, compared(near | {"peeq_max": peeq}, words))
    twin = same_as({"loading.steps": 20}, 0.005, OWN_PATH, STRAINED)
    why = "steps are cut, and begun with the nodes in contact of the last one"
    sheet = Absent("it shears in a sheet at its lower side that no layers of an affordable number resolve")
    what = "a layer with 0.1 times the yield stress that is squeezed out, 0.3 radii thick"
    changes = {"loading.steps": 10, "fem.cells_per_radius": 5, "fem.box": 10.0}
    changes |= swift(C=20.0, profile=profile(0.1, 0.3))
    expected = both(sheet, Right(why, [twin, residuals_hold, yields]))
    yield Row("layer-0.1-squeezed", "layer", what, changes, expected)
    hard = {"law": "perfect", "yield_stress": P0 / 2.0}
    changes = swift(C=20.0, layer_thickness=0.3 * HERTZ, layer=hard) | wide(5, 49, 5, 0.05 * HERTZ)
    what = "a layer that never hardens on a Swift body, 0.3 radii thick"
    expected = compared(near | {"peeq_max": 0.03}, "10 cells in the radius")
    yield Row("layer-perfect", "layer", what, changes | {"loading.steps": 5}, expected)


def steps_and_tolerances() -> Iterator[Row]:
    """Extremes of the number of load steps and of the tolerance."""
    twin = same_as({"loading.steps": 10}, 0.03, OWN_PATH, STRAINED)
    right = both(Right("backward Euler is stable for any step", [twin, residuals_hold, yields]))
    for steps in (1, 200):
        changes = swift(C=20.0) | {"loading.steps": steps}
        yield Row(f"plastic-steps-{steps}", "steps", f"{steps} steps, Swift", changes, right)
    twin = same_as(STEPS, 0.05, OWN_PATH, ("approach_m", "contact_radius_m"))
    right = both(Right("backward Euler, steps cut where needed", [twin, residuals_hold, yields]))
    what, changes = "1 step, perfect, p0/σy = 6.2", perfect(6.2) | {"loading.steps": 1}
    yield Row("perfect-6.2-steps-1", "steps", what, changes, right)
    names, reason = ("approach_m", "p_center_Pa"), "of the coarser tolerance ten times"
    for tolerance, bound in ((1e-3, 1e-2), (1e-9, 1e-5), (1e-12, 1e-5)):
        twin = same_as({"solver.tolerance": 1e-6}, bound, reason, names)
        right = both(Right("a tolerance above rounding can be met", [twin, residuals_hold]))
        name, what = f"plastic-tolerance-{tolerance:g}", f"Swift, solver.tolerance = {tolerance:g}"
        changes = swift(C=20.0) | {"loading.steps": 3, "solver.tolerance": tolerance}
        yield Row(name, "tolerance", what, changes, right)


def kinematic(*, share: float = 1.0, **constants: Any) -> dict[str, Any]:
    """Perfect plasticity with back-stresses. share: of the yield stress."""
    found = {"law": "perfect", "yield_stress": share * YIELD}
    return {"body.plasticity": found | ({"kinematic": constants} if constants else {})}


def back_stresses() -> Iterator[Row]:
    """Laws that are another law in the limit; constants that are none; a method without back-stresses."""

    def twin(reason: str, as_what: str, bound: float, **constants: Any) -> Right:
        return Right(as_what, [same_as(kinematic(**constants), bound, reason, STRAINED)])

    stiff = Right("so stiff that it stays elastic", [hertz(mises=0.015)])
    reason = "a back-stress of 1e-9 yield stresses; both within their tolerance"
    none = Right("as without", [*twin(reason, "", 1e-5).checks, yields])
    reason = "saturated after a strain of 1e-6 at a fifth of the yield stress"
    higher = twin(reason, "a higher yield stress", 0.01, share=1.2)
    reason, once = "equal ones add: rounding and tolerance", {"modulus": (8e9,), "recovery": (300.0,)}
    sums = twin(reason, "one with the sum of the moduli", 1e-5, **once)
    saturated = kinematic(modulus=(0.2 * YIELD * 1e6,), recovery=(1e6,))
    eight = kinematic(modulus=(1e9,) * 8, recovery=(300.0,) * 8)
    three = kinematic(modulus=(400e9, 60e9, 6e9), recovery=(2000.0, 300.0, 0.0))
    three |= {"loading.steps": 10, "loading.unload": True, "loading.cycles": 2}
    paper = both(Refused("the loops of the paper have no back-stress", ["solver.method"]))
    method, one = {"solver.method": "paper"}, {"modulus": (1e9,)}

    def wrong(*words: str, **constants: Any) -> tuple[dict, dict]:
        return kinematic(**constants), every(Refused("no such law", words))

    limit = "a back-stress with a modulus of 1e6 E: elastic in the limit"
    for name, what, changes, expected in (
        ("stiff", limit, kinematic(modulus=(1e6 * YOUNG,)), both(stiff)),
        ("vanishing", "a modulus of 1 Pa", kinematic(modulus=(1.0,)), both(none)),
        ("saturated", "C/g = σy/5, g = 1e6", saturated, both(higher)),
        ("eight", "eight equal back-stresses", eight, both(sums)),
        ("three", "three back-stresses, two cycles of 10 steps", three, compared()),
        ("modulus-0", "modulus 0", *wrong(f"{KEYS}.modulus", modulus=(0.0,))),
        ("recovery-1e8", "recovery 1e8", *wrong(f"{KEYS}.recovery", **one, recovery=(1e8,))),
        ("nine", "nine", *wrong(f"{KEYS}.modulus", "8", modulus=(1e9,) * 9)),
        ("lengths", "lengths", *wrong(f"{KEYS}.recovery", **one, recovery=(1.0, 2.0))),
        ("paper", "the loops of the paper", kinematic(**one) | method, paper),
    ):
        changes = {"loading.steps": 5} | changes
        yield Row(f"back-{name}", "back-stress", what, changes, expected, quick=name == "vanishing")
    yield from alternating()


def alternating() -> Iterator[Row]:
    """Traction in place whose sign changes from cycle to cycle."""
    h = HERTZ / 8
    given = kinematic(share=1e9 / YIELD, modulus=(0.05 * YOUNG,)) | {
        "friction": {"coefficient": 0.2, "direction": "alternating"},
        "counterbody": None,
        "loading": {"prescribed": "hertz", "radius": HERTZ, "steps": 3, "unload": True, "cycles": 4},
        "fem.cells_per_radius": 4,
        "fem.box": 4.0,
        "grid": {"cells": (33, 33), "extent": (33 * h, 33 * h), "depths": tuple(h * k for k in range(19))},
    }
    near = {"peeq_max": 0.15, "residual_uz_center_m": 0.15}
    reason = "cells of a/8, elements of a/4 in a box of 4 a; both err by some per cent, to opposite sides"
    for name, p0 in (("elastic", 1e9), ("flows", 3.4e9)):
        checks = [
            [signs, *([yields, as_other_model(twin, near, reason)] if name == "flows" else [])]
            for twin in (FEM_3D, SAM)
        ]
        sam, spatial = (Right("one convex problem a step", own) for own in checks)
        what = f"traction that alternates, p given, p₀ = {p0 / 1e9:g} GPa"
        changes, expected = given | {"loading.p0": p0}, both(sam, NO_FRICTION, spatial)
        yield Row(f"alternating-{name}", "alternating", what, changes, expected, quick=name == "elastic")


def signs(trial: Trial) -> Iterator[Deviation]:
    """The coefficient of friction is never negative; the sign of the traction is a column of its own."""
    cycles, mu = trial.result.tables["cycles"], trial.scene.friction.coefficient
    for k, found in enumerate(cycles["friction_coefficient"], start=1):
        yield Deviation(f"coefficient of cycle {k}", abs(found - mu), 1e-9, "q = mu p: rounding")
    wanted = [1, -1] * (len(cycles["cycle"]) // 2)
    wrong = float(list(cycles.get("friction_sign", [])) != wanted)
    yield Deviation("sign of the traction by cycle", wrong, 0.5, "+x in odd cycles, -x in even ones")


def misfits() -> Iterator[Row]:
    """A sphere that grows inside the body: next to nothing and without end, deep and close to the surface."""
    given = {"prescribed": "misfit-sphere", "radius": 4e-6, "misfit": 0.02, "steps": 1}
    law = {"law": "linear", "yield_stress": 1e9, "modulus": 10e9}
    base = {"counterbody": None, "grid": None, "body.plasticity": law}
    spatial = {FEM_3D: Refused("it has no misfit strain", ["loading.prescribed", "axisymmetric"])}
    near, reason = {"peeq_max": 0.1, "mises_max_Pa": 0.02}, "8 cells and elements in the radius of the sphere"
    strained = {
        model: Right("one plastic strain", [as_other_model(twin, near, reason), residuals_hold, yields])
        for model, twin in ((SAM, FEM), (FEM, SAM))
    }
    unstrained = both(Right("a millionth of the strain of first yield", [stays_elastic]))
    held = {"depth": 6e-6, "misfit": 0.5, "surface": "held"}
    reaches = both(Refused("the plastic zone reaches the held surface", ["loading.depth"]))
    for name, what, keys, expected in (
        ("deep", "the centre at ten radii", {"depth": 40e-6}, strained),
        ("close", "the centre at 1.01 radii", {"depth": 4.04e-6}, strained),
        ("nothing", "misfit 1e-9: nothing yields", {"depth": 6e-6, "misfit": 1e-9}, unstrained),
        ("held", "misfit 0.5, held", held, reaches),
    ):
        changes = base | {"loading": given | keys}
        yield Row(f"misfit-{name}", "misfit", what, changes, expected | spatial, quick=name == "deep")


def stays_elastic(trial: Trial) -> Iterator[Deviation]:
    """The largest von Mises stress of the elastic sphere, 0.28 E e/(1 - nu) but for the image."""
    body, misfit = trial.scene.body, trial.scene.loading.misfit
    exact = 0.28 * body.young * misfit / (1.0 - body.poisson)
    off = abs(trial.quantities["mises_max_Pa"] / exact - 1.0)
    yield Deviation("largest von Mises stress", off, 0.05, "8 cells in the radius, and the free surface")
    yield Deviation("plastic strain", trial.quantities["peeq_max"], 1e-15, TOLERANCE)
