# SPDX-License-Identifier: MIT
"""The kinds of pictures in space: what each shows, and which run has it."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pyvista as pv

from sam.scene import UNLOADED
from verification.figures.places import YIELDED, interface_of
from verification.figures.space.meshes import MICRO, RAISED, Found, around, drawn_at
from verification.figures.space.view import BODY, FLAT, LIT, Picture, length_unit

GIGA, NANO, PERCENT = 1e-9, 1e9, 1e2
RELIEF = 0.25
"""Heights are drawn over about this share of the width."""
NOTHING = 1e-6
"""Of the largest displacement under load: one that is smaller everywhere is rounding."""
VALUE = {"scalars": "value"}
GLASS = {"color": "white", "opacity": 0.2}
LINES = {"color": "black", "opacity": 0.35, "style": "wireframe", "line_width": 1}
BEFORE_IT = 2e-3
"""Of the width: how far a mark stands out of the face on which it is drawn."""


def surface(found: Found) -> Picture | None:
    """The heights of a rough surface before any load."""
    sheet = found.sheet()
    if sheet is None or "height_m" not in sheet.point_data:
        return None
    kind, height = found.scene["surface"]["kind"], MICRO * sheet.point_data["height_m"]
    title = f"Rough surface before the first load ({'from a file' if kind == 'file' else kind})"
    return _coloured(title, "height [$\\mu$m]", sheet, height, values=height)


def worn(found: Found) -> Picture | None:
    """The surface around what was removed, and there the original one, transparent."""
    whole = found.sheet(UNLOADED)
    if whole is None or "worn_m" not in whole.cell_data or not (whole.cell_data["worn_m"] > 0.0).any():
        return None
    sheet = around(whole, whole.cell_data["worn_m"] > 0.0)
    lost, depth = sheet.point_data["worn_m"], NANO * sheet.cell_data["worn_m"]
    height = MICRO * sheet.point_data["height_m"]
    times = _exaggeration(sheet, height)
    solid = drawn_at(sheet, times * (height - MICRO * lost), np.where(depth > 0.0, depth, np.nan))
    before = drawn_at(sheet, times * height, depth)
    removed = before.extract_points(lost > 0.0, adjacent_cells=False)
    parts = [(solid, VALUE | LIT), (removed, GLASS), (removed, LINES)]
    cycles = found.scene["loading"].get("cycles") or 1
    after = "one cycle" if cycles == 1 else f"{cycles} cycles"
    title = f"Surface worn in {after}; transparent: the original surface"
    return Picture(title, "depth worn [nm]", (0.0, float(depth.max())), parts, _box(solid, before), times)


def contact(found: Found) -> Picture | None:
    """The surface, deformed where that is known, with the pressure where it is in contact."""
    whole = found.sheet()
    if whole is None or not (whole.cell_data["p_Pa"] > 0.0).any():
        return None
    rough = "height_m" in whole.point_data
    if not rough and RAISED not in whole.point_data:
        return None
    sheet = whole if rough else around(whole, whole.cell_data["p_Pa"] > 0.0)
    height = MICRO * (_known(sheet, "height_m") - _known(sheet, "worn_m") + _known(sheet, RAISED))
    p = GIGA * sheet.cell_data["p_Pa"]
    title = f"{'Contact spots' if rough else 'Deformed surface and contact pressure'} {_load(found)}"
    limits = (0.0, GIGA * float(max(sheet.cell_data["p_Pa"].max(), sheet.point_data["p_Pa"].max())))
    return _coloured(
        title, "pressure [GPa]", sheet, height, values=np.where(p > 0.0, p, np.nan), limits=limits
    )


def imprint(found: Found) -> Picture | None:
    """The surface after unloading of a body that has yielded and is not worn."""
    whole = found.sheet(UNLOADED)
    if whole is None or "worn_m" in whole.point_data or not found.run.quantities["peeq_max"]:
        return None
    largest = np.abs(_known(whole, RAISED)).max()
    if not largest > NOTHING * np.abs(_known(found.sheet(), RAISED)).max():
        return None
    rough = "height_m" in whole.point_data
    sheet = whole if rough else around(whole, np.abs(whole.point_data[RAISED]) > 0.05 * largest)
    height = MICRO * (_known(sheet, "height_m") + sheet.point_data[RAISED])
    unit, name = length_unit(MICRO * largest)
    label, values = f"residual displacement $-u_z$ [{name}]", unit * MICRO * sheet.point_data[RAISED]
    return _coloured("Imprint after unloading", label, sheet, height, values=values)


def _known(sheet: pv.StructuredGrid, name: str) -> np.ndarray:
    """A field at the nodes, zero where it is not known."""
    return sheet.point_data[name] if name in sheet.point_data else np.zeros(sheet.n_points)


def _coloured(
    title: str, label: str, sheet: pv.StructuredGrid, height: np.ndarray, *, values: np.ndarray, **how: Any
) -> Picture:
    """A surface at heights in µm, coloured by values between the least and the largest, or `limits`."""
    times = _exaggeration(sheet, height)
    mesh, ends = drawn_at(sheet, times * height, values), (float(values.min()), float(values.max()))
    how = {"limits": ends, "parts": [(mesh, VALUE | LIT)], "box": _box(mesh), "exaggeration": times} | how
    return Picture(title, label, **how)


def plastic_zone(found: Found) -> Picture | None:
    """The part of the body with plastic strain on the side y > 0 of the plane in which the run is cut."""
    body = found.strained()
    if body is None:
        return None
    body["value"] = PERCENT * np.nan_to_num(body["peeq"])
    largest = body.points[int(np.argmax(body["value"]))]
    y = round(float(largest[1]), 6) if found.scene.get("surface") else MICRO * found.section.y
    half = body.clip(normal="-y", origin=(0.0, y, 0.0))
    least = YIELDED * float(body["value"].max())
    zone = half.clip_scalar(scalars="value", value=least, invert=False)
    if zone.n_cells == 0:
        return None
    box = _margin(_box(zone), y)
    faces = [_face(zone, normal, at) for normal, at in (("y", y), ("z", 0.0))]
    shell = (half.contour([least], scalars="value"), {"color": "#4b6a9b", **LIT})
    parts = [shell, *((face, VALUE | FLAT) for face in faces if face.n_points), *_contact_line(found, box)]
    title = f"Plastic zone {_load(found)}, cut at {_place(y)}"
    top = float(body["value"].max())
    note = f"drawn above {least:.2g} % of plastic strain; black: edge of the contact"
    return Picture(title, "plastic strain [%]", (0.0, top), parts, box, note=note)


def mises(found: Found) -> Picture | None:
    """The von Mises stress on the face of the body that is cut where the pressure is largest."""
    if not found.run.quantities["force_N"]:
        return None
    x, depth, values = found.plane("mises_Pa")
    first, last = (MICRO * end for end in found.section.reach)
    beside = 0.25 * (last - first)
    use = (x >= first - beside) & (x <= last + beside)
    if np.count_nonzero(use) < 2:
        return None
    x, values, y = x[use], GIGA * values[use], MICRO * found.section.y
    deep = depth <= 0.7 * np.ptp(x)
    depth, values = depth[deep], values[:, deep]
    box = np.array([[x[0], x[-1]], [y, y + 0.5 * np.ptp(x)], [-depth[-1], 0.0]])
    across, down = np.meshgrid(x, -depth, indexing="ij")
    face = pv.StructuredGrid(across[:, None], np.full_like(across, y)[:, None], down[:, None])
    face["value"] = values.ravel(order="F")
    before = BEFORE_IT * np.ptp(x)
    block = pv.Box((*box[0], y + before, box[1, 1], *box[2]))
    parts = [(block, {"color": BODY, **LIT, "smooth_shading": False}), (face, VALUE | FLAT)]
    parts += [*_contact_line(found, box), *_interface_line(found, box)]
    title = f"Von Mises stress {_load(found)}, cut at {_place(y)}"
    note = "black: edge of the contact"
    return Picture(title, "von Mises stress [GPa]", (0.0, float(values.max())), parts, box, note=note)


def _place(y: float) -> str:
    """The place of a cut for the title."""
    return f"$y$ = {y:.4g} $\\mu$m".replace("-", "\N{MINUS SIGN}") if y else "$y$ = 0"


def _load(found: Found) -> str:
    return "at the last load reached" if found.run.last_fitting else "at the peak load"


def _exaggeration(sheet: pv.StructuredGrid, height: np.ndarray) -> float:
    """1, 2 or 5 times a power of ten: the largest that keeps heights within RELIEF of the width."""
    if not np.ptp(height) > 0.0:
        return 1.0
    wanted = RELIEF * max(np.ptp(sheet.x), np.ptp(sheet.y)) / np.ptp(height)
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(power * max(step for step in (1.0, 2.0, 5.0) if step * power <= wanted * (1.0 + 1e-9)))


def _box(*meshes: pv.DataSet) -> np.ndarray:
    """The box around meshes, (3, 2)."""
    bounds = np.array([mesh.bounds for mesh in meshes]).reshape(len(meshes), 3, 2)
    return np.stack([bounds[..., 0].min(axis=0), bounds[..., 1].max(axis=0)], axis=1)


def _margin(box: np.ndarray, y: float) -> np.ndarray:
    """A box with a tenth more on each side but the cut and the surface."""
    more = 0.1 * np.ptp(box[0])
    return np.array([box[0] + [-more, more], [y, box[1, 1] + more], [box[2, 0] - more, 0.0]])


def _face(zone: pv.DataSet, normal: str, at: float) -> pv.PolyData:
    """Where a body meets a plane."""
    origin = {"y": (0.0, at, 0.0), "z": (0.0, 0.0, at)}[normal]
    size = BEFORE_IT * np.ptp(np.array(zone.bounds).reshape(3, 2))
    inside = {"y": (0.0, at + 0.1 * size, 0.0), "z": (0.0, 0.0, at - 0.1 * size)}[normal]
    face = zone.slice(normal=normal, origin=inside)
    return face.translate(1.5 * (np.array(origin) - np.array(inside)))


def _contact_line(found: Found, box: np.ndarray) -> list[tuple[pv.DataSet, dict]]:
    """The edge of the contact on the surface, as far as it is in the box."""
    sheet = found.sheet()
    if sheet is None:
        return []
    p = sheet.point_data["p_Pa"]
    mesh = drawn_at(sheet, np.full(p.shape, BEFORE_IT * np.ptp(box[0])), p)
    line = mesh.contour([0.02 * float(p.max())], scalars="value").clip_box(
        (*box[:2].ravel(), -np.inf, np.inf), invert=False
    )
    return [(line, {"color": "black", "line_width": 3})] if line.n_points else []


def _interface_line(found: Found, box: np.ndarray) -> list[tuple[pv.DataSet, dict]]:
    """Where a coating ends, along the cut and the side of the body."""
    film = interface_of(found.run)
    if film is None:
        return []
    (_, right), (front, back), _ = box
    before, z = BEFORE_IT * np.ptp(box[0]), -MICRO * film
    places = [(box[0, 0], front - before, z), (right + before, front - before, z), (right + before, back, z)]
    return [(pv.lines_from_points(np.array(places)), {"color": "black", "line_width": 2})]


PICTURES: Mapping[str, Callable[[Found], Picture | None]] = {
    "worn": worn,
    "plastic-zone": plastic_zone,
    "contact": contact,
    "mises": mises,
    "imprint": imprint,
    "surface": surface,
}
"""Name of a picture -> what makes it, None of a run without it; first what says most of a run."""
