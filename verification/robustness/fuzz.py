# SPDX-License-Identifier: MIT
"""Bad input on purpose: scenes, the files they name, archives and run folders, mutated from good ones by a
seed.

An input is a small folder: `bad_input(seed, number)` is the same on every machine, and `lay` writes it to
disk. Most inputs are wrong, some are odd but good; what a reader makes of them is the business of who calls.
"""

from __future__ import annotations

import json
import random
import re
from collections.abc import Callable, Mapping
from functools import cache
from importlib import resources

from verification.robustness.bad_files import (
    ARCHIVE,
    AROUND,
    RUN,
    SCENE,
    BadInput,
    bad_archive,
    bad_run,
    mutated,
    toml_string,
    with_pickle,
)
from verification.robustness.bad_meshes import GOOD, bad_mesh, good_meshes, with_mapping
from verification.robustness.bad_surfaces import bad_matrix, bad_surface, good_heights
from verification.robustness.hostile import (
    APPROACHES,
    DEPTH,
    EVERY_KEY,
    JUDGED,
    MARKUP,
    MOVING,
    NUMBERS,
    OF_STUDIES,
    ON_WAY,
    PLACES,
    PLASTIC,
    ROUGH,
    RUNNING_IN,
    SMALL,
    STUDY,
    UNITS,
    VALUES,
    WAVES,
    YIELD,
)

MESHES, MAPPINGS, STUDIES = "meshes", "mappings", "studies"
Generator = Callable[[random.Random, str], BadInput]
_FORCE = re.compile(r"(?m)^force = .+$")
_LINE = re.compile(r"(?m)^(\w+) = (.+)$")
_STRING = re.compile(r'"([^"\n]*)"')


@cache
def good_scenes() -> tuple[str, ...]:
    """The scenes of verification/scenes, one with every key of the format, and small ones that solve at
    once.
    """
    folder = resources.files("verification").joinpath("scenes")
    shipped = sorted(path.name for path in folder.iterdir() if path.name.endswith(".toml"))
    texts = tuple(folder.joinpath(name).read_text(encoding="utf-8") for name in shipped)
    return (*texts, EVERY_KEY, PLASTIC, JUDGED, SMALL, MOVING, ROUGH, WAVES, RUNNING_IN, ON_WAY)


def bad_input(seed: int, number: int) -> BadInput:
    """Input `number` of the series of `seed`; the kinds take turns, MORE_KINDS at negative numbers."""
    kinds = KINDS if number >= 0 else MORE_KINDS
    kind = tuple(kinds)[number % len(kinds)]
    return kinds[kind](random.Random(f"{seed}/{number}"), kind)


def _scene(text: str | bytes, kind: str, files: Mapping = ()) -> BadInput:
    content = text if isinstance(text, bytes) else text.encode("utf-8", "surrogatepass")
    return BadInput(
        kind,
        {
            "yield.csv": YIELD,
            "depth.csv": DEPTH,
            "heights.npz": good_heights(),
            **dict(files),
            SCENE: content,
        },
    )


def _number(rng: random.Random) -> str:
    """A hostile number, or one of any size."""
    if rng.random() < 0.5:
        return rng.choice(NUMBERS)
    return f"{rng.choice(('', '-'))}{rng.random() * 10 ** rng.uniform(-32, 32):.{rng.randrange(1, 17)}g}"


def _values(rng: random.Random, kind: str) -> BadInput:
    """One to three values replaced: other types, other numbers, what is no TOML."""
    text = rng.choice(good_scenes())
    for _ in range(rng.randint(1, 3)):
        text = _with_value(
            rng, text, rng.choice((rng.choice(VALUES), _number(rng), f'"{_number(rng)} {rng.choice(UNITS)}"'))
        )
    return _scene(text, kind)


def _units(rng: random.Random, kind: str) -> BadInput:
    """One to three quantities with another number or unit, right dimensions included."""
    text = rng.choice(good_scenes())
    for _ in range(rng.randint(1, 3)):
        found = [match for match in _STRING.finditer(text) if match[1][:1].isdigit()]
        if not found:
            break  # the last one has become none
        match = rng.choice(found)
        number, _, unit = match[1].partition(" ")
        replaced = rng.choice(
            (
                f"{_number(rng)} {unit}",
                f"{number} {rng.choice(UNITS)}",
                f"{number}{unit}",
                f" {number}  {unit} ",
            )
        )
        text = text[: match.start(1)] + replaced + text[match.end(1) :]
    return _scene(text, kind)


def _extremes(rng: random.Random, kind: str) -> BadInput:
    """Good values of every size that the format allows, together."""
    text = rng.choice([text for text in good_scenes() if text is not EVERY_KEY])
    for match in reversed(list(_STRING.finditer(text))):
        if match[1][:1].isdigit() and rng.random() < 0.6:
            unit = match[1].partition(" ")[2]
            text = text[: match.start(1)] + f"{10 ** rng.uniform(-22, 20):.3g} {unit}" + text[match.end(1) :]
    if rng.random() < 0.3:
        text = re.sub(r"poisson = .*", f"poisson = {rng.choice(('0', '0.5', '0.4999999', '1e-300'))}", text)
    if rng.random() < 0.2:
        text = re.sub(r"tolerance = .*", f"tolerance = {rng.choice(('1e-14', '0.1'))}", text)
    return _scene(text, kind)


def _with_value(rng: random.Random, text: str, value: str) -> str:
    lines = list(_LINE.finditer(text))
    if not lines:
        return text
    match = rng.choice(lines)
    return text[: match.start(2)] + value + text[match.end(2) :]


def _keys(rng: random.Random, kind: str) -> BadInput:
    """Keys and tables that are unknown, misspelt, twice, missing, in another table, or nested deep."""
    lines = rng.choice(good_scenes()).splitlines()
    at = rng.randrange(len(lines))
    deep = rng.choice((50, 1_000, 20_000))
    edit = rng.randrange(9)
    if edit == 0:
        lines.insert(
            at,
            rng.choice(("unknown", "Young", "title", '""', '"a b"', "é", "__class__", "x" * 9_000)) + " = 1",
        )
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
        lines.insert(
            at, f"{rng.choice(('x', 'young', 'cells', 'title'))} = {'[' * deep}{']' * rng.choice((deep, 0))}"
        )
    elif edit == 7:
        dotted = ".".join("b" * deep)
        tables = ("x = " + "{a = " * deep, f"[{dotted}]", f"[[{dotted}]]", "[[body]]", "[loading]", "[body]")
        lines.insert(at, rng.choice(tables))
    else:
        lines[at:at] = [f"key{k} = {k}" for k in range(rng.choice((10, 2_000)))]
    return _scene("\n".join(lines), kind)


def _bytes(rng: random.Random, kind: str) -> BadInput:
    """A scene cut short, with bits flipped or bytes put in, in another encoding, with very long lines."""
    text = rng.choice(good_scenes()).replace("steel", "stähl", 1)
    edit = rng.randrange(5)
    if edit == 0:
        codec = rng.choice(
            ("utf-16", "utf-16-le", "utf-32", "latin-1", "cp1252", "utf-8-sig", "utf-7", "cp037")
        )
        return _scene(text.encode(codec, "replace"), kind)
    if edit == 1:
        return _scene(
            text.replace("\n", rng.choice(("\r\n", "\r", "\x0b", "\x00\n", "\u2028", "#" * 100_000 + "\n"))),
            kind,
        )
    return _scene(mutated(rng, text.encode()), kind)


def _sizes(rng: random.Random, kind: str) -> BadInput:
    """Grids, meshes and step counts of every size, and depths in any order."""
    whole = (
        "1",
        "0",
        "-1",
        "2",
        "3",
        "4",
        "64",
        "129",
        "1025",
        "4097",
        "4098",
        "1000000000",
        "18446744073709551616",
        "65.0",
        "true",
        "nan",
    )
    length = ("0 um", "1 um", "24 um", "1e-30 m", "1e-12 m", "1e30 m", "-1 um", "1 km", "1e-9 um", "0.2 um")
    rows = []
    if rng.random() < 0.7:
        rows.append(
            f"cells = [{', '.join(rng.choice(whole) for _ in range(rng.choice((1, 2, 2, 2, 2, 3))))}]"
        )
    if rng.random() < 0.5:
        rows.append(
            f"extent = {json.dumps([rng.choice(length) for _ in range(rng.choice((1, 2, 2, 2, 2, 3)))])}"
        )
    if rng.random() < 0.4:
        rows.append(
            f"depths = {json.dumps([rng.choice(length) for _ in range(rng.choice((0, 1, 2, 3, 5, 2_000)))])}"
        )
    if rng.random() < 0.4:
        rows.append(f"layers = {rng.choice(whole)}")
    if rng.random() < 0.4:
        rows.append(f'depth = "{rng.choice(length)}"')
    text = re.sub(r"(?ms)^\[(grid|fem)\].*?(?=^\[|\Z)", "", rng.choice(good_scenes()))
    if rng.random() < 0.4:
        text = re.sub(r"(steps|cycles) = \d+", lambda match: f"{match[1]} = {rng.choice(whole)}", text)
    fem = (
        f"[fem]\ncells_per_radius = {rng.choice(whole)}\nbox = {_number(rng)}\n" if rng.random() < 0.4 else ""
    )
    return _scene("\n".join([text, "[grid]", *rows, fem]), kind)


def _paths(rng: random.Random, kind: str) -> BadInput:
    """A table of the scene outside its folder, behind a link, in a pipe or device, or with an impossible
    name.
    """
    place = rng.choice(PLACES)
    key = rng.choice(("file", "profile"))
    text = PLASTIC.replace('file = "yield.csv"', f"{key} = {toml_string(place)}")
    return _scene(text, kind, {**AROUND, "pickle.npz": with_pickle()})


def _tables(rng: random.Random, kind: str) -> BadInput:
    """Yield tables with other columns, quotes, separators, numbers, lengths and encodings."""
    number = rng.choice(
        (
            "nan",
            "inf",
            "-1",
            "1e400",
            "",
            "x",
            "1,5",
            '"',
            "0",
            "1e-320",
            "9" * 5_000,
            "\x00",
            "0x1p3",
            "1_0",
            "١",
        )
    )
    edit = rng.randrange(8)
    if edit == 0:
        content = YIELD.replace(
            rng.choice((b"peeq", b"yield_stress_Pa", b",")),
            rng.choice((b"x", b"", b";", b"peeq,", b"\t", b'"', b"\xff")),
        )
    elif edit == 1:
        content = YIELD.replace(rng.choice((b"0.01", b"1.2e9", b"1e9", b"2e9")), number.encode())
    elif edit == 2:
        content = b"peeq,yield_stress_Pa\n" + b"".join(
            b"%d,1e9\n" % k for k in range(rng.choice((0, 1, 9_999, 10_001, 100_000)))
        )
    elif edit == 3:
        content = b"0.1,1e9\n" * rng.choice((1, 1_000_000))
    elif edit == 4:
        content = YIELD.decode().encode(rng.choice(("utf-16", "utf-8-sig", "utf-32", "cp037")))
    elif edit == 5:
        content = b'"' + b"x" * rng.choice((10, 200_000)) + rng.choice((b"", b'"\n'))
    elif edit == 6:
        content = b"peeq,yield_stress_Pa\n" + b"0,1e9" + b"," * rng.choice((1, 500_000))
    else:
        content = mutated(rng, YIELD)
    return _scene(PLASTIC, kind, {"yield.csv": content})


def _titles(rng: random.Random, kind: str) -> BadInput:
    """A good scene with markup, escapes and control characters in its title."""
    title = "".join(rng.choice(MARKUP) for _ in range(rng.randint(1, 3)))
    return _scene(
        SMALL.replace(
            '"Small"', json.dumps(title, ensure_ascii=True).replace("\\ud83d\\ude00", "\\U0001f600")
        ),
        kind,
    )


def _places(rng: random.Random, kind: str) -> BadInput:
    """A scene that is no file, is not there, or has an odd name."""
    name = rng.choice(
        (
            "sub",
            "pipe",
            "link-out",
            "link-loop",
            "link-zero",
            "/dev/zero",
            "/dev/full",
            "missing.toml",
            "yield.csv/x.toml",
        )
    )
    odd = rng.choice(
        (
            "a b.toml",
            "-x.toml",
            "é.toml",
            "[red].toml",
            "\x1b[31m.toml",
            "x\ny.toml",
            "\udcff.toml",
            "x" * 250,
            "x" * 5_000,
            ".toml",
            "$.toml",
        )
    )
    if rng.random() < 0.5 or len(odd) > 255:
        return BadInput(kind, AROUND, rng.choice((name, "x" * 5_000)))
    return BadInput(kind, {**AROUND, odd: rng.choice(good_scenes()).encode()}, odd)


def _approach(rng: random.Random, kind: str) -> BadInput:
    """An approach in place of the force, or beside it: of every size, and what is no length."""
    text = rng.choice([text for text in good_scenes() if _FORCE.search(text)])
    value = rng.choice((*APPROACHES, *(f'"{10 ** rng.uniform(-22, 20):.3g} m"' for _ in APPROACHES)))
    if rng.random() < 0.3:
        value = rng.choice((rng.choice(VALUES), _number(rng), f'"{_number(rng)} {rng.choice(UNITS)}"'))
    kept = r"\g<0>\n" if rng.random() < 0.1 else ""
    return _scene(_FORCE.sub(lambda match: match.expand(kept) + f"approach = {value}", text), kind)


def _mapping(rng: random.Random, kind: str) -> BadInput:
    """The mapping of a good mesh, with other values, paths and bytes."""
    text = GOOD
    edit = rng.randrange(5)
    if edit == 0:
        text = text.replace('"own.vtu"', toml_string(rng.choice(PLACES)))
    elif edit == 1:
        return with_mapping(kind, mutated(rng, text.encode()).decode(errors="surrogateescape"), good_meshes())
    elif edit == 2:
        line = rng.choice(text.splitlines())
        text = text.replace(
            line, rng.choice(("", f"{line}\n{line}", f"x{line}", "stress = ['p_Pa', 'x']")), 1
        )
    for _ in range(rng.randint(0, 2)):
        hostile = rng.choice(VALUES), _number(rng), toml_string(rng.choice((*MARKUP, *UNITS)))
        text = _with_value(rng, text, rng.choice(hostile))
    return with_mapping(kind, text, good_meshes())


def _study(rng: random.Random, kind: str) -> BadInput:
    """A study with other values, keys, modes and bytes, of a scene that is good, bad or not there."""
    text = STUDY
    for _ in range(rng.choice((0, 1, 1, 2, 3))):
        match = rng.choice(list(re.finditer(r'(?<=")[^"\n]*(?=")|\w+|"[^"\n]*"|\{.*\}', text)))
        hostile = rng.choice(OF_STUDIES), rng.choice(VALUES), _number(rng), toml_string(rng.choice(PLACES))
        text = text[: match.start()] + rng.choice(hostile) + text[match.end() :]
    content = text.encode("utf-8", "surrogatepass")
    scene = rng.choice((SMALL, SMALL, SMALL, rng.choice(good_scenes()))).encode()
    made = mutated(rng, content) if rng.random() < 0.1 else content
    return BadInput(
        kind, {**AROUND, "heights.npz": good_heights(), SCENE: scene, "study.toml": made}, "study.toml"
    )


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
