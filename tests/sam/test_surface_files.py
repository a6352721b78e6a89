# SPDX-License-Identifier: MIT
"""Measured heights in files: read as they are, wherever they come from, and refused with what was found."""

import io
import pickle
import tracemalloc
import zipfile

import numpy as np
import pandas as pd
import pytest
from builders import measured_scene as rough

import sam
from sam.scene import HeightMap, Scene, SceneError, load_scene, resolved
from sam.scene.inputs import InputError
from sam.scene.surface.readers import read_named
from verification.robustness.fuzz import good_heights, npz, table, with_pickle
from verification.robustness.hostile import ROUGH
from verification.runs.store import identity

# --- height maps and their files ----------------------------------------------------------------------------


def test_a_map_is_its_content_wherever_it_comes_from(tmp_path):
    """npz, CSV in any order of rows and columns, single precision aside: one digest, so one key in the
    store.
    """
    scene = rough(tmp_path)
    lines = table().decode().splitlines()
    body = [",".join(reversed(line.split(","))) for line in lines]
    order = [body[0], *sorted(body[1:])]
    for k, content in enumerate(
        (table(), "\n".join(order).encode(), ("\ufeff" + "\r\n".join(lines)).encode())
    ):
        other = rough(tmp_path, f"h{k}.csv", content)
        assert other == scene and identity(other, "sam") == identity(scene, "sam")
    other = rough(tmp_path, "h.csv", table().replace(b",1e-07\n", b",1.1e-07\n"))
    assert other != scene and identity(other, "sam") != identity(scene, "sam")


def test_a_map_survives_pickle_and_a_summary_as_far_as_it_can(tmp_path):
    scene = rough(tmp_path)
    found = scene.surface.path
    assert found.cells == (12, 10) and found.extent == pytest.approx((12e-6, 10e-6), rel=1e-12)
    again = pickle.loads(pickle.dumps(scene))
    assert again == scene and np.array_equal(again.surface.path.values, found.values)
    read = Scene(**resolved(scene))
    assert read == scene and read.surface.path.values is None and pickle.loads(pickle.dumps(read)) == scene
    assert len(str(resolved(scene)["surface"])) < 500
    with pytest.raises(sam.UnsupportedScene, match=r"surface.path = HeightMap.*: only its digest is at hand"):
        sam.check(read)
    sam.check(scene)
    with pytest.raises(ValueError, match="read-only"):
        found.values[0, 0] = 1.0
    assert HeightMap(found.values + 1e-12, found.extent) != found
    assert HeightMap(found.values, (1.0, 2.0)) != found


def test_where_the_origin_of_a_file_lies_does_not_matter():
    lines = table().decode().splitlines()
    moved = [lines[0]] + [
        f"{float(x) + 5e-3!r},{float(y) - 1e-3!r},{z}" for x, y, z in (line.split(",") for line in lines[1:])
    ]
    first, second = read_named("map", table()), read_named("map", "\n".join(moved).encode())
    assert np.array_equal(first.values, second.values) and second.extent == pytest.approx(
        first.extent, rel=1e-9
    )


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "x_m,y_m,height_m",
            "x,y,z",
            "nothing says the unit of its numbers: give the key unit",
        ),
        (
            "x_m,y_m,height_m",
            "x_m,y_m,p_Pa",
            r'its first line is "x_m,y_m,p_Pa": columns x_m, y_m and height_m on a regular grid',
        ),
        ("x_m,y_m,height_m\n", "x_m,y_m,height_m\n\n1,2\n", "not CSV: "),
        (
            ",1e-07\n",
            ",nan\n",
            "surface.path = .*: 1 of 120 heights are missing: fill them, or give surface.missing",
        ),
        (",1e-07\n", ",inf\n", "heights from -1e"),
        (",1e-07\n", ",x\n", "not CSV: could not convert string 'x'"),
        (
            "\n0.0,0.0,",
            "\n0.0,1e-06,",
            r"no regular grid: 120 rows with 12 different x_m and 10 different y_m",
        ),
        ("\n0.0,0.0,", "\nnan,0.0,", "x_m: finite numbers"),
        ("\n0.0,0.0,1e-07", "", "no regular grid: 119 rows"),
    ],
)
def test_a_table_that_is_no_map_is_refused_with_what_was_found(tmp_path, old, new, message):
    assert table().decode().count(old) == 1
    with pytest.raises(SceneError, match=message):
        rough(tmp_path, "h.csv", table().decode().replace(old, new).encode())


# --- as laboratories export them ----------------------------------------------------------------------------

X, Y = np.arange(12) * 2.0, np.arange(8) * 2.0
Z = np.round(0.3 * np.cos(0.4 * X[:, None] + 0.3) * np.cos(0.5 * Y + 0.2), 4)  # um
ROWS = pd.DataFrame({"x_um": np.repeat(X, 8), "y_um": np.tile(Y, 12), "z_um": Z.ravel()})
NAMES = ["X [µm]", "Y [µm]", "Z [µm]"]
MATRIX = pd.DataFrame(Z.T, index=Y, columns=X)
UNIT, SIDES = 'unit = "um"\n', 'extent = ["24 um", "16 um"]\nunit = "um"\n'
HOLES = 'missing = "harmonic"\n'


def text(frame: pd.DataFrame = ROWS, names: list[str] | bool = True, **how) -> str:
    return frame.to_csv(index=False, header=names, **how)


def with_hole(mark: str) -> str:
    return text(ROWS.assign(z_um=ROWS.z_um.where(ROWS.index != 13)), na_rep=mark)


def as_npy(values: np.ndarray) -> bytes:
    stream = io.BytesIO()
    np.save(stream, values)
    return stream.getvalue()


WAYS = {
    "names with units": ("h.csv", text(), ""),
    "pandas with its index": ("h.csv", ROWS.to_csv(), ""),
    "heights in another unit": (
        "h.csv",
        text(ROWS.assign(z_um=ROWS.z_um * 1e3), ["x (um)", "y (um)", "z/nm"]),
        "",
    ),
    "names without units": ("h.csv", text(names=list("xyz")), UNIT),
    "no names, spaces": ("h.xyz", text(names=False, sep=" "), UNIT),
    "semicolons, decimal commas": ("h.txt", text(names=NAMES, sep=";", decimal=","), ""),
    "tabs": ("h.dat", text(sep="\t"), ""),
    "spaces, decimal commas": ("h.txt", text(names=False, sep=" ", decimal=","), UNIT),
    "rows along y": ("h.csv", text(ROWS.sort_values(["y_um", "x_um"])), ""),
    "matrix": ("h.csv", text(MATRIX, False), SIDES),
    "matrix of savetxt": ("h.txt", text(MATRIX, False, sep=" "), SIDES),
    "matrix below words": ("h.csv", text(MATRIX, [f"{k}.1.2026" for k in range(12)]), SIDES),
    "matrix with coordinates": ("h.csv", MATRIX[::-1].to_csv(index_label="y"), SIDES),
    "matrix below coordinates": ("h.csv", text(MATRIX, sep=";", decimal=","), SIDES),
    "npy": ("h.npy", as_npy(Z.T), SIDES),
    "npy of rows": ("h.npy", as_npy(ROWS.to_numpy()), UNIT),
    "empty cell": ("h.csv", with_hole(""), HOLES),
    "NaN": ("h.csv", with_hole("NaN"), HOLES),
    "---": ("h.csv", with_hole("---"), HOLES),
    "***": ("h.csv", with_hole("***"), HOLES),
    "separator at the end": ("h.csv", text(sep=";").replace("\n", ";\n"), ""),
    "separator at the end of rows": ("h.csv", text().replace("\n", ",\n").replace("um,\n", "um\n", 1), ""),
    "matrix with tabs at the end": ("h.txt", text(MATRIX, False, sep="\t").replace("\n", "\t\n"), SIDES),
    "comments": ("h.txt", "# by hand\n# x_um y_um z_um\n" + text(names=False, sep=" ") + "# end\n", ""),
    "Windows": ("h.csv", ("\ufeff" + text(names=NAMES, sep=";").replace("\n", "\r\n")).encode(), ""),
    "UTF-16": ("h.csv", text(names=NAMES, sep="\t").encode("utf-16"), ""),
    "Latin-1": ("h.csv", text(names=NAMES, sep=";").encode("latin-1"), ""),
}


@pytest.mark.parametrize("way", WAYS)
def test_heights_are_read_as_laboratories_export_them(tmp_path, way):
    name, content, keys = WAYS[way]
    scene = rough(tmp_path, name, content.encode() if isinstance(content, str) else content, keys=keys)
    found = scene.surface.path
    assert found.cells == (12, 8) and found.extent == pytest.approx((24e-6, 16e-6), rel=1e-12)
    known = ~np.isnan(found.values)
    assert (~known).sum() == (keys == HOLES) and known[1, 5] == (keys != HOLES)
    assert found.values[known] == pytest.approx(1e-6 * Z[known], rel=1e-14)
    plain = HeightMap(found.values, found.extent)
    again = scene.model_copy(update={"surface": scene.surface.model_copy(update={"path": plain})})
    assert again == scene and resolved(again) == resolved(scene)  # nothing tells how the file spelled it


@pytest.mark.parametrize(
    ("name", "content", "keys", "message"),
    [
        (
            "h.csv",
            text(MATRIX, False),
            "",
            "12 columns without names.* give the keys extent and unit, such as",
        ),
        ("h.csv", text(MATRIX, False), SIDES.removesuffix(UNIT), "nothing says the unit"),
        (
            "h.csv",
            text(MATRIX, False),
            'extent = "24 um"\n' + UNIT,
            "12 x 8 heights: extent needs both sides",
        ),
        ("h.csv", text(), UNIT, "name their unit: leave out unit"),
        ("h.csv", text(), SIDES, "its columns are x, y and heights: leave out extent"),
        ("h.csv", text(names=["x_px", "y_px", "z_um"]), "", '"px" is no unit of length'),
        (
            "h.csv",
            text(names=list("xyz")),
            'unit = "s"\n',
            'surface.unit = "s": a unit of length, such as "um"',
        ),
        ("h.npz", None, UNIT, "npz, which has its lengths in m: leave out extent and unit"),
        (
            "h.csv",
            text(MATRIX * 1e3, False),
            SIDES,
            "heights from -0.0002861 m .* on a map of 2.4e-05 m x 1.6e-05 m",
        ),
        ("h.csv", with_hole("-9999"), "", "heights from -0.009999 m .* the mark of a missing height"),
    ],
)
def test_what_a_file_does_not_say_is_asked_for_and_never_guessed(tmp_path, name, content, keys, message):
    with pytest.raises(SceneError, match=message):
        rough(tmp_path, name, content and content.encode(), keys=keys)


@pytest.mark.parametrize(
    ("name", "content", "keys"),
    [
        (
            "h.csv",
            b"Date;1.2.2026\nRows;96\nX;Y;Z\n" + text(names=False, sep=";", decimal=",").encode(),
            UNIT,
        ),
        ("h.txt", b"MAP 12 8\n\n" + text(MATRIX, False, sep=" ").replace("0.", "zero", 1).encode(), SIDES),
        ("h.csv", b"Height map\n" + text(MATRIX, False).encode(), SIDES),
        ("h.npz", npz({"z": Z.T}), SIDES),
    ],
)
def test_the_python_in_a_refusal_writes_a_file_that_is_read(tmp_path, monkeypatch, name, content, keys):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SceneError, match=r"This Python writes") as refusal:
        rough(tmp_path, name, content, keys=keys)
    words, python = str(refusal.value).split("import ", 1)
    exec(f"import {python}")
    made = "heights.npy" if "heights.npy" in words else "heights.csv"
    found = rough(tmp_path, made, (tmp_path / made).read_bytes(), keys=keys + HOLES).surface.path
    assert found.missing == ("zero" in content.decode("latin-1"))
    assert np.nanmax(np.abs(found.values - 1e-6 * Z)) < 1e-20 and found.extent == pytest.approx(
        (24e-6, 16e-6)
    )


def arrays() -> dict[str, np.ndarray]:
    with np.load(io.BytesIO(good_heights())) as content:
        return dict(content)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"x_m": np.arange(12.0) ** 1.1}, "no regular grid: steps of x_m from 1 to 1.39"),
        ({"x_m": -np.arange(12.0)}, "no regular grid: .* ascending"),
        ({"x_m": np.zeros(12)}, "no regular grid"),
        (
            {"y_m": np.arange(9.0)},
            r"height_m: shape \[12, 10\], \(12, 9\), the lengths of x_m and y_m, is needed",
        ),
        ({"y_m": np.arange(2.0)}, r"y_m: shape \[2\], \(n,\), n from 3 to 4097, is needed"),
        ({"height_m": np.full((12, 10), np.nan)}, "120 of 120 heights are missing"),
        ({"height_m": np.zeros((12, 10), dtype=complex)}, "height_m: .complex128., numbers are allowed"),
        ({"height_m": np.full((12, 10), "1")}, "height_m: .<U1., numbers are allowed"),
    ],
)
def test_arrays_that_are_no_map_are_refused_with_what_was_found(tmp_path, changed, message):
    with pytest.raises(SceneError, match=message):
        rough(tmp_path, content=npz(arrays() | changed))


def test_other_numbers_and_orders_of_an_array_are_read():
    plain = read_named("map", npz(arrays())).values
    for order in (np.asfortranarray, lambda a: a.astype(">f8"), np.ascontiguousarray):
        assert np.array_equal(
            read_named("map", npz(arrays() | {"height_m": order(arrays()["height_m"])})).values, plain
        )
    assert np.array_equal(read_named("map", npz(arrays() | {"more": np.zeros(3)})).values, plain)
    with pytest.raises(InputError, match=r'npz with \["x_m.npy"\]: x_m, y_m and height_m'):
        read_named("map", npz({"x_m": np.arange(3.0)}))
    whole = read_named(
        "map", npz(arrays() | {"height_m": np.arange(120, dtype=">i2").reshape(12, 10)})
    ).values
    assert np.array_equal(whole, np.arange(120.0).reshape(12, 10))


def test_nothing_is_unpickled_and_nothing_large_is_unpacked(tmp_path, monkeypatch):
    """Heights said to be 12 x 10 that unpack to 16 MB, and heights said to be far too many: refused within 3
    MB.
    """
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match="numbers are allowed"):
        read_named("map", with_pickle())
    assert not (tmp_path / "sprung").exists()
    for shape in ((12, 10), (1 << 40, 1 << 20), (8192, 8192)):
        header, stream = io.BytesIO(), io.BytesIO()
        np.lib.format.write_array_header_1_0(header, {"descr": "<f8", "fortran_order": False, "shape": shape})
        with (
            zipfile.ZipFile(io.BytesIO(good_heights())) as good,
            zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as bomb,
        ):
            for name in good.namelist():
                content = header.getvalue() + bytes(1 << 24) if name == "height_m.npy" else good.read(name)
                bomb.writestr(name, content)
        content = stream.getvalue()
        assert len(content) < 30_000
        tracemalloc.start()
        with pytest.raises(InputError, match="height_m: "):
            read_named("map", content)
        largest = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert largest < 3e6


def test_files_elsewhere_or_without_end_are_refused(tmp_path):
    for name, message in (
        ("../h.npz", "outside the folder"),
        ("/dev/zero", "outside"),
        ("none.npz", "cannot be read"),
        ("", "name of"),
    ):
        (tmp_path / "s.toml").write_text(ROUGH.replace("heights.npz", name))
        with pytest.raises(SceneError, match=f"surface.path = .*: .*{message}"):
            load_scene(tmp_path / "s.toml")
    with pytest.raises(InputError, match="2 x 5000 heights"):
        HeightMap(np.zeros((2, 5000)), (1.0, 1.0))
    with pytest.raises(InputError, match="two dimensions"):
        HeightMap(np.zeros(5), (1.0, 1.0))


def test_the_grid_of_a_file_is_that_of_the_scene(tmp_path):
    same = rough(
        tmp_path, more='[grid]\ncells = [12, 10]\nextent = ["12 um", "10 um"]\ndepths = ["0 um", "1 um"]\n'
    )
    grid = sam.choose_grid(same)
    assert (grid.nx, grid.ny) == (12, 10) and (grid.hx, grid.hy) == pytest.approx((1e-6, 1e-6), rel=1e-12)
    for more, message in (
        ("cells = [12, 12]", r"grid.cells = \[12, 12\]: \[12, 10\], the grid of surface.path"),
        ('extent = ["12 um", "12 um"]', r"grid.extent = .*: 1.2e-05 m and 1e-05 m, the grid of surface.path"),
    ):
        with pytest.raises(SceneError, match=message):
            rough(tmp_path, more=f"[grid]\n{more}\n")
