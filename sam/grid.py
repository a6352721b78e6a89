# SPDX-License-Identifier: MIT
"""The cells and output depths of the semi-analytical model: taken from the scene, or chosen from a Hertz estimate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, pi, sqrt

import numpy as np

from sam.contact.convolution import Window
from sam.loading import peak_force
from sam.scene import Scene

DEFAULT_CELLS = 129  # odd: a cell centre on the apex; about 32 cells in the contact radius
DEFAULT_EXTENT = 4.0  # contact radii
PUNCH_EXTENT = 3.0  # radii: the contact cannot grow, and its edge needs finer cells
DEPTH_SPACING, DEPTH_RANGE = 0.02, 2.0  # of the output depths, in contact radii
PLASTIC_CELLS = 65  # with plasticity: 16 cells in the Hertz radius
MOST_LAYERS = 2000
# layers in the varying yield stress at least; cells in their thickness at most
LAYERS_IN_PROFILE, SLENDEST = 6, 50
EVEN_DEPTH = 1.2  # Hertz radii: down to here layers are as thick as a cell
LAYER_GROWTH = 1.2  # ratio of the thicknesses of deeper layers
LAYER_RANGE = 3.0  # Hertz radii: depth of the lowest face, unless the plastic zone goes deeper
# half the side of the grid over `point_load_reach`; perfect plasticity comes to 0.63 (p0 = 6 yield stresses) to 0.71 (10) of it
ZONE_BESIDE = 0.75
FARTHEST = 4.5  # Hertz radii: no grid is chosen for a larger reach (p0 = 19 yield stresses)


@dataclass(frozen=True)
class Room:
    """Factors by which a chosen grid is larger than the first choice: its sides, and its depth."""

    beside: float = 1.0
    below: float = 1.0


@dataclass(frozen=True)
class CellGrid:
    """nx x ny cells of hx x hy in m, centres x_i = (i - (nx - 1)/2) hx; depths: (nz,) output depths in m, ascending.

    faces: (nz + 1,) of the layers of the volume grid, whose centres are the depths; None for an elastic body. border: cells
    at each end in x and y that do not count for maxima once the contact touches the edge (rough bodies only). room: with which
    it was chosen, see `sam.enlargement`.
    """

    nx: int
    ny: int
    hx: float
    hy: float
    depths: np.ndarray
    faces: np.ndarray | None = None
    border: tuple[int, int] = (0, 0)
    room: Room = Room()

    @property
    def x(self) -> np.ndarray:
        return (np.arange(self.nx) - (self.nx - 1) / 2) * self.hx

    @property
    def y(self) -> np.ndarray:
        return (np.arange(self.ny) - (self.ny - 1) / 2) * self.hy

    @property
    def axis_rows(self) -> Window:
        """The rows of cells that touch y = 0: one if ny is odd, two if it is even."""
        rows = 2 - self.ny % 2
        return Window(0, (self.ny - rows) // 2, self.nx, rows)

    @property
    def axis_columns(self) -> slice:
        """The columns of cells that touch x = 0."""
        columns = 2 - self.nx % 2
        first = (self.nx - columns) // 2
        return slice(first, first + columns)


class UnsupportedScene(ValueError):  # noqa: N818 - the name that callers of both models know
    """A valid scene that has no grid of a size that can be meant; the message names key, value and what is allowed."""


def check(scene: Scene) -> None:
    """Raise UnsupportedScene for a plastic scene whose cells are so small that layers as thick would be too many.

    Also for a coating where anything yields: the coefficients of plastic strain hold for a homogeneous body.
    """
    _check_coating(scene)
    if scene.surface is not None and scene.surface.path is not None and scene.surface.path.values is None:
        raise UnsupportedScene(
            f"surface.path = {scene.surface.path!r}: only its digest is at hand, read the scene file"
        )
    given = scene.grid
    if scene.body.plasticity is None or given is None or given.extent is None or given.depths or given.layers:
        return
    a, b, thickness = (
        *hertz_semi_axes(scene),
        min(np.divide(given.extent, given.cells or (PLASTIC_CELLS, PLASTIC_CELLS))),
    )
    layers = EVEN_DEPTH * min(a, b) / thickness
    if layers > MOST_LAYERS:
        extent = " and ".join(f"{side:g} m" for side in given.extent)
        raise UnsupportedScene(
            f"grid.extent = {extent}: {layers:.3g} layers as thick as a cell, at most {MOST_LAYERS} are allowed: raise it, "
            f"or give grid.layers and grid.depth"
        )


def _check_coating(scene: Scene) -> None:
    coating, plasticity = scene.body.coating, scene.body.plasticity
    if coating is None:
        return
    allowed = (
        "the semi-analytical model allows an elastic coating on an elastic body; fem-axisymmetric solves it"
    )
    if plasticity is not None:
        raise UnsupportedScene(
            f'body.coating together with body.plasticity (law = "{plasticity.law}"): {allowed}'
        )
    if coating.yield_stress is not None:
        raise UnsupportedScene(f"body.coating.yield_stress = {coating.yield_stress:g} Pa: {allowed}")


def contact_modulus(scene: Scene) -> float:
    """E* in Pa, 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2; the second term is absent for a rigid counter-body or none.

    It stands in D_33 of paper Eq. 5, which is printed with E alone.
    With a coating that of the body below it: a unit of pressure, no more.
    """
    body, other = scene.body, scene.counterbody
    compliance = (1 - body.poisson**2) / body.young
    if other is not None and other.elastic:
        compliance += (1 - other.poisson**2) / other.young
    return 1 / compliance


def tangential_compliance(young: float, poisson: float) -> float:
    """(1 - 2 nu)/mu in 1/Pa: with it a traction moves the surface normally (paper: D_31 of Eq. 5)."""
    return (1 - 2 * poisson) * 2 * (1 + poisson) / young


def tangential_mismatch(scene: Scene) -> float:
    """2 beta of Dundurs (1969), E*/2 [(1 - 2 nu1)/mu1 - (1 - 2 nu2)/mu2]: body 2 carries the opposite traction.

    Zero between like bodies, largest against a rigid one; printed in the paper is the first term alone.
    """
    body, other = scene.body, scene.counterbody
    compliance = tangential_compliance(body.young, body.poisson)
    if other is not None and other.elastic:
        compliance -= tangential_compliance(other.young, other.poisson)
    return contact_modulus(scene) / 2 * compliance


def coupling_of(scene: Scene, coefficient: float | np.ndarray) -> float | np.ndarray:
    """2 beta mu, with which the traction enters the gap (see sam.contact.normal); zero for the decoupled form of the paper.

    coefficient: mu, a number or (nx, ny). With a coating the result is mu: 2 beta is then a function of the wave number, and
    part of the coefficients (see sam.contact.bodies).
    """
    if scene.friction is None or not scene.friction.coupling:
        return 0.0
    if scene.body.coating is not None:
        return coefficient
    return tangential_mismatch(scene) * coefficient


def hertz_semi_axes(scene: Scene) -> tuple[float, float]:
    """Contact semi-axes (a along x, b along y) in m by Hertz, for the body without coating. Johnson 1985, Eq. 4.26.

    The radius twice for a punch and for a given Hertz pressure; half the sides of the patch for a plane. An ellipse is solved
    for the ratio of the axes, with the complete elliptic integrals K and E of m = e^2 = 1 - ratio^2.
    """
    if scene.loading.prescribed:
        return scene.loading.radius, scene.loading.radius
    if scene.counterbody.shape == "punch":
        return scene.counterbody.radius, scene.counterbody.radius
    if scene.counterbody.shape == "flat":
        from sam.rough import sides_of

        return tuple(side / 2 for side in sides_of(scene)[1])
    rx, ry = scene.counterbody.radii
    force, modulus = scene.loading.force, contact_modulus(scene)
    if rx == ry:
        a = (3 * force * rx / (4 * modulus)) ** (1 / 3)
        return a, a
    from scipy.optimize import brentq  # a sphere needs neither
    from scipy.special import ellipe, ellipk

    small, large = sorted((rx, ry))

    def curvatures(ratio: float) -> tuple[float, float]:
        """(K - E, E/ratio^2 - K)/e^2: proportional to the curvatures 1/(2 R) along the major and the minor axis."""
        m = 1 - ratio**2
        k, e = ellipk(m), ellipe(m)
        return (k - e) / m, (e / ratio**2 - k) / m

    def mismatch(log_ratio: float) -> float:
        along_major, along_minor = curvatures(np.exp(log_ratio))
        return along_minor / along_major * small / large - 1

    # the ratio of the axes lies between the ratio of the radii and 1 (Johnson: about its power 2/3)
    ratio = (
        float(np.exp(brentq(mismatch, np.log(small / large), -1e-6)))
        if small / large < 1 - 1e-4
        else 1 - 1e-6
    )
    major = (3 * force * small * curvatures(ratio)[1] / (pi * modulus)) ** (1 / 3)
    axes = major * ratio, major  # the contact is longer along the larger radius
    return axes if rx < ry else axes[::-1]


def choose_grid(scene: Scene, room: Room = Room()) -> CellGrid:
    """The grid of a scene. What `[grid]` leaves out is chosen: 129 x 129 cells over four contact radii each way.

    Punch: three radii; with plasticity 65 x 65 cells, and layers as thick as a cell where most of the plastic strain is.
    Cells of the same size and further layers are added where the plastic zone goes further (see `point_load_reach`), and along
    the path of a travelling load. room: see `sam.enlargement`. A scene without force has no contact radius; a length of a
    thousandth of the radius of curvature takes its place. Rough bodies: see `sam.rough`. With a coating see `sam.coated_grid`.
    """
    if scene.surface is not None:
        from sam.rough import rough_grid

        return rough_grid(scene)
    given = scene.grid
    plastic = scene.body.plasticity is not None
    (a, b), bare = hertz_semi_axes(scene), 1.0
    if a == 0.0:
        a, b = (1e-3 * r for r in scene.counterbody.radii)
    elif scene.body.coating is not None:
        from sam.coated_grid import contact_scale, room_for_bare

        scale = contact_scale(scene)
        a, b, bare = a * scale, b * scale, room_for_bare(scale)
    usual = PLASTIC_CELLS if plastic else DEFAULT_CELLS
    reach = (
        PUNCH_EXTENT
        if scene.counterbody is not None and scene.counterbody.shape == "punch"
        else DEFAULT_EXTENT
    )
    zone = point_load_reach(scene, min(a, b)) if plastic else 0.0
    stretch = [
        max(1.0, ZONE_BESIDE * zone / (reach * radius / 2)) * room.beside + 2 * far / (reach * radius)
        for far, radius in zip(_farthest(scene), (a, b), strict=True)
    ]
    longer = tuple(usual if s == 1 else 2 * int(np.ceil(s * usual / 2)) + 1 for s in stretch)
    nx, ny = (given.cells if given and given.cells else None) or longer
    lx, ly = (given.extent if given and given.extent else None) or (
        bare * reach * a * (longer[0] / usual), bare * reach * b * (longer[1] / usual)
    )  # fmt: skip
    hx, hy = lx / nx, ly / ny
    if given and given.depths:
        depths = np.array(given.depths)
    elif given and given.layers and given.depth:
        depths = np.linspace(0.0, given.depth, given.layers + 1)
    elif plastic:
        depths = _layer_faces(
            min(hx, hy), min(a, b), zone, room.below, scene.body.plasticity.depth_profile().depth
        )
    else:
        count = round(DEPTH_RANGE / DEPTH_SPACING)
        depths = np.arange(count + 1) * (DEPTH_SPACING * min(a, b))
        if scene.body.coating is not None:
            from sam.coated_grid import depths_with_film

            depths = depths_with_film(depths, scene.body.coating.thickness)
    if plastic:
        return CellGrid(nx, ny, hx, hy, (depths[1:] + depths[:-1]) / 2, depths, room=room)
    return CellGrid(nx, ny, hx, hy, depths, room=room)


def point_load_reach(scene: Scene, radius: float) -> float:
    """Depth in m at which the peak force, acting at a point, brings unstrained bulk material to yield.

    On the axis of Boussinesq's point force F, szz = -3F/(2 pi z^2) and srr = (1 - 2 nu) F/(4 pi z^2) (Johnson 1985, Eq. 3.19),
    so the von Mises stress (7/2 - nu) F/(2 pi z^2) equals the yield stress at z = sqrt((7/2 - nu) F/(2 pi sigma_y)). By
    Saint-Venant's principle a plastic zone much larger than the contact ends about there, whatever the hardening.
    radius: of Hertz's contact in m; FARTHEST of them at most, as a law may begin at a vanishing yield stress.
    """
    plasticity = scene.body.plasticity
    bulk = float(plasticity.curve().stress(np.zeros(1))[0]) * plasticity.depth_profile().factor[-1]
    reach = sqrt((3.5 - scene.body.poisson) * peak_force(scene) / (2 * pi * bulk))
    return min(reach, FARTHEST * radius)


def _farthest(scene: Scene) -> tuple[float, float]:
    """Largest |x| and |y| in m of the centre of a travelling load; zero without path."""
    path = scene.loading.path
    return (
        tuple(max(map(abs, ends)) for ends in zip(path.start, path.end, strict=True)) if path else (0.0, 0.0)
    )


def _layer_faces(
    thickness: float, radius: float, zone: float, room: float, kinks: Sequence[float] = ()
) -> np.ndarray:
    """Faces of equal layers down to EVEN_DEPTH radii, then of growing ones to LAYER_RANGE.

    zone: depth in m (see `point_load_reach`) above which the lowest layer must not begin, as a plastic zone leaves it free;
    room: factor on both depths.
    kinks: depths of the rows of a profile of the yield stress. They are faces too, as a layer has the yield stress at its
    centre: with none at its lower side a soft layer would be thinner or thicker. LAYERS_IN_PROFILE or more down
    to the last of them, none thinner than thickness/SLENDEST.
    """
    faces, kinks = [0.0], [z for z in kinks if 0 < z < EVEN_DEPTH * radius]
    thin = max(min([thickness, *(z / LAYERS_IN_PROFILE for z in kinks[-1:])]), thickness / SLENDEST)
    for kink in kinks:
        length = kink - faces[-1]
        if length >= thin / 2:  # nearer rows are one
            faces.extend(np.linspace(faces[-1], kink, max(1, ceil(length / thin - 1e-9)) + 1)[1:])
    faces.extend(
        faces[-1] + thickness * np.arange(1, np.ceil((EVEN_DEPTH * radius - faces[-1]) / thickness) + 1)
    )
    while faces[-1] < LAYER_RANGE * radius * room or faces[-2] < zone * room:
        thickness *= LAYER_GROWTH
        faces.append(faces[-1] + thickness)
    return np.array(faces)


def gap_of(scene: Scene, grid: CellGrid) -> np.ndarray:
    """Initial gap at the cell centres, (nx, ny) in m: x^2/(2 Rx) + y^2/(2 Ry); 0 under a punch and inf beside it.

    Not a number where the scene gives the pressure and no counter-body. Of a rough body less its heights, and 0 where the
    bodies touch first.
    """
    smooth = _profile(scene, grid)
    if scene.surface is None:
        return smooth
    from sam.rough import rough_gap

    return rough_gap(scene, grid, smooth)


def _profile(scene: Scene, grid: CellGrid) -> np.ndarray:
    """The gap of a smooth body.

    The cells of a punch are those nearest to its axis that together have its area, as closely as whole rings allow.
    """
    x, y = grid.x[:, None], grid.y[None, :]
    if scene.counterbody is None:
        return np.full((grid.nx, grid.ny), np.nan)
    if scene.counterbody.shape == "punch":
        return np.where(
            _cells_of_circle(np.hypot(x, y), scene.counterbody.radius, grid.hx * grid.hy), 0.0, np.inf
        )
    if scene.counterbody.shape == "flat":
        return np.zeros((grid.nx, grid.ny))
    rx, ry = scene.counterbody.radii
    return x**2 / (2 * rx) + y**2 / (2 * ry)


def _cells_of_circle(distance: np.ndarray, radius: float, cell_area: float) -> np.ndarray:
    """The cells nearest to the centre whose number comes closest to the area of the circle: at least the innermost.

    Cells at one distance enter together, so the symmetry of the grid stays.
    """
    rings, counts = np.unique(np.round(distance / radius, 9), return_counts=True)
    last = np.abs(np.cumsum(counts) - pi * radius**2 / cell_area).argmin()
    return np.round(distance / radius, 9) <= rings[last]


def equivalent_radius(area: float) -> float:
    """Radius in m of the circle with that area."""
    return sqrt(area / pi)
