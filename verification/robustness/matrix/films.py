# SPDX-License-Identifier: MIT
"""Extremes of an elastic film: its modulus over the body's from 1e-6 to 1e6, its thickness from 1e-4 to 1e4
contact radii.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache, partial

from sam.scene import Scene, Status
from verification.reference.coated_sphere import CoatedContact, solve_force, thin_layer
from verification.reference.hertz import CircularContact, effective_modulus
from verification.reference.layered_axisymmetric import CoatedHalfSpace
from verification.robustness.matrix.checks import as_other_model, balanced, nothing_touches, relative, same_as
from verification.robustness.matrix.elastic import both
from verification.robustness.matrix.row import Deviation, Expectation, Refused, Right, Row, Trial
from verification.robustness.matrix.scenes import BEYOND, FORCE, HERTZ, POISSON, RADIUS, YOUNG, scene_with
from verification.runs.models import FEM, SAM

RATIOS = (1e-6, 1e-2, 1e2, 1e6)
THICKNESSES = (1e-4, 1e-2, 1.0, 1e2, 1e4)  # in contact radii of the bare body
ONE_GRID = "the contact with the film is {:.2g} of that without, and both are on one grid"
LINEAR = "elastic and linear in the pressure: closed forms in the wave number"
COARSE = {SAM: "6 to 9 cells in the radius", FEM: "8 elements in the radius"}


@cache
def _exact(layers: CoatedHalfSpace, radius: float, force: float) -> CoatedContact:
    return solve_force(layers, radius, force)


def layers_of(scene: Scene) -> CoatedHalfSpace:
    """The coated half-space of a scene, as the reference solutions take it."""
    film = scene.body.coating
    return CoatedHalfSpace(film.young, film.poisson, film.thickness, scene.body.young, scene.body.poisson)


def coated(trial: Trial) -> Iterator[Deviation]:
    """A sphere on a coated half-space, by dual integral equations: p0 and approach."""
    scene, found = trial.scene, trial.quantities
    exact = _exact(layers_of(scene), scene.counterbody.radius, scene.loading.force)
    reason = COARSE[trial.model]
    p0, approach = float(exact.pressure(0.0)), exact.approach
    yield relative("p0, coated half-space", found["p_center_Pa"], p0, 0.015, reason=reason)
    yield relative("approach, coated half-space", found["approach_m"], approach, 0.004, reason=reason)


def squeezed(trial: Trial) -> Iterator[Deviation]:
    """A thin soft film on a rigid body (Johnson 1985, 5.8): a from the force, p0, and the approach a^2/(2
    R).
    """
    scene, found = trial.scene, trial.quantities
    _, unit = thin_layer(
        layers_of(scene), RADIUS, HERTZ
    )  # force at one radius; it goes with the fourth power
    a = HERTZ * (scene.loading.force / unit) ** 0.25
    p0, _ = thin_layer(layers_of(scene), RADIUS, a)
    reason = "film of 1e-3 contact radii on a body 1e6 times as stiff: rigid to 1/100"
    yield relative("p0, thin film", found["p_center_Pa"], p0, 0.02, reason=reason)
    yield relative("approach, thin film", found["approach_m"], a**2 / (2 * RADIUS), 0.02, reason=reason)


def thick(trial: Trial) -> Iterator[Deviation]:
    """The film alone, as a half-space: Hertz's p0."""
    scene = trial.scene
    modulus = effective_modulus(scene.body.coating.young, scene.body.coating.poisson)
    exact = CircularContact(scene.loading.force, scene.counterbody.radius, modulus)
    yield relative(
        "p0, limit of a thick film",
        trial.quantities["p_center_Pa"],
        exact.peak_pressure,
        0.015,
        reason=COARSE[trial.model],
    )


def one_material(trial: Trial) -> Iterator[Deviation]:
    """A film that is none, or next to none: Hertz for the body."""
    exact = CircularContact(FORCE, RADIUS, effective_modulus(YOUNG, POISSON))
    reason = COARSE[trial.model]
    yield relative("p0, Hertz", trial.quantities["p_center_Pa"], exact.peak_pressure, 0.01, reason=reason)
    yield relative("approach, Hertz", trial.quantities["approach_m"], exact.approach, 0.004, reason=reason)


def rows() -> Iterator[Row]:
    """All of them."""
    for ratio in RATIOS:
        for thickness in THICKNESSES:
            yield _film(ratio, thickness)
    for thickness in (1e-4, 1.0, 1e4):
        right = Right("the same material: no film", [one_material])
        yield _row(1.0, thickness, both(right, _in_fem(1.0, thickness) or right))
    none = Right("nothing touches", [nothing_touches])
    yield _row(
        1e-2, 1.0, both(none), {"loading.force": 0.0}, name="film-force-0", what="0 N on a film", quick=False
    )
    changes = {"body.coating.poisson": 0.5, "body.poisson": 0.5}
    half = Refused("displacement elements divide by 1 - 2 nu", ["poisson", "< 0.5"])
    right = Right("closed forms hold for an incompressible film", [coated])
    yield _row(
        1e-2,
        1.0,
        both(right, half),
        changes,
        name="film-poisson-0.5",
        what="film and body with ν = 0.5",
        quick=True,
    )


def _film(ratio: float, thickness: float) -> Row:
    checks = [coated] if thickness >= 1e-2 else []
    if (ratio, thickness) == (1e-6, 1e-2):
        checks = [squeezed]
    if ratio == 1e6 and thickness < 1.0:  # a stiff plate: the contact is no disc, and there is no closed form
        checks = [same_as({"grid.cells": (65, 65)}, 0.01, "half the cell", ("approach_m",))]
    if (ratio, thickness) == (1e2, 1e-4):  # 1e-4 radii, 100 times as stiff: the bare body to 1 %
        checks = [one_material]
    checks += [thick] if thickness >= 1e4 else []
    fem = _in_fem(ratio, thickness)
    if fem is None and not checks:
        near = {"approach_m": 0.005, "p_center_Pa": 0.01}
        reason = "8 cells or elements in the radius"
        both_ways = {
            name: Right(LINEAR, [as_other_model(twin, near, reason)])
            for name, twin in ((SAM, FEM), (FEM, SAM))
        }
        return _row(ratio, thickness, both_ways)
    sam = _in_sam(ratio, thickness) or Right(LINEAR, [*checks, balanced])
    return _row(
        ratio, thickness, both(sam, fem or Right(LINEAR, checks)), quick=(ratio, thickness) == (1e-2, 1.0)
    )


def _in_sam(ratio: float, thickness: float) -> Expectation | None:
    """The error that SAM must end in, None if it must be right."""
    if ratio == 1e6 and thickness >= 1.0:
        share = ratio ** (-1 / 3)
        return Refused(ONE_GRID.format(share), ["too few cells", "grid.cells"], Status.UNDER_RESOLVED)
    return None


def _in_fem(ratio: float, thickness: float) -> Expectation | None:
    """The error that FEM must end in, None if it must be right."""
    if thickness > 5.0:
        return Refused("no body below the film in the box of 10 radii", ["body.coating.thickness", "fem.box"])
    if ratio == 1e-6 and thickness >= 1e-2:
        return Refused("a contact as large as the box: so soft a film is pressed flat", ["fem.box"])
    if ratio == 1e6 or (ratio == 1e2 and thickness == 1e-4):
        reason = (
            "forces of the stiff film are small differences: they do not balance to 1e-9 in double precision"
        )
        return Refused(reason, ["body.coating.thickness", "body.coating.young"], Status.NOT_CONVERGED)
    return None


def _row(
    ratio: float, thickness: float, expected, changes=None, *, name: str = "", what: str = "", quick=False
) -> Row:
    coating = {"thickness": thickness * HERTZ, "young": ratio * YOUNG, "poisson": POISSON}
    cells = {"grid.cells": (129, 129)} if ratio == 1e2 and thickness >= 1.0 else {}
    wide = BEYOND if ratio == 1e-6 and thickness >= 1.0 else {}  # pressed nearly through
    make = partial(scene_with, {"body.coating": coating} | cells | wide | (changes or {}))
    name = name or f"film-{ratio:g}-{thickness:g}a"
    return Row(
        name, "film", what or f"film of {ratio:g} E, {thickness:g} contact radii thick", make, expected, quick
    )
