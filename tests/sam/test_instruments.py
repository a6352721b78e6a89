# SPDX-License-Identifier: MIT
"""Files of instruments: read with the right orientation, sign and unit, compared with files written by hand;
or refused.
"""

import json
import struct

import numpy as np
import pytest
from builders import measured_scene as rough

from sam.scene import HeightMap, SceneError, inputs
from sam.scene.inputs import InputError
from sam.scene.surface import processed, readers
from sam.scene.surface.instrument_child import RefusedError, heights_in
from sam.scene.surface.readers import read_named
from verification.robustness.fuzz import npz

ROWS = [
    [1.0, 2.0, 4.0, 8.0, -3.0],
    [3.0, -5.0, 7.0, 0.5, 6.0],
    [9.0, 11.0, -13.0, 17.0, 19.0],
    [0.0, 23.0, 29.0, -31.0, 37.0],
]
"""Lines of a picture from top to bottom, in nm: no two of its mirror images, turns and negatives are the
same.
"""
WANTED = 1e-9 * np.array(ROWS).T  # x first


def centres(n: int, h: float) -> np.ndarray:
    return (np.arange(n) - (n - 1) / 2) * h


@pytest.fixture(scope="module")
def library():
    return pytest.importorskip("SurfaceTopography", reason="the extra instruments is not installed")


def sdf_in_words(bad: str = "") -> bytes:
    """ISO 25178-71, ASCII: metres, values of a profile along x one after the other, profile after profile
    along y.
    """
    head = "aISO-1.0\nManufacID = samfem\nCreateDate = 010120260000\nModDate = 010120260000\n"
    head += "NumPoints = 5\nNumProfiles = 4\nXscale = 2e-6\nYscale = 1e-6\nZscale = 1e-9\n"
    head += "Zresolution = -1\nCompression = 0\nDataType = 7\nCheckType = 0\n*\n"
    lines = "\n".join(" ".join(bad if bad and value == 7.0 else repr(value) for value in row) for row in ROWS)
    return (head + lines + "\n*\n").encode()


def sdf_in_bytes() -> bytes:
    head = struct.pack(
        "<8s10s12s12sHH4d3B",
        b"bISO-1.0",
        b"samfem",
        b"0" * 12,
        b"0" * 12,
        5,
        4,
        2e-6,
        1e-6,
        1e-9,
        -1,
        0,
        7,
        0,
    )
    return head + np.array(ROWS, dtype="<f8").tobytes()


def matrix(header: str) -> bytes:
    return (header + "\n".join(" ".join(map(repr, row)) for row in ROWS) + "\n").encode()


GWYDDION_TEXT = "# Channel: Height\n# Width: 10 µm\n# Height: 4 µm\n# Value units: nm\n"


def test_x_y_sign_and_unit_of_files_written_by_hand(library):
    """Two formats of ISO 25178-71 and Gwyddion's text, by their definitions: rows of the picture are x,
    heights point out.
    """
    for name, content in (("sdf", sdf_in_words()), ("sdf", sdf_in_bytes()), ("asc", matrix(GWYDDION_TEXT))):
        head, found = heights_in(content, [name], 4097)
        assert found.shape == (5, 4) and head["extent"] == pytest.approx([1e-5, 4e-6], rel=1e-12)
        assert np.allclose(found, WANTED, rtol=1e-12, atol=0)
        for wrong in (found[::-1], found[:, ::-1], -found, found * 1e3):
            assert not np.allclose(wrong, WANTED, rtol=1e-3, atol=0)


@pytest.mark.parametrize("ending", ["gwy", "x3p", "nc"])
def test_files_that_the_library_writes_come_back(library, tmp_path, ending):
    """Heights in um of which one is missing (x3p, gwy; the writer of nc allows none)."""
    values = np.ma.masked_array(WANTED * 1e6, mask=np.zeros((5, 4), dtype=bool))
    values[1, 2] = values[1, 2] if ending == "nc" else np.ma.masked
    topography = library.Topography(values if ending != "nc" else values.filled(), (10.0, 4.0), unit="µm")
    getattr(topography, "to_netcdf" if ending == "nc" else f"to_{ending}")(str(tmp_path / f"h.{ending}"))
    head, found = heights_in((tmp_path / f"h.{ending}").read_bytes(), [ending], 4097)
    assert head["extent"] == pytest.approx([1e-5, 4e-6], rel=1e-12)
    assert np.isnan(found).sum() == (ending != "nc")
    known = ~np.isnan(found)
    assert np.allclose(found[known], WANTED[known], rtol=1e-12, atol=0)


@pytest.mark.parametrize(
    ("formats", "content", "message"),
    [
        (["asc"], matrix(""), "does not say how large the map is"),
        (["asc"], matrix("# Width: 10 µm\n# Height: 4 µm\n"), "does not say in which unit"),
        (["asc"], matrix("# Value units: nm\n"), "does not say how large"),
        (["asc"], matrix(GWYDDION_TEXT.replace("nm", "V")), "Could not find any topography"),
        (["asc"], matrix(GWYDDION_TEXT)[:-30], "different numbers of values"),
        (["sdf"], sdf_in_bytes()[:-8], "."),
        (
            ["sdf"],
            sdf_in_bytes().replace(struct.pack("<HH", 5, 4), struct.pack("<HH", 5000, 4)),
            "5000 x 4 heights: at most",
        ),
        (["gwy", "x3p"], bytes(range(256)) * 9, ".*; .*"),
        (["al3d"], b"", "."),
    ],
)
def test_a_file_without_a_size_a_unit_or_sense_is_refused(library, formats, content, message):
    with pytest.raises((RefusedError, library.Exceptions.CorruptFile), match=message):
        heights_in(content, formats, 4097)


def test_a_scene_reads_an_instrument_in_a_process_of_its_own(library, tmp_path):
    """One hole, filled by the mean of its neighbours, weighted by 1/distance^2: 2 um along x, 1 um
    along y.
    """
    scene = rough(tmp_path, "pin.sdf", sdf_in_words("BAD"), 'missing = "harmonic"\n')
    known = ~np.isnan(scene.surface.path.values)
    assert known.sum() == 19 and np.allclose(
        scene.surface.path.values[known], WANTED[known], rtol=1e-12, atol=0
    )
    found = processed(scene.surface, (5, 4))[2, 1]
    assert found == pytest.approx(1e-9 * (4 - 13 + (-5 + 0.5) / 4) / 2.5, rel=1e-12)


def test_bytes_that_are_no_instruments_file_end_in_one_message(library, tmp_path):
    with pytest.raises(
        SceneError, match=r"surface.path = .pin.SDF.: no heights, read as sdf: .*Missing required field"
    ):
        rough(tmp_path, "pin.SDF", sdf_in_words()[:150])


def said(name: str, shape: list[int], kind: str = "<f8") -> str:
    head = {"said": {"extent": [1, 1]}, "arrays": {name: [kind, shape]}}
    return f"print({json.dumps(json.dumps(head))})"


@pytest.mark.parametrize(
    ("script", "message"),
    [
        ("import time; time.sleep(60)", "its reader did not end in 0.5 s"),
        ("import os; os.abort()", "ended without an answer"),
        ("print('hello')", "ended without an answer"),
        ("print('[1]')", "answered nonsense"),
        ("print('{}')", "answered nonsense"),
        (said("heights", [5, 4]), "answered nonsense"),
        (said("heights", [9**99]), "answered nonsense"),
        (said("heights", [0, 4], "|O"), "answered nonsense"),
        (said("other", [0, 4]), "answered nonsense"),
        (said("heights", [0, 4]), "0 x 4 heights"),
        ("""print('{"refused": "a\\\\u001b[31mb"}')""", r"no heights, read as sdf: a\?\[31mb"),
    ],
)
def test_a_reader_that_hangs_or_dies_is_a_refusal(monkeypatch, tmp_path, script, message):
    (tmp_path / "child.py").write_text(script)
    monkeypatch.setattr(inputs, "CHILD", tmp_path / "child.py")
    monkeypatch.setattr(inputs, "SECONDS", 0.5 if "sleep" in script else 30.0)
    monkeypatch.setattr(readers, "find_spec", lambda _: True)
    with pytest.raises(InputError, match=message):
        readers.read_instrument("h.sdf", b"")


def test_without_the_extra_only_our_own_files_are_read(monkeypatch, tmp_path):
    monkeypatch.setattr(readers, "find_spec", lambda _: None)
    with pytest.raises(
        SceneError,
        match=r"surface.path = .h.al3d.: .*SurfaceTopography, the extra .instruments., not installed",
    ):
        rough(tmp_path, "h.al3d", b"AliconaImaging")
    plain = HeightMap(WANTED, (1e-5, 4e-6))
    x, y = centres(5, 2e-6), centres(4, 1e-6)
    arrays = npz({"x_m": x, "y_m": y, "height_m": WANTED})
    table = "height_m,x_m,y_m\n" + "".join(
        f"{WANTED[i, j]!r},{a!r},{b!r}\n" for i, a in enumerate(x) for j, b in enumerate(y)
    )
    table = table.replace("np.float64(", "").replace(")", "")
    for name, content in (
        ("h.npz", arrays),
        ("h", arrays),
        ("h.txt", table.encode()),
        ("h.csv", table.encode()),
    ):
        assert np.array_equal(read_named(name, content).values, plain.values)
    assert readers.formats_of("a/b.DAT") == ("asc", "metropro") and readers.formats_of("scene.toml") == ()


def test_every_ending_is_one_of_the_library(library):
    """Format by format; those without lengths (npy, h5, mat, hgt) and our own two endings are left out on
    purpose.
    """
    formats = pytest.importorskip("SurfaceTopography.IO").readers
    known = {reader.format(): set(reader.file_extensions()) for reader in formats}
    for name, endings in readers.ENDINGS.items():
        assert set(endings.split()) <= known[name]
