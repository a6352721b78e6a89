# SPDX-License-Identifier: MIT
"""The outcome of a whole verification case in the store, with its figures and runs as files.

A case whose code and scenes are unchanged need not run again: what it measured is judged anew, what
it drew is written again byte for byte. Only a case that came to its end is kept. Its scenes and its
file, but for limits, count by content, everything else by the version of the code that it depends on.
"""

import gzip
import hashlib
from dataclasses import dataclass, replace
from importlib import resources
from pathlib import Path

from verification.cases.case import Case, Context, Figure, Outcome
from verification.runs.code_version import unchanged, version_of_cases
from verification.runs.files import SUMMARY, write_atomically
from verification.runs.store import OUTCOME, Lookup, Reuse, Store

PACKED = 4_000  # bytes of a table: packing those beyond saves 1.4 of the 1.9 MB of all, below it nothing


@dataclass(frozen=True)
class Kept:
    """What is stored of a case. files: name in the folder -> content; inputs, sources: see Context."""

    outcome: Outcome
    inputs: dict[str, bytes]
    sources: dict[str, Reuse]
    files: dict[str, bytes]
    seconds: float


def find(store: Store, case: Case, context: Context) -> Lookup:
    """The outcome of a case at this level, if it is there, of this version and the same scenes."""
    found = store.find(_identity(case, context.level), version_of_cases(), Kept)
    inputs = found.result.inputs if found.result else {}
    changed = [name for name, content in inputs.items() if present(name) != content]
    if changed:
        return replace(found, result=None, note=f"stale: {', '.join(changed)} changed since {found.created}")
    return found


def is_kept(store: Store, case: Case, level: str) -> bool:
    """Whether `find` would find an outcome, unless it is damaged or its scenes have changed."""
    return store.holds(_identity(case, level), version_of_cases())


def put_back(kept: Kept, context: Context, *, with_runs: bool = True) -> Outcome:
    """Write the files of a case again, a run's summary last, or only its figures; fill the context."""
    drawn = {name for figure in kept.outcome.figures for name in figure.files}
    files = [(name, content) for name, content in kept.files.items() if with_runs or name in drawn]
    for name, content in sorted(files, key=lambda item: item[0].endswith(SUMMARY)):
        path = context.out / name
        path.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(path, content)
    context.inputs |= kept.inputs
    context.runs += kept.sources
    context.sources |= {run: replace(source, reused=True) for run, source in kept.sources.items()}
    return kept.outcome


def keep(store: Store, case: Case, context: Context, outcome: Outcome, *, seconds: float) -> None:
    """Keep what a case found, unless code changed. ValueError for an input that is no file of the scenes."""
    if foreign := [name for name in context.inputs if present(name) is None]:
        raise ValueError(f"case {case.name} names as input what is no file of the scenes: {foreign}")
    if not unchanged():
        return
    places = [path for run in context.runs for path in (context.out / run).iterdir()]
    places += [context.out / name for figure in outcome.figures for name in figure.files]
    kept = [path for path in places if path.is_file() and not path.name.startswith(".")]
    files = {path.relative_to(context.out).as_posix(): path.read_bytes() for path in kept}
    content = Kept(outcome, dict(context.inputs), dict(context.sources), files, seconds)
    store.put(_identity(case, context.level), version_of_cases(), content, case.title)


def _identity(case: Case, level: str) -> dict:
    return {"kind": OUTCOME, "case": case.name, "level": level, "file": file_digest(case)}


def file_digest(case: Case | None) -> str:
    """Digest of what the file of a case says beside the limits and words of its rows, empty without one."""
    if case is None or case.file is None:
        return ""
    measured = [(claim.row.id, *claim[1:]) for claim in case.file.claims]
    content = case.file.model_dump_json(exclude={"path", "claims"}) + repr(measured)
    return hashlib.sha256(content.encode()).hexdigest()


def present(name: str) -> bytes | None:
    """The present content of a file of the scenes, None if it is not there."""
    try:
        return resources.files("verification").joinpath("scenes", name).read_bytes()
    except OSError:
        return None


def packed(figure: Figure, folder: Path) -> Figure:
    """The figure with its table packed where that is long; both are in the folder of a published report."""
    table = folder / figure.csv
    if not (figure.csv.endswith(".csv") and table.is_file() and table.stat().st_size > PACKED):
        return figure
    write_atomically(folder / f"{figure.csv}.gz", gzip.compress(table.read_bytes(), mtime=0))
    table.unlink()
    return replace(figure, csv=f"{figure.csv}.gz")
