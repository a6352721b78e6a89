# SPDX-License-Identifier: MIT
"""The scene: one contact, described once, solved by every model. In Python all quantities are SI floats.

Conventions: x along sliding, z into the body, z = 0 at its surface; the counter-body is a paraboloid with its apex at
the origin, gap0 = x^2/(2 Rx) + y^2/(2 Ry), or the flat end of a cylinder (punch), gap0 = 0 for r <= radius.
A value out of range, an unknown key or keys that contradict each other raise pydantic.ValidationError, all at once.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import Annotated, ClassVar, Literal

from pydantic import AfterValidator, BeforeValidator
from pydantic_core import PydanticCustomError

from sam.scene.section import Conflict, Section
from sam.scene.units import Box, Cells, Count, Depth, Force, Fraction, Length, MeshCells, Poisson, Pressure

MOST_DEPTHS = 1001
MOST_SLENDER = 1e4  # ratio of the radii of an ellipsoid; beyond it the contact is a line for every grid that is allowed


def _list_of(shortest: int, longest: int) -> BeforeValidator:
    """A TOML array (or tuple, or list) of so many entries, as a tuple."""
    words = f"a list of {shortest}" if shortest == longest else f"a list of {shortest} to {longest}"

    def check(value: object) -> tuple:
        if not isinstance(value, list | tuple) or not shortest <= len(value) <= longest:
            raise PydanticCustomError("allowed", "allowed: {allowed}", {"allowed": words})
        return tuple(value)

    return BeforeValidator(check)


def _ascending(depths: tuple[float, ...]) -> tuple[float, ...]:
    if any(lower >= upper for lower, upper in pairwise(depths)):
        raise PydanticCustomError("allowed", "allowed: {allowed}", {"allowed": "depths in strictly ascending order"})
    return depths


class Body(Section):
    """The half-space z >= 0, elastic and isotropic. young in Pa."""

    later: ClassVar[Mapping] = {"plasticity": None, "coating": None}

    young: Pressure
    poisson: Poisson


class CounterBody(Section):
    """The smooth counter-body. Rigid without young and poisson, elastic with both. Lengths in m, young in Pa."""

    later: ClassVar[Mapping] = {"shape": ("flat",)}

    shape: Literal["sphere", "ellipsoid", "punch"]
    radius: Length | None = None
    radius_x: Length | None = None
    radius_y: Length | None = None
    young: Pressure | None = None
    poisson: Poisson | None = None

    @property
    def elastic(self) -> bool:
        return self.young is not None

    @property
    def radii(self) -> tuple[float, float]:
        """(Rx, Ry) in m of a sphere or an ellipsoid."""
        if self.shape == "ellipsoid":
            return self.radius_x, self.radius_y
        return self.radius, self.radius

    @classmethod
    def conflicts(cls, given: Mapping) -> Iterator[Conflict]:
        shape = given.get("shape")
        needed = {"sphere": ("radius",), "punch": ("radius",), "ellipsoid": ("radius_x", "radius_y")}.get(shape, ())
        for key in ("radius", "radius_x", "radius_y"):
            if needed and (key in needed) != (key in given):
                yield key, f'shape = "{shape}" takes {" and ".join(needed)}' + ("" if key in needed else ": remove it")
        if ("young" in given) != ("poisson" in given):
            missing = "poisson" if "young" in given else "young"
            yield missing, "required: young and poisson together (elastic counter-body), or neither (rigid)"

    def excesses(self) -> Iterator[Conflict]:
        if self.shape == "ellipsoid" and not 1 / MOST_SLENDER <= self.radius_x / self.radius_y <= MOST_SLENDER:
            yield "radius_y", f"radius_x/radius_y from {1 / MOST_SLENDER:g} to {MOST_SLENDER:g}"


class Loading(Section):
    """Normal force in N: `steps` equal steps to the peak, and back to zero in `unload_steps` when `unload`."""

    later: ClassVar[Mapping] = {"prescribed": None, "p0": None, "radius": None, "path": None}

    force: Force
    steps: Count = 1
    unload: bool = False
    unload_steps: Count | None = None
    cycles: Count = 1

    @classmethod
    def conflicts(cls, given: Mapping) -> Iterator[Conflict]:
        if "unload_steps" in given and given.get("unload", False) is False:
            yield "unload_steps", "only together with unload = true"


class Grid(Section):
    """The cells and output depths of the semi-analytical model. cells: (nx, ny); extent: (Lx, Ly) in m.

    Cells alone take the default extent, an extent alone the default number of cells. depths: z in m where stresses are
    returned, or `layers` equal layers down to `depth`.
    """

    later: ClassVar[Mapping] = {"border": ("relief",)}

    cells: Annotated[tuple[Cells, Cells], _list_of(2, 2)] | None = None
    extent: Annotated[tuple[Length, Length], _list_of(2, 2)] | None = None
    depths: Annotated[tuple[Depth, ...], AfterValidator(_ascending), _list_of(1, MOST_DEPTHS)] | None = None
    layers: Count | None = None
    depth: Length | None = None
    border: Literal["free"] = "free"

    @classmethod
    def conflicts(cls, given: Mapping) -> Iterator[Conflict]:
        if "depths" in given and ("layers" in given or "depth" in given):
            yield "depths", "either depths, or layers with depth, not both"
        elif ("layers" in given) != ("depth" in given):
            yield ("depth" if "layers" in given else "layers"), "required: layers and depth together"


class Solver(Section):
    """tolerance: see the solver. Frictionless elastic contact knows one method."""

    later: ClassVar[Mapping] = {"method": ("paper",), "stop": None}

    method: Literal["backward-euler"] = "backward-euler"
    tolerance: Fraction = 1e-6


class Fem(Section):
    """The finite-element mesh. box: outer radius and depth in Hertz radii."""

    cells_per_radius: MeshCells = 16
    box: Box = 10.0


class Scene(Section):
    """One contact."""

    later: ClassVar[Mapping] = {"surface": None, "friction": None, "wear": None}

    title: str = ""
    body: Body
    counterbody: CounterBody
    loading: Loading
    grid: Grid | None = None
    solver: Solver = Solver()
    fem: Fem = Fem()


def resolved(scene: Scene) -> dict:
    """The scene with every default, numbers in SI, as a mapping that JSON can hold; Scene(**it) is the scene again."""
    return scene.model_dump(mode="json")
