# SPDX-License-Identifier: MIT
"""The vocabulary: each quantity that a row may name, in words, with its unit and how it is taken from a
result.

A quantity is a number or a field. Held against a reference, it is `of` a result of either model beside
the value or function of the same name in the reference; SAM against finite elements, it is `between` two
results, where nothing else is said the row of `compare` of that name; of all runs of a scene it is `whole`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.interpolate import RegularGridInterpolator

from sam.scene import UNLOADED, Result, Scene
from verification.compare import measures
from verification.compare.measures import Plane, Spot, nodal_pressures, patch_pressure, spots
from verification.judging import Measured, relative_l2
from verification.reference.hertz import CircularContact, effective_modulus
from verification.reference.hertz_line import LineContact
from verification.reference.stress import von_mises
from verification.runs.models import FEM_3D, FEM_LINE, SAM
from verification.runs.sampling import (
    means_of_cells,
    means_of_line,
    peak,
    plane_field,
    pressure_map,
    pressure_on,
    ring_edges,
    rows_of,
)

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Reference:
    """An independent answer for a scene. values: quantity -> number in SI, or function of the places of its
    field; units: a (length), p0, approach, or others by which figures divide; curves: (table, column) ->
    function of the place in m; deepest, inside: how far a field on the axis, a pressure along the surface is
    compared, in m.
    """

    values: Mapping[str, Any]
    units: Mapping[str, float]
    curves: Mapping[tuple[str, str], Callable] = field(default_factory=dict)
    deepest: float = np.inf
    inside: float = np.inf


def modulus_of(scene: Scene) -> float:
    """The contact modulus E* in Pa: 1/E* = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2."""
    body, other = scene.body, scene.counterbody
    return effective_modulus(body.young, body.poisson, other.young, other.poisson)


def contact_of(scene: Scene) -> CircularContact | LineContact:
    """The elastic contact of a scene with a sphere or a cylinder."""
    if (length := scene.counterbody.length) is not None:
        return LineContact(scene.loading.force, scene.counterbody.radius, modulus_of(scene), length)
    return CircularContact(scene.loading.force, scene.counterbody.radius, modulus_of(scene))


@dataclass(frozen=True)
class Solved:
    """A scene with its reference and the result of each model, by the name of its run; frame: of the
    sweeps of the case, see `verification.cases.sweep`; coarser: the same with larger cells and elements,
    and the ratio of the sizes; without a scene the frame is all.
    """

    scene: Scene | None
    reference: Reference | None
    results: dict[str, Result]
    frame: pd.DataFrame | None = None
    coarser: Sequence[tuple[Result, float]] = ()


@dataclass(frozen=True)
class Values:
    """A field. places: coordinates in m, as the reference takes them; weight: see Measured."""

    places: tuple[Any, ...]
    values: np.ndarray
    weight: np.ndarray | None = None


@dataclass(frozen=True)
class Quantity:
    """words: for the reader, without the model; of: (result, reference) -> number, Values, or Measured where
    the result has the answer itself; between: (scene, SAM, other result) -> Measured; row: of `compare`, the
    difference of both models where that alone is held; whole: of all runs of a scene.
    """

    words: str
    unit: str = ""
    of: Callable[[Result, Reference], float | Values | Measured] | None = None
    between: Callable[[Scene, Result, Result], Measured] | None = None
    row: str = ""
    whole: Callable[[Solved], Measured | float] | None = None

    def against(self, name: str, result: Result, reference: Reference | None) -> Measured:
        """The quantity of a result beside the value of its name in the reference, where it has one."""
        found = self.of(result, reference)
        if isinstance(found, Measured):
            return found
        expected = reference.values.get(name) if reference else None
        if isinstance(found, Values):
            return Measured(found.values, expected(*found.places), found.weight)
        return Measured(found, expected, unit=self.unit)


def _scalar(name: str, words: str, unit: str = "") -> Quantity:
    """A quantity of summary.json."""

    def between(scene: Scene, sam: Result, other: Result) -> Measured:
        return Measured(sam.quantities[name], other.quantities[name], unit=unit)

    return Quantity(words, unit, lambda result, _: result.quantities[name], between, name)


def _load(result: Result, reference: Reference) -> float:
    """The sum over the cells of SAM; of finite elements the error of their multipliers."""
    if result.model != SAM:
        return result.certificate["force_balance"]
    x, y, p = pressure_map(result)
    return float(np.sum(p) * ((x[1] - x[0]) * (y[1] - y[0])))


def _pressure(result: Result, reference: Reference) -> Values:
    """On the cells of SAM, the nodes of FEM with their area 2 pi r dr, or dr; along the line in a punch."""
    if np.isfinite(reference.inside):
        x, p = peak(result.tables["line"], "x_m", "p_Pa")
        x, p = x[inside := (x >= 0.0) & (x <= reference.inside)], p[inside]
        return Values((x, 0.0), p, x * np.gradient(x))
    if result.model == SAM:
        x, y, p = pressure_map(result)
        return Values((x[:, None], y[None, :]), p)
    r, p = peak(result.tables["line"], "x_m", "p_Pa")
    return Values((r, 0.0), p, np.gradient(r) * (1.0 if result.model == FEM_LINE else r))


def _pressure_on_cells(scene: Scene, sam: Result, other: Result) -> Measured:
    """Both pressures on the cells of SAM: that of other cells bilinear, of rings of nodes linear in p where
    the body yields, else in p^2; of the three-dimensional model at its nodes.
    """
    if other.model == FEM_3D:
        return Measured(*nodal_pressures(sam, other))
    x, y, p = pressure_map(sam)
    if other.model == SAM:
        u, v, field = pressure_map(other)
        at = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
        return Measured(p, RegularGridInterpolator((u, v), field, bounds_error=False, fill_value=0.0)(at))
    return Measured(p, pressure_on(x, y, other.tables, power=1 if scene.body.plasticity else 2))


def _pressure_over_rings(scene: Scene, sam: Result, fem: Result) -> Measured:
    """Means over rings of a tenth of the elastic contact radius, weighted with their areas."""
    reach = 1.2 * fem.quantities["contact_radius_m"]
    edges = ring_edges(0.1 * contact_of(scene).contact_radius, reach)
    r, p = peak(fem.tables["line"], "x_m", "p_Pa")
    cells = means_of_cells(*pressure_map(sam), edges)
    return Measured(cells, means_of_line(r, p, edges), np.diff(edges**2))


def _largest_strain(scene: Scene, *results: Result, below: bool) -> Measured:
    """The largest plastic strain of cells or Gauss points in y = 0, in the layer or below it."""
    thickness = scene.body.plasticity.layer_thickness
    pairs = [peak(each.tables["plane"], "z_m", "peeq") for each in results]
    return Measured(*(float(peeq[(z >= thickness) == below].max()) for z, peeq in pairs))


def _of_two_cycles(result: Result) -> tuple[float, float, float, float]:
    """Plastic strain at the first peak and in the end, approach at the first peak and at the second."""
    names = ("cycle", "force_N", "approach_m", "peeq_max")
    cycle, force, approach, peeq = (np.asarray(result.tables["history"][name]) for name in names)
    first, second = (np.flatnonzero(cycle == k)[np.argmax(force[cycle == k])] for k in (1, 2))
    return float(peeq[first]), float(peeq[-1]), float(approach[first]), float(approach[second])


def _patch(scene: Scene, sam: Result, fem: Result) -> Measured:
    """Of a rough patch on the cells that both models have, else at the nodes of FEM with their areas."""
    if scene.patch_surface:
        return Measured(*(patch_pressure(each.tables)[-1] for each in (sam, fem)))
    return Measured(*nodal_pressures(sam, fem))


def _of_spot(scene: Scene, sam: Result, fem: Result, *, number: int, load: bool) -> Measured:
    """The load of a contact spot, counted along x, or the strain below it; nan where there are fewer."""
    for spot in spots(sam.tables, fem.tables)[number - 1 : number]:
        return Measured(spot.sam, spot.fem, unit="N") if load else strain_below(scene, sam, fem, spot)[1]
    return Measured(np.nan, np.nan)


def strain_below(scene: Scene, sam: Result, fem: Result, spot: Spot) -> tuple[np.ndarray, Measured]:
    """Depths in m, and the plastic strains there below the centre of a spot."""
    law = scene.body.plasticity
    jump = law.layer_thickness if law.layer else 0.0
    own, other = (Plane.of(each.tables, jump=jump) for each in (sam, fem))
    z = measures.depths_compared(other, spot.x, spot.radius)
    return z, Measured(own.below(spot.x, z), other.below(spot.x, z))


def _below_spots(scene: Scene, sam: Result, fem: Result) -> Measured:
    """Of the spot where it is largest."""
    pairs = (strain_below(scene, sam, fem, spot)[1] for spot in spots(sam.tables, fem.tables))
    return Measured(max((relative_l2(p.value, p.expected) for p in pairs), default=np.nan))


def _strip_width(result: Result, reference: Reference) -> float:
    """Contact width of a wave in m: where the line p^2/cos^2 psi over sin^2 psi ends (Westergaard 1939)."""
    x, _, p = pressure_map(result)
    wave, bears = reference.units["wave"], p[:, 0] > 0.0
    use = bears & np.roll(bears, 1) & np.roll(bears, -1)
    psi, p = np.pi / wave * x[use], p[use, 0]
    slope, level = np.polyfit(np.sin(psi) ** 2, (p / np.cos(psi)) ** 2, 1)
    return 2.0 * wave / np.pi * float(np.arcsin(np.sqrt(-level / slope)))


def _residual(scene: Scene, sam: Result, fem: Result) -> Measured:
    (x, own), (u, other) = (rows_of(each.tables["line"], UNLOADED, "x_m", "uz_m") for each in (sam, fem))
    return Measured(own, np.interp(x, u, other), unit="m")


def _below_film(scene: Scene, sam: Result, fem: Result) -> Measured:
    """In y = 0 where FEM gives it, from the interface on: SAM linear between its points."""
    interface, wide = scene.body.coating.thickness * (1.0 - 1e-9), 1.5 * contact_of(scene).contact_radius
    (x, z, own), (u, w, other) = (plane_field(each.tables, "mises_Pa") for each in (sam, fem))
    body, columns, rows = z >= interface, np.abs(u) <= wide, (w >= interface) & (w <= z[-1])
    depths = np.maximum(w[rows], z[body][0])  # the interface to rounding
    at = np.stack(np.meshgrid(u[columns], depths, indexing="ij"), axis=-1)
    field = RegularGridInterpolator((x, z[body]), own[:, body])(at)
    return Measured(field, other[np.ix_(columns, rows)])


def _centroid(scene: Scene, sam: Result, fem: Result) -> Measured:
    a = contact_of(scene).contact_radius
    first, second = (each.quantities["pressure_centroid_x_m"] / a for each in (sam, fem))
    return Measured(first, second, unit="a")


def _largest(*results: Any, of: Callable[..., Measured]) -> Measured:
    """The largest value of a field of both models."""
    found = of(*results)
    first, second = (float(np.max(np.asarray(each))) for each in (found.value, found.expected))
    return Measured(first, second, unit="Pa")


def _at_interface(result: Result, reference: Reference) -> Values:
    """Along y = 0 where the body meets the film."""
    x, z, field = plane_field(result.tables, "mises_Pa")
    use = np.abs(x) <= 1.5 * reference.units["a"]
    (row,) = np.flatnonzero(np.isclose(z, reference.units["h"], rtol=1e-9, atol=0.0))
    return Values((x[use],), field[use, row])


def _mises_on_axis(result: Result, reference: Reference) -> Values:
    """Each point stands for the depth around it."""
    z, mises = peak(result.tables["axis"], "z_m", "mises_Pa")
    z, mises = z[use := z <= reference.deepest], mises[use]
    return Values((z,), mises, np.gradient(z))


PATCH = 0.2  # half width, in elastic contact radii, of the hats over which pressures are held against FEM
STILL = 1e-9  # growth that counts as none in a ratio: thousandths of what the plastic loop resolves


def planes(solved: Solved) -> dict[str, Plane]:
    """Run -> plastic strain in the plane y = 0."""
    return {name: Plane.of(each.tables, solved.reference.units["a"]) for name, each in solved.results.items()}


def _column_of(solved: Solved, column: bool) -> tuple[dict[str, Plane], float]:
    """The planes of all runs, and x of the axis or of the column where the strain of FEM is largest."""
    both = planes(solved)
    return both, both["fem"].place_of_maximum() if column else 0.0


def _profile(solved: Solved, *, column: bool) -> float:
    both, x = _column_of(solved, column)
    return measures.profile_difference(both["sam"], both["fem"], x)


def _limit(solved: Solved, *, column: bool) -> float:
    """The same of the limits of both models."""
    (both, x), a = _column_of(solved, column), solved.reference.units["a"]
    z = measures.depths_compared(both["fem"], x)
    one, other = (measures.limit_of_strain(solved.results, m, a=a, x=x, z=z) for m in ("sam", "fem"))
    return float(np.abs(one / other - 1.0).max())


def _contour(solved: Solved, *, percent: float, extent: str) -> Measured:
    """Depth or length of the part of y = 0 beyond a plastic strain, from the first depth of both on."""
    both = [planes(solved)[name] for name in ("sam", "fem")]
    top = max(plane.z[0] for plane in both)
    sam, fem = (measures.contour(plane, percent / 100, top) for plane in both)
    return Measured(sam and getattr(sam, extent), fem and getattr(fem, extent), unit="a")


def _decoupled(solved: Solved, *, distance: Callable[[Result, Result, float], float]) -> float:
    """Pressure of the decoupled form off FEM over that of the coupled one."""
    runs, a = solved.results, solved.reference.units["a"]
    return distance(runs["decoupled"], runs["fem"], a) / distance(runs["sam"], runs["fem"], a)


def _stress(words: str, inside: Callable, of_tensor: Callable = np.asarray, part: Any = np.s_[:]) -> Quantity:
    """What `inside` takes of a result, or a part of it, against the closed form of the reference, in p0."""

    def of(result: Result, reference: Reference) -> float:
        places, found = inside(result, reference.units["a"])
        exact = of_tensor(reference.values["stress"](*places))
        return float(np.abs(found / reference.units["p0"] - exact)[part].max())

    return Quantity(f"largest error of {words}, in p0", of=of)


def _growth(lead: str) -> Callable[[Solved], float]:
    """Of two runs of a travelling load, the latter of more passes."""
    return lambda solved: measures.growth(*(r for n, r in solved.results.items() if n.startswith(lead)))


_settles, _grows = _growth("below"), _growth("above")
_LARGEST = "largest relative difference"
SLIDING: Mapping[str, Quantity] = {
    **{
        f"{lead}{name}": Quantity(f"{words}{without}, {_LARGEST}", whole=partial(of, column=name == "column"))
        for name, words in (
            ("axis", "plastic strain at z >= 0.3 a on the axis"),
            ("column", "plastic strain at z >= 0.3 a at the x of the largest"),
        )
        for lead, of, without in (("", _profile, ""), ("limit-", _limit, " without cells and load steps"))
    },
    **{
        f"contour-{percent:g}-{extent}".replace(".", "-"): Quantity(
            f"{extent} of the part of y = 0 beyond {percent:g} % of plastic strain",
            "a",
            whole=partial(_contour, percent=percent, extent=extent),
        )
        for percent in (0.2, 2.0)
        for extent in ("depth", "length")
    },
    "decoupled": Quantity(
        "deviation of the pressure from FEM (L2 at the nodes): normal displacement by shear neglected, "
        "divided by the same with it kept",
        whole=partial(_decoupled, distance=lambda sam, fem, _: relative_l2(*nodal_pressures(sam, fem))),
    ),
    "decoupled-hats": Quantity(
        "deviation of the pressure from FEM (L2 of means over 0.2 a): normal displacement by shear "
        "neglected, divided by the same with it kept",
        whole=partial(_decoupled, distance=lambda sam, fem, a: measures.patch_distance(sam, fem, PATCH * a)),
    ),
    **{
        name: _stress(f"{name} at interior points", measures.stresses_inside, part=np.s_[:, k])
        for k, name in enumerate(measures.COMPONENTS)
    },
    "plane": _stress("the von Mises stress in y = 0 from 0.25 a on", measures.mises_inside, von_mises),
    "adds": Quantity(
        "plastic strain added by later cycles over that of the first",
        of=lambda result, _: float((peeq := result.tables["cycles"]["peeq_max"])[-1] / peeq[0] - 1.0),
    ),
    "moved": _scalar("residual_ux_center_m", "residual displacement of the centre along x", "m"),
    "settles": Quantity("plastic strain that a pass adds anywhere in y = 0, p0/k = 4.4", whole=_settles),
    "grows": Quantity("plastic strain that a pass adds anywhere in y = 0, p0/k = 4.9", whole=_grows),
    "apart": Quantity(
        "growth at p0/k = 4.9 over that at 4.4", whole=lambda s: _grows(s) / max(_settles(s), STILL)
    ),
}


def ladders(solved: Solved) -> list[dict[int, Result]]:
    """Of SAM and of finite elements, the runs "sam-N" and "fem-N": N -> result, the finest last."""
    named = {tuple(name.split("-", 1)): each for name, each in solved.results.items()}
    return [
        {int(n): named[model, n] for model, n in named if model == run and n.isdigit()}
        for run in ("sam", "fem")
    ]


def refined(runs: Mapping[int, Result], value: Callable[[Result], Any]) -> np.ndarray:
    """The limit of a value in 1/N of second order, of the two finest runs; of a single run its own."""
    *coarse, fine = (np.asarray(value(runs[n])) for n in sorted(runs))
    if not coarse:
        return fine
    n, m = sorted(runs)[-2:]
    return fine + (fine - coarse[-1]) / ((m / n) ** 2 - 1)


def groove_at(result: Result, places: np.ndarray) -> np.ndarray:
    """Depth of the groove in m at places along the track."""
    return np.interp(places, result.tables["track"]["x_m"], result.tables["track"]["uz_m"])


def _groove(solved: Solved) -> float:
    """Difference of the finest runs within a radius of the middle, over the depth."""
    places = np.linspace(-1.0, 1.0, 81) * solved.reference.units["a"]
    sam, fem = (groove_at(runs[max(runs)], places) for runs in ladders(solved))
    return float(np.abs(sam - fem).max() / fem.max())


OF_TRACKS: Mapping[str, Callable[[Result], float]] = {
    "groove in the middle of the track": lambda result: float(groove_at(result, 0.0)),
    "largest depth of the groove": lambda result: float(result.quantities["groove_deepest_m"]),
    "largest plastic strain": lambda result: float(result.quantities["peeq_max"]),
}


def _both_refined(words: str, unit: str) -> Quantity:
    """A value of a track, both models refined."""

    def whole(solved: Solved) -> Measured:
        sam, fem = (float(refined(runs, OF_TRACKS[words])) for runs in ladders(solved))
        return Measured(sam, fem, unit=unit)

    return Quantity(f"{words}, both models refined", unit, whole=whole)


def of_passes(result: Result, name: str) -> np.ndarray:
    """The "energy" in J that each pass dissipates, or the largest new "strain" of the steady part."""
    table, column = {"energy": ("cycles", "dissipated_J"), "strain": ("passes", "new_strain_max")}[name]
    return np.asarray(result.tables[table][column], dtype=float)


def of_cycles(result: Result, column: str) -> np.ndarray:
    """A column of the table of cycles."""
    return np.asarray(result.tables["cycles"][column], dtype=float)


def _counted(solved: Solved) -> np.ndarray:
    """Which passes strain more than the floor of the verdict, in all runs of both models."""
    runs = solved.results.values()
    return np.all([of_passes(each, "strain") > each.verdict["floor"] for each in runs], axis=0)


def _pass(name: str, words: str, *, own: bool = False) -> Quantity:
    """Largest difference of a pass, over what the first one does, as a later pass strains little and has the
    error of the strain that has accumulated; own: of a pass that counts, over what itself does.
    """

    def whole(solved: Solved) -> float:
        sam, fem = (refined(runs, lambda result: of_passes(result, name)) for runs in ladders(solved))
        if own:
            return float(np.abs(sam[counted := _counted(solved)] / fem[counted] - 1.0).max())
        return float(np.abs(sam - fem).max() / fem[0])

    over = "of a pass that counts, over itself" if own else "over the first pass"
    return Quantity(f"{words}, largest difference of both models {over}", whole=whole)


def _verdicts(solved: Solved) -> set[str]:
    return {each.verdict["class"] for each in solved.results.values()}


def _becomes(name: str) -> Quantity:
    """Whether a run, or all runs, end with a verdict."""
    return Quantity(
        f"1 if the verdict is {name}",
        of=lambda result, _: float(result.verdict["class"] == name),
        whole=lambda solved: Measured(float(_verdicts(solved) == {name}), 1.0),
    )


MOVING: Mapping[str, Quantity] = {
    "groove": Quantity("largest difference of the groove between both models over its depth", whole=_groove),
    "groove-refined": _both_refined("groove in the middle of the track", "m"),
    "deepest-refined": _both_refined("largest depth of the groove", "m"),
    "strain-refined": _both_refined("largest plastic strain", ""),
    "verdict": Quantity(
        "different verdicts of both models on all grids",
        whole=lambda solved: Measured(float(len(_verdicts(solved))), 1.0),
    ),
    "energy": _pass("energy", "energy that a pass dissipates"),
    "strain": _pass("strain", "largest strain that a pass adds"),
    "own-energy": _pass("energy", "energy of a pass", own=True),
    "own-strain": _pass("strain", "largest strain of a pass", own=True),
    "counted": Quantity(
        "passes that strain some cell by more than the floor of the verdict, on all grids",
        whole=lambda solved: float(_counted(solved).sum()),
    ),
    "class": Quantity("verdict", of=lambda result, _: result.verdict["class"]),
    "shakes-down": _becomes("shakedown"),
    "alternates": _becomes("alternating"),
}

QUANTITIES: Mapping[str, Quantity] = {
    "p-max": _scalar("p_max_Pa", "largest pressure", "Pa"),
    "p-center": _scalar("p_center_Pa", "pressure in the centre", "Pa"),
    "approach": _scalar("approach_m", "approach", "m"),
    "radius": _scalar("contact_radius_m", "contact radius", "m"),
    "half-width": _scalar("contact_half_width_m", "half-width of the contact", "m"),
    "load": Quantity("sum of the pressure over the cells", "N", _load),
    "pressure": Quantity("pressure over the surface", "Pa", _pressure, _pressure_on_cells),
    "displacement": Quantity("displacement of the surface to 2 a", "m", row="uz_m on the line"),
    "mises-max": _scalar("mises_max_Pa", "largest von Mises stress", "Pa"),
    "mises-depth": _scalar("mises_max_depth_m", "depth of the largest von Mises stress", "m"),
    "mises-axis": Quantity("von Mises stress on the axis", "Pa", _mises_on_axis, row="mises_Pa on the axis"),
    "mises-plane": Quantity("von Mises stress in the plane y = 0", "Pa", row="mises_Pa in the plane y = 0"),
    "peeq-max": _scalar("peeq_max", "largest plastic strain"),
    "peeq-depth": _scalar("peeq_max_depth_m", "depth of the largest plastic strain", "m"),
    "peeq-axis": Quantity("plastic strain on the axis", row="peeq on the axis"),
    "peeq-plane": Quantity("plastic strain in the plane y = 0", row="peeq in the plane y = 0"),
    "residual-centre": _scalar("residual_uz_center_m", "displacement of the centre after unloading", "m"),
    "residual-axis": Quantity("residual von Mises stress on the axis", row="residual mises_Pa on the axis"),
    "residual-mises": _scalar("residual_mises_max_Pa", "largest residual von Mises stress", "Pa"),
    "pressure-rings": Quantity("mean pressure over rings of a/10", "Pa", between=_pressure_over_rings),
    "strain-layer": Quantity(
        "largest plastic strain in the layer", between=partial(_largest_strain, below=False)
    ),
    "strain-below": Quantity(
        "largest plastic strain below the layer", between=partial(_largest_strain, below=True)
    ),
    "peeq-reloaded": Quantity(
        "largest plastic strain after the second load, against the first",
        of=lambda result, _: Measured(*_of_two_cycles(result)[1::-1]),
    ),
    "approach-reloaded": Quantity(
        "change of the approach at the peak by the second cycle",
        of=lambda result, _: abs((values := _of_two_cycles(result))[3] / values[2] - 1.0),
    ),
    "applications": Quantity(
        "applications of the residual-stress operator by SAM",
        between=lambda scene, sam, fem: Measured(sam.cost["operator_applications"]),
    ),
    **SLIDING,
    **MOVING,
    "mises-film": _scalar("mises_max_film_Pa", "largest von Mises stress of the film", "Pa"),
    "mises-body": _scalar("mises_max_substrate_Pa", "largest von Mises stress of the body", "Pa"),
    "mises-interface": Quantity("von Mises stress of the body along the interface", "Pa", _at_interface),
    "p-change": _scalar("p_max_change", "change of the largest pressure by the film"),
    "mises-change": _scalar(
        "mises_max_change", "change of the largest von Mises stress of the body by the film"
    ),
    "nodal-pressure": Quantity("pressure over the cells or nodes", "Pa", between=_patch),
    "nodal-p-max": Quantity(
        "largest pressure at the nodes of FEM, to which SAM is averaged",
        "Pa",
        between=partial(_largest, of=_patch),
    ),
    "centroid": Quantity("centre of pressure, in contact radii", between=_centroid),
    "mises-below-film": Quantity(
        "von Mises stress of the body in y = 0, at the interface and the centres of the elements",
        between=_below_film,
    ),
    "mises-below-film-max": Quantity(
        "largest von Mises stress of the body in y = 0, same points in both models",
        "Pa",
        between=partial(_largest, of=_below_film),
    ),
    "area": _scalar("contact_area_m2", "contact area", "m²"),
    "share": _scalar("contact_share", "share of the patch in contact"),
    "published-share": Quantity(
        "share of the patch in contact, against a fit",
        of=lambda result, _: result.quantities["contact_share"],
    ),
    "fitted-share": _scalar("contact_share", "share of the patch in contact, against a published fit"),
    "open-share": Quantity(
        "share of the patch not in contact", of=lambda result, _: 1.0 - result.quantities["contact_share"]
    ),
    "strip-width": Quantity("width of the strip in contact", "m", _strip_width),
    "friction": _scalar("friction_coefficient", "coefficient of friction of the whole contact"),
    "spots": Quantity(
        "contact spots of the three asperities that bear more than 5 % of the force",
        between=lambda scene, sam, fem: Measured(len(spots(sam.tables, fem.tables)), 3),
    ),
    **{
        f"load-{k}": Quantity(
            f"load of spot {k}",
            "N",
            between=partial(_of_spot, number=k, load=True),
        )
        for k in (1, 2, 3)
    },
    **{
        f"strain-{k}": Quantity(
            f"plastic strain below spot {k} at z >= 0.3 radii, down to a tenth of the largest",
            between=partial(_of_spot, number=k, load=False),
        )
        for k in (1, 2, 3)
    },
    "strain-below-spots": Quantity(
        "plastic strain below a spot, the largest difference", between=_below_spots
    ),
    "residual-line": Quantity("displacement along y = 0 after unloading", "m", between=_residual),
    "reference-residual": Quantity(
        "error of the surface's shape in the spectral solution", of=lambda _, exact: exact.values["residual"]
    ),
}
