# SPDX-License-Identifier: MIT
"""Figures of one finished run, from its files: pressure, von Mises stress, plastic strain,
profiles, wear, load.

Every plane and profile goes through the largest pressure, that of the plastic strain below a contact that may
lie beside the origin through its largest value, see `verification.figures.places`.
Lengths are in contact radii below a circular contact around the origin, else in µm.
"""

from collections.abc import Mapping, Sequence
from itertools import groupby
from pathlib import Path

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from sam.scene import Progress
from verification.compare.running_in_measures import History, Scar
from verification.cost.contact import hertz_of
from verification.figures import repeated
from verification.figures.compared import PANELS
from verification.figures.lines import Curve, curves
from verification.figures.maps import INTERFACE, mark_interface
from verification.figures.places import (
    Section,
    SurfaceMap,
    below,
    interface_of,
    is_circular,
    section_of,
    strained_of,
    surface_map,
)
from verification.figures.run_maps import contact_map, plane_map, worn
from verification.figures.running_in import six_panels
from verification.figures.style import EXACT, FEM, SAM, Drawing, marked, save, sheet
from verification.runs.files import FIGURES, Run, of_last_load, read_run
from verification.runs.sampling import peak
from verification.runs.tables import contact_size

MICRO, GIGA = 1e6, 1e-9
PARTS = {"loading": "-o", "unloading": "--s", "constant force": ":^", "unloaded in one step": "s"}
"""Parts of a history -> their line and marker."""
NOTHING = 1e-9
"""Over the approach, or the largest friction: a gap, or a change of friction, below it is rounding."""


def draw_run(folder: Path, *, pdf: bool = False, progress: Progress = lambda *_: None) -> list[Path]:
    """Write the figures of a run into its folder `figures`; returns the paths (PNG and CSV of each, or PDF).
    Raises FolderError (a ValueError) when the folder holds no result. A run without load has only its history
    to show, one that did not reach its peak the last load that it reached.
    """
    drawings = drawings_of(read_run(folder))
    (folder / FIGURES).mkdir(exist_ok=True)
    paths = []
    for k, (name, drawing) in enumerate(drawings.items(), start=1):
        paths += save(drawing, folder / FIGURES / name, pdf=pdf, small=False)
        progress("drawing figures", k, len(drawings))
    return paths


def drawings_of(run: Run) -> dict[str, Drawing]:
    """The figures of a run, at the last load that it reached, by name."""
    run = of_last_load(run)
    return marked(_drawings_of(run), run)


def _drawings_of(run: Run) -> dict[str, Drawing]:
    if not run.quantities["force_N"]:
        return {"history": history(run), "line": line(run, None, Section(0.0, 0.0, (), "plane"))}
    surface = surface_map(run)
    section = section_of(run, surface)
    drawings = {
        "history": history(run),
        "line": line(run, surface, section),
        "axis": axis(run, section),
        "mises": plane_map(run, section, "mises_Pa", "von Mises stress [GPa]"),
    }
    if run.quantities["peeq_max"]:
        drawings["peeq"] = plane_map(run, strained_of(run, surface, section), "peeq", "plastic strain [%]")
    if surface is not None:
        drawings["pressure"] = contact_map(surface, "p_Pa", "pressure [GPa]")
        if not _runs_in(run) and _varies(surface):
            drawings["friction"] = contact_map(surface, "friction", "coefficient of friction")
    if "surface" in run.tables and run.summary["scene"].get("wear") is not None:
        drawings["worn"] = worn(run)
    if _runs_in(run):
        friction = run.summary["scene"]["friction"]
        coefficients = friction["low"], friction["high"]
        drawings["running-in"] = six_panels(Scar.of(run.tables), History.of(run.tables), coefficients)
    return drawings | repeated.drawings_of(run)


def _runs_in(run: Run) -> bool:
    """Whether it is a rough body with a chemical film, over cycles, to its unloaded state."""
    friction = run.summary["scene"].get("friction") or {}
    worn_surface = "surface" in run.tables and "unloaded" in set(run.tables["surface"]["state"])
    return friction.get("law") == "chemical-film" and "cycles" in run.tables and worn_surface


def _varies(surface: SurfaceMap) -> bool:
    """Whether friction differs from cell to cell."""
    friction = surface.fields.get("friction")
    known = np.array([]) if friction is None else friction[surface.touching]
    return known.size > 0 and np.ptp(known) > NOTHING * np.abs(known).max()


def _drawn(run: Run, horizontal: str, found: Mapping[str, tuple[np.ndarray, np.ndarray]], **how) -> Drawing:
    """One panel a curve; found: label -> (x, y) in the units of its axes."""
    look = SAM if run.model == "sam" else FEM
    panels = {label: {"": Curve(x, y, look=look)} for label, (x, y) in found.items()}
    drawing = curves(panels, horizontal, None, **{"size": (3.45, 3.2), "legend": None} | how)
    data = {horizontal: next(iter(found.values()))[0]} | {label: y for label, (_, y) in found.items()}
    return Drawing(drawing.figure, {_plain(label): values for label, values in data.items()})


def _plain(label: str) -> str:
    """A label without mathtext, for a column name."""
    return label.replace("$\\mu$", "u").replace("$", "").replace("\\", "")


def line(run: Run, surface: SurfaceMap | None, section: Section) -> Drawing:
    """Pressure, displacement and gap along the row of the largest pressure: all spots of the row with what is
    beside them, everything when there is no contact. Beside y = 0, where displacement and gap are not kept,
    the pressure and the heights of a rough surface.
    """
    horizontal, gap = "$x$ [$\\mu$m]", "gap [$\\mu$m]"
    pitch = np.diff(surface.y).min() if surface is not None and surface.y.size > 1 else 0.0
    if section.source == "cut" and (abs(section.y) > pitch or "surface" in run.tables):
        row = int(np.argmin(np.abs(surface.y - section.y)))
        x, found = surface.x, {"pressure [GPa]": GIGA * surface.p[:, row]}
        if "height_m" in surface.fields:
            height = surface.fields["height_m"] - surface.fields.get("worn_m", 0.0)
            found["height [$\\mu$m]"] = MICRO * height[:, row]
        horizontal += f" at $y$ = {MICRO * section.y:.4g} $\\mu$m"
    else:
        x, of = peak(run.tables["line"], "x_m")[0], PANELS["line"]
        found = {label: unit * peak(run.tables["line"], name)[0] for label, (name, unit) in of.items()}
        least = NOTHING * MICRO * abs(run.quantities["approach_m"] or 0.0)
        if not (np.isfinite(found[gap]) & (np.abs(found[gap]) > least)).any():
            del found[gap]
    shown = np.full(x.shape, True)
    if section.spots and is_circular(run):
        shown = np.abs(x) <= 2.0 * run.quantities["contact_radius_m"]
    elif section.spots:
        first, last = section.spots[0][0], section.spots[-1][1]
        shown = (x >= first - 0.5 * (last - first)) & (x <= last + 0.5 * (last - first))
    return _drawn(run, horizontal, {label: (MICRO * x[shown], y[shown]) for label, y in found.items()})


def axis(run: Run, section: Section) -> Drawing:
    """Stresses under the largest pressure; a gap in the curves, and a line, where a coating ends."""
    found = {label: below(run, section, column) for label, (column, _) in PANELS["axis"].items()}
    reach = 2.0 * contact_size(run.quantities) if section.source == "plane" else np.inf
    found = {label: (MICRO * z[z <= reach], GIGA * v[z <= reach]) for label, (z, v) in found.items()}
    horizontal = "$z$ [$\\mu$m]"
    if section.source == "cut":
        horizontal += f" at $x$ = {MICRO * section.place:.4g}, $y$ = {MICRO * section.y:.4g} $\\mu$m"
    drawing = _drawn(run, horizontal, found)
    if interface_of(run) is not None:
        mark_interface(drawing.figure.axes, MICRO * interface_of(run))
        look, name = (SAM, "SAM") if run.model == "sam" else (FEM, "FEM")
        drawing.figure.axes[0].legend(handles=[Line2D([], [], **look, label=name), INTERFACE])
    return drawing


def history(run: Run) -> Drawing:
    """Force over approach, a line through the rows of each part of the history that has several, beside the
    elastic contact of Hertz where it applies; elastic unloading in one step is a point alone. Where the
    pressure is given there is no approach: over the number of the row.
    """
    table = run.tables["history"]
    approach, force = (table[name].to_numpy() for name in ("approach_m", "force_N"))
    given = not np.isfinite(approach).any()
    x = np.arange(1, force.size + 1) if given else approach * MICRO
    look = {"color": (SAM if run.model == "sam" else FEM)["color"], "markersize": 4.0, "fillstyle": "none"}
    hertz = {} if given or run.last_fitting else {"force_N": run.quantities["force_N"]} | hertz_of(run.scene)
    with sheet(4.6, 3.2) as (figure, panel):
        if "p_max_Pa" in hertz:
            end = MICRO * hertz.get("approach_m", run.quantities["approach_m"])
            dense = np.linspace(0.0, end, 100)
            panel.plot(dense, hertz["force_N"] * (dense / end) ** 1.5, **EXACT, label="Hertz (elastic)")
        xs, ys, named = np.append(0.0, x), np.append(0.0, force), set()
        for part, rows in groupby(range(force.size), key=_parts(force, table["note"]).__getitem__):
            first, *more = rows
            shown = slice(first, more[-1] + 2) if more else slice(first + 1, first + 2)
            label = "" if part in named else part
            panel.plot(xs[shown], ys[shown], PARTS[part] if more else PARTS[part][-1], **look, label=label)
            named.add(part)
        panel.set(xlabel="load step, of all cycles" if given else "approach [$\\mu$m]", ylabel="force [N]")
        panel.legend()
        if given:
            panel.xaxis.set_major_locator(MaxNLocator(integer=True, min_n_ticks=2))
    return Drawing(figure, {"load_step" if given else "approach_um": x, "force_N": force})


def _parts(force: np.ndarray, notes: Sequence) -> list[str]:
    """What each row of a history is part of."""
    change = np.diff(force, prepend=0.0)
    same = np.abs(change) <= 1e-9 * np.abs(force).max()
    parts = np.where(same, "constant force", np.where(change > 0.0, "loading", "unloading"))
    return [
        "unloaded in one step" if "in one step" in str(note) else part
        for part, note in zip(parts, notes, strict=True)
    ]
