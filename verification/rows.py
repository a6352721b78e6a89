# SPDX-License-Identifier: MIT
"""The files of the cases: what each says, and its rows.

A file `verification/cases/<family>/<name>.toml` is a case, or several where it has tables `[cases.NAME]`,
each of which overrides the keys above it. A row is `name = [metric, tolerance, reason, words]` in a table
`[rows.KIND]`; its id is `<case>.<name>`. Braces stand for several rows: `"{sam,fem}-radius"` with
"radius, {SAM,FEM}" are two. A reason "@name" stands in `[reasons]`, an equation "name" in equations.toml.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from sam.scene import Problem, SceneError, spelling
from verification.judging import Row
from verification.quantities import QUANTITIES

LEVELS = ("quick", "full")
FOLDER = Path(__file__).resolve().parent / "cases"
FAMILIES = (
    *("hertz", "plastic", "sliding", "cyclic", "moving", "published", "energy"),
    *("coated", "rough", "film", "running_in"),
    *("limits", "cost", "peers", "certificates", "robustness"),
)
"""Folders of cases, in the order of the report."""
ROW = "a row is [metric, tolerance, reason, words]; without words its name is a quantity"


class CaseFile(BaseModel):
    """A case as its file says it.

    equations: (what, formula, source) of the independent answer; levels: at which of LEVELS it runs,
    none: only when it is named. Without `scene` the module of the same name in its folder measures it;
    with one:

    scene: of `verification/scenes`; set: key of the scene, as `loading.force` -> its value here, in SI;
    vary: recipe of `verification.cases.recipes` -> its value; quick: `set` and `vary` that differ at that
    level; models: that solve it; values: quantity -> the number that it is held against; reference: an
    independent answer, a name in `verification.references`; figures: kinds of `verification.cases.kinds`;
    claims: table of rows -> the names in it.
    """

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)

    name: str
    family: str
    path: Path
    title: str = Field(min_length=1)
    question: str = ""
    equations: tuple[tuple[str, str, str], ...] = ()
    levels: tuple[Literal["quick", "full"], ...] = ("quick", "full")
    scene: str = ""
    set: dict[str, Any] = {}
    vary: dict[str, Any] = {}
    values: dict[str, float] = {}
    quick: dict[str, Any] = {}
    models: tuple[Literal["sam", "fem", "fem-3d"], ...] = ()
    reference: str = ""
    figures: tuple[str, ...] = ()
    rows: tuple[Row, ...]
    claims: dict[str, tuple[str, ...]]

    @property
    def own(self) -> bool:
        """Whether it is a file of a user."""
        return FOLDER not in self.path.parents


@cache
def case_files() -> Mapping[str, CaseFile]:
    """Name -> case of the suite, in the order of the families and of the names of their files."""
    paths = [path for family in FAMILIES for path in sorted((FOLDER / family).glob("*.toml"))]
    cases = [case for path in paths for case in read_cases(path)]
    return {case.name: case for family in FAMILIES for case in cases if case.family == family}


@cache
def _equations() -> Mapping[str, Sequence[str]]:
    return tomllib.loads((FOLDER / "equations.toml").read_text(encoding="utf-8"))


def read_cases(path: Path) -> list[CaseFile]:
    """The cases of a file. Raises SceneError, which names file, key, value and what is allowed."""
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise SceneError([Problem("case file", path.name, str(error))], str(path)) from error
    own, reasons = content.pop("cases", {}), content.pop("reasons", {})
    common = {"name": path.stem.replace("_", "-"), "family": path.parent.name, "path": path}
    cases = [_merged(content, case | {"name": name}) for name, case in own.items()] if own else [content]
    return [_case(common | case, reasons) for case in cases]


def _merged(first: Mapping, second: Mapping) -> dict:
    """Nested tables, the second's values before the first's."""
    both = {k: _merged(first[k], v) if isinstance(v, dict) and k in first else v for k, v in second.items()}
    return {**first, **both}


def _case(content: dict[str, Any], reasons: Mapping[str, str]) -> CaseFile:
    """One case of a file. Raises SceneError with every fault of it."""
    faults: list[Problem] = []
    tables = content.pop("rows", {})
    rows = [
        row
        for table in tables
        for row in _rows(content["name"], table, tables[table], reasons=reasons, faults=faults)
    ]
    named = [each for each in content.get("equations", ()) if isinstance(each, str)]
    content["equations"] = [_equations().get(e, e) if e in named else e for e in content.get("equations", ())]
    lists = {key: tuple(value) for key, value in content.items() if isinstance(value, list)}
    lists["equations"] = tuple(map(tuple, lists["equations"]))
    twice = sorted({row.id for row in rows if sum(other.id == row.id for other in rows) > 1})
    faults += [Problem("rows", name, "occurs twice") for name in twice]
    try:
        case = CaseFile(
            **{**content, **lists}, rows=tuple(rows), claims={k: tuple(v) for k, v in tables.items()}
        )
    except ValidationError as error:
        faults += _faults(error)
    if faults:
        raise SceneError(faults, str(content["path"]))
    return case


def _rows(case: str, table: str, named: Mapping, *, reasons: Mapping, faults: list[Problem]) -> Iterator[Row]:
    """The rows of a table, of kind `exact`, or, where two models are held against each other or one against
    something, `sam/fem`, `sam/exact`; what is wrong with one is added to `faults`.
    """
    model, _, against = table.rpartition("/")
    kind = "model" if against == "fem" else against
    lead = f"{model}-" if model and kind != "model" else ""
    of = f", {model.upper()}" + " against FEM" * (kind == "model") if model else ""
    for key, cells in named.items():
        try:
            metric, tolerance, reason, *words = cells
            reason = reasons[reason[1:]] if reason.startswith("@") else reason
            said = words or [f"{QUANTITIES[key].words}{of}"]
            for name, quantity in zip(_braces(key), _braces(*said), strict=True):
                yield Row(
                    id=f"{case}.{lead}{name}",
                    case=case,
                    quantity=quantity,
                    metric=metric,
                    tolerance=tolerance,
                    reason=reason,
                    kind=kind,
                )
        except ValidationError as error:
            faults += _faults(error, f"rows.{table}.{key}")
        except (KeyError, TypeError, ValueError, AttributeError):
            faults.append(Problem(f"rows.{table}.{key}", spelling(cells), ROW))


def _faults(error: ValidationError, *above: str) -> list[Problem]:
    """What pydantic says of a file, by key."""
    return [
        Problem(".".join((*above, *map(str, item["loc"]))), spelling(item["input"]), item["msg"])
        for item in error.errors(include_url=False)
    ]


def _braces(text: str) -> list[str]:
    """The texts that one with braces stands for: a{b,c} for ab and ac."""
    found = re.search(r"\{([^{}]*,[^{}]*)\}", text)
    if not found:
        return [text]
    return [
        each
        for part in found[1].split(",")
        for each in _braces(text[: found.start()] + part + text[found.end() :])
    ]


def load_rows() -> tuple[Row, ...]:
    """The rows of all cases of the suite, in their order."""
    return tuple(row for case in case_files().values() for row in case.rows)
