# SPDX-License-Identifier: MIT
"""The files of the cases: what each says, and its rows.

A file `verification/cases/<family>/<name>.toml` is a case, or several where it has tables `[cases.NAME]`,
each of which overrides the keys above it. A row is `name = [metric, tolerance, reason, words]` in a table
`[rows.KIND]`; its id is `<case>.<name>`; words may be the name of its quantity where the row has another.
Braces stand for several rows: `"{sam,fem}-radius"` with "radius, {SAM,FEM}" are two. A reason "@name"
stands in `[reasons]`, an equation "name" in equations.toml.

Where a case has tables `[sweeps.NAME]`, a fifth entry says what a row takes of the points of the sweeps, see
`Take`: `"order p-max of sam"`, `"share of fem at depth = 3"`, `"limit peeq-max of sam | of fem"` with what it
is held against. Points that need more than axes are what a function returns, `frame = "NAME"`.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any, Literal, NamedTuple

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

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
ROW = "a row is [metric, tolerance, reason, words, take]; without words its name is a quantity"
_TAKE = re.compile(
    r"(?:([a-z-]+) )??([a-z0-9-]+)(?: of ([a-z0-9/ -]+?))?(?: at (.+))?|([-+.0-9e]+)", re.ASCII
)
_AT = re.compile(r"([a-zA-Z0-9_.-]+) (=|<|>) (\S+)")


class Take(NamedTuple):
    """What a row takes of the frame of the sweeps: `STATISTIC COLUMN of SWEEP MODEL at AXIS = VALUE, ...`.

    statistic: a name in `verification.cases.sweep.STATISTICS` or of a function beside the file; of: names of
    sweeps and models; at: (axis, comparison, value). What it is held against follows a bar: a number alone,
    another take, or `of` and names in place of its own.
    """

    statistic: str
    column: str
    of: tuple[str, ...] = ()
    at: tuple[tuple[str, str, str], ...] = ()
    number: float | None = None

    @classmethod
    def of_row(cls, text: str) -> tuple[Take, ...]:
        """What a row takes, and what that is held against where it says so. Raises ValueError."""
        first, *others = text.split(" | ")
        take = cls.parse(first)
        held = (
            cls(take.statistic, take.column, tuple(other.split()[1:]), take.at)
            if other.startswith("of ")
            else cls.parse(other)
            for other in others
        )
        return take, *held

    @classmethod
    def parse(cls, text: str) -> Take:
        """One side of a take. Raises ValueError for what does not read as one."""
        found = _TAKE.fullmatch(text.strip())
        if not found:
            raise ValueError(f"no take: {text}")
        statistic, column, of, at, alone = found.groups()
        if alone or re.fullmatch(r"[0-9.]+", column):
            return cls("", "", number=float(alone or column))
        conditions = [_AT.fullmatch(each.strip()) for each in at.split(",")] if at else []
        read = tuple((c[1], c[2], c[3]) for c in conditions if c)
        if len(read) < len(conditions):
            raise ValueError(f"no condition: {at}")
        return cls(statistic or "value", column, tuple((of or "").split()), read)


class SweepFile(BaseModel):
    """Points at which the scene of a case is solved.

    models: that solve each; axes: key of the scene or recipe -> its values, or name -> the keys and recipes
    of a value; quick: axes with other values at that level; columns: quantity, or a function beside the
    file -> "value", "between" (SAM against FEM), or the metric of its error against the reference, a list of
    names for values alone; size: what is refined, for orders and limits.
    """

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)

    models: tuple[Literal["sam", "fem", "fem-3d"], ...]
    axes: dict[str, list | dict[str, dict[str, Any]]] = Field(min_length=1)
    quick: dict[str, list | dict[str, dict[str, Any]]] = {}
    columns: dict[str, Literal["value", "between", "relative", "absolute", "relative_l2"]]
    size: Literal["", "cell", "step"] = ""

    @field_validator("models", mode="before")
    @classmethod
    def _accept_lists(cls, value: object) -> object:
        return tuple(value) if isinstance(value, list) else value

    @field_validator("columns", mode="before")
    @classmethod
    def _accept_names(cls, value: object) -> object:
        return dict.fromkeys(value, "value") if isinstance(value, list) else value


class CaseFile(BaseModel):
    """A case as its file says it.

    equations: (what, formula, source) of the independent answer; levels: at which of LEVELS it runs,
    none: only when it is named. Without `scene` the module of the same name in its folder measures it;
    with one:

    scene: of `verification/scenes`; set: key of the scene, as `loading.force` -> its value here, in SI;
    vary: recipe of `verification.cases.recipes` -> its value; quick: `set` and `vary` that differ at that
    level; models: that solve it; runs: name -> {model, set, vary}, beside these, which need not converge;
    variants: name -> {words, set, vary} of the scene, each solved and measured by itself if rows or `also`
    name it; values: quantity -> the number that it is held against; reference: an
    independent answer, a name in `verification.references`; figures: kinds of `verification.cases.kinds`;
    claims: table of rows -> name -> its quantity, of those without a take; sweeps: its points beside the
    scene itself; setting: (name, number with unit) for the reader; takes: id of a row -> what it takes of
    them, see `Take`; notes: sentences below the tables; views: pictures in space.

    frame: function beside the file that returns the points instead of sweeps; of such functions, tables:
    that return one of the frame; data: that hands numbers of it to the pages; cannot: that says why the
    case does not run here. alone: it measures times, so that nothing runs beside it and a later run
    measures again.

    allowance: rows of SAM against FEM that hold the difference over what refinement allows, known from
    both models at the `coarser` resolution; against: recipe -> value of another scene, solved by the same
    models, against which rows hold what changes.
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
    runs: dict[str, dict[str, Any]] = {}
    variants: dict[str, dict[str, Any]] = {}
    also: tuple[str, ...] = ()
    reference: str = ""
    coarser: tuple[int, ...] = ()
    allowance: tuple[str, ...] = ()
    against: dict[str, Any] = {}
    figures: tuple[str, ...] = ()
    views: tuple[str, ...] = ()
    rows: tuple[Row, ...]
    claims: dict[str, dict[str, str]]
    sweeps: dict[str, SweepFile] = {}
    frame: str = ""
    tables: tuple[str, ...] = ()
    data: str = ""
    alone: bool = False
    cannot: str = ""
    takes: dict[str, tuple[Take, ...]] = {}
    notes: tuple[str, ...] = ()
    setting: tuple[tuple[str, str], ...] = ()

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
    cases = [merged(content, case | {"name": name}) for name, case in own.items()] if own else [content]
    return [_case(common | case, reasons) for case in cases]


def merged(first: Mapping, second: Mapping) -> dict:
    """Nested tables, the second's values before the first's."""
    both = {k: merged(first[k], v) if isinstance(v, dict) and k in first else v for k, v in second.items()}
    return {**first, **both}


def _case(content: dict[str, Any], reasons: Mapping[str, str]) -> CaseFile:
    """One case of a file. Raises SceneError with every fault of it."""
    faults: list[Problem] = []
    takes: dict[str, tuple[Take, ...]] = {}
    variants, tables = content.get("variants", {}), dict[str, dict[str, Any]]()
    for heads, named in content.pop("rows", {}).items():
        for head in _braces(heads):
            tables[head] = tables.get(head, {}) | named
    more = {"reasons": reasons, "variants": variants, "takes": takes, "faults": faults}
    rows = [row for table, named in tables.items() for row in _rows(content["name"], table, named, **more)]
    named = [each for each in content.get("equations", ()) if isinstance(each, str)]
    content["equations"] = [_equations().get(e, e) if e in named else e for e in content.get("equations", ())]
    lists = {key: tuple(value) for key, value in content.items() if isinstance(value, list)}
    lists |= {key: tuple(map(tuple, lists[key])) for key in ("equations", "setting") if key in lists}
    twice = sorted({row.id for row in rows if sum(other.id == row.id for other in rows) > 1})
    faults += [Problem("rows", name, "occurs twice") for name in twice]
    if not content.get("sweeps") and not content.get("frame"):
        faults += [Problem("rows", name, "its fifth entry takes of sweeps: there are none") for name in takes]
    claims = {
        table: {
            name: quantity
            for key, cells in own.items()
            if len(cells) < 5
            for name, quantity in zip(_braces(key), _braces(_named(key, cells)), strict=True)
        }
        for table, own in tables.items()
    }
    try:
        case = CaseFile(**{**content, **lists}, rows=tuple(rows), claims=claims, takes=takes)
    except ValidationError as error:
        faults += _faults(error)
    if faults:
        raise SceneError(faults, str(content["path"]))
    return case


def head_of(table: str, variants: Mapping) -> tuple[str, str, str]:
    """Variant, model and what it is held against, of the name of a table of rows; "" for what it lacks."""
    first, _, rest = table.partition("/")
    variant, rest = (first, rest) if first in variants else ("", table)
    model, _, against = rest.rpartition("/")
    return variant, model, against


def _rows(
    case: str, table: str, named: Mapping, *, reasons: Mapping, variants: Mapping, takes: dict, faults: list
) -> Iterator[Row]:
    """The rows of a table, of kind `exact`, or, where two models are held against each other or one
    against something, `sam/fem`, `sam/exact`, after the name of a variant of the scene if there are; what
    they take is added to `takes`, what is wrong with one to `faults`.
    """
    variant, model, against = head_of(table, variants)
    kind = "model" if against == "fem" else against
    lead = f"{variant}-" * bool(variant) + (f"{model}-" if model and kind != "model" else "")
    of = f", {variants[variant]['words']}" if variant else ""
    of += f", {model.upper()}" + " against FEM" * (kind == "model") if model else ""
    for key, cells in named.items():
        try:
            metric, tolerance, reason, *words = cells
            reason = reasons[reason[1:]] if reason.startswith("@") else reason
            names, of_names, take = _braces(key), _braces(_named(key, cells)), words[1:]
            alone = not words or words[0] in QUANTITIES
            said = [f"{QUANTITIES[name].words}{of}" for name in of_names] if alone else _braces(words[0])
            if take:
                sides = map(Take.of_row, _braces(*take))
                takes |= {f"{case}.{name}": side for name, side in zip(names, sides, strict=True)}
            for name, quantity in zip(names, said, strict=True):
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


def _named(name: str, cells: Sequence) -> str:
    """The quantity of a row, or the names of several."""
    return cells[3] if len(cells) > 3 and cells[3] in QUANTITIES else name


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
