# SPDX-License-Identifier: MIT
"""checkpoint.npz in the folder of a run: a solve in progress, and what it belongs to.

It is written at most every INTERVAL_S seconds, and less often where writing takes long: never more than SHARE
of the time. It can be continued only by the model, scene, code, packages and machine that wrote it, because
only they give the same bytes.
"""

import hashlib
import json
import math
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from sam.scene import Checkpoint, Scene, resolved, solved_part
from verification.runs.archive import ArchiveError, read_archive, write_archive
from verification.runs.code_version import code_version
from verification.runs.files import CHECKPOINT, MEMBERS, SUMMARY, FolderError, plain, read_summary
from verification.runs.provenance import collect

FORMAT = "samfem checkpoint 1"
INTERVAL_S, SHARE = 5.0, 0.02
INTERVAL = "SAMFEM_CHECKPOINT_S"
"""Environment variable with another interval in s; 0: every step."""
MACHINE = ("os", "architecture", "cpu", "cores")
PACKAGES = ("python", "numpy", "scipy", "scikit-fem")
WORDS = {"scene_sha256": "scene", "code": "version of samfem", "threads": "number of threads"}
"""Names of the identity for the reader, where they differ."""


def interval() -> float:
    """Seconds between checkpoints, of the environment or INTERVAL_S. FolderError for no such number."""
    text = os.environ.get(INTERVAL, "").strip()
    try:
        seconds = float(text) if text else INTERVAL_S
    except ValueError:
        seconds = math.nan
    if not 0 <= seconds < math.inf:
        raise FolderError(f"{INTERVAL} = {text}: a number of seconds >= 0 is needed")
    return seconds


def identity(scene: Scene, model: str) -> dict[str, Any]:
    """What must be equal for the same bytes."""
    source = collect()
    return {
        "format": FORMAT,
        "model": model,
        "scene_sha256": hashlib.sha256(json.dumps(_solved(scene), sort_keys=True).encode()).hexdigest(),
        "code": code_version(model),
        **{name: source["versions"][name] for name in PACKAGES},
        "machine": {name: source["machine"][name] for name in MACHINE},
        "threads": source["threads"],
    }


class Writer:
    """Writes the checkpoints of a solve into its folder; the `checkpoint` callable of models.solve. who: see
    `identity`; start: the one that the solve goes on from; warn: called once with a text if one cannot be
    written, which does not end the solve. written: the one in the folder.
    """

    def __init__(
        self,
        folder: Path,
        who: Mapping,
        seconds: float,
        start: Checkpoint | None,
        *,
        warn: Callable[[str], None],
    ):
        self.path, self.who, self.seconds, self.warn = folder / CHECKPOINT, dict(who), seconds, warn
        self.written = self.latest = start
        self._replaces, self._failed = _digest(folder / SUMMARY), False
        self._due = time.monotonic() + seconds

    def __call__(self, checkpoint: Checkpoint) -> None:
        """Keep in mind, and write if it is time."""
        self.latest = checkpoint
        if time.monotonic() >= self._due:
            self.write()

    def write(self) -> None:
        """Write the latest checkpoint, if it is not written yet."""
        if self.latest is None or self.latest is self.written:
            return
        began, latest = time.monotonic(), self.latest
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            own = {"identity": self.who, "replaces": self._replaces}
            write_archive(self.path, latest.arrays, {**own, "values": dict(latest.values)})
            self.written = latest
        except OSError as error:
            if not self._failed:
                self.warn(f"{self.path} cannot be written ({error.strerror}): the solve goes on without it")
            self._failed = True
        now = time.monotonic()
        self._due = now + (max(self.seconds, (now - began) / SHARE) if self.seconds else 0.0)


@contextmanager
def interruptible(writer: Writer) -> Iterator[None]:
    """SIGINT and SIGTERM write the latest checkpoint and end in a KeyboardInterrupt that says so."""

    def stop(*_signal):
        raise KeyboardInterrupt

    main = threading.current_thread() is threading.main_thread()
    before = signal.signal(signal.SIGTERM, stop) if main else None
    try:
        yield
    except KeyboardInterrupt:
        writer.write()
        if writer.written is None:
            raise
        step, total = writer.written.done + 1, writer.written.total
        where = f"from step {step} of {total}" if step <= total else "after the last step"
        raise KeyboardInterrupt(f"interrupted: --resume continues {where}") from None
    finally:
        if main:
            signal.signal(signal.SIGTERM, before or signal.SIG_DFL)


def read(folder: Path, who: Mapping) -> Checkpoint | None:
    """The checkpoint in `folder`, or None. FolderError for another's, ArchiveError for a damaged one."""
    path = folder / CHECKPOINT
    if not path.exists():
        return None
    arrays, values = _content(path)
    found = values["identity"]
    differs = [WORDS.get(name, name) for name in who if found.get(name) != plain(who[name])]
    if differs:
        words = "delete it to start anew, or solve into another folder (--out)"
        another = ", another ".join(differs)
        raise FolderError(f"{path} is of another {another}, and cannot be continued: {words}")
    return Checkpoint(str(found["model"]), arrays, values["values"])


def is_finished(folder: Path, scene: Scene, model: str) -> bool:
    """Whether the folder holds this result, and no newer solve of it was interrupted."""
    if not (folder / SUMMARY).exists() or (folder / MEMBERS).exists():
        return False
    summary = read_summary(folder)
    found = summary.get("scene")
    if summary.get("model") != model or not isinstance(found, dict) or solved_part(found) != _solved(scene):
        return False
    if not (folder / CHECKPOINT).exists():
        return True
    try:
        return _content(folder / CHECKPOINT)[1]["replaces"] != _digest(folder / SUMMARY)
    except ArchiveError:
        return True


def _solved(scene: Scene) -> dict:
    """What the result depends on, as JSON holds it."""
    return plain(solved_part(resolved(scene)))


def _content(path: Path) -> tuple[dict, dict]:
    """(arrays, values) of the file, its values checked for their kinds. Raises ArchiveError."""
    arrays, values = read_archive(path)
    tables = all(isinstance(values.get(name), dict) for name in ("identity", "values"))
    if not (tables and "replaces" in values):
        raise ArchiveError(f"{path} is no checkpoint")
    return arrays, values


def _digest(path: Path) -> str | None:
    """SHA-256 of a file, None if it is not there."""
    return hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else None
