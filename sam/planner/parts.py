# SPDX-License-Identifier: MIT
"""What only some scenes need, by its kind: the one place that loads modules on demand.

A function a kind. What it returns is known to the solver by a protocol, so nothing else asks for the kind.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from sam.arrays import Array
from sam.grid.cells import CellGrid
from sam.half_space import ElasticConstants, ElasticPair
from sam.results.history import CycleEnd, PassEnd, Row
from sam.results.snapshots import Snapshot
from sam.results.tables import Remedies
from sam.scene import Coating, CounterBody, Friction, Grid, Plasticity, Scene, Wear as WearSection
from sam.scene.checkpoint import Checkpoint
from sam.scene.section import stated
from sam.surface_state import Tribofilm, TribofilmState, Wear

if TYPE_CHECKING:
    from sam.elastic.coated import CoatedPair
    from sam.elastic.misfit import MisfitSphere
    from sam.grid.gap import RoundedPunch
    from sam.grid.rough import RoughDemand, RoughPatch
    from sam.grid.smooth import MisfitDemand
    from sam.moving import Track
    from sam.plasticity.flow import Material
    from sam.plasticity.history import Found
    from sam.plasticity.load_step import Problem
    from sam.plasticity.progress import Progressed
    from sam.results.rough import RoughRecord
    from sam.tribofilm.state import VisitLaw


def ellipse(force: float, radii: tuple[float, float], modulus: float) -> tuple[float, float]:
    """An elliptic contact: its semi-axes in m."""
    from sam.grid.gap import elliptic_contact

    return elliptic_contact(force, radii, modulus)


def rounded_punch(other: CounterBody) -> RoundedPunch:
    """A punch with a rounded edge."""
    from sam.grid.gap import RoundedPunch

    return RoundedPunch(stated(other.flat_radius), stated(other.radius))


def rough_patch(scene: Scene) -> RoughPatch:
    """A rough body or counter-body: the heights."""
    from sam.grid.rough import RoughPatch

    return RoughPatch.of(scene.surface, scene.counter_surface, scene.grid, strip=scene.counter_strip)


def rough_demand(
    patch: RoughPatch,
    given: Grid | None,
    plasticity: Plasticity | None,
    with_coating: Callable[[Array], Array],
    *,
    reach: float,
) -> RoughDemand:
    """A rough body or counter-body: what its grid is chosen from."""
    from sam.grid.rough import RoughDemand

    return RoughDemand(patch, given, plasticity, with_coating, reach)


def rough_record(patch: RoughPatch, remedies: Remedies) -> RoughRecord:
    """A rough body or counter-body: its record."""
    from sam.results.rough import RoughRecord

    return RoughRecord(patch, remedies)


def coated_depths(thickness: float) -> Callable[[Array], Array]:
    """A coating, its thickness in m: output depths of a bare body -> of the coated one."""
    from sam.grid.smooth import depths_with_film

    return partial(depths_with_film, thickness=thickness)


def coated_pair(coating: Coating, pair: ElasticPair) -> CoatedPair:
    """A coating: both bodies."""
    from sam.elastic.coated import CoatedPair

    return CoatedPair.of(ElasticConstants(coating.young, coating.poisson), coating.thickness, pair)


def coated_scale(coated: CoatedPair, force: float, radius: float, bare: tuple[float, float]) -> float:
    """A coating: contact radius over that of the bare body.

    bare: Hertz radii in m of the body below the coating, and of one that is all of its material.
    """
    from sam.grid.smooth import contact_radius

    return contact_radius(coated.response, force, radius, bare) / bare[0]


def coated_compliance(coated: CoatedPair, radius: float) -> float:
    """A coating: mean compliance 1/E* in 1/Pa of both bodies in a contact of a radius in m."""
    from sam.grid.smooth import mean_compliance

    return mean_compliance(coated.response, radius)


def room_for_bare(scale: float) -> float:
    """A coating: factor on the sides of the grid, so that it holds the contact of the bare body too."""
    from sam.grid.smooth import room_for_bare

    return room_for_bare(scale)


def tribofilm(friction: Friction, track: Track | None, grid: CellGrid) -> Tribofilm:
    """A tribofilm: its law on the cells of a grid; track: of a counter-body that moves."""
    from sam.tribofilm.law import FilmLaw
    from sam.tribofilm.state import FilmOnCells

    return FilmOnCells(FilmLaw.of(friction), grid.shape, None if track is None else _visits(track))


def _visits(track: Track) -> VisitLaw:
    """A tribofilm below a counter-body that moves: how it begins each visit."""
    from sam.tribofilm.state import VisitLaw

    return VisitLaw(None if track.growth is None else track.growth.rate, track.period)


def wear(section: WearSection, layer_thickness: float | None, grid: CellGrid) -> Wear:
    """Wear: its law on the cells of a grid; layer_thickness: in m, of a layer with its own limit."""
    from sam.wear import WearLaw, limit_by_depth

    limits = limit_by_depth(section, layer_thickness)
    return WearLaw(
        grid.shape,
        grid.hx,
        grid.hy,
        limits,
        section.interpolate,
        section.smoothing_window,
        section.smoothing_order,
    )


def misfit_sphere(scene: Scene, body: ElasticConstants) -> MisfitSphere:
    """A misfit sphere: its strain, and the stress that it makes."""
    from sam.elastic.misfit import PROFILES, MisfitSphere

    loading = scene.loading
    return MisfitSphere(
        body,
        stated(loading.depth),
        stated(loading.radius),
        stated(loading.misfit),
        PROFILES[stated(loading.profile)],
        free=loading.surface == "free",
    )


def misfit_demand(given: Grid | None, depth: float, radius: float, zone: float | None) -> MisfitDemand:
    """A misfit sphere: what its grid is chosen from; zone: radius of the plastic zone in m."""
    from sam.grid.smooth import MisfitDemand

    return MisfitDemand(given, depth, radius, zone)


def track(scene: Scene, axes: tuple[float, float]) -> Track:
    """A counter-body that moves: its track; axes: of the contact in m."""
    from sam.moving import Growth, Track

    path, other, strip = stated(scene.loading.path), stated(scene.counterbody), scene.counter_strip
    plane = other.shape == "flat"
    curvatures = (0.0, 0.0) if plane else None
    if other.radii is not None:
        curvatures = 1 / other.radii[0], 1 / other.radii[1]
    carries = 1.0
    if plane:  # summits carry it, of the counter-body alone or of both
        carries = stated(strip).slip if scene.surface is None else 0.0
    step = path.length / scene.strokes.count
    track, friction, growth = path.length, scene.friction, None
    if friction is not None and friction.growth_rate is not None:
        growth = Growth(friction.growth_rate, stated(friction.speed))
        if not (plane or path.to_and_fro):
            track = stated(friction.track)
    return Track(
        path.start,
        path.end,
        axes[0],
        curvatures,
        step,
        plane=plane,
        carries=carries,
        strip=strip,
        period=track,
        returns=path.to_and_fro,
        growth=growth,
    )


def path_results(
    track: Track,
    grid: CellGrid,
    last: Snapshot,
    *,
    rows: Sequence[Row],
    passes: Sequence[PassEnd],
    ends: Sequence[CycleEnd],
    film: TribofilmState | None,
) -> tuple[dict[str, dict[str, Any]], dict[str, float | None]]:
    """A counter-body that moves: the tables and the quantities that it adds; see `sam.moving`."""
    from sam.moving import Solved, path_quantities, path_tables

    found = Solved(last, rows, passes, ends, film)
    return path_tables(track, grid, found), path_quantities(track, grid, found)


def paper_problem() -> type[Problem]:
    """The loops of the paper: the problem of their load step."""
    from sam.plasticity.paper import PaperProblem

    return PaperProblem


def material_with_back_stresses() -> Callable[..., Material]:
    """Kinematic hardening: makes the material of a box."""
    from sam.plasticity.flow import KinematicMaterial

    return KinematicMaterial.of


def progressed(start: Checkpoint) -> Progressed:
    """Plasticity: the record in a checkpoint."""
    from sam.plasticity.progress import Progressed

    return start.record(Progressed)


def on_larger_grid(so_far: Progressed, grid: CellGrid, larger: CellGrid) -> Progressed | None:
    """Plasticity: the record on a larger grid; None if the history begins anew there."""
    from sam.plasticity.history import on_larger_grid

    return on_larger_grid(so_far, grid, larger)


def yielding() -> Callable[..., Found]:
    """Plasticity: what solves the load history of a plan, `sam.planner.yielding.solve_yielding`."""
    from sam.planner.yielding import solve_yielding

    return solve_yielding
