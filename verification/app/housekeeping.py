# SPDX-License-Identifier: MIT
"""The command store: list what is kept, and prune it."""

from __future__ import annotations

from verification.runs.store import CURRENT, DAMAGED, FOLDER, STALE, Entry, default_store
from verification.text.console import print_table
from verification.text.readable import with_prefix

ALL = "all"


def show(prune: str | None, older_than: float | None) -> int:
    """List the entries of the store, or remove: stale and damaged ones (and those older than so many days),
    or ALL.
    """
    store = default_store()
    if store is None:
        print(f"no store: {FOLDER} is empty, so nothing is kept")
    elif prune:
        removed = 0, 0
        for what, size in store.prune(lambda entry: _goes(entry, prune, older_than)):
            print(f"removed {what}")
            removed = removed[0] + 1, removed[1] + size
        print(f"{removed[0]} removed, {with_prefix(removed[1], 'B')} freed: {store.folder}")
    else:
        entries = store.entries()
        if entries:
            print_table(
                ("key", "kind", "of", "title", "created", "commit", "code", "size"),
                list(map(_cells, entries)),
            )
        counts = [
            f"{sum(entry.state == state for entry in entries)} {state}" for state in (CURRENT, STALE, DAMAGED)
        ]
        total = with_prefix(sum(entry.size for entry in entries), "B")
        over = len(store.left_over())
        print(f"{len(entries)} entries ({', '.join(counts)}), {over} left over, {total}: {store.folder}")
    return 0


def _goes(entry: Entry, prune: str, older_than: float | None) -> bool:
    old = older_than is not None and entry.age_days > older_than
    return prune == ALL or entry.state != CURRENT or old


def _cells(entry: Entry) -> tuple[str, ...]:
    made = entry.created[:16].replace("T", " ")
    commit = entry.commit[:7] + "+" * entry.commit.endswith("+")
    return (
        *(
            entry.path.stem[:12],
            entry.kind or "-",
            entry.what or "-",
            entry.title or "-",
            made or "-",
            commit or "-",
        ),
        *(entry.state, with_prefix(entry.size, "B")),
    )
