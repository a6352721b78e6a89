# SPDX-License-Identifier: MIT
"""Figures of repeated loading: strain of each period, loops of three points, map of classes in y = 0."""

from pathlib import Path

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from sam.scene import PLASTIC_STRAINS
from verification.figures.lines import PLAIN, Curve, curves
from verification.figures.style import BLACK, BLUE, GREEN, ORANGE, PURPLE, VERMILION, Drawing, sheet
from verification.runs.files import Run, mesh_of
from verification.runs.meshes import FIELDS

MICRO, GIGA, PERCENT = 1e6, 1e-9, 1e2
CLASSES = {
    "elastic": ("#ffffff", "o"),
    "shakedown": (BLUE, "s"),
    "settling": (GREEN, "v"),
    "alternating": (ORANGE, "D"),
    "ratchetting": (VERMILION, "^"),
    "undecided": (PURPLE, "x"),
}
"""Class, in the order of its number -> colour in a map, marker in a curve."""
BESIDE = 0.25  # of the size of the region that is not elastic: what is drawn around it
BODY = "body.vtr"


def drawings_of(run: Run) -> dict[str, Drawing]:
    """The figures of a run with a verdict by name; none of another."""
    if not run.summary.get("verdict"):
        return {}
    found = {"strain-per-period": strain_per_period(run)}
    if "loops" in run.tables:
        found["loops"] = loops(run)
    if run.folder is not None and (cells := classified(run.folder)) is not None:
        found["classes"] = class_map(*cells)
    return found


def strain_per_period(run: Run) -> Drawing:
    """Strain that each period adds, its change, and the floor below which it is none; class markers."""
    table = run.tables["cycles"]
    table = table[np.isfinite(table["period"].to_numpy(dtype=float))]
    period, verdict = table["period"].to_numpy(dtype=float), table["verdict"].to_numpy()
    looks = {
        "accumulated strain": ("peeq_step_max", {"color": BLUE}),
        "change of the strain": ("strain_step_max", {"color": VERMILION, "linestyle": "--"}),
    }
    data, drawn, classes = {"period": period}, {}, dict.fromkeys(verdict)
    for label, (name, look) in looks.items():
        values = data[name] = table[name].to_numpy(dtype=float)
        drawn[label] = Curve(period, shown := np.where(values > 0, values, np.nan), look=PLAIN | look)
        for each in classes:
            mark = {**look, "marker": CLASSES[each][1], "linestyle": "none", "fillstyle": "none"}
            here = np.where(verdict == each, shown, np.nan)
            drawn[f"{label}, {each}"] = Curve(period, here, look=mark)
    marks = {"counts as none below": ("y", run.summary["verdict"]["floor"])}
    how = {"marks": marks, "logarithmic": "y", "count": True, "legend": None, "size": (5.0, 3.6)}
    drawing = curves({"": drawn}, "period", "largest plastic strain of a period", **how)
    (panel,) = drawing.figure.axes
    lines = [line for line in panel.lines if line.get_label() in (*looks, *marks)]
    look = {"color": BLACK, "linestyle": "none", "fillstyle": "none"}
    lines += [Line2D([], [], **look, marker=CLASSES[each][1], label=each) for each in classes]
    drawing.figure.legend(handles=lines, loc="outside lower center", ncols=3, fontsize=8.0, frameon=False)
    return Drawing(drawing.figure, {**data, "class": verdict})


def loops(run: Run) -> Drawing:
    """Stress over plastic strain of three points in the last period, in the component that strains most."""
    drawn: dict[str, Curve] = {}
    for (number, points), color in zip(
        run.tables["loops"].groupby("point"), (BLUE, VERMILION, GREEN), strict=False
    ):
        strains = {name: PERCENT * points[name].to_numpy(dtype=float) for name in PLASTIC_STRAINS}
        component = max(strains, key=lambda name: np.ptp(strains[name])).removeprefix("ep")
        mean = points[["sxx_Pa", "syy_Pa", "szz_Pa"]].to_numpy(dtype=float).mean(axis=1)
        stress = points[f"s{component}_Pa"].to_numpy(dtype=float)
        stress = GIGA * (stress - mean * (component[0] == component[1]))
        x, y, z = (MICRO * float(points[name].iloc[0]) for name in ("x_m", "y_m", "z_m"))
        place = f"{component} at $x$ = {x:.3g}, $y$ = {y:.3g}, $z$ = {z:.3g} $\\mu$m"
        strain = strains[f"ep{component}"] - strains[f"ep{component}"][0]
        line = PLAIN | {"color": color, "label": place.replace("-", "\N{MINUS SIGN}")}
        drawn[f"point {number}, {component}"] = Curve(strain, stress, look=line)
        dot = {"color": color, "marker": "o", "markersize": 4, "linestyle": "none", "label": "_"}
        drawn[f"start of {number}"] = Curve(strain[:1], stress[:1], look=dot)
    drawn["start of the period"] = Curve(
        np.empty(0), np.empty(0), look=dot | {"color": BLACK, "label": "start of the period"}
    )
    labels = "plastic strain since the start of the period [%]", "deviatoric stress [GPa]"
    return curves({"": drawn}, *labels, size=(5.0, 3.8))


def classified(folder: Path) -> tuple[np.ndarray, np.ndarray] | None:
    """Corners (n, 4, 2), x and z in m, of cells that touch y = 0, and classes (n,); None if not judged."""
    of_sam = (folder / BODY).exists()
    mesh = mesh_of(folder, BODY if of_sam else FIELDS)
    if "class" not in mesh.cell_data:
        return None
    boxes = np.array([mesh.get_cell(k).bounds for k in range(mesh.n_cells)]).reshape(-1, 3, 2)
    x, y, z = boxes[:, 0], boxes[:, 1], -boxes[:, 2]
    touches = (y[:, 0] <= 0) & (y[:, 1] >= 0)
    x, z, found = x[touches], z[touches], np.asarray(mesh.cell_data["class"])[touches]
    corners = np.stack([x[:, [0, 1, 1, 0]], z[:, [0, 0, 1, 1]]], axis=-1)
    order = np.argsort(found, kind="stable")  # of two cells beside the plane the higher class is on top
    return corners[order], found[order].astype(int)


def class_map(corners: np.ndarray, found: np.ndarray) -> Drawing:
    """The classes of the cells of `classified`."""
    names = tuple(CLASSES)
    strained = MICRO * (corners[found > 0] if (found > 0).any() else corners)
    (x0, _), (x1, z1) = strained.min(axis=(0, 1)), strained.max(axis=(0, 1))
    (low, _), (high, deepest) = MICRO * corners.min(axis=(0, 1)), MICRO * corners.max(axis=(0, 1))
    beside = BESIDE * (x1 - x0)
    with sheet(5.4, 4.0, layout="compressed") as (figure, panel):
        how = {"edgecolors": "#cccccc", "linewidths": 0.2, "rasterized": True}
        panel.add_collection(
            PolyCollection(MICRO * corners, facecolors=[CLASSES[names[k]][0] for k in found], **how)
        )
        panel.set(xlim=(max(x0 - beside, low), min(x1 + beside, high)), aspect="equal")
        panel.set(ylim=(min((1 + BESIDE) * z1, deepest), 0.0))
        panel.grid(False)
        panel.set(xlabel="$x$ [$\\mu$m]", ylabel="$z$ [$\\mu$m]")
        entries = [
            Patch(facecolor=CLASSES[names[k]][0], edgecolor="#999999", label=names[k])
            for k in np.unique(found)
        ]
        figure.legend(handles=entries, loc="outside lower center", ncols=3)
    middle = corners.mean(axis=1)
    return Drawing(figure, {"x_m": middle[:, 0], "z_m": middle[:, 1], "class": [names[k] for k in found]})
