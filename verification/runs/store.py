# SPDX-License-Identifier: MIT
"""The store: what was computed once, kept by what it was computed from.

An entry is one archive, <key>.npz. Its key is the SHA-256 of its identity (kind, model and resolved scene
without the title, so that tables which a scene names count by content); inside are the identity, the version
of the code, date, commit and the values. An entry of another version is stale, one that cannot be read or is
another's is damaged: both are computed again, and said. A store that cannot be written costs a warning on
stderr, never a result.
"""

import hashlib
import json
import os
import re
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from typing import Any

from sam.scene import CodecError, Progress, Result, Scene, decode, encode, resolved, solved_part
from verification.runs import models
from verification.runs.archive import ArchiveError, read_archive, read_values, write_archive
from verification.runs.code_version import code_version, unchanged, version_of_cases
from verification.runs.files import FolderError
from verification.runs.provenance import collect

FOLDER = "SAMFEM_STORE"
LIMIT, PLACE = "SAMFEM_COEFFICIENTS", "coefficients"  # of the coefficients of plastic boxes
FORMAT = "samfem store 2"
RESULT, UNCONVERGED, OUTCOME = "result", "unconverged", "outcome"
CURRENT, STALE, DAMAGED = "current", "stale", "damaged"
_KEY = re.compile(r"[0-9a-f]{64}")
_WRITING = threading.Lock()


@dataclass(frozen=True)
class Lookup:
    """What a lookup found. result: None if nothing usable; note: why an entry is not used ("stale: ..."), or
    empty; created (UTC, ISO 8601) and commit of what was found.
    """

    result: Any = None
    note: str = ""
    created: str = ""
    commit: str = ""


@dataclass(frozen=True)
class Reuse:
    """Where a result is from. reused: from the store; created, commit: when computed; note: see Lookup."""

    reused: bool
    created: str = ""
    commit: str = ""
    note: str = ""

    @property
    def text(self) -> str:
        """For the reader: where a reused result is from, or why one is computed again; else empty."""
        if self.reused:
            return f"taken from the store: computed {self.created}, {short(self.commit)}"
        return f"{self.note}: computed again" if self.note else ""

    @property
    def provenance(self) -> dict[str, Any]:
        """What summary.json says besides about a reused result."""
        return {"from_store": {"computed_utc": self.created, "commit": self.commit}} if self.reused else {}


@dataclass(frozen=True)
class Entry:
    """A file of the store, for the list. what: model, or name and level of a case; size in bytes."""

    path: Path
    kind: str
    what: str
    title: str
    created: str
    commit: str
    state: str
    size: int

    @property
    def age_days(self) -> float:
        """Since it was made; 0 if it does not say when."""
        try:
            return (datetime.now(UTC) - datetime.fromisoformat(self.created)).total_seconds() / 86400
        except (ValueError, TypeError):
            return 0.0


class Store:
    """The entries in a folder, made when the first is kept. Any number of processes may share it."""

    def __init__(self, folder: Path):
        self.folder = Path(folder)
        self._warned = False
        for model in models.MODELS:  # as early as can be: before anything is computed with these files
            code_version(model)

    def lookup(self, scene: Scene, model: str, kind: str = RESULT) -> Lookup:
        """The result of a scene, if there and of this version; UNCONVERGED: one that did not converge."""
        return self.find(identity(scene, model) | {"kind": kind}, code_version(model), Result)

    def keep(self, scene: Scene, model: str, result: Result, *, unconverged: bool = False) -> None:
        """Keep a result, unless the code changed meanwhile; unconverged ones if asked for, and apart."""
        if not (result.converged or unconverged):
            return
        if not unchanged(model=model):
            self._warn("the source files changed since the command began: the result is not kept")
            return
        who = identity(scene, model) | {"kind": RESULT if result.converged else UNCONVERGED}
        self.put(who, code_version(model), result, scene.title)

    def find(self, who: dict, version: str, wanted: type) -> Lookup:
        """The record, of the wanted type, that a version of the code kept for an identity."""
        path = self._path(who)
        try:
            if not path.is_file():
                return Lookup()
            values, arrays = _read(path)
            made = {"created": values["created"], "commit": values["commit"]}
            if _is_stale(values, version):
                code = values["code_version"][:8]
                return Lookup(None, f"stale: computed by code {code} of {values['created']}", **made)
            return Lookup(decode(values.get("content"), arrays, wanted), "", **made)
        except (OSError, ArchiveError, CodecError) as error:
            return Lookup(None, f"damaged: {error}")

    def holds(self, who: dict, version: str) -> bool:
        """Whether a record of this version is kept for an identity; that it is whole is not looked at."""
        try:
            return not _is_stale(read_values(self._path(who)), version)
        except (ArchiveError, LookupError, TypeError):
            return False

    def put(self, who: dict, version: str, record: Any, title: str) -> None:
        """Keep a record under an identity, in place of an older one; a warning if that fails."""
        try:
            tree, arrays = encode(record)
            values = {"format": FORMAT, "identity": who, "title": title, "code_version": version, **now()}
            self.folder.mkdir(parents=True, exist_ok=True)
            with _WRITING:  # the temporary file is one a process
                write_archive(self._path(who), arrays, values | {"content": tree})
        except (OSError, CodecError) as error:
            reason = getattr(error, "strerror", None) or error
            what = f"give another folder by {FOLDER}, or none to do without"
            self._warn(f"{reason}: results are not kept; {what}")

    def entries(self) -> list[Entry]:
        """Every entry, the oldest first; each is read whole, so that damage shows."""
        paths = [path for path in self.folder.glob("*.npz") if _KEY.fullmatch(path.stem)]
        return sorted(map(_entry, paths), key=lambda entry: (entry.created, entry.path.name))

    def left_over(self) -> list[Path]:
        """Temporary files of processes that were killed while they wrote."""
        found = [path for path in self.folder.glob(".*.npz.*.part") if _KEY.match(path.name[1:])]
        return sorted(path for path in found if not _is_running(path.name.split(".")[-2]))

    def coefficients(self) -> list[Path]:
        """Files with the coefficients of plastic boxes, see `kept_coefficients`."""
        return sorted((self.folder / PLACE).glob("*"))

    def prune(
        self, chosen: Callable[[Entry], bool], *, coefficients: bool = False
    ) -> Iterator[tuple[str, int]]:
        """Remove the chosen entries, left-overs and coefficients; (what, bytes) of each. Raises OSError."""
        for entry in self.entries():
            if chosen(entry):
                entry.path.unlink(missing_ok=True)
                yield f"{entry.path.stem[:12]} {entry.kind} {entry.what} ({entry.state})", entry.size
        of_boxes = self.coefficients() if coefficients else []
        for path in [*self.left_over(), *of_boxes]:
            size = path.stat().st_size
            path.unlink(missing_ok=True)
            yield f"{path.name[:13]} ({'coefficients' if path in of_boxes else 'left over'})", size

    def _path(self, who: dict) -> Path:
        return self.folder / f"{_key(who)}.npz"

    def _warn(self, text: str) -> None:
        if not self._warned:
            print(f"samfem: warning: store {self.folder}: {text}", file=sys.stderr, flush=True)
        self._warned = True


def default_store() -> Store | None:
    """The user's store: $SAMFEM_STORE (empty: none), else samfem in $XDG_CACHE_HOME or ~/.cache."""
    named = os.environ.get(FOLDER)
    if named is not None:
        return Store(Path(named)) if named else None
    caches = os.environ.get("XDG_CACHE_HOME", "")
    try:
        return Store((Path(caches) if os.path.isabs(caches) else Path.home() / ".cache") / "samfem")
    except RuntimeError:  # the user has no home folder
        return None


def kept_coefficients() -> AbstractContextManager[None]:
    """In the block SAM takes the coefficients of plastic boxes from the store of the user, and keeps them
    there up to $SAMFEM_COEFFICIENTS bytes (0: none). Raises FolderError for what is no such number.
    """
    from sam.kernels import CoefficientStore, using  # noqa: PLC0415 - not needed by other commands

    known, text = default_store(), os.environ.get(LIMIT, "").strip() or "2e9"
    try:
        limit = float(text)
    except ValueError:
        raise FolderError(f"{LIMIT} = {text}: a number of bytes is needed") from None
    return using(known and CoefficientStore(known.folder / PLACE, limit, code_version(models.SAM)))


def solve_or_reuse(
    store: Store | None,
    scene: Scene,
    model: str,
    progress: Progress | None = None,
    *,
    fresh: bool = False,
    **how,
) -> tuple[Result, Reuse]:
    """The result of a scene, stored or else solved and kept. fresh: solve anyway; how: for `models.solve`."""
    found = Lookup() if store is None or fresh else store.lookup(scene, model)
    if found.result is not None:
        return found.result, Reuse(True, found.created, found.commit)
    result = models.solve(scene, model, progress, **how)
    if store is not None:
        store.keep(scene, model, result)
    return result, Reuse(False, **now(), note=found.note)


def identity(scene: Scene, model: str) -> dict:
    """What a result depends on but the code: model and scene with every default, no title or [compare]."""
    content = solved_part(resolved(scene))
    content.pop("title", None)
    return {"kind": RESULT, "model": model, "scene": content}


def short(commit: str) -> str:
    """A commit for the reader."""
    return f"commit {commit[:7]}{' with changes' if commit.endswith('+') else ''}" if commit else "no commit"


def _key(who: dict) -> str:
    return hashlib.sha256(json.dumps(who, sort_keys=True, separators=(",", ":")).encode()).hexdigest()


def _is_running(process: str) -> bool:
    """Whether a process of this number lives on this machine; another's temporary file is not touched."""
    try:
        os.kill(int(process), 0)
    except PermissionError:
        return True
    except (OSError, ValueError, OverflowError):
        return False
    return True


def now() -> dict[str, str]:
    """created and commit (when first asked), the latter with a plus where files differ from it."""
    return {"created": datetime.now(UTC).isoformat(timespec="seconds"), "commit": _commit()}


@cache
def _commit() -> str:
    source = collect()
    return (source["commit"] or "") + "+" * bool(source["dirty"])


def _read(path: Path) -> tuple[dict, dict]:
    """(values, arrays) of an entry, its own words checked. Raises ArchiveError."""
    arrays, values = read_archive(path)
    texts = (values.get(name) for name in ("format", "code_version", "created", "commit", "title"))
    if not (all(isinstance(text, str) for text in texts) and isinstance(values.get("identity"), dict)):
        raise ArchiveError(f"{path} is no entry of a store")
    if _key(values["identity"]) != path.stem:
        raise ArchiveError(f"{path} holds something else than its name says")
    return values, arrays


def _is_stale(values: dict, version: str) -> bool:
    return values["format"] != FORMAT or values["code_version"] != version


def _entry(path: Path) -> Entry:
    size = 0
    try:
        size = path.stat().st_size
        values, _ = _read(path)
        who = values["identity"]
        kind = who.get("kind")
        what = who.get("model") if kind == RESULT else f"{who.get('case')}, {who.get('level')}"
        version = code_version(what) if what in models.MODELS else ""
        version = version_of_cases() if kind == OUTCOME else version
        state = STALE if _is_stale(values, version) else CURRENT
        said = {name: values[name] for name in ("title", "created", "commit")}
        return Entry(path, str(kind), str(what), state=state, size=size, **said)
    except (OSError, ArchiveError):
        return Entry(path, "", "", "", "", "", DAMAGED, size)
