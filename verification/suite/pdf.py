# SPDX-License-Identifier: MIT
"""The figures of a finished report as PDF, for print: drawn anew from results of the store."""

from __future__ import annotations

import shutil
from pathlib import Path
from tempfile import TemporaryDirectory

from sam.scene import Progress
from verification.cases import all_cases
from verification.cases.case import Context
from verification.runs.store import Store
from verification.suite.verify import finished


def draw_pdf(folder: Path, progress: Progress, store: Store | None) -> list[Path]:
    """Write figures/<case>-<name>.pdf of every case of a report that has figures, and return the paths.

    A result that is not in the store is solved again. Raises FolderError when the folder holds no finished
    report.
    """
    results, known, written = finished(folder), all_cases(), []
    (folder / "figures").mkdir(exist_ok=True)
    for record in results["cases"]:
        if not record["figures"] or record["name"] not in known:
            continue
        with TemporaryDirectory() as scratch:
            out = Path(scratch)
            level = record.get("level", results["level"])
            context = Context(record["name"], out, level, progress, store=store, pdf=True)
            known[record["name"]].run(context)
            for path in sorted((out / "figures").glob("*.pdf")):
                written.append(Path(shutil.copy(path, folder / "figures" / path.name)))
    return written
