# SPDX-License-Identifier: MIT
"""The command view: pictures in space of a finished run.

Wrong input raises FolderError before anything is drawn or written.
"""

from __future__ import annotations

import os
import sys
from importlib.util import find_spec
from pathlib import Path

from verification.figures.space import CannotDrawError, draw, draw_run
from verification.runs.files import FolderError, read_summary, write_atomically
from verification.runs.lock import locked

OF_PAGES = ("trame_pyvista", "nest_asyncio2")
"""Packages that write a page."""


def view(folder: Path, *, name: str | None, out: Path | None, page: Path | None) -> int:
    """Draw one picture of the run in `folder` into the PNG `out` or the HTML file `page`, else all pictures
    into its folder of figures; 0, or 1 with a line on stderr where this machine cannot draw.
    """
    read_summary(folder)
    target = page or out
    if target is not None:
        _check_file(target, ".html" if page else ".png")
    missing = [package for package in OF_PAGES if page and find_spec(package) is None]
    if missing:
        raise FolderError(f"--html needs {' and '.join(missing)}: pip install 'samfem[html]'")
    try:
        print(*_drawn(folder, name, target, as_page=page is not None), sep="\n")
    except CannotDrawError as error:
        print(f"samfem: {error}", file=sys.stderr)
        return 1
    return 0


def _drawn(folder: Path, name: str | None, target: Path | None, *, as_page: bool) -> list[Path]:
    """The files that were written. Raises FolderError for a run that does not have what is to be shown."""
    if target is None:
        with locked(folder):
            written = draw_run(folder, name)
    else:
        written = [target] * len(pictures := draw(folder, name, one=True, page=as_page))
        for content in pictures.values():
            write_atomically(target, content)
    if not written:
        what = (
            "has nothing to show in space" if name is None else f"does not have what --picture {name} shows"
        )
        raise FolderError(f"{folder} {what}; docs/guide/results.md says which runs have which pictures")
    return written


def _check_file(path: Path, ending: str) -> None:
    """Raise FolderError unless a file of this kind can be written there."""
    if path.suffix.lower() != ending:
        raise FolderError(f"{path} does not end in {ending}")
    if path.is_dir() or not path.absolute().parent.is_dir() or not os.access(path.absolute().parent, os.W_OK):
        raise FolderError(f"{path} cannot be written: give a file in a folder that can be written to")
