# SPDX-License-Identifier: MIT
"""Kinds of figures that the file of a case names, each drawn of a scene, its reference and the results of
both models (`verification.quantities.Solved`). Titles and captions follow from the vocabulary.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from verification.cases.case import Plot
from verification.figures.maps import FieldPair, pressure_maps
from verification.figures.plastic import axis_profiles, compared_peeq, residual_surface
from verification.figures.profiles import Profile, profiles
from verification.figures.style import Drawing
from verification.figures.views import SURFACE_AXES, VON_MISES, compared_mises, compared_pressure
from verification.quantities import Solved
from verification.references import contact_of
from verification.runs.sampling import peak, pressure_map

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
