# SPDX-License-Identifier: MIT
"""A result with the numerical uncertainty of its quantities: the formal order of the error of each, or why it
has none, the coarser companions of a scene, and what the results of all say together.
"""

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import ceil, floor, inf, sqrt
from typing import Any

import numpy as np

import sam
from sam.grid import CellGrid, Room
from sam.scene import COLUMNS, Problem, Result, Scene, SceneError, Status, spelling
from verification.runs import models
from verification.runs.files import Run
from verification.runs.tables import contact_size
from verification.scenes import with_keys
from verification.uncertainty.rule import EDGE, FACTOR, STEP_FACTOR, bound, converging, of_edge, order_seen

Solve = Callable[[Scene, str], Result]
"""Solves a scene of the family; the text says which it is."""
NOT_CONVERGING = "not converging: the last refinement changed more than the one before"

# the quantities

ORDERS = dict.fromkeys(
    (
        *("force_N", "approach_m", "contact_area_m2", "contact_radius_m", "friction_coefficient"),
        "contact_half_width_m",
        *("p_max_Pa", "p_center_Pa", "mises_max_Pa", "peeq_max", "peeq_p95", "residual_uz_center_m"),
        *("p_max_bare_Pa", "mises_max_bare_Pa", "mises_max_substrate_Pa", "mises_max_film_Pa"),
        *("p_max_change", "mises_max_change", "tangential_displacement_center_m", "residual_ux_center_m"),
        *("plastic_shear_center_m", "groove_depth_m", "groove_deepest_m", "contact_share"),
    ),
    2.0,
) | {"wear_volume_m3": 1.0}
"""Quantity -> order in the cells; that in the load steps is 1, of backward Euler, for all."""
EDGES = {"contact_area_m2": 0.3, "contact_radius_m": 0.15, "contact_half_width_m": 0.15}
OUTLINE_FACTOR = 2.0
"""Of a contact of SAM with one outline, by quantity: EDGE of the rule, and the factor in place of FACTOR. The
area errs to either side, more so on the coarser grids, and differences of grids are already larger than the
error of the finest. Of 293 triplets of Hertz's contact, 4 to 33 cells in the radius, the apex at the centre
of a cell or between four, 99.7 % are covered, U/error 4.6 in the median; with a factor of 3 as many, 6.2.
"""
STEP_ORDER = 1.0
BOX_ORDERS = dict.fromkeys(("residual_uz_center_m", "residual_ux_center_m", "plastic_shear_center_m"), 1.0)
"""The same in the size of the finite-element box; 2 of all others. From 5 to 34 radii the approach and the
largest pressure and strain of Hertz's and of a yielding contact were seen to settle with 2.2 to 3.2, a
residual displacement with 1.2.
"""

BALANCED = (
    *("force_N", "approach_m", "contact_area_m2", "contact_radius_m", "contact_share"),
    *("friction_coefficient", "wear_volume_m3"),
)
"""What the balance of forces over many spots decides; a maximum below a rough body is that of one spot."""
OF_EDGE = (
    *("p_max_Pa", "mises_max_Pa", "p_max_bare_Pa", "mises_max_bare_Pa", "p_max_change", "mises_max_change"),
    *("mises_max_substrate_Pa", "mises_max_film_Pa", "peeq_max"),
)
OF_ELEMENTS = ("approach_m", "force_N")
"""What alone the edge of a contact in an element changes by more than the rest of the rule knows: coarser
meshes have a node at Hertz's radius too, and agree by chance. Of 35 values of five spheres beyond yield (9 to
20 elements) 24 of the approach are covered without it and all with it; of p_max all, of peeq_max 34 without.
"""
WHY_NOT = {
    "mises_max_depth_m": "the place of a maximum moves by whole points",
    "peeq_max_depth_m": "the place of a maximum moves by whole cells",
    "residual_mises_max_Pa": "its maximum moves to another place as the cells become smaller",
    "pressure_centroid_x_m": "it is zero, or a small difference of large numbers",
}
SINGULAR = "the stress is singular at the edge of the punch"
WHOLE_RINGS = "the cells have the area of the punch as closely as whole rings allow"
ONE_SPOT = "a maximum below a rough body is that of a single spot"
UNKNOWN = "none was measured for it"
NONE_AT_ALL = (*WHY_NOT.values(), SINGULAR, WHOLE_RINGS, ONE_SPOT, UNKNOWN)


def is_given(name: str, scene: Scene) -> bool:
    """Whether the scene gives a quantity, so that it has no error."""
    loading = scene.loading
    if name == "friction_coefficient":
        return scene.constant_friction
    if name == "wear_volume_m3":
        return scene.wear is None
    if loading.prescribed is not None and name in ("p_max_Pa", "p_center_Pa", "contact_area_m2"):
        return True
    given = "approach_m" if loading.approach is not None else "force_N"
    return name == given or (loading.prescribed is not None and name == "contact_radius_m")


def why_not(name: str, scene: Scene) -> str:
    """Why a quantity of a scene has no uncertainty; empty if it has one."""
    other = scene.counterbody
    if other is not None and other.shape == "punch" and name in (*OF_EDGE, *EDGES):
        return SINGULAR if name in OF_EDGE else WHOLE_RINGS
    if scene.patch_surface is not None and name in ORDERS and name not in BALANCED:
        return ONE_SPOT
    return WHY_NOT.get(name, "" if name in ORDERS else UNKNOWN)


# the family of scenes

RATIO = 1.5  # of neighbouring cell sizes and load steps
# The same of elements of the axisymmetric model, at most, and elements that are left in the radius: 96 % of
# the errors of seven spheres with 9 to 24 elements are covered, as many as with 1.5, which costs more.
WIDEST, LEFT = 2.0, 5.0
LEAST_IN_RADIUS = 4.0  # cells in the contact radius of the coarsest: below it the rule covers less
LEAST_BOX = 3.0  # of [fem], in radii
# Of the largest von Mises stress: at depths with less its largest value is not looked for. It then takes a
# third of the depths, and 1.4 to 1.5 times the cost of the plain solve in place of 2.2 for a coated sphere.
LARGE = 0.85
WIDER = 1.5  # sides and depth of coarse cells over those of the fine ones, where these are too small
AT_EDGE = (Status.PLASTIC_ZONE_AT_GRID_EDGE, Status.CONTACT_AT_GRID_EDGE)
FEWEST_STEPS = 4  # from so many on the others have fewer, else more


@dataclass(frozen=True)
class Member:
    """label: for the reader; number: of cells or load steps; size: what its error falls with; result: once
    it is solved.
    """

    scene: Scene
    label: str
    number: float
    size: float
    result: Any = None


@dataclass(frozen=True)
class Family:
    """The scenes that an uncertainty needs. cells: finest first; steps: on the coarsest of them, beginning
    with it; box: beginning with the last of steps, or of cells; empty where history or box decide nothing.
    edge: cells in the radius if it falls between them.
    """

    cells: Sequence[Member]
    steps: Sequence[Member] = ()
    box: Sequence[Member] = ()
    edge: float = inf

    @property
    def all(self) -> tuple[Member, ...]:
        """Every scene once, the finest first."""
        return (*self.cells, *self.steps[1:], *self.box[1:])

    @property
    def reason(self) -> str:
        """Why the results are not of one family; empty if they are."""
        finer = "grid.cells" if self.cells[0].result.model == models.SAM else "fem.cells_per_radius"
        parts = {finer: self.cells, "loading.steps": self.steps, "fem.box": self.box}
        for key, members in parts.items():
            for member in members:
                if not member.result.converged:
                    return f"{member.label}: {member.result.status}: raise {key}"
        every = itertools.chain(*parts.values())
        cuts = {each.label: each.result.cost.get("step_cuts") or 0 for each in every}
        if len(set(cuts.values())) > 1:
            words = ", ".join(f"{cut} with {label}" for label, cut in cuts.items())
            return f"load steps were cut differently ({words}): raise loading.steps"
        return ""


class NoFamilyError(ValueError):
    """A scene that cannot be put on coarser cells; the message says why."""


def alone(scene: Scene) -> Scene:
    """The scene without its uncertainty, and asked for no accuracy: what a model solves."""
    return with_keys(scene, "solver", uncertainty=False, accuracy=None, accuracy_of=None)


def family(
    scene: Scene, model: str, room: Room | None = None, depths: Sequence[float] | None = None
) -> Family:
    """The scenes that the uncertainty of a scene is taken from; room: of a grid that was enlarged;
    depths: to which the coarser ones of an elastic body are limited, see `depths_of_maxima`. Raises
    NoFamilyError.
    """
    scene = alone(scene)
    cells = tuple(_cell_members(scene, model, room or Room(), depths))
    for member in cells[1:]:
        for key, allowed in member.scene.excesses():
            raise NoFamilyError(f"{member.label}: {key}: {allowed}")
        try:
            models.check(member.scene, model)
        except models.ModelError as reason:
            raise NoFamilyError(f"{member.label}: {reason}") from None
    return _with_steps_and_box(cells, model)


def _with_steps_and_box(cells: Sequence[Member], model: str) -> Family:
    steps = members_of_steps(cells[-1]) if has_history(cells[-1].scene) else ()
    box = members_of_box((steps or cells)[-1]) if model != models.SAM else ()
    return Family(cells, steps, box)


def cells_to_edge(scene: Scene, fine: Result, family: Family) -> float:
    """Cells of a result in the radius of its contact; infinite where no edge falls between cells."""
    area = fine.quantities.get("contact_area_m2")
    if scene.counterbody is None or scene.patch_surface is not None or not area:
        return np.inf
    if fine.model != models.SAM:
        moved = scene.body.plasticity is not None or scene.body.coating is not None
        return family.cells[0].number if moved else np.inf
    wide = fine.quantities.get("contact_half_width_m") or sqrt(area / np.pi)
    return wide / family.cells[0].size


def coarser(count: int, factor: float) -> int:
    """A number of cells over a factor, odd if the number is: a cell centre then stays on the apex."""
    odd = count % 2
    return 2 * floor((count / factor - odd) / 2 + 0.5) + odd


def cell_size(grid: CellGrid) -> float:
    """Size of a cell in m; of a row along x below a cylinder its width, as all is the same along y."""
    return grid.hx if grid.ny == 1 else sqrt(grid.hx * grid.hy)


def step_counts(count: int) -> tuple[int, int, int]:
    """Three numbers of load steps, that of the scene first."""
    if count >= FEWEST_STEPS:
        return count, _whole(count / RATIO), max(_whole(count / RATIO**2), 2)
    middle = max(_whole(count * RATIO), count + 1)
    return count, middle, max(_whole(count * RATIO**2), middle + 1)


def _whole(value: float) -> int:
    return floor(value + 0.5)


def has_history(scene: Scene) -> bool:
    """Whether load steps decide anything: something yields, or a film breaks down."""
    coating, friction = scene.body.coating, scene.friction
    if scene.body.plasticity is not None or (friction is not None and friction.film):
        return True
    return coating is not None and coating.yield_stress is not None


def depths_of_maxima(scene: Scene, fine: Result) -> tuple[float, ...] | None:
    """The output depths about the largest stresses of an elastic body, in its film and below, which decide
    all that its coarser companions are asked for; any one below a rough body, where they are asked for no
    stress. None where the depths of a body that yields are its layers, or for finite elements.
    """
    table = fine.tables.get("plane")
    if fine.model != models.SAM or has_history(scene) or not table:
        return None
    z, mises = (np.asarray(table[name], dtype=float) for name in ("z_m", "mises_Pa"))
    depths, place = np.unique(z, return_inverse=True)
    if scene.patch_surface is not None:
        return (float(depths[0]),)
    largest = np.zeros(depths.size)
    np.maximum.at(largest, place, mises)
    film = depths < (0.0 if scene.body.coating is None else scene.body.coating.thickness)
    kept = [each & (largest >= LARGE * largest[each].max()) for each in (film, ~film) if each.any()]
    return tuple(map(float, depths[np.logical_or.reduce(kept)]))


def _cell_members(scene: Scene, model: str, room: Room, depths: Sequence[float] | None) -> list[Member]:
    other = scene if has_history(scene) else in_one_step(scene)
    if scene.patch_surface is None and model != models.SAM:
        count = scene.fem.cells_per_radius
        ratio = min(max(sqrt(count / LEFT), RATIO), WIDEST) if model == models.FEM else RATIO
        of = [(scene, count), *((other, max(_whole(count / ratio**k), 2)) for k in (1, 2))]
        scenes = [(with_keys(each, "fem", cells_per_radius=n), n) for each, n in of]
        return [Member(each, f"{n} elements in the radius", n, 1.0 / n) for each, n in scenes]
    grid = sam.plan(scene).on(room).grid
    first = Member(scene, f"{grid.nx} cells", grid.nx, cell_size(grid))
    return [first, *(_of_grid(other, grid, RATIO**k, depths) for k in (1, 2))]


def in_one_step(scene: Scene) -> Scene:
    """The same load of an elastic body at once; a way is gone as it is."""
    if scene.strokes.count:
        return scene
    return with_keys(scene, "loading", steps=1, unload_steps=None)


def _of_grid(scene: Scene, grid: CellGrid, factor: float, depths: Sequence[float] | None) -> Member:
    """The scene on a grid with larger cells over the same sides; depths: as those of `family`."""
    nx, ny = (max(coarser(count, factor), min(count, 3)) for count in grid.shape)
    sides = grid.nx * grid.hx, grid.ny * grid.hy
    change: dict[str, object] = {"cells": (nx, ny)}
    if scene.patch_surface is None:
        change["extent"] = sides
    if grid.faces is not None:
        change |= {"depths": _faces(scene, grid.faces, nx / grid.nx), "layers": None, "depth": None}
    elif depths is not None:
        change |= {"depths": tuple(depths), "layers": None, "depth": None}
    size = sides[0] / nx if ny == 1 else sqrt(sides[0] * sides[1] / (nx * ny))
    return Member(with_keys(scene, "grid", **change), f"{nx} cells", nx, size)


def _faces(scene: Scene, faces: np.ndarray, share: float) -> tuple[float, ...]:
    """Fewer faces of layers, interpolated in their number; those where the yield stress has a kink stay."""
    layers = len(faces) - 1
    places = np.linspace(0.0, layers, max(_whole(layers * share), 2) + 1)
    found = np.interp(places, np.arange(layers + 1), faces)
    for kink in scene.body.plasticity.strength().kinks.depths:
        if np.isclose(faces[1:-1], kink, rtol=1e-9, atol=0.0).any():
            found[1 + np.abs(found[1:-1] - kink).argmin()] = kink
    return tuple(map(float, np.unique(found)))


def wider(member: Member) -> Member:
    """The member with half as many cells again beside its own and layers below them, where they may be more:
    cells and layers of the same size in the same places. Of a sphere that fits both grids every quantity
    is the same within 6e-11.
    """
    grid, change = sam.plan(member.scene).grid, {}
    if member.scene.patch_surface is None:
        cells = [n + 2 * ceil(n * (WIDER - 1) / 2) * (n > 1) for n in grid.shape]
        change = {"cells": tuple(cells), "extent": (cells[0] * grid.hx, cells[1] * grid.hy)}
    if (faces := grid.faces) is not None:
        last = faces[-1] - faces[-2]
        deeper = np.append(faces, np.arange(faces[-1], WIDER * faces[-1], last) + last)
        change |= {"depths": tuple(map(float, deeper)), "layers": None, "depth": None}
    scene = with_keys(member.scene, "grid", **change)
    return replace(member, scene=scene, label=f"{member.label} and more beside them")


def members_of_steps(coarsest: Member) -> tuple[Member, ...]:
    """A scene with its number of load steps and two others, its own first."""
    loading = coarsest.scene.loading
    along = coarsest.scene.strokes.count
    whole = loading.steps + along
    members = []
    for count in step_counts(whole):
        share = count / whole
        change: dict[str, object] = {"steps": _share(loading.steps, share) if along else count}
        if loading.unload_steps:
            change["unload_steps"] = _share(loading.unload_steps, share)
        if along:
            own = {"steps": _share(along, share), "step_per_radius": None}
            change["path"] = loading.path.model_copy(update=own)
        scene = with_keys(coarsest.scene, "loading", **change)
        members.append(Member(scene, f"{count} load steps on {coarsest.label}", count, 1.0 / count))
    return tuple(members)


def _share(count: int, share: float) -> int:
    return max(_whole(count * share), 1)


def members_of_box(coarsest: Member) -> tuple[Member, ...]:
    """A scene with its finite-element box and a smaller one; none where that would be too small."""
    scene, box = coarsest.scene, coarsest.scene.fem.box
    if box / RATIO < LEAST_BOX:
        return ()
    scenes = {size: with_keys(scene, "fem", box=size) for size in (box, box / RATIO)}
    label = f"a box of {{:.3g}} radii on {coarsest.label}"
    return tuple(Member(each, label.format(size), size, 1.0 / size) for size, each in scenes.items())


# their results


def solve(scene: Scene, model: str, solver: Solve | None = None) -> Result:
    """The result of a scene, with its uncertainty if asked for. solver: `models.solve` by default."""
    how = solver or (lambda each, _: models.solve(each, model))
    return with_uncertainty(scene, model, how) if scene.solver.uncertainty else how(scene, "")


def asked_of(scene: Scene, source: str) -> Scene:
    """The scene, asked for its uncertainty. SceneError where there is none; source: names it in errors."""
    asked = with_keys(scene, "solver", uncertainty=True)
    solver = asked.solver
    own = ((f"solver.{key}", words) for key, words in solver.conflicts(solver.model_dump(exclude_none=True)))
    if found := [*own, *asked.excesses()]:
        raise SceneError([Problem(key, spelling(True), words) for key, words in found], source)
    return asked


def with_uncertainty(scene: Scene, model: str, solver: Solve) -> Result:
    """The result of a scene, and of its coarser companions what they say about it. The finest is solved
    first. Where it does not converge, or nothing can be said, the others are not solved.
    """
    fine = solver(alone(scene), "the scene itself")
    if not fine.converged:
        return replace(fine, uncertainty={})
    room = fine.discretisation.get("grid_enlarged")
    try:
        found = family(scene, model, None if room is None else Room(**room), depths_of_maxima(scene, fine))
        reason = under_resolved(scene, fine, found)
    except NoFamilyError as error:
        reason = str(error)
    if reason:
        return _reported(fine, scene, reason)

    def solved(members: Sequence[Member], first: Result) -> Sequence[Member]:
        """The members, wider where that is needed, with their results, of which the first is known."""
        found = [replace(member, result=first) for member in members[:1]]
        for member in members[1:]:
            result = solver(member.scene, member.label)
            if model == models.SAM and result.status in AT_EDGE:
                larger = wider(member)
                if larger.scene != member.scene:
                    member, result = larger, solver(larger.scene, larger.label)
            found.append(replace(member, result=result))
        return found

    cells = solved(found.cells, fine)
    found = _with_steps_and_box(cells, model)
    steps = solved(found.steps, cells[-1].result)
    return assessed(scene, Family(cells, steps, solved(found.box, (steps or cells)[-1].result)))


def under_resolved(scene: Scene, fine: Result, found: Family) -> str:
    """Why the coarsest grid of a family has too few cells in its radius; empty if enough, or rough."""
    if scene.patch_surface is not None:
        return ""
    if fine.model != models.SAM:
        return too_coarse(found, fine.model, found.cells[0].number)
    radius = scene.loading.radius or contact_size(fine.quantities)
    return too_coarse(found, fine.model, radius / found.cells[0].size)


def too_coarse(found: Family, model: str, resolved: float) -> str:
    """Why the coarsest grid of a family is under-resolved, or empty. resolved: cells of the finest."""
    finest, coarsest = found.cells[0], found.cells[-1]
    left = resolved * finest.size / coarsest.size
    if left >= LEAST_IN_RADIUS:
        return ""
    if model != models.SAM:
        enough = next(n for n in itertools.count(finest.number) if _whole(n / RATIO**2) >= LEAST_IN_RADIUS)
        what = f"fem.cells_per_radius to {enough}"
    elif left:
        least, (nx, ny) = LEAST_IN_RADIUS / left * coarsest.number, coarsest.scene.grid.cells
        enough = next(n for n in itertools.count(finest.number, 2) if coarser(n, RATIO**2) >= least)
        what = f"grid.cells to [{enough}, {coarser(enough, nx / ny)}]"
    else:
        what = "the load"
    words = f"{coarsest.label}, {left:.2g} in the contact radius, {LEAST_IN_RADIUS:g} needed"
    return f"the coarsest grid is under-resolved: {words}: raise {what}"


def unknown(result: Result | Run) -> str:
    """Why no quantity has the uncertainty that was asked for, and what to change; empty if one has it."""
    entries = (result.uncertainty or {}).values()
    if any(entry["u_num"] is not None for entry in entries):
        return ""
    reasons = dict.fromkeys(entry["flag"] for entry in entries)
    for_all = [words for words in reasons if words not in NONE_AT_ALL]
    return f"no uncertainty of any quantity: {'; '.join(for_all or reasons)}" if reasons else ""


def assessed(scene: Scene, solved: Family) -> Result:
    """The finest result of a family, with the uncertainty of its quantities and the cost of all solves."""
    fine = solved.cells[0].result
    reason = solved.reason or under_resolved(scene, fine, solved)
    solved = replace(solved, edge=cells_to_edge(scene, fine, solved))
    cost = cost_of(fine, [member.result for member in solved.all[1:]])
    return replace(_reported(fine, scene, reason, solved), cost=cost)


def _reported(fine: Result, scene: Scene, reason: str, solved: Family | None = None) -> Result:
    """The result with the uncertainty of each quantity that the scene does not give, or why there is none;
    reason: of all that have none of their own.
    """
    entries: dict[str, dict[str, Any]] = {}
    for name, value in fine.quantities.items():
        if value is None or is_given(name, scene):
            continue
        words = why_not(name, scene) or reason
        known = None if words or solved is None else entry(name, solved, scene.solver.tolerance)
        entries[name] = known or {"u_num": None, "flag": words}
    rows = [{"quantity": name, "value": fine.quantities[name]} | each for name, each in entries.items()]
    table = {column: [row.get(column) for row in rows] for column in COLUMNS["quantities"]}
    return replace(fine, uncertainty=entries, tables={**fine.tables, "quantities": table})


def entry(name: str, solved: Family, tolerance: float) -> dict[str, Any]:
    """What the members say about a quantity. u_cells, u_steps, u_box: bounds by each; u_num: their sum, as
    errors of one sign are usual, at least the tolerance of the solvers. Bounds by steps and box are relative
    changes on the coarsest cells; that by cells is at least what the edge of the contact leaves.
    """
    fine = solved.cells[0].result
    value, of_sam = fine.quantities[name], fine.model == models.SAM
    factor = OUTLINE_FACTOR if name in EDGES and solved.edge < inf and of_sam else FACTOR
    of_cells, values = _bound(name, solved.cells, ORDERS[name], factor)
    of_steps, on_steps = _bound(name, solved.steps, STEP_ORDER, STEP_FACTOR)
    of_box, in_boxes = _bound(name, solved.box, BOX_ORDERS.get(name, 2.0))
    if of_cells is None:
        return {"u_num": None, "flag": "a coarser solve does not have it"}
    left = of_sam or name in OF_ELEMENTS
    edge = of_edge(value, solved.edge, EDGES.get(name, EDGE)) if ORDERS[name] == 2.0 and left else 0.0
    parts = {"u_cells": max(of_cells, edge), "u_steps": _carried(of_steps, on_steps, value)}
    parts["u_box"] = _carried(of_box, in_boxes, value)
    total = max(sum(parts.values()), tolerance * abs(value))
    sizes = [member.size for member in solved.cells]
    return {
        "u_num": total,
        "relative": total / abs(value) if value else None,
        **parts,
        "order_seen": order_seen(values, sizes),
        "values": values,
        "cells": [member.number for member in solved.cells],
        "values_of_steps": on_steps,
        "steps": [member.number for member in solved.steps],
        "flag": "" if converging(values, sizes) else NOT_CONVERGING,
    }


def _carried(part: float | None, values: Sequence[float], value: float) -> float:
    """A bound of the first of some values as the same share of another value."""
    if part is None:
        return 0.0
    return part * abs(value / values[0]) if values[0] else part


def _bound(
    name: str, members: Sequence[Member], order: float, factor: float = FACTOR
) -> tuple[float | None, list[float]]:
    """The bound of a quantity along one direction, None where there is none, and its values."""
    values = [member.result.quantities[name] for member in members]
    if len(values) < 2 or None in values:
        return None, []
    return bound(values, [member.size for member in members], order, factor), values


def cost_of(fine: Result, members: Sequence[Result]) -> dict[str, float | int | None]:
    """Of all solves together, which are made one after the other."""
    total = dict(fine.cost)
    for name, value in total.items():
        others = [member.cost.get(name) or 0 for member in members]
        if name == "peak_memory_bytes":
            total[name] = max(value or 0, *others)
        elif value is not None:
            total[name] = value + sum(others)
    return total
