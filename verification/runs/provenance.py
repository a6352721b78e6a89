# SPDX-License-Identifier: MIT
"""Where a result comes from: versions, commit, machine, threads, time and the hashes of its inputs."""

import contextlib
import hashlib
import os
import platform
import subprocess
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any

from verification.runs.threads import THREADS

PACKAGES = ("samfem", "numpy", "scipy", "scikit-fem", "meshio", "pydantic", "pint", "matplotlib")

GROUP_LIMITS = (Path("/sys/fs/cgroup/memory.max"), Path("/sys/fs/cgroup/memory/memory.limit_in_bytes"))


def collect(inputs: Mapping[str, bytes] | None = None, seeds: Sequence[int] = ()) -> dict:
    """Provenance that JSON can hold. inputs: name of an input -> its content, kept as SHA-256."""
    return {
        "time_utc": datetime.now(UTC).isoformat(timespec="seconds"),
        "versions": {"python": platform.python_version()} | {name: installed(name) for name in PACKAGES},
        **_commit(Path(__file__).resolve().parents[2]),
        "machine": dict(_machine()),
        "threads": {name: os.environ.get(name) for name in THREADS},
        "seeds": list(seeds),
        "input_sha256": hashes(inputs or {}),
    }


def hashes(inputs: Mapping[str, bytes]) -> dict[str, str]:
    """Name of each input as text (UTF-8, whatever the locale) -> SHA-256 of its content."""
    return {
        name.encode(errors="surrogateescape").decode(errors="replace"): hashlib.sha256(content).hexdigest()
        for name, content in inputs.items()
    }


def without_places(text: str, *folders: Path) -> str:
    """A text for publication: files of these folders, and of the current one, by their names below it."""
    for folder in (*folders, Path.cwd()):
        text = text.replace(f"{folder.absolute()}{os.sep}", "")
    return text


@cache
def installed(package: str) -> str | None:
    """The version of a package, None where it is not there."""
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None


def _commit(root: Path) -> dict[str, Any]:
    """Commit, and whether files differ from it, if `root` is the top of a git checkout; else None."""
    if not (root / ".git").exists():
        return {"commit": None, "dirty": None}
    status = _git(root, "status", "--porcelain", "--", ".", ":!reports")  # what it writes is no code
    dirty = None if status is None else bool(status)
    return {"commit": _git(root, "rev-parse", "--verify", "HEAD"), "dirty": dirty}


def _git(root: Path, *arguments: str) -> str | None:
    command = ["git", "-C", str(root), *arguments]
    try:
        answer = subprocess.run(command, capture_output=True, text=True, timeout=20, check=False)
    except (OSError, subprocess.SubprocessError):
        return None
    return answer.stdout.strip() if answer.returncode == 0 else None


@cache
def _machine() -> Mapping[str, Any]:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        lines = []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return {
        "os": platform.platform(),
        "architecture": platform.machine(),
        "cpu": names[0] if names else platform.processor() or None,
        "cores": len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count(),
        "memory_bytes": memory_bytes(),
    }


def memory_bytes() -> int | None:
    """The memory of the machine, or of the control group if that is less; None if unknown."""
    try:
        found = [os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")]
    except (AttributeError, OSError, ValueError):
        return None
    for path in GROUP_LIMITS:
        with contextlib.suppress(OSError, ValueError):  # not there, or "max"
            found.append(int(path.read_text(encoding="utf-8")))
    return min(each for each in found if each)
