# SPDX-License-Identifier: MIT
"""Memory and time that a scene will need in a model. Solves nothing.

Arrays and work are counted from the numbers of cells, elements and steps (`counted`); each count has a
factor, MEMORY (for the arrays that stand beside the counted one) and TIME (seconds for each), fitted to the
ladders of `verification.cost.growth` (`python -m verification.cost.growth` prints them), TIME also to the
scenes of the cases, which it meets within 1.5. Rates are those of one core of a 2020s server processor.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from math import ceil, erf, floor, log2, log10, pi, prod, sqrt
from typing import TYPE_CHECKING, Any

import numpy as np

from sam.scene import Scene, Wear
from verification.runs import models
from verification.runs.model_range import contact_modulus, rms_slope

if TYPE_CHECKING:
    from sam.grid import CellGrid, Window
    from sam.plasticity import ExpectedBox, Zone

IDLE_BYTES = 92e6  # interpreter with numpy, scipy and the model loaded
MEMORY = {  # chunks: what is worked through piece by piece
    models.SAM: {
        "surface": 33.7, "stresses": 5.68, "patch": 3.5, "patch stresses": 7.0, "layered": 1.2, "boxes": 1.0,
        "fields": 104.0, "set-up": 5.0, "chunks": 30e6,
    },
    models.FEM: {"unknowns": 545.0, "steps": 226.0, "points": 152.0},
    models.FEM_3D: {"unknowns": 1780.0, "states": 1.0},
    models.FEM_LINE: {"unknowns": 650.0, "states": 1.0},
}  # fmt: skip
TIME = {
    models.SAM: {
        "solve": 0.0435, "contact": 4e-8, "patch contact": 2.6e-9, "stresses": 6.8e-8, "patch": 1.2e-7,
        "tables": 1.7e-3, "layered": 1.05e-7, "box set-up": 5.5e-8, "box": 1.13e-9, "swept set-up": 2.1e-7,
        "swept": 6.5e-8, "evaluations": 8e-7, "beside": 4.5e-8,
    },
    models.FEM: {"solve": 0.129, "factors": 3.01e-7, "points": 0.0},
    models.FEM_3D: {"solve": 0.0712, "multigrid": 7.6e-8},
    models.FEM_LINE: {"solve": 0.1, "solves": 4.5e-7},
}  # fmt: skip
# Of a patch that repeats, whose coefficients are made in wave numbers, a depth at a time: share of the work
# of stresses, of their memory, and what takes as long for any patch, in units of a solve; and share of the
# memory of fields, whose transforms are a quarter as long.
PERIODIC_FIELDS = 0.6
PERIODIC_WORK, PERIODIC_MEMORY, PERIODIC_SOLVES = 0.4, 1 / 7, 2.5
SETTLES = 0.5  # power of the cycles that count: later ones strain and wear less
RENEWED = 0.65  # the same where each cycle meets another counter-surface: 231 to 1401 iterations in 25 cycles
MULTIGRID = 1.5  # power of the unknowns: 12,000 to 68,000 take 8 to 20 us for each and iteration
FEM_ITERATIONS = 4  # active-set iterations of a load step
ELASTIC_ITERATIONS = 1  # of a load step of SAM below a rough body in which nothing yields: it looks whether
# Further ones of a step of the first cycle, at a tolerance of 1e-3: a factor times a power of the ratio of an
# elastic rough contact's mean pressure to the yield stress at 1 % strain, at most so many times the ratio.
# Fitted to ratios of 0.9 to 6.2 and 1 to 25 cycles: times within a factor 1.5, of seven others one by 1.7.
ROUGH_POWER = 2.5
WITHOUT_FILM, MOST_WITHOUT_FILM = 0.6, 2.3
# Cells in which a film fails add iterations. Counted over 25 cycles of bulk, curve A and curve B, with a
# renewed counter-surface and without: 111 to 396 with those of elastic steps, within a factor of 1.4.
WITH_FILM, MOST_WITH_FILM = 1.5, 7.0
ROUGH_DIGITS = 3.0
# Cells that a cycle removes were those that had hardened: after it by a factor more iterations where the
# strain limit is lower than 1 %, and fewer where it is higher; 0.2 to 5 % measured.
WORN_AT, WORN_POWER, WORN_MOST = 0.01, 1 / 3, 2.0
# Depth that yields below a rough contact over that below a sphere with the area of its largest spot: layers
# within a sixth in 11 contacts of 55 to 4921 cells.
BELOW_SPOT = 0.85
# Cells with the smallest gap, over those expected in contact, that reach as far as an elastic contact does:
# within a tenth of each side of ten boxes of twelve, of 24 to 256 cells.
WIDER_SPOTS = 1.5
# Of a step of SAM below a smooth body, under p0 = ratio times the yield stress at 1 % strain: STEEPER ratio -
# FEWER.
# Measured for ratios of 0.9 to 15, perfectly plastic, linear and Swift, within a factor 1.3 but at first
# yield.
STEEPER = 3.5
FEWER = 1.5
LEAST_ITERATIONS = 1.5  # at first yield: some steps need none
# of the tolerance for which that holds; 3 digits take half of it (6.2 instead of 12.6 at ratio 4)
DIGITS = 6.0
# Newton's iterations of a step of FEM, measured for the same ratio, 1.4 to 4.7, and where steps are halved
NEWTON = 1.6
NEWTON_STEEPER = 1.1
CUT_ABOVE = 5.3  # ratio: 4.7 takes 7 iterations and no cut, 6 takes 31 and one cut a step
NEWTON_CUT = 5.4  # times the ratio: 31 at 6, 55 at 10
NEWTON_COATED = 3.7  # of a coated body, as at the ratio of the ladder
LINE_SOLVES = 10  # linear solves of an iteration of Newton's method in which a section yields: 8 to 12
FACTORS = 2.7  # units of work of an iteration: ten in a step of the ladder, with its search for the contact
# of a step with back-stresses, and for each: 1.41 with one and 2.16 with three, as many points flowing
WITH_BACK_STRESSES, EACH_BACK_STRESS = 1.05, 0.37
HARDENS = 1.3  # yield stress at 1 % strain over the first one: below it the second of
# for each p0/yield stress above 3, the plastic zone is wider by that share than the elastic stress has it
SPREAD = (0.02, 0.05)
# A given pressure does not level off where the body yields: for each p0/yield stress above the first, by
# which share the zone is wider and deeper, hardening (back-stresses too) or not. Measured for 2 to 4.5, with
# 6 and 9 cells in the radius, with and without traction: to a cell.
GIVEN_ABOVE = 2.2
GIVEN_SPREAD = ((0.08, 0.025), (0.24, 0.13))
TRACTION = 0.7  # times the square of the friction: by so much earlier a given load yields, up to 0.25
FREE = 3  # cells that are free beside the zone of a misfit sphere
# Cells: where the zone ends so near to the edge of a box, the box may grow or not: half of both is counted.
# plastic-swift-steel grows where plastic-swift-rigid, with the same zone to 1e-6, does not: 8.1 s and 4.3 s.
UNDECIDED = 0.15
ZONE, ZONE_POINTS = 5.0, 201  # Hertz radii, and points along each: where the elastic stress is looked for
# largest von Mises stress below a sphere over p0 (Johnson 1985, ch. 4, for a Poisson's ratio of 0.3)
MISES = 0.62
MOST_RATIO = 30.0  # p0/yield stress whose zone fits in there


@dataclass(frozen=True)
class Estimate:
    """memory_bytes: largest memory of the process; time_s: processor seconds."""

    memory_bytes: int
    time_s: float


@dataclass(frozen=True)
class Counted:
    """bytes of arrays and numbers of operations, by name, as the factors in MEMORY and TIME have them."""

    bytes: dict[str, float]
    work: dict[str, float]


def estimate(scene: Scene, model: str, made: Any = None) -> Estimate:
    """What `model` will need for a scene that it can represent; made: its plan, if that is at hand."""
    made = models.plan(scene, model) if made is None else made
    found = counted(scene, model, made)
    memory = IDLE_BYTES + sum(MEMORY[model][name] * number for name, number in found.bytes.items())
    seconds = sum(TIME[model][name] * number for name, number in found.work.items())
    if model == models.SAM and made.coarser is not None:
        seconds += estimate(scene, model, made.coarser).time_s
    return Estimate(round(memory), float(f"{seconds:.2g}"))


def counted(scene: Scene, model: str, made: Any = None) -> Counted:
    """What is counted of a scene in a model; made: the plan of the model, if that is at hand."""
    made = models.plan(scene, model) if made is None else made
    of_models = {models.SAM: _sam, models.FEM: _axisymmetric, models.FEM_3D: _spatial}
    return {**of_models, models.FEM_LINE: _line}[model](scene, made)


def steps_of(scene: Scene) -> int:
    """Load steps of a cycle, those along the path included; none without load."""
    return (scene.loading.steps + scene.strokes.count) * loaded(scene)


def loaded(scene: Scene) -> bool:
    """Whether there is any load: a given pressure, an approach, or a force above zero."""
    return scene.loading.force != 0.0


def flows(scene: Scene) -> bool:
    """Whether the body or its film yields."""
    coating = scene.body.coating
    return scene.body.plasticity is not None or (coating is not None and coating.yield_stress is not None)


def plastic_boxes(scene: Scene, plan: Any, beyond: float = 0.0) -> list[ExpectedBox]:
    """The boxes around the plastic zone, the first one and what it grows to, as the solver makes them: a
    little wider (SPREAD) than the zone of Hertz' elastic stress; below a rough body around the contact.
    plan: of SAM; beyond: cells by which the zone is wider than is guessed.
    """
    from sam.plasticity import ExpectedBox, expected_sides

    grid = plan.grid
    faces = np.asarray(grid.depths if grid.faces is None else grid.faces)
    tolerance = scene.solver.tolerance
    if scene.patch_surface is not None or not loaded(scene):
        window, layers = _rough_box(scene, plan)
        sides, worn = [window.shape], scene.wear is not None and scene.wear.removes
        if worn and scene.loading.cycles > 1 and window != grid.whole:
            sides.append(grid.shape)  # where summits are worn others touch
        operator, in_cells, repeats = scene.solver.operator, tuple(faces / grid.hx), plan.period is not None
        return [ExpectedBox(*each, layers, tolerance, False, operator, in_cells, repeats) for each in sides]
    depths = (faces[1:] + faces[:-1]) / 2
    if scene.loading.misfit_sphere:
        return [_box_of_sphere(scene, grid, depths, beyond)]
    zone = _zone(scene, grid, depths)
    wide, deep = zone.needed
    zone = replace(zone, needed=(wide + beyond * min(grid.hx, grid.hy) / min(zone.axes), deep))
    found = expected_sides(grid, depths, zone)
    turns, operator, in_cells = _turns(scene, grid), scene.solver.operator, tuple(faces / grid.hx)
    return [ExpectedBox(*box, tolerance, box[0] == box[1] and turns, operator, in_cells) for box in found]


def contact_share(scene: Scene, pressure: float) -> float:
    """Share of a rough patch in elastic contact under a mean pressure in Pa, by erf(sqrt(pi) p/(E* h')), h'
    the rms slope, whose slope 2 for light loads is that of Hyun et al., Phys. Rev. E 70 (2004) 026117, and
    which ends at 1 as by Persson, J. Chem. Phys. 115 (2001) 3840; 1 without a slope.
    """
    slope = rms_slope(scene)
    return erf(sqrt(pi) * pressure / (contact_modulus(scene) * slope)) if slope else 1.0


def _rough_box(scene: Scene, plan: Any) -> tuple[Window, int]:
    """The box around a rough contact, where the gap is smallest, WIDER_SPOTS wider; and its layers, as deep
    as yields below a sphere with the area of the largest spot and with the mean pressure of all.
    """
    from scipy.ndimage import label

    from sam.contact import Counters, around
    from sam.plasticity import or_whole

    grid, force, depths = plan.grid, scene.loading.force, len(plan.grid.depths)
    if not force or scene.counterbody is None:
        return grid.whole, depths
    area, plane = grid.nx * grid.ny * grid.cell_area, scene.counterbody.shape == "flat"
    share = contact_share(scene, force / area) if plane else pi * prod(plan.axes) / area
    gap = plan.problem(Counters()).gap(plan.schedule.peak)
    spots = label(gap <= np.quantile(gap, min(share, 1.0)))[0]
    radius = sqrt(np.bincount(spots.flat)[1:].max() * grid.cell_area / pi)
    ratio = 1.5 * force / (share * area) / scene.body.plasticity.strength().least(0.0)
    deep = radius * _elastic_zone(min(ratio, MOST_RATIO), scene.body.poisson)[1]
    layers = min(max(int(np.searchsorted(grid.depths, BELOW_SPOT * deep)) + 1, 2), depths)
    if plan.period is not None or len(plan.schedule.path) > 1 or plan.schedule.renews:
        return grid.whole, layers
    return or_whole(around(gap <= np.quantile(gap, min(WIDER_SPOTS * share, 1.0))), grid), layers


def _box_of_sphere(scene: Scene, grid: CellGrid, depths: np.ndarray, beyond: float) -> ExpectedBox:
    """The box around the plastic zone of a misfit sphere, which is known to a cell."""
    from sam import misfit_zone
    from sam.plasticity import ExpectedBox

    zone = misfit_zone(scene)
    sides = zip((grid.hx, grid.hy), grid.shape, strict=True)
    half = [floor(zone / h + 0.5 * (1 - n % 2) + beyond) + FREE for h, n in sides]
    nx, ny = (min(2 * each + n % 2, n) for each, n in zip(half, grid.shape, strict=True))
    layers = min(int(np.searchsorted(depths, scene.loading.depth + zone)) + 1, len(depths))
    turns = nx == ny and grid.hx == grid.hy
    return ExpectedBox(nx, ny, layers, scene.solver.tolerance, exchange=turns)


def _turns(scene: Scene, grid: CellGrid) -> bool:
    """Whether a quarter turn of a smooth scene changes nothing: see `sam.plasticity.model.Model`."""
    from sam import hertz_semi_axes

    at_rest = not scene.coefficient and scene.loading.path is None and not scene.loading.prescribed
    worn = scene.wear is not None and scene.wear.removes
    round_ = scene.counterbody is not None and len(set(hertz_semi_axes(scene))) == 1
    return at_rest and round_ and not worn and grid.hx == grid.hy and scene.solver.method != "paper"


def _zone(scene: Scene, grid: CellGrid, depths: np.ndarray) -> Zone:
    """The contact and the plastic zone of a smooth scene, from the stress below a Hertz contact."""
    from sam import hertz_semi_axes
    from sam.plasticity import Zone

    ratio, hardening = load_ratio(scene, depths)
    ratio *= 1 + TRACTION * scene.coefficient**2 * scene.loading.hertz
    wide, deep = _elastic_zone(min(ratio, MOST_RATIO), scene.body.poisson)
    wider, deeper = SPREAD[hardening < HARDENS] * max(ratio - 3, 0.0), 0.0
    if scene.loading.hertz:
        soft = hardening + _back_hardening(scene, depths) < HARDENS
        wider, deeper = (share * max(ratio - GIVEN_ABOVE, 0.0) for share in GIVEN_SPREAD[soft])
    needed, path = ((1 + wider) * wide, (1 + deeper) * deep), _path_cells(scene, grid)
    slides = bool(scene.coefficient) or scene.loading.path is not None
    axes = hertz_semi_axes(scene)
    axes = (axes[0], axes[0]) if grid.line else axes
    return Zone(axes, wide, deep, needed, MISES * ratio, slides, path)


def _back_hardening(scene: Scene, depths: np.ndarray) -> float:
    """What back-stresses add at 1 % strain, over the least yield stress at these depths."""
    strength = scene.body.plasticity.strength()
    over_depth = strength.stress(depths, np.zeros(1))
    z = depths[over_depth.argmin()]
    if (back := strength.back_at(z)) is None:
        return 0.0
    modulus, recovery = back
    path, falls = np.full_like(recovery, 0.01), recovery > 0
    np.divide(-np.expm1(-0.01 * recovery), recovery, out=path, where=falls)
    return float((modulus * path).sum() / over_depth.min())


def load_ratio(scene: Scene, depths: np.ndarray) -> tuple[float, float]:
    """(p0 of the elastic contact over the least yield stress here, yield stress at 1 % over that at 0)."""
    strength = scene.body.plasticity.strength()
    over_depth = strength.stress(depths, np.zeros(1))
    weakest = strength.curve_at(depths[over_depth.argmin()])
    first, later = (float(weakest.stress(np.full(1, strain))[0]) for strain in (0.0, 0.01))
    return peak_pressure(scene) / float(over_depth.min()), later / first


def plastic_iterations(scene: Scene, grid: CellGrid) -> float:
    """Iterations of a load step of the semi-analytical model below a smooth body."""
    digits = -log10(scene.solver.tolerance) / DIGITS
    ratio, hardening = load_ratio(scene, grid.depths)
    return digits * max(STEEPER * ratio / hardening - FEWER, LEAST_ITERATIONS)


def rough_iterations(scene: Scene, plan: Any) -> tuple[float, float]:
    """Load steps of all cycles below a rough body, and iterations beyond those of steps in which nothing
    yields, by the elastic mean pressure E* / 2 times the root mean square slope (Hyun et al., Phys. Rev. E 70
    (2004) 026117).
    """
    opposite, cycles = plan.rough.opposite, plan.schedule.cycles
    slope = plan.rough.roughness(0.0 if opposite is None else -opposite(0, plan.schedule.path[0])).sdq
    ratio = plan.pair.contact_modulus * slope / 2 / scene.body.plasticity.strength().least(0.01)
    film = plan.tribofilm is not None
    factor, most = (WITH_FILM, MOST_WITH_FILM) if film else (WITHOUT_FILM, MOST_WITHOUT_FILM)
    further = min(factor * ratio**ROUGH_POWER, most * ratio) * -log10(scene.solver.tolerance) / ROUGH_DIGITS
    later = cycles ** (RENEWED if plan.schedule.renews else SETTLES) - 1
    rows = cycles * (plan.steps + plan.schedule.unloads)
    return rows, further * plan.steps * (1 + _worn(scene.wear) * later)


def _worn(wear: Wear | None) -> float:
    """Factor on the iterations after the first cycle of a body that wears; 1 of one that does not."""
    if wear is None or not wear.removes:
        return 1.0
    limit = wear.strain_limit if wear.strain_limit_layer is None else wear.strain_limit_layer
    return min(max((WORN_AT / limit) ** WORN_POWER, 1 / WORN_MOST), WORN_MOST)


def newton_iterations(scene: Scene) -> float:
    """Iterations of a load step of FEM in which something yields."""
    if scene.body.plasticity is None or scene.body.coating is not None or scene.patch_surface is not None:
        return NEWTON_COATED
    ratio, hardening = load_ratio(scene, np.zeros(1))
    ratio /= hardening
    return NEWTON + NEWTON_STEEPER * ratio if ratio < CUT_ABOVE else NEWTON_CUT * ratio


def peak_pressure(scene: Scene) -> float:
    """p0 of the elastic contact in Pa; of a misfit sphere that of a contact with its largest stress."""
    if scene.loading.hertz:
        return scene.loading.p0
    if scene.loading.misfit_sphere:
        return _largest_mises(scene) / MISES
    from sam import expected_force, hertz_semi_axes

    area, line = np.pi * np.prod(hertz_semi_axes(scene)), scene.counterbody.length is not None
    return (1.0 if line else 1.5) * expected_force(scene) / area if area else 0.0


def _largest_mises(scene: Scene) -> float:
    """The largest von Mises stress about a misfit sphere, Pa, if the body stayed elastic."""
    from verification.reference.misfit_sphere import PROFILES

    body, loading = scene.body, scene.loading
    found = PROFILES[loading.profile](np.linspace(0.0, 2.0, 201))[1].max()
    return float(found) * body.young * loading.misfit / (1 - body.poisson)


def _path_cells(scene: Scene, grid: CellGrid) -> tuple[int, int]:
    """Cells that a travelling load passes, in x and y."""
    path = scene.loading.path
    if path is None:
        return 0, 0
    (x0, y0), (x1, y1) = path.start, path.end
    return ceil(abs(x1 - x0) / grid.hx), ceil(abs(y1 - y0) / grid.hy)


@lru_cache(maxsize=64)
def _elastic_zone(ratio: float, poisson: float) -> tuple[float, float]:
    """(radius, depth) in Hertz radii of where the stress of Hertz exceeds the yield stress, p0/ratio."""
    from verification.reference.hertz import subsurface_stress
    from verification.reference.stress import von_mises

    at = np.linspace(0.0, ZONE, ZONE_POINTS)
    stress = subsurface_stress(at[:, None], 0.0, at[None, :], 1.0, contact_radius=1.0, nu=poisson)
    excess = von_mises(stress) - 1 / ratio
    return _farthest(at, excess), _farthest(at, excess.T)


def _farthest(at: np.ndarray, excess: np.ndarray) -> float:
    """The farthest place along the first axis where (n, m) values cross zero downwards, or 0."""
    before, after = excess[:-1], excess[1:]
    i, j = np.nonzero((before > 0) & (after <= 0))
    return float(np.max(at[i] + (at[1] - at[0]) * before[i, j] / (before[i, j] - after[i, j]), initial=0.0))


def _sam(scene: Scene, plan: Any) -> Counted:
    """Of the semi-analytical model, for a contact half as wide as the grid."""
    grid, steps, rough = plan.grid, plan.steps, plan.rough is not None
    cells, depths, loads = grid.nx * grid.ny, len(grid.depths), 1 + plan.slip.slides  # pressure and traction
    sizes = {each.stage: each.size for each in plan.stages if each.runs}
    coefficients = sizes.get("stresses at the output depths", {}).get("coefficients", 0)  # none without load
    met = {load.stretch for load in plan.schedule.peaks}  # by an elastic body
    contacts = (len(met) if plan.plasticity is None else 1) * steps * cells * log2(cells)
    block = 8 * coefficients * (plan.held_depths[0] / depths)  # of those with coefficients
    memory = {"surface": 8.0 * cells, "patch" if rough else "stresses": block}
    if rough and steps:
        memory["patch stresses"] = 48.0 * cells * plan.held_depths[1]  # of those with stresses
    of_grid = {"contact": contacts, "stresses": loads * coefficients}
    work = {"solve": 1.0} | ({"patch contact": contacts, "patch": loads * coefficients} if rough else of_grid)
    if plan.period is not None:
        memory["patch"] = 48.0 * cells
        memory["patch stresses"] = PERIODIC_MEMORY * memory.get("patch stresses", 0.0)
        work |= {"solve": 1.0 + PERIODIC_SOLVES, "patch": PERIODIC_WORK * work["patch"]}
    if plan.coated is not None and steps:  # and the same contact without it
        memory["layered"] = block
        work |= {name: 2 * number for name, number in work.items() if name != "solve"}
        work |= {"tables": loads * (1 + depths), "layered": loads * (cells + coefficients)}
    if plan.plasticity is None or not steps:
        return Counted(memory, work)
    from sam.plasticity import held

    boxes = plastic_boxes(scene, plan)
    last, cycles = boxes[-1], plan.schedule.cycles
    kept = 4 if rough else 2 if loads > 1 or len(plan.schedule.path) > 1 else 1  # numbers of a wave number
    if rough:
        rows, further = rough_iterations(scene, plan)
        iterations = ELASTIC_ITERATIONS * rows + further
    else:
        rows = steps * cycles**SETTLES
        iterations = plastic_iterations(scene, grid) * rows
    if count := plan.plasticity.back_stresses:
        iterations *= WITH_BACK_STRESSES + EACH_BACK_STRESS * count
    plane, beside = _beside(scene, plan, last)
    work["beside"] = beside * (1 + (scene.wear is not None and scene.wear.removes))  # other strain, unloaded
    fields, share = max(box.cells for box in [last, *plane]), PERIODIC_FIELDS if last.periodic else 1.0
    memory = {  # the stresses of the elastic body are gone when the boxes come
        "surface": memory["surface"],
        "boxes": float(sum(box.width * box.coefficients for box in [*held(boxes), *plane])),
        "fields": 8.0 * fields * share,
        "set-up": 8.0 * max(last.set_up / last.layers, beside / depths),
        "chunks": 1.0,
    }
    either = [plastic_boxes(scene, plan, beyond) for beyond in (-UNDECIDED, UNDECIDED)]
    for box in [each for boxes in [*either, plane, plane] for each in boxes]:
        name = "swept set-up" if box.swept else "box set-up"
        work[name] = work.get(name, 0.0) + box.set_up / 2
    work["evaluations"] = (iterations + rows) * (boxes[0].cells + last.cells) / 2
    if rough and (boxes[0].nx, boxes[0].ny) != grid.shape:
        work["patch"] += 6.0 * last.layers * cells  # displacement beside the box
    iterations += sum(box.waves * box.layers for box in plane) / (last.waves * last.layers)
    if last.swept:
        work["swept"] = iterations * last.width / 8 * 6.0 * last.layers * last.waves * kept
    else:
        work["box"] = iterations * last.width / 8 * sum(each[-1].coefficients for each in either) / 2
    return Counted(memory, work)


def _beside(scene: Scene, plan: Any, box: ExpectedBox) -> tuple[list[ExpectedBox], float]:
    """What the stress in y = 0 outside of a box takes: an operator of all columns through the box, where that
    is swept for its size, or so many coefficients.
    """
    grid, rows, depths = plan.grid, plan.grid.axis_rows, len(plan.grid.depths)
    i, j, nx, ny = (grid.nx - box.nx) // 2, (grid.ny - box.ny) // 2, box.nx, box.ny
    if plan.rough is not None and (nx, ny) != grid.shape:
        window = _rough_box(scene, plan)[0]
        i, j = window.i0, window.j0
    first, end = min(j, rows.j0 - 1), max(j + ny, rows.j0 + rows.ny + 1)
    covered = box.layers * (nx == grid.nx and end - first == ny)
    if plan.period is not None or (box.large and box.operator != "dense"):
        wide = replace(box, nx=grid.nx, ny=end - first, layers=depths, exchange=False)
        return [wide] * (covered < depths), 0.0
    lags = max(i + nx, grid.nx - i) * max(j + ny - rows.j0, rows.j0 + rows.ny - j)  # in x, times those in y
    return [], 36.0 * (depths - covered) * box.layers * lags


def _axisymmetric(scene: Scene, plan: Any) -> Counted:
    """Of the axisymmetric model; a coated body is solved without its film too."""
    points, unknowns, steps = plan.points, plan.unknowns, steps_of(scene)
    factor, again = unknowns**1.2, 1 + (plan.bare is not None)
    factors = 1 + steps * FEM_ITERATIONS
    work = {"solve": float(again)}
    if flows(scene):
        iterations = steps * scene.loading.cycles * FACTORS * newton_iterations(scene)
        factors, work["points"] = 1 + iterations, again * iterations * points
    memory = {"unknowns": 8.0 * unknowns, "steps": 8.0 * unknowns * (steps > 1)}
    memory["points"] = 8.0 * points * flows(scene)
    return Counted(memory, work | {"factors": again * factor * factors})


def _spatial(scene: Scene, plan: Any) -> Counted:
    """Of the three-dimensional model, from the mesh that it would use."""
    unknowns, iterations = plan.unknowns, FEM_ITERATIONS
    if flows(scene):
        iterations *= scene.loading.cycles
    iterations *= 1 + (scene.body.coating is not None)
    work = {"solve": 1.0, "multigrid": unknowns**MULTIGRID * steps_of(scene) * iterations}
    return Counted({"unknowns": 8.0 * unknowns, "states": _held_states(scene, plan)}, work)


def _line(scene: Scene, plan: Any) -> Counted:
    """Of the plane-strain model: linear solves, one for each node in contact, and those of Newton."""
    steps = steps_of(scene)
    solves = (2.0 if plan.half else 4.0) * plan.cells_per_radius + 2.0 * steps
    if flows(scene):
        solves += LINE_SOLVES * newton_iterations(scene) * steps * scene.loading.cycles
    states = _held_states(scene, plan)
    if flows(scene) and not scene.moves:
        states = 8.0 * steps * scene.loading.cycles * (plan.unknowns + 7 * plan.points)
    work = {"solve": 1.0, "solves": solves * plan.unknowns}
    return Counted({"unknowns": 8.0 * plan.unknowns, "states": states}, work)


def _held_states(scene: Scene, plan: Any) -> float:
    """Bytes of the states kept while a counter-body moves: ends of passes, and all of a judged period."""
    if not (scene.moves and flows(scene)):
        return 0.0
    plasticity, judging = scene.body.plasticity, plan.judging
    back = 0 if plasticity is None else plasticity.back_stresses
    states = scene.loading.cycles + (0 if judging is None else judging.period * steps_of(scene))
    return 8.0 * states * (plan.unknowns + plan.points * (7 + 6 * back))
