# SPDX-License-Identifier: MIT
"""Speed, memory and counts of this code over those of the code that was published last, in turns."""

import json
import os
import re
import resource
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from compileall import compile_dir
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from verification.cases.case import FEM, FEM_3D, SAM, Context, DataFrame, SmallTable
from verification.runs.code_version import OF_CASES
from verification.runs.threads import EVERY_LIBRARY

ROOT = Path(__file__).resolve().parents[3]
PAIRS, LOSS = 5, 1.2
FEW, SHARE = 2, 0.05  # by how much a count may grow
ROUNDING = 1e-9  # of the largest quantity in a unit: what is less is no result


@dataclass(frozen=True)
class Rung:
    """A scene file of the published code. changes: key -> its value here, as TOML; more: further lines."""

    words: str
    file: str
    changes: Mapping[str, str] = field(default_factory=dict)
    more: str = ""
    model: str = SAM

    def text(self, tree: Path) -> str:
        """The scene file, of the file in a tree of the project."""
        text = (tree / f"verification/scenes/{self.file}.toml").read_text(encoding="utf-8")
        for key, value in self.changes.items():
            text, count = re.subn(rf"^{key} = .*$", f"{key} = {value}", text, flags=re.MULTILINE)
            if count != 1:
                raise RuntimeError(f"{self.file}.toml has {count} lines of {key}")
        return text + self.more


PATCH = {"cells": "[128, 128]", "force": '"0.3 N"', "sq": '"0.3 um"'}
SWIFT = """layers = 13
depth = "13 um"
[body.plasticity]
law = "swift"
B = "945 MPa"
C = 20
n = 0.121
[solver]
tolerance = 1e-3
"""
"""For rough.toml, whose last table is [grid]."""
PATH = {"path": '{ start = ["-3.9 um", "0 um"], end = ["3.9 um", "0 um"], step_per_radius = 4 }'}
CYCLES = {"cycles": "2", "steps": "3", "unload_steps": "3"}
ELEMENTS = {"steps": "5", "cells_per_radius": "16"}
COARSE = {"steps": "1", "unload": "false", "cells_per_radius": "6"}
RUNGS = (
    Rung("tiny elastic sphere", "hertz-sphere", {"cells": "[33, 33]"}),
    Rung("sphere sliding on a body that yields", "starts/sliding", {"steps": "2"}),
    Rung("rough elastic, 256 × 256 cells", "starts/rough", {"cells": "[256, 256]"}),
    Rung("sphere on Swift steel", "plastic-swift-rigid", {"steps": "5"}),
    Rung("moving sphere on Swift steel", "moving-sphere", PATH),
    Rung("rough plastic step, 128 × 128 × 13 cells", "starts/rough", PATCH, SWIFT),
    Rung("running-in, 64 × 64 cells, 2 cycles", "running-in-bulk", CYCLES),
    Rung("sphere on Swift steel, FEM", "plastic-swift-rigid", ELEMENTS, model=FEM),
    Rung("elastic sphere, 3D FEM", "hertz-sphere", COARSE, model=FEM_3D),
)


def published() -> str:
    """The commit whose times the published report has, empty without one."""
    try:
        results = json.loads((ROOT / "reports/results.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return ""
    latest = results["provenance"]["commit"]
    ended = [case for case in results["cases"] if case["tables"]]
    of = {case["name"]: (case["reused"] or {}).get("commit") or latest for case in ended}
    return (of.get("published-code") or of.get("growth") or "").removesuffix("+")


def missing() -> str:
    """Why the published code cannot be run here, or an empty text."""
    git, asked = shutil.which("git"), f"{published()}^{{commit}}"
    if git and not subprocess.run([git, "-C", ROOT, "cat-file", "-e", asked], capture_output=True).returncode:
        return ""
    return "it runs the published code: in a git checkout with its history and reports/results.json"


def frame(context: Context) -> Iterator[dict[str, Any]]:
    """A row for each scene, see `row_of`."""
    commit = published()
    with TemporaryDirectory(prefix="samfem-published-") as place:
        tree, archive = Path(place, "tree"), f"{place}/tree.zip"
        words = ["git", "-C", ROOT, "archive", "--output", archive, commit, "--", ".", ":!reports"]
        subprocess.run(words, check=True)
        shutil.unpack_archive(archive, tree)
        for package in (each / name for each in (tree, ROOT) for name in OF_CASES):
            compile_dir(package, quiet=2)
        for k, rung in enumerate(RUNGS):
            context.progress(f"{context.case}: {rung.words}", k, len(RUNGS))
            text = rung.text(tree)
            pairs = [tuple(solved(rung, text, each) for each in (tree, ROOT)) for _ in range(PAIRS)]
            yield {"sweep": f"This code over commit {commit[:7]}", "scene": rung.words} | row_of(pairs)


def solved(rung: Rung, text: str, tree: Path) -> dict[str, Any]:
    """What `samfem solve` of a tree takes for a scene, counts and finds; the time is of the process."""
    project = tomllib.loads((tree / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    module, function = project["scripts"]["samfem"].split(":")
    with TemporaryDirectory(prefix="samfem-solve-") as folder:
        Path(folder, "scene.toml").write_text(text, encoding="utf-8")
        program = f"import sys, {module}; sys.exit({module}.{function}())"
        words = [sys.executable, "-c", program, "solve", "scene.toml", "--model", rung.model, "--out", "run"]
        own = {"PYTHONPATH": str(tree), "SAMFEM_STORE": str(Path(folder, "store")), "XDG_CACHE_HOME": folder}
        environment = os.environ | dict.fromkeys(EVERY_LIBRARY, "1") | own
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        ended = subprocess.run(words, cwd=folder, env=environment, capture_output=True, text=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        if ended.returncode:
            code = "this code" if tree == ROOT else "the published code"
            raise RuntimeError(f"{rung.words}, {code}: {ended.stderr[-400:]}")
        summary = json.loads(Path(folder, "run/summary.json").read_text(encoding="utf-8"))
    memory = summary["cost"].pop("peak_memory_bytes")
    return {
        "time": sum(after[:2]) - sum(before[:2]),  # of user and system
        "memory": memory,
        "counts": {name: count for name, count in summary["cost"].items() if isinstance(count, int)},
        "quantities": summary["quantities"],
        "tolerance": summary["scene"]["solver"]["tolerance"],
    }


def row_of(pairs: Sequence[tuple[Mapping[str, Any], ...]]) -> dict[str, Any]:
    """What both codes took in turns: medians, ratios, what grew of the counts, how far results are apart."""
    row: dict[str, Any] = {}
    for what, unit, size in (("time", "s", 1.0), ("memory", "MB", 1e6)):
        ratios = [new[what] / old[what] for old, new in pairs]
        row[f"{what} [{unit}]"] = float(np.median([new[what] for _, new in pairs])) / size
        row |= {f"{what} ratio": float(np.median(ratios))}
        row |= {f"{what} ratio of pairs": f"{min(ratios):.2f} to {max(ratios):.2f}"}
    old, new = pairs[-1]
    grown = {name: new["counts"].get(name, 0) - count for name, count in old["counts"].items()}
    row["counts-over-allowed"] = max(grown[name] / max(FEW, SHARE * old["counts"][name]) for name in grown)
    changes = (
        f"{name.replace('_', ' ')} {old['counts'][name]} {more:+d}" for name, more in grown.items() if more
    )
    difference, of = apart(old["quantities"], new["quantities"])
    row |= {"counts": ", ".join(changes) or "equal", "difference": difference}
    return row | {"most different": of if difference else "", "tolerance": new["tolerance"]}


def apart(old: Mapping[str, Any], new: Mapping[str, Any]) -> tuple[float, str]:
    """The largest relative difference of the quantities of two results, and its quantity."""
    values = {name: value for name, value in old.items() if isinstance(value, int | float) and name in new}
    largest: dict[str, float] = {}
    for name, value in values.items():
        unit = name.rpartition("_")[2]
        largest[unit] = max(abs(value), largest.get(unit, 0.0))
    return max(
        (abs((new[name] or 0.0) / value - 1.0), name)
        for name, value in values.items()
        if abs(value) > ROUNDING * largest[name.rpartition("_")[2]]
    )


def losses(frame: DataFrame) -> SmallTable:
    """The largest ratios, and every scene that takes more than LOSS times as much."""
    rows = []
    for what, words in (("time ratio", "processor time"), ("memory ratio", "peak memory")):
        beyond = frame[frame[what] > LOSS].sort_values(what, ascending=False)
        named = ", ".join(f"{row['scene']} ({row[what]:.2f})" for _, row in beyond.iterrows())
        most = frame.loc[frame[what].idxmax()]
        where = named and f"more than {LOSS} in {named}"
        where = where or f"in {most['scene']}; in no scene more than {LOSS}"
        rows.append((words, f"{most[what]:.2f}", where))
    return SmallTable("Largest ratios", ("what", "ratio", "where"), rows)
