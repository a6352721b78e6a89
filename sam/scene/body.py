# SPDX-License-Identifier: MIT
"""The tables [body], [counterbody] and [friction] of a scene: elastic constants, plasticity with its
hardening laws and a coating; what is pressed on the body; one coefficient, a map of them, or a film that
decides between two.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from math import isinf, sqrt
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from sam.scene.inputs import Rows, TwoColumns, list_of
from sam.scene.section import Conflict, Given, Section, broken, of_choice, stated
from sam.scene.surface.counter import CounterSurface
from sam.scene.surface.height_map import FrictionField
from sam.scene.units import (
    DEPTH,
    FACTOR,
    PRESSURE,
    STRAIN,
    Coefficient,
    Exponent,
    Growth,
    Length,
    Modulus,
    Poisson,
    Positive,
    Pressure,
    Recovery,
    Share,
    Speed,
    StrainLimit,
    Temperature,
)
from sam.scene.yield_curve import (
    OFFSET,
    BackStress,
    DepthProfile,
    Linear,
    Strength,
    Swift,
    Tabulated,
    YieldCurve,
    off_unit,
)

YIELD_TABLE = TwoColumns(("peeq", "yield_stress_Pa"), (STRAIN, PRESSURE), from_zero=True, falling="softening")
PROFILE = TwoColumns(("depth_m", "factor"), (DEPTH, FACTOR))
MOST_BACK_STRESSES = 8  # each adds six numbers a cell to the state
MICROSTRAIN = 1e6  # alpha of Swift's law in the paper, Eq. 18: the strain in microstrain


@dataclass(frozen=True)
class Law:
    """A hardening law: what makes its curve of its keys in this order, and the keys with a default."""

    curve: Callable[..., YieldCurve]
    needed: tuple[str, ...]
    defaults: Mapping[str, float] = field(default_factory=dict)

    @property
    def keys(self) -> tuple[str, ...]:
        """All that it takes."""
        return *self.needed, *self.defaults


LAWS = {
    "swift": Law(Swift, ("B", "C", "n"), {"alpha": MICROSTRAIN}),
    "linear": Law(Linear, ("yield_stress", "modulus")),
    "perfect": Law(Linear, ("yield_stress",)),
    "table": Law(Tabulated.of_rows, ("file",)),
}
"""The hardening laws of a scene, by their names."""
if TYPE_CHECKING:
    LawName = str
else:
    LawName = Literal[tuple(LAWS)]


class Kinematic(Section):
    """Kinematic hardening beside the isotropic law. modulus: of each back-stress in Pa; recovery: of each, 0
    (Prager's law) if not given.
    """

    modulus: Annotated[tuple[Pressure, ...], list_of(1, MOST_BACK_STRESSES)]
    recovery: Annotated[tuple[Recovery, ...], list_of(1, MOST_BACK_STRESSES)] | None = None

    @classmethod
    def conflicts(cls, given: Given) -> Iterator[Conflict]:
        """A recovery for each modulus, or for none."""
        lists = [given[key] for key in ("modulus", "recovery") if isinstance(given.get(key), list | tuple)]
        counts = list(map(len, lists))
        if len(set(counts)) > 1:
            yield "recovery", f"as many numbers as modulus has: {counts[0]}"


class Hardening(Section):
    """A hardening law with its constants.

    law "swift": B (C + alpha peeq)^n, B in Pa, alpha 1e6 if not given; "linear": yield_stress + modulus peeq,
    both in Pa; "perfect": yield_stress; "table": file, the rows (peeq, yield stress in Pa), the first at peeq
    = 0, never falling; in a scene file the name of a CSV file in its folder. kinematic: back-stresses beside
    it.
    """

    law: LawName
    B: Pressure | None = None
    C: Positive | None = None
    n: Exponent | None = None
    alpha: Positive | None = None
    yield_stress: Pressure | None = None
    modulus: Modulus | None = None
    file: Annotated[Rows, YIELD_TABLE] | None = None
    kinematic: Kinematic | None = None

    @classmethod
    def implied(cls, given: Given) -> Mapping[str, Any]:
        """The defaults of the law, as alpha of Swift's."""
        law = LAWS.get(given.text("law"))
        return {} if law is None else law.defaults

    @classmethod
    def conflicts(cls, given: Given) -> Iterator[Conflict]:
        """Keys that the law needs, or has no use for."""
        name = given.text("law")
        if (law := LAWS.get(name)) is None:
            return
        of_some_law = {key for other in LAWS.values() for key in other.keys}
        needed, taken = (f'law = "{name}" takes {", ".join(keys)}' for keys in (law.needed, law.keys))
        keys = [key for key in cls.model_fields if key in of_some_law]
        yield from of_choice(given, keys, (law.needed, law.keys), (needed, f"{taken}: remove it"))

    def curve(self) -> YieldCurve:
        """The yield stress in Pa over the accumulated plastic strain, where the factor is 1."""
        law = LAWS[self.law]
        return law.curve(*(stated(getattr(self, key)) for key in law.keys))

    def back_stress(self) -> BackStress | None:
        """The constants of the back-stresses where the factor over depth is 1; None without them."""
        if (table := self.kinematic) is None:
            return None
        return BackStress(table.modulus, table.recovery or (0.0,) * len(table.modulus))


class Plasticity(Hardening):
    """J2 plasticity with isotropic and kinematic hardening. Yield stress at depth z: strength().stress(z,
    peeq), the factor of the profile times the curve of the law, or times that of the layer in it.

    profile: the rows (depth in m, factor); in a scene file the name of a CSV file in its folder.
    layer_thickness: depth in m below the current surface of a layer; layer: its hardening law, else that of
    the body. Without layer and without a strain limit of its own the thickness changes nothing.
    """

    profile: Annotated[Rows, PROFILE] | None = None
    layer_thickness: Length | None = None
    layer: Hardening | None = None

    @classmethod
    def conflicts(cls, given: Given) -> Iterator[Conflict]:
        """Also a layer without thickness."""
        yield from super().conflicts(given)
        if "layer" in given and "layer_thickness" not in given:
            words = "required: the thickness of the layer that [body.plasticity.layer] is about"
            yield "layer_thickness", words

    def depth_profile(self) -> DepthProfile:
        """The factor on the yield stress as a function of depth in m; 1 everywhere without profile."""
        return DepthProfile(*zip(*self.profile, strict=True)) if self.profile else DepthProfile()

    @property
    def back_stresses(self) -> int:
        """How many there are at most at any depth."""
        tables = (self.kinematic, None if self.layer is None else self.layer.kinematic)
        return max(0 if table is None else len(table.modulus) for table in tables)

    @property
    def _laws(self) -> tuple[Hardening, ...]:
        """Of the body, and of a layer with a law of its own."""
        return self, *(() if self.layer is None else (self.layer,))

    @property
    def grows_for_ever(self) -> bool:
        """Whether the isotropic hardening of every part never ends, so that every load settles in the end."""
        return all(law.law == "swift" or (law.modulus or 0.0) > 0 for law in self._laws)

    @property
    def bounds_strain(self) -> bool:
        """Whether all parts have a back-stress of Prager, whose energy bounds the strain."""
        backs = (law.back_stress() for law in self._laws)
        return all(back is not None and isinf(back.saturation) for back in backs)

    @property
    def of_layer(self) -> str:
        """What a plan adds about a layer with a law of its own; nothing without one."""
        if self.layer is None:
            return ""
        return f", law {self.layer.law} of its own at z < {stated(self.layer_thickness):g} m"

    def strength(self) -> Strength:
        """The yield stress over depth and accumulated plastic strain."""
        curve, profile, back = self.curve(), self.depth_profile(), self.back_stress()
        if self.layer is None:
            return Strength(curve, profile, back=back)
        layer, thickness = self.layer, stated(self.layer_thickness)
        return Strength(curve, profile, layer.curve(), thickness, back=back, layer_back=layer.back_stress())


class Coating(Section):
    """An elastic coating bonded on the body, 0 <= z < thickness; thickness in m, young in Pa.

    yield_stress in Pa: perfectly plastic beyond it (finite elements only); elastic if not given.
    """

    thickness: Length
    young: Pressure
    poisson: Poisson
    yield_stress: Pressure | None = None

    @classmethod
    def conflicts(cls, given: Given) -> Iterator[Conflict]:
        """An incompressible coating cannot yield."""
        yields = "yield_stress" in given and given.get("poisson") == 0.5
        return broken((yields, "poisson", "less than 0.5 with yield_stress"))

    def excesses(self) -> Iterator[Conflict]:
        """A yield stress in another unit than Young's modulus."""
        limit = self.yield_stress
        words = "" if limit is None else off_unit(limit, self.young, "young")
        return broken((words, "yield_stress", words))


class Body(Section):
    """The half-space z >= 0, isotropic; elastic without plasticity. young in Pa. A coating takes the place of
    its outer part.
    """

    young: Pressure
    poisson: Poisson
    plasticity: Plasticity | None = None
    coating: Coating | None = None

    @classmethod
    def conflicts(cls, given: Given) -> Iterator[Conflict]:
        """An incompressible body cannot yield; a layer lies at the surface, as a coating does."""
        layer, yields = given.has("plasticity.layer"), "plasticity" in given
        return broken(
            (layer and "coating" in given, "plasticity.layer", "not together with [body.coating]"),
            (yields and given.get("poisson") == 0.5, "poisson", "less than 0.5 with plasticity"),
        )

    def excesses(self) -> Iterator[Conflict]:
        """A yield stress in another unit than Young's modulus, by a law or its factors."""
        if self.plasticity is None:
            return
        factors = self.plasticity.depth_profile().factor
        for table, law in (("plasticity", self.plasticity), ("plasticity.layer", self.plasticity.layer)):
            if law is None:
                continue
            usual = float(law.curve().stress(OFFSET))
            if words := off_unit(usual, self.young, "young"):
                column = f"column {YIELD_TABLE.columns[1]}: " if law.file is not None else ""
                yield f"{table}.{LAWS[law.law].needed[0]}", f"{column}{words}"
            elif words := off_unit(min(factors) * usual, self.young, "young"):
                yield "plasticity.profile", f"factors from {min(factors):g} to {max(factors):g} for {words}"
                return


MOST_SLENDER = 1e4  # ratio of the radii; beyond it the contact is a line for every grid that is allowed
SHAPES = {
    "sphere": ("radius",),
    "ellipsoid": ("radius_x", "radius_y"),
    "punch": ("radius",),
    "rounded-punch": ("flat_radius", "radius"),
    "flat": (),
    "cylinder": ("radius", "length"),
}
"""The shapes of a scene and the keys that each needs."""
CURVED = ("sphere", "ellipsoid")  # the shapes that have radii of curvature: their own keys
if TYPE_CHECKING:
    ShapeName = str
else:
    ShapeName = Literal[tuple(SHAPES)]


class CounterBody(Section):
    """The counter-body. Rigid without young and poisson, elastic with both; it neither yields nor wears.
    Smooth without surface. radius: of a sphere, of the flat end of a punch, of the rounded edge of a
    rounded-punch, whose flat end has flat_radius, of a cylinder, whose axis lies along y and whose length
    bears the force: a line contact, the same at every y. Lengths in m, young in Pa. slip: of one that moves
    (loading.path), the share of its way by which it slides over the body, 1 if not given; 0: it rolls.
    """

    shape: ShapeName
    radius: Length | None = None
    flat_radius: Length | None = None
    radius_x: Length | None = None
    radius_y: Length | None = None
    length: Length | None = None
    young: Pressure | None = None
    poisson: Poisson | None = None
    surface: CounterSurface | None = None
    slip: Share | None = None
    unwritten: ClassVar[tuple[str, ...]] = ("length",)

    @property
    def elastic(self) -> bool:
        """Whether it is elastic; else it is rigid."""
        return self.young is not None

    @property
    def radii(self) -> tuple[float, float] | None:
        """Radii of curvature (Rx, Ry) in m; None of a shape that has none."""
        if self.shape not in CURVED:
            return None
        values = [stated(getattr(self, key)) for key in SHAPES[self.shape]]
        return values[0], values[-1]

    @classmethod
    def conflicts(cls, given: Given) -> Iterator[Conflict]:
        """Radii that the shape needs, or has no use for; one elastic constant without the other."""
        shape, of_some_shape = given.text("shape"), {key for keys in SHAPES.values() for key in keys}
        if (needed := SHAPES.get(shape)) is not None:
            keys = [key for key in cls.model_fields if key in of_some_shape]
            words = f'shape = "{shape}" takes {" and ".join(needed) or "no radius"}'
            yield from of_choice(given, keys, (needed, needed), (words, f"{words}: remove it"))
        if ("young" in given) != ("poisson" in given):
            missing = "poisson" if "young" in given else "young"
            yield missing, "required: young and poisson together (elastic counter-body), or neither (rigid)"

    def excesses(self) -> Iterator[Conflict]:
        """An ellipsoid that is too slender for any grid."""
        along, across = self.radii or (1.0, 1.0)
        if not 1 / MOST_SLENDER <= along / across <= MOST_SLENDER:
            yield "radius_y", f"radius_x/radius_y from {1 / MOST_SLENDER:g} to {MOST_SLENDER:g}"


GROWTH_ROWS = ((323.15, 2.451e-9), (373.15, 3.644e-9), (423.15, 4.620e-9), (473.15, 4.916e-9))
"""(bath temperature in K, K_0 in m/s^0.5) of Bosman & Schipper (2011), Table 3, after their [33]."""

_FILM = ("low", "high", "film_thickness", "film_young", "film_poisson", "film_yield")
_GROWTH = ("growth_coefficient", "bath_temperature", "track", "contact_width", "speed")
FRICTION_LAWS = {
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
        if law not in FRICTION_LAWS:
            return
        needed, optional = FRICTION_LAWS[law]
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
