# SPDX-License-Identifier: MIT
"""The commands of a page of the guide, run while the site is built: what they print and draw is on the page.

Blocks that begin with "```sh run" are run one after the other in an empty folder, and what each prints on a
terminal is shown below it. `<!-- picture: PATH ALT -->` shows a picture that the commands have made.
"""

import os
import pty
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

from sphinx.application import Sphinx
from sphinx.errors import ExtensionError

ROOT = Path(__file__).resolve().parents[2]
KEPT = ROOT / "docs" / "_build" / "stories"
PART = re.compile(
    r"^```sh run\n(?P<commands>.*?)^```\n|<!-- picture: (?P<path>\S+) (?P<alt>.*?) -->",
    re.MULTILINE | re.DOTALL,
)
COLUMNS, HEAD, TAIL = 120, 24, 6
END = "\x1e"  # between the outputs of two blocks


def run(name: str, text: str) -> str:
    """The text of a page, with the output of each of its blocks and the paths of its pictures."""
    (kept := KEPT / name).mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory() as work:
        script = "".join(
            f"{part['commands']}printf '{END}'\n" if part["commands"] else f"cp {part['path']} {kept}\n"
            for part in PART.finditer(text)
        )
        outputs = iter(printed(script, Path(work)).split(END))

    def told(part: re.Match) -> str:
        if part["commands"]:
            return f"```sh\n{part['commands']}```\n{shown(next(outputs))}"
        up = "../" * name.count("/")
        return f"![{part['alt']}]({up}_build/stories/{name}/{Path(part['path']).name})"

    return PART.sub(told, text)


def printed(script: str, work: Path) -> str:
    """What a script prints on a terminal, in an empty folder. Raises ExtensionError if a command fails."""
    for program, words in (("samfem", " -m samfem.cli"), ("python", "")):
        (work / program).write_text(f'#!/bin/sh\nexec "{sys.executable}"{words} "$@"\n')
        (work / program).chmod(0o755)
    (folder := work / "empty").mkdir()
    ours, theirs = pty.openpty()
    program = subprocess.Popen(
        ["bash", "-c", f"set -euo pipefail\n{script}"],
        cwd=folder,
        env={
            **os.environ,
            "PATH": os.pathsep.join([str(work), os.environ["PATH"]]),
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
    found = b"".join(iter(partial(read, ours), b""))
    os.close(ours)
    text = found.decode().replace("\r\n", "\n")
    if program.wait() != 0:
        raise ExtensionError(f"a command failed in {folder}:\n{text[-2000:]}")
    return text


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
        stories = {name: text for name, text in texts.items() if PART.search(text)}
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            told.update(zip(stories, pool.map(run, stories, stories.values()), strict=True))

    def replace(app: Sphinx, name: str, source: list[str]) -> None:
        source[0] = told.get(name, source[0])

    app.connect("env-before-read-docs", tell)
    app.connect("source-read", replace, priority=100)  # before links are made those of the site
