# SPDX-License-Identifier: MIT
"""Bad input on purpose: scenes, the files they name, surfaces, meshes, archives and run folders, mutated from
good ones by a seed.

An input is a small folder: `bad_input(seed, number)` is the same on every machine, and `lay` writes it to
disk. Most inputs are wrong, some are odd but good; what a reader makes of them is the business of who calls.
"""

from __future__ import annotations

import io
import json
import os
import pickle
import random
import re
import zipfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Literal

import numpy as np

from sam.scene import GridFields, Result, Status
from verification.robustness import hostile
from verification.robustness.hostile import EVERY_KEY, NUMBERS, PLACES, PLASTIC, ROUGH, SMALL, UNITS, VALUES
from verification.runs.archive import DIGEST, VALUES as VALUES_JSON, digest_of
from verification.runs.meshes import READABLE, mesh_files

SCENE, MAPPING, HEIGHTS, TABLE = "scene.toml", "own.toml", "heights.npz", "heights.csv"
ARCHIVE, RUN, MESHES, MAPPINGS, STUDIES = "archive", "run", "meshes", "mappings", "studies"
BOMB_BYTES = 1 << 26
_FORCE = re.compile(r"(?m)^force = .+$")
_LINE = re.compile(r"(?m)^(\w+) = (.+)$")
_STRING = re.compile(r'"([^"\n]*)"')
_COUNT = re.compile(rb"\b\d+\b")


@dataclass(frozen=True)
class Special:
    """What is no ordinary file: a named pipe, a folder, or a link to `target`."""

    what: Literal["pipe", "folder", "link"]
    target: str = ""


File = bytes | Special


@dataclass(frozen=True)
class BadInput:
    """kind: of KINDS; files: path in the folder -> content; name: what a reader is given, in the folder or
    absolute.
    """

    kind: str
    files: Mapping[str, File]
    name: str


Laid = tuple[Mapping[str, File], str]
"""Files and name of an input."""
Generator = Callable[[random.Random], Laid]
AROUND: Mapping[str, File] = {
    "yield.csv": hostile.YIELD,
    "depth.csv": hostile.DEPTH,
    "sub": Special("folder"),
    "pipe": Special("pipe"),
    "link-out": Special("link", "/etc/passwd"),
    "link-loop": Special("link", "link-loop"),
    "link-in": Special("link", "yield.csv"),
    "link-zero": Special("link", "/dev/zero"),
}
"""What lies in the folder of a scene whose paths are attacked."""


def bad_input(seed: int, number: int) -> BadInput:
    """Input `number` of the series of `seed`; the kinds take turns, MORE_KINDS at negative numbers."""
    kinds = KINDS if number >= 0 else MORE_KINDS
    kind = tuple(kinds)[number % len(kinds)]
    return BadInput(kind, *kinds[kind](random.Random(f"{seed}/{number}")))


def lay(bad: BadInput, folder: Path) -> Path:
    """Write the files of an input into an empty folder, and return the path that a reader is given."""
    for name, content in bad.files.items():
        path = folder / os.fsdecode(name.encode(errors="surrogateescape"))  # bytes of UTF-8 in every language
        path.parent.mkdir(parents=True, exist_ok=True)
        if isinstance(content, bytes):
            path.write_bytes(content)
        elif content.what == "folder":
            path.mkdir()
        elif content.what == "link":
            path.symlink_to(content.target)
        elif hasattr(os, "mkfifo"):
            os.mkfifo(path)
    return folder / bad.name


def one_of(rng: random.Random, words: str) -> str:
    """One of the texts between the bars."""
    return rng.choice(words.split("|"))


def mutated(rng: random.Random, content: bytes) -> bytes:
    """Bytes cut short, with bits flipped, with hostile bytes put in, or with a part twice or missing."""
    content = bytearray(content)
    for _ in range(rng.choice((1, 1, 2, 8))):
        at = rng.randrange(len(content) + 1)
        match rng.randrange(5):
            case 0:
                del content[at:]
            case 1 if at < len(content):
                content[at] ^= 1 << rng.randrange(8)
            case 2:
                content[at:at] = rng.choice(hostile.BYTES) * rng.choice((1, 1, 1_000))
            case 3:
                content[at:at] = content[at : at + rng.randrange(200)]
            case 4:
                del content[at : at + rng.randrange(40)]
    return bytes(content)


def toml_string(text: str) -> str:
    """A TOML string; control characters as escapes, which TOML allows only for some."""
    return json.dumps(text, ensure_ascii=any("\ud800" <= c <= "\udfff" for c in text))


def encoded(text: str) -> bytes:
    """UTF-8, with surrogates as they are."""
    return text.encode("utf-8", "surrogatepass")


def npz(members: Mapping[str, np.ndarray | bytes], values: Mapping | None = None) -> bytes:
    """An npz file of arrays, or of members whose bytes are given, and of values as an archive holds them."""
    stream = io.BytesIO()
    if values is not None:
        members = {**members, "values.json": np.frombuffer(json.dumps(values).encode(), dtype=np.uint8)}
    with zipfile.ZipFile(stream, "w") as target:
        for name, content in members.items():
            if not isinstance(content, bytes):
                content = npy(content)
            target.writestr(zipfile.ZipInfo(f"{name}.npy"), content)
    return stream.getvalue()


def npy(array: np.ndarray, *, objects: bool = False) -> bytes:
    """A member of an npz file."""
    member = io.BytesIO()
    np.lib.format.write_array(member, array, allow_pickle=objects)
    return member.getvalue()


def npy_header(kind: str, shape: tuple[int, ...]) -> bytes:
    """How a member begins that says to hold values of that kind."""
    member = io.BytesIO()
    np.lib.format.write_array_header_1_0(member, {"descr": kind, "fortran_order": False, "shape": shape})
    return member.getvalue()


def lying_header(rng: random.Random) -> bytes:
    """An npy member whose header lies."""
    shape = rng.choice(hostile.SHAPES)
    kind = one_of(rng, "<f8|¦O|<U999999999|x|<f8, <f8|¦V0|>c16").replace("¦", "|")
    text = f"{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}".encode()
    version = rng.choice((b"\x01\x00", b"\x02\x00", b"\x03\x00", b"\x09\x09"))
    return b"\x93NUMPY" + version + len(text).to_bytes(2, "little") + text


class Trap:
    """What a reader that unpickles would run: it makes the file `sprung` beside itself."""

    def __reduce__(self):
        return os.mkdir, ("sprung",)


@cache
def with_pickle() -> bytes:
    """An npz file with an array of objects whose unpickling makes a folder in the current one."""
    trap = npy_header("|O", (1,)) + pickle.dumps([Trap()])
    return npz({"x_m": trap, "y_m": np.zeros(3), "height_m": np.zeros((3, 3))}, {})


def bad_archive(rng: random.Random) -> Laid:
    """An npz file with flipped bits, pickles, absurd shapes, odd values, or none at all."""
    arrays = {"a": np.arange(24.0).reshape(4, 6), "b": np.array(["x", "yy"])}
    arrays[VALUES_JSON] = np.frombuffer(json.dumps({"x": [1, None, "é"]}).encode(), dtype=np.uint8)
    edit = rng.randrange(6)
    if edit == 0:
        content = with_pickle()
    elif edit == 1:
        content = npz({"a": lying_header(rng)}, {})
    elif edit == 2:
        content = npz({"values.json": np.frombuffer(rng.choice(hostile.JSON), dtype=np.uint8)}, None)
    elif edit == 3:
        names = "sub", "pipe", "link-zero", "link-loop", "missing", "yield.csv", "x" * 5_000, "a\0b"
        return AROUND, rng.choice(names)
    else:
        content = mutated(rng, npz({**arrays, DIGEST: digest_of(arrays)}))
    return {ARCHIVE: content}, ARCHIVE


def bad_run(rng: random.Random) -> Laid:
    """The folder of a run whose summary or tables are damaged, of another version, or no files."""
    summary, table = f"{RUN}/summary.json", f"{RUN}/history.csv"
    good = {"format": "samfem run 1", "status": "converged", "model": "sam", "scene": {}}
    text = json.dumps(good | {"quantities": {"force_N": 1.0}}).encode()
    files: dict[str, File] = {summary: text, table: b"cycle,step,force_N\n1,1,0.5\n1,2,1.0\n"}
    edit = rng.randrange(5)
    if edit == 0:
        files[summary] = mutated(rng, files[summary])
    elif edit == 1:
        files[summary] = rng.choice(hostile.SUMMARIES)
    elif edit == 2:
        files[table] = rng.choice(hostile.HISTORIES)
    elif edit == 3:
        links = Special("link", "/dev/zero"), Special("link", "nowhere")
        odd = rng.choice((Special("pipe"), Special("folder"), *links))
        files[f"{RUN}/{rng.choice(('summary.json', 'history.csv'))}"] = odd
    else:
        files[table] = mutated(rng, files[table])
    return files, rng.choice((RUN,) * 8 + (table, "missing", "x" * 5_000))


def with_mapping(text: str, files: dict[str, File]) -> Laid:
    """A mapping beside a scene and files."""
    return {**AROUND, SCENE: SMALL.encode(), MAPPING: encoded(text), **files}, MAPPING


def bad_mesh(rng: random.Random) -> Laid:
    """A mesh that is damaged, lies about its sizes, names others elsewhere, or is none."""
    edit = rng.randrange(6)
    name = f"own{rng.choice(('.vtu', '.vtk', '.vtr'))}"
    good = content = good_meshes()[name]
    if edit == 0:
        content = mutated(rng, good)
    elif edit == 1:  # a number of the first lines, which say how much of what there is
        found = rng.choice(list(_COUNT.finditer(good[:2_000])))
        content = good[: found.start()] + rng.choice(NUMBERS).encode() + good[found.end() :]
    elif edit == 2:
        others = "own.vtu", "sub/own.vtu", "../own.vtu", "own.pvd", "own.vtm", "own.case"
        place = rng.choice((*PLACES, *others))
        ending = rng.choice((".pvd", ".vtm", ".pvtu", ".case"))
        part = f"<DataSet file={toml_string(place)}/>"
        xml = f'<VTKFile type="Collection"><Collection>{part}</Collection></VTKFile>'
        case = f"FORMAT\ntype: ensight gold\nGEOMETRY\nmodel: 1 {place}\n"
        name, content = f"own{ending}", encoded(case if ending == ".case" else xml)
    elif edit == 3:
        start = rng.choice((*hostile.MAGIC, good[:300]))
        content = start + rng.randbytes(rng.choice((0, 1, 189, 5_000)))
        name = f"own{rng.choice((*READABLE, *hostile.NOT_READ))}"
    elif edit == 4:
        links = Special("link", "/dev/zero"), Special("link", "/etc/passwd")
        content = rng.choice((Special("pipe"), Special("folder"), *links))
    else:
        name = f"own{rng.choice(READABLE)}"  # the ending of another format
    text = hostile.MAPPING.replace('"own.vtu"', toml_string(name))
    return with_mapping(text, {**good_meshes(), name: content})


@cache
def good_meshes() -> dict[str, bytes]:
    """A plane below the contact of SMALL, in three formats."""
    x, z = np.linspace(-6e-5, 6e-5, 25), np.linspace(0.0, 6e-5, 13)
    p = np.where(z == 0.0, 1.0, 0.0) * np.sqrt(np.maximum(1.0 - (x[:, None] / 1.5e-5) ** 2, 0.0)) * 1e9
    moved = 1e-16 * np.stack([p[:, None]] * 3)
    fields = {"p_Pa": p[:, None], "mises_Pa": 0.5 * p[:, None], "displacement_m": moved}
    plane = GridFields(x, np.zeros(1), z, fields, {})
    grids = {"peak": {"plane": plane, "surface": plane}}
    made = mesh_files(Result("sam", Status.CONVERGED, {}, {}, grids=grids), 1)
    return {"own.vtu": made["fields.vtu"], "own.vtr": made["surface.vtr"], "own.vtk": _legacy(x, z, p)}


def _legacy(x: np.ndarray, z: np.ndarray, p: np.ndarray) -> bytes:
    """The points of the plane with their pressure, in the old format of VTK, in bytes."""
    points = np.stack([each.ravel() for each in np.meshgrid(x, 0.0, -z, indexing="ij")], axis=-1)
    n = len(points)
    cells = np.stack([np.ones(n), np.arange(n)], axis=-1)
    parts = (
        "# vtk DataFile Version 3.0\nplane\nBINARY\nDATASET UNSTRUCTURED_GRID\n",
        f"POINTS {n} double\n",
        points.astype(">f8").tobytes(),
        f"\nCELLS {n} {2 * n}\n",
        cells.astype(">i4").tobytes(),
        f"\nCELL_TYPES {n}\n",
        np.ones(n, ">i4").tobytes(),
        f"\nPOINT_DATA {n}\nSCALARS p_Pa double 1\nLOOKUP_TABLE default\n",
        p.astype(">f8").tobytes(),
    )
    return b"".join(part if isinstance(part, bytes) else part.encode() for part in parts)


def bad_surface(rng: random.Random) -> Laid:
    """A rough scene: its path, the file that it names, or the keys of its generator changed."""
    edit = rng.randrange(6)
    if edit == 0:
        return _rough(rng.choice((*PLACES, HEIGHTS, TABLE)), {TABLE: table()})
    if edit in (1, 2):
        return _rough(HEIGHTS, {HEIGHTS: _bad_npz(rng) if edit == 1 else _odd_arrays(rng)})
    if edit == 3:
        return _rough(TABLE, {TABLE: _bad_table(rng)})
    if edit == 4:
        return _bad_processing(rng)
    return {SCENE: _bad_generator(rng).encode()}, SCENE


def bad_matrix(rng: random.Random) -> Laid:
    """Heights as laboratories export them: a matrix alone, or x, y and z in other units, good and bad."""
    rows = [[f"{value:.6g}" for value in row] for row in 1e9 * _arrays()["height_m"].T]
    for _ in range(rng.choice((0, 0, 1, 3))):
        row = rng.choice(rows)
        row[rng.randrange(len(row))] = rng.choice(hostile.HEIGHTS)
    if rng.random() < 0.2:
        del rows[rng.randrange(len(rows))][rng.randrange(12) :]
    if rng.random() < 0.3:
        places = [[str(x), str(y), z] for y, row in enumerate(rows) for x, z in enumerate(row)]
        rows = [["x_um", "y_um", "z_um"], *places]
    between = rng.choice((",", ";", "\t", " ", "  ", ", "))
    text = "\n".join(between.join(row) for row in rows) + rng.choice(("", "\n", "\n\n"))
    text = text.replace(".", ",") if between != "," and rng.random() < 0.2 else text
    heads = "", "", "", "# nm\n", "x,y,z\n", "\ufeff", "1\n", "[Header]\nWidth=10 um\n\n"
    content = (rng.choice(heads) + text).encode(one_of(rng, "utf-8|utf-8|utf-16|latin-1"), "replace")
    ending = rng.choice((".csv", ".txt", ".npy", ".asc", ".dat"))
    if ending == ".npy":
        kinds = "<f8", "<f4", ">f8", "<i8", "<c16", "?", "|O", "<U9"
        values = _arrays()["height_m"].astype(rng.choice(kinds))  # an object is refused
        content = rng.choice((npy(values, objects=True), lying_header(rng)))
    content = mutated(rng, content) if rng.random() < 0.2 else content
    keys = rng.sample(hostile.MATRIX_KEYS, rng.randrange(3))
    path = toml_string(f"heights{ending}") + "\n" + "\n".join(keys)
    files = {f"heights{ending}": content, SCENE: ROUGH.replace(toml_string(HEIGHTS), path).encode()}
    return {**AROUND, **files}, SCENE


def _rough(path: str, files: dict[str, bytes]) -> Laid:
    text = encoded(ROUGH.replace(toml_string(HEIGHTS), toml_string(path)))
    around = {**AROUND, "pickle.npz": with_pickle(), HEIGHTS: good_heights()}
    return {**around, **files, SCENE: text}, SCENE


def _bad_processing(rng: random.Random) -> Laid:
    """What is done to a file, with odd values, and heights of which some, most or all are missing."""
    arrays = _arrays()
    missing = rng.choice((0, 0, 0, 1, 30, 60, 61, 120))
    arrays["height_m"].flat[rng.sample(range(120), missing)] = np.nan
    length = one_of(rng, "4 um|5.5 um|9.4 um|10 um|12.1 um|-3 um|0 um|1e30 m|1e-30 m|3 N")
    crops = ("[]", "[1, 2]", f'["{length}", "5 um"]', f'["{length}", "0 um", "6 um", "5 um"]')
    lines = [
        f"{key} = {rng.choice(words if rng.random() < 0.9 else hostile.NO_WORDS)}"
        for key, words in hostile.PROCESSING.items()
    ]
    lines.append(f"crop = {rng.choice(crops)}")
    lines.append(f"[grid]\ncells = {rng.choice(('[12, 10]', '[33, 17]', '[4097, 3]'))}")
    chosen = "\n".join(line for line in lines if rng.random() < 0.5)
    text = ROUGH.replace('"heights.npz"\n', f'"heights.npz"\n{chosen}\n').encode()
    return {**_rough(HEIGHTS, {HEIGHTS: npz(arrays)})[0], SCENE: text}, SCENE


def _arrays() -> dict[str, np.ndarray]:
    x, y = np.arange(12) * 1e-6, np.arange(10) * 1e-6
    return {"x_m": x, "y_m": y, "height_m": 1e-7 * np.cos(1e6 * x[:, None]) * np.cos(7e5 * y[None, :])}


@cache
def good_heights() -> bytes:
    """An npz file of 12 x 10 heights."""
    return npz(_arrays())


@cache
def table() -> bytes:
    """The same as CSV."""
    x, y, heights = (array.tolist() for array in _arrays().values())
    rows = [f"{x[i]!r},{y[j]!r},{heights[i][j]!r}\n" for i in range(12) for j in range(10)]
    return ("x_m,y_m,height_m\n" + "".join(rows)).encode()


@cache
def _bomb(shape: tuple[int, ...]) -> bytes:
    """An npz file of a few kB whose heights, said to have that shape, unpack to BOMB_BYTES."""
    stream, members = io.BytesIO(), {name: npy(array) for name, array in _arrays().items()}
    members["height_m"] = npy_header("<f8", shape) + bytes(BOMB_BYTES)
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as target:
        for name, content in members.items():
            target.writestr(zipfile.ZipInfo(f"{name}.npy"), content, zipfile.ZIP_DEFLATED)
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
        names = one_of(rng, "x_m|x_m y_m|x_m y_m height_m extra||x y z").split()
        return npz({name: np.arange(3.0) for name in names})
    return mutated(rng, good_heights())


def _odd_arrays(rng: random.Random) -> bytes:
    """A sound container with heights or coordinates that are no map."""
    arrays = _arrays()
    name = rng.choice(("x_m", "y_m", "height_m"))
    array = arrays[name].copy()
    match rng.randrange(6):
        case 0:
            odd = np.nan, np.inf, -np.inf, 1e308, -1e300, 1e31
            array.flat[rng.randrange(array.size)] = rng.choice(odd)
        case 1:
            some = array[:1], array[:2], array[:0], array[::-1]
            array = rng.choice((*some, np.repeat(array, 2, axis=0), array[None], array.sum()))
        case 2:
            array = array.astype(one_of(rng, "<f4|>f8|<i8|<f2|?|<c16|<U9|S3|<M8[s]|>i2"))
        case 3:
            array.flat[rng.randrange(array.size)] += rng.choice((1e-12, 1e-9, 1e-7, 1e-3, 1e20))
        case 4:
            array = array * rng.choice((0.0, 1e-300, 1e-25, 1e25, 1e300, -1.0))
        case _:
            array = np.asfortranarray(array)
    return npz(arrays | {name: np.asarray(array)})


def _bad_table(rng: random.Random) -> bytes:
    """CSV with other columns, numbers, rows, separators and encodings."""
    lines = table().decode().splitlines(keepends=True)
    match rng.randrange(7):
        case 0:
            lines[0] = rng.choice(hostile.HEADS) + "\n"
        case 1:
            at = rng.randrange(1, len(lines))
            cells = lines[at].rstrip("\n").split(",")
            cells[rng.randrange(3)] = rng.choice(hostile.HEIGHTS)
            lines[at] = ",".join(cells) + "\n"
        case 2:
            del lines[rng.randrange(1, len(lines)) :: rng.choice((1, 2, 1_000))]
        case 3:
            odd = "\n", "\r\n", "1,2\n", "1,2,3,4\n", lines[1], "," * 100_000 + "\n", "# x\n"
            lines.insert(rng.randrange(len(lines)), rng.choice(odd))
        case 4:
            rows = lines[1:]
            rng.shuffle(rows)
            lines[1:] = rows
        case 5:
            return "".join(lines).encode(rng.choice(hostile.CODECS))
        case _:
            return mutated(rng, table())
    return "".join(lines).encode()


def _bad_generator(rng: random.Random) -> str:
    """A generated surface with one or two keys replaced, or left out."""
    text = hostile.WAVES
    for _ in range(rng.randint(1, 2)):
        match = rng.choice(list(re.finditer(r"(?m)^(\w+) = (.+)\n", text[text.index("[surface]") :])))
        length = f'"{10 ** rng.uniform(-9, 3):.3g} um"'
        numbers = length, "0", "1", "0.5", "-1", "1e9"
        value = rng.choice((*numbers, '"file"', '"sinusoid"', '"self-affine"', "[20, 20]", "[3, 4097]"))
        changed = f"{match[1]} = {value}\n"
        others = "", 'amplitude = "1 um"\n', 'path = "heights.npz"\n'
        text = text.replace(match[0], rng.choice((changed, changed, *others)), 1)
    return text


@cache
def good_scenes() -> tuple[str, ...]:
    """The scenes of verification/scenes, one with every key of the format, and small ones that solve at
    once.
    """
    folder = resources.files("verification").joinpath("scenes")
    shipped = sorted(path.name for path in folder.iterdir() if path.name.endswith(".toml"))
    texts = tuple(folder.joinpath(name).read_text(encoding="utf-8") for name in shipped)
    return (*texts, EVERY_KEY, PLASTIC, *hostile.SCENES)


def _scene(text: str | bytes, files: Mapping = ()) -> Laid:
    content = text if isinstance(text, bytes) else encoded(text)
    around = {"yield.csv": hostile.YIELD, "depth.csv": hostile.DEPTH, HEIGHTS: good_heights()}
    return {**around, **dict(files), SCENE: content}, SCENE


def _number(rng: random.Random) -> str:
    """A hostile number, or one of any size."""
    if rng.random() < 0.5:
        return rng.choice(NUMBERS)
    return f"{rng.choice(('', '-'))}{rng.random() * 10 ** rng.uniform(-32, 32):.{rng.randrange(1, 17)}g}"


def _value(rng: random.Random) -> str:
    return rng.choice((rng.choice(VALUES), _number(rng), f'"{_number(rng)} {rng.choice(UNITS)}"'))


def _with_value(rng: random.Random, text: str, value: str) -> str:
    lines = list(_LINE.finditer(text))
    if not lines:
        return text
    match = rng.choice(lines)
    return text[: match.start(2)] + value + text[match.end(2) :]


def _values(rng: random.Random) -> Laid:
    """One to three values replaced: other types, other numbers, what is no TOML."""
    text = rng.choice(good_scenes())
    for _ in range(rng.randint(1, 3)):
        text = _with_value(rng, text, _value(rng))
    return _scene(text)


def _units(rng: random.Random) -> Laid:
    """One to three quantities with another number or unit, right dimensions included."""
    text = rng.choice(good_scenes())
    for _ in range(rng.randint(1, 3)):
        found = [match for match in _STRING.finditer(text) if match[1][:1].isdigit()]
        if not found:
            break  # the last one has become none
        match = rng.choice(found)
        number, _, unit = match[1].partition(" ")
        changed = f"{_number(rng)} {unit}", f"{number} {rng.choice(UNITS)}"
        spaced = f"{number}{unit}", f" {number}  {unit} "
        text = text[: match.start(1)] + rng.choice((*changed, *spaced)) + text[match.end(1) :]
    return _scene(text)


def _extremes(rng: random.Random) -> Laid:
    """Good values of every size that the format allows, together."""
    text = rng.choice([text for text in good_scenes() if text is not EVERY_KEY])
    for match in reversed(list(_STRING.finditer(text))):
        if match[1][:1].isdigit() and rng.random() < 0.6:
            unit = match[1].partition(" ")[2]
            text = text[: match.start(1)] + f"{10 ** rng.uniform(-22, 20):.3g} {unit}" + text[match.end(1) :]
    if rng.random() < 0.3:
        text = re.sub(r"poisson = .*", f"poisson = {one_of(rng, '0|0.5|0.4999999|1e-300')}", text)
    if rng.random() < 0.2:
        text = re.sub(r"tolerance = .*", f"tolerance = {one_of(rng, '1e-14|0.1')}", text)
    return _scene(text)


def _keys(rng: random.Random) -> Laid:
    """Keys and tables that are unknown, misspelt, twice, missing, in another table, or nested deep."""
    lines = rng.choice(good_scenes()).splitlines()
    at, deep, edit = rng.randrange(len(lines)), rng.choice((50, 1_000, 20_000)), rng.randrange(9)
    if edit == 0:
        odd = "unknown", "Young", "title", '""', '"a b"', "é", "__class__", "x" * 9_000
        lines.insert(at, f"{rng.choice(odd)} = 1")
    elif edit == 1:
        lines.insert(at, lines[rng.randrange(len(lines))])
    elif edit == 2 and len(lines[at]) > 2:
        cut = rng.randrange(len(lines[at]) - 1)
        lines[at] = lines[at][:cut] + lines[at][cut + 1] + lines[at][cut] + lines[at][cut + 2 :]
    elif edit == 3:
        del lines[at : at + rng.choice((1, 1, 3, 10))]
    elif edit == 4:
        rng.shuffle(lines)
    elif edit == 5:
        lines.insert(at, ".".join("a" * deep) + " = 1")
    elif edit == 6:
        lines.insert(at, f"{one_of(rng, 'x|young|cells|title')} = {'[' * deep}{']' * rng.choice((deep, 0))}")
    elif edit == 7:
        dotted = ".".join("b" * deep)
        tables = ("x = " + "{a = " * deep, f"[{dotted}]", f"[[{dotted}]]", "[[body]]", "[loading]", "[body]")
        lines.insert(at, rng.choice(tables))
    else:
        lines[at:at] = [f"key{k} = {k}" for k in range(rng.choice((10, 2_000)))]
    return _scene("\n".join(lines))


def _bytes(rng: random.Random) -> Laid:
    """A scene cut short, with bits flipped or bytes put in, in another encoding, with very long lines."""
    text = rng.choice(good_scenes()).replace("steel", "stähl", 1)
    edit = rng.randrange(5)
    if edit == 0:
        codec = one_of(rng, "utf-16|utf-16-le|utf-32|latin-1|cp1252|utf-8-sig|utf-7|cp037")
        return _scene(text.encode(codec, "replace"))
    if edit == 1:
        ends = "\r\n", "\r", "\x0b", "\x00\n", "\u2028", "#" * 100_000 + "\n"
        return _scene(text.replace("\n", rng.choice(ends)))
    return _scene(mutated(rng, text.encode()))


def _sizes(rng: random.Random) -> Laid:
    """Grids, meshes and step counts of every size, and depths in any order."""
    whole, length, rows = hostile.WHOLE, hostile.LENGTHS, []
    few, many = (1, 2, 2, 2, 2, 3), (0, 1, 2, 3, 5, 2_000)
    if rng.random() < 0.7:
        rows.append(f"cells = [{', '.join(rng.choice(whole) for _ in range(rng.choice(few)))}]")
    for key, chance, counts in (("extent", 0.5, few), ("depths", 0.4, many)):
        if rng.random() < chance:
            rows.append(f"{key} = {json.dumps([rng.choice(length) for _ in range(rng.choice(counts))])}")
    if rng.random() < 0.4:
        rows.append(f"layers = {rng.choice(whole)}")
    if rng.random() < 0.4:
        rows.append(f'depth = "{rng.choice(length)}"')
    text = re.sub(r"(?ms)^\[(grid|fem)\].*?(?=^\[|\Z)", "", rng.choice(good_scenes()))
    if rng.random() < 0.4:
        text = re.sub(r"(steps|cycles) = \d+", lambda match: f"{match[1]} = {rng.choice(whole)}", text)
    fem = ""
    if rng.random() < 0.4:
        fem = f"[fem]\ncells_per_radius = {rng.choice(whole)}\nbox = {_number(rng)}\n"
    return _scene("\n".join([text, "[grid]", *rows, fem]))


def _paths(rng: random.Random) -> Laid:
    """A table of the scene outside its folder, behind a link, in a pipe or device, or with an impossible
    name.
    """
    place, key = rng.choice(PLACES), rng.choice(("file", "profile"))
    text = PLASTIC.replace('file = "yield.csv"', f"{key} = {toml_string(place)}")
    return _scene(text, {**AROUND, "pickle.npz": with_pickle()})


def _tables(rng: random.Random) -> Laid:
    """Yield tables with other columns, quotes, separators, numbers, lengths and encodings."""
    number, head = rng.choice(hostile.YIELD_NUMBERS), b"peeq,yield_stress_Pa\n"
    match rng.randrange(8):
        case 0:
            old = rng.choice((b"peeq", b"yield_stress_Pa", b","))
            content = hostile.YIELD.replace(
                old, rng.choice((b"x", b"", b";", b"peeq,", b"\t", b'"', b"\xff"))
            )
        case 1:
            content = hostile.YIELD.replace(rng.choice((b"0.01", b"1.2e9", b"1e9", b"2e9")), number.encode())
        case 2:
            count = rng.choice((0, 1, 9_999, 10_001, 100_000))
            content = head + b"".join(b"%d,1e9\n" % k for k in range(count))
        case 3:
            content = b"0.1,1e9\n" * rng.choice((1, 1_000_000))
        case 4:
            content = hostile.YIELD.decode().encode(rng.choice(hostile.CODECS))
        case 5:
            content = b'"' + b"x" * rng.choice((10, 200_000)) + rng.choice((b"", b'"\n'))
        case 6:
            content = head + b"0,1e9" + b"," * rng.choice((1, 500_000))
        case _:
            content = mutated(rng, hostile.YIELD)
    return _scene(PLASTIC, {"yield.csv": content})


def _titles(rng: random.Random) -> Laid:
    """A good scene with markup, escapes and control characters in its title."""
    title = json.dumps("".join(rng.choice(hostile.MARKUP) for _ in range(rng.randint(1, 3))))
    return _scene(SMALL.replace('"Small"', title.replace("\\ud83d\\ude00", "\\U0001f600")))


def _places(rng: random.Random) -> Laid:
    """A scene that is no file, is not there, or has an odd name."""
    places = "sub|pipe|link-out|link-loop|link-zero|/dev/zero|/dev/full|missing.toml|yield.csv/x.toml"
    name, odd = one_of(rng, places), rng.choice(hostile.NAMES)
    if rng.random() < 0.5 or len(odd) > 255:
        return AROUND, rng.choice((name, "x" * 5_000))
    return {**AROUND, odd: rng.choice(good_scenes()).encode()}, odd


def _approach(rng: random.Random) -> Laid:
    """An approach in place of the force, or beside it: of every size, and what is no length."""
    text, known = rng.choice([text for text in good_scenes() if _FORCE.search(text)]), hostile.APPROACHES
    value = rng.choice((*known, *(f'"{10 ** rng.uniform(-22, 20):.3g} m"' for _ in known)))
    if rng.random() < 0.3:
        value = _value(rng)
    kept = r"\g<0>\n" if rng.random() < 0.1 else ""
    return _scene(_FORCE.sub(lambda match: match.expand(kept) + f"approach = {value}", text))


def _mapping(rng: random.Random) -> Laid:
    """The mapping of a good mesh, with other values, paths and bytes."""
    text, edit = hostile.MAPPING, rng.randrange(5)
    if edit == 0:
        text = text.replace('"own.vtu"', toml_string(rng.choice(PLACES)))
    elif edit == 1:
        return with_mapping(mutated(rng, text.encode()).decode(errors="surrogateescape"), good_meshes())
    elif edit == 2:
        line = rng.choice(text.splitlines())
        others = "", f"{line}\n{line}", f"x{line}", "stress = ['p_Pa', 'x']"
        text = text.replace(line, rng.choice(others), 1)
    for _ in range(rng.randint(0, 2)):
        odd = rng.choice(VALUES), _number(rng), toml_string(rng.choice((*hostile.MARKUP, *UNITS)))
        text = _with_value(rng, text, rng.choice(odd))
    return with_mapping(text, good_meshes())


def _study(rng: random.Random) -> Laid:
    """A study with other values, keys, modes and bytes, of a scene that is good, bad or not there."""
    text = hostile.STUDY
    for _ in range(rng.choice((0, 1, 1, 2, 3))):
        match = rng.choice(list(re.finditer(r'(?<=")[^"\n]*(?=")|\w+|"[^"\n]*"|\{.*\}', text)))
        word, value, number = rng.choice(hostile.OF_STUDIES), rng.choice(VALUES), _number(rng)
        odd = word, value, number, toml_string(rng.choice(PLACES))
        text = text[: match.start()] + rng.choice(odd) + text[match.end() :]
    scene = rng.choice((SMALL, SMALL, SMALL, rng.choice(good_scenes()))).encode()
    made = mutated(rng, encoded(text)) if rng.random() < 0.1 else encoded(text)
    files = {HEIGHTS: good_heights(), SCENE: scene, "study.toml": made}
    return {**AROUND, **files}, "study.toml"


KINDS: dict[str, Generator] = {
    "values": _values,
    "units": _units,
    "extremes": _extremes,
    "keys": _keys,
    "bytes": _bytes,
    "sizes": _sizes,
    "paths": _paths,
    "surfaces": bad_surface,
    "tables": _tables,
    "titles": _titles,
    "places": _places,
    ARCHIVE: bad_archive,
    RUN: bad_run,
}
"""Name of a kind -> its generator."""
MORE_KINDS: dict[str, Generator] = {
    "approaches": _approach,
    MESHES: bad_mesh,
    MAPPINGS: _mapping,
    "matrices": bad_matrix,
    STUDIES: _study,
}
"""Kinds of negative numbers: the inputs of KINDS stay what they are."""
