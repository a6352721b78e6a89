# SPDX-License-Identifier: MIT
"""The files of the cases: what each says, and its rows.

A file `verification/cases/<family>/<name>.toml` is a case, or several where it has tables `[cases.NAME]`,
each of which overrides the keys above it. A row is `name = [metric, tolerance, reason, words]` in a table
`[rows.KIND]`; its id is `<case>.<name>`; words may be the name of its quantity where the row has another.
Braces stand for several rows: `"{sam,fem}-radius"` with "radius, {SAM,FEM}" are two; in the name of a case
for several cases, with as many in its title and values. A reason, or words, "@name" stand in `[reasons]`, an
equation "name" in equations.toml.

Where a case has tables `[sweeps.NAME]`, the last entry of a row of a kind alone says what it takes of their
points, see `Take`: `"order p-max of sam"`, `"share of fem at depth = 3"`, `"limit peeq-max of sam | of fem"`
with what it is held against; without words that says what it is, in those of `[words]`. Points that need more
than axes are what a function returns, `frame = "NAME"`.
"""

from __future__ import annotations

import re
import tomllib
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal, NamedTuple

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from sam.scene import Problem, SceneError, check_kind, spelling
from verification.judging import Row
from verification.quantities import QUANTITIES

LEVELS = ("quick", "full")
FOLDER = Path(__file__).resolve().parent / "cases"
FAMILIES = (
    *("hertz", "plastic", "sliding", "cyclic", "moving", "line", "published", "energy"),
    *("coated", "rough", "periodic", "film", "running_in"),
    *("limits", "cost", "peers", "certificates", "robustness"),
)
"""Folders of cases, in the order of the report."""
ROW = "a row is [metric, tolerance, reason, words, take]; without words its name is a quantity"
WORDS = {
    "sam": "SAM",
    "fem": "FEM",
    "value": "",
    "order": "observed order of convergence",
    "largest": "largest deviation of all points",
    "last": "finest grid",
    "pair": "SAM against FEM",
    "law linear": "linear hardening",
    "law swift": "Swift's law",
    "law perfect": "perfect plasticity",
    "law prager": "Prager's law",
    "elements": "{} elements in the radius",
    "friction": "μ = {}",
    "steps": "{} load steps",
}
"""What rows say of a model, a statistic, an axis or its value ("{}"); a case has more under `words`."""
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

    def words(self, own: Mapping[str, str] = MappingProxyType({})) -> str:
        """For the reader, of a row that says no more. own: the words of the case."""
        known = {**{name: quantity.words for name, quantity in QUANTITIES.items()}, **WORDS, **own}
        at = [
            known.get(f"{axis} {point}") or known.get(axis, axis.replace("-", " ") + " {}").format(point)
            for axis, sign, value in self.at
            for point in [value if sign == "=" else f"{sign} {value}"]
        ]
        column, how = (known.get(name, name.replace("-", " ")) for name in (self.column, self.statistic))
        return ", ".join(filter(None, [column, *(known.get(name, name) for name in self.of), *at, how]))

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


class Claim(NamedTuple):
    """A row with the variant, model and what it is held against, its quantity, what it takes of sweeps."""

    row: Row
    variant: str
    model: str
    against: str
    quantity: str
    take: tuple[Take, ...] = ()

    @property
    def name(self) -> str:
        """Of the row, without that of its case."""
        return self.row.id.partition(".")[2]

    @property
    def table(self) -> str:
        """Where it stands in its file."""
        return "rows." + "/".join(filter(None, (self.variant, self.model, self.against)))


class SweepFile(BaseModel):
    """Points at which the scene of a case is solved. models: that solve each; axes: key of the scene or
    recipe -> its values, or name -> the keys and recipes of a value; quick: axes with other values at that
    level; columns: quantity, or a function beside the file -> "value", "between" (SAM against FEM), or the
    metric of its error against the reference, a list of names for values alone; size: what is refined, for
    orders and limits.
    """

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)

    models: tuple[Literal["sam", "fem", "fem-3d", "fem-plane-strain"], ...]
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

    equations: (what, formula, source) of the independent answer; levels: at which of LEVELS it runs, none:
    only when it is named. Without `scene` the module of the same name in its folder measures it; with one:

    scene: of `verification/scenes`; set: key of the scene, as `loading.force` -> its value here, in SI; vary:
    recipe of `verification.cases.recipes` -> its value; quick: `set` and `vary` that differ at that level;
    models: that solve it; runs: name -> {model, set, vary}, beside these, which need not converge; variants:
    name -> {words, set, vary} of the scene, each solved and measured by itself if rows name it; values:
    quantity -> the number that it is held against; reference: an independent answer, a name in
    `verification.references`; figures: kinds of `verification.cases.kinds`; claims: its rows; sweeps: its
    points beside the scene itself; setting: (name, number with unit) for the reader; notes: sentences below
    the tables; views: pictures in space; labels: what figures say of a column, with the unit in which it is
    drawn, of an axis ("{}": its value) or of a single value; captions: of figures, by their names.

    frame: function beside the file that returns the points instead of sweeps; of such functions, tables: that
    return one of the frame; data: that hands numbers of it to the pages; cannot: that says why the case does
    not run here. alone: it measures times, so that nothing runs beside it and a later run measures again.

    allowance: rows of SAM against FEM that hold the difference over what refinement allows, known from both
    models at the `coarser` resolution.
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
    models: tuple[Literal["sam", "fem", "fem-3d", "fem-plane-strain"], ...] = ()
    runs: dict[str, dict[str, Any]] = {}
    variants: dict[str, dict[str, Any]] = {}
    reference: str = ""
    coarser: tuple[int, ...] = ()
    allowance: tuple[str, ...] = ()
    figures: tuple[str, ...] = ()
    labels: dict[str, str] = {}
    captions: dict[str, str] = {}
    views: tuple[str, ...] = ()
    claims: tuple[Claim, ...]
    sweeps: dict[str, SweepFile] = {}
    frame: str = ""
    tables: tuple[str, ...] = ()
    data: str = ""
    alone: bool = False
    cannot: str = ""
    notes: tuple[str, ...] = ()
    setting: tuple[tuple[str, str], ...] = ()

    @property
    def rows(self) -> tuple[Row, ...]:
        """What is claimed, for the judge."""
        return tuple(claim.row for claim in self.claims)

    @property
    def taken(self) -> tuple[Claim, ...]:
        """The claims about points of sweeps."""
        return tuple(claim for claim in self.claims if claim.take)

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
    check_kind(content, "verification case", str(path))
    own, reasons, words = (content.pop(key, {}) for key in ("cases", "reasons", "words"))
    common = {"name": path.stem.replace("_", "-"), "family": path.parent.name, "path": path}
    named: dict[str, dict[str, Any]] = {}
    for heads, case in own.items():
        for k, name in enumerate(names := _braces(heads)):
            one = {
                key: value if key == "rows" else _chosen(value, k, len(names)) for key, value in case.items()
            }
            named[name] = merged(named.get(name, {}), one)
    cases = [merged(content, case | {"name": name}) for name, case in named.items()] if own else [content]
    return [_case(common | case, reasons, words) for case in cases]


def _chosen(value: Any, k: int, count: int) -> Any:
    """The one of `count` texts or numbers that braces stand for; other values as they are."""
    if isinstance(value, dict):
        return {key: _chosen(each, k, count) for key, each in value.items()}
    if not isinstance(value, str) or len(texts := _braces(value)) != count or count == 1:
        return value
    return float(texts[k]) if re.fullmatch(r"[0-9.e+-]+", texts[k]) else texts[k]


def merged(first: Mapping, second: Mapping) -> dict:
    """Nested tables, the second's values before the first's."""
    both = {k: merged(first[k], v) if isinstance(v, dict) and k in first else v for k, v in second.items()}
    return {**first, **both}


def _case(content: dict[str, Any], reasons: Mapping[str, str], own: Mapping[str, str]) -> CaseFile:
    """One case of a file. Raises SceneError with every fault of it."""
    faults: list[Problem] = []
    tables: dict[str, dict[str, Any]] = {}
    for heads, named in content.pop("rows", {}).items():
        for head in _braces(heads):
            tables[head] = tables.get(head, {}) | named
    claims: list[Claim] = []
    for table, named in tables.items():
        for key, cells in named.items():
            try:
                claims += _claims(content, table, key, [_full(cell, reasons) for cell in cells], own=own)
            except ValidationError as error:
                faults += _faults(error, f"rows.{table}.{key}")
            except (KeyError, TypeError, ValueError, AttributeError):
                faults.append(Problem(f"rows.{table}.{key}", spelling(cells), ROW))
    ids = Counter(claim.row.id for claim in claims)
    faults += [Problem("rows", name, "occurs twice") for name, times in sorted(ids.items()) if times > 1]
    content["equations"] = [_equations().get(str(each), each) for each in content.get("equations", ())]
    lists = {key: tuple(value) for key, value in content.items() if isinstance(value, list)}
    lists |= {key: tuple(map(tuple, lists[key])) for key in ("equations", "setting") if key in lists}
    try:
        case = CaseFile(**{**content, **lists}, claims=tuple(claims))
        if not case.sweeps and not case.frame:
            said = "its fifth entry takes of sweeps: there are none"
            faults += [Problem("rows", claim.row.id, said) for claim in case.taken]
    except ValidationError as error:
        faults += _faults(error)
    if faults:
        raise SceneError(faults, str(content["path"]))
    return case


def _claims(
    content: Mapping[str, Any], table: str, key: str, cells: list, *, own: Mapping[str, str]
) -> Iterator[Claim]:
    """What an entry of a table stands for. The table is of a kind, `exact`, or, where two models are held
    against each other or one against something, `sam/fem`, `sam/exact`, after the name of a variant of the
    scene if there are; own: words of the case.
    """
    metric, tolerance, reason, *more = cells
    first, _, rest = table.partition("/")
    variant, rest = (first, rest) if first in content.get("variants", {}) else ("", table)
    model, _, against = rest.rpartition("/")
    lead = f"{variant}-" * bool(variant) + f"{model}-" * bool(model and against != "fem")
    of = f", {content['variants'][variant]['words']}" if variant else ""
    of += f", {model.upper()}" + " against FEM" * (against == "fem") if model else ""
    names, points = _braces(key), bool(content.get("sweeps") or content.get("frame"))
    takes = _braces(more.pop()) if len(more) == 2 or (points and not model and more) else []
    words = _braces(more[0]) if more else []
    if len(more) > 1 or any(len(each) not in (0, len(names)) for each in (takes, words)):
        raise ValueError(ROW)
    quantities = words if words and all(each in QUANTITIES for each in words) else names
    said = {"case": content["name"], "metric": metric, "tolerance": tolerance, "reason": reason}
    said["kind"] = "model" if against == "fem" else against
    for k, name in enumerate(names):
        take = Take.of_row(takes[k]) if takes else ()
        if quantities is words or not (words or take):
            quantity = f"{QUANTITIES[quantities[k]].words}{of}"
        else:
            quantity = words[k] if words else take[0].words(own)
        row = Row(id=f"{content['name']}.{lead}{name}", quantity=quantity, **said)
        yield Claim(row, variant, model, against, quantities[k], take)


def _faults(error: ValidationError, *above: str) -> list[Problem]:
    """What pydantic says of a file, by key."""
    return [
        Problem(".".join((*above, *map(str, item["loc"]))), spelling(item["input"]), item["msg"])
        for item in error.errors(include_url=False)
    ]


def _full(cell: Any, reasons: Mapping[str, str]) -> Any:
    """What stands in `[reasons]` for "@name"."""
    return reasons[cell[1:]] if isinstance(cell, str) and cell.startswith("@") else cell


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
