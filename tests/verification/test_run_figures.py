# SPDX-License-Identifier: MIT
"""What `samfem solve --figures` draws, read from the drawn artists: where the contact is, its largest value,
and that number.

A scene of each kind that is not a sphere in the middle: rough, elliptic, worn, coated, travelling; solved
here, on few cells.
"""

import re
from functools import cache
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from builders import running_in
from matplotlib.collections import LineCollection, QuadMesh

from sam.planner.bodies import hertz_semi_axes
from sam.scene import FrictionMap, Scene
from verification.figures.run import drawings_of
from verification.runs import models
from verification.runs.files import Run, read_run, write_run
from verification.runs.sampling import peak

BODY = {"young": 210e9, "poisson": 0.3}
SOFT = BODY | {"plasticity": {"law": "linear", "yield_stress": 1e9, "modulus": 1e10}}
FILM = {"thickness": 0.5e-6, "young": 30e9, "poisson": 0.3}
"""So soft that near the axis its von Mises stresses are all above those of the body next to it."""
SPHERE = {"shape": "sphere", "radius": 105e-6}
ROUGH = {
    "kind": "self-affine",
    "ra": 0.1e-6,
    "cutoff_long": 16e-6,
    "cutoff_short": 8e-6,
    "hurst": 0.8,
    "seed": 3,
}
PATCH = {"cells": (24, 24), "extent": (16e-6, 16e-6)}
WAVE = {"kind": "sinusoid", "amplitude": 0.05e-6, "wavelength_x": 8e-6, "wavelength_y": 8e-6}
TRAVELLING = {"prescribed": "hertz", "p0": 2.5e9, "radius": 5e-6, "steps": 1}


def path(start, end) -> dict:
    return {"loading": TRAVELLING | {"path": {"start": start, "end": end, "steps": 2}}}


def with_body(body: dict, **sections) -> dict:
    return {"body": body, "loading": {"force": 0.1, "steps": 2}, **sections}


SCENES = {
    "sphere": with_body(
        SOFT, counterbody=SPHERE, loading={"force": 0.05, "steps": 1}, grid={"cells": (33, 33)}
    ),
    "ellipse": with_body(
        BODY,
        counterbody={"shape": "ellipsoid", "radius_x": 400e-6, "radius_y": 100e-6},
        grid={"cells": (65, 65)},
    ),
    "punch": with_body(BODY, counterbody={"shape": "punch", "radius": 5e-6}, grid={"cells": (33, 33)}),
    "rough": with_body(BODY, counterbody={"shape": "flat"}, surface=ROUGH, grid=PATCH | {"border": "relief"}),
    "cut off": with_body(
        BODY, counterbody={"shape": "flat"}, surface=WAVE, grid={"cells": (32, 32), "extent": (16e-6, 16e-6)}
    ),
    "coated": with_body(BODY | {"coating": FILM}, counterbody=SPHERE, grid={"cells": (33, 33)}),
    "travelling": with_body(
        SOFT, **path((-3e-6, 0.0), (4e-6, 3e-6)), grid={"cells": (31, 31), "extent": (30e-6, 30e-6)}
    ),
    "sliding": with_body(
        BODY, counterbody=SPHERE, friction={"coefficient": 0.4}, fem={"cells_per_radius": 4, "box": 4}
    ),
}
AXISYMMETRIC = {"fem": {"cells_per_radius": 8, "box": 5}}


@cache
def run_of(name: str, model: str = models.SAM) -> Run:
    """A solved scene with its figures, read back from files that stay until the tests end."""
    scene = (
        running_in()
        if name == "worn"
        else Scene(**SCENES[name] | (AXISYMMETRIC if model == models.FEM else {}))
    )
    folder = TemporaryDirectory()
    write_run(models.solve(scene, model), scene, folder.name, {})
    _FOLDERS.append(folder)
    return read_run(folder.name)


_FOLDERS: list[TemporaryDirectory] = []


@cache
def drawn(name: str, model: str = models.SAM) -> dict:
    return drawings_of(run_of(name, model))


def panel_of(name: str, figure: str, model: str = models.SAM, k: int = 0):
    return drawn(name, model)[figure].figure.axes[k]


def mesh_of(panel) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Edges in x (nx + 1,) and y (ny + 1,) of the coloured cells of a panel, and their values (nx, ny), NaN
    where blank.
    """
    (mesh,) = (each for each in panel.collections if isinstance(each, QuadMesh))
    corners = mesh.get_coordinates()
    return corners[0, :, 0], corners[:, 0, 1], np.ma.filled(mesh.get_array().astype(float), np.nan).T


def centres(edges: np.ndarray) -> np.ndarray:
    return 0.5 * (edges[1:] + edges[:-1])


def words_of(panel) -> str:
    return " ".join([*(text.get_text() for text in panel.texts), panel.get_title(loc="right")])


def numbers(words: str, before: str) -> float:
    """The number after a word."""
    return float(re.search(before + r"\D*?(-?[\d.]+)", words)[1])


def cross_of(panel) -> tuple[float, float]:
    """Where the largest value is marked."""
    (line,) = (each for each in panel.lines if each.get_marker() == "x")
    return float(line.get_xdata()[0]), float(line.get_ydata()[0])


ALL = ["ellipse", "cut off", "travelling", "worn"]


class TestPressure:
    @pytest.mark.parametrize("name", ALL)
    def test_only_the_contact_is_coloured_and_its_largest_value_is_written(self, name):
        panel, run = panel_of(name, "pressure"), run_of(name)
        x, y, field = mesh_of(panel)
        touching = np.isfinite(field)
        assert 0 < touching.sum() < field.size and np.nanmin(field) > 0.0
        assert touching.sum() == run.summary["discretisation"]["contact_cells"]
        quoted = 1e-9 * run.quantities["p_max_Pa"]
        assert numbers(words_of(panel), "max") == pytest.approx(quoted, rel=6e-4)
        u, v = cross_of(panel)
        i, j = np.searchsorted(x, u) - 1, np.searchsorted(y, v) - 1
        assert field[i, j] == pytest.approx(quoted, rel=1e-12)
        assert "mu" in panel.get_xlabel() and "mu" in panel.get_ylabel()
        if name == "travelling":
            weight, end = np.nan_to_num(field), np.array(run.scene.loading.path.end)
            middle = np.array([weight.sum(1) @ centres(x), weight.sum(0) @ centres(y)]) / weight.sum()
            assert middle == pytest.approx(1e6 * end, abs=0.05)
        if name == "cut off":  # cells at the edge of the patch bear more, and do not count
            assert np.nanmax(field) > 1.2 * quoted and "frame" in words_of(panel)
            (frame,) = panel.patches
            assert frame.get_x() < u < frame.get_x() + frame.get_width() < x[-1]
        else:
            assert np.nanmax(field) == pytest.approx(quoted, rel=1e-12) and not panel.patches

    @pytest.mark.parametrize("name", ["rough", "ellipse"])
    def test_the_outline_goes_around_every_cell_in_contact(self, name):
        panel = panel_of(name, "pressure")
        x, y, field = mesh_of(panel)
        inside = np.pad(np.isfinite(field), 1)
        sides = sum(np.count_nonzero(np.diff(inside.astype(int), axis=axis)) for axis in (0, 1))
        (outline,) = (each for each in panel.collections if isinstance(each, LineCollection))
        assert len(outline.get_segments()) == sides
        if name == "ellipse":  # Hertz: the axes of the contact, to a cell on each side
            ends = np.ptp(np.concatenate(outline.get_segments()), axis=0)
            for end, axis, edges in zip(ends, hertz_semi_axes(run_of(name).scene), (x, y), strict=True):
                assert end == pytest.approx(2e6 * axis, abs=2.0 * np.diff(edges)[0])


MISES, PEEQ = ("mises", "mises_max_Pa", 1e-9), ("peeq", "peeq_max", 1e2)
MAPS = [(name, *MISES) for name in ("sphere", "punch", "coated", "travelling")] + [("sphere", *PEEQ)]
MAPS += [("worn", *PEEQ)]


class TestPlane:
    @pytest.mark.parametrize("name", ["worn", "travelling"])
    def test_goes_through_the_largest_pressure(self, name):
        """That is in the words of the axes, in the bar over the contact, and not in y = 0."""
        panel, pressure = panel_of(name, "mises"), panel_of(name, "pressure")
        u, v = cross_of(pressure)
        assert v != 0.0 and numbers(panel.get_xlabel(), "y\\$ = ") == pytest.approx(v, rel=1e-3)
        assert "mu" in panel.get_xlabel() and "mu" in panel.get_ylabel() and "/a" not in panel.get_xlabel()
        x, _, _ = mesh_of(panel)
        assert x[0] < u < x[-1]
        bars = [each.get_xdata() for each in panel.lines if each.get_linewidth() == 4.0]
        assert any(first < u < last for first, last in bars)
        px, py, p = mesh_of(pressure)
        row = np.isfinite(p[:, np.searchsorted(py, v) - 1])
        for at, touches in zip(centres(px), row, strict=True):
            if x[0] < at < x[-1]:
                assert touches == any(first < at < last for first, last in bars)

    @pytest.mark.parametrize("name, figure, quantity, unit", MAPS)
    def test_writes_the_largest_value_that_it_draws(self, name, figure, quantity, unit):
        """And that of summary.json beside it where it is another number: refined, or of another place."""
        panel, quoted = panel_of(name, figure), unit * run_of(name).quantities[quantity]
        _, _, field = mesh_of(panel)
        words, largest = words_of(panel), np.nanmax(field)
        assert numbers(words, "max") == pytest.approx(largest, rel=6e-4)
        assert largest <= quoted * (1 + 1e-9) or name == "punch"
        if abs(quoted - largest) > 1e-3 * quoted:
            assert numbers(words, "refined") == pytest.approx(quoted, rel=6e-4)
        u, v = cross_of(panel)
        x, z, field = mesh_of(panel)
        assert field[np.searchsorted(x, u) - 1, np.searchsorted(z, v) - 1] == pytest.approx(
            largest, rel=1e-12
        )
        (bar,) = (each for each in panel.collections if isinstance(each, QuadMesh))
        assert bar.get_clim() == (0.0, pytest.approx(largest))

    def test_of_a_sliding_contact_in_three_dimensions_is_no_mirror_image(self):
        """Friction moves the largest stress along x; the elements are drawn as they are. Its pressure is
        mirrored to the whole.
        """
        assert panel_of("sphere", "mises").get_xlabel() == "$x/a$"
        _, _, field = mesh_of(panel_of("sliding", "mises", models.FEM_3D))
        run, panel = run_of("sliding", models.FEM_3D), panel_of("sliding", "pressure", models.FEM_3D)
        _, y, p = mesh_of(panel)
        assert y[0] == pytest.approx(-y[-1]) and np.array_equal(p, p[:, ::-1], equal_nan=True)
        assert np.nanmax(p) == pytest.approx(1e-9 * run.quantities["p_max_Pa"], rel=1e-12)
        table = run.tables["plane"]
        assert np.abs(field - field[::-1]).max() > 0.1 * field.max()
        assert np.isin(field[np.isfinite(field)], 1e-9 * table["mises_Pa"]).all()


class TestCurves:
    @pytest.mark.parametrize("name", ["rough", "travelling", "ellipse"])
    def test_the_row_holds_the_largest_pressure_and_both_ends_of_the_contact(self, name):
        line = panel_of(name, "line").lines[0]
        x, p = line.get_xdata(), line.get_ydata()
        assert p.max() == pytest.approx(1e-9 * run_of(name).quantities["p_max_Pa"], rel=1e-9)
        assert p[0] == 0.0 and p[-1] == 0.0
        assert np.abs(x[p.argmax()] - cross_of(panel_of(name, "pressure"))[0]) < 1e-6

    @pytest.mark.parametrize("name", ["travelling", "punch"])
    def test_no_panel_without_numbers(self, name):
        """No gap where nothing is opposite, none that is rounding, no approach of a pressure that is
        given.
        """
        labels = [panel.get_ylabel() for panel in drawn(name)["line"].figure.axes]
        assert len(labels) == {"travelling": 1, "punch": 2}[name] and not any(
            "gap" in label for label in labels
        )
        assert np.isfinite(panel_of(name, "history").lines[0].get_xdata()).all()
        assert any("gap" in panel.get_ylabel() for panel in drawn("sphere")["line"].figure.axes)


@pytest.mark.parametrize("model", [models.SAM, models.FEM])
class TestCoated:
    def test_the_interface_is_drawn_and_no_curve_crosses_it(self, model):
        film = 1e6 * FILM["thickness"]
        for panel in drawn("coated", model)["axis"].figure.axes:
            curve, interface = panel.lines
            assert np.ptp(interface.get_xdata()) == 0.0 and interface.get_xdata()[0] == pytest.approx(film)
            z, values = curve.get_xdata(), curve.get_ydata()
            known = np.isfinite(values)
            both = known[1:] & known[:-1]
            assert not ((z[:-1] < film * (1 - 1e-9)) & (z[1:] >= film * (1 - 1e-9)) & both).any()
            assert (z[known] < film * (1 - 1e-9)).any() and (z[known] > film).any()

    def test_no_value_of_the_map_is_a_mean_of_film_and_body(self, model):
        """Next to the interface the values are between those of the two rows of points in their own layer, of
        plane.csv.
        """
        panel, run = panel_of("coated", "mises", model), run_of("coated", model)
        a, film = run.quantities["contact_radius_m"], FILM["thickness"]
        x, z, field = mesh_of(panel)
        middle, depth = np.abs(centres(x)) < 0.15, a * centres(z)
        x, z, mises = peak(run.tables["plane"], "x_m", "z_m", "mises_Pa")
        rows = np.unique(np.round(z[np.abs(x) < 0.2 * a], 13))
        first = int(np.searchsorted(rows, film * (1 - 1e-9)))
        for low, high in ((rows[first - 2], film), (film, rows[first + 1])):
            known = (np.abs(x) < 0.2 * a) & (z > low - 1e-12) & (z < high + 1e-12)
            known &= (z < film * (1 - 1e-9)) == (high == film)
            shown = field[np.ix_(middle, (depth > low) & (depth < high))]
            shown = 1e9 * shown[np.isfinite(shown)]
            assert shown.size
            assert mises[known].min() * (1 - 1e-9) <= shown.min(initial=np.inf)
            assert shown.max(initial=0.0) <= mises[known].max() * (1 + 1e-9)


class TestWorn:
    def test_the_depth_worn_and_the_profile_through_the_deepest_place(self):
        left, right = drawn("worn")["worn"].figure.axes[:2]
        table = run_of("worn").tables["surface"]
        after = table[table["state"] == "unloaded"]
        x, y, worn, height = (after[name].to_numpy() for name in ("x_m", "y_m", "worn_m", "height_m"))
        deepest = worn.argmax()
        _, _, field = mesh_of(left)
        assert np.isfinite(field).sum() == np.count_nonzero(worn > 0.0) < worn.size
        assert np.nanmax(field) == pytest.approx(1e9 * worn[deepest], rel=1e-9)
        assert numbers(words_of(left), "max") == pytest.approx(1e9 * worn[deepest], rel=6e-4)
        assert cross_of(left) == pytest.approx((1e6 * x[deepest], 1e6 * y[deepest]))
        row = np.isclose(y, y[deepest], rtol=0.0, atol=1e-9)
        before, now = (line.get_ydata() for line in right.lines)
        order = np.argsort(x[row])
        assert before == pytest.approx(1e6 * height[row][order], abs=1e-9)
        assert now == pytest.approx(1e6 * (height - worn)[row][order], abs=1e-9)
        assert numbers(right.get_xlabel(), "y\\$ = ") == pytest.approx(1e6 * y[deepest], rel=1e-3)
        # panel (e) has a colour of its own for no contact; in (f) such cells are blank
        axes = {panel.get_title()[:3]: panel for panel in drawn("worn")["running-in"].figure.axes}
        (_, _, friction), (_, _, pressure) = (mesh_of(axes[name]) for name in ("(e)", "(f)"))
        assert np.array_equal(friction > 0, np.isfinite(pressure))
        at_peak = table[table["state"] == "peak"]
        assert np.isfinite(pressure).sum() == np.count_nonzero(at_peak["p_Pa"] > 0.0)


def test_friction_that_varies_is_drawn_in_contact_only(tmp_path):
    """A map of friction: low on one side, high on the other."""
    values = np.where(np.arange(24)[:, None] < 10, 0.1, 0.3) * np.ones((1, 24))
    friction = {"law": "map", "path": FrictionMap(values, (16e-6, 16e-6)), "coupling": False}
    scene = Scene(**SCENES["rough"] | {"friction": friction})
    write_run(models.solve(scene, models.SAM), scene, tmp_path, {})
    figures = drawings_of(read_run(tmp_path))
    _, _, field = mesh_of(figures["friction"].figure.axes[0])
    _, _, pressure = mesh_of(figures["pressure"].figure.axes[0])
    assert np.array_equal(np.isfinite(field), np.isfinite(pressure))
    touching = np.isfinite(field)
    assert field[touching] == pytest.approx(values[touching], rel=1e-12) and np.ptp(field[touching]) > 0.0
    assert "friction" not in drawn("rough") and "friction" not in drawn("travelling")


def test_without_force_there_is_no_map(tmp_path):
    scene = Scene(**SCENES["sphere"] | {"loading": {"force": 0.0}})
    write_run(models.solve(scene, models.SAM), scene, tmp_path, {})
    assert set(drawings_of(read_run(tmp_path))) == {"history", "line"}
