# SPDX-License-Identifier: MIT
"""The commands verify, report and pages: the cases of the suite, what they must reach, and their pages."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from verification.figures import solve_figures
from verification.runs.files import SUMMARY
from verification.runs.store import default_store
from verification.suite import verify as suite
from verification.suite.changes import show_changes
from verification.suite.freshness import older, stale
from verification.text.console import Progress


def verify(
    case: Sequence[str], *, level: str, out: Path, use_store: bool = True, show: str | None = None
) -> int:
    """Run the named cases (none: all of the level) and write the report, or list them.

    show: "cases" or "gates", to list them and run none.
    """
    if show:
        return suite.show(show, case)
    with Progress(remaining=True) as progress:
        return suite.main(list(case), level, out, progress, store=default_store() if use_store else None)


def report(
    folder: Path,
    against: Path | None = None,
    *,
    table: Path | None = None,
    single_file: bool = False,
    pdf: bool = False,
) -> int:
    """Write the pages of a finished report again, or list what changed since an older one, or draw the
    figures of a report or a run as PDF. table: of the gates that the older one had and what they are now.
    """
    if against is not None:
        return show_changes(folder, against, table)
    if pdf and (folder / SUMMARY).is_file():
        print(*solve_figures(folder, pdf=True), sep="\n")
        return 0
    if pdf:
        with Progress() as progress:
            written = suite.draw_pdf(folder, progress, default_store())
        print(*written, sep="\n")
        return 0
    return suite.rebuild(folder, single_file=single_file)


def pages(folder: Path, *, list_stale: bool = False, single_file: bool = False) -> int:
    """Write the pages of a published report again, or list the cases that are older than the code; 1 if any
    is.
    """
    if not list_stale:
        return suite.rebuild(folder, single_file=single_file)
    results = suite.finished(folder)
    found = stale(results)
    print("".join(f"{name}: {why}\n" for name, why in found.items()), end="")
    count = sum(case["status"] != "not run" for case in results["cases"]) - len(older(results))
    print(f"{len(found)} stale, {count} as the code in front of you")
    return 1 if found else 0
