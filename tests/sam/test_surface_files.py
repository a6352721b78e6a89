# SPDX-License-Identifier: MIT
"""Measured heights in files: read with the right orientation, sign and unit, or refused by name."""

import io
import json
import pickle
import struct
import tracemalloc
import zipfile

import numpy as np
import pandas as pd
import pytest
from builders import measured_scene as rough

import sam
from sam.scene import HeightMap, Scene, SceneError, inputs, resolved
from sam.scene.inputs import InputError
from sam.scene.surface import height_map, processed
from sam.scene.surface.height_map import read_named
from sam.scene.surface.instrument_child import RefusedError, heights_in
from verification.robustness.fuzz import good_heights, npz, table, with_pickle
from verification.runs.store import identity


def test_a_map_is_its_content_wherever_it_comes_from(tmp_path):
    """npz, CSV in any order of rows and columns, from any origin: one digest, so one key in the store."""
    scene = rough(tmp_path)
    lines = table().decode().splitlines()
    body = [",".join(reversed(line.split(","))) for line in lines]
    order = [body[0], *sorted(body[1:])]
    for k, content in enumerate(("\n".join(order).encode(), ("\ufeff" + "\r\n".join(lines)).encode())):
        other = rough(tmp_path, f"h{k}.csv", content)
        assert other == scene and identity(other, "sam") == identity(scene, "sam")
    other = rough(tmp_path, "h.csv", table().replace(b",1e-07\n", b",1.1e-07\n"))
    assert other != scene and identity(other, "sam") != identity(scene, "sam")
    places = (line.split(",") for line in lines[1:])
    moved = [lines[0], *(f"{float(x) + 5e-3!r},{float(y) - 1e-3!r},{z}" for x, y, z in places)]
    found = read_named("map", "\n".join(moved).encode())
    assert np.array_equal(found.values, scene.surface.path.values)
    assert found.extent == pytest.approx(scene.surface.path.extent, rel=1e-9)


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
    with pytest.raises(ValueError, match="read-only"):
        found.values[0, 0] = 1.0
    assert HeightMap(found.values + 1e-12, found.extent) != found
    assert HeightMap(found.values, (1.0, 2.0)) != found


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("x_m,y_m,height_m", "x,y,z", "nothing says the unit of its numbers: give the key unit"),
        ("x_m,y_m,height_m", "x_m,y_m,p_Pa", r'first line is "x_m,y_m,p_Pa": columns x_m, y_m and height_m'),
        ("x_m,y_m,height_m\n", "x_m,y_m,height_m\n\n1,2\n", "not CSV: "),
        (",1e-07\n", ",inf\n", "heights from -1e"),
        (",1e-07\n", ",x\n", "not CSV: could not convert string 'x'"),
        ("\n0.0,0.0,", "\n0.0,1e-06,", "no regular grid: 120 rows with 12 different x_m and 10 different"),
        ("\n0.0,0.0,", "\nnan,0.0,", "x_m: finite numbers"),
        ("\n0.0,0.0,1e-07", "", "no regular grid: 119 rows"),
    ],
)
def test_a_table_that_is_no_map_is_refused_with_what_was_found(tmp_path, old, new, message):
    assert table().decode().count(old) == 1
    with pytest.raises(SceneError, match=message):
        rough(tmp_path, "h.csv", table().decode().replace(old, new).encode())


# as laboratories export them

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


IN_NM = text(ROWS.assign(z_um=ROWS.z_um * 1e3), ["x (um)", "y (um)", "z/nm"])
WAYS = {
    "pandas with its index": ("h.csv", ROWS.to_csv(), ""),
    "heights in another unit": ("h.csv", IN_NM, ""),
    "names without units": ("h.csv", text(names=list("xyz")), UNIT),
    "no names, spaces": ("h.xyz", text(names=False, sep=" "), UNIT),
    "semicolons, decimal commas": ("h.txt", text(names=NAMES, sep=";", decimal=","), ""),
    "spaces, decimal commas": ("h.txt", text(names=False, sep=" ", decimal=","), UNIT),
    "matrix of savetxt": ("h.txt", text(MATRIX, False, sep=" "), SIDES),
    "matrix below words": ("h.csv", text(MATRIX, [f"{k}.1.2026" for k in range(12)]), SIDES),
    "matrix with coordinates": ("h.csv", MATRIX[::-1].to_csv(index_label="y"), SIDES),
    "matrix below coordinates": ("h.csv", text(MATRIX, sep=";", decimal=","), SIDES),
    "npy": ("h.npy", as_npy(Z.T), SIDES),
    "npy of rows": ("h.npy", as_npy(ROWS.to_numpy()), UNIT),
    "empty cell": ("h.csv", with_hole(""), HOLES),
    "NaN": ("h.csv", with_hole("NaN"), HOLES),
    "---": ("h.csv", with_hole("---"), HOLES),
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


IN_MM = text(MATRIX * 1e3, False)


@pytest.mark.parametrize(
    ("name", "content", "keys", "message"),
    [
        ("h.csv", text(MATRIX, False), "", "12 columns without names.* give the keys extent and unit, such"),
        ("h.csv", text(MATRIX, False), SIDES.removesuffix(UNIT), "nothing says the unit"),
        ("h.csv", text(MATRIX, False), 'extent = "24 um"\n' + UNIT, "12 x 8 heights: extent needs both"),
        ("h.csv", text(), UNIT, "name their unit: leave out unit"),
        ("h.csv", text(), SIDES, "its columns are x, y and heights: leave out extent"),
        ("h.csv", text(names=["x_px", "y_px", "z_um"]), "", '"px" is no unit of length'),
        ("h.csv", text(names=list("xyz")), 'unit = "s"\n', 'surface.unit = "s": a unit of length, such as'),
        ("h.npz", None, UNIT, "npz, which has its lengths in m: leave out extent and unit"),
        ("h.csv", IN_MM, SIDES, "heights from -0.0002861 m .* on a map of 2.4e-05 m x 1.6e-05 m"),
        ("h.csv", with_hole("-9999"), "", "heights from -0.009999 m .* the mark of a missing height"),
    ],
)
def test_what_a_file_does_not_say_is_asked_for_and_never_guessed(tmp_path, name, content, keys, message):
    with pytest.raises(SceneError, match=message):
        rough(tmp_path, name, content and content.encode(), keys=keys)


# arrays


def arrays() -> dict[str, np.ndarray]:
    with np.load(io.BytesIO(good_heights())) as content:
        return dict(content)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"x_m": np.arange(12.0) ** 1.1}, "no regular grid: steps of x_m from 1 to 1.39"),
        ({"x_m": -np.arange(12.0)}, "no regular grid: .* ascending"),
        ({"y_m": np.arange(9.0)}, r"height_m: shape \[12, 10\], \(12, 9\), the lengths of x_m and y_m, is"),
        ({"y_m": np.arange(2.0)}, r"y_m: shape \[2\], \(n,\), n from 3 to 4097, is needed"),
        ({"height_m": np.zeros((12, 10), dtype=complex)}, "height_m: .complex128., numbers are allowed"),
        ({"height_m": np.full((12, 10), "1")}, "height_m: .<U1., numbers are allowed"),
    ],
)
def test_arrays_that_are_no_map_are_refused_with_what_was_found(tmp_path, changed, message):
    with pytest.raises(SceneError, match=message):
        rough(tmp_path, content=npz(arrays() | changed))


def test_nothing_is_unpickled_and_nothing_large_is_unpacked(folder):
    """12 x 10 heights that unpack to 16 MB, and far too many: refused within 3 MB."""
    with pytest.raises(InputError, match="numbers are allowed"):
        read_named("map", with_pickle())
    assert not (folder / "sprung").exists()
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
        tracemalloc.start()
        with pytest.raises(InputError, match="height_m: "):
            read_named("map", stream.getvalue())
        largest = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert largest < 3e6


# files of instruments

LINES = [
    [1.0, 2.0, 4.0, 8.0, -3.0],
    [3.0, -5.0, 7.0, 0.5, 6.0],
    [9.0, 11.0, -13.0, 17.0, 19.0],
    [0.0, 23.0, 29.0, -31.0, 37.0],
]
"""Lines of a picture from top to bottom, in nm: no two of its mirror images, turns and negatives are the
same.
"""
WANTED = 1e-9 * np.array(LINES).T  # x first


@pytest.fixture(scope="module")
def library():
    return pytest.importorskip("SurfaceTopography", reason="the extra instruments is not installed")


def sdf_in_words(bad: str = "") -> bytes:
    """ISO 25178-71, ASCII: metres, profiles along x one after the other along y."""
    head = "aISO-1.0\nManufacID = samfem\nCreateDate = 010120260000\nModDate = 010120260000\n"
    head += "NumPoints = 5\nNumProfiles = 4\nXscale = 2e-6\nYscale = 1e-6\nZscale = 1e-9\n"
    head += "Zresolution = -1\nCompression = 0\nDataType = 7\nCheckType = 0\n*\n"
    lines = (" ".join(bad if bad and value == 7.0 else repr(value) for value in row) for row in LINES)
    return (head + "\n".join(lines) + "\n*\n").encode()


def sdf_in_bytes(points: int = 5) -> bytes:
    words, scales = (b"bISO-1.0", b"samfem", b"0" * 12, b"0" * 12), (2e-6, 1e-6, 1e-9, -1)
    head = struct.pack("<8s10s12s12sHH4d3B", *words, points, 4, *scales, 0, 7, 0)
    return head + np.array(LINES, dtype="<f8").tobytes()


def matrix(header: str) -> bytes:
    return (header + "\n".join(" ".join(map(repr, row)) for row in LINES) + "\n").encode()


GWYDDION = "# Channel: Height\n# Width: 10 µm\n# Height: 4 µm\n# Value units: nm\n"


def test_x_y_sign_and_unit_of_files_written_by_hand(library):
    """ISO 25178-71 twice and Gwyddion's text: rows of the picture are x, heights point out."""
    for name, content in (("sdf", sdf_in_words()), ("sdf", sdf_in_bytes()), ("asc", matrix(GWYDDION))):
        head, found = heights_in(content, [name], 4097)
        assert found.shape == (5, 4) and head["extent"] == pytest.approx([1e-5, 4e-6], rel=1e-12)
        assert np.allclose(found, WANTED, rtol=1e-12, atol=0)


@pytest.mark.parametrize("ending", ["gwy", "x3p", "nc"])
def test_files_that_the_library_writes_come_back(library, tmp_path, ending):
    """Heights in um of which one is missing (x3p, gwy; the writer of nc allows none)."""
    values = np.ma.masked_array(WANTED * 1e6, mask=np.zeros((5, 4), dtype=bool))
    values[1, 2] = values[1, 2] if ending == "nc" else np.ma.masked
    topography = library.Topography(values if ending != "nc" else values.filled(), (10.0, 4.0), unit="µm")
    getattr(topography, "to_netcdf" if ending == "nc" else f"to_{ending}")(str(tmp_path / f"h.{ending}"))
    head, found = heights_in((tmp_path / f"h.{ending}").read_bytes(), [ending], 4097)
    assert head["extent"] == pytest.approx([1e-5, 4e-6], rel=1e-12)
    known = ~np.isnan(found)
    assert (~known).sum() == (ending != "nc") and np.allclose(found[known], WANTED[known], rtol=1e-12, atol=0)


@pytest.mark.parametrize(
    ("formats", "content", "message"),
    [
        (["asc"], matrix(""), "does not say how large the map is"),
        (["asc"], matrix("# Width: 10 µm\n# Height: 4 µm\n"), "does not say in which unit"),
        (["asc"], matrix(GWYDDION.replace("nm", "V")), "Could not find any topography"),
        (["asc"], matrix(GWYDDION)[:-30], "different numbers of values"),
        (["sdf"], sdf_in_bytes()[:-8], "."),
        (["sdf"], sdf_in_bytes(5000), "5000 x 4 heights: at most"),
        (["gwy", "x3p"], bytes(range(256)) * 9, ".*; .*"),
    ],
)
def test_a_file_without_a_size_a_unit_or_sense_is_refused(library, formats, content, message):
    with pytest.raises((RefusedError, library.Exceptions.CorruptFile), match=message):
        heights_in(content, formats, 4097)


def test_a_scene_reads_an_instrument_in_a_process_of_its_own(library, tmp_path):
    """One hole, filled by the mean of its neighbours, weights 1/distance^2: 2 um along x, 1 um along y."""
    scene = rough(tmp_path, "pin.sdf", sdf_in_words("BAD"), 'missing = "harmonic"\n')
    values = scene.surface.path.values
    known = ~np.isnan(values)
    assert known.sum() == 19 and np.allclose(values[known], WANTED[known], rtol=1e-12, atol=0)
    found = processed(scene.surface, (5, 4))[2, 1]
    assert found == pytest.approx(1e-9 * (4 - 13 + (-5 + 0.5) / 4) / 2.5, rel=1e-12)
    words = r"surface.path = .pin.SDF.: no heights, read as sdf: .*Missing required field"
    with pytest.raises(SceneError, match=words):
        rough(tmp_path, "pin.SDF", sdf_in_words()[:150])


def said(name: str, shape: list[int], kind: str = "<f8") -> str:
    head = {"said": {"extent": [1, 1]}, "arrays": {name: [kind, shape]}}
    return f"print({json.dumps(json.dumps(head))})"


@pytest.mark.parametrize(
    ("script", "message"),
    [
        ("import time; time.sleep(60)", "its reader did not end in 0.5 s"),
        ("import os; os.abort()", "ended without an answer"),
        ("print('[1]')", "answered nonsense"),
        (said("heights", [9**99]), "answered nonsense"),
        (said("heights", [0, 4], "|O"), "answered nonsense"),
        (said("heights", [0, 4]), "0 x 4 heights"),
        ("""print('{"refused": "a\\\\u001b[31mb"}')""", r"no heights, read as sdf: a\?\[31mb"),
    ],
)
def test_a_reader_that_hangs_or_dies_is_a_refusal(monkeypatch, tmp_path, script, message):
    (tmp_path / "child.py").write_text(script)
    monkeypatch.setattr(inputs, "CHILD", tmp_path / "child.py")
    monkeypatch.setattr(inputs, "SECONDS", 0.5 if "sleep" in script else 30.0)
    monkeypatch.setattr(height_map, "find_spec", lambda _: True)
    with pytest.raises(InputError, match=message):
        height_map.read_instrument("h.sdf", b"")


def test_without_the_extra_only_our_own_files_are_read(monkeypatch, tmp_path):
    monkeypatch.setattr(height_map, "find_spec", lambda _: None)
    words = r"surface.path = .h.al3d.: .*SurfaceTopography, the extra .instruments., not installed"
    with pytest.raises(SceneError, match=words):
        rough(tmp_path, "h.al3d", b"AliconaImaging")
    for name, content in (("h", good_heights()), ("h.txt", table())):
        assert read_named(name, content).cells == (12, 10)
    formats_of = height_map.formats_of
    assert formats_of("a/b.DAT") == ("asc", "metropro") and formats_of("scene.toml") == ()
