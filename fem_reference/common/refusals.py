# SPDX-License-Identifier: MIT
"""What no finite-element model can represent. Loads no numerical library but numpy."""

from __future__ import annotations

from collections.abc import Sequence

from fem_reference.common.coating import expected_radius
from fem_reference.common.hertz import scales
from sam.scene.remedies import either, larger_box, less_load
from sam.scene.schema import Scene
from sam.scene.section import Problem, spelling

THINNEST = 1e-4
"""Smallest thickness of a coating in Hertz radii: with 16 cells in the radius its elements are 1250 times
as wide as high.
"""
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


def shape_problems(scene: Scene, shapes: Sequence[str], model: str) -> list[Problem]:
    """A counter-body of a shape that `model` has not."""
    shape = scene.counterbody.shape if scene.counterbody else None
    if shape in (*shapes, None):
        return []
    allowed = " or ".join(spelling(name) for name in shapes)
    return [
        Problem("counterbody.shape", spelling(shape), f"the {model} finite-element model allows {allowed}")
    ]


def incompressible(key: str, poisson: float | None) -> list[Problem]:
    """An incompressible body, which the elements have no pressure for."""
    return [] if poisson is None or poisson < 0.5 else [Problem(f"{key}.poisson", spelling(poisson), POISSON)]


def running_in_problems(scene: Scene) -> list[Problem]:
    """Wear and chemical films, which no finite-element model has."""
    problems = []
    if scene.friction is not None and scene.friction.film:
        words = 'the finite-element models allow "constant", in three dimensions also "map"'
        problems.append(Problem("friction.law", spelling(scene.friction.law), words))
    if scene.wear is not None:
        words = "the finite-element models allow a surface that does not wear: remove [wear]"
        problems.append(Problem("wear.strain_limit", spelling(scene.wear.strain_limit), words))
    return problems


def coating_problems(scene: Scene) -> list[Problem]:
    """What finite elements cannot represent of a coating; the scene must be one whose contact radius can be
    estimated.
    """
    coating = scene.body.coating
    if coating is None:
        return []
    problems, length = incompressible("body.coating", coating.poisson), scales(scene).length
    least, most = THINNEST * length, THICKEST * scene.fem.box * length
    if not least <= coating.thickness <= most:
        allowed = f"from {least:.3g} to {most:.3g} m for this contact and fem.box = {spelling(scene.fem.box)}"
        problems.append(Problem("body.coating.thickness", spelling(coating.thickness), allowed))
    return problems or _too_stiff_a_coating(scene)


def _too_stiff_a_coating(scene: Scene) -> list[Problem]:
    """A coating that makes the contact so small that elements as small would be too many."""
    share, coating = expected_radius(scene), scene.body.coating
    if coating is None or share >= SMALLEST:
        return []
    words = (
        f"less: the contact would have {share:.2g} of the radius without film, the mesh allows {SMALLEST:g}"
    )
    return [Problem("body.coating.young", spelling(coating.young), words)]


def box_problems(scene: Scene, reach: float, contact: str) -> list[Problem]:
    """A box that does not hold the uniform part of the mesh, of the size `reach` in Hertz radii."""
    if reach < scene.fem.box:
        return []
    remedies = either(larger_box(scene), less_load(scene))
    radii = "radii" if scene.loading.misfit_sphere else "Hertz radii"
    words = f"more than {reach:.3g} {radii} for this {contact}: {remedies}"
    return [Problem("fem.box", spelling(scene.fem.box), words)]
