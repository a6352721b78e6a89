# SPDX-License-Identifier: MIT
"""Figures of one finished run, from its files: pressure, von Mises stress, plastic strain, profiles, load."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.ticker import MaxNLocator

from verification.figures.maps import draw_field, mark_contact, mark_peak
from verification.figures.sampling import peak, plane_field, plane_field_on, surface_pressure
from verification.figures.style import FEM, SAM, Drawing, new_figure, save, style
from verification.figures.views import peak_of
from verification.files import FIELDS, FIGURES, Run, of_last_load, read_run

MICRO, GIGA, PERCENT = 1e6, 1e-9, 1e2


def draw_run(folder: Path) -> list[Path]:
    """Write the figures of a run into its folder `figures`; returns the paths (PNG, SVG, CSV of each).

    Raises FolderError (a ValueError) when the folder holds no result. A run without load has only its history to show, one that
    did not reach its peak the last load that it reached.
    """
    run = of_last_load(read_run(folder))
    drawings = {"history": history(run), "line": line(run)}
    if run.quantities["force_N"]:
        drawings |= {
            "axis": axis(run),
            "mises": plane_map(run, "mises_Pa", "mises_max_Pa", GIGA, "von Mises stress [GPa]"),
        }
        if run.quantities["peeq_max"]:
            drawings["peeq"] = plane_map(run, "peeq", "peeq_max", PERCENT, "plastic strain [%]")
        if run.summary["model"] == "sam":
            drawings["pressure"] = pressure(run)
        if _runs_in(run):
            drawings["running-in"] = running_in(run)
    (folder / FIGURES).mkdir(exist_ok=True)
    return [path for name, drawing in drawings.items() for path in save(drawing, folder / FIGURES / name)]


def _runs_in(run: Run) -> bool:
    """Whether it is a rough body with a chemical film, over cycles, to its unloaded state."""
    friction = run.summary["scene"].get("friction") or {}
    states = run.tables.get("surface", {}).get("state", ())
    return friction.get("law") == "chemical-film" and "cycles" in run.tables and "unloaded" in states


def running_in(run: Run) -> Drawing:
    """The six panels of Bosman & Schipper (2011), Figs. 13 to 17."""
    from verification.cases.running_in_measures import History, Scar
    from verification.figures.running_in import six_panels

    friction = run.summary["scene"]["friction"]
    return six_panels(Scar.of(run.tables), History.of(run.tables), (friction["low"], friction["high"]))


def _look(run: Run) -> dict:
    return SAM if run.summary["model"] == "sam" else FEM


def _curves(run: Run, table: str, place: str, columns: dict[str, tuple[str, float]]) -> Drawing:
    """One panel a column over a place in um; columns: label -> (column, factor of its unit)."""
    x = peak(run.tables[table], place)[0] * MICRO
    data = {place.replace("_m", "_um"): x}
    shown = _shown(run, x)
    horizontal = f"${place[0]}$ [$\\mu$m]"
    with style():
        figure = new_figure(3.45 * len(columns), 3.2)
        axes = figure.subplots(1, len(columns), squeeze=False)[0]
        for panel, (label, (column, factor)) in zip(axes, columns.items(), strict=True):
            y = peak(run.tables[table], column)[0]
            panel.plot(x[shown], y[shown] * factor, **_look(run))
            panel.set(xlabel=horizontal, ylabel=label)
            data[column] = y
    return Drawing(figure, data)


def _shown(run: Run, x: np.ndarray) -> np.ndarray:
    """Which of the points (um) to draw: to two contact radii, or everything when there is no contact."""
    radius = run.quantities["contact_radius_m"]
    return np.abs(x) <= 2.0 * radius * MICRO if radius else np.full(x.shape, True)


def line(run: Run) -> Drawing:
    """Pressure, displacement and gap along y = 0."""
    columns = {
        "pressure [GPa]": ("p_Pa", GIGA),
        "displacement of the body [$\\mu$m]": ("uz_m", MICRO),
        "gap [$\\mu$m]": ("gap_m", MICRO),
    }
    return _curves(run, "line", "x_m", columns)


def axis(run: Run) -> Drawing:
    """Stresses under the origin."""
    columns = {
        "$\\sigma_{zz}$ [GPa]": ("szz_Pa", GIGA),
        "$\\sigma_{xx}$ [GPa]": ("sxx_Pa", GIGA),
        "von Mises [GPa]": ("mises_Pa", GIGA),
    }
    return _curves(run, "axis", "z_m", columns)


def history(run: Run) -> Drawing:
    """Force over approach, every row of the history; points only, as elastic unloading is one step."""
    approach, force = run.tables["history"]["approach_m"] * MICRO, run.tables["history"]["force_N"]
    with style():
        figure = new_figure(4.6, 3.2)
        panel = figure.subplots()
        panel.plot(approach, force, **_look(run) | {"marker": "o", "linestyle": "none"})
        panel.set(xlabel="approach [$\\mu$m]", ylabel="force [N]")
    return Drawing(figure, {"approach_um": approach, "force_N": force})


def plane_map(run: Run, column: str, quantity: str, unit: float, label: str) -> Drawing:
    """A column in y = 0 with iso-lines, contact width and the maximum, over x/a and z/a.

    quantity: name of the largest value, its depth being "..._max_depth_m"; unit: factor of the colours; label: of them.
    """
    a, largest = run.quantities["contact_radius_m"], run.quantities[quantity] * unit
    if run.summary["model"] == "sam":
        x, z, values = plane_field(run.tables, column)
    else:
        x, z = np.linspace(-1.5, 1.5, 121) * a, np.linspace(0.0, 1.9, 77) * a
        values = plane_field_on(x, z, run.tables, column)
    use = np.abs(x) <= 1.5 * a
    u, v, field = x[use] / a, z / a, values[use] * unit
    top = peak_of(u, field, run.quantities[quantity.partition("_max")[0] + "_max_depth_m"] / a, largest)
    with style():
        figure = new_figure(5.4, 3.4, "compressed")
        panel = figure.subplots()
        mesh = draw_field(panel, u, v, field, cmap="viridis", vmin=0.0, vmax=np.nanmax(field))
        mark_peak(panel, u, v, field, top, MaxNLocator(7).tick_values(0.0, largest)[1:])
        mark_contact(panel, 1.0)
        panel.invert_yaxis()
        panel.set(xlabel="$x/a$", ylabel="$z/a$")
        figure.colorbar(mesh, ax=panel, label=label)
    places = np.meshgrid(u, v, indexing="ij")
    return Drawing(figure, {"x/a": places[0].ravel(), "z/a": places[1].ravel(), label: field.ravel()})


def pressure(run: Run) -> Drawing:
    """The pressure over the cells of SAM."""
    import meshio

    mesh = meshio.read(run.folder / FIELDS)
    x, y, p = surface_pressure(mesh.points, mesh.cells_dict["quad"], mesh.cell_data_dict["p_Pa"]["quad"])
    with style():
        figure = new_figure(5.0, 3.8, "compressed")
        panel = figure.subplots()
        colours = draw_field(panel, x * MICRO, y * MICRO, p * GIGA, cmap="viridis", vmin=0.0)
        panel.set(xlabel="$x$ [$\\mu$m]", ylabel="$y$ [$\\mu$m]")
        figure.colorbar(colours, ax=panel, label="pressure [GPa]")
    places = np.meshgrid(x, y, indexing="ij")
    return Drawing(figure, {"x_m": places[0].ravel(), "y_m": places[1].ravel(), "p_Pa": p.ravel()})
