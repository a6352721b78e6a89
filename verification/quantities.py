# SPDX-License-Identifier: MIT
"""The vocabulary: each quantity that a row may name, in words, with its unit and how it is taken from a
result.

A quantity is a number or a field. Held against a reference, it is `of` a result of either model beside
the value or function of the same name in the reference; SAM against finite elements, it is `between` two
results, where nothing else is said the row of `compare` of that name.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from sam.scene import Result, Scene
from verification.judging import Measured
from verification.runs.models import SAM
from verification.runs.sampling import peak, pressure_map, pressure_on

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


@dataclass(frozen=True)
class Solved:
    """A scene with its reference and the result of each model, by the name of its run; frame: of the sweeps
    of the case, see `verification.cases.sweep`.
    """

    scene: Scene
    reference: Reference | None
    results: dict[str, Result]
    frame: pd.DataFrame | None = None


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
    """words: for the reader, without the model; of: (result, reference) -> number or Values; between:
    (scene, SAM, FEM) -> Measured; row: of `compare` that holds one model against the other.
    """

    words: str
    unit: str = ""
    of: Callable[[Result, Reference], float | Values] | None = None
    between: Callable[[Scene, Result, Result], Measured] | None = None
    row: str = ""

    def against(self, name: str, result: Result, reference: Reference | None) -> Measured:
        """The quantity of a result beside the value of its name in the reference; alone where that has
        none.
        """
        found = self.of(result, reference)
        expected = reference.values.get(name) if reference else None
        if isinstance(found, Values):
            return Measured(found.values, expected(*found.places), found.weight)
        return Measured(found, expected, unit=self.unit)


def _scalar(name: str, words: str, unit: str = "", *, pair: bool = False) -> Quantity:
    """A quantity of summary.json; pair: SAM against FEM it is the value beside the other, not a row of
    compare.
    """

    def between(scene: Scene, sam: Result, fem: Result) -> Measured:
        return Measured(sam.quantities[name], fem.quantities[name], unit=unit)

    return Quantity(words, unit, lambda result, _: result.quantities[name], between if pair else None, name)


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


def _pressure_on_cells(scene: Scene, sam: Result, fem: Result) -> Measured:
    """Both over the cells of SAM; between nodes p is linear where the body yields, else p^2."""
    x, y, p = pressure_map(sam)
    return Measured(p, pressure_on(x, y, fem.tables, power=1 if scene.body.plasticity else 2))


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
    "peeq-max": _scalar("peeq_max", "largest plastic strain", pair=True),
    "peeq-axis": Quantity("plastic strain on the axis", row="peeq on the axis"),
    "peeq-plane": Quantity("plastic strain in the plane y = 0", row="peeq in the plane y = 0"),
    "residual-centre": _scalar("residual_uz_center_m", "residual displacement in the centre", "m", pair=True),
}
