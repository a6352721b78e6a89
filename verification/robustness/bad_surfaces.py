# SPDX-License-Identifier: MIT
"""Rough scenes that are bad on purpose: files of heights that lie, explode or do not fit, and generators at
odd values.
"""

from __future__ import annotations

import io
import random
import re
import zipfile
from functools import cache

import numpy as np

from verification.robustness.bad_files import (
    AROUND,
    SCENE,
    BadInput,
    Special,
    lying_header,
    mutated,
    npz,
    toml_string,
    with_pickle,
)
from verification.robustness.hostile import PLACES, ROUGH, WAVES

HEIGHTS, TABLE = "heights.npz", "heights.csv"
BOMB_BYTES = 1 << 26
PROCESSING = {
    "form": ('"none"', '"tilt"', '"sphere"', '"quadratic"'),
    "missing": ('"harmonic"', '"refuse"'),
    "resample": ('"fourier"',),
}
NO_WORDS = ('"x"', '""', "0", "[]", "true", '"harmonic"')
BAD_NUMBERS = (
    "nan",
    "inf",
    "-inf",
    "1e400",
    "-1e308",
    "",
    "x",
    '"1"',
    "0x1p3",
    "1_0",
    "9" * 5_000,
    "\x00",
    "1;2",
    "١",
)


def bad_surface(rng: random.Random, kind: str) -> BadInput:
    """A rough scene: its path, the file that it names, or the keys of its generator changed."""
    edit = rng.randrange(6)
    if edit == 0:
        return _rough(kind, rng.choice((*PLACES, HEIGHTS, TABLE)), {TABLE: table()})
    if edit == 1:
        return _rough(kind, HEIGHTS, {HEIGHTS: _bad_npz(rng)})
    if edit == 2:
        return _rough(kind, HEIGHTS, {HEIGHTS: _odd_arrays(rng)})
    if edit == 3:
        return _rough(kind, TABLE, {TABLE: _bad_table(rng)})
    if edit == 4:
        return _bad_processing(rng, kind)
    return BadInput(kind, {SCENE: _bad_generator(rng).encode()})


def bad_matrix(rng: random.Random, kind: str) -> BadInput:
    """Heights as laboratories export them: a matrix alone, or x, y and z in other units, good and bad."""
    rows = [[f"{value:.6g}" for value in row] for row in 1e9 * _arrays()["height_m"].T]
    for _ in range(rng.choice((0, 0, 1, 3))):
        row = rng.choice(rows)
        row[rng.randrange(len(row))] = rng.choice(BAD_NUMBERS)
    if rng.random() < 0.2:
        del rows[rng.randrange(len(rows))][rng.randrange(12) :]
    if rng.random() < 0.3:
        rows = [
            ["x_um", "y_um", "z_um"],
            *([str(x), str(y), z] for y, row in enumerate(rows) for x, z in enumerate(row)),
        ]
    between = rng.choice((",", ";", "\t", " ", "  ", ", "))
    text = "\n".join(between.join(row) for row in rows) + rng.choice(("", "\n", "\n\n"))
    text = text.replace(".", ",") if between != "," and rng.random() < 0.2 else text
    heads = "", "", "", "# nm\n", "x,y,z\n", "\ufeff", "1\n", "[Header]\nWidth=10 um\n\n"
    content = (rng.choice(heads) + text).encode(
        rng.choice(("utf-8", "utf-8", "utf-16", "latin-1")), "replace"
    )
    ending = rng.choice((".csv", ".txt", ".npy", ".asc", ".dat"))
    if ending == ".npy":
        values = _arrays()["height_m"].astype(
            rng.choice(("<f8", "<f4", ">f8", "<i8", "<c16", "?", "|O", "<U9"))
        )
        member = io.BytesIO()
        np.lib.format.write_array(member, values, allow_pickle=True)  # an object is refused
        content = rng.choice((member.getvalue(), lying_header(rng)))
    content = mutated(rng, content) if rng.random() < 0.2 else content
    keys = (
        'extent = ["12 um", "10 um"]',
        'unit = "nm"',
        'extent = "12 um"',
        'unit = "N"',
        "unit = 1",
        'extent = ["0 m", "1 m"]',
    )
    name = f"heights{ending}"
    path = toml_string(name) + "\n" + "\n".join(rng.sample(keys, rng.randrange(3)))
    files = {**AROUND, name: content, SCENE: ROUGH.replace(toml_string(HEIGHTS), path).encode()}
    return BadInput(kind, files)


def _rough(kind: str, path: str, files: dict[str, bytes]) -> BadInput:
    text = ROUGH.replace(toml_string(HEIGHTS), toml_string(path)).encode("utf-8", "surrogatepass")
    around: dict[str, bytes | Special] = {**AROUND, "pickle.npz": with_pickle(), HEIGHTS: good_heights()}
    return BadInput(kind, {**around, **files, SCENE: text})


def _bad_processing(rng: random.Random, kind: str) -> BadInput:
    """What is done to a file, with odd values, and heights of which some, most or all are missing."""
    arrays = _arrays()
    missing = rng.choice((0, 0, 0, 1, 30, 60, 61, 120))
    arrays["height_m"].flat[rng.sample(range(120), missing)] = np.nan
    length = rng.choice(
        ("4 um", "5.5 um", "9.4 um", "10 um", "12.1 um", "-3 um", "0 um", "1e30 m", "1e-30 m", "3 N")
    )
    crops = ("[]", "[1, 2]", f'["{length}", "5 um"]', f'["{length}", "0 um", "6 um", "5 um"]')
    lines = [
        f"{key} = {rng.choice(words if rng.random() < 0.9 else NO_WORDS)}"
        for key, words in PROCESSING.items()
    ]
    lines.append(f"crop = {rng.choice(crops)}")
    lines.append(f"[grid]\ncells = {rng.choice(('[12, 10]', '[33, 17]', '[4097, 3]'))}")
    chosen = "\n".join(line for line in lines if rng.random() < 0.5)
    bad = _rough(kind, HEIGHTS, {HEIGHTS: npz(arrays)})
    return BadInput(
        kind, {**bad.files, SCENE: ROUGH.replace('"heights.npz"\n', f'"heights.npz"\n{chosen}\n').encode()}
    )


def _arrays() -> dict[str, np.ndarray]:
    x = np.arange(12) * 1e-6
    y = np.arange(10) * 1e-6
    return {"x_m": x, "y_m": y, "height_m": 1e-7 * np.cos(1e6 * x[:, None]) * np.cos(7e5 * y[None, :])}


@cache
def good_heights() -> bytes:
    """An npz file of 12 x 10 heights."""
    return npz(_arrays())


@cache
def table() -> bytes:
    """The same as CSV."""
    arrays = _arrays()
    rows = [
        f"{x!r},{y!r},{arrays['height_m'][i, j]!r}\n"
        for i, x in enumerate(arrays["x_m"].tolist())
        for j, y in enumerate(arrays["y_m"].tolist())
    ]
    return ("x_m,y_m,height_m\n" + "".join(rows)).replace("np.float64(", "").replace(")", "").encode()


@cache
def _bomb(shape: tuple[int, ...]) -> bytes:
    """An npz file of a few kB whose heights, said to have that shape, unpack to BOMB_BYTES."""
    member, stream = io.BytesIO(), io.BytesIO()
    np.lib.format.write_array_header_1_0(member, {"descr": "<f8", "fortran_order": False, "shape": shape})
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as target:
        for name, content in _arrays().items():
            plain = io.BytesIO()
            np.lib.format.write_array(plain, content)
            bomb = member.getvalue() + bytes(BOMB_BYTES)
            target.writestr(
                zipfile.ZipInfo(f"{name}.npy"),
                bomb if name == "height_m" else plain.getvalue(),
                zipfile.ZIP_DEFLATED,
            )
    return stream.getvalue()


def _bad_npz(rng: random.Random) -> bytes:
    """A container that is damaged, lies about its members, or holds what it must not."""
    edit = rng.randrange(6)
    if edit == 0:
        return with_pickle()
    if edit == 1:
        return npz(_arrays() | {rng.choice(("x_m", "height_m")): lying_header(rng)})
    if edit == 2:
        return _bomb(rng.choice(((12, 10), (BOMB_BYTES // 8,), (1 << 13, 1 << 10), (1 << 40, 1 << 20))))
    if edit == 3:
        content, at = bytearray(good_heights()), good_heights().rfind(b"PK\x01\x02")
        content[at + 20 : at + 28] = rng.randbytes(8)  # sizes of the last member in the directory
        return bytes(content)
    if edit == 4:
        names = rng.choice(
            (("x_m",), ("x_m", "y_m"), ("x_m", "y_m", "height_m", "extra"), (), ("x", "y", "z"))
        )
        return npz({name: np.arange(3.0) for name in names})
    return mutated(rng, good_heights())


def _odd_arrays(rng: random.Random) -> bytes:
    """A sound container with heights or coordinates that are no map."""
    arrays = _arrays()
    name = rng.choice(("x_m", "y_m", "height_m"))
    array = arrays[name].copy()
    edit = rng.randrange(6)
    if edit == 0:
        array.flat[rng.randrange(array.size)] = rng.choice((np.nan, np.inf, -np.inf, 1e308, -1e300, 1e31))
    elif edit == 1:
        array = rng.choice(
            (
                array[:1],
                array[:2],
                array[:0],
                array[::-1],
                np.repeat(array, 2, axis=0),
                array[None],
                array.sum(),
            )
        )
    elif edit == 2:
        array = array.astype(
            rng.choice(("<f4", ">f8", "<i8", "<f2", "?", "<c16", "<U9", "S3", "<M8[s]", ">i2"))
        )
    elif edit == 3:
        array.flat[rng.randrange(array.size)] += rng.choice((1e-12, 1e-9, 1e-7, 1e-3, 1e20))
    elif edit == 4:
        array = array * rng.choice((0.0, 1e-300, 1e-25, 1e25, 1e300, -1.0))
    else:
        array = np.asfortranarray(array)
    return npz(arrays | {name: np.asarray(array)})


def _bad_table(rng: random.Random) -> bytes:
    """CSV with other columns, numbers, rows, separators and encodings."""
    lines = table().decode().splitlines(keepends=True)
    edit = rng.randrange(7)
    if edit == 0:
        lines[0] = rng.choice(
            (
                "x,y,z\n",
                "\n",
                "x_m;y_m;height_m\n",
                "y_m, x_m ,height_m\n",
                '"x_m","y_m","height_m"\n',
                "x_m,x_m,y_m\n",
            )
        )
    elif edit == 1:
        at = rng.randrange(1, len(lines))
        cells = lines[at].rstrip("\n").split(",")
        cells[rng.randrange(3)] = rng.choice(BAD_NUMBERS)
        lines[at] = ",".join(cells) + "\n"
    elif edit == 2:
        del lines[rng.randrange(1, len(lines)) :: rng.choice((1, 2, 1_000))]
    elif edit == 3:
        lines.insert(
            rng.randrange(len(lines)),
            rng.choice(("\n", "\r\n", "1,2\n", "1,2,3,4\n", lines[1], "," * 100_000 + "\n", "# x\n")),
        )
    elif edit == 4:
        rows = lines[1:]
        rng.shuffle(rows)
        lines[1:] = rows
    elif edit == 5:
        return "".join(lines).encode(rng.choice(("utf-16", "utf-8-sig", "utf-32", "cp037")))
    else:
        return mutated(rng, table())
    return "".join(lines).encode()


def _bad_generator(rng: random.Random) -> str:
    """A generated surface with one or two keys replaced, or left out."""
    text = WAVES
    for _ in range(rng.randint(1, 2)):
        match = rng.choice(list(re.finditer(r"(?m)^(\w+) = (.+)\n", text[text.index("[surface]") :])))
        length = f'"{10 ** rng.uniform(-9, 3):.3g} um"'
        value = rng.choice(
            (
                length,
                "0",
                "1",
                "0.5",
                "-1",
                "1e9",
                '"file"',
                '"sinusoid"',
                '"self-affine"',
                "[20, 20]",
                "[3, 4097]",
            )
        )
        line = rng.choice(
            (
                f"{match[1]} = {value}\n",
                f"{match[1]} = {value}\n",
                "",
                'amplitude = "1 um"\n',
                'path = "heights.npz"\n',
            )
        )
        text = text.replace(match[0], line, 1)
    return text
