# SPDX-License-Identifier: MIT
"""The numbers of a scene: what each may be, and how a string with a unit becomes an SI float.

A scene file spells a dimensioned number as a string with a unit, "210 GPa"; in Python the same number is a
float in SI, or such a string too. One validator serves both: it reads the spelling that the validation
context asks for (IN_FILE, or none). Conversion is exact decimal arithmetic, rounded once to the nearest
float: "105 um" is the float 105e-6.
"""

from __future__ import annotations

import math
import re
import sys
from contextlib import suppress
from dataclasses import dataclass
from decimal import Decimal
from functools import cache, lru_cache
from importlib import import_module
from numbers import Integral, Real
from types import ModuleType
from typing import Annotated, Any, cast

from pydantic import PlainSerializer, ValidationInfo
from pydantic_core import PydanticCustomError, core_schema

IN_FILE = {"spelling": "file"}
"""Validation context of a scene file; "inputs": of the files it names. Else numbers are SI."""

_FACTOR = r"[A-Za-zµμ_]{1,24}(?:(?:\^|\*\*)-?[0-9]{1,2}(?:\.[0-9]{1,3})?)?"
_QUANTITY = re.compile(
    r"\s*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?)"
    rf"\s*({_FACTOR}(?:\s*[*/ ]\s*{_FACTOR}){{0,5}})\s*"
)
_LONGEST = 80  # characters of a number with its unit


def in_file(info: ValidationInfo | None) -> bool:
    """Whether the value comes from a scene file."""
    return bool(info and info.context and info.context.get("spelling") == IN_FILE["spelling"])


def refused(text: str) -> PydanticCustomError:
    """The error of a validator, with what is allowed."""
    return PydanticCustomError("allowed", "allowed: {allowed}", {"allowed": text})


@dataclass(frozen=True)
class Number:
    """A kind of number: its name in words; its closed range in SI; its SI unit as pint spells it, empty for a
    pure number; an example as a scene file would spell it; and whether 0 is allowed although `low` is above
    it, whether it must be whole, whether inf is allowed (also as the string "inf", which JSON can hold), and
    whether it may be a text in percent, "2 %".
    """

    name: str
    low: float
    high: float
    unit: str = ""
    example: str = ""
    zero: bool = False
    whole: bool = False
    infinite: bool = False
    percent: bool = False

    def _wrong(self, value: object, number: float | None) -> str:
        """What is wrong with a value, before what is allowed; empty where that says it."""
        if number is not None and not self.whole and self.low > 0 >= number:
            return "must be positive: "
        parts = number_and_unit(value) if self.unit else None
        if parts is None or _is_known(parts[1]):
            return ""
        # of two prefixes that differ by case the likelier one: MPa and mm
        powers = sorted(PREFIXES.items(), key=lambda item: item[1], reverse=self.unit != "Pa")
        names = {f"{prefix}{self.unit}".lower(): f"{prefix}{self.unit}" for prefix, _ in powers}
        near = names.get(parts[1].lower()) if self.unit in PLAIN else None
        return f"unknown unit {parts[1]}, " + (f"did you mean {near}? allowed: " if near else "allowed: ")

    def allowed(self, file: bool) -> str:
        """What a value may be, in words, for a scene file or for Python."""
        bounds = f"from {self.low:g} to {self.high:g} {self.unit}".rstrip() + (" or 0" if self.zero else "")
        bounds += " or inf" if self.infinite else ""
        if file and self.unit:
            return f'{self.name} as a string with a unit, such as "{self.example}", {bounds}'
        if self.percent:
            return f'{self.name} {bounds}, or in percent, such as "{self.example}"'
        return f"{self.name} {bounds}" + (" (a float in SI, or a string with a unit)" if self.unit else "")

    def check(self, value: object, info: ValidationInfo | None) -> float | int:
        """The value as an SI float, or int when whole; an error of type "allowed" for anything else."""
        file = in_file(info)
        if self.infinite and (value == "inf" or (isinstance(value, float) and value == math.inf)):
            return math.inf
        if self.percent and isinstance(value, str) and value.rstrip().endswith("%"):
            with suppress(ValueError):  # of a text that is no number, which is refused below
                value = float(value.rstrip().removesuffix("%")) / 100.0
        if self.unit and (file or isinstance(value, str)):
            exact = in_unit(value, self.unit)
            number = None if exact is None else float(exact)
        else:
            number = _real(value, self.whole)
        if number is None or not (self.low <= number <= self.high or (self.zero and number == 0)):
            raise refused(self._wrong(value, number) + self.allowed(file))
        return number

    def __get_pydantic_core_schema__(self, _source: Any, _handler: Any) -> core_schema.CoreSchema:
        return core_schema.with_info_plain_validator_function(self.check)

    def __get_pydantic_json_schema__(self, _core: Any, _handler: Any) -> dict[str, Any]:
        """JSON schema of the number as a scene file spells it."""
        description = {"description": self.allowed(file=True)}
        if self.unit:
            spelt = {"pattern": f"^{_QUANTITY.pattern}$", "examples": [self.example]}
            return {"type": "string", **spelt, **description}
        if self.percent:
            share = {"type": "number", "minimum": self.low, "maximum": self.high}
            text = {"type": "string", "pattern": r"^\s*[0-9.eE+-]+\s*%\s*$", "examples": [self.example]}
            return {"anyOf": [share, text], **description}
        number = {"type": "integer" if self.whole else "number", "maximum": self.high}
        number["minimum"] = 0 if self.zero else self.low
        return {"anyOf": [number, {"const": "inf"}]} if self.infinite else number | description


def _real(value: object, whole: bool) -> float | int | None:
    """A finite real number as float, or int when whole; None for anything else (a bool is no number)."""
    if isinstance(value, bool) or not isinstance(value, Real):
        return None
    if whole:
        return int(value) if isinstance(value, Integral) else None
    try:
        number = float(value)
    except OverflowError:
        return None
    return number if math.isfinite(number) else None


def in_unit(value: object, unit: str) -> Decimal | None:
    """How many units of pint a string NUMBER UNIT is, exactly; None for another dimension."""
    parts = number_and_unit(value)
    if parts is None:
        return None
    factor = _factor(parts[1], unit)
    return None if factor is None else Decimal(parts[0]) * factor


def number_and_unit(value: object) -> tuple[str, str] | None:
    """The two parts of a string NUMBER UNIT, whose unit need not be a known one; None if it is no such
    string.

    >>> number_and_unit("2.5 GPa")
    ('2.5', 'GPa')
    """
    match = _QUANTITY.fullmatch(value) if isinstance(value, str) and len(value) <= _LONGEST else None
    return (match[1], match[2]) if match else None


def metres_in(unit: object) -> float | None:
    """How many m are in a unit of length of pint; None for none, and for pint's pixel of a screen."""
    factor = in_unit(f"1 {unit}", "m") if isinstance(unit, str) and "px" not in unit else None
    return None if factor is None else float(factor)


@cache
def _registry() -> Any:
    """The units of pint, 0.3 s. Its dask asks psutil, which fails without /proc: then without."""
    try:
        pint = import_module("pint")
    except Exception:
        if "dask" in sys.modules:  # loaded: something else is wrong
            raise
        sys.modules["dask"] = cast(ModuleType, None)  # as if it were not installed
        try:
            pint = import_module("pint")
        finally:
            del sys.modules["dask"]
    return pint.UnitRegistry(non_int_type=Decimal, cache_folder=None)


PLAIN = ("m", "N", "Pa", "s")
PREFIXES = {"": 0, "n": -9, "u": -6, "\N{MICRO SIGN}": -6, "m": -3, "k": 3, "M": 6, "G": 9}
"""Powers of ten."""


@lru_cache(maxsize=1000)
def _factor(text: str, unit: str) -> Decimal | None:
    """How many `unit` are in one `text`, without pint for a prefix; None for another dimension."""
    prefix = text.removesuffix(unit) if unit in PLAIN and text.endswith(unit) else None
    if prefix in PREFIXES:
        return Decimal(1).scaleb(PREFIXES[prefix])
    registry = _registry()
    try:
        factor: Decimal = registry.Quantity(Decimal(1), registry.Unit(text)).to(unit).magnitude
    except Exception:  # for odd text pint raises errors of a dozen kinds, KeyError and TypeError among them
        return None
    return factor


def _is_known(text: str) -> bool:
    """Whether pint knows a unit."""
    try:
        _registry().Unit(text)
    except Exception:  # of a dozen kinds, as above
        return False
    return True


def spelled(number: float, unit: str) -> str:
    """An SI number as a string with a unit that is read as the same float.

    >>> spelled(2.1e11, "Pa"), spelled(0.6, "m/s")
    ('210 GPa', '0.6 m/s')
    """
    exact = Decimal(repr(float(number)))
    powers = {power: name for name, power in PREFIXES.items() if name.isascii()} if unit in PLAIN else {0: ""}
    power = max((each for each in powers if each <= exact.adjusted()), default=min(powers)) if exact else 0
    value = exact.scaleb(-power).normalize()
    return f"{value:{'f' if abs(value.adjusted()) < 9 else 'E'}} {powers[power]}{unit}"


PRESSURE = Number("a pressure", 1e-30, 1e30, "Pa", "210 GPa")
LENGTH = Number("a length", 1e-30, 1e30, "m", "10 um")
DEPTH = Number("a depth", 1e-30, 1e30, "m", "0.5 um", zero=True)
COEFFICIENT = Number("a number", 0.0, 10.0)
FACTOR = Number("a number", 1e-6, 1e6)
STRAIN = Number("a number", 0.0, 1000.0)
FRACTION = Number("a number", 1e-14, 0.1)
BOX = Number("a number (in Hertz radii)", 3.0, 1000.0)
COUNT = Number("a whole number", 1, 1000, whole=True)
ROWS = Number("a whole number", 1, 4097, whole=True)
CELLS = Number("a whole number", 3, 4097, whole=True)
MESH_CELLS = Number("a whole number", 2, 256, whole=True)

Pressure = Annotated[float, PRESSURE]
Length = Annotated[float, LENGTH]
Coordinate = Annotated[float, Number("a coordinate", -1e30, 1e30, "m", "-10 um")]
Depth = Annotated[float, DEPTH]
Force = Annotated[float, Number("a force", 1e-30, 1e30, "N", "0.6 N", zero=True)]
Poisson = Annotated[float, Number("a number", 0.0, 0.5)]
Coefficient = Annotated[float, COEFFICIENT]
Modulus = Annotated[float, Number("a pressure", 1e-30, 1e30, "Pa", "10 GPa", zero=True)]
Exponent = Annotated[float, Number("a number", 1e-6, 0.999999)]
Positive = Annotated[float, Number("a number", 1e-15, 1e15)]
Misfit = Annotated[float, Number("a strain", 1e-12, 1.0)]
Recovery = Annotated[float, Number("a number", 0.0, 1e7)]
Speed = Annotated[float, Number("a speed", 1e-30, 1e30, "m/s", "1 m/s")]
Growth = Annotated[float, Number("a growth coefficient", 1e-30, 1e30, "m/s**0.5", "3.644 nm/s**0.5")]
Temperature = Annotated[float, Number("an absolute temperature", 323.15, 473.15, "K", "373.15 K")]
Order = Annotated[int, Number("a whole number", 0, 9, whole=True)]
SmoothingWindow = Annotated[int, Number("an odd number of cells", 3, 99, zero=True, whole=True)]
Fraction = Annotated[float, FRACTION]
Share = Annotated[float, Number("a number", 0.0, 1.0)]
Hurst = Annotated[float, Number("a number", 0.0, 1.0)]
Anisotropy = Annotated[float, Number("a number", 0.01, 100.0)]
Box = Annotated[float, BOX]
Count = Annotated[int, COUNT]
PerRadius = Annotated[float, Number("a number of steps in a contact radius", 1.0, 1000.0)]
Cells = Annotated[int, CELLS]
Rows = Annotated[int, ROWS]
Seed = Annotated[int, Number("a whole number", 0, 2**63 - 1, whole=True)]
MeshCells = Annotated[int, MESH_CELLS]
StrainLimit = Annotated[
    float,
    Number("a number", 1e-9, 1000.0, infinite=True),
    PlainSerializer(lambda value: value if math.isfinite(value) else "inf", when_used="json"),
]
