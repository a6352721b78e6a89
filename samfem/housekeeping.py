# SPDX-License-Identifier: MIT
"""The command store: list what is kept, and prune it."""

from __future__ import annotations

from verification.runs.files import FolderError
from verification.runs.store import CURRENT, DAMAGED, FOLDER, STALE, Entry, default_store
from verification.text.console import print_table
from verification.text.readable import with_prefix

ALL = "all"


def store(prune: str | None, older_than: float | None) -> int:
    """List the entries of the store, or prune them: stale and damaged ones (and those older than so many
    days), or ALL.

    Raises FolderError for an age without `prune`, or with ALL.
    """
    if older_than is not None and prune in (None, ALL):
        raise FolderError("--older-than DAYS: only together with --prune")
    kept = default_store()
    if kept is None:
        print(f"no store: {FOLDER} is empty, so nothing is kept")
    elif prune:

        def goes(entry: Entry) -> bool:
            old = older_than is not None and entry.age_days > older_than
            return prune == ALL or entry.state != CURRENT or old

        sizes = []
        for what, size in kept.prune(goes, coefficients=prune == ALL):
            print(f"removed {what}")
            sizes.append(size)
        print(f"{len(sizes)} removed, {with_prefix(sum(sizes), 'B')} freed: {kept.folder}")
    else:
        entries = kept.entries()
        if entries:
            print_table(
                ("key", "kind", "of", "title", "created", "commit", "code", "size"),
                list(map(_cells, entries)),
            )
        counts = [
            f"{sum(entry.state == state for entry in entries)} {state}" for state in (CURRENT, STALE, DAMAGED)
        ]
        total = with_prefix(sum(entry.size for entry in entries), "B")
        over = len(kept.left_over())
        print(f"{len(entries)} entries ({', '.join(counts)}), {over} left over, {total}: {kept.folder}")
        if boxes := kept.coefficients():
            total = with_prefix(sum(path.stat().st_size for path in boxes), "B")
            print(f"coefficients of {len(boxes)} plastic boxes, {total}")
    return 0


def _cells(entry: Entry) -> tuple[str, ...]:
    made = entry.created[:16].replace("T", " ")
    commit = entry.commit[:7] + "+" * entry.commit.endswith("+")
    told = (entry.kind, entry.what, entry.title, made, commit)
    return entry.path.stem[:12], *(text or "-" for text in told), entry.state, with_prefix(entry.size, "B")
