# SPDX-License-Identifier: MIT
"""The yield stress as a function of the accumulated plastic strain and of depth: a parameter of both models.

A curve knows `stress(peeq)` and `slope(peeq)`, d sigma_y/d peeq, for arrays of any shape; peeq >= 0, stresses
in Pa. `Strength` says which curve holds at which depth, and its factor there. How a model uses them (return
mapping, tangent) is its own.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from itertools import zip_longest
from typing import Protocol, Self, cast

import numpy as np
from numpy.typing import NDArray

from sam.arrays import Array, Mask
from sam.scene.back_stress import BackStress

# E over yield stress at most. Annealed lead and indium, the softest of metals in use, have some 1e3 to 1e4; a
# value in MPa that is taken as Pa adds a factor of 1e6 to the 10 to 1e4 of all materials.
SOFTEST = 1e5
OFFSET = 2e-3  # plastic strain of the yield stress that handbooks give, R_p0.2


def off_unit(usual: float, young: float, key: str) -> str:
    """What a yield stress at a plastic strain of OFFSET may be beside Young's modulus, where it can only be
    in another unit; else empty. A law that rises from nearly 0 has one there.

    usual, young: in Pa; key: of Young's modulus. A yield stress that is never reached may be of any size.
    """
    if usual >= young / SOFTEST:
        return ""
    return (
        f"a yield stress of at least {young / SOFTEST:.4g} Pa, {key}/{SOFTEST:g}, at a plastic strain of "
        f"{OFFSET:g}: it is {usual:.4g} Pa: are values in MPa taken as Pa?"
    )


class YieldCurve(Protocol):
    """Isotropic hardening law."""

    def stress(self, peeq: Array | float) -> Array:
        """The yield stress in Pa at an accumulated plastic strain."""

    def slope(self, peeq: Array | float) -> Array:
        """d sigma_y/d peeq in Pa; of a table that to the next row."""

    def at(self, points: Mask) -> YieldCurve:
        """The curve of some of the points that it belongs to."""


class Everywhere:
    """A curve that is the same at all points."""

    def at(self, points: Mask) -> Self:
        """The curve of some points."""
        return self


@dataclass(frozen=True)
class Swift(Everywhere):
    """sigma_y = B (C + alpha peeq)^n; B in Pa. Paper Eq. 18 (alpha = 1e6: the strain in microstrain)."""

    B: float
    C: float
    n: float
    alpha: float = 1e6

    def stress(self, peeq: Array | float) -> Array:
        """The yield stress in Pa at an accumulated plastic strain."""
        return self.B * (self.C + self.alpha * np.asarray(peeq)) ** self.n  # paper Eq. 18

    def slope(self, peeq: Array | float) -> Array:
        """d sigma_y/d peeq in Pa."""
        return self.B * self.n * self.alpha * (self.C + self.alpha * np.asarray(peeq)) ** (self.n - 1)


@dataclass(frozen=True)
class Linear(Everywhere):
    """sigma_y = yield_stress + modulus peeq, both in Pa; modulus 0: perfect plasticity."""

    yield_stress: float
    modulus: float = 0.0

    def stress(self, peeq: Array | float) -> Array:
        """The yield stress in Pa at an accumulated plastic strain."""
        return self.yield_stress + self.modulus * np.asarray(peeq)

    def slope(self, peeq: Array | float) -> Array:
        """d sigma_y/d peeq in Pa."""
        return np.full_like(np.asarray(peeq, dtype=float), self.modulus)


@dataclass(frozen=True)
class Tabulated(Everywhere):
    """Linear between the rows (peeq, yield stress in Pa), constant after the last; the first row has peeq =
    0.
    """

    peeq: tuple[float, ...]
    yield_stress: tuple[float, ...]

    @classmethod
    def of_rows(cls, rows: Iterable[tuple[float, float]]) -> Tabulated:
        """The curve through the rows (peeq, yield stress in Pa)."""
        return cls(*zip(*rows, strict=True))

    def stress(self, peeq: Array | float) -> Array:
        """The yield stress in Pa at an accumulated plastic strain."""
        return cast(Array, np.interp(peeq, self.peeq, self.yield_stress))

    def slope(self, peeq: Array | float) -> Array:
        """The slope to the right of each point; 0 from the last row on."""
        slopes = np.append(np.diff(self.yield_stress) / np.diff(self.peeq), 0.0)
        row = np.searchsorted(self.peeq, peeq, side="right") - 1
        found: Array = slopes[np.clip(row, 0, len(slopes) - 1)]
        return found


@dataclass(frozen=True)
class Layered:
    """The curves of the points of a body with a layer: inside, of a shape that broadcasts with peeq, says
    which points lie in the layer.
    """

    body: YieldCurve
    layer: YieldCurve
    inside: Mask

    def stress(self, peeq: Array | float) -> Array:
        """The yield stress in Pa at an accumulated plastic strain."""
        return np.where(self.inside, self.layer.stress(peeq), self.body.stress(peeq))

    def slope(self, peeq: Array | float) -> Array:
        """d sigma_y/d peeq in Pa."""
        return np.where(self.inside, self.layer.slope(peeq), self.body.slope(peeq))

    def at(self, points: Mask) -> Layered:
        """The curves of some points, (n,)."""
        return Layered(self.body, self.layer, np.broadcast_to(self.inside, points.shape)[points])


@dataclass(frozen=True)
class DepthProfile:
    """Factor on the yield stress over depth (m, ascending): linear between the rows, constant before and
    after them.
    """

    depth: tuple[float, ...] = (0.0,)
    factor: tuple[float, ...] = (1.0,)

    def __call__(self, z: Array | float) -> Array:
        """The factor at depths z in m."""
        return cast(Array, np.interp(z, self.depth, self.factor))


@dataclass(frozen=True)
class Kinks:
    """Depths in m, ascending, at which the yield stress has a kink or a jump."""

    depths: tuple[float, ...] = ()

    def interval(self, z: Array | float) -> NDArray[np.intp]:
        """How many kinks lie at or above z: where the number is the same, fields are smooth."""
        return np.searchsorted(self.depths, z, side="right")


@dataclass(frozen=True)
class Strength:
    """The yield stress over depth z and accumulated plastic strain: profile(z) times `curve`, or in a layer,
    z < thickness in m, times that of the layer. back, layer_back: constants of the back-stresses in the body
    and in the layer, whose moduli have the factor too.
    """

    curve: YieldCurve
    profile: DepthProfile = DepthProfile()
    layer: YieldCurve | None = None
    thickness: float = 0.0
    back: BackStress | None = None
    layer_back: BackStress | None = None

    def curve_at(self, z: Array | float) -> YieldCurve:
        """The curve at depths z in m, before the factor of the profile."""
        if self.layer is None:
            return self.curve
        return Layered(self.curve, self.layer, np.less(z, self.thickness))

    def stress(self, z: Array | float, peeq: Array | float) -> Array:
        """The yield stress in Pa at depths z in m and accumulated plastic strains, which broadcast."""
        return self.profile(z) * self.curve_at(z).stress(peeq)

    def back_at(self, z: Array | float) -> tuple[Array, Array] | None:
        """Moduli in Pa and recoveries of the back-stresses at depths z in m, (N, ...) both; None without
        back-stress. Where there are fewer than N the others have the modulus 0.
        """
        if self.back is None and self.layer_back is None:
            return None
        none, z = BackStress((), ()), np.asarray(z, dtype=float)
        body, layer = self.back or none, self.layer_back or none
        inside = np.less(z, self.thickness if self.layer is not None else 0.0)
        pairs = zip_longest(body.modulus, body.recovery, layer.modulus, layer.recovery, fillvalue=0.0)
        each = [(np.where(inside, C1, C), np.where(inside, g1, g)) for C, g, C1, g1 in pairs]
        moduli, recoveries = (np.array(values) for values in zip(*each, strict=True))
        return self.profile(z) * moduli, recoveries

    def back_saturation(self, z: float) -> float:
        """The largest back-stress in tension at depth z in m, in Pa; 0 without back-stress."""
        in_layer = self.layer is not None and z < self.thickness
        back = self.layer_back if in_layer else self.back
        return 0.0 if back is None else float(self.profile(z)) * back.saturation

    def least(self, peeq: float) -> float:
        """The smallest yield stress at any depth, in Pa."""
        return float(self.stress(np.array([*self.profile.depth, *self._sides]), peeq).min())

    def with_curves(self, change: Callable[[YieldCurve], YieldCurve]) -> Strength:
        """The same with other curves."""
        return replace(
            self, curve=change(self.curve), layer=None if self.layer is None else change(self.layer)
        )

    @property
    def kinks(self) -> Kinks:
        """The rows of the profile, and the lower side of a layer whose curve is another one."""
        same = self.layer == self.curve and self.layer_back == self.back
        lower = () if self.layer is None or same else (self.thickness,)
        return Kinks(tuple(sorted({*self.profile.depth, *lower})))

    @property
    def _sides(self) -> tuple[float, ...]:
        """Depths just above and at the lower side of the layer."""
        return () if self.layer is None else (float(np.nextafter(self.thickness, 0.0)), self.thickness)
