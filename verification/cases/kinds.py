# SPDX-License-Identifier: MIT
"""Kinds of figures that the file of a case names, each drawn of a scene, its reference and the results of
both models (`verification.quantities.Solved`). Titles and captions follow from the vocabulary.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from sam.scene import UNLOADED
from verification.cases.case import DataFrame, Plot, View
from verification.cases.sweep import BOTH, LABELS, UNITS as SI, fitted, label_of, spelt, words_of
from verification.compare.measures import SHALLOWEST, Plane, patch_pressure, spots
from verification.figures.check import COUNTS
from verification.figures.lines import (
    CYCLES,
    GIGA,
    LINE_ON_POINTS,
    LOOKS,
    PERCENT,
    PLAIN,
    POINTS,
    Curve,
    curves,
)
from verification.figures.maps import (
    PLANE_AXES,
    PRESSURE,
    STRAIN,
    SURFACE_AXES,
    VON_MISES,
    VON_MISES_LEVELS,
    FieldPair,
    in_body,
    iso_levels,
    peak_at,
    plane_maps,
    pressure_maps,
    rough_pressures,
    section_pair,
)
from verification.figures.profiles import Profile, against_fem, profiles, residual_surface
from verification.figures.style import BLACK, Drawing
from verification.quantities import Solved, ladders, of_passes, planes, strain_below
from verification.reference.convergence import extrapolate
from verification.references import REFERENCES, coated_contact, contact_of
from verification.rows import CaseFile
from verification.runs.sampling import peak, plane_field, pressure_map, pressure_on, rows_of
from verification.runs.tables import contact_size

COLUMNS = {
    ("line", "p_Pa"): ("Pressure", PRESSURE, "p0"),
    ("line", "uz_m"): ("Displacement of the body", r"$u_z/\delta$", "approach"),
    ("line", "gap_m"): ("Gap", r"gap$/\delta$", "approach"),
    ("axis", "szz_Pa"): ("Normal stress", r"$\sigma_{zz}/p_0$", "p0"),
    ("axis", "sxx_Pa"): ("Lateral stress", r"$\sigma_{xx}/p_0$", "p0"),
    ("axis", "mises_Pa"): ("Von Mises stress", VON_MISES, "p0"),
}
"""Table and column -> title, label, unit of the reference that it is divided by."""
UNITS = {"p0": "$p_0$", "approach": r"$\delta$"}
BOTH_MODELS = ("SAM", "FEM")
MANY = 30
"""Points: a curve of more has no marks."""


def _maps(what: str, name: str, draw: Callable[[Solved], Drawing]) -> Callable[[Solved], Plot]:
    """Maps of SAM and FEM, and their difference."""
    words = f"The maps compare the {what} by SAM and by FEM; the right one shows the difference."
    return lambda found: Plot(draw(found), name, what[0].upper() + what[1:], words)


def _along(
    *columns: tuple[str, str], name: str, title: str, until: float, pressed: float = np.inf
) -> Callable[[Solved], Plot]:
    """Columns of tables on the curves of the reference to `until` times a, with the errors underneath."""

    def plot(found: Solved) -> Plot:
        units, curves = found.reference.units, found.reference.curves
        a = units["a"]

        def panel(table: str, column: str) -> Profile:
            words, label, unit = COLUMNS[table, column]
            place, axis = ("x_m", "$x/a$") if table == "line" else ("z_m", "depth $z/a$")
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
        words = f"The curves compare {names} with the reference; the errors are shown underneath."
        film = found.scene.body.coating if columns[0][0] == "axis" else None
        drawn = profiles([panel(*each) for each in shown], interface=film.thickness / a if film else None)
        return Plot(drawn, name, title, words)

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
    pair = FieldPair(x / a, y / a, *fields, ("SAM", "closed form"), SURFACE_AXES, PRESSURE, (1.0, b / a))
    words = "The maps compare the pressure of SAM with the closed form, whose contact is dashed."
    return Plot(pressure_maps(pair), "pressure-maps", "Contact pressure", words)


CLEAR = 0.25
"""Of an element; the Gauss points of eight-node elements are 0.21 of it from its edges."""


def _peeq_maps(found: Solved) -> Drawing:
    """In %; the bar is the contact of FEM."""
    (sam, fem), a = found.results.values(), contact_of(found.scene).contact_radius
    pair, peaks = section_pair(sam, fem, "peeq", (a, 1.0 / PERCENT))
    pair = replace(pair, semi_axes=(edge := contact_size(fem.quantities) / a, edge))
    return plane_maps(pair, peaks, iso_levels(max(each.value for each in peaks)))


def _plastic_axis(found: Solved) -> Plot:
    """Plastic strain and von Mises stress at the peak, von Mises and lateral stress after unloading."""
    wanted = (
        ("Plastic strain", "plastic strain [%]", "peak", "peeq", PERCENT),
        ("Von Mises, at the peak", r"$\sigma_\mathrm{vM}$ [GPa]", "peak", "mises_Pa", GIGA),
        ("Von Mises, unloaded", r"$\sigma_\mathrm{vM}$ [GPa]", "unloaded", "mises_Pa", GIGA),
        ("Residual lateral stress", r"$\sigma_{xx}$ [GPa]", "unloaded", "sxx_Pa", GIGA),
    )
    panels, a = [], contact_of(found.scene).contact_radius
    for title, label, state, column, unit in wanted:
        read = (rows_of(each.tables["axis"], state, "z_m", column) for each in found.results.values())
        both = ((z / a, unit * values) for z, values in read)
        panels.append(against_fem((title, "depth $z/a$", label), *both, (0.0, 2.0)))
    words = (
        "The curves compare SAM with FEM on the axis: plastic strain and von Mises stress at the peak, von "
        "Mises and lateral stress after unloading; the differences are shown underneath."
    )
    drawing = profiles(panels, reference="FEM")
    return Plot(drawing, "axis", "Under the centre, at the peak and unloaded", words)


def _residual_surface(found: Solved) -> Plot:
    drawing = residual_surface(*found.results.values(), contact_of(found.scene))
    words = (
        "The left panel compares the surface after unloading along y = 0 in SAM and FEM, the right one the "
        "force over the approach at every load step with the elastic curve of Hertz."
    )
    return Plot(drawing, "surface", "Residual surface, load and approach", words)


def _pressure_maps(found: Solved) -> Drawing:
    """p/p0 over x/a and y/a, to 1.3 a; where the body yields to the contact of FEM."""
    elastic, (sam, fem), yields = contact_of(found.scene), found.results.values(), found.scene.body.plasticity
    a, p0, edge, reach = elastic.contact_radius, elastic.peak_pressure, 1.0, 1.3
    if yields:
        edge = contact_size(fem.quantities) / a
        reach = 1.2 * max(edge, 1.0)
    x, y, p = pressure_map(sam)
    x, y, p = x[near := np.abs(x) <= reach * a], y[close := np.abs(y) <= reach * a], p[np.ix_(near, close)]
    fields = p / p0, pressure_on(x, y, fem.tables, 1 if yields else 2) / p0
    return pressure_maps(FieldPair(x / a, y / a, *fields, BOTH_MODELS, SURFACE_AXES, PRESSURE, (edge, edge)))


def _mises_maps(found: Solved) -> Drawing:
    """Over p0. Between the last Gauss points above and below the interface of a film, within CLEAR of an
    element, no stress of FEM is known on either side: nothing is drawn there.
    """
    a, p0 = found.reference.units["a"], found.reference.units["p0"]
    clear = interface = None
    if film := found.scene.body.coating:
        element = coated_contact(found.scene).bare.contact_radius / found.scene.fem.cells_per_radius
        clear, interface = (film.thickness, CLEAR * element), film.thickness / a
    pair, peaks = section_pair(*found.results.values(), "mises", (a, p0), clear=clear)
    return plane_maps(pair, peaks, VON_MISES_LEVELS, interface=interface)


def _spot_pressures(found: Solved) -> Plot:
    (x, y, own), (*_, fem) = (patch_pressure(each.tables) for each in found.results.values())
    words = "The maps compare the pressure of the spots at peak load by SAM and by FEM."
    return Plot(
        rough_pressures(x, y, {"SAM": own, "FEM": fem}, reach=3.2e-6),
        "pressure",
        "Pressure of the spots",
        words,
    )


def _spot_strains(found: Solved) -> Plot:
    """Over depth below the centre of each spot: SAM as a line, FEM at its points."""
    sam, fem = found.results.values()
    both, panels, shade = (Plane.of(sam.tables), Plane.of(fem.tables)), {}, {}
    depths = np.linspace(both[0].z[0], 2e-6, 100), both[1].z[both[1].z <= 2e-6]
    for spot in spots(sam.tables, fem.tables):
        title = f"x = {spot.x * 1e6:.2f} µm"
        panels[title] = {
            name: Curve(1e6 * z, PERCENT * each.below(spot.x, z))
            for name, z, each in zip(("SAM", "FEM"), depths, both, strict=True)
        }
        shade[title] = 0.0, 1e6 * strain_below(found.scene, sam, fem, spot)[0][0]
    words = (
        "The curves compare the plastic strain below each spot in y = 0 at peak load by SAM and by FEM; in "
        "the grey range, too near the surface, nothing is compared."
    )
    drawing = curves(panels, "depth $z$ [µm]", "plastic strain [%]", shade, looks=LINE_ON_POINTS)
    return Plot(drawing, "strain", "Plastic strain below the spots", words)


def _residual_line(found: Solved) -> Plot:
    side, drawn = found.scene.patch_surface.path.extent[0], {}
    for run, each in found.results.items():
        x, uz = rows_of(each.tables["line"], UNLOADED, "x_m", "uz_m")
        use = np.abs(x) <= side / 2
        drawn[run.upper()] = Curve(1e6 * x[use], -1e9 * uz[use])
    how = {"looks": LINE_ON_POINTS, "size": (6.0, 3.0)}
    words = "The curves compare by how much the heights along y = 0 have changed after unloading."
    drawing = curves({"": drawn}, "$x$ [µm]", "change of the height [nm]", **how)
    return Plot(drawing, "residual", "Residual heights", words)


def _mises_below_film(found: Solved) -> Plot:
    hertz, thickness = contact_of(found.scene), found.scene.body.coating.thickness
    (sam, fem), a, p0 = found.results.values(), hertz.contact_radius, hertz.peak_pressure
    x, z, own = plane_field(sam.tables, "mises_Pa")
    use_x, use_z = np.abs(x) <= 1.5 * a, (z >= thickness * (1.0 - 1e-9)) & (z <= 1.4 * a)
    x, z, own = x[use_x], z[use_z], own[np.ix_(use_x, use_z)]
    fields, edge = (own / p0, in_body(fem, x, z, thickness) / p0), contact_size(fem.quantities) / a
    pair = FieldPair(x / a, z / a, *fields, BOTH_MODELS, PLANE_AXES, VON_MISES, (edge, edge))
    drawn = plane_maps(pair, [peak_at(x / a, z / a, field) for field in fields], VON_MISES_LEVELS)
    words = (
        "The maps compare the von Mises stress of the body from the lower face of its film on, by SAM and by "
        "FEM, which is linear between that face and the centres of the elements below."
    )
    return Plot(drawn, "mises", "Von Mises stress in the plane y = 0", words)


def _strain_planes(found: Solved) -> Plot:
    """Plastic strain in y = 0 of SAM and the three-dimensional elements, with iso-lines, among them that of
    0.2 %. The maxima are those below the strip in which nothing is compared; what it holds is said beside
    them.
    """
    both, peaks = planes(found), []
    a, sam, fem = found.reference.units["a"], both["sam"], both["fem"]
    edge = contact_size(found.results["fem"].quantities) / a if found.scene.counterbody else 1.0
    x, z = sam.x[np.abs(sam.x) <= 1.6], sam.z[sam.z <= 1.4]
    fields = tuple(PERCENT * plane.at(x, z) for plane in (sam, fem))
    pair, below = FieldPair(x, z, *fields, BOTH_MODELS, PLANE_AXES, STRAIN, (edge, edge)), z >= SHALLOWEST
    for field in fields:
        largest, anywhere = peak_at(x, z[below], field[:, below]), np.nanmax(field)
        inside = f", {anywhere:#.3g} % in it" if anywhere > largest.value else ""
        peaks.append(replace(largest, words=f"max {largest.value:#.3g} % below the strip{inside}"))
    levels = iso_levels(max(each.value for each in peaks))
    drawing = plane_maps(pair, peaks, levels, strip=SHALLOWEST)
    words = (
        "The maps compare the plastic strain in y = 0 by SAM and by FEM; the body is pulled along +x. Near "
        "the surface, where the strain depends on the mesh, nothing is compared (hatched)."
    )
    return Plot(drawing, "plane", "Plastic strain in the plane y = 0", words)


BELOW = f"in the column of the largest strain below {SHALLOWEST:g} a"
DEEP = 1.4  # radii to which profiles are drawn


def _strain_profiles(file: CaseFile, found: Mapping[str, Solved]) -> Iterator[Plot]:
    """Plastic strain over depth of every run, a panel a variant."""
    fields = {name: planes(each) for name, each in found.items()}
    for name, place in (("axis", "on the axis"), ("column", BELOW)):
        panels = {}
        for variant, runs in fields.items():
            x = runs["fem"].place_of_maximum() if name == "column" else 0.0
            panel = panels[f"{file.variants[variant]['words']}, x = {x:.2f} a"] = {}
            for run in ("fem", *(run for run in runs if run != "fem")):
                line, z = run.upper() if run in ("sam", "fem") else f"SAM, {run}", runs[run].z
                if line in LOOKS:
                    look, z = {"label": label_of(file, "run", run)}, z[z <= DEEP]
                    panel[line] = Curve(z, PERCENT * runs[run].below(x, z), look=look)
        drawing = curves(panels, "depth $z/a$", "plastic strain [%]", (0.0, SHALLOWEST))
        text = (
            "The curves compare the plastic strain over depth in y = 0 at peak load by FEM and by each form "
            "of SAM in the legend. Nothing is compared in the grey range, where it depends on the mesh."
        )
        yield Plot(drawing, name, f"Plastic strain over depth {place}", text)


def _strain_of_cycles(file: CaseFile, found: Mapping[str, Solved]) -> Iterator[Plot]:
    """The largest plastic strain over the cycles, of the runs with most of them, a panel a variant."""
    panels = {}
    for name, solved in found.items():
        strains = {run: np.asarray(each.tables["cycles"]["peeq_max"]) for run, each in solved.results.items()}
        most = max(map(len, strains.values()))
        panels[file.variants[name]["words"]] = {
            label_of(file, "run", run): Curve(np.arange(1, most + 1), PERCENT * each)
            for run, each in strains.items()
            if len(each) == most
        }
    words = "The figure shows the largest plastic strain after each cycle."
    drawing = curves(panels, "cycle", "largest plastic strain [%]", count=True)
    yield Plot(drawing, "strain", "Plastic strain over the cycles", words)


def _grooves(found: Solved) -> Plot:
    """The groove along the track of the finest runs that are compared."""
    a, path = found.reference.units["a"], found.scene.loading.path
    length, lines = (path.end[0] - path.start[0]) / a, {}
    for model, runs in zip(("SAM, cells", "FEM, elements"), ladders(found), strict=True):
        n = max(runs)
        x, depth = (np.asarray(runs[n].tables["track"][column]) / a for column in ("x_m", "uz_m"))
        near = np.abs(x) <= length / 2 + 2.0
        lines[f"{model} of $a$/{n}"] = Curve(x[near] + length / 2, PERCENT * depth[near], look=PLAIN)
    axes = "distance from the start of the track, $s/a$", "depth of the groove over $a$ [%]"
    ends = {"ends of the track": ("x", 0.0, length)}
    drawing = curves({"": lines}, *axes, marks=ends, size=(6.2, 3.2))
    drawing.figure.axes[0].invert_yaxis()
    words = "The curves compare the depth of the unloaded surface along the track in both models."
    return Plot(drawing, "groove", "Groove of one pass in both models", words)


def _new_strains(file: CaseFile, found: Mapping[str, Solved]) -> Iterator[Plot]:
    """What each pass adds, a figure a variant."""
    for variant, solved in found.items():
        strains = {
            label_of(file, "run", name): of_passes(each, "strain") for name, each in solved.results.items()
        }
        drawn = {name: Curve(np.arange(1, own.size + 1), own) for name, own in strains.items()}
        floors = sorted({float(each.verdict["floor"]) for each in solved.results.values()})
        how = {"marks": {"floor of the verdict": ("y", *floors)}, "size": (6.6, 3.2)}
        label = "largest plastic strain that a pass adds"
        drawing = curves({"": drawn}, "pass", label, logarithmic="y", count=True, **how)
        text = (
            "The figure shows the largest plastic strain that each pass adds to a cell of the steady part of "
            f"the track, {file.variants[variant]['words']}; below a floor the verdict counts none."
        )
        yield Plot(drawing, f"new-strain-{variant}", "What each pass adds", text)


_punch = partial(
    *(_along, ("line", "p_Pa"), ("line", "uz_m"), ("axis", "mises_Pa")),
    name="profiles",
    title="Pressure, surface and stress under the centre",
    until=1.5,
)
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
    "punch": _punch(),
    "rounded-punch": _punch(pressed=1.2),
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


def of_kind(kind: str, found: Solved) -> Plot:
    """A figure of KINDS; its caption ends with the units that the reference has."""
    plot, units = KINDS[kind](found), found.reference.units if found.reference else {}
    scales = {"a": ("a", 1e6, "µm"), "p0": ("p₀", 1e-9, "GPa"), "approach": ("δ", 1e6, "µm")}
    said = [
        f"{sign} = {f * units[name]:.3g} {unit}" for name, (sign, f, unit) in scales.items() if name in units
    ]
    return replace(plot, caption=f"{plot.caption} Here {', '.join(said)}.") if said else plot


def _orders(file: CaseFile, frame: DataFrame) -> Plot:
    """The errors of each refinement over the size of the cells, with the orders that rows take of them."""
    panels: dict[str, dict[str, Curve]] = {}
    fits: list[str] = []
    for (name, model), rows in frame[frame["model"] != BOTH].groupby(["sweep", "model"], sort=False):
        sweep, title = file.sweeps[name], LABELS[model]
        for column in (
            c for c, how in sweep.columns.items() if sweep.size and how not in ("value", "between")
        ):
            order, words = fitted(file, rows, column), words_of(file, column)
            said = f"order {order.exponent:.2f}" if order else ""
            look = {} if order else {"linestyle": "none"}
            line = Curve(rows["h"].to_numpy(), rows[column].to_numpy(), order, said, look=look)
            panels.setdefault(title, {})[words] = line
            fits += [f"{title} {words} {order.exponent:.2f}"] if order else []
    how = {"logarithmic": "xy", "ticks": lambda h: f"a/{1.0 / h:.3g}", "legend": "each", "size": (4.4, 3.9)}
    drawing = curves(panels, "cell size", "relative error", **how)
    said = f"Observed orders: {', '.join(fits)}."
    text = f"The figure shows the errors over the cell size h; the lines are fits error ~ hᵐ. {said}"
    return Plot(drawing, "orders", "Error against cell size", text)


def _limits(file: CaseFile, frame: DataFrame, column: str) -> Plot:
    """A strain over the size of what each sweep refines, with the limit of each model."""
    panels: dict[str, dict[str, Curve]] = {}
    labels, off = {}, []
    for name, rows in frame[frame["model"] != BOTH].groupby("sweep", sort=False):
        panel, limits = panels.setdefault(name.capitalize(), {}), []
        labels[name.capitalize()] = (
            "1 / load steps" if file.sweeps[name].size == "step" else "cell or element size / a"
        )
        for model, own in rows.groupby("model", sort=False):
            h, strain, label = own["h"].to_numpy(), PERCENT * own[column].to_numpy(), LABELS[model]
            limits.append(limit := extrapolate(h, own[column].to_numpy()))
            if not limit.observed:
                panel[label] = Curve(h, strain, note="no order observed", look={"linestyle": "none"})
                continue
            fit = lambda at, limit=limit: PERCENT * limit(at)  # noqa: E731
            panel[label] = Curve(h, strain, fit, f"order {limit.order:.2f}", (0.0, h.max()))
            look = POINTS[label] | {"marker": "D", "markersize": 5, "linestyle": "none", "clip_on": False}
            panel[f"{label}, limit"] = Curve(np.zeros(1), np.array([PERCENT * limit.limit]), look=look)
        if all(limit.observed for limit in limits):
            off.append(f"{1e2 * (limits[0].limit / limits[1].limit - 1.0):+.2f} % ({name})")
    words, said = words_of(file, column), f" The limit of SAM is off that of FEM by {', '.join(off)}."
    drawing = curves(panels, labels, f"{words} [%]", looks=POINTS, legend="each", size=(4.2, 3.4))
    for axis in drawing.figure.axes:
        axis.set_xlim(0.0, None)
    text = f"The figure shows the {words} of both models under refinement; the lines are fits limit + c hᵐ"
    text += ", drawn where an order is observed." + said * bool(off)
    title = f"{words[0].upper()}{words[1:]} under refinement"
    return Plot(drawing, "refinement", title, text)


def _lines(file: CaseFile, frame: DataFrame, ys: str, *words: str) -> Plot | None:
    """`lines Y,Y over X by SERIES in PANEL on AXES at LEVELS`: columns over an axis or a column, each a
    number or an array; what is expected is a line below the marks of what is found. Series and panels are
    told by one axis or by several, "model,size", and by the column where there are several (of one scale if
    the file has a label "y"). on: logarithmic axes; at: levels that are marked. None where no line has two
    points.
    """
    said = dict(zip(words[::2], words[1::2], strict=True))
    x, by, panel = said["over"], said.get("by", "model").split(","), said.get("in", "sweep").split(",")
    labels = {column: label_of(file, column) for column in (*ys.split(","), x)}
    *shown, at = labels.values()
    expected, known = (
        file.labels.get("expected", "{}, expected"),
        frame.dropna(subset=ys.split(","), how="all"),
    )
    panel = [of for of in panel if known[of].map(spelt).nunique() > 1]
    panels: dict[tuple[str, str], dict[str, Curve]] = {}
    looks: dict[str, Mapping[str, Any]] = {}

    def named(axes: list[str], rows: DataFrame) -> str:
        return ", ".join(filter(None, (label_of(file, of, rows[of].iloc[0]) for of in axes)))

    def values(rows: DataFrame, column: str, label: str) -> np.ndarray:
        return np.hstack(rows[column].tolist()) * SI.get(label.rpartition("[")[2].rstrip("]"), 1)

    for y, label in zip(labels, shown, strict=False):
        for _, rows in known.dropna(subset=[y]).groupby([*panel, *by], sort=False):
            series, name = panels.setdefault((label, named(panel, rows)), {}), named(by, rows)
            one = Curve(values(rows, x, at), values(rows, y, label))
            look = looks.setdefault(name, CYCLES[len(looks) % len(CYCLES)])
            if (of := f"{y} expected") in rows and rows[of].notna().all():
                whole, color = expected.format(name), look["color"] if "{}" in expected else BLACK
                points = np.stack([one.x, values(rows, of, label)])
                if before := series.pop(whole, None):
                    points = np.hstack([points, [before.x, before.y]])
                line = {"color": color, "marker": "", "linestyle": ":"}
                series |= {name: replace(one, look={**look, "linestyle": "none"})}
                series |= {whole: Curve(*points[:, np.argsort(points[0])], look=line)}
            else:
                series[name] = replace(one, look={**look, **PLAIN} if one.x.size > MANY else look)
    if all(curve.x.size < 2 for series in panels.values() for curve in series.values()):
        return None
    levels = [float(level) for level in said.get("at", "").split(",") if level]
    marks = {file.labels.get("limit", "limit"): ("y", *levels)} if levels else {}
    how = {"logarithmic": said.get("on", ""), "marks": marks, "count": bool(COUNTS.match(at))}
    if len({title for _, title in panels}) == 1:
        drawing = curves({label: own for (label, _), own in panels.items()}, at, file.labels.get("y"), **how)
    elif len(shown) == 1:
        drawing = curves({title: own for (_, title), own in panels.items()}, at, shown[0], **how)
    else:
        drawing = curves(panels, at, **how)
    of = " and ".join(label.partition(" [")[0] for label in shown)
    title = f"{of[0].upper()}{of[1:]}" if len(shown) == 1 else file.title
    text = f"The figure shows the {of} over the {at.partition(' [')[0]}."
    return Plot(drawing, next(iter(labels)).replace("_", "-"), title, text)


def _at(file: CaseFile, frame: DataFrame, kind: str, *where: str) -> Plot:
    """`at KIND AXIS VALUE AXIS VALUE`: a figure of one point."""
    at = dict(zip(where[::2], where[1::2], strict=True))
    rows = frame[frame["model"] != BOTH]
    for axis, value in at.items():
        rows = rows[[spelt(each) == value for each in rows[axis]]]
    scene, models = rows["scene"].iloc[0], (model.partition("-")[0] for model in rows["model"])
    reference = REFERENCES[file.reference](scene) if file.reference else None
    plot = of_kind(kind, Solved(scene, reference, dict(zip(models, rows["result"], strict=True))))
    name = "-".join((plot.name, *at.values())).replace(".", "-")
    said = ", ".join(label_of(file, axis, value) for axis, value in at.items())
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
        "The picture shows the plastic strain of SAM at the peak load on the cut y = 0 and, where the zone "
        "reaches it, on the surface.",
    )
}
"""Name in a case file -> the picture in space."""
OVER_VARIANTS: Mapping[str, Callable[[CaseFile, Mapping[str, Solved]], Iterator[Plot]]] = {
    "strain-profiles": _strain_profiles,
    "strain-of-cycles": _strain_of_cycles,
    "new-strains": _new_strains,
}
"""The same of all variants of a scene."""
