# SPDX-License-Identifier: MIT
"""Where the contact of a finished run is, and the plane through its largest pressure."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sam.scene.surface import border_cells
from verification.runs.files import Run, mesh_of
from verification.runs.meshes import SURFACE
from verification.runs.sampling import Tables, gridded, peak, plane_field_on
from verification.runs.tables import contact_size

BODIES = {"sam": "body.vtr", "fem-3d": "fields.vtu"}
"""Model -> the mesh of a run with what its cells have strained."""
ON_CELLS = ("p_Pa", "friction", "worn_m", "height_m")
"""What is drawn of the surface of SAM."""
AROUND = 1.0
"""Beside the contact a figure shows so many of its widths, half on each side."""
FINE, DEEP, REACH = 121, 1.9, 1.5
"""Points along x of an axisymmetric plane, and how far it is drawn, in contact radii."""
YIELDED = 0.01
"""Of the largest plastic strain: where the plastic zone is drawn to end."""
IN_FILM, BELOW = 9, 77
"""Points over depth of an axisymmetric plane, in a film and below it."""


@dataclass(frozen=True)
class SurfaceMap:
    """Fields on the cells (or nodes) of the surface at the peak load. x (nx,), y (ny,) in m; fields: name ->
    (nx, ny); border: cells at each end in x and y that do not count for the largest values.
    """

    x: np.ndarray
    y: np.ndarray
    fields: dict[str, np.ndarray]
    border: tuple[int, int] = (0, 0)

    @property
    def p(self) -> np.ndarray:
        """Pressure in Pa, (nx, ny)."""
        return self.fields["p_Pa"]

    @property
    def touching(self) -> np.ndarray:
        """Where there is contact, (nx, ny)."""
        return self.p > 0.0

    def in_contact(self, name: str) -> np.ndarray:
        """A field, (nx, ny); NaN out of contact."""
        return np.where(self.touching, self.fields[name], np.nan)

    def largest(self, name: str = "p_Pa") -> tuple[int, int]:
        """The cell with the largest value in contact, among those that count."""
        bx, by = self.border
        counts = np.full(self.p.shape, -np.inf)
        inner = np.s_[bx : self.x.size - bx, by : self.y.size - by]
        counts[inner] = np.where(self.touching, self.fields[name], -np.inf)[inner]
        return tuple(int(k) for k in np.unravel_index(counts.argmax(), counts.shape))


def surface_map(run: Run) -> SurfaceMap | None:
    """The surface of a run; None of an axisymmetric one and of a line contact, which have no map."""
    counter = run.summary["scene"].get("counterbody") or {}
    line = counter.get("shape") == "cylinder" and not is_rough(run.summary["scene"])
    if line or run.model == "fem-axisymmetric":
        return None
    mesh = mesh_of(run.folder, SURFACE)
    if run.model == "sam":
        x, y = (0.5 * (faces[1:] + faces[:-1]) for faces in (mesh.x, mesh.y))
        known = {name: mesh.cell_data[name] for name in ON_CELLS if name in mesh.cell_data}
        fields = {name: np.array(values).reshape(y.size, x.size).T for name, values in known.items()}
        return SurfaceMap(x, y, fields, _border(run, fields["p_Pa"]))
    x, y = (np.array(nodes) for nodes in (mesh.x, mesh.y))
    field = np.array(mesh.point_data["p_Pa"]).reshape(y.size, x.size).T
    if y[0] == 0.0:  # half a model: the other half is its mirror image
        y, field = np.append(-y[:0:-1], y), np.hstack([field[:, :0:-1], field])
    return SurfaceMap(x, y, {"p_Pa": field})


def _border(run: Run, p: np.ndarray) -> tuple[int, int]:
    """Cells that do not count: of a rough body whose contact touches the edge of a patch that ends free."""
    grid, touching = run.summary["scene"].get("grid") or {}, p > 0.0
    at_edge = touching[[0, -1], :].any() or touching[:, [0, -1]].any()
    rough = is_rough(run.summary["scene"])
    return border_cells(p.shape) if rough and at_edge and grid.get("border", "free") == "free" else (0, 0)


def is_rough(scene: Mapping[str, Any]) -> bool:
    """Whether the body or the counter-body of a resolved scene has heights."""
    return (scene.get("surface") or (scene.get("counterbody") or {}).get("surface")) is not None


def is_circular(run: Run) -> bool:
    """Whether the contact is a circle around the origin: its radius is the unit of length of the figures."""
    scene = run.summary["scene"]
    loading, other = scene["loading"], scene.get("counterbody") or {}
    if loading.get("prescribed"):
        return loading.get("path") is None
    if is_rough(scene) or other.get("shape") in ("flat", "cylinder"):
        return False
    return other.get("shape") != "ellipsoid" or other["radius_x"] == other["radius_y"]


def interface_of(run: Run) -> float | None:
    """Depth in m at which a coating ends; None without one."""
    coating = run.summary["scene"]["body"].get("coating")
    return coating["thickness"] if coating else None


def in_film(z: np.ndarray, film: float) -> np.ndarray:
    """Which depths are above the interface, known to rounding; values at it are those of the body."""
    return z < film * (1.0 - 1e-9)


@dataclass(frozen=True)
class Section:
    """The plane in which a run is drawn, y = const in m. place: x of the largest pressure (of a "body":
    plastic strain) in it, in m; spots: where it is in contact, (first, last) x in m of each; source: the
    table with its fields, "plane" (y = 0) or "cut", or "body", the mesh.
    """

    y: float
    place: float
    spots: Sequence[tuple[float, float]]
    source: str

    @property
    def reach(self) -> tuple[float, float]:
        """What of x is to be seen: the spot of the largest pressure and AROUND of its width beside it."""
        first, last = next((s for s in self.spots if s[0] <= self.place <= s[1]), (self.place, self.place))
        beside = 0.5 * AROUND * (last - first)
        return first - beside, last + beside


def section_of(run: Run, surface: SurfaceMap | None) -> Section:
    """The table cut where there is one, else the plane y = 0 of the tables plane, line and axis."""
    if "cut" in run.tables:
        y = float(run.tables["cut"]["y_m"][0])
        row = int(np.argmin(np.abs(surface.y - y)))
        i, j = surface.largest()
        place = float(surface.x[i if j == row else surface.p[:, row].argmax()])
        return Section(y, place, spots_of(surface.x, surface.p[:, row]), "cut")
    x, p = peak(run.tables["line"], "x_m", "p_Pa")
    if x[0] >= 0.0:  # half of a model
        radius = contact_size(run.quantities)
        return Section(0.0, 0.0, [(-radius, radius)] if radius else [], "plane")
    spots = spots_of(x, p)
    return Section(0.0, float(np.mean(spots)) if spots else 0.0, spots, "plane")


def strained_of(run: Run, surface: SurfaceMap | None, section: Section) -> Section:
    """The plane of the cells with the largest plastic strain, where the section is that of a table cut."""
    if section.source != "cut" or run.model not in BODIES or not (run.folder / BODIES[run.model]).is_file():
        return section
    x, y, _, peeq = _cells_of(run)
    most = int(np.argmax(peeq))
    row = int(np.argmin(np.abs(surface.y - y[most])))
    return Section(float(y[most]), float(x[most]), spots_of(surface.x, surface.p[:, row]), "body")


def _cells_of(run: Run) -> tuple[np.ndarray, ...]:
    """Centres in m, z into the body, and plastic strain of the cells of the mesh of the body, each (n,)."""
    mesh = mesh_of(run.folder, BODIES[run.model])
    x, y, z = np.round(mesh.cell_centers().points.T, 13) + 0.0  # centres of one row differ by rounding
    return x, y, -z, np.array(mesh.cell_data["peeq"])


def spots_of(x: np.ndarray, p: np.ndarray) -> list[tuple[float, float]]:
    """Where a row of points is in contact; a spot ends half-way to the next point, x: (n,) in m."""
    edges = edges_of(x)
    change = np.flatnonzero(np.diff(np.concatenate([[0], (p > 0.0).astype(int), [0]])))
    return [(float(edges[a]), float(edges[b])) for a, b in zip(change[::2], change[1::2], strict=True)]


def edges_of(x: np.ndarray) -> np.ndarray:
    """(n + 1,): half-way between points x (n,), and as far beyond the first and the last."""
    return np.concatenate([[1.5 * x[0] - 0.5 * x[1]], 0.5 * (x[1:] + x[:-1]), [1.5 * x[-1] - 0.5 * x[-2]]])


def plane_of(run: Run, section: Section, column: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A column in the plane of a section at the peak: x (nx,), z (nz,) in m and the field (nx, nz). Of the
    axisymmetric model between its Gauss points, in a film and below it by themselves; others as they are.
    """
    if run.model == "fem-axisymmetric":
        return _axisymmetric_plane(run, column)
    if section.source == "body":
        x, y, z, values = _cells_of(run)
        return gridded(*(each[y == section.y] for each in (x, z, values)))
    return gridded(*peak(run.tables[section.source], "x_m", "z_m", column))


def _axisymmetric_plane(run: Run, column: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    a, film = run.quantities["contact_radius_m"], interface_of(run)
    x = np.linspace(-REACH, REACH, FINE) * a
    if film is None:
        z = np.linspace(0.0, DEEP, BELOW) * a
        return x, z, plane_field_on(x, z, run.tables, column)
    parts = (
        np.linspace(0.0, film, IN_FILM, endpoint=False),
        np.linspace(film, max(DEEP * a, 2 * film), BELOW),
    )
    depth = np.asarray(run.tables["plane"]["z_m"])
    layers = (in_film(depth, film), ~in_film(depth, film))
    fields = [
        plane_field_on(x, z, _rows(run.tables, use), column) for z, use in zip(parts, layers, strict=True)
    ]
    return x, np.concatenate(parts), np.hstack(fields)


def _rows(tables: Tables, use: np.ndarray) -> Tables:
    """The table plane with some of its rows."""
    return {"plane": {name: np.asarray(values)[use] for name, values in tables["plane"].items()}}


def below(run: Run, section: Section, column: str) -> tuple[np.ndarray, np.ndarray]:
    """Depths (nz,) in m and a column below the largest pressure; NaN, a gap, where a coating ends."""
    if section.source == "plane":
        z, values = peak(run.tables["axis"], "z_m", column)
    else:
        x, z, values = peak(run.tables["cut"], "x_m", "z_m", column)
        nearest = np.abs(x - section.place) <= np.abs(x - section.place).min() * (1.0 + 1e-9)
        z, values = z[nearest], values[nearest]
        z, values = np.unique(z), np.array([values[z == depth].mean() for depth in np.unique(z)])
    film = interface_of(run)
    first = 0 if film is None else np.count_nonzero(in_film(z, film))
    if first in (0, z.size):
        return z, values
    return np.insert(z, first, film), np.insert(values, first, np.nan)
