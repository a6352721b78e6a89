# SPDX-License-Identifier: MIT
"""The vocabulary: each quantity that a row may name, in words, with its unit and how it is taken from a
result.

A quantity is a number or a field. Held against a reference, it is `of` a result of either model beside
the value or function of the same name in the reference; SAM against finite elements, it is `between` two
results, where nothing else is said the row of `compare` of that name.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.interpolate import RegularGridInterpolator

from sam.scene import Result, Scene
from verification.judging import Measured
from verification.reference.hertz import CircularContact, effective_modulus
from verification.runs.models import SAM
from verification.runs.sampling import (
    means_of_cells,
    means_of_line,
    peak,
    pressure_map,
    pressure_on,
    ring_edges,
)

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Reference:
    """An independent answer for a scene.

    values: quantity -> number in SI, or function of the places of its field; units: a (length), p0,
    approach, or others by which figures divide; curves: (table, column) -> function of the place in m;
    deepest, inside: how far a field on the axis, a pressure along the surface is compared, in m; facts:
    (name, number with unit) for the reader.
    """

    values: Mapping[str, Any]
    units: Mapping[str, float]
    curves: Mapping[tuple[str, str], Callable] = field(default_factory=dict)
    deepest: float = np.inf
    inside: float = np.inf
    facts: tuple[tuple[str, str], ...] = ()


def modulus_of(scene: Scene) -> float:
    """The contact modulus E* in Pa: 1/E* = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2."""
    body, other = scene.body, scene.counterbody
    return effective_modulus(body.young, body.poisson, other.young, other.poisson)


def contact_of(scene: Scene) -> CircularContact:
    """The elastic contact of a scene with a sphere."""
    return CircularContact(scene.loading.force, scene.counterbody.radius, modulus_of(scene))


@dataclass(frozen=True)
class Solved:
    """A scene with its reference and the result of each model, by the name of its run; frame: of the
    sweeps of the case, see `verification.cases.sweep`; coarser: the same with larger cells and elements,
    and the ratio of the sizes; others: of another scene, likewise by run.
    """

    scene: Scene
    reference: Reference | None
    results: dict[str, Result]
    frame: pd.DataFrame | None = None
    coarser: Sequence[tuple[Result, float]] = ()
    others: Mapping[str, Result] = field(default_factory=dict)


@dataclass(frozen=True)
class Values:
    """A field. places: coordinates in m, as the function of the reference takes them; weight: see
    Measured.
    """

    places: tuple[Any, ...]
    values: np.ndarray
    weight: np.ndarray | None = None


@dataclass(frozen=True)
class Quantity:
    """words: for the reader, without the model; of: (result, reference) -> number, Values, or Measured where
    the result has the answer itself; between: (scene, SAM, other result) -> Measured; row: of `compare`, the
    difference of both models where that alone is held.
    """

    words: str
    unit: str = ""
    of: Callable[[Result, Reference], float | Values | Measured] | None = None
    between: Callable[[Scene, Result, Result], Measured] | None = None
    row: str = ""

    def against(self, name: str, result: Result, reference: Reference | None) -> Measured:
        """The quantity of a result beside the value of its name in the reference; alone where that has
        none.
        """
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
    """On the cells of SAM, at the nodes of FEM with the area 2 pi r dr of each; along the line inside a
    punch.
    """
    if np.isfinite(reference.inside):
        x, p = peak(result.tables["line"], "x_m", "p_Pa")
        x, p = x[inside := (x >= 0.0) & (x <= reference.inside)], p[inside]
        return Values((x, 0.0), p, x * np.gradient(x))
    if result.model == SAM:
        x, y, p = pressure_map(result)
        return Values((x[:, None], y[None, :]), p)
    r, p = peak(result.tables["line"], "x_m", "p_Pa")
    return Values((r, 0.0), p, r * np.gradient(r))


def _pressure_on_cells(scene: Scene, sam: Result, other: Result) -> Measured:
    """Both over the cells of SAM; between other cells p is bilinear, zero beyond the outermost, between nodes
    linear where the body yields, else p^2.
    """
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


def _largest_strain(below: bool) -> Callable[[Scene, Result, Result], Measured]:
    """The largest plastic strain of cells or Gauss points in y = 0, in the layer or below it."""

    def between(scene: Scene, *results: Result) -> Measured:
        thickness = scene.body.plasticity.layer_thickness
        pairs = [peak(each.tables["plane"], "z_m", "peeq") for each in results]
        return Measured(*(float(peeq[(z >= thickness) == below].max()) for z, peeq in pairs))

    return between


def _surface_change(scene: Scene, result: Result, other: Result) -> Measured:
    """Of quantities and of fields along the surface, relative to the largest value of each."""
    names = ("approach_m", "contact_area_m2", "p_max_Pa"), ("p_Pa", "uz_m", "gap_m")
    pairs: list[tuple] = [(result.quantities[name], other.quantities[name]) for name in names[0]]
    pairs += [(peak(result.tables["line"], n)[0], peak(other.tables["line"], n)[0]) for n in names[1]]
    return Measured(max(float(np.max(np.abs(np.subtract(a, b))) / np.max(np.abs(b))) for a, b in pairs))


def _of_second_cycle(of: Callable[..., float | Measured]) -> Callable[[Result, Reference], float | Measured]:
    """of: (plastic strain at the first peak, in the end, approach at the first peak, at the second)."""

    def found(result: Result, reference: Reference) -> float | Measured:
        names = ("cycle", "force_N", "approach_m", "peeq_max")
        cycle, force, approach, peeq = (np.asarray(result.tables["history"][name]) for name in names)
        first, second = (np.flatnonzero(cycle == k)[np.argmax(force[cycle == k])] for k in (1, 2))
        return of(float(peeq[first]), float(peeq[-1]), float(approach[first]), float(approach[second]))

    return found


def _mises_on_axis(result: Result, reference: Reference) -> Values:
    """Each point stands for the depth around it."""
    z, mises = peak(result.tables["axis"], "z_m", "mises_Pa")
    z, mises = z[use := z <= reference.deepest], mises[use]
    return Values((z,), mises, np.gradient(z))


QUANTITIES: Mapping[str, Quantity] = {
    "p-max": _scalar("p_max_Pa", "largest pressure", "Pa"),
    "p-center": _scalar("p_center_Pa", "pressure in the centre", "Pa"),
    "approach": _scalar("approach_m", "approach", "m"),
    "radius": _scalar("contact_radius_m", "contact radius", "m"),
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
    "residual-mises": _scalar("residual_mises_max_Pa", "largest residual von Mises stress", "Pa"),
    "pressure-rings": Quantity("mean pressure over rings of a/10", "Pa", between=_pressure_over_rings),
    "strain-layer": Quantity("largest plastic strain in the layer", between=_largest_strain(below=False)),
    "strain-below": Quantity("largest plastic strain below the layer", between=_largest_strain(below=True)),
    "peeq-reloaded": Quantity(
        "largest plastic strain after the second load, against the first",
        of=_of_second_cycle(lambda first, last, *_: Measured(last, first)),
    ),
    "approach-reloaded": Quantity(
        "change of the approach at the peak by the second cycle",
        of=_of_second_cycle(lambda *values: abs(values[3] / values[2] - 1.0)),
    ),
    "surface-change": Quantity("largest change of the surface and the contact", between=_surface_change),
    "applications": Quantity(
        "applications of the residual-stress operator by SAM",
        between=lambda scene, sam, fem: Measured(sam.cost["operator_applications"]),
    ),
}
