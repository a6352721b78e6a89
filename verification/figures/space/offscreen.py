# SPDX-License-Identifier: MIT
"""Drawing without a display: which library VTK can use, and the child process in which it draws."""

import ctypes
import os
import signal
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor, wait
from pathlib import Path
from typing import Any

from sam.scene import Progress
from verification.runs.files import FIGURES, FolderError, write_atomically

IN_SPACE = "-3d"
"""At the end of the names of the files: a map may be called as a picture is."""
WINDOW = "VTK_DEFAULT_OPENGL_WINDOW"
"""The variable by which VTK is told what to draw with, before it is imported."""
WINDOWS = {"libEGL.so.1": "vtkEGLRenderWindow", "libOSMesa.so.8": "vtkOSOpenGLRenderWindow"}
"""Library -> what VTK draws with where it is found; the first that is."""
INSTALL = "apt-get install --no-install-recommends libegl1 libgl1-mesa-dri"
REMEDY = f"without a display VTK needs EGL, on Debian and Ubuntu: {INSTALL}"
CHILD = ("-m", "verification.figures.space.child")
WRONG = 2
"""Exit code of the child for a run that is damaged, which it names."""
LONGEST_S = 600.0
"""A picture takes seconds; whatever takes that long does not end."""


class CannotDrawError(RuntimeError):
    """VTK has drawn nothing on this machine; one line that says why and what to do."""


def window() -> str | None:
    """What VTK can draw with on this machine: as the user has set it, else by the libraries; None without."""
    if os.environ.get(WINDOW):
        return os.environ[WINDOW]
    return next((window for library, window in WINDOWS.items() if _loads(library)), None)


def draw(
    folder: Path,
    name: str | None = None,
    *,
    one: bool = False,
    page: bool = False,
    progress: Progress = lambda *_: None,
) -> dict[str, bytes]:
    """The pictures that the run in `folder` has: name -> the content of a PNG, or of an HTML page. name: this
    one alone; one: the first alone; progress: called twice a second. Raises CannotDrawError, or FolderError
    for a damaged run.
    """
    found = window()
    if found is None and not page:  # a page is drawn by the browser
        raise CannotDrawError(f"no pictures in space: {REMEDY}")
    options = [*(["--name", name] if name else []), *["--one"] * one, *["--page"] * page]
    with tempfile.TemporaryDirectory(prefix="samfem-") as into:
        with ThreadPoolExecutor(1) as beside:
            ended = beside.submit(_run, [str(folder.absolute()), into, *options], {WINDOW: found or ""})
            while not wait([ended], timeout=0.5).done:
                drawn = [path.stat().st_size > 0 for path in Path(into).iterdir()]
                progress("drawing pictures in space", sum(drawn), len(drawn))
        ended.result()
        return {path.stem: path.read_bytes() for path in sorted(Path(into).iterdir())}


def draw_run(folder: Path, name: str | None = None, *, progress: Progress = lambda *_: None) -> list[Path]:
    """Draw the pictures of a finished run, or the named one. CannotDrawError: nothing was written."""
    pictures = {
        folder / FIGURES / f"{each}{IN_SPACE}.png": png
        for each, png in draw(folder, name, progress=progress).items()
    }
    for path, png in pictures.items():
        path.parent.mkdir(exist_ok=True)
        write_atomically(path, png)
    return list(pictures)


def _loads(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True


def _run(arguments: list[str], environment: dict[str, str]) -> None:
    """Run the child, with the code of this process whatever the working folder holds."""
    root = str(Path(__file__).parents[3])
    paths = os.pathsep.join(filter(None, (root, os.environ.get("PYTHONPATH"))))
    command = [sys.executable, "-P", *CHILD, *arguments]
    how: dict[str, Any] = {"stdin": subprocess.DEVNULL, "capture_output": True, "text": True}
    how["env"] = {**os.environ, "PYTHONPATH": paths, **environment}
    try:
        ended = subprocess.run(command, errors="replace", timeout=LONGEST_S, check=False, **how)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise CannotDrawError(f"no pictures in space: {error}; {REMEDY}") from None
    if ended.returncode == WRONG:
        raise FolderError(ended.stderr.strip())
    if ended.returncode:
        raise CannotDrawError(f"no pictures in space: drawing ended with {_how(ended)}")


def _how(ended: subprocess.CompletedProcess[str]) -> str:
    """How a process failed, and what to do: a signal is a missing library, words are a defect."""
    if ended.returncode < 0:
        return f"{signal.Signals(-ended.returncode).name}; {REMEDY}"
    lines = ended.stderr.strip().splitlines() or [f"exit code {ended.returncode}"]
    return f"{lines[-1]}; please report it"
