# SPDX-License-Identifier: MIT
"""A study: one scene with some of its values varied. From a TOML file to the scenes, or to every error of it
at once.

The values are put into the tables of the scene file, and each point goes through the parser of scenes: what a
scene may hold, a study may vary. The values of one key are a list, or numbers between two ends in decimal
arithmetic, so that they are the same on every machine.
"""

import itertools
import json
import math
import random
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import Context, Decimal
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import BeforeValidator, Field, ValidationError
from pydantic_core import PydanticCustomError

from sam.scene import (
    Conflict,
    InputError,
    Inputs,
    Number,
    Problem,
    Scene,
    SceneError,
    Section,
    below,
    check_kind,
    in_unit,
    number_and_unit,
    parse_toml,
    problems,
    read_limited,
    scene_of,
    spelling,
    tables_of,
    unit_of_key,
    with_units,
)
from verification.runs import models
from verification.sensitivity import METHODS, design, size

MOST_POINTS = 10_000
SI_UNITS = ("m", "N", "Pa", "s", "m/s", "m/s**0.5")
KINDS = ("list", "range", "log", "random", "random-log")
COUNT = Number("a whole number", 1, MOST_POINTS, whole=True)

_EXACT, _ROUND = Context(prec=40), Context(prec=15)
_ENDS = 'two numbers, or two strings with units of one dimension, such as ["0.1 N", "0.5 N"], '
_ENDS += "the first below the second"
_LIST = "one or more numbers, texts, true, false or lists of these; strings with units all of one dimension"


def refused(text: str) -> PydanticCustomError:
    """What pydantic raises for a value, with what is allowed."""
    return PydanticCustomError("allowed", "allowed: {allowed}", {"allowed": text})


def _listed(value: object) -> tuple:
    if not isinstance(value, list) or not 1 <= len(value) <= MOST_POINTS:
        raise refused(_LIST)
    single = [entry for each in value for entry in (each if isinstance(each, list) else [each])]
    plain = all(isinstance(each, str | bool) or _in("", each) is not None for each in single)
    if not plain or len(set(map(si_unit, value))) > 1:
        raise refused(_LIST)
    return tuple(value)


def _ends(value: object) -> tuple:
    pair = value if isinstance(value, list) and len(value) == 2 else (None, None)
    low, high = (_in(unit_of(pair[0]), entry) for entry in pair)
    if low is None or high is None or not low < high:
        raise refused(_ENDS)
    return tuple(value)


def _positive_ends(value: object) -> tuple:
    ends = _ends(value)
    if _in(unit_of(ends[0]), ends[0]) <= 0:
        raise refused(f"{_ENDS}, both above zero")
    return ends


def unit_of(value: object) -> str:
    """The unit of a string with one; empty for anything else."""
    return number_and_unit(value)[1] if si_unit(value) else ""


def si_unit(value: object) -> str:
    """The SI unit of the dimension of a string with a unit; empty for anything else."""
    return next((unit for unit in SI_UNITS if in_unit(value, unit) is not None), "")


def _in(unit: str, value: object) -> Decimal | None:
    """A value as a number of `unit` (empty: a plain number); None if it is not one."""
    if unit:
        return in_unit(value, unit)
    plain = isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < math.inf
    return Decimal(repr(value)) if plain else None


Ends = Annotated[tuple | None, BeforeValidator(_ends)]
PositiveEnds = Annotated[tuple | None, BeforeValidator(_positive_ends)]


class Axis(Section):
    """The values of one key: a list, or `count` of them between two ends, both included but not by the random
    ones. range: equal distances; log: equal ratios; random, random-log: drawn uniformly, or so in the
    logarithm. block: of a design, a value of the list drawn for each sample.
    """

    of_scene: ClassVar[bool] = False

    list: Annotated[tuple | None, BeforeValidator(_listed)] = None
    range: Ends = None
    log: PositiveEnds = None
    random: Ends = None
    random_log: PositiveEnds = Field(None, alias="random-log")
    count: Annotated[int, COUNT] | None = None
    block: bool = False

    @classmethod
    def conflicts(cls, given: Mapping) -> Iterator[Conflict]:
        """Say which keys of an axis exclude or need each other."""
        kinds = [kind for kind in KINDS if kind in given]
        if len(kinds) != 1:
            yield (kinds[1] if kinds else "list"), f"one of {', '.join(KINDS)}"
        elif kinds == ["list"] and "count" in given:
            yield "count", "a list has its own number of values: remove it"
        elif kinds != ["list"] and given.get("block"):
            yield "block", "with a list of values"
        elif kinds[0] in ("range", "log") and given.get("count") == 1:
            yield "count", "2 or more: both ends are values"

    @property
    def kind(self) -> str:
        """One of KINDS."""
        return next(kind for kind in KINDS if self.ends(kind) is not None)

    def ends(self, kind: str) -> tuple | None:
        """The entries under `kind`: every value of a list, the two ends of the others."""
        return getattr(self, kind.replace("-", "_"))

    @property
    def size(self) -> int:
        """Number of values."""
        return len(self.list) if self.list else self.count or 0

    @property
    def logarithmic(self) -> bool:
        """Whether the values are spread in their logarithm."""
        return self.kind in ("log", "random-log")

    @property
    def unit(self) -> str:
        """The unit of the first value, empty where it has none."""
        return unit_of(self.ends(self.kind)[0])

    @property
    def si_unit(self) -> str:
        """The unit of the values in a table, empty where they have none."""
        return si_unit(self.ends(self.kind)[0])

    def values(self, key: str, seed: int | None) -> Sequence:
        """The values as a scene file spells them. Draws depend on the seed and the key only."""
        kind, given = self.kind, self.ends(self.kind)
        if kind == "list":
            return given
        if kind in ("range", "log"):
            steps = [Decimal(k) / (self.count - 1) for k in range(1, self.count - 1)]
            return [given[0], *self.at(steps), given[1]]
        return self.at(drawn(key, seed, self.count))

    def at(self, shares: Sequence[Decimal]) -> Sequence:
        """Values at shares (0 to 1) from first to last, as a scene file spells them, to 15 digits."""
        if self.list:
            return [self.list[min(int(share * self.size), self.size - 1)] for share in shares]
        ends = self.ends(self.kind)
        low, high = (_in(self.unit, end) for end in ends)
        if self.logarithmic:
            ratio = _EXACT.ln(_EXACT.divide(high, low))
            found = [_EXACT.multiply(low, _EXACT.exp(_EXACT.multiply(ratio, share))) for share in shares]
        else:
            found = [_EXACT.fma(_EXACT.subtract(high, low), share, low) for share in shares]
        whole = all(isinstance(end, int) for end in ends)
        return [_spelled(_ROUND.plus(value).normalize(), self.unit, whole) for value in found]


def drawn(key: str, seed: int | None, count: int) -> Sequence[Decimal]:
    """Random shares (0 to 1), the same for a seed and a key on every machine."""
    draws = random.Random(f"{seed} {key}")
    return [Decimal(draws.random()) for _ in range(count)]


def _spelled(number: Decimal, unit: str, whole: bool) -> str | int | float:
    if unit:
        return f"{float(number):.15g} {unit}"
    return int(number) if whole and number == number.to_integral_value() else float(number)


def in_si(value: Any) -> float | int | str:
    """A value of a scene file for a table: a number in SI, or a text."""
    unit = si_unit(value)
    if unit:
        return float(in_unit(value, unit))
    if isinstance(value, list):
        return json.dumps(list(map(in_si, value)), ensure_ascii=False)
    return json.dumps(value) if isinstance(value, bool) else value


MOST_LEVELS = 6  # tables in tables of a varied key
MOST_REASONS = 10  # said when every scene is refused
NO_UNCERTAINTY = "not in a sweep, whose table has no place for it: remove it"

_KEY = re.compile(r"[A-Za-z0-9_-]{1,60}")
_SEED = Number("a whole number", 0, 10**9, whole=True)
_SAMPLES = Number("a whole number", 2, MOST_POINTS, whole=True)
_NO_DESIGN = 'with mode = "morris", "sobol" or "uniform" only: remove it'


def _axes(value: object) -> dict:
    """The table [vary], keys in one piece: "loading.force" = {...} and loading.force = {...} are one."""
    if not isinstance(value, Mapping) or not value:
        example = '"loading.force" = { list = ["0.1 N", "0.2 N"] }'
        raise refused(f"one or more keys of the scene, such as {example}")
    found = dict(_leaves(value, ()))
    for key in found:
        parts = key.split(".")
        if len(parts) > MOST_LEVELS or not all(map(_KEY.fullmatch, parts)):
            raise refused(f'{spelling(key)} is no key of a scene: such as "loading.force"')
        inside = [other for other in found if key.startswith(f"{other}.")]
        if inside:
            raise refused(f"{inside[0]} or {key}: one is inside the other")
    return found


def _leaves(table: Mapping, above: tuple[str, ...]) -> Iterator[tuple[str, object]]:
    for key, value in table.items():
        path = (*above, key)
        inside = value.values() if isinstance(value, Mapping) else ()
        deeper = inside and all(isinstance(entry, Mapping) for entry in inside)
        if deeper and len(path) <= MOST_LEVELS and not set(value) & {*KINDS, "count", "block"}:
            yield from _leaves(value, path)
        else:
            yield ".".join(path), value


class Study(Section):
    """The content of a study file. scene: a file in its folder or below it."""

    of_scene: ClassVar[bool] = False

    title: str = ""
    scene: str
    model: Literal["sam", "fem-axisymmetric", "fem-3d", "fem-plane-strain"] = models.SAM
    mode: Literal["grid", "zip", "morris", "sobol", "uniform"] = "grid"
    samples: Annotated[int, _SAMPLES] | None = None
    seed: Annotated[int, _SEED] | None = None
    vary: Annotated[dict[str, Axis], BeforeValidator(_axes)]

    @classmethod
    def conflicts(cls, given: Mapping) -> Iterator[Conflict]:
        """Say what a mode needs, and what it does not take."""
        vary, design = given.get("vary"), given.get("mode") in METHODS
        found = dict(_leaves(vary, ())) if isinstance(vary, Mapping) else {}
        axes = {key: axis for key, axis in found.items() if isinstance(axis, Mapping)}
        randomly = any({"random", "random-log"} & set(axis) for axis in axes.values())
        if "seed" not in given and (randomly or design):
            yield "seed", f"required by random draws: {_SEED.allowed(True)}"
        if design and "samples" not in given:
            yield "samples", f"required by this mode: {_SAMPLES.allowed(True)}"
        if not design and "samples" in given:
            yield "samples", _NO_DESIGN
        for key, axis in axes.items():
            yield from ((f"vary.{key}.{name}", words) for name, words in _of_mode(axis, design))

    def excesses(self) -> Iterator[Conflict]:
        """Say where there are too many scenes, or not as many values for each key."""
        sizes = [axis.size for axis in self.vary.values()]
        if self.design:
            if not self.factors:
                yield "vary", "a key that is no block"
            elif self.samples * size(self.mode, len(self.factors)) > MOST_POINTS:
                most = MOST_POINTS // size(self.mode, len(self.factors))
                yield "samples", f"at most {most} with {len(self.factors)} keys: {MOST_POINTS} scenes"
        elif self.mode == "zip" and len(set(sizes)) > 1:
            named = ", ".join(f"{key} {size}" for key, size in zip(self.vary, sizes, strict=True))
            yield "mode", f"with zip as many values for each key; here {named}"
        elif self.mode == "grid" and math.prod(sizes) > MOST_POINTS:
            yield "vary", f"at most {MOST_POINTS} scenes; here {math.prod(sizes)}"

    @property
    def design(self) -> bool:
        """Whether the values are those of a design of sensitivity."""
        return self.mode in METHODS

    @property
    def factors(self) -> list[str]:
        """The keys that a design varies; the others, its blocks, are drawn for each sample."""
        return [key for key, axis in self.vary.items() if not axis.block]

    def shares(self) -> np.ndarray:
        """Of a design: shares (points, factors)."""
        return design(self.mode, len(self.factors), self.samples, self.seed)

    @classmethod
    def _field_in_words(cls, name: str, file: bool) -> str:
        return {"scene": "the name of a scene file", "vary": "a table [vary]"}[name]

    def combinations(self) -> list[tuple]:
        """The values of each point, in the order of `vary`; in a grid the last key changes fastest."""
        if self.design:
            return self._designed()
        columns = [axis.values(key, self.seed) for key, axis in self.vary.items()]
        return list(itertools.product(*columns) if self.mode == "grid" else zip(*columns, strict=True))

    def _designed(self) -> list[tuple]:
        shares = dict(zip(self.factors, self.shares().T, strict=True))
        repeats = size(self.mode, len(self.factors))
        columns = []
        for key, axis in self.vary.items():
            if axis.block:
                of_samples = axis.at(drawn(key, self.seed, self.samples))
                columns.append([value for value in of_samples for _ in range(repeats)])
            else:
                columns.append(axis.at([Decimal(float(share)) for share in shares[key]]))
        return list(zip(*columns, strict=True))


def _of_mode(axis: Mapping, designed: bool) -> Iterator[Conflict]:
    """What is missing from a table of [vary] in a mode, or too much there."""
    kind = next((kind for kind in KINDS if kind in axis), "")
    if designed:
        if "count" in axis and kind != "list":
            yield "count", "the mode chooses the values: remove it"
        if kind.startswith("random"):
            yield kind, "the mode chooses the values: range, log or list"
    else:
        if kind not in ("", "list") and "count" not in axis:
            yield "count", f"required: {COUNT.allowed(True)}"
        if axis.get("block"):
            yield "block", _NO_DESIGN


@dataclass(frozen=True)
class StudyPoint:
    """A scene of a study. values: as its file spells them; scene: None if refused, for the `reason`."""

    index: int
    values: tuple
    scene: Scene | None
    reason: str = ""

    @property
    def shown(self) -> list:
        """The values for a table: in SI, or as a text."""
        return [in_si(value) for value in self.values]


@dataclass(frozen=True)
class Points:
    """A study with its scenes, and the content of every file that was read for them, by name."""

    study: Study
    points: Sequence[StudyPoint]
    inputs: Mapping[str, bytes]


def read_study(path: str | Path) -> Points:
    """The study in a TOML file. SceneError with all its problems, or if every scene is refused."""
    path = Path(path)
    try:
        content = read_limited(path)
    except InputError as error:
        raise SceneError([Problem("", "", str(error))], str(path)) from None
    table = parse_toml(content, str(path))
    check_kind(table, "study", str(path))
    study, found = None, []
    try:
        study = Study.model_validate(table, context={"spelling": "file"})
    except ValidationError as error:
        found = problems(error)
    name, base = table.get("scene"), b""
    if isinstance(name, str):
        try:
            base = read_limited(below(path.parent, name, "study"))
        except InputError as error:
            found.append(Problem("scene", spelling(name), str(error)))
    if found:
        raise SceneError(found, str(path))
    place = path.parent / name
    points, inputs = _points(study, parse_toml(base, str(place)), place, str(path))
    return Points(study, points, {path.name: content, name: base, **inputs})


def study_of(given: Mapping[str, Any]) -> Points:
    """The study that Python gives, with its scenes. The scene may be a Scene, its tables or a path, values of
    a key a list alone, and numbers are SI numbers or strings with units. Raises SceneError as `read_study`.
    """
    table, scene, place = dict(given), given.get("scene"), Path("scene")
    base, read = dict[str, Any](), dict[str, bytes]()
    if isinstance(scene, str | Path):
        place = Path(scene)
        try:
            read[place.name] = read_limited(place)
        except InputError as error:
            raise SceneError([Problem("scene", spelling(str(scene)), str(error))], "study") from None
        base = parse_toml(read[place.name], str(place))
    elif isinstance(scene, Scene | Mapping):
        base = tables_of(scene if isinstance(scene, Scene) else Scene(**scene))
    if base:
        table["scene"] = place.name
    if isinstance(vary := table.get("vary"), Mapping):
        axes = {key: axis if isinstance(axis, Mapping) else {"list": axis} for key, axis in vary.items()}
        table["vary"] = made = {key: dict(axis) for key, axis in axes.items()}
        for key, axis in made.items():
            unit = unit_of_key(Scene, key)
            axis |= {name: _from_python(value, unit if name in KINDS else "") for name, value in axis.items()}
    try:
        study = Study.model_validate(table, context={"spelling": "file"})
    except ValidationError as error:
        raise SceneError(problems(error), "study") from None
    points, inputs = _points(study, base, place, "study")
    return Points(study, points, read | inputs)


def _from_python(values: Any, unit: str) -> Any:
    """Values of an axis as a study file spells them, of an array or a tuple too."""
    listed = values.tolist() if isinstance(values, np.ndarray | np.generic) else values
    if isinstance(listed, list | tuple):
        return [_from_python(value, unit) for value in listed]
    return with_units(listed, unit)


def _points(
    study: Study, base: Mapping, place: Path, source: str
) -> tuple[list[StudyPoint], dict[str, bytes]]:
    """Every point, and the files that its scenes name."""
    reasons = {key: reason for key in study.vary if (reason := _no_table(base, key))}
    if reasons:
        raise SceneError([Problem(f"vary.{key}", "a key", why) for key, why in reasons.items()], source)
    points, inputs, refusals = [], Inputs(place.parent), {}
    for index, values in enumerate(study.combinations()):
        table = base
        for key, value in zip(study.vary, values, strict=True):
            table = _with(table, key.split("."), value)
        try:
            scene = scene_of(table, str(place), inputs)
            models.check(scene, study.model)
            asked = scene.solver
            if asked.uncertainty or asked.accuracy:
                key = "uncertainty" if asked.uncertainty else "accuracy"
                wrong = Problem(f"solver.{key}", spelling(getattr(asked, key)), NO_UNCERTAINTY)
                raise SceneError([wrong], str(place))
            points.append(StudyPoint(index, values, scene))
        except (SceneError, models.ModelError) as error:
            found = error.problems if isinstance(error, SceneError) else [Problem("", "", str(error))]
            refusals |= dict.fromkeys(found)
            points.append(StudyPoint(index, values, None, "; ".join(map(str, found))))
    if all(point.scene is None for point in points):
        rest = len(refusals) - MOST_REASONS
        more = [Problem("", "", f"and {rest} more")] if rest > 0 else []
        said = [*list(refusals)[:MOST_REASONS], *more]
        raise SceneError(said, f"{source}: every scene is refused: {place}")
    return points, inputs.contents


def _no_table(base: Mapping, key: str) -> str:
    """Why a key cannot be put into the tables of the scene; empty if it can."""
    parts = key.split(".")
    for k, part in enumerate(parts[:-1]):
        if part not in base:
            return ""
        base = base[part]
        if not isinstance(base, Mapping):
            return f"{'.'.join(parts[: k + 1])} is no table of the scene"
    return ""


def _with(table: Mapping, parts: Sequence[str], value: object) -> dict:
    """A copy of the tables with the value at a key, its tables made if need be."""
    name, *rest = parts
    return {**table, name: _with(table.get(name, {}), rest, value) if rest else value}
