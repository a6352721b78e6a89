# SPDX-License-Identifier: MIT
"""What the axisymmetric model can represent, and what it leaves out of a scene. Loads no numerical library."""

from __future__ import annotations

from sam.scene.errors import Problem, spelling
from sam.scene.remedies import either, larger_box, less_load
from sam.scene.result import LeftOut
from sam.scene.schema import Scene

SHAPES = ("sphere", "punch")
TRACTION = "tangential traction"
THINNEST, THICKEST = 1e-4, 0.5
"""Thickness of a film: at least in Hertz radii, at most in sizes of the box, so that there is a body below it."""
# contact radius with a film over that without it: a film 1e6 times as stiff as the body, and thick
SMALLEST = 0.01


class UnsupportedScene(ValueError):  # noqa: N818 - the name that callers of both models know
    """A valid scene that the axisymmetric model cannot represent; the message names key, value and what is allowed."""


def check(scene: Scene) -> None:
    """Raise UnsupportedScene, with every reason at once, unless the axisymmetric model can represent the scene."""
    problems = []
    shape = scene.counterbody.shape if scene.counterbody else None
    if shape not in (*SHAPES, None):
        allowed = " or ".join(spelling(name) for name in SHAPES)
        problems.append(
            Problem(
                "counterbody.shape",
                spelling(shape),
                f"the axisymmetric finite-element model allows {allowed}",
            )
        )
    if scene.coefficient > 0:
        allowed = "the axisymmetric finite-element model allows 0: friction leaves no symmetry of rotation"
        problems.append(Problem("friction.coefficient", spelling(scene.coefficient), allowed))
    if scene.loading.path:
        problems.append(
            Problem("loading.path", "a table", "a load that stays on the axis of symmetry: remove it")
        )
    for key, body in (("body", scene.body), ("counterbody", scene.counterbody)):
        if body is not None and body.poisson is not None and not body.poisson < 0.5:
            allowed = "the finite-element model allows 0 <= poisson < 0.5"
            problems.append(Problem(f"{key}.poisson", spelling(body.poisson), allowed))
    problems += rough(scene) + running_in(scene)
    problems += (
        coating_problems(scene) if not problems else []
    )  # it needs the contact radius of a shape that is allowed
    if not problems and (scene.body.plasticity is not None or scene.body.coating is not None):
        problems += _too_small_a_box(scene)
    if problems:
        raise UnsupportedScene("; ".join(map(str, problems)))


def rough(scene: Scene) -> list[Problem]:
    """A rough body, which the axisymmetric model has not."""
    if scene.surface is None:
        return []
    words = "the axisymmetric finite-element model allows a smooth body: remove [surface]"
    return [Problem("surface.kind", spelling(scene.surface.kind), words)]


def running_in(scene: Scene) -> list[Problem]:
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
    """What the finite elements cannot represent of a coating: an incompressible one, one that no mesh of this box can hold."""
    from fem_reference.common.hertz import scales

    coating, problems = scene.body.coating, []
    if coating is None:
        return problems
    if not coating.poisson < 0.5:
        allowed = "the finite-element model allows 0 <= poisson < 0.5"
        problems.append(Problem("body.coating.poisson", spelling(coating.poisson), allowed))
    length = scales(scene).length
    least, most = THINNEST * length, THICKEST * scene.fem.box * length
    if not least <= coating.thickness <= most:
        allowed = f"from {least:.3g} to {most:.3g} m for this contact and fem.box = {spelling(scene.fem.box)}"
        problems.append(Problem("body.coating.thickness", spelling(coating.thickness), allowed))
    return problems or _too_stiff_a_film(scene)


def _too_stiff_a_film(scene: Scene) -> list[Problem]:
    """A film that makes the contact so small that elements as small would be too many."""
    from fem_reference.common.film import expected_radius

    share = expected_radius(scene)
    if share >= SMALLEST:
        return []
    allowed = (
        f"less: the contact would have {share:.2g} of the radius without film, the mesh allows {SMALLEST:g}"
    )
    return [Problem("body.coating.young", spelling(scene.body.coating.young), allowed)]


def _too_small_a_box(scene: Scene) -> list[Problem]:
    """Contacts on plastic bodies and soft films outgrow Hertz's, a thousandfold and more: the uniform mesh must fit the box."""
    from fem_reference.axisymmetric.model import choose_core

    core, size = choose_core(scene), 1.0 / scene.fem.cells_per_radius
    reach = max(core.radius, core.depth) + size
    if reach < scene.fem.box:
        return []
    kind = "coated" if scene.body.plasticity is None else "plastic"
    allowed = f"more than {reach:.3g} Hertz radii for this {kind} contact: {either(larger_box(scene), less_load(scene))}"
    return [Problem("fem.box", spelling(scene.fem.box), allowed)]


def left_out(scene: Scene) -> list[LeftOut]:
    """Stages of the finite-element model that the scene does not need, with the reason."""
    coating = scene.body.coating
    elastic = scene.body.plasticity is None and (coating is None or coating.yield_stress is None)
    stages = [] if coating else [LeftOut("film elements", "no [body.coating]")]
    stages += [
        LeftOut(TRACTION, "friction.coefficient is 0" if scene.friction else "no [friction]"),
        LeftOut("worn geometry", "no [wear]"),
    ]
    if elastic:
        reason = "the body is elastic: no [body.plasticity]" + (
            ", no body.coating.yield_stress" if coating else ""
        )
        stages.append(LeftOut("return mapping and plastic history", reason))
    if scene.counterbody is not None and not scene.counterbody.elastic:
        stages.append(
            LeftOut("mesh of the counter-body", "rigid: no counterbody.young and counterbody.poisson")
        )
    if scene.solver.extrapolate:
        stages.append(LeftOut("extrapolation", "solver.extrapolate is a method of the semi-analytical model"))
    if not scene.loading.unload:
        stages.append(LeftOut("unloading", "loading.unload is false"))
    elif elastic:
        stages.append(LeftOut("unloading steps", "elastic: unloading in one step is exact"))
    alternating = scene.coefficient > 0.0 and scene.friction.direction == "alternating"
    if elastic and scene.loading.cycles > 1 and not alternating:
        stages.append(LeftOut("cycles after the first", "elastic: every cycle equals the first"))
    return stages
