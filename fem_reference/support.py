# SPDX-License-Identifier: MIT
"""What the axisymmetric model can represent, and what it leaves out of a scene. Loads no numerical library."""

from __future__ import annotations

from sam.scene.errors import Problem, spelling
from sam.scene.result import LeftOut
from sam.scene.schema import Scene

SHAPES = ("sphere", "punch")
TRACTION = "tangential traction"


class UnsupportedScene(ValueError):  # noqa: N818 - the name that callers of both models know
    """A valid scene that the axisymmetric model cannot represent; the message names key, value and what is allowed."""


def check(scene: Scene) -> None:
    """Raise UnsupportedScene, with every reason at once, unless the axisymmetric model can represent the scene."""
    problems = []
    shape = scene.counterbody.shape if scene.counterbody else None
    if shape not in (*SHAPES, None):
        allowed = " or ".join(spelling(name) for name in SHAPES)
        problems.append(
            Problem("counterbody.shape", spelling(shape), f"the axisymmetric finite-element model allows {allowed}")
        )
    if scene.coefficient > 0:
        allowed = "the axisymmetric finite-element model allows 0: friction leaves no symmetry of rotation"
        problems.append(Problem("friction.coefficient", spelling(scene.coefficient), allowed))
    if scene.loading.path:
        problems.append(Problem("loading.path", "a table", "a load that stays on the axis of symmetry: remove it"))
    for key, body in (("body", scene.body), ("counterbody", scene.counterbody)):
        if body is not None and body.poisson is not None and not body.poisson < 0.5:
            allowed = "the finite-element model allows 0 <= poisson < 0.5"
            problems.append(Problem(f"{key}.poisson", spelling(body.poisson), allowed))
    if not problems and scene.body.plasticity is not None:
        problems += _too_small_a_box(scene)
    if problems:
        raise UnsupportedScene("; ".join(map(str, problems)))


def _too_small_a_box(scene: Scene) -> list[Problem]:
    """Plastic contacts outgrow that of Hertz, at the softest a thousandfold and more: the uniform mesh must fit the box."""
    from fem_reference.model import choose_core

    core, size = choose_core(scene), 1.0 / scene.fem.cells_per_radius
    reach = max(core.radius, core.depth) + size
    if reach < scene.fem.box:
        return []
    allowed = f"more than {reach:.3g} Hertz radii for this plastic contact: raise fem.box, or lower loading.force"
    return [Problem("fem.box", spelling(scene.fem.box), allowed)]


def left_out(scene: Scene) -> list[LeftOut]:
    """Stages of the finite-element model that the scene does not need, with the reason."""
    elastic = scene.body.plasticity is None
    stages = [
        LeftOut("film elements", "no [body.coating]"),
        LeftOut(TRACTION, "friction.coefficient is 0" if scene.friction else "no [friction]"),
        LeftOut("worn geometry", "no [wear]"),
    ]
    if elastic:
        stages.append(LeftOut("return mapping and plastic history", "the body is elastic: no [body.plasticity]"))
    if scene.counterbody is not None and not scene.counterbody.elastic:
        stages.append(LeftOut("mesh of the counter-body", "rigid: no counterbody.young and counterbody.poisson"))
    if not scene.loading.unload:
        stages.append(LeftOut("unloading", "loading.unload is false"))
    elif elastic:
        stages.append(LeftOut("unloading steps", "elastic: unloading in one step is exact"))
    if elastic and scene.loading.cycles > 1:
        stages.append(LeftOut("cycles after the first", "elastic: every cycle equals the first"))
    return stages
