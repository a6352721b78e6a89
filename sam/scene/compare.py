# SPDX-License-Identifier: MIT
"""The table [compare] of a scene: how two results of it are judged. It changes no result."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import ValidationInfo

from sam.scene.section import Section
from sam.scene.units import Number

_PERCENT = 100.0


@dataclass(frozen=True)
class Share(Number):
    """A pure number that may also be a text in percent, "2 %"."""

    def allowed(self, file: bool) -> str:
        """What a value may be, in words."""
        return f'{super().allowed(file)}, or in percent, such as "{self.example}"'

    def check(self, value: object, info: ValidationInfo | None) -> float | int:
        """The value as a float; an error of type "allowed" for anything else."""
        if isinstance(value, str) and value.rstrip().endswith("%"):
            try:
                value = float(value.rstrip().removesuffix("%")) / _PERCENT
            except ValueError:
                pass  # refused below
        return super().check(value, info)

    def __get_pydantic_json_schema__(self, _core: Any, _handler: Any) -> dict[str, Any]:
        """JSON schema of the number as a scene file spells it."""
        number = {"type": "number", "minimum": self.low, "maximum": self.high}
        text = {"type": "string", "pattern": r"^\s*[0-9.eE+-]+\s*%\s*$", "examples": [self.example]}
        return {"anyOf": [number, text], "description": self.allowed(file=True)}


TOLERANCE = Share("tolerance", 1e-12, 10.0, example="2 %")


class Compare(Section):
    """claim "negligible-film": a comparison fails if the film changes pressure or stress of the body by more
    than its limit; tolerances: row of a comparison -> its tolerance, in place of that of samfem.
    """

    claim: Literal["negligible-film"] | None = None
    tolerances: dict[str, Annotated[float, TOLERANCE]] | None = None
