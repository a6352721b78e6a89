# SPDX-License-Identifier: MIT
"""All rows of the robustness matrix, from `rows.toml`, and the verdict on a cell.

A row is one extreme. Beforehand it says for each model whether it must be right (and by which checks), end in
an error (and which words tell the user what to change), or does not apply; each with the reason. A cell that
does otherwise is wrong, and so is one that dies of another exception, that numpy warns of, or whose numbers
are not finite.
"""

import time
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources
from math import isfinite
from typing import Any

from pydantic import ValidationError

from sam.scene import InputError, Result, SceneError, problems
from verification.robustness.matrix.checks import TOLERANCE, Bench, Deviation, Trial, check_of
from verification.robustness.matrix.scenes import fit_with, scene_with
from verification.runs.models import FEM, FEM_3D, SAM, ModelError

RIGHT, ERROR, ABSENT, WRONG = KINDS = ("right", "error", "not applicable", "wrong")
"""What a cell is."""


@dataclass(frozen=True)
class Row:
    """An extreme. changes: what differs from the base; expected: model -> what must become of it: "right",
    the reason and the checks, "error", the reason, the status of the result ("unsolved": none) and words of
    the message, or "absent" and the reason; quick: at this level too.
    """

    name: str
    topic: str
    what: str
    changes: Mapping[str, Any]
    expected: Mapping[str, Sequence]
    quick: bool = False


@dataclass(frozen=True)
class Cell:
    """The verdict. kind: of KINDS; text: message of an error, or what is wrong; deviations: of a right cell;
    seconds: of processor time.
    """

    kind: str
    text: str = ""
    deviations: Sequence[Deviation] = ()
    seconds: float = 0.0

    @property
    def worst(self) -> Deviation | None:
        """The comparison that is nearest to its bound, certificates last."""
        return max(self.deviations, key=lambda each: (each.reason != TOLERANCE, each.share), default=None)


@cache
def table() -> dict:
    """The file: `quick`, `changes`, `checks`, `expected`, and the topics with their rows."""
    return tomllib.loads(resources.files(__package__).joinpath("rows.toml").read_text(encoding="utf-8"))


def topics() -> dict[str, str]:
    """Of what there must be rows at level full: name -> in words."""
    return {name: words for name, (words, *_) in table()["topics"].items()}


def all_rows(level: str) -> list[Row]:
    """The rows of a level, by topic."""
    quick, found = table()["quick"], []
    for topic, (_, *rows) in table()["topics"].items():
        for name, what, *rest in rows:
            own: dict = {}
            for part in (each for each in rest if isinstance(each, dict)):
                for shared in part.get("with", ()):
                    own |= table()["changes"][shared]
                own |= {key: value for key, value in part.items() if key != "with"}
            said = [each for each in rest if not isinstance(each, dict)]
            said = [table()["expected"].get(each, [each]) if isinstance(each, str) else each for each in said]
            if len(said) == 1:
                said *= 2
            elif said[0] == ["every"]:
                said = said[1:] * 3
            expected = dict(zip((SAM, FEM, FEM_3D), said, strict=False))
            found.append(Row(name, topic, what, own, expected, name in quick))
    return found if level == "full" else [row for row in found if row.quick]


def judge(row: Row, model: str, bench: Bench) -> Cell:
    """Solve a cell and compare with what the row expects."""
    kind, reason, *rest = row.expected[model]
    if kind == "absent":
        return Cell(ABSENT, reason)
    began, scene, result, text, wrong = time.process_time(), None, None, "", ""
    found: list[Deviation] = []
    try:
        if any(key.startswith("fit.") for key in row.changes):
            fit_with(row.changes)
        else:
            scene = scene_with(row.changes)
            result = bench.solve(scene, model)
    except ValidationError as error:
        text = "; ".join(map(str, problems(error)))
    except (SceneError, InputError, ModelError) as error:
        text = str(error)
    except Exception as error:  # whatever else it is, it is wrong
        wrong = f"{type(error).__name__}: {error}"
    if result is not None and not result.converged:
        text = f"{result.status}: {result.message}"
    if kind == "error":
        wrong = wrong or _wrong_error(result, text, *rest)
    elif result is None:
        wrong = wrong or f"refused: {text}"
    elif not result.converged:
        wrong = text
    else:
        wrong, found = _wrong_result(rest, Trial(scene, model, result, bench))
    return Cell(WRONG if wrong else kind, wrong or text, found, time.process_time() - began)


def _wrong_error(result: Result | None, text: str, status: str, *words: str) -> str:
    """What is wrong with an error; empty where it is the expected one."""
    if result is not None and result.converged:
        return "converged, but an error was expected"
    if status != ("unsolved" if result is None else result.status):
        return f"expected {status if status != 'unsolved' else 'a refusal'}: {text}"
    missing = [word for word in words if word not in text]
    return f"the message does not say {missing}: {text}" if missing else ""


def _wrong_result(checks: Sequence, trial: Trial) -> tuple[str, list[Deviation]]:
    """What is wrong with a converged result, empty where nothing is; and its comparisons."""
    quantities, named = trial.result.quantities, table()["checks"]
    broken = [name for name, value in quantities.items() if value is not None and not isfinite(value)]
    if broken:
        return f"not finite: {', '.join(broken)}", []
    try:
        checks = [named.get(said, said) if isinstance(said, str) else said for said in checks]
        found = [deviation for said in checks for deviation in check_of(said)(trial)]
    except (RuntimeError, ValueError) as error:
        return str(error), []
    beyond = [each for each in found if not each.share <= 1.0]
    text = "; ".join(f"{each.what}: {each.error:.3g} > {each.bound:g}" for each in beyond)
    return text or ("" if found else "nothing was compared"), found
