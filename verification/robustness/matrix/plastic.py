# SPDX-License-Identifier: MIT
"""Extremes of plasticity: near-perfect and perfect, p0/sigma_y0 from 0.5 to 15, steep and vanishing initial
yield, layers.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import partial
from math import pi

from sam.scene import Result, Scene, Status
from verification.robustness.matrix.checks import (
    as_other_model,
    balanced,
    hertz,
    nothing_touches,
    same_as,
    within_refinement,
)
from verification.robustness.matrix.elastic import both
from verification.robustness.matrix.row import (
    TOLERANCE,
    Absent,
    Deviation,
    Expectation,
    Refused,
    Right,
    Row,
    Trial,
)
from verification.robustness.matrix.scenes import FORCE, HERTZ, YOUNG, other, scene_with
from verification.runs.models import FEM, SAM

P0 = 1.5 * FORCE / (pi * HERTZ**2)  # Hertz's largest pressure in Pa
STEPS = 15
COARSE = "8 cells in the radius in both; the largest strain sits in a few of them"
NEAR = {"approach_m": 0.012, "p_center_Pa": 0.03, "contact_radius_m": 0.03, "peeq_max": 0.06}
SWIFT = {"law": "swift", "B": 945e6, "C": 4.0, "n": 0.121}
YIELDS_FAR = "everything within many radii yields"
AT_EDGE = Refused(YIELDS_FAR, ["grid.extent", "grid.depths"], Status.PLASTIC_ZONE_AT_GRID_EDGE)
OWN_PATH = "one return over the whole path, or many: backward Euler in time"


def residuals_hold(trial: Trial) -> Iterator[Deviation]:
    """No stress beyond yield, and the flow rule, on the returned fields."""
    for name in ("yield_excess", "flow_residual"):
        if name in trial.result.certificate:
            yield Deviation(name, trial.result.certificate[name], trial.scene.solver.tolerance, TOLERANCE)


def yields(trial: Trial) -> Iterator[Deviation]:
    """The extreme is one: there is plastic strain."""
    yield Deviation(
        "no plastic strain", float(not trial.quantities["peeq_max"] > 0.0), 0.5, "or the row tests nothing"
    )


def compared(bounds: Mapping[str, float] = NEAR, reason: str = COARSE) -> Mapping[str, Right]:
    """Each model with the other one."""
    words = "a convex problem: one stress, found by return mapping"
    return {
        SAM: Right(words, [as_other_model(FEM, bounds, reason), balanced, residuals_hold, yields]),
        FEM: Right(words, [as_other_model(SAM, bounds, reason), residuals_hold, yields]),
    }


def row(
    name: str,
    topic: str,
    what: str,
    law: Mapping,
    *,
    expected: Mapping[str, Expectation],
    quick=False,
    **changes,
) -> Row:
    """The base with a law of yield. changes: other keys, with __ for the dot."""
    dotted = {key.replace("__", "."): value for key, value in changes.items()}
    return Row(name, topic, what, partial(scene_with, {"body.plasticity": law} | dotted), expected, quick)


def perfect(ratio: float) -> dict:
    """No hardening; p0/sigma_y0 = ratio."""
    return {"law": "perfect", "yield_stress": P0 / ratio}


def rows() -> Iterator[Row]:
    """All of them."""
    yield from ratios()
    yield from chosen_grids()
    yield from laws()
    yield from layers()
    yield from steps_and_tolerances()


def wide(radii: float, cells: int, depth: float, thickness: float | None = None, *, even: int = 9) -> dict:
    """Keys of a grid over so many Hertz radii, its layers growing below the first `even`; their thickness, of
    a cell if None.
    """
    thickness, faces = thickness or radii * HERTZ / cells, [0.0]
    while faces[-1] < depth * HERTZ:
        faces.append(faces[-1] + thickness * max(1.0, 1.2 ** (len(faces) - even)))
    return {"cells": (cells, cells), "extent": (radii * HERTZ, radii * HERTZ), "depths": tuple(faces)}


def ratios() -> Iterator[Row]:
    """Extremes of the pressure over the yield stress."""
    below = Right("the largest stress is 0.62 p0: no yield below p0/σy = 1.61", [hertz(mises=0.015)])
    for ratio in (0.5, 1.6):
        yield row(
            f"perfect-{ratio:g}",
            "p0/yield",
            f"perfect, p0/σy = {ratio:g}",
            perfect(ratio),
            expected=both(below),
            loading__steps=2,
        )
    for ratio in (1.8, 3.0, 6.2):
        what = f"perfect, p0/σy = {ratio:g}, {STEPS} steps"
        near = NEAR | {"peeq_max": 0.15} if ratio < 2 else NEAR
        yield row(
            f"perfect-{ratio:g}",
            "p0/yield",
            what,
            perfect(ratio),
            expected=compared(near),
            quick=ratio == 3.0,
            loading__steps=STEPS,
        )
    nearly = {"law": "linear", "yield_stress": P0 / 6.2, "modulus": 1e6}
    what = "nearly perfect: modulus 1 MPa, p0/σy = 6.2"
    yield row("nearly-perfect-6.2", "perfect", what, nearly, expected=compared(), loading__steps=STEPS)
    far = {"approach_m": 0.03, "p_center_Pa": 0.04, "contact_radius_m": 0.06}
    grid = wide(12, 49, 8)
    expected = compared(far, "4 cells in the Hertz radius, 7 in the contact")
    what = "perfect, p0/σy = 15, a grid of 12 radii"
    yield row(
        "perfect-15", "p0/yield", what, perfect(15.0), expected=expected, loading__steps=STEPS, grid=grid
    )
    beside = Refused(YIELDS_FAR, ["beside the contact", "grid.extent"], Status.PLASTIC_ZONE_AT_GRID_EDGE)
    expected = {SAM: beside, FEM: Right("the same mesh as above", [residuals_hold, yields])}
    small = {"cells": (33, 33), "extent": (4 * HERTZ, 4 * HERTZ)}
    what = "the same, a grid of 4 radii"
    yield row(
        "perfect-15-small-grid",
        "p0/yield",
        what,
        perfect(15.0),
        expected=expected,
        loading__steps=STEPS,
        grid=small,
    )


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
    changes = {"grid": None, "fem__cells_per_radius": 24, "loading__steps": 24}
    for ratio in (8.0, 10.0):
        law = {"law": "linear", "yield_stress": P0 / ratio, "modulus": 0.02 * YOUNG / 0.98}
        expected = compared(near | {"peeq_max": 0.06}, reason)
        words = f"2 % hardening, p0/σy = {ratio:g}, no [grid]"
        yield row(f"hardening-{ratio:g}-chosen-grid", "p0/yield", words, law, expected=expected, **changes)
    for ratio in (7.5, 10.0):
        expected = {
            model: replace(right, checks=[*right.checks, within_refinement(twin, "peeq_max", coarser)])
            for (model, right), twin in zip(compared(near, reason).items(), (FEM, SAM), strict=True)
        }
        words, law = f"perfect, p0/σy = {ratio:g}, no [grid]", perfect(ratio)
        yield row(f"perfect-{ratio:g}-chosen-grid", "p0/yield", words, law, expected=expected, **changes)


def laws() -> Iterator[Row]:
    """Extremes of the hardening laws."""
    yield from _steep_laws()
    yield from _other_laws()


def _steep_laws() -> Iterator[Row]:
    """Swift's law with ever smaller C, whose slope at zero strain grows without bound."""
    for c in (20.0, 4.0):
        law = SWIFT | {"C": c}
        slope = law["B"] * law["n"] * 1e6 * c ** (law["n"] - 1) / 1e12
        what = f"Swift, C = {c:g}: a slope of {slope:.0f} TPa at zero strain"
        yield row(
            f"swift-C-{c:g}", "swift", what, law, expected=compared(), quick=c == 4.0, loading__steps=10
        )
    grid, what = wide(12, 49, 8), "Swift, C = 1e-3: p0/σy0 = 14, 52000 TPa; a grid of 12 radii"
    near = {"approach_m": 0.01, "p_center_Pa": 0.03, "contact_radius_m": 0.04, "peeq_max": 0.08}
    law = SWIFT | {"C": 1e-3}
    yield row(
        "swift-C-1e-3",
        "C -> 0",
        what,
        law,
        expected=compared(near, "4 cells in the radius of SAM"),
        loading__steps=5,
        grid=grid,
    )
    vanishing = SWIFT | {"C": 1e-15}
    box = Refused(YIELDS_FAR, ["fem.box"], Status.PLASTIC_ZONE_AT_GRID_EDGE)
    yield row(
        "swift-C-1e-15",
        "C -> 0",
        "Swift, C = 1e-15: p0/σy0 = 390",
        vanishing,
        expected=both(AT_EDGE, box),
        loading__steps=5,
    )
    what, reason = (
        "the same, a box of 40 radii",
        "the strains at which the curves differ are far below those under the contact",
    )
    limit = same_as({"body.plasticity.C": 1e-3}, 0.005, reason, ("approach_m", "p_center_Pa", "peeq_max"))
    expected = both(AT_EDGE, Right("the limit C -> 0 of the curve exists", [limit, residuals_hold]))
    yield row(
        "swift-C-1e-15-box", "C -> 0", what, vanishing, expected=expected, loading__steps=5, fem__box=40.0
    )
    zero = Refused("an infinite slope", ["body.plasticity.C", "1e-15 to 1e+15"])
    yield row("swift-C-0", "C -> 0", "Swift, C = 0", SWIFT | {"C": 0.0}, expected=both(zero))


def _other_laws() -> Iterator[Row]:
    """Laws that hardly yield or never harden, and materials and loads at their limits."""
    stiff = {"law": "linear", "yield_stress": P0 / 6.2, "modulus": 1e6 * YOUNG}
    near_elastic = Right("so stiff that it stays elastic", [hertz(mises=0.015)])
    what = "linear hardening of 1e6 E: elastic in the limit"
    yield row("linear-stiff", "stiff", what, stiff, expected=both(near_elastic), loading__steps=2)
    box = Refused(YIELDS_FAR, ["fem.box"])
    yield row(
        "perfect-1000",
        "p0/yield",
        "perfect, p0/σy = 1000",
        perfect(1e3),
        expected=both(AT_EDGE, box),
        loading__steps=2,
        solver__beyond_model=True,
    )
    half = Refused(
        "elastic strain cannot change the volume, nor can plastic strain", ["body.poisson", "less than 0.5"]
    )
    yield row(
        "plastic-poisson-0.5",
        "poisson",
        "ν = 0.5 and plastic",
        SWIFT,
        expected=both(half, half, half),
        body__poisson=0.5,
    )
    for nu in (0.0, 0.4999):
        what = f"ν = {nu:g} and plastic"
        yield row(
            f"plastic-poisson-{nu:g}",
            "poisson",
            what,
            SWIFT,
            expected=compared(),
            body__poisson=nu,
            loading__steps=5,
        )
    none = Right("nothing touches", [nothing_touches])
    yield row("plastic-force-0", "force", "0 N and plastic", SWIFT, expected=both(none), loading__force=0.0)


def layers() -> Iterator[Row]:
    """A layer with a tenth of the yield stress on a body that stays elastic; one with ten times that of a
    body that yields.

    The largest strains of both models agree within 0.4 % at equal depths on grids and meshes graded towards
    the kink of the yield stress: at the bottom of a thin weak layer, or below a hard one, the strain is
    largest just there.
    """
    yield layer(
        "layer-0.1",
        0.1,
        9450e6,
        1.0,
        peeq=0.02,
        reason="SAM 0.9 % below the limit, FEM 0.3 % above",
        grid=wide(5, 49, 5, 0.1 * HERTZ),
    )
    yield layer(
        "layer-10",
        10.0,
        945e6,
        0.3,
        peeq=0.02,
        reason="SAM 0.7 % and FEM 0.3 % below the limit",
        grid=wide(5, 49, 5, 0.05 * HERTZ),
    )
    reason = "taken 0.01 radii above the kink, SAM 2.3 % and FEM 1.4 % below the limit at the kink itself"
    grid = wide(5, 49, 5, 0.025 * HERTZ, even=18)  # faces at 0.3 and 0.45 radii, where the mesh has lines too
    yield layer(
        "layer-0.1-thin", 0.1, 9450e6, 0.3, peeq=0.03, reason=reason, grid=grid, fem__cells_per_radius=20
    )
    yield squeezed()
    hard = {"law": "perfect", "yield_stress": P0 / 2.0}
    law = SWIFT | {"C": 20.0, "B": 945e6, "layer_thickness": 0.3 * HERTZ, "layer": hard}
    near = {"approach_m": 0.01, "p_center_Pa": 0.03, "contact_radius_m": 0.03, "peeq_max": 0.03}
    yield row(
        "layer-perfect",
        "layer",
        "a layer that never hardens on a Swift body, 0.3 radii thick",
        law,
        expected=compared(near, "10 cells in the radius"),
        loading__steps=5,
        grid=wide(5, 49, 5, 0.05 * HERTZ),
    )


def squeezed() -> Row:
    """A weak layer on a body that yields too, p0 some forty times its yield stress."""
    law = SWIFT | {"C": 20.0, "B": 945e6, "profile": profile(0.1, 0.3)}
    twin = same_as({"loading.steps": 20}, 0.005, OWN_PATH, ("approach_m", "p_center_Pa", "peeq_max"))
    cut = Right(
        "steps are cut, and begun with the nodes in contact of the last one", [twin, residuals_hold, yields]
    )
    sheet = Absent("it shears in a sheet at its lower side that no layers of an affordable number resolve")
    what = "a layer with 0.1 times the yield stress that is squeezed out, 0.3 radii thick"
    mesh = {"fem__cells_per_radius": 5, "fem__box": 10.0}
    return row(
        "layer-0.1-squeezed", "layer", what, law, expected={SAM: sheet, FEM: cut}, loading__steps=10, **mesh
    )


def profile(factor: float, thickness: float) -> tuple[tuple[float, float], ...]:
    """Profile of a layer of so many Hertz radii, with a transition half as thick below it."""
    return (thickness * HERTZ, factor), (1.5 * thickness * HERTZ, 1.0)


def layer(
    name: str,
    factor: float,
    strength: float,
    thickness: float,
    *,
    peeq: float,
    reason: str,
    grid: dict,
    **changes,
) -> Row:
    """factor, thickness: see `profile`; peeq: bound for the largest strain."""
    law = SWIFT | {"C": 20.0, "B": strength, "profile": profile(factor, thickness)}
    what = f"a layer with {factor:g} times the yield stress, {thickness:g} radii thick"
    near = {"approach_m": 0.01, "p_center_Pa": 0.03, "contact_radius_m": 0.03, "peeq_max": peeq}
    words = f"8 to 10 cells in the radius; the largest strain: {reason}"
    return row(
        name, "layer", what, law, expected=compared(near, words), loading__steps=10, grid=grid, **changes
    )


def steps_and_tolerances() -> Iterator[Row]:
    """Extremes of the number of load steps and of the tolerance."""
    law = SWIFT | {"C": 20.0}
    for steps in (1, 200):
        twin = same_as({"loading.steps": 10}, 0.03, OWN_PATH, ("approach_m", "p_center_Pa", "peeq_max"))
        right = Right("backward Euler is stable for any step", [twin, residuals_hold, yields])
        yield row(
            f"plastic-steps-{steps}",
            "steps",
            f"{steps} steps, Swift",
            law,
            expected=both(right),
            loading__steps=steps,
        )
    twin = same_as({"loading.steps": STEPS}, 0.05, OWN_PATH, ("approach_m", "contact_radius_m"))
    right = Right("backward Euler, steps cut where needed", [twin, residuals_hold, yields])
    yield row(
        "perfect-6.2-steps-1",
        "steps",
        "1 step, perfect, p0/σy = 6.2",
        perfect(6.2),
        expected=both(right),
        loading__steps=1,
    )
    for tolerance in (1e-3, 1e-9, 1e-12):
        bound = 10 * tolerance if tolerance > 1e-6 else 1e-5
        twin = same_as(
            {"solver.tolerance": 1e-6},
            bound,
            "of the coarser tolerance ten times",
            ("approach_m", "p_center_Pa"),
        )
        right = Right("a tolerance above rounding can be met", [twin, residuals_hold])
        name, what = f"plastic-tolerance-{tolerance:g}", f"Swift, solver.tolerance = {tolerance:g}"
        yield row(
            name, "tolerance", what, law, expected=both(right), loading__steps=3, solver__tolerance=tolerance
        )
