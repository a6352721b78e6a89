# SPDX-License-Identifier: MIT
"""Bad input on purpose: scenes, the files they name, surfaces, meshes, archives and run folders, mutated from
good ones by a seed.

An input is a small folder: `bad_input(seed, number)` is the same on every machine, and `lay` writes it to
disk. Most inputs are wrong, some are odd but good; what a reader makes of them is the business of who calls.
"""

import io
import json
import os
import random
import re
import zipfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache, partial
from importlib import resources
from pathlib import Path

import numpy as np

from sam.scene import GridFields, Result, Status
from verification.robustness import hostile
from verification.robustness.hostile import NUMBERS, PLACES, PLASTIC, ROUGH, SMALL, UNITS, VALUES, WHOLE
from verification.runs.archive import DIGEST, VALUES as VALUES_JSON, digest_of
from verification.runs.meshes import READABLE, as_pyvista, mesh_files

SCENE, MAPPING, HEIGHTS, TABLE = "scene.toml", "own.toml", "heights.npz", "heights.csv"
ARCHIVE, RUN, MESHES, MAPPINGS, STUDIES = "archive", "run", "meshes", "mappings", "studies"
BOMB_BYTES = 1 << 26
VALUE = re.compile(r"(?m)(?<== ).+$")
QUANTITY = re.compile(r'(?<=")(\d[^"\s]*) ?([^"\n]*)(?=")')
LINE = re.compile(r"(?m)^.*\n")
CELL = re.compile(r"[^,;\s]+")
TOKEN = re.compile(r'(?<=")[^"\n]*(?=")|\w+|"[^"\n]*"|\{.*\}')
COUNT = re.compile(r"\b\d+\b")


File = bytes | str
"""The content of a file, or what is no ordinary one: "pipe", "folder", or the target of a link."""


@dataclass(frozen=True)
class BadInput:
    """kind: of KINDS; files: path -> content; name: what a reader is given, in the folder or absolute."""

    kind: str
    files: Mapping[str, File]
    name: str


Laid = tuple[Mapping[str, File], str]
"""Files and name of an input."""
Generator = Callable[[random.Random], Laid]
AROUND: Mapping[str, File] = {
    "yield.csv": hostile.YIELD,
    "depth.csv": hostile.DEPTH,
    "sub": "folder",
    "pipe": "pipe",
    "link-out": "/etc/passwd",
    "link-loop": "link-loop",
    "link-in": "yield.csv",
    "link-zero": "/dev/zero",
}
"""What lies in the folder of a scene whose paths are attacked."""
ODD = ("pipe", "folder", "/dev/zero", "/etc/passwd", "nowhere")
"""In place of a file."""


def bad_input(seed: int, number: int) -> BadInput:
    """Input `number` of the series of `seed`; the kinds take turns."""
    kind = TURNS[number % len(TURNS)]
    return BadInput(kind, *KINDS[kind](random.Random(f"{seed}/{number}")))


def lay(bad: BadInput, folder: Path) -> Path:
    """Write the files of an input into an empty folder, and return the path that a reader is given."""
    for name, content in bad.files.items():
        path = folder / os.fsdecode(name.encode(errors="surrogateescape"))  # bytes of UTF-8 in every language
        path.parent.mkdir(parents=True, exist_ok=True)
        if isinstance(content, bytes):
            path.write_bytes(content)
        elif content == "folder":
            path.mkdir()
        elif content != "pipe":
            path.symlink_to(content)
        elif hasattr(os, "mkfifo"):
            os.mkfifo(path)
    return folder / bad.name


def replaced(
    rng: random.Random, text: str, pattern: re.Pattern, word: Callable[[re.Match], str], *, most: int = 3
) -> str:
    """A text in which, one to `most` times, something that matches a pattern is another word."""
    for _ in range(rng.randint(1, most)):
        if found := list(pattern.finditer(text)):
            match = rng.choice(found)
            text = text[: match.start()] + word(match) + text[match.end() :]
    return text


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


def npz(members: Mapping[str, np.ndarray | bytes], packing: int = zipfile.ZIP_STORED) -> bytes:
    """An npz file of arrays, or of members whose bytes are given."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as target:
        for name, content in members.items():
            member = content if isinstance(content, bytes) else npy(content)
            target.writestr(zipfile.ZipInfo(f"{name}.npy"), member, packing)
    return stream.getvalue()


def npy(array: np.ndarray, *, objects: bool = False) -> bytes:
    """A member of an npz file."""
    member = io.BytesIO()
    np.lib.format.write_array(member, array, allow_pickle=objects)
    return member.getvalue()


def lying_header(rng: random.Random) -> bytes:
    """An npy member whose header lies."""
    kind = rng.choice(("<f8", "|O", "<U999999999", "x", "<f8, <f8", "|V0", ">c16"))
    text = f"{{'descr': '{kind}', 'fortran_order': False, 'shape': {rng.choice(hostile.SHAPES)}, }}".encode()
    version = rng.choice((b"\x01\x00", b"\x02\x00", b"\x03\x00", b"\x09\x09"))
    return b"\x93NUMPY" + version + len(text).to_bytes(2, "little") + text


class Trap:
    """What a reader that unpickles would run: it makes the file `sprung` beside itself."""

    def __reduce__(self):
        return os.mkdir, ("sprung",)


@cache
def with_pickle() -> bytes:
    """An npz file with an array of objects whose unpickling makes a folder in the current one."""
    trap = npy(np.array([Trap()], dtype=object), objects=True)
    return npz({"x_m": trap, "y_m": np.zeros(3), "height_m": np.zeros((3, 3))})


@cache
def bomb(shape: tuple[int, ...]) -> bytes:
    """An npz file of a few kB whose heights, said to have that shape, unpack to BOMB_BYTES."""
    member = io.BytesIO()
    np.lib.format.write_array_header_1_0(member, {"descr": "<f8", "fortran_order": False, "shape": shape})
    heights = member.getvalue() + bytes(BOMB_BYTES)
    return npz({**_arrays(), "height_m": heights}, zipfile.ZIP_DEFLATED)


def bad_npz(rng: random.Random, arrays: Mapping[str, np.ndarray]) -> bytes:
    """A container that is damaged, lies about its members, holds what it must not, or odd arrays."""
    name, content = rng.choice(tuple(arrays)), bytearray(npz(arrays))
    match rng.randrange(8):
        case 0:
            return with_pickle()
        case 1:
            return npz({**arrays, name: lying_header(rng)})
        case 2:
            return bomb(rng.choice(((12, 10), (BOMB_BYTES // 8,), (1 << 13, 1 << 10), (1 << 40, 1 << 20))))
        case 3:
            at = content.rfind(b"PK\x01\x02") + 20  # sizes of the last member in the directory
            return bytes(content[:at]) + rng.randbytes(8) + bytes(content[at + 8 :])
        case 4:
            names = rng.choice(("x_m", "x_m y_m", "x_m y_m height_m extra", "", "x y z"))
            return npz({each: np.arange(3.0) for each in names.split()})
        case 5 | 6:
            return npz({**arrays, name: odd_array(rng, arrays[name])})
    return mutated(rng, bytes(content))


def odd_array(rng: random.Random, array: np.ndarray) -> np.ndarray:
    """Of other values, another shape, type or order."""
    array, at = array.copy(), rng.randrange(array.size)
    numbers = array.dtype.kind == "f"
    match rng.randrange(5):
        case 0 if numbers:
            array.flat[at] = rng.choice((np.nan, np.inf, -np.inf, 1e308, -1e300, 1e31))
        case 1 if numbers:
            array.flat[at] += rng.choice((1e-12, 1e-9, 1e-7, 1e-3, 1e20))
        case 2 if numbers:
            array = array * rng.choice((0.0, 1e-300, 1e-25, 1e25, 1e300, -1.0))
        case 3 if numbers:
            array = array.astype(rng.choice("<f4|>f8|<i8|<f2|?|<c16|<U9|S3|<M8[s]|>i2".split("|")))
        case _:
            some = array[:1], array[:2], array[:0], array[::-1], array[None], np.asfortranarray(array)
            array = rng.choice((*some, np.repeat(array, 2, axis=0)))
    return np.asarray(array)


def bad_table(rng: random.Random, good: bytes, numbers: tuple[str, ...]) -> bytes:
    """A table of text with other cells, separators, rows, lengths, encodings or bytes."""
    text, many = good.decode(), 1 + 3_000_000 // len(good)
    head, _, rest = text.partition("\n")
    match rng.randrange(7):
        case 0:
            text = replaced(rng, text, CELL, lambda _: rng.choice(numbers))
        case 1:
            old = rng.choice((",", "\n", *head.split(",")))
            text = text.replace(old, rng.choice(("", ";", "\t", '"', ",,", "\r\n", "x", "x,y")))
        case 2:
            odd = "", "\n", "1,2\n", "1,2,3,4\n", "," * 100_000 + "\n", "# x\n", '"' + "x" * 200_000
            text = replaced(rng, text, LINE, lambda match: rng.choice((*odd, match[0] * 2)))
        case 3:
            text = rng.choice((f"{head}\n", "")) + rest * rng.choice((0, 1, many))
        case 4:
            rows = rest.splitlines(keepends=True)
            text = f"{head}\n" + "".join(rng.sample(rows, len(rows)))
        case 5:
            return text.encode(rng.choice(hostile.CODECS))
        case _:
            return mutated(rng, good)
    return text.encode(errors="surrogatepass")


def _archive(rng: random.Random) -> Laid:
    """An archive that is damaged, or none, or whose values are."""
    arrays = {"a": np.arange(24.0).reshape(4, 6), "b": np.array(["x", "yy"])}
    arrays[VALUES_JSON] = np.frombuffer(json.dumps({"x": [1, None, "é"]}).encode(), dtype=np.uint8)
    arrays[DIGEST] = digest_of(arrays)
    odd = {VALUES_JSON: np.frombuffer(rng.choice(hostile.JSON), dtype=np.uint8)}
    files = {**AROUND, ARCHIVE: npz(odd) if rng.random() < 0.2 else bad_npz(rng, arrays)}
    return files, ARCHIVE if rng.random() < 0.8 else rng.choice(PLACES)


def _run(rng: random.Random) -> Laid:
    """The folder of a run whose summary or tables are damaged, of another version, or no files."""
    summary, table = f"{RUN}/summary.json", f"{RUN}/history.csv"
    good = {"format": "samfem run 1", "status": "converged", "model": "sam", "scene": {}}
    text, history = json.dumps(good | {"quantities": {"force_N": 1.0}}).encode(), b"cycle,step\n1,1\n1,2\n"
    odd = (
        {summary: mutated(rng, text)},
        {summary: rng.choice(hostile.JSON)},
        {table: rng.choice(hostile.HISTORIES)},
        {rng.choice((summary, table)): rng.choice(ODD)},
        {table: bad_table(rng, history, hostile.CELLS)},
    )
    return {summary: text, table: history, **rng.choice(odd)}, rng.choice((RUN,) * 8 + (table, *PLACES[:2]))


def with_mapping(text: bytes, files: Mapping[str, File]) -> Laid:
    """A mapping beside a scene and files."""
    return {**AROUND, SCENE: SMALL.encode(), MAPPING: text, **files}, MAPPING


def _mesh(rng: random.Random) -> Laid:
    """A mesh that is damaged, lies about its sizes, names others elsewhere, or is none."""
    name = f"own{rng.choice(('.vtu', '.vtk', '.vtr'))}"
    good = good_meshes()[name]
    content: File = good
    match rng.randrange(6):
        case 0:
            content = mutated(rng, good)
        case 1:  # a number of the first lines, which say how much of what there is
            head = replaced(rng, good[:2_000].decode("latin-1"), COUNT, lambda _: rng.choice(NUMBERS), most=1)
            content = head.encode("latin-1") + good[2_000:]
        case 2:
            others = "own.vtu", "sub/own.vtu", "../own.vtu", "own.pvd", "own.vtm", "own.case"
            place, ending = rng.choice((*PLACES, *others)), rng.choice((".pvd", ".vtm", ".pvtu", ".case"))
            part = f"<DataSet file={toml_string(place)}/>"
            xml = f'<VTKFile type="Collection"><Collection>{part}</Collection></VTKFile>'
            case = f"FORMAT\ntype: ensight gold\nGEOMETRY\nmodel: 1 {place}\n"
            name, content = f"own{ending}", encoded(case if ending == ".case" else xml)
        case 3:
            start = rng.choice((*hostile.MAGIC, good[:300]))
            content = start + rng.randbytes(rng.choice((0, 1, 189, 5_000)))
            name = f"own{rng.choice((*READABLE, *hostile.NOT_READ))}"
        case 4:
            content = rng.choice(ODD)
        case _:
            name = f"own{rng.choice(READABLE)}"  # the ending of another format
    text = hostile.MAPPING.replace('"own.vtu"', toml_string(name))
    return with_mapping(encoded(text), {**good_meshes(), name: content})


@cache
def good_meshes() -> dict[str, bytes]:
    """A plane below the contact of SMALL, in three formats."""
    from vtkmodules.vtkIOLegacy import vtkDataSetWriter

    x, z = np.linspace(-6e-5, 6e-5, 25), np.linspace(0.0, 6e-5, 13)
    p = np.where(z == 0.0, 1.0, 0.0) * np.sqrt(np.maximum(1.0 - (x[:, None] / 1.5e-5) ** 2, 0.0)) * 1e9
    moved = 1e-16 * np.stack([p[:, None]] * 3)
    fields = {"p_Pa": p[:, None], "mises_Pa": 0.5 * p[:, None], "displacement_m": moved}
    plane = GridFields(x, np.zeros(1), z, fields, {})
    grids = {"peak": {"plane": plane, "surface": plane}}
    legacy = vtkDataSetWriter()
    legacy.SetInputData(as_pyvista(plane))
    legacy.WriteToOutputStringOn()
    legacy.Write()
    text = legacy.GetOutputString().encode()
    made = mesh_files(Result("sam", Status.CONVERGED, {}, {}, grids=grids), 1)
    return {"own.vtu": made["fields.vtu"], "own.vtr": made["surface.vtr"], "own.vtk": text}


def _surface(rng: random.Random) -> Laid:
    """A rough scene with heights that are damaged, or with holes, and keys that say what is done to them."""
    arrays, lines = _arrays(), ""
    if rng.random() < 0.5:
        content = bad_npz(rng, arrays)
    else:
        arrays["height_m"].flat[rng.sample(range(120), rng.choice((0, 0, 0, 1, 30, 60, 61, 120)))] = np.nan
        content = npz(arrays)
        words = {key: rng.choice(values) for key, values in hostile.PROCESSING.items()}
        lines = "".join(f"{key} = {word}\n" for key, word in words.items() if rng.random() < 0.5)
        lines += rng.choice(("", "[grid]\ncells = [12, 10]\n", "[grid]\ncells = [4097, 3]\n"))
    return _scene(ROUGH + lines, {HEIGHTS: content})


def _matrix(rng: random.Random) -> Laid:
    """Heights as laboratories export them: a matrix alone, or x, y and z in other units, good and bad."""
    rows = [[f"{value:.6g}" for value in row] for row in 1e9 * _arrays()["height_m"].T]
    if rng.random() < 0.3:
        places = [[str(x), str(y), z] for y, row in enumerate(rows) for x, z in enumerate(row)]
        rows = [["x_um", "y_um", "z_um"], *places]
    between = rng.choice((",", ";", "\t", " ", "  ", ", "))
    heads = "", "", "", "# nm\n", "x,y,z\n", "\ufeff", "1\n", "[Header]\nWidth=10 um\n\n"
    text = rng.choice(heads) + "\n".join(map(between.join, rows)) + "\n"
    text = text.replace(".", ",") if between != "," and rng.random() < 0.2 else text
    content = text.encode() if rng.random() < 0.4 else bad_table(rng, text.encode(), hostile.CELLS)
    ending = rng.choice((".csv", ".txt", ".npy", ".asc", ".dat"))
    if ending == ".npy":
        kinds = "<f8", "<f4", ">f8", "<i8", "<c16", "?", "|O", "<U9"
        values = _arrays()["height_m"].astype(rng.choice(kinds))  # an object is refused
        content = rng.choice((npy(values, objects=True), lying_header(rng)))
    right, some = hostile.MATRIX_KEYS[:2], rng.sample(hostile.MATRIX_KEYS, rng.randrange(3))
    text = ROUGH.replace(HEIGHTS, f"heights{ending}") + "\n".join(rng.choice((right, some)))
    return _scene(text, {f"heights{ending}": content})


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
def shipped(ending: str) -> dict[str, bytes]:
    """The files of verification/scenes whose name ends so."""
    paths = sorted(resources.files("verification").joinpath("scenes").iterdir(), key=lambda path: path.name)
    return {path.name: path.read_bytes() for path in paths if path.name.endswith(ending)}


@cache
def good_scenes() -> tuple[str, ...]:
    """The shipped scenes, and small ones that solve at once or have other keys."""
    return (*(content.decode() for content in shipped(".toml").values()), *hostile.SCENES)


def _scene(text: str | bytes, files: Mapping[str, File] = {}) -> Laid:
    """A scene with the files that good scenes name, or others in their place, and what lies around."""
    content = text if isinstance(text, bytes) else encoded(text)
    around = {**AROUND, HEIGHTS: good_heights(), "pickle.npz": with_pickle()}
    return {**around, **shipped(".csv"), **files, SCENE: content}, SCENE


def _number(rng: random.Random) -> str:
    """A hostile number, or one of any size."""
    if rng.random() < 0.5:
        return rng.choice(NUMBERS)
    return f"{rng.choice(('', '-'))}{rng.random() * 10 ** rng.uniform(-32, 32):.{rng.randrange(1, 17)}g}"


def hostile_word(rng: random.Random, good: str) -> str:
    """In place of a good value: one of its sort that is too much, or of any other sort."""
    number = _number(rng)
    words = [rng.choice(VALUES), number, f'"{number} {rng.choice(UNITS)}"']
    if quantity := QUANTITY.search(good):
        value, unit = quantity.groups()
        words += [f'"{number} {unit}"', f'"{value} {rng.choice(UNITS)}"', f'" {value}  {unit} "']
        words += [f'"{value}{unit}"', _extreme(rng, quantity)]
    elif good.startswith('"'):
        some = "".join(rng.choice(hostile.MARKUP) for _ in range(rng.randint(1, 3)))
        words += [toml_string(each) for each in (rng.choice(PLACES), rng.choice(UNITS), some)]
    if good.startswith("["):
        many, sort = rng.choice((0, 1, 2, 2, 2, 3, 2_000)), rng.choice((WHOLE, hostile.LENGTHS))
        words += [f"[{', '.join(rng.choices(sort, k=many))}]"] * 3
    return rng.choice(words)


def _extreme(rng: random.Random, quantity: re.Match) -> str:
    """The quantity, of any size."""
    return f'"{10 ** rng.uniform(-22, 20):.3g} {quantity[2]}"'


def odd_values(rng: random.Random, text: str) -> bytes:
    """Values of another type, unit or size; or many quantities of every size together."""

    def extreme(found: re.Match) -> str:
        return _extreme(rng, found)[1:-1] if rng.random() < 0.6 else found[0]

    if rng.random() < 0.2:
        return encoded(QUANTITY.sub(extreme, text))
    return encoded(replaced(rng, text, VALUE, lambda found: hostile_word(rng, found[0])))


def odd_lines(rng: random.Random, text: str) -> bytes:
    """Keys and tables that are unknown, misspelt, twice, missing, in another table, or nested deep."""
    deep = rng.choice((50, 1_000, 20_000))
    dotted, opened = ".".join("b" * deep), "[" * deep
    names = "unknown", "Young", "title", '""', '"a b"', "é", "__class__", "x" * 9_000, dotted
    brackets = rng.choice((opened, opened + "]" * deep, "{a = " * deep))
    tables = f"[{dotted}]", f"[[{dotted}]]", "[[body]]", "[loading]", "[body]"

    def other(match: re.Match) -> str:
        line, at = match[0], rng.randrange(len(match[0]))
        swapped = line[:at] + line[at : at + 2][::-1] + line[at + 2 :]
        many = "".join(f"key{k} = {k}\n" for k in range(rng.choice((10, 2_000))))
        more = f"{rng.choice(names)} = 1\n", f"x = {brackets}\n", f"{rng.choice(tables)}\n", many
        return rng.choice(("", line * 2, swapped, rng.choice(more) + line))

    text = replaced(rng, text, LINE, other)
    lines = text.splitlines(keepends=True)
    return encoded("".join(rng.sample(lines, len(lines))) if rng.random() < 0.1 else text)


def odd_bytes(rng: random.Random, text: str) -> bytes:
    """A text cut short, with bits flipped or bytes put in, in another encoding, with very long lines."""
    text = text.replace("steel", "stähl", 1)
    match rng.randrange(5):
        case 0:
            codecs = "utf-16", "utf-16-le", "utf-32", "latin-1", "cp1252", "utf-8-sig", "utf-7", "cp037"
            return text.encode(rng.choice(codecs), "replace")
        case 1:
            ends = "\r\n", "\r", "\x0b", "\x00\n", "\u2028", "#" * 100_000 + "\n"
            return text.replace("\n", rng.choice(ends)).encode()
    return mutated(rng, text.encode())


def odd_text(rng: random.Random, text: str) -> bytes:
    """A text as it is, or wrong in one of these ways."""
    return rng.choice((odd_values, odd_lines, odd_bytes, lambda _, good: encoded(good)))(rng, text)


def _of_scene(change: Callable[[random.Random, str], bytes], rng: random.Random) -> Laid:
    return _scene(change(rng, rng.choice(good_scenes())))


def _tables(rng: random.Random) -> Laid:
    """Tables with other columns, quotes, separators, numbers, lengths and encodings."""
    if rng.random() < 0.5:
        return _scene(PLASTIC, {"yield.csv": bad_table(rng, hostile.YIELD, hostile.CELLS)})
    heights = bad_table(rng, table(), (*hostile.CELLS, *hostile.HEADS))
    return _scene(ROUGH.replace(HEIGHTS, TABLE), {TABLE: heights})


def _places(rng: random.Random) -> Laid:
    """A scene that is no file, is not there, or has an odd name."""
    if rng.random() < 0.5:
        return AROUND, rng.choice(PLACES)
    name = rng.choice(hostile.NAMES)
    return {**AROUND, name: rng.choice(good_scenes()).encode()}, name


def _mapping(rng: random.Random) -> Laid:
    """The mapping of a good mesh, as it is or with other values, paths, lines and bytes."""
    return with_mapping(odd_text(rng, hostile.MAPPING), good_meshes())


def _study(rng: random.Random) -> Laid:
    """A study with other words, values, lines and bytes, of a scene that is good, bad or not there."""
    text = hostile.STUDY
    if rng.random() < 0.5:
        text = replaced(rng, text, TOKEN, lambda _: rng.choice(hostile.OF_STUDIES))
    scene, name = rng.choice((SMALL, SMALL, SMALL, rng.choice(good_scenes()))), "study.toml"
    files, _ = _scene(scene)
    return {**files, name: odd_text(rng, text)}, name


KINDS: dict[str, Generator] = {
    "values": partial(_of_scene, odd_values),
    "keys": partial(_of_scene, odd_lines),
    "bytes": partial(_of_scene, odd_bytes),
    "surfaces": _surface,
    "tables": _tables,
    "places": _places,
    ARCHIVE: _archive,
    RUN: _run,
    MESHES: _mesh,
    MAPPINGS: _mapping,
    "matrices": _matrix,
    STUDIES: _study,
}
"""Name of a kind -> its generator."""
TURNS = (*KINDS, *["values"] * 5)
"""The values of a scene are most of what can be wrong."""
