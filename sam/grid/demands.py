# SPDX-License-Identifier: MIT
"""The grid of a smooth scene: taken from [grid], or chosen from an estimate of the contact, or of a misfit
sphere, and of the plastic zone.

The contact radius of a coated body is that of the best Hertz pressure in the sense of the
complementary energy. Under p = p0 sqrt(1 - r^2/a^2), of force F, the harmonics have the amplitudes F S(k a),
S(t) = 3 j1(t)/t with the spherical Bessel function j1, and 1/E(k) = k c_zz(k)/2 is the compliance that each
of them meets. The energy F^2/(2 pi) int S(k a)^2/E(k) dk of both bodies and F <r^2>/(2 R) = F a^2/(5 R) of
the gap are stationary for

    a^3 = 3/4 F R <1/E>,    <1/E> = 5/(3 pi) int 18 j1(t) j2(t)/t 1/E(t/a) dt:

Hertz with a mean compliance (the weights integrate to 1). It is exact without coating.

The grid of a rough scene, and the heights of both bodies on it. Loaded for rough scenes only: the whole
grid may come into contact.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache
from math import ceil, inf, pi, sqrt

import numpy as np

from sam.arrays import Array
from sam.grid.cells import CellGrid, Room
from sam.scene import Grid, Plasticity
from sam.scene.section import stated
from sam.scene.surface import (
    CounterSurface,
    Roughness,
    Strip,
    Surface,
    border_cells,
    heights,
    leading,
    mean_deviation,
    patch_of,
    roughness,
    with_relief,
)

DEFAULT_CELLS = 129  # odd: a cell centre on the apex; about 32 cells in the contact radius
DEFAULT_EXTENT = 4.0  # contact radii
ROUNDED_EXTENT = 2.6  # contact radii: most of them are flat, and the rounded edge needs finer cells
PUNCH_EXTENT = 3.0  # radii: the contact cannot grow, and its edge needs finer cells
DEPTH_SPACING = 0.02  # contact radii: Hertz's largest stress, refined by a parabola, errs by 1e-6 (measured)
DEPTH_RANGE = 2.0  # contact radii: four times the depth of the largest stress under a sphere
EDGE_SPACING = 6  # depths in a largest cell: the largest stress below a rounded edge within 0.1 %
EDGE_DEPTHS = 30  # so close: down to 1.7 of its width, twice the depth of the largest stress
PLASTIC_CELLS = 65  # with plasticity: 16 cells in the Hertz radius
# Cells in four contact radii of a body that yields below a counter-body that moves, as the memory grows with
# the track: the groove of Swift steel at p0 = 4 sigma_y is 3.6 % shallower with 6 in the radius than with 12,
# with 8 it is 1.7 %.
MOVING_CELLS = 41
# The same of a line contact, whose cells are a row; (elastic, plastic, plastic and moving)
LINE_CELLS = 513, 129, 65
DEEPER_BELOW_LINE = 1.5  # times the depth of layers: perfect plasticity rolled at 3 yield stresses needs 1.2
MOST_CELLS = 1025  # along a side of a chosen grid; an elastic solve then takes about a minute
CHOSEN = 0.6  # of the largest cell allowed: 5 in a rounded edge, its largest pressure within 0.4 %
MOST_LAYERS = 2000  # of a volume grid; memory and time of the box grow with their square
LAYERS_IN_PROFILE = 6  # at least, in the depth over which the yield stress varies
SLENDEST = 50  # cells in the thickness of a layer at most
EVEN_DEPTH = 1.2  # Hertz radii: down to here layers are as thick as a cell
LAYER_GROWTH = 1.2  # ratio of the thicknesses of deeper layers
LAYER_RANGE = 3.0  # Hertz radii: depth of the lowest face, unless the plastic zone goes deeper
ZONE_BESIDE = (
    0.75  # half side over `point_load_reach`; perfect plasticity reaches 0.63 (p0 = 6 sigma_y) to 0.71 (10)
)
FARTHEST = 4.5  # Hertz radii: no grid is chosen for a larger reach (p0 = 19 yield stresses)


@dataclass(frozen=True)
class PlasticDemand:
    """What plasticity asks of a grid: depth in m of the plastic zone, and of kinks of the yield stress."""

    reach: float
    kinks: Sequence[float] = ()


@dataclass(frozen=True)
class GridDemand:
    """What the grid of a smooth scene is chosen from. axes: estimated semi-axes in m; extent: sides
    in contact radii; wider: factor on them; farthest: |x|, |y| of a load in m; film: thickness;
    length: of a line contact along y in m, 0 of others; its cells are a row along x.
    """

    given: Grid | None
    axes: tuple[float, float]
    extent: float = DEFAULT_EXTENT
    wider: float = 1.0
    farthest: tuple[float, float] = (0.0, 0.0)
    plastic: PlasticDemand | None = None
    film: float | None = None
    moves: bool = False
    largest_cell: float = inf
    length: float = 0.0

    @cached_property
    def usual(self) -> int:
        """Cells each way of a grid for a contact that stays in place and a plastic zone no wider, odd."""
        given = self.given.extent if self.given else None
        sides = given or tuple(self.wider * self.extent * radius for radius in self.axes)
        least = 2 * ceil(max(sides) / (CHOSEN * self.largest_cell) / 2 - 0.5) + 1
        if self.length:
            return LINE_CELLS[0 if self.plastic is None else 1 + self.moves]
        if self.plastic is None:
            return max(DEFAULT_CELLS, least)
        return max(MOVING_CELLS if self.moves else PLASTIC_CELLS, least)

    def sides(self, cells: tuple[int, int]) -> tuple[float, float]:
        """Sides in m of a grid that has these cells unless they are given."""
        if self.given and self.given.extent:
            return self.given.extent
        a, b = (
            self.wider * self.extent * r * (n / self.usual) for r, n in zip(self.axes, cells, strict=True)
        )
        return a, b

    def grid(self, room: Room) -> CellGrid:
        """The grid, larger by the factors of a room. Chosen are 129 x 129 cells over four contact
        radii each way, 65 x 65 with plasticity, with layers as thick as a cell; more along a path.
        """
        given, plastic = self.given, self.plastic
        zone, longer = plastic.reach if plastic else 0.0, []
        for far, radius in zip(self.farthest, self.axes, strict=True):
            stretch = max(1.0, ZONE_BESIDE * zone / (self.extent * radius / 2)) * room.beside
            stretch += 2 * far / (self.extent * radius)
            longer.append(self.usual if stretch == 1 else 2 * int(np.ceil(stretch * self.usual / 2)) + 1)
        nx, ny = (given.cells if given and given.cells else None) or longer
        lx, ly = self.sides((longer[0], longer[1]))
        if line := self.length > 0:
            ny, ly = 1, self.length
        hx, hy = lx / nx, ly / ny
        depths = given_depths(given)
        if plastic is None:
            depths = self._output_depths() if depths is None else depths
            return CellGrid(nx, ny, hx, hy, depths, room=room, line=line)
        if depths is None:
            cell, deeper = (hx, DEEPER_BELOW_LINE) if line else (min(hx, hy), 1.0)
            depths = _layer_faces(cell, min(self.axes), plastic, deeper * room.below)
        return CellGrid(nx, ny, hx, hy, (depths[1:] + depths[:-1]) / 2, depths, room=room, line=line)

    def _output_depths(self) -> Array:
        """Depths in m at which the stress of an elastic body is returned."""
        count = round(DEPTH_RANGE / DEPTH_SPACING)
        levels: Array = np.arange(count + 1, dtype=np.float64) * (DEPTH_SPACING * min(self.axes))
        if self.largest_cell < inf:
            fine = np.arange(EDGE_DEPTHS + 1) * min(self.largest_cell / EDGE_SPACING, levels[1])
            levels = np.concatenate([fine, levels[levels > fine[-1]]])
        return levels if self.film is None else depths_with_film(levels, self.film)


def given_depths(given: Grid | None) -> Array | None:
    """The depths in m that [grid] gives, of a plastic body those of the faces; None if it gives none."""
    if given and given.depths:
        return np.array(given.depths)
    if given and given.layers and given.depth:
        return np.linspace(0.0, given.depth, given.layers + 1)
    return None


def point_load_reach(force: float, poisson: float, bulk_yield: float, radius: float) -> float:
    """Depth in m to which a point force in N, in unstrained bulk, yields, by von Mises (7/2 - nu)
    F/(2 pi z^2) (Johnson 1985, Eq. 3.19), at most FARTHEST radii: there a large zone ends.
    """
    reach = sqrt((3.5 - poisson) * force / (2 * pi * bulk_yield))
    return min(reach, FARTHEST * radius)


def line_load_reach(force: float, poisson: float, bulk_yield: float, radius: float) -> float:
    """The same of a line force in N/m in plane strain: (1 - nu + nu^2)^(1/2) 2 F'/(pi z) (Johnson 1985, Eq.
    2.15).
    """
    reach = sqrt(1 - poisson + poisson**2) * 2 * force / (pi * bulk_yield)
    return min(reach, FARTHEST * radius)


def _layer_faces(thickness: float, radius: float, plastic: PlasticDemand, room: float) -> Array:
    """Faces of equal layers to EVEN_DEPTH radii, then growing to LAYER_RANGE and the plastic zone;
    kinks are faces, with LAYERS_IN_PROFILE or more, none thinner than thickness/SLENDEST.
    """
    faces, kinks = [0.0], [z for z in plastic.kinks if 0 < z < EVEN_DEPTH * radius]
    thin = max(min([thickness, *(z / LAYERS_IN_PROFILE for z in kinks[-1:])]), thickness / SLENDEST)
    for kink in kinks:
        length = kink - faces[-1]
        if length >= thin / 2:  # nearer rows are one
            faces.extend(np.linspace(faces[-1], kink, max(1, ceil(length / thin - 1e-9)) + 1)[1:])
    even = np.ceil((EVEN_DEPTH * radius - faces[-1]) / thickness)
    faces.extend(faces[-1] + thickness * np.arange(1, even + 1))
    while faces[-1] < LAYER_RANGE * radius * room or faces[-2] < plastic.reach * room:
        thickness *= LAYER_GROWTH
        faces.append(faces[-1] + thickness)
    return np.array(faces)


CELLS_IN_RADIUS = 8  # plastic strain of a smooth profile within 5 % (linear hardening), in 0.2 s
CELLS_IN_ZONE = 12  # at most so many are needed in the radius of a plastic zone
BEYOND_ZONE = 1.5  # radii of the zone: the half side of the grid
ELASTIC_SIDE = 2.0  # radii of the sphere, where nothing yields: the half side of the grid


@dataclass(frozen=True)
class MisfitDemand:
    """What the grid of a misfit sphere is chosen from; zone: plastic radius in m, or None."""

    given: Grid | None
    depth: float
    radius: float
    zone: float | None

    def grid(self, room: Room) -> CellGrid:
        """The grid, its sides and depth larger by the factors of a room than those chosen first."""
        given, zone = self.given, self.zone or 0.0
        half = max(BEYOND_ZONE * zone, self.radius) if zone else ELASTIC_SIDE * self.radius
        cell = max(self.radius / CELLS_IN_RADIUS, zone / CELLS_IN_ZONE)
        usual = 2 * ceil(half * room.beside / cell - 0.5) + 1
        nx, ny = (given.cells if given and given.cells else None) or (usual, usual)
        lx, ly = (given.extent if given and given.extent else None) or (2 * half * room.beside,) * 2
        if not given or not (given.cells or given.extent):
            lx = ly = usual * cell
        hx, hy = lx / nx, ly / ny
        depths = given_depths(given)
        if self.zone is None:
            return CellGrid(nx, ny, hx, hy, self._levels(half) if depths is None else depths, room=room)
        if depths is None:
            depths = self._faces(min(hx, hy), half, room.below)
        return CellGrid(nx, ny, hx, hy, (depths[1:] + depths[:-1]) / 2, depths, room=room)

    def _levels(self, half: float) -> Array:
        """Output depths of an elastic body: one of them that of the centre."""
        spacing = DEPTH_SPACING * self.radius
        above = int(self.depth / spacing)
        return self.depth + spacing * np.arange(-above, ceil(half / spacing) + 1.0)

    def _faces(self, thickness: float, half: float, room: float) -> Array:
        """Faces of layers as thick as a cell about the centre, then of growing ones up to the surface."""
        count = ceil(half / thickness - 0.5)
        below = self.depth + thickness * (np.arange(ceil(count * room) + 1) + 0.5)
        above, upper = [self.depth - thickness / 2], thickness
        while above[-1] > 0:
            if len(above) > count:
                upper *= LAYER_GROWTH
            above.append(above[-1] - upper)
        above.pop()
        if len(above) > 1 and above[-1] < thickness / 2:
            above.pop()
        return np.concatenate([[0.0], above[::-1], below])


LEVELS = 8  # output depths in the coating at least, of equal distance
FILM_SIDE = 1 - 1e-6  # thicknesses: the deepest of them, the coating's side of the interface
# times the deepest of the other depths (two contact radii): a thicker coating is all that is looked at
REACH = 5.0
BELOW = (1.05, 1.1, 1.2, 1.35, 1.5)  # thicknesses: output depths below a coating where the other depths end
CLOSE = 0.25  # of the distance of the other depths: none of them is closer to the interface
BARE_ROOM = 1.6  # the contact of the bare body fits into a default grid up to this many coated contact radii
MOST_ROOM = 3.0  # factor on a default grid at most, for the contact of the bare body
PANELS = 30  # of Gauss-Legendre nodes, one panel in pi: the integrand oscillates with that period
NODES = 8  # in a panel
TAIL = 1e9  # beyond the panels 18 j1 j2/t has the mean 18/t^4, up to here
TAIL_NODES = 200  # evenly in the logarithm
WIDER = 30.0  # the bracket goes so far beyond the radii of the bare coating and of the bare body


def room_for_bare(scale: float) -> float:
    """Factor on a default grid for the coated contact, so that it holds the bare one to compare with."""
    return float(np.clip(1 / (BARE_ROOM * scale), 1.0, MOST_ROOM))


def depths_with_film(depths: Array, thickness: float) -> Array:
    """Depths of a bare body made those of a coated one: LEVELS or more in the coating and both
    sides of the interface, if that is in REACH.
    """
    deepest, spacing = depths[-1], depths[1] - depths[0]
    inside: Array = depths[depths < thickness - CLOSE * spacing]
    if thickness > REACH * deepest:
        return inside
    if len(inside) < LEVELS:
        inside = thickness * np.arange(LEVELS - 1) / (LEVELS - 1)
    inside = np.append(inside, FILM_SIDE * thickness)
    below = depths[depths > thickness + CLOSE * spacing]
    deeper = [share * thickness for share in BELOW if share * thickness > deepest]
    return np.concatenate([inside, [thickness], below, deeper])


@cache
def _weights() -> tuple[Array, Array]:
    """Nodes t and weights of <1/E>, which sum to 1."""
    from scipy.special import spherical_jn  # noqa: PLC0415

    x, w = np.polynomial.legendre.leggauss(NODES)
    t = (np.arange(PANELS)[:, None] * np.pi + (x + 1) * np.pi / 2).ravel()
    weight = np.tile(w * np.pi / 2, PANELS) * 18 * spherical_jn(1, t) * spherical_jn(2, t) / t
    far = np.geomspace(PANELS * np.pi, TAIL, TAIL_NODES)
    steps = np.gradient(np.log(far))
    steps[[0, -1]] /= 2
    nodes, weights = np.append(t, far), np.append(weight, 18 / far**3 * steps)
    return nodes, weights / weights.sum()


def mean_compliance(response: Callable[[Array], Array], radius: float) -> float:
    """<1/E> in 1/Pa of a contact with the radius in m; response: k in 1/m -> c_zz(k) in m/Pa."""
    t, weights = _weights()
    k = t / radius
    return float(weights @ (k * response(k) / 2))


def contact_radius(
    response: Callable[[Array], Array], force: float, radius: float, bare: tuple[float, float]
) -> float:
    """Radius in m of a paraboloid's contact; response: k -> c_zz(k) in m/Pa; bare: Hertz radii."""
    from scipy.optimize import brentq  # noqa: PLC0415 - a tenth of a second, for coatings alone

    def excess(log_a: float) -> float:
        compliance = mean_compliance(response, np.exp(log_a))
        return float(3 * log_a - np.log(0.75 * force * radius * compliance))

    low, high = np.log(min(bare) / WIDER), np.log(max(bare) * WIDER)
    return float(np.exp(brentq(excess, low, high, xtol=1e-13)))


EQUAL = 1e-4  # relative difference of the radii below which the ellipse is a circle to that accuracy


def elliptic_contact(force: float, radii: tuple[float, float], modulus: float) -> tuple[float, float]:
    """Semi-axes (a along x, b along y) in m by complete elliptic integrals (Johnson 1985, Eq. 4.26)."""
    from scipy.optimize import brentq  # noqa: PLC0415 - a tenth of a second, for ellipses alone
    from scipy.special import ellipe, ellipk  # noqa: PLC0415

    rx, ry = radii
    small, large = sorted((rx, ry))

    def curvatures(ratio: float) -> tuple[float, float]:
        """(K - E, E/ratio^2 - K)/e^2, in proportion to the curvatures along major and minor axis."""
        m = 1 - ratio**2
        k, e = ellipk(m), ellipe(m)
        return (k - e) / m, (e / ratio**2 - k) / m

    def mismatch(log_ratio: float) -> float:
        along_major, along_minor = curvatures(np.exp(log_ratio))
        return along_minor / along_major * small / large - 1

    # the ratio of the axes lies between the ratio of the radii and 1 (Johnson: about its power 2/3)
    ratio = (
        float(np.exp(brentq(mismatch, np.log(small / large), -1e-6)))
        if small / large < 1 - EQUAL
        else 1 - 1e-6
    )
    major = (3 * force * small * curvatures(ratio)[1] / (pi * modulus)) ** (1 / 3)
    axes = major * ratio, major  # the contact is longer along the larger radius
    return axes if rx < ry else (major, major * ratio)


FINE_DEPTH = (
    # cells: down to here the depth levels are even, as the stress of a single summit is largest near the
    # surface
    2.0
)
FINEST = 0.25  # cells between the even levels
GROWTH = 1.2  # ratio of the distances between deeper levels
DEPTH_SHARE = 1 / 8  # of the shorter side: the deepest level, unless the plastic zone goes deeper
THICKER = 1.25  # ratio of the thicknesses of layers
MOST_ACROSS = 3.0  # of `step_across`: self-affine patches that repeat have 0.6 to 1.6


@dataclass(frozen=True)
class RoughPatch:
    """Rough surfaces on (nx, ny) cells over (Lx, Ly) in m; strip: of one that moves."""

    surface: Surface | None
    cells: tuple[int, int]
    extent: tuple[float, float]
    relief: bool = False
    counter: CounterSurface | None = None
    strip: Strip | None = None
    periodic: bool = False

    @classmethod
    def of(
        cls,
        surface: Surface | None,
        counter: CounterSurface | None,
        given: Grid | None,
        *,
        strip: Strip | None = None,
    ) -> RoughPatch:
        """On the cells of a file, or on those that [grid] gives; strip: of a counter-body that moves."""
        relief = given is not None and given.border == "relief"
        if strip is not None:
            return cls(surface, strip.cells, strip.extent, relief, counter, strip)
        cells, extent = patch_of(stated(leading(surface, counter)), given)
        periodic = given is not None and given.periodic == "xy"
        return cls(surface, cells, extent, relief, counter, periodic=periodic)

    def heights(self) -> Array:
        """Heights of a rough body at the cell centres, (nx, ny) in m, positive out of it; read-only."""
        return _heights(stated(self.surface), self.cells, self.extent, self.relief)

    def counter_heights(self, number: int, place: tuple[float, float]) -> Array:
        """Heights of a stretch of a rough counter-body at a place of its path in m, positive out of it."""
        if self.strip is not None:
            return self.strip.at(number, place)
        stretch = stated(self.counter).stretch(number)
        return _heights(stretch, self.cells, self.extent, self.relief)

    @property
    def opposite(self) -> Callable[[int, tuple[float, float]], Array] | None:
        """Heights of a stretch of the counter-body at a place, (nx, ny) in m; None if it is smooth."""
        return None if self.counter is None else self.counter_heights

    def changed_by_taper(self, surface: Surface) -> tuple[float, float]:
        """Rms change of the heights of a surface by its taper, and their rms deviation, in m."""
        before = surface.model_copy(update={"taper": None})
        as_is, other = (_heights(each, self.cells, self.extent, False) for each in (before, surface))
        return float(np.sqrt(np.mean((other - as_is) ** 2))), float(as_is.std())

    @property
    def of_body(self) -> Array:
        """The heights of the body, or zeros if it is smooth."""
        return np.zeros(self.cells) if self.surface is None else self.heights()

    def roughness(self, lowered: Array | float = 0.0) -> Roughness:
        """Of the heights less what is lowered, (nx, ny) in m, but for a border that falls off."""
        (nx, ny), (lx, ly) = self.cells, self.extent
        bx, by = border_cells((nx, ny)) if self.relief else (0, 0)
        inner = (self.of_body - lowered)[bx : nx - bx, by : ny - by]
        return roughness(inner, lx / nx, ly / ny)


@lru_cache(maxsize=2)  # the body, and the stretch opposite
def _heights(surface: Surface, cells: tuple[int, int], extent: tuple[float, float], relief: bool) -> Array:
    x, y = (((np.arange(n) + 0.5) / n - 0.5) * side for n, side in zip(cells, extent, strict=True))
    values = heights(surface, x, y, extent)
    if surface.taper:
        values = tapered(values, surface.taper)
    if relief:
        values = with_relief(values, (x, y), extent, mean_deviation(surface, extent))
    values.flags.writeable = False
    return values


def step_across(heights: Array, axes: tuple[int, ...] = (0, 1)) -> float:
    """Rms step across the border of a patch over that between neighbouring cells, the larger of some
    directions: about 1 of heights (nx, ny) that repeat.
    """
    steps = [(heights.take(0, axis) - heights.take(-1, axis), np.diff(heights, axis=axis)) for axis in axes]
    rms = [[float(np.sqrt(np.square(each).mean())) for each in both] for both in steps]
    return max(across / (inside or across or 1.0) for across, inside in rms)


def tapered(heights: Array, share: float) -> Array:
    """Heights (nx, ny) that repeat: in a share of each side, half of it at both ends, half of the step across
    the border is added or taken off, as s^3 (10 - 15 s + 6 s^2) of the way s to the border.
    """
    for axis in (0, 1):
        n = heights.shape[axis]
        s = np.clip(1 - (np.arange(n) + 0.5) / (share * n / 2), 0.0, 1.0)
        half = np.expand_dims(np.subtract(heights.take(-1, axis), heights.take(0, axis)) / 2, axis)
        at_start = np.expand_dims(s**3 * (10 - 15 * s + 6 * s**2), 1 - axis)
        heights = heights + half * (at_start - np.flip(at_start, axis))
    return heights


@dataclass(frozen=True)
class RoughDemand:
    """What the grid of a rough scene is chosen from; reach: of `point_load_reach` in m; line: below a
    cylinder, all repeats along y.
    """

    patch: RoughPatch
    given: Grid | None
    plasticity: Plasticity | None
    film: float | None = None
    reach: float = 0.0
    line: bool = False

    def grid(self, room: Room) -> CellGrid:
        """The cells of the patch; depths that are not given are fine near the surface, for small contacts."""
        patch, plasticity = self.patch, self.plasticity
        (nx, ny), (lx, ly) = patch.cells, patch.extent
        hx, hy = lx / nx, ly / ny
        depths = given_depths(self.given)
        if depths is None:
            cell, deepest = hx if ny == 1 else min(hx, hy), DEPTH_SHARE * (lx if self.line else min(lx, ly))
            chosen = (
                _depths(cell, deepest)
                if plasticity is None
                else _faces(plasticity, cell, deepest * room.below, self.reach * room.below)
            )
            depths = chosen if self.film is None else depths_with_film(chosen, self.film)
        border = (0, 0) if patch.relief or patch.periodic else border_cells((nx, ny))
        border = (border[0], 0) if self.line else border
        faces = None if plasticity is None else depths
        depths = depths if faces is None else (faces[1:] + faces[:-1]) / 2
        return CellGrid(nx, ny, hx, hy, depths, faces, border, room, patch.periodic, self.line)


def _depths(cell: float, deepest: float) -> Array:
    """Output depths in m: even ones near the surface, then growing distances."""
    levels, step = [FINEST * cell * k for k in range(round(FINE_DEPTH / FINEST) + 1)], FINEST * cell
    while levels[-1] < deepest:
        step *= GROWTH
        levels.append(levels[-1] + step)
    return np.array(levels)


def _faces(plasticity: Plasticity, cell: float, deepest: float, reach: float) -> Array:
    """Faces of layers of a body that yields; the one next to a kink is moved there."""
    thin = [cell / 2]
    if plasticity.profile is not None:
        thin.append(plasticity.profile[-1][0] / LAYERS_IN_PROFILE or cell / 2)
    if plasticity.layer_thickness is not None:
        thin.append(plasticity.layer_thickness / LAYERS_IN_PROFILE)
    faces, step = [0.0, min(thin)], THICKER * min(thin)
    while faces[-1] < deepest or faces[-2] < reach:
        faces.append(faces[-1] + step)
        step *= THICKER
    kinks = plasticity.strength().kinks.depths
    for kink in (z for z in kinks if min(thin) / 2 < z < faces[-1]):
        nearest = int(np.abs(np.array(faces) - kink).argmin())
        faces[nearest] = faces[nearest] if faces[nearest] in kinks else kink
    return np.array(faces)
