# SPDX-License-Identifier: MIT
"""The table [friction] of a scene: one coefficient, a map of them, or a film that decides between two."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from math import sqrt
from typing import Any, Literal

from sam.scene.section import Conflict, Given, Section, of_choice, stated
from sam.scene.surface.height_map import FrictionField
from sam.scene.units import Coefficient, Growth, Length, Poisson, Pressure, Speed, StrainLimit, Temperature
from sam.scene.yield_curve import off_unit

GROWTH_ROWS = ((323.15, 2.451e-9), (373.15, 3.644e-9), (423.15, 4.620e-9), (473.15, 4.916e-9))
"""(bath temperature in K, K_0 in m/s^0.5) of Bosman & Schipper (2011), Table 3, after their [33]."""

_FILM = ("low", "high", "film_thickness", "film_young", "film_poisson", "film_yield")
_GROWTH = ("growth_coefficient", "bath_temperature", "track", "contact_width", "speed")
LAWS = {
    "constant": (("coefficient",), ()),
    "map": (("path",), ()),
    "chemical-film": (_FILM, ("strain_limit", *_GROWTH, "form")),
}
"""Laws, the keys that each needs, and those that it may have."""


def growth_coefficient(temperature: float) -> float:
    """K_0 in m/s^0.5 at a bath temperature in K: linear between the rows of Table 3. Outside of them a
    ValueError.

    >>> round(growth_coefficient(373.15), 12)  # at 100 degrees Celsius
    3.644e-09
    """
    for (t0, k0), (t1, k1) in pairwise(GROWTH_ROWS):
        if t0 <= temperature <= t1:
            return k0 + (k1 - k0) * (temperature - t0) / (t1 - t0)
    raise ValueError(
        f"temperature = {temperature!r} K: {GROWTH_ROWS[0][0]} to {GROWTH_ROWS[-1][0]} K are allowed"
    )


class Friction(Section):
    """Full slip at every step, loading and unloading: the traction q = coefficient * p acts along +x on the
    body.

    coupling: whether the traction moves the surfaces normally; "alternating": +x in odd cycles, -x in even
    ones. law "constant": coefficient; "map": path, a file with the columns x_m, y_m, friction on the grid of
    the scene, in Python a FrictionMap. "chemical-film": low where a film is whole, high where it has failed
    in the cycle. The film (thickness in m, young and yield in Pa, perfectly plastic) fails where it thins by
    more than it grows again in a cycle: strain_limit, or from the growth (Eq. 11, 16 and 17 of Bosman &
    Schipper 2011; coefficient in m/s^0.5 or bath temperature in K, track and contact_width in m, speed in
    m/s). form "printed": their Eq. 12 and 13 as printed, for comparison.
    """

    law: Literal["constant", "map", "chemical-film"] = "constant"
    coefficient: Coefficient | None = None
    coupling: bool = True
    direction: Literal["constant", "alternating"] = "constant"
    path: FrictionField | None = None
    low: Coefficient | None = None
    high: Coefficient | None = None
    film_thickness: Length | None = None
    film_young: Pressure | None = None
    film_poisson: Poisson | None = None
    film_yield: Pressure | None = None
    strain_limit: StrainLimit | None = None
    growth_coefficient: Growth | None = None
    bath_temperature: Temperature | None = None
    track: Length | None = None
    contact_width: Length | None = None
    speed: Speed | None = None
    form: Literal["consistent", "printed"] | None = None

    @classmethod
    def implied(cls, given: Given) -> Mapping[str, Any]:
        """The form of the film's law, unless it is given."""
        return {"form": "consistent"} if given.get("law") == "chemical-film" else {}

    @classmethod
    def conflicts(cls, given: Given) -> Iterator[Conflict]:
        """Keys that the law needs, or has no use for; a strain limit, or a growth."""
        law = given.text("law") if "law" in given else "constant"
        if law not in LAWS:
            return
        needed, optional = LAWS[law]
        keys = [key for key in cls.model_fields if key not in ("law", "coupling", "direction")]
        missing = f'law = "{law}" takes {", ".join(needed)}' if "law" in given else "a number from 0 to 10"
        surplus = f'law = "{law}" takes {", ".join((*needed, *optional))}: remove it'
        words = f"required: {missing}", surplus
        yield from of_choice(given, keys, (needed, (*needed, *optional)), words)
        if law != "chemical-film":
            return
        either = "growth_coefficient (or bath_temperature), track, contact_width and speed"
        limit, growth = "strain_limit" in given, [key for key in _GROWTH if key in given]
        if limit:
            yield from ((key, f"either strain_limit, or {either}, not both") for key in growth)
        elif not growth:
            yield "strain_limit", f"required: strain_limit, or {either}"
        else:
            if ("growth_coefficient" in given) == ("bath_temperature" in given):
                yield "growth_coefficient", "required: growth_coefficient or bath_temperature, and not both"
            yield from ((key, f"required: {either}") for key in _GROWTH[2:] if key not in given)
        if given.get("film_poisson") == 0.5:
            yield "film_poisson", "less than 0.5"

    def excesses(self) -> Iterator[Conflict]:
        """A wide contact, or a yield stress of another unit than Young's modulus."""
        if self.film and stated(self.high) < (low := stated(self.low)):
            yield "high", f"at least low, {low:g}"
        if self.film_yield is not None and (
            words := off_unit(self.film_yield, stated(self.film_young), "film_young")
        ):
            yield "film_yield", words
        if self.contact_width is not None and self.contact_width >= (track := stated(self.track)):
            yield "contact_width", f"less than track, {track:g} m"

    @property
    def film(self) -> bool:
        """Whether a chemical film decides on the coefficient."""
        return self.law == "chemical-film"

    @property
    def largest(self) -> float:
        """The largest coefficient that may come up."""
        if self.law == "map":
            values = stated(self.path).values
            return float(values.max()) if values is not None else 0.0
        return max(stated(self.low), stated(self.high)) if self.film else stated(self.coefficient)

    @property
    def growth(self) -> float | None:
        """Thickness in m of a cycle on bare metal: K_0 sqrt((track - contact_width)/speed)."""
        if self.track is None:
            return None
        k0 = self.growth_coefficient
        if k0 is None:
            k0 = growth_coefficient(stated(self.bath_temperature))
        way = self.track - stated(self.contact_width)
        return k0 * sqrt(way / stated(self.speed))  # paper Eq. 11 and 16

    @property
    def growth_rate(self) -> float | None:
        """Growth on bare metal in 1 m over the thickness, in 1/sqrt(m), or None."""
        if self.growth is None:
            return None
        way = stated(self.track) - stated(self.contact_width)
        return self.growth / stated(self.film_thickness) / sqrt(way)

    @property
    def thinning_limit(self) -> float:
        """Largest normal plastic strain of the film in a cycle: a given one, or paper Eq. 17."""
        if self.strain_limit is not None:
            return self.strain_limit
        return stated(self.growth) / stated(self.film_thickness)  # paper Eq. 17
