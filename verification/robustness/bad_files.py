# SPDX-License-Identifier: MIT
"""Files that are bad on purpose: what an input is and how it is laid out, archives, run folders, and bytes
mutated.
"""

from __future__ import annotations

import io
import json
import os
import pickle
import random
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Literal

import numpy as np

from verification.robustness.hostile import DEPTH, YIELD
from verification.runs.archive import DIGEST, VALUES, digest_of

SCENE = "scene.toml"
ARCHIVE, RUN = "archive", "run"


@dataclass(frozen=True)
class Special:
    """What is no ordinary file: a named pipe, a folder, or a link to `target`."""

    what: Literal["pipe", "folder", "link"]
    target: str = ""


@dataclass(frozen=True)
class BadInput:
    """kind: of KINDS; files: path in the folder -> content; name: what a reader is given, in the folder or
    absolute.
    """

    kind: str
    files: Mapping[str, bytes | Special] = field(default_factory=dict)
    name: str = SCENE


AROUND: Mapping[str, bytes | Special] = {
    "yield.csv": YIELD,
    "depth.csv": DEPTH,
    "sub": Special("folder"),
    "pipe": Special("pipe"),
    "link-out": Special("link", "/etc/passwd"),
    "link-loop": Special("link", "link-loop"),
    "link-in": Special("link", "yield.csv"),
    "link-zero": Special("link", "/dev/zero"),
}
"""What lies in the folder of a scene whose paths are attacked."""


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
                odd = (
                    b"\x00",
                    b"\xff",
                    b"\xed\xa0\x80",
                    b"\xef\xbb\xbf",
                    b"\x1b[31m",
                    b"\x1a",
                    b"\x80",
                    b"\xf4\x90\x80\x80",
                    b"\x7f",
                    b"'",
                    b'"',
                )
                content[at:at] = rng.choice(odd) * rng.choice((1, 1, 1_000))
            case 3:
                content[at:at] = content[at : at + rng.randrange(200)]
            case 4:
                del content[at : at + rng.randrange(40)]
    return bytes(content)


def toml_string(text: str) -> str:
    """A TOML string; control characters as escapes, which TOML allows only for some."""
    return json.dumps(text, ensure_ascii=any("\ud800" <= c <= "\udfff" for c in text))


def bad_archive(rng: random.Random, kind: str) -> BadInput:
    """An npz file with flipped bits, pickles, absurd shapes, odd values, or none at all."""
    arrays = {"a": np.arange(24.0).reshape(4, 6), "b": np.array(["x", "yy"])}
    arrays[VALUES] = np.frombuffer(json.dumps({"x": [1, None, "é"]}).encode(), dtype=np.uint8)
    good = npz({**arrays, DIGEST: digest_of(arrays)})
    edit = rng.randrange(6)
    if edit == 0:
        return BadInput(kind, {ARCHIVE: with_pickle()}, ARCHIVE)
    if edit == 1:
        return BadInput(kind, {ARCHIVE: npz({"a": lying_header(rng)}, {})}, ARCHIVE)
    if edit == 2:
        text = rng.choice((b"", b"[]", b"{", b"\xff", b"null", b"[" * 100_000, b'{"a": NaN}', b"9" * 5_000))
        return BadInput(
            kind, {ARCHIVE: npz({"values.json": np.frombuffer(text, dtype=np.uint8)}, None)}, ARCHIVE
        )
    if edit == 3:
        return BadInput(
            kind,
            AROUND,
            rng.choice(
                ("sub", "pipe", "link-zero", "link-loop", "missing", "yield.csv", "x" * 5_000, "a\0b")
            ),
        )
    return BadInput(kind, {ARCHIVE: mutated(rng, good)}, ARCHIVE)


def lying_header(rng: random.Random) -> bytes:
    """An npy member whose header lies."""
    shape = rng.choice(
        (
            "(1000000000000,)",
            "(-1,)",
            "(2, 3",
            "()" * 20_000,
            "(" * 5_000,
            "(1,)",
            "(1.5,)",
            "(9999999999999999999999,)",
            "'",
        )
    )
    kind = rng.choice(("<f8", "|O", "<U999999999", "x", "<f8, <f8", "|V0", ">c16"))
    text = f"{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}".encode()
    return (
        b"\x93NUMPY"
        + rng.choice((b"\x01\x00", b"\x02\x00", b"\x03\x00", b"\x09\x09"))
        + len(text).to_bytes(2, "little")
        + text
    )


def npz(members: Mapping[str, np.ndarray | bytes], values: Mapping | None = None) -> bytes:
    """An npz file of arrays, or of members whose bytes are given, and of values as an archive holds them."""
    stream = io.BytesIO()
    if values is not None:
        members = {**members, "values.json": np.frombuffer(json.dumps(values).encode(), dtype=np.uint8)}
    with zipfile.ZipFile(stream, "w") as target:
        for name, content in members.items():
            if not isinstance(content, bytes):
                member = io.BytesIO()
                np.lib.format.write_array(member, content, allow_pickle=False)
                content = member.getvalue()
            target.writestr(zipfile.ZipInfo(f"{name}.npy"), content)
    return stream.getvalue()


class Trap:
    """What a reader that unpickles would run: it makes the file `sprung` beside itself."""

    def __reduce__(self):
        return os.mkdir, ("sprung",)


@cache
def with_pickle() -> bytes:
    """An npz file with an array of objects whose unpickling makes a folder in the current one."""
    stream = io.BytesIO()
    np.lib.format.write_array_header_1_0(stream, {"descr": "|O", "fortran_order": False, "shape": (1,)})
    return npz(
        {"x_m": stream.getvalue() + pickle.dumps([Trap()]), "y_m": np.zeros(3), "height_m": np.zeros((3, 3))},
        {},
    )


def bad_run(rng: random.Random, kind: str) -> BadInput:
    """The folder of a run whose summary or tables are damaged, of another version, or no files."""
    summary = {
        "format": "samfem run 1",
        "status": "converged",
        "model": "sam",
        "scene": {},
        "quantities": {"force_N": 1.0},
    }
    table = b"cycle,step,force_N\n1,1,0.5\n1,2,1.0\n"
    files: dict[str, bytes | Special] = {
        f"{RUN}/summary.json": json.dumps(summary).encode(),
        f"{RUN}/history.csv": table,
    }
    edit = rng.randrange(5)
    if edit == 0:
        files[f"{RUN}/summary.json"] = mutated(rng, files[f"{RUN}/summary.json"])
    elif edit == 1:
        texts = (
            b"",
            b"[]",
            b"null",
            b"{}",
            b'{"format": "samfem run 0"}',
            b'{"format": ["samfem run 1"]}',
            b"[" * 100_000,
            b"9" * 5_000,
            b"\xff\xfe",
        )
        files[f"{RUN}/summary.json"] = rng.choice(texts)
    elif edit == 2:
        texts = (
            b"",
            b"\n",
            b"cycle\n1,2\n",
            b"cycle\nx\n",
            b"cycle\n\xff\n",
            b'cycle\n"',
            b"cycle\n" + b"1" * 200_000,
            b"cycle,cycle\n1,2\n",
            b"a\x00b\n1\n",
        )
        files[f"{RUN}/history.csv"] = rng.choice(texts)
    elif edit == 3:
        odd = rng.choice(
            (Special("pipe"), Special("folder"), Special("link", "/dev/zero"), Special("link", "nowhere"))
        )
        files[f"{RUN}/{rng.choice(('summary.json', 'history.csv'))}"] = odd
    else:
        files[f"{RUN}/history.csv"] = mutated(rng, table)
    return BadInput(kind, files, rng.choice((RUN,) * 8 + (f"{RUN}/history.csv", "missing", "x" * 5_000)))
