# SPDX-License-Identifier: MIT
"""The gallery after `sphinx`, which has run its scripts: each page ends without a warning, says how well its
numbers are known, has a picture and leaves no file; its script has at most 40 lines, and its notebook is that
script. The first notebook runs again, in a kernel.
"""

import ast
import re
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import nbformat
from nbclient import NotebookClient

GALLERY = Path(__file__).resolve().parents[1] / "auto_gallery"
OUTPUT = re.compile(r"^\.\. rst-class:: sphx-glr-script-out\n(.*?)^\.\. ", re.MULTILINE | re.DOTALL)


def faults_of(path: Path) -> list[str]:
    """What is wrong with the page of a notebook, and with the notebook."""
    page, script = (path.with_suffix(end).read_text(encoding="utf-8") for end in (".rst", ".py"))
    said = "".join(OUTPUT.findall(page))  # stdout and stderr
    cells = [cell.source for cell in nbformat.read(path, as_version=4).cells if cell.cell_type == "code"]
    checks = {
        "more than 40 lines": len(script.splitlines()) > 40,
        "no cells or elements": not re.search(r"\d+ cells of|\d+ elements", said),
        "no uncertainty": not re.search(r"^ *uncertainty: .* times the estimated error", said, re.MULTILINE),
        "no picture": ".. image-sg::" not in page,
        "warns": re.search(r"\w+Warning: ", said) is not None,
        "not its script": ast.dump(ast.parse("\n".join(cells))) != ast.dump(without_docstring(script)),
    }
    return [f"{path.stem}: {fault}" for fault, found in checks.items() if found]


def without_docstring(script: str) -> ast.Module:
    """The parsed script without its first statement, which is the text of the page."""
    module = ast.parse(script)
    del module.body[0]
    return module


def faults_of_run(path: Path) -> list[str]:
    """What is wrong with a notebook once it has run. Raises CellExecutionError where a cell fails."""
    notebook = nbformat.read(path, as_version=4)
    with TemporaryDirectory() as folder:
        NotebookClient(notebook, timeout=120, resources={"metadata": {"path": folder}}).execute()
        left = [entry.name for entry in Path(folder).iterdir()]
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", ())]
    checks = {
        "no picture": not any("image/png" in output.get("data", {}) for output in outputs),
        "warns": any(output.get("name") == "stderr" for output in outputs),
        f"leaves {left}": bool(left),
    }
    return [f"{path.stem} in a kernel: {fault}" for fault, found in checks.items() if found]


if __name__ == "__main__":
    notebooks = sorted(GALLERY.rglob("*.ipynb"))
    if not notebooks:
        sys.exit(f"no notebooks in {GALLERY}: sphinx makes them, see docs in Makefile")
    faults = [fault for path in notebooks for fault in faults_of(path)]
    files = [path for path in GALLERY.with_name("gallery").rglob("*") if path.is_file()]
    left = [path.name for path in files if path.suffix not in (".py", ".rst")]
    faults += [f"the scripts leave {left}"] if left else []
    faults += faults_of_run(notebooks[0])
    print(f"{len(notebooks)} notebooks, the first of them run")
    sys.exit("\n".join(faults) or 0)
