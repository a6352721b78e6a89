# SPDX-License-Identifier: MIT
"""The commands of a page of the guide, run while the site is built: their output and pictures are those of the reader.

A block that begins with "```sh run" is run, one after the other in an empty folder for each page. What it prints on a
terminal is shown below it. `<!-- picture: PATH ALT -->` shows a picture that the commands have made.
"""

import os
import pty
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from tempfile import TemporaryDirectory

from sphinx.application import Sphinx
from sphinx.errors import ExtensionError

ROOT = Path(__file__).resolve().parents[2]
KEPT = ROOT / "docs" / "_build" / "stories"
BLOCK = re.compile(r"^```sh run\n(.*?)^```\n", re.MULTILINE | re.DOTALL)
PICTURE = re.compile(r"<!-- picture: (\S+) (.*?) -->", re.DOTALL)
COLUMNS, HEAD, TAIL = 110, 24, 6
LONGEST_S = 120  # what a reader of a story is promised
END = "\x1e"  # between the outputs of two blocks


def run(name: str, text: str) -> str:
    """The text of a page, with the output of each of its blocks and the paths of its pictures."""
    with TemporaryDirectory() as work:
        (folder := Path(work, "empty")).mkdir()
        outputs = iter(printed(BLOCK.findall(text), folder, Path(work)))
        (kept := KEPT / name).mkdir(parents=True, exist_ok=True)
        for path, _ in PICTURE.findall(text):
            shutil.copy(folder / path, kept / path.replace("/", "-"))
    text = BLOCK.sub(lambda block: f"```sh\n{block[1]}```\n{shown(next(outputs))}", text)
    up = "../" * name.count("/")
    return PICTURE.sub(
        lambda found: f"![{found[2]}]({up}_build/stories/{name}/{found[1].replace('/', '-')})", text
    )


def printed(blocks: list[str], folder: Path, work: Path) -> Iterator[str]:
    """What each block prints on a terminal. Raises ExtensionError for one that fails."""
    (programs := work / "bin").mkdir()
    for program, words in (("samfem", " -m samfem.cli"), ("python", "")):
        (programs / program).write_text(f'#!/bin/sh\nexec "{sys.executable}"{words} "$@"\n')
        (programs / program).chmod(0o755)
    ours, theirs = pty.openpty()
    program = subprocess.Popen(
        ["bash", "-c", "set -euo pipefail\n" + f"printf '{END}'\n".join(blocks)],
        cwd=folder,
        env={
            **os.environ,
            "PATH": os.pathsep.join([str(programs), os.environ["PATH"]]),
            "PYTHONPATH": str(ROOT),
            "SAMFEM_STORE": str(work / "store"),
            "TERM": "dumb",
            "NO_COLOR": "1",
            "COLUMNS": str(COLUMNS),
            "LINES": "50",
        },
        stdin=subprocess.DEVNULL,
        stdout=theirs,
        stderr=theirs,
    )
    os.close(theirs)
    found = b""
    while part := read(ours):
        found += part
    os.close(ours)
    text = found.decode().replace("\r\n", "\n")
    if program.wait(LONGEST_S) != 0:
        raise ExtensionError(f"a command failed in {folder}:\n{text[-2000:]}")
    return iter(text.split(END))


def read(terminal: int) -> bytes:
    """The next bytes of a terminal; empty at its end."""
    try:
        return os.read(terminal, 65536)
    except OSError:  # Linux's way to say that nobody writes any more
        return b""


def shown(output: str) -> str:
    """A block with the output, its middle left out where it is long."""
    lines = [line.rstrip() for line in output.strip("\n").splitlines()]
    if len(lines) > HEAD + TAIL + 1:
        lines[HEAD:-TAIL] = [f"... ({len(lines) - HEAD - TAIL} more lines)"]
    return "\n".join(["", "```{code-block} text", ":class: output", "", *lines, "```", ""]) if lines else ""


def setup(app: Sphinx) -> None:
    """Called by Sphinx: all pages that it is going to read are run before, on all cores."""
    told: dict[str, str] = {}

    def tell(app: Sphinx, env: object, names: list[str]) -> None:
        texts = {name: Path(app.env.doc2path(name)).read_text(encoding="utf-8") for name in names}
        stories = {name: text for name, text in texts.items() if BLOCK.search(text)}
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            told.update(zip(stories, pool.map(run, stories, stories.values()), strict=True))

    def replace(app: Sphinx, name: str, source: list[str]) -> None:
        source[0] = told.get(name, source[0])

    app.connect("env-before-read-docs", tell)
    app.connect("source-read", replace, priority=100)  # before links are made those of the site
