# SPDX-License-Identifier: MIT
"""Run each notebook of the gallery in a kernel: it ends without an error or a warning, says how well its
numbers are known, draws, and leaves no file; its script has at most 40 lines.
"""

import os
import re
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from tempfile import TemporaryDirectory

import nbformat
from nbclient import NotebookClient

GALLERY = Path(__file__).resolve().parents[1] / "auto_gallery"


def faults_of(path: Path) -> list[str]:
    """What is wrong with a notebook once it has run. Raises CellExecutionError where a cell fails."""
    notebook = nbformat.read(path, as_version=4)
    with TemporaryDirectory() as folder:
        NotebookClient(notebook, timeout=120, resources={"metadata": {"path": folder}}).execute()
        left = [entry.name for entry in Path(folder).iterdir()]
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", ())]
    streams = {
        name: "".join(each["text"] for each in outputs if each.get("name") == name)
        for name in ("stdout", "stderr")
    }
    said = streams["stdout"]
    checks = {
        "more than 40 lines": len(path.with_suffix(".py").read_text(encoding="utf-8").splitlines()) > 40,
        "no cells or elements": not re.search(r"\d+ cells of|\d+ elements", said),
        "no uncertainty": not re.search(r"^uncertainty: .* times the estimated error", said, re.MULTILINE),
        "no picture": not any("image/png" in output.get("data", {}) for output in outputs),
        f"warns: {streams['stderr']}": bool(streams["stderr"]),
        f"leaves {left}": bool(left),
    }
    return [f"{path.stem}: {fault}" for fault, found in checks.items() if found]


if __name__ == "__main__":
    notebooks = sorted(GALLERY.rglob("*.ipynb"))
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        faults = [fault for found in pool.map(faults_of, notebooks) for fault in found]
    print(f"{len(notebooks)} notebooks run")
    sys.exit("\n".join(faults) if faults or not notebooks else 0)
