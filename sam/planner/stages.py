# SPDX-License-Identifier: MIT
"""The stages of a plan, in the order in which they begin: those that run with their sizes, and why others are
left out.

A stage runs where the plan has the part that it works on; nothing else decides on it. What only the solve can
tell, as the size of the plastic zone, is not among the sizes.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil

from sam.elastic.problem import Plan
from sam.scene import LeftOut, Path, Plasticity, Scene, Stage
from sam.scene.result import NO_FORCE
from sam.scene.verdict import VERDICT, periods_of, reason_without

LEFT_ORDER = (
    "tangential kernels",
    "coupling",
    "contact search",
    "surface coefficients",
    "volume grid",
    "eigenstrain kernels",
    "plastic loop",
    "layered coefficients",
    "bare comparison",
    "stresses in the film",
    "stresses in the substrate",
    "chemical film",
    "worn geometry",
    "stress outside the plane y = 0",
    "surface heights",
    "counter-surface heights",
    "unloading",
    "unloading steps",
    "cycles after the first",
    "back-stresses",
    VERDICT,
    "strain limit of the layer",
)
"""The order in which stages that do not run are told."""
# (c, n) of errors in percent, c times the step in contact radii to the power n, of Swift steel at p0 = 4
# sigma_y0: steps of a/2 to a/32 against the limit of short ones (case moving-steps).
LEFT_OF_GROOVE, LEFT_OF_STRAIN = (9.0, 1.5), (23.0, 0.77)
ROUNDING = 1e-9  # of a number of cells
UNTOUCHED = "loading.misfit: nothing touches the surface"
UNYIELDING = "the elastic stress at the peak yields nowhere"


def stages_of(scene: Scene, plan: Plan) -> tuple[Stage, ...]:
    """The stages of a scene: those that it needs in their order, then those that it does not need."""
    solving = [
        *_coarser(plan),
        *_surface(scene, plan),
        *_load(scene, plan),
        *_plastic(scene, plan),
        *_unloading(plan),
        *_output(scene, plan),
    ]
    if plan.schedule.peak.rests:
        solving = [Stage(each.stage, False, NO_FORCE) if each.runs else each for each in solving]
    found = [*_cells(scene, plan), *solving]
    needed = [each for each in found if each.runs or each.reason == NO_FORCE]
    left = [each for each in found if not each.runs and each.reason != NO_FORCE]
    return (*needed, *sorted(left, key=lambda each: LEFT_ORDER.index(each.stage)))


def left_out_of_unyielding(plan: Plan) -> list[LeftOut]:
    """What a scene with plasticity turns out not to need when it stays elastic."""
    stages = ["eigenstrain kernels", "plastic loop"]
    if plan.wear is not None:
        stages.append("worn geometry")
    return [LeftOut(stage, UNYIELDING) for stage in stages]


def _not(stage: str, reason: str) -> Stage:
    return Stage(stage, False, reason)


def _cells(scene: Scene, plan: Plan) -> Iterator[Stage]:
    """Cells, layers and heights."""
    grid = plan.grid
    cells = [grid.nx, grid.ny]
    yield Stage("grid", True, _grid_reason(scene), {"cells": cells, "cell_m": [grid.hx, grid.hy]})
    if grid.faces is None:
        yield _not("volume grid", "no [body.plasticity]: stresses at the output depths only")
    else:
        own = scene.grid is not None and bool(scene.grid.depths or scene.grid.layers)
        further = "and the load, further ones if the plastic zone reaches the last"
        reason = "layers of [grid]" if own else f"layers chosen from the {_length(scene)} {further}"
        size = {"layers": max(len(grid.faces) - 1, 1), "largest_depth_m": float(grid.faces[-1])}
        yield Stage("volume grid", True, reason, size)
    if scene.surface is None:
        yield _not("surface heights", "no [surface]")
    else:
        words = f'[surface], kind "{scene.surface.kind}", at the cell centres'
        yield Stage("surface heights", True, words, {"cells": cells})
    yield _counter_heights(scene, plan, cells)


def _counter_heights(scene: Scene, plan: Plan, cells: list[int]) -> Stage:
    """Heights of the counter-body, in each cycle others if it is renewed."""
    stage, surface = "counter-surface heights", scene.counter_surface
    if surface is None:
        return _not(stage, "no [counterbody.surface]")
    count = plan.schedule.cycles if plan.schedule.renews else 1
    words = f'[{surface.table}], kind "{surface.kind}", at the cell centres'
    if surface.renewed:
        words += ", another stretch in each cycle"
    strip = scene.counter_strip
    if strip is not None:
        words, cells = f"{words}, as long as the patch and the way", list(strip.whole)
    return Stage(stage, True, words, {"cells": cells, "stretches": count})


def _coarser(plan: Plan) -> Iterator[Stage]:
    """The solution on fewer cells that quantities are extrapolated from."""
    if plan.coarser is not None:
        cells = [plan.coarser.grid.nx, plan.coarser.grid.ny]
        reason = "solver.extrapolate: all that follows on half as many cells first"
        yield Stage("coarser grid", True, reason, {"cells": cells})


def _surface(scene: Scene, plan: Plan) -> Iterator[Stage]:
    """Influence coefficients of the surface."""
    cells = plan.grid.nx * plan.grid.ny
    if plan.misfit is None:
        reason = "normal displacement under pressure"
        yield Stage("surface coefficients", True, reason, {"coefficients": cells})
    else:
        yield _not("surface coefficients", UNTOUCHED)
    if plan.coated is None:
        yield _not("layered coefficients", "no [body.coating]")
    else:
        loads = 1 + plan.slip.slides  # pressure and traction
        reason = f"film of {plan.coated.thickness:g} m in the contact and at the output depths"
        size = {
            "coefficients": loads * (cells + stress_coefficients(plan)),
            "tables": loads * (1 + len(plan.grid.depths)),
        }
        yield Stage("layered coefficients", True, reason, size)
    if scene.friction is not None and plan.slip.slides:
        yield _coupling(plan, {"coefficients": cells})


def _coupling(plan: Plan, size: dict[str, object]) -> Stage:
    """Whether the traction is part of the gap."""
    if not plan.slip.coupled:
        return _not("coupling", "friction.coupling = false: the traction moves no surface normally")
    if plan.given is not None:
        return _not("coupling", "the pressure is given: the gap that the traction changes is not needed")
    if plan.slip.coupling == 0:
        return _not("coupling", "like bodies, equal (1 - 2 nu)/mu: the traction moves both surfaces alike")
    return Stage("coupling", True, "the traction moves the surfaces normally too: part of the gap", size)


def _prescribed(scene: Scene) -> str:
    """The load in place of a force, in words."""
    return f'loading.prescribed = "{scene.loading.prescribed}"'


def _load(scene: Scene, plan: Plan) -> Iterator[Stage]:
    """What puts the load on."""
    steps = {"steps": plan.steps}
    if plan.misfit is not None:
        yield Stage("misfit strain", True, f"{_prescribed(scene)}: closed form of the elastic stress", steps)
        yield _not("contact search", UNTOUCHED)
        return
    if plan.given is None:
        way = ", then along the path" if scene.moves else ""
        yield Stage("contact search", True, f"load steps to the peak{way}", steps)
        if scene.loading.path is not None:
            yield _moving(scene, scene.loading.path, plan)
        return
    words = _prescribed(scene)
    travels = ", and travels" if len(plan.schedule.path) > 1 else ""
    yield Stage("given pressure", True, words + travels, steps)
    yield _not("contact search", f"{words}: the pressure is given")


def _moving(scene: Scene, path: Path, plan: Plan) -> Stage:
    """A counter-body that moves: its passes, the cells that it sweeps, and what is not used of symmetry."""
    strokes, grid = scene.strokes, plan.grid
    step = path.length / strokes.count
    way = "to and fro, the load stays on" if path.to_and_fro else "one way, unloaded at its end"
    plane = plan.track is not None and plan.track.plane
    in_steps = "" if plane else f" in steps of {step / min(plan.axes):.3g} of the contact radius;"
    words = (
        f"the gap moves over the body, {way};{in_steps} no mirror image in x, no exchange of x and y, no "
        "pressure of an earlier pass"
    )
    if plan.plasticity is not None and not plane:
        groove, strain = (c * (step / min(plan.axes)) ** n for c, n in (LEFT_OF_GROOVE, LEFT_OF_STRAIN))
        words += f"; the steps leave about {groove:.0f} % of the groove, {strain:.0f} % of the plastic strain"
    sides = zip(path.start, path.end, plan.axes, (grid.hx, grid.hy), strict=True)
    swept = [ceil((abs(end - start) + 2 * axis) / h - ROUNDING) for start, end, axis, h in sides]
    if plane:  # all of the patch stays in the apparent contact
        swept = [grid.nx, grid.ny]
    size = {"passes": strokes.cycles, "steps": strokes.count, "step_m": step, "cells": swept}
    return Stage("moving counter-body", True, words, size)


def _plastic(scene: Scene, plan: Plan) -> Iterator[Stage]:
    """What plasticity, a tribofilm and wear add."""
    cycles = {"cycles": plan.schedule.cycles}
    if plan.plasticity is None:
        yield _not("eigenstrain kernels", "no [body.plasticity]")
        yield _not("plastic loop", "no [body.plasticity]")
        if plan.schedule.cycles > 1:
            yield _not("cycles after the first", "elastic: all cycles are equal")
        yield from _running_in(scene, plan)
        return
    first = "whether and where the elastic stress exceeds the yield stress"
    if plan.slip.whole is not None:
        first += ", with friction.high everywhere"
    where = "the contact" if plan.given is None else "the given pressure"
    where = "the misfit strain" if plan.misfit is not None else where
    kernels = "residual stress and displacement of the plastic strain, in a box that grows"
    loop = {"steps": plan.steps} | ({"unload_steps": plan.unload_steps} if plan.unloads else {})
    yield Stage("elastic peak", True, first, {"depths": len(plan.grid.depths)})
    yield Stage("eigenstrain kernels", True, kernels)
    yield Stage(
        "plastic loop",
        True,
        f"method {plan.solver.method}, {where} inside it{plan.plasticity.of_layer}",
        loop,
    )
    if plan.schedule.cycles > 1:
        reason = "each starts from the strain that the others left"
        yield Stage("cycles after the first", True, reason, cycles)
    yield from _running_in(scene, plan)
    yield _back_stresses(plan.plasticity)
    reason = reason_without(scene)
    words = "strains of the unloaded body after each period"
    yield _not(VERDICT, reason) if reason else Stage(VERDICT, True, words, {"periods": periods_of(scene)})
    if plan.plasticity.layer_thickness is not None and scene.wear is None:
        idle = ": body.plasticity.layer_thickness changes nothing" * (plan.plasticity.layer is None)
        yield _not("strain limit of the layer", f"no [wear]{idle}")


def _back_stresses(plasticity: Plasticity) -> Stage:
    """Kinematic hardening."""
    count = plasticity.back_stresses
    if not count:
        return _not("back-stresses", "no [body.plasticity.kinematic]")
    settles = "; the isotropic hardening never ends: every load settles in the end"
    words = f"exact along a constant direction of flow{settles * plasticity.grows_for_ever}"
    return Stage("back-stresses", True, words, {"back_stresses": count})


def _running_in(scene: Scene, plan: Plan) -> Iterator[Stage]:
    """Tribofilm and wear; on an elastic body the film is solved in one cycle, as all are equal."""
    friction, size = scene.friction, {"cycles": 1 if plan.plasticity is None else plan.schedule.cycles}
    if friction is None:
        yield _not("chemical film", "no [friction]")
    elif plan.tribofilm is None:
        yield _not("chemical film", f'friction.law = "{friction.law}": the coefficient is given')
    else:
        limit = f"{friction.thinning_limit:.4g}"
        later = " in the first visit, later by the time out of contact"
        later *= scene.moves and friction.growth_rate is not None
        reason = (
            f"fails where it thins by more than {limit}{later}, solved together with the contact in each step"
        )
        yield Stage("chemical film", True, reason, size)
    if scene.wear is None:
        yield _not("worn geometry", "no [wear]")
    elif plan.wear is None:
        yield _not("worn geometry", "wear.strain_limit = inf: nothing is removed")
    else:
        words = "removal, smoothing, remap and equilibrium after each cycle"
        yield Stage("worn geometry", True, words, size)


def _unloading(plan: Plan) -> Iterator[Stage]:
    """The way back to no force."""
    if not plan.unloads:
        yield _not("unloading", "loading.unload = false")
    elif plan.plasticity is None:
        yield Stage("unloading", True, "elastic: in one step", {"steps": 1})
        yield _not("unloading steps", "elastic: unloading in one step is exact")
    else:
        words = "in one step if that strains nothing, else in equal ones"
        yield Stage("unloading", True, words, {"steps": plan.unload_steps})


def _output(scene: Scene, plan: Plan) -> Iterator[Stage]:
    """What is computed of the solved contact."""
    grid = plan.grid
    coefficients = stress_coefficients(plan) if plan.misfit is None else 0
    depths = len(grid.depths)
    unloaded = " and unloaded" if plan.unloads and plan.plasticity is not None else ""
    words = f"in the plane y = 0 at peak load{unloaded}"
    size = {"depths": depths, "largest_depth_m": float(grid.depths[-1]), "coefficients": coefficients}
    yield Stage("stresses at the output depths", True, words, size)
    yield _outside(plan, depths)
    if plan.slip.slides:
        reason = "stresses of the traction, displacements along x"
        yield Stage("tangential kernels", True, reason, {"coefficients": coefficients})
    else:
        words = "no [friction]" if scene.friction is None else "friction.coefficient = 0"
        yield _not("tangential kernels", words)
    if plan.coated is not None:
        yield from _coated(plan, plan.coated.thickness)


def _outside(plan: Plan, depths: int) -> Stage:
    """Where the largest von Mises stress is looked for."""
    stage, grid = "stress outside the plane y = 0", plan.grid
    if plan.places.anywhere:
        reason = "rough: the largest von Mises stress lies anywhere below the patch"
        return Stage(stage, True, reason, {"cells": [grid.nx, grid.ny], "depths": depths})
    if plan.places.beside:
        reason = "the load ends beside y = 0: the largest von Mises stress lies below it"
        return Stage(stage, True, reason, {"cells": [grid.nx, 1], "depths": depths})
    return _not(stage, "smooth, sliding along x: the largest von Mises stress lies in y = 0")


def _coated(plan: Plan, thickness: float) -> Iterator[Stage]:
    """What is computed of a coated contact, and what its depths or its load leave out."""
    if not plan.schedule.peak.rests:
        words = "the same contact and stresses without film, from the coated pressure on"
        yield Stage("bare comparison", True, words, {"steps": 1})
    else:
        yield _not("bare comparison", "loading.force = 0: no contact")
    depths = plan.grid.depths
    for part, there, where in (
        ("film", depths[0] < thickness, "above"),
        ("substrate", depths[-1] >= thickness, "at or below"),
    ):
        if not there:
            reason = f"no output depth {where} the interface, z = {thickness:g} m"
            yield _not(f"stresses in the {part}", reason)


def stress_coefficients(plan: Plan) -> int:
    """Influence coefficients of the stresses at the output depths, of one load: in y = 0 of the lags to the
    contact of Hertz, four components if one row of cells lies in it; below a rough patch all.
    """
    grid = plan.grid
    if plan.places.anywhere:
        return 6 * len(grid.depths) * grid.nx * grid.ny
    a, b = plan.axes
    lags = min(ceil(grid.nx / 2 + a / grid.hx), grid.nx) * min(ceil(b / grid.hy), grid.ny)
    return (4 if grid.ny % 2 else 6) * len(grid.depths) * lags


def _length(scene: Scene) -> str:
    """What grids are chosen from."""
    if scene.patch_surface is not None:
        return "cells and the sides of the patch"
    if scene.loading.misfit_sphere:
        return "radius of the sphere"
    return "Hertz radius" if scene.body.coating is None else "estimated contact radius"


def _grid_reason(scene: Scene) -> str:
    """Where the cells come from."""
    given = scene.grid
    named = [name for name in ("cells", "extent") if given is not None and getattr(given, name) is not None]
    chosen = [name for name in ("cells", "extent") if name not in named]
    first = scene.patch_surface
    if first is not None and first.kind == "file" and (first is scene.surface or not scene.moves):
        return f"that of {first.table}.path" + (", resampled" if first.resample and "cells" in named else "")
    source = _length(scene)
    if scene.body.plasticity is not None and first is None:
        source += " and the plastic zone, enlarged if that goes further"
    parts = [f"{' and '.join(named)} from [grid]"] if named else []
    return ", ".join(parts + ([f"{' and '.join(chosen)} chosen from the {source}"] if chosen else []))
