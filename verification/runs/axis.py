# SPDX-License-Identifier: MIT
"""The values of one varied key of a study: a list, or numbers between two ends.

Numbers between two ends are decimal arithmetic, so that they are the same on every machine.
"""

from __future__ import annotations

import json
import math
import random
from collections.abc import Iterator, Mapping, Sequence
from decimal import Context, Decimal
from typing import Annotated, Any, ClassVar

from pydantic import BeforeValidator, Field
from pydantic_core import PydanticCustomError

from sam.scene import Conflict, Number, Section, in_unit, number_and_unit

MOST_POINTS = 10_000
SI_UNITS = ("m", "N", "Pa", "s", "m/s", "m/s**0.5")
KINDS = ("list", "range", "log", "random", "random-log")
COUNT = Number("a whole number", 1, MOST_POINTS, whole=True)

_EXACT, _ROUND = Context(prec=40), Context(prec=15)
_ENDS = (
    'two numbers, or two strings with units of one dimension, such as ["0.1 N", "0.5 N"], '
    "the first below the second"
)
_LIST = "one or more numbers, texts, true, false or lists of these; strings with units all of one dimension"


def refused(text: str) -> PydanticCustomError:
    """What pydantic raises for a value, with what is allowed."""
    return PydanticCustomError("allowed", "allowed: {allowed}", {"allowed": text})


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < math.inf


def _is_plain(value: object) -> bool:
    return isinstance(value, str | bool) or _is_number(value)


def _listed(value: object) -> tuple:
    if not isinstance(value, list) or not 1 <= len(value) <= MOST_POINTS:
        raise refused(_LIST)
    if not all(
        _is_plain(entry) or (isinstance(entry, list) and all(map(_is_plain, entry))) for entry in value
    ):
        raise refused(_LIST)
    units = [si_unit(entry) for entry in value]
    if any(units) and len(set(units)) > 1:
        raise refused(_LIST)
    return tuple(value)


def _ends(value: object, positive: bool = False) -> tuple:
    if not isinstance(value, list) or len(value) != 2:
        raise refused(_ENDS)
    low, high = (_in(unit_of(value[0]), entry) for entry in value)
    if low is None or high is None or not low < high:
        raise refused(_ENDS)
    if positive and low <= 0:
        raise refused(f"{_ENDS}, both above zero")
    return tuple(value)


def _positive_ends(value: object) -> tuple:
    return _ends(value, positive=True)


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
    return Decimal(repr(value)) if _is_number(value) else None


Ends = Annotated[tuple | None, BeforeValidator(_ends)]
PositiveEnds = Annotated[tuple | None, BeforeValidator(_positive_ends)]


class Axis(Section):
    """The values of one key: a list, or `count` of them between two ends (both included, but not by the
    random ones).

    range: equal distances; log: equal ratios; random, random-log: drawn uniformly, or uniformly in the
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
            return [given[0], *self._between(steps), given[1]]
        return self._between(drawn(key, seed, self.count))

    def at(self, shares: Sequence[Decimal]) -> Sequence:
        """The values at shares (0 to 1) of the way from first to last, as a scene file spells them."""
        if self.list:
            return [self.list[min(int(share * self.size), self.size - 1)] for share in shares]
        return self._between(shares)

    def _between(self, shares: Sequence[Decimal]) -> Sequence:
        """Values at shares (0 to 1) of the way, in the unit of the first end, rounded to 15 digits."""
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
    if isinstance(value, bool | list):
        return json.dumps(
            [in_si(entry) for entry in value] if isinstance(value, list) else value, ensure_ascii=False
        )
    return value
