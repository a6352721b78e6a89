# SPDX-License-Identifier: MIT
"""What no finite-element model can represent, and what to change when a solve ends badly: nothing that is set
already, nothing that the scene has not. Loads no numerical library but numpy.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fem_reference.common.bodies import expected_radius
from fem_reference.common.hertz import scales
from sam.scene import remedies
from sam.scene.result import Status
from sam.scene.schema import Scene
from sam.scene.section import Problem, spelling

THINNEST = 1e-4
"""Smallest thickness of a coating in Hertz radii: elements 1250 times as wide as high."""
THICKEST = 0.5
"""Largest thickness of a coating in sizes of the box, so that there is a body below it."""
SMALLEST = 0.01
"""Contact radius with a coating over that without it: a coating 1e6 times as stiff as the body, and thick."""
POISSON = "the finite-element model allows 0 <= poisson < 0.5"


class UnsupportedScene(ValueError):  # noqa: N818 - the name that callers of both models know
    """A valid scene that a finite-element model cannot represent.

    The message names every key that stands in the way, its value and what is allowed.
    """


def refuse(problems: Sequence[Problem]) -> None:
    """Raise UnsupportedScene with every reason at once, if there is any."""
    if problems:
        raise UnsupportedScene("; ".join(map(str, problems)))


def problems_of(scene: Scene, shapes: Sequence[str], model: str) -> list[Problem]:
    """What no model allows, wear, chemical films, patches that repeat, incompressible bodies, which the
    elements have no pressure for; and a counter-body of a shape that `model` has not.
    """
    allows, problems = f"the {model} finite-element model allows", []
    shape = scene.counterbody.shape if scene.counterbody else None
    if scene.grid is not None and scene.grid.periodic is not None:
        words = f"{allows} a patch that does not repeat: leave it out"
        problems.append(Problem("grid.periodic", spelling(scene.grid.periodic), words))
    elif shape not in (*shapes, None):
        words = " or ".join(spelling(name) for name in shapes)
        problems.append(Problem("counterbody.shape", spelling(shape), f"{allows} {words}"))
    for key, body in (("body", scene.body), ("counterbody", scene.counterbody)):
        problems += [] if body is None else incompressible(key, body.poisson)
    if scene.friction is not None and scene.friction.film:
        words = 'the finite-element models allow "constant", in three dimensions also "map"'
        problems.append(Problem("friction.law", spelling(scene.friction.law), words))
    if scene.wear is not None:
        words = "the finite-element models allow a surface that does not wear: remove [wear]"
        problems.append(Problem("wear.strain_limit", spelling(scene.wear.strain_limit), words))
    return problems


def incompressible(key: str, poisson: float | None) -> list[Problem]:
    """A body without change of volume."""
    return [] if poisson is None or poisson < 0.5 else [Problem(f"{key}.poisson", spelling(poisson), POISSON)]


def coating_problems(scene: Scene) -> list[Problem]:
    """What finite elements cannot represent of a coating, of a scene with a contact radius."""
    coating = scene.body.coating
    if coating is None:
        return []
    problems, length = incompressible("body.coating", coating.poisson), scales(scene).length
    least, most = THINNEST * length, THICKEST * scene.fem.box * length
    if not least <= coating.thickness <= most:
        allowed = f"from {least:.3g} to {most:.3g} m for this contact and fem.box = {spelling(scene.fem.box)}"
        problems.append(Problem("body.coating.thickness", spelling(coating.thickness, "m"), allowed))
    if problems or (share := expected_radius(scene)) >= SMALLEST:
        return problems
    words = (
        f"less: the contact would have {share:.2g} of the radius without film, the mesh allows {SMALLEST:g}"
    )
    return [Problem("body.coating.young", spelling(coating.young, "Pa"), words)]


def box_problems(scene: Scene, reach: float, contact: str) -> list[Problem]:
    """A box that does not hold the uniform part of the mesh, of the size `reach` in Hertz radii."""
    if reach < scene.fem.box:
        return []
    either = remedies.either(remedies.larger_box(scene), remedies.less_load(scene))
    radii = "radii" if scene.loading.misfit_sphere else "Hertz radii"
    words = f"more than {reach:.3g} {radii} for this {contact}: {either}"
    return [Problem("fem.box", spelling(scene.fem.box), words)]


MOST_CUTS = 6
"""A step is halved so many times at most: into 64 parts."""
FLOWED = 1.0
"""Accumulated plastic strain of a coating beyond which a small-strain solution means nothing."""
SOFTER = "raise body.coating.thickness, or lower body.coating.young"
FEWEST_ELEMENTS = 4
"""Fewer elements in the contact radius are under-resolved: 1 % off in the central pressure."""
FEWEST_NODES = 28
"""Fewer nodes in rough contact are under-resolved; a spot of three elements has 28."""


def message_of(scene: Scene, status: Status) -> str:
    """What to change for a status, in words; empty for a converged solve."""
    rough, less = scene.patch_surface is not None, remedies.less_load(scene)
    match status:
        case Status.NOT_CONVERGED if rough:
            what = remedies.either(remedies.finer_cells(scene), f"{less} if all of it touches")
            return f"the contact iteration did not settle: {what}"
        case Status.NOT_CONVERGED:
            return "the contact iteration did not settle: change fem.cells_per_radius"
        case Status.CONTACT_AT_GRID_EDGE:
            return f"the contact reaches the edge of the fine mesh: {less}"
        case Status.UNDER_RESOLVED if rough:
            return f"fewer than {FEWEST_NODES} surface nodes in contact: {remedies.finer_cells(scene)}"
        case Status.UNDER_RESOLVED:
            what = remedies.finer_mesh(scene)
            return f"fewer than {FEWEST_ELEMENTS} elements in the contact radius: {what}"
        case Status.PLASTIC_ZONE_AT_GRID_EDGE:
            what = remedies.either(remedies.larger_box(scene), less)
            return f"the plastic zone reaches the outer boundary: {what}"
        case Status.STEP_CUT_LIMIT:
            what = remedies.either(remedies.more_steps(scene), less)
            return f"a load step did not converge, halved {MOST_CUTS} times: {what}"
    return status.advice  # of a status that no solve here ends in


@dataclass(frozen=True)
class Advice:
    """What to change when a solve ends in a status; flows: of a coating that may flow."""

    by_status: Mapping[Status, str]
    flows: str | None = None

    def outcome(self, status: Status, peeq: float) -> tuple[Status, str]:
        """Status and message of a solve; peeq: the largest at the peak, of a coating that flows."""
        if self.flows is not None and status is Status.CONVERGED and peeq > FLOWED:
            return Status.NOT_CONVERGED, self.flows
        return status, self.by_status[status]


def advice_of(scene: Scene) -> Advice:
    """The advice of a scene.

    A coating that yields carries no traction beyond yield_stress/sqrt(3), that is with friction no pressure
    beyond this over the coefficient. A larger pressure that is given has no equilibrium; that of a contact
    levels off there, while the coating is sheared until small strains mean nothing.
    """
    coating, mu = scene.body.coating, scene.coefficient
    advice = {status: message_of(scene, status) for status in Status}
    if coating is not None and coating.young > scene.body.young:
        words = f"if the film is too thin and stiff for the digits of a double, {SOFTER}"
        advice[Status.NOT_CONVERGED] += f"; {words}"
    if coating is None or coating.yield_stress is None:
        return Advice(advice)
    words = f"the film flows, with a plastic strain beyond {FLOWED:g}"
    if mu > 0.0:
        most = coating.yield_stress / (np.sqrt(3.0) * mu)
        words = f"the film carries no pressure beyond {most:.4g} Pa with friction.coefficient = {mu:g}"
        advice[Status.STEP_CUT_LIMIT] += f"; {words}"
    others = remedies.less_load(scene), remedies.less_friction(scene)
    what = remedies.either("raise body.coating.yield_stress", *others)
    return Advice(advice, flows=f"{words}: {what}")
