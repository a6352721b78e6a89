# SPDX-License-Identifier: MIT
"""What the three-dimensional model can represent, and what it leaves out of a scene. Loads no numerical library."""

from __future__ import annotations

from fem_reference.axisymmetric.support import TRACTION, UnsupportedScene, coating_problems, running_in
from fem_reference.axisymmetric.support import left_out as left_out_of_any
from sam.scene.errors import Problem, spelling
from sam.scene.remedies import either, larger_box, less_load
from sam.scene.result import LeftOut
from sam.scene.schema import Scene

SHAPES = ("sphere", "ellipsoid")
ROUGH_SHAPES = (*SHAPES, "flat")


def check(scene: Scene) -> None:
    """Raise UnsupportedScene, with every reason at once, unless the three-dimensional model can represent the scene."""
    problems, counter, rough = [], scene.counterbody, scene.surface is not None
    shapes = ROUGH_SHAPES if rough else SHAPES
    if counter is not None and counter.shape not in shapes:
        allowed = " or ".join(spelling(name) for name in shapes)
        words = f"the three-dimensional finite-element model allows {allowed}"
        problems.append(Problem("counterbody.shape", spelling(counter.shape), words))
    if counter is not None and counter.elastic:
        words = "the three-dimensional finite-element model allows only a rigid counter-body: remove young and poisson"
        problems.append(Problem("counterbody.young", spelling(counter.young), words))
    if not scene.body.poisson < 0.5:
        allowed = "the finite-element model allows 0 <= poisson < 0.5"
        problems.append(Problem("body.poisson", spelling(scene.body.poisson), allowed))
    problems += running_in(scene) + _combinations(scene)
    problems += (
        coating_problems(scene) if not problems else []
    )  # it needs the contact radius of a shape that is allowed
    if not problems and not rough:  # half of a rough patch is less than the smallest box
        problems += _too_small_a_box(scene)
    if problems:
        raise UnsupportedScene("; ".join(map(str, problems)))


def _combinations(scene: Scene) -> list[Problem]:
    """What cannot be put together here: a rough body and a coating, given tractions and a map of coefficients."""
    problems, coating = [], scene.body.coating
    if scene.surface is not None and coating is not None:
        words = "the three-dimensional finite-element model allows no film on a rough body: remove it, or [surface]"
        problems.append(Problem("body.coating.thickness", spelling(coating.thickness), words))
    if scene.loading.prescribed is not None and not scene.constant_friction:
        words = 'the three-dimensional finite-element model allows "constant" where the pressure is given'
        problems.append(Problem("friction.law", spelling(scene.friction.law), words))
    return problems


def _too_small_a_box(scene: Scene) -> list[Problem]:
    """The uniform mesh must fit into the box in depth."""
    from fem_reference.spatial.model import uniform_depth

    depth = uniform_depth(scene)
    if depth < scene.fem.box:
        return []
    allowed = (
        f"more than {depth:.3g} Hertz radii for this contact: {either(larger_box(scene), less_load(scene))}"
    )
    return [Problem("fem.box", spelling(scene.fem.box), allowed)]


def left_out(scene: Scene) -> list[LeftOut]:
    """Stages of the three-dimensional model that the scene does not need, with the reason."""
    stages = left_out_of_any(scene)
    if scene.coefficient > 0.0:
        stages = [entry for entry in stages if entry.stage != TRACTION]
    if scene.friction is not None and not scene.friction.coupling:
        reason = "friction.coupling = false is a choice of the semi-analytical model: a continuum is always coupled"
        stages.append(LeftOut("decoupled traction", reason))
    return stages
