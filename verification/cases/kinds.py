# SPDX-License-Identifier: MIT
"""Kinds of figures that the file of a case names, each drawn of a scene, its reference and the results of
both models (`verification.quantities.Solved`). Titles and captions follow from the vocabulary.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import cycle
from typing import TYPE_CHECKING

import numpy as np

from verification.cases.case import Plot
from verification.cases.sweep import BOTH, fitted, spelt, words_of
from verification.figures.friction import CYCLES, Curve, curves
from verification.figures.maps import FieldPair, maps_over_axes, pressure_maps
from verification.figures.plastic import axis_profiles, compared_peeq, residual_surface
from verification.figures.profiles import Profile, convergence, profiles
from verification.figures.refinement import refinement
from verification.figures.style import Drawing
from verification.figures.views import SURFACE_AXES, VON_MISES, compared_mises, compared_pressure
from verification.quantities import Solved
from verification.reference.convergence import extrapolate
from verification.references import contact_of
from verification.rows import CaseFile
from verification.runs.sampling import peak, pressure_map

if TYPE_CHECKING:
    from pandas import DataFrame

COLUMNS = {
    ("line", "p_Pa"): ("Pressure", "$p/p_0$", "p0"),
    ("line", "uz_m"): ("Displacement of the body", r"$u_z/\delta$", "approach"),
    ("line", "gap_m"): ("Gap", r"gap$/\delta$", "approach"),
    ("axis", "szz_Pa"): ("Normal stress", r"$\sigma_{zz}/p_0$", "p0"),
    ("axis", "sxx_Pa"): ("Lateral stress", r"$\sigma_{xx}/p_0$", "p0"),
    ("axis", "mises_Pa"): ("Von Mises stress", VON_MISES, "p0"),
}
"""Table and column -> title, label, unit of the reference that it is divided by."""
UNITS = {"p0": "$p_0$", "approach": r"$\delta$"}


def _maps(what: str, name: str, draw: Callable[[Solved], Drawing]) -> Callable[[Solved], Plot]:
    """Maps of SAM and FEM, and their difference."""
    alt = f"Three maps of the {what}: SAM, FEM and their difference."
    return lambda found: Plot(draw(found), name, what[0].upper() + what[1:], alt, alt)


def _along(*columns: tuple[str, str], name: str, title: str, until: float) -> Callable[[Solved], Plot]:
    """Columns of tables on the curves of the reference to `until` times a, with the errors underneath."""

    def plot(found: Solved) -> Plot:
        units, curves = found.reference.units, found.reference.curves
        a = units["a"]

        def panel(table: str, column: str) -> Profile:
            words, label, unit = COLUMNS[table, column]
            place, axis = ("x_m", "$x/a$") if table == "line" else ("z_m", "$z/a$")
            read = {
                run.upper(): peak(each.tables[table], place, column) for run, each in found.results.items()
            }
            series = {run: (at / a, values / units[unit]) for run, (at, values) in read.items()}
            end = min(until, found.reference.inside / a) if column == "p_Pa" else until

            def exact(at: np.ndarray) -> np.ndarray:
                return curves[table, column](at * a) / units[unit]

            return Profile(words, axis, label, exact, series, 1.0, UNITS[unit], (0.0, end))

        names = ", ".join(COLUMNS[each][0].lower() for each in columns)
        words = f"Curves of {names} of the models on those of the reference, with the errors underneath."
        return Plot(profiles([panel(*each) for each in columns]), name, title, words, words)

    return plot


def _loading(found: Solved) -> Plot:
    """The approach at each load step on the curve of the reference."""
    steps = {run.upper(): each.tables["history"] for run, each in found.results.items()}
    series = {run: (np.array(h["force_N"]), 1e6 * np.array(h["approach_m"])) for run, h in steps.items()}
    exact, end = found.reference.curves["history", "approach_m"], found.scene.loading.force
    scale = 1e6 * found.reference.units["approach"]
    labels = "Approach", "force [N]", r"approach [$\mu$m]"
    panel = Profile(
        *labels, lambda f: 1e6 * exact(f), series, scale, r"$\delta$ at the peak", (0.0, end), points=True
    )
    words = "Approach against force at each load step, with the errors underneath."
    return Plot(profiles([panel]), "loading", "Load and approach", words, words)


def _exact_maps(found: Solved) -> Plot:
    """The pressure of SAM and of the reference, and their difference."""
    (a, b, p0), exact = (
        (found.reference.units[name] for name in ("a", "b", "p0")),
        found.reference.values["pressure"],
    )
    x, y, p = pressure_map(found.results["sam"])
    x, y, p = x[near := np.abs(x) <= 1.2 * a], y[close := np.abs(y) <= 1.2 * a], p[np.ix_(near, close)]
    fields = p / p0, exact(x[:, None], y[None, :]) / p0
    pair = FieldPair(x / a, y / a, *fields, ("SAM", "closed form"), SURFACE_AXES, "$p/p_0$", (1.0, b / a))
    words = "Three maps of the pressure: SAM, closed form and difference; dashed: the exact contact."
    return Plot(pressure_maps(pair), "pressure-maps", "Contact pressure", words, words)


def _across(found: Solved) -> Plot:
    """The pressure along both axes of an elliptic contact and the stress below its centre."""
    (a, b, p0), sam = (found.reference.units[name] for name in ("a", "b", "p0")), found.results["sam"]
    exact, mises = found.reference.values["pressure"], found.reference.values["mises-axis"]
    x, y, p = pressure_map(sam)
    z, stress = peak(sam.tables["axis"], "z_m", "mises_Pa")
    wanted: Sequence[tuple] = (
        (
            "Pressure along x",
            "$x/a$",
            "$p/p_0$",
            lambda s: exact(s * a, 0.0),
            (x / a, p[:, y.size // 2]),
            (-1.5, 1.5),
        ),
        (
            "Pressure along y",
            "$y/b$",
            "$p/p_0$",
            lambda s: exact(0.0, s * b),
            (y / b, p[x.size // 2]),
            (-1.5, 1.5),
        ),
        (
            "Von Mises under the centre",
            "$z/b$",
            VON_MISES,
            lambda s: mises(s * b),
            (z / b, stress),
            (0.0, 2.0),
        ),
    )
    panels = [
        Profile(
            *labels, lambda s, curve=curve: curve(s) / p0, {"SAM": (at, v / p0)}, 1.0, UNITS["p0"], limits
        )
        for *labels, curve, (at, v), limits in wanted
    ]
    words = (
        "Pressure along both axes and von Mises stress under the centre on the closed form, with the errors."
    )
    return Plot(
        profiles(panels), "profiles", "Pressure along the axes, stress under the centre", words, words
    )


def _peeq_maps(found: Solved) -> Drawing:
    return compared_peeq(*found.results.values(), contact_of(found.scene).contact_radius)


def _plastic_axis(found: Solved) -> Plot:
    drawing = axis_profiles(*found.results.values(), contact_of(found.scene).contact_radius)
    alt = (
        "Curves over depth of the plastic strain and von Mises stress at the peak, and of the von Mises and "
        "lateral stress after unloading; SAM on the curves of FEM, with the differences underneath."
    )
    caption = "On the axis r = 0. Underneath: SAM minus FEM in % of the largest value of FEM."
    return Plot(drawing, "axis", "Under the centre, at the peak and unloaded", alt, caption)


def _residual_surface(found: Solved) -> Plot:
    drawing = residual_surface(*found.results.values(), contact_of(found.scene))
    words = (
        "Left: the surface after unloading along y = 0, SAM on the curve of FEM, with the difference. Right: "
        "force over approach at every load step of both models beside the elastic curve of Hertz."
    )
    return Plot(drawing, "surface", "Residual surface, load and approach", words, words)


def _pressure_maps(found: Solved) -> Drawing:
    """To 1.3 a; where the body yields to the contact of FEM."""
    elastic, (sam, fem) = contact_of(found.scene), found.results.values()
    a, p0 = elastic.contact_radius, elastic.peak_pressure
    if not found.scene.body.plasticity:
        return compared_pressure(sam, fem.tables, a, p0)
    edge = fem.quantities["contact_radius_m"] / a
    return compared_pressure(sam, fem.tables, a, p0, reach=1.2 * max(edge, 1.0), edge=edge, power=1)


def _mises_maps(found: Solved) -> Drawing:
    return compared_mises(*found.results.values(), found.reference.units["a"], found.reference.units["p0"])


_PUNCH = (("line", "p_Pa"), ("line", "uz_m"), ("axis", "mises_Pa"))
KINDS: Mapping[str, Callable[[Solved], Plot]] = {
    "pressure-maps": _maps("contact pressure over x/a and y/a", "pressure-maps", _pressure_maps),
    "mises-maps": _maps("von Mises stress in the plane y = 0", "mises-maps", _mises_maps),
    "peeq-maps": _maps("plastic strain in the plane y = 0", "peeq-maps", _peeq_maps),
    "surface": _along(
        *(("line", column) for column in ("p_Pa", "uz_m", "gap_m")),
        name="surface",
        title="Surface: pressure, displacement, gap",
        until=1.98,
    ),
    "axis": _along(
        *(("axis", column) for column in ("szz_Pa", "sxx_Pa", "mises_Pa")),
        name="axis",
        title="Stresses under the centre",
        until=2.0,
    ),
    "punch": _along(
        *_PUNCH, name="profiles", title="Pressure, surface and stress under the centre", until=1.5
    ),
    "loading": _loading,
    "exact-maps": _exact_maps,
    "across": _across,
    "plastic-axis": _plastic_axis,
    "residual-surface": _residual_surface,
}
"""Name in a case file -> how it is drawn."""


def _orders(file: CaseFile, frame: DataFrame) -> Plot:
    """The errors of each sweep over the size of the cells, with the orders that rows take of them."""
    panels, fits = {}, []
    for (name, model), rows in frame[frame["model"] != BOTH].groupby(["sweep", "model"], sort=False):
        sweep, title = file.sweeps[name], model.upper() if name == model else f"{model.upper()}, {name}"
        errors = [column for column, how in sweep.columns.items() if how not in ("value", "between")]
        curves = {
            words_of(file, c): (rows["h"].to_numpy(), rows[c].to_numpy(), fitted(file, rows, c))
            for c in errors
        }
        panels[title] = curves
        fits += [f"{title} {words} {order.order:.2f}" for words, (*_, order) in curves.items() if order]
    said = f"Observed orders: {', '.join(fits)}."
    alt = f"Log-log plot of the errors against the cell size with fitted straight lines. {said}"
    caption = f"Lines: least-squares fits error ~ hᵐ. {said}"
    return Plot(convergence(panels), "orders", "Error against cell size", alt, caption)


def _limits(file: CaseFile, frame: DataFrame, column: str) -> Plot:
    """A strain over the size of what each sweep refines, with the limit of each model."""
    panels, labels, off = {}, {}, []
    for name, rows in frame[frame["model"] != BOTH].groupby("sweep", sort=False):
        models = rows.groupby("model", sort=False)
        points = {model.upper(): (own["h"].to_numpy(), own[column].to_numpy()) for model, own in models}
        panels[name] = {model: (h, v, extrapolate(h, v)) for model, (h, v) in points.items()}
        labels[name] = "1 / load steps" if file.sweeps[name].size == "step" else "cell or element size / a"
        sam, fem = (limit.limit for *_, limit in panels[name].values())
        off.append(f"{name} {1e2 * (sam / fem - 1.0):+.2f} %")
    words, said = words_of(file, column), f"SAM minus FEM, extrapolated: {', '.join(off)}."
    alt = f"The {words} of SAM and FEM under refinement with fitted power laws that meet at zero. {said}"
    caption = f"Lines: limit + c hᵐ fitted to all points. {said}"
    title = f"{words[0].upper()}{words[1:]} under refinement"
    return Plot(refinement(panels, labels, f"{words} [%]"), "refinement", title, alt, caption)


def _lines(file: CaseFile, frame: DataFrame, y: str, *words: str) -> Plot:
    """`lines Y over X by SERIES in PANEL`: a column over an axis or a column, each a number or an array; what
    is expected is dotted.
    """
    said = dict(zip(words[::2], words[1::2], strict=True))
    x, by, panel = said["over"], said.get("by", "model"), said.get("in", "sweep")
    panels: dict[str, dict[str, Curve]] = {}
    for (title, name), rows in frame.dropna(subset=[y]).groupby([panel, by], sort=False):
        for column, series in ((y, spelt(name)), (f"{y} expected", f"{spelt(name)}, expected")):
            if rows[column].notna().all() if column in rows else False:
                values = (np.concatenate([np.atleast_1d(each) for each in rows[c]]) for c in (x, column))
                panels.setdefault(spelt(title), {})[series] = Curve(*values)
    names = dict.fromkeys(name for series in panels.values() for name in series)
    plain, dashed = ([n for n in names if n.endswith(", expected") is ends] for ends in (False, True))
    looks = dict(zip(plain, cycle(CYCLES)))
    looks |= {n: {"color": looks[n.removesuffix(", expected")]["color"], "linestyle": ":"} for n in dashed}
    what = words_of(file, y)
    title = f"{what[0].upper()}{what[1:]}"
    text = f"Curves of the {what} over {x.replace('.', ' ')}, by {by}; dotted: what is expected."
    return Plot(curves(panels, x.replace(".", " "), what, looks=looks), y, title, text, text)


def _maps(file: CaseFile, frame: DataFrame, z: str, *words: str) -> Plot:
    """`maps Z over X Y in PANEL`: a column over two axes, with lines of equal values."""
    (_, x, y, *rest), said = words, words_of(file, z)
    panels = {}
    for name, rows in frame.dropna(subset=[z]).groupby(rest[1] if rest else "model", sort=False):
        table = rows.pivot(index=y, columns=x, values=z)
        panels[spelt(name)] = (table.columns.to_numpy(), table.index.to_numpy(), table.to_numpy(dtype=float))
    text = f"Maps of the {said} over {x} and {y}."
    return Plot(maps_over_axes(panels, (x, y), said), z, f"{said[0].upper()}{said[1:]}", text, text)


SWEPT: Mapping[str, Callable[..., Plot]] = {
    "orders": _orders,
    "limits": _limits,
    "lines": _lines,
    "maps": _maps,
}
"""First word of a figure in a case file -> how the frame of its sweeps is drawn; the others are handed on."""
