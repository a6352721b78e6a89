# SPDX-License-Identifier: MIT
"""Kinds of figures that the file of a case names, each drawn of a scene, its reference and the results of
both models (`verification.quantities.Solved`). Titles and captions follow from the vocabulary.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from itertools import cycle
from textwrap import fill
from typing import TYPE_CHECKING

import numpy as np

from sam.scene import UNLOADED
from verification.cases.case import Plot, View
from verification.cases.sweep import BOTH, fitted, spelt, words_of
from verification.compare.measures import SHALLOWEST, Plane, patch_pressure, spots
from verification.figures.lines import (
    CYCLES,
    LOOKS,
    PERCENT,
    Curve,
    below_spots,
    convergence,
    curves,
    grooves,
    new_strains,
    profile_of,
    refinement,
    residual,
)
from verification.figures.maps import (
    SURFACE_AXES,
    VON_MISES,
    FieldPair,
    compared_mises,
    compared_peeq,
    compared_planes,
    compared_pressure,
    pressure_maps,
    rough_pressures,
    sliding_sections,
)
from verification.figures.profiles import Profile, axis_profiles, profiles, residual_surface
from verification.figures.style import Drawing
from verification.quantities import Solved, ladders, of_passes, planes, strain_below
from verification.reference.convergence import extrapolate
from verification.references import REFERENCES, coated_contact, contact_of
from verification.rows import CaseFile
from verification.runs.sampling import peak, pressure_map, rows_of

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


def _along(
    *columns: tuple[str, str], name: str, title: str, until: float, pressed: float = np.inf
) -> Callable[[Solved], Plot]:
    """Columns of tables on the curves that the reference has, to `until` times a, the pressure to `pressed`
    or to where it is compared, with the errors underneath.
    """

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
            compared = min(until, found.reference.inside / a)
            end = until if column != "p_Pa" else compared if pressed == np.inf else pressed

            def exact(at: np.ndarray) -> np.ndarray:
                return curves[table, column](at * a) / units[unit]

            return Profile(words, axis, label, exact, series, 1.0, UNITS[unit], (0.0, end))

        shown = [each for each in columns if each in curves]
        names = ", ".join(COLUMNS[each][0].lower() for each in shown)
        words = f"Curves of {names} of the models on those of the reference, with the errors underneath."
        film = found.scene.body.coating if columns[0][0] == "axis" else None
        drawn = profiles([panel(*each) for each in shown], interface=film.thickness / a if film else None)
        return Plot(drawn, name, title, words, words)

    return plot


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
    units = found.reference.units["a"], found.reference.units["p0"]
    if not (film := found.scene.body.coating):
        return compared_mises(*found.results.values(), *units)
    element = coated_contact(found.scene).bare.contact_radius / found.scene.fem.cells_per_radius
    return compared_mises(*found.results.values(), *units, film=film.thickness, element=element)


def _spot_pressures(found: Solved) -> Plot:
    (x, y, own), (*_, fem) = (patch_pressure(each.tables) for each in found.results.values())
    words = "Maps of the pressure by SAM and FEM at peak load, and their difference."
    return Plot(
        rough_pressures(x, y, {"SAM": own, "FEM": fem}, reach=3.2e-6),
        "pressure",
        "Pressure of the spots",
        words,
        words,
    )


def _spot_strains(found: Solved) -> Plot:
    """Over depth below the centre of each spot: SAM as a line, FEM at its points."""
    sam, fem = found.results.values()
    both, panels = (Plane.of(sam.tables), Plane.of(fem.tables)), {}
    depths = np.linspace(both[0].z[0], 2e-6, 100), both[1].z[both[1].z <= 2e-6]
    for spot in spots(sam.tables, fem.tables):
        first = strain_below(found.scene, sam, fem, spot)[0][0]
        curves_of = [(z, each.below(spot.x, z)) for z, each in zip(depths, both, strict=True)]
        panels[f"x = {spot.x * 1e6:.2f} µm"] = (*curves_of, first)
    words = "Plastic strain over depth below each spot, in y = 0 at peak load: SAM on the points of FEM."
    caption = f"{words} Grey: too near the surface to be compared."
    return Plot(below_spots(panels), "strain", "Plastic strain below the spots", words, caption)


def _residual_line(found: Solved) -> Plot:
    lines = (rows_of(each.tables["line"], UNLOADED, "x_m", "uz_m") for each in found.results.values())
    side = found.scene.patch_surface.path.extent[0]
    near = ((x[use := np.abs(x) <= side / 2], uz[use]) for x, uz in lines)
    words = "Change of the heights along y = 0 after unloading, by SAM and FEM."
    return Plot(residual(*near), "residual", "Residual heights", words, words)


def _mises_below_film(found: Solved) -> Plot:
    hertz, thickness = contact_of(found.scene), found.scene.body.coating.thickness
    units = hertz.contact_radius, hertz.peak_pressure
    words = "Three maps of the von Mises stress of the body below its film: SAM, FEM and their difference."
    caption = (
        "From the lower face of the film on; the cross marks the largest value. FEM is linear between its "
        "lower face and the centres of the elements below."
    )
    drawn = sliding_sections(*found.results.values(), units, thickness)
    return Plot(drawn, "mises", "Von Mises stress in the plane y = 0", words, caption)


TOO_NEAR = "too near the surface to be compared, where the strain depends on the mesh."


def _strain_planes(found: Solved) -> Plot:
    """Plastic strain in y = 0 of SAM and the three-dimensional elements, to the depth that is compared."""
    both = planes(found)
    a, fem = found.reference.units["a"], found.results["fem"]
    edge = fem.quantities["contact_radius_m"] / a if found.scene.counterbody else 1.0
    drawing = compared_planes(both["sam"], both["fem"], ("SAM", "FEM"), edge, strip=SHALLOWEST)
    alt = "Three maps of the plastic strain over x/a and z/a: SAM, FEM and their difference."
    caption = f"{alt} Iso-lines in %. The body is pulled along +x. Hatched: {TOO_NEAR}"
    return Plot(drawing, "plane", "Plastic strain in the plane y = 0", alt, caption)


DEEP = 1.4  # radii to which profiles are drawn


def _strain_profiles(found: Mapping[str, Solved], words: Mapping[str, str]) -> Iterator[Plot]:
    """Plastic strain over depth of every run, a panel a variant."""
    fields = {name: planes(each) for name, each in found.items()}
    for name, place in (("axis", "on the axis"), ("column", "where it is largest")):
        panels = {}
        for variant, runs in fields.items():
            x = runs["fem"].place_of_maximum() if name == "column" else 0.0
            order = ("fem", *(run for run in runs if run != "fem"))
            panels[f"{words[variant]}, x = {x:.2f} a"] = {
                run.upper() if run in ("sam", "fem") else f"SAM, {run}": profile_of(runs[run], x, DEEP)
                for run in order
                if run in ("sam", "fem") or f"SAM, {run}" in LOOKS
            }
        drawing = curves(panels, "$z/a$", "plastic strain [%]", (0.0, SHALLOWEST))
        alt = "Curves of the plastic strain over depth: FEM, SAM on it, other forms of SAM beside it."
        caption = f"In y = 0 at the peak. Grey: {TOO_NEAR}"
        yield Plot(drawing, name, f"Plastic strain over depth {place}", alt, caption)


def _strain_of_cycles(found: Mapping[str, Solved], words: Mapping[str, str]) -> Iterator[Plot]:
    """The largest plastic strain over the cycles, of the runs with most of them, a panel a variant."""
    panels = {}
    for name, solved in found.items():
        strains = {run: np.asarray(each.tables["cycles"]["peeq_max"]) for run, each in solved.results.items()}
        most = max(map(len, strains.values()))
        panels[words[name]] = {
            run: Curve(np.arange(1, most + 1), PERCENT * each)
            for run, each in strains.items()
            if len(each) == most
        }
    series = dict.fromkeys(run for panel in panels.values() for run in panel)
    looks = dict(zip(series, CYCLES, strict=False))
    alt = "Curves of the largest plastic strain over the cycles of every run."
    drawing = curves(panels, "cycle", "largest plastic strain [%]", looks=looks, count=True)
    yield Plot(drawing, "strain", "Plastic strain over the cycles", alt, alt)


def _grooves(found: Solved) -> Plot:
    """The groove along the track of the finest runs that are compared."""
    a, path = found.reference.units["a"], found.scene.loading.path
    length, lines = (path.end[0] - path.start[0]) / a, {}
    for runs in ladders(found):
        n = max(runs)
        x, depth = (np.asarray(runs[n].tables["track"][column]) / a for column in ("x_m", "uz_m"))
        near = np.abs(x) <= length / 2 + 2.0
        lines[f"{runs[n].model}, {n} in a"] = x[near] + length / 2, depth[near]
    words = "Depth of the unloaded surface over the distance from the start, both models; a: radius of Hertz."
    return Plot(grooves(lines, length), "groove", "Groove of one pass in both models", words, words)


def _new_strains(found: Mapping[str, Solved], words: Mapping[str, str]) -> Iterator[Plot]:
    """What each pass adds, a figure a variant."""
    for variant, solved in found.items():
        runs = {name: of_passes(each, "strain") for name, each in solved.results.items()}
        floors = sorted({float(each.verdict["floor"]) for each in solved.results.values()})
        text = (
            f"Largest plastic strain that a pass adds to a cell or element of the steady part of the track, "
            f"{words[variant]}; below its floor the verdict counts none."
        )
        yield Plot(new_strains(runs, floors), f"new-strain-{variant}", "What each pass adds", text, text)


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
    "rounded-punch": _along(
        *_PUNCH,
        name="profiles",
        title="Pressure, surface and stress under the centre",
        until=1.5,
        pressed=1.2,
    ),
    "exact-maps": _exact_maps,
    "plastic-axis": _plastic_axis,
    "residual-surface": _residual_surface,
    "strain-planes": _strain_planes,
    "grooves": _grooves,
    "spot-pressures": _spot_pressures,
    "spot-strains": _spot_strains,
    "residual-line": _residual_line,
    "mises-below-film": _mises_below_film,
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
        fits += [f"{title} {words} {order.exponent:.2f}" for words, (*_, order) in curves.items() if order]
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


def _lines(file: CaseFile, frame: DataFrame, y: str, *words: str) -> Plot | None:
    """`lines Y over X by SERIES in PANEL`: a column over an axis or a column, each a number or an array; what
    is expected is dotted. Series and panels are told by one axis or by several, "model,size". None where no
    line has two points.
    """
    said = dict(zip(words[::2], words[1::2], strict=True))
    x, by, panel = said["over"], said.get("by", "model").split(","), said.get("in", "sweep").split(",")
    panels: dict[str, dict[str, Curve]] = {}
    for keys, rows in frame.dropna(subset=[y]).groupby([*panel, *by], sort=False):
        told = [
            spelt(each).upper() if of == "model" else spelt(each)
            for of, each in zip([*panel, *by], keys, strict=True)
        ]
        title, name = (", ".join(part) for part in (told[: len(panel)], told[len(panel) :]))
        for column, series in ((y, name), (f"{y} expected", f"{name}, expected")):
            if rows[column].notna().all() if column in rows else False:
                values = (np.concatenate([np.atleast_1d(each) for each in rows[c]]) for c in (x, column))
                panels.setdefault(title, {})[series] = Curve(*values)
    if all(len(curve.x) < 2 for series in panels.values() for curve in series.values()):
        return None
    names = dict.fromkeys(name for series in panels.values() for name in series)
    plain, dashed = ([n for n in names if n.endswith(", expected") is ends] for ends in (False, True))
    looks = dict(zip(plain, cycle(CYCLES)))
    looks |= {n: {"color": looks[n.removesuffix(", expected")]["color"], "linestyle": ":"} for n in dashed}
    what = words_of(file, y) if file.sweeps else y.replace("-", " ")
    title, at = f"{what[0].upper()}{what[1:]}", re.sub("[.-]", " ", x)
    text = f"Curves of the {what} over {at}, by {' and '.join(by)}; dotted: what is expected."
    return Plot(curves(panels, at, fill(what, 40), looks=looks), y, title, text, text)


def _at(file: CaseFile, frame: DataFrame, kind: str, *where: str) -> Plot:
    """`at KIND AXIS VALUE AXIS VALUE`: a figure of one point."""
    at = dict(zip(where[::2], where[1::2], strict=True))
    rows = frame[frame["model"] != BOTH]
    for axis, value in at.items():
        rows = rows[[spelt(each) == value for each in rows[axis]]]
    scene, models = rows["scene"].iloc[0], (model.partition("-")[0] for model in rows["model"])
    reference = REFERENCES[file.reference](scene) if file.reference else None
    plot = KINDS[kind](Solved(scene, reference, dict(zip(models, rows["result"], strict=True))))
    name = "-".join((plot.name, *at.values())).replace(".", "-")
    said = ", ".join(f"{axis.replace('-', ' ')} {value.replace('-', ', ')}" for axis, value in at.items())
    return replace(plot, name=name, title=f"{plot.title}, {said}")


SWEPT: Mapping[str, Callable[..., Plot | None]] = {
    "orders": _orders,
    "limits": _limits,
    "lines": _lines,
    "at": _at,
}
"""First word of a figure in a case file -> how the frame of its sweeps is drawn; the others are handed on."""
VIEWS: Mapping[str, View] = {
    "plastic-zone": View(
        *("sam", "plastic-zone", "zone", "The plastic zone in space"),
        "The plastic zone of SAM below the sphere, cut open at y = 0: a bowl that is strained most below the "
        "centre of the contact.",
        "Plastic strain of SAM at the peak load on the cut and, where the zone reaches it, on the surface.",
    ),
}
"""Name in a case file -> the picture in space."""
OVER_VARIANTS: Mapping[str, Callable[[Mapping[str, Solved], Mapping[str, str]], Iterator[Plot]]] = {
    "strain-profiles": _strain_profiles,
    "strain-of-cycles": _strain_of_cycles,
    "new-strains": _new_strains,
}
"""The same of all variants of a scene, with the words of each."""
