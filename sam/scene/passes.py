# SPDX-License-Identifier: MIT
"""What a counter-body that moves over the body needs, and what it cannot be put together with."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import ceil, inf, sqrt
from typing import Any

from sam.scene.body import Body
from sam.scene.counterbody import CounterBody
from sam.scene.loading import Loading
from sam.scene.path import ROUNDING, TO_AND_FRO, Path
from sam.scene.section import MISSING_INPUT, NOT_YET, Conflict, stated, value_at
from sam.scene.units import COUNT

STICKS = "a counter-body that rolls (slip = 0) with friction sticks in a part of the contact (stick-slip)"


def contact_radius(body: Body, other: CounterBody | None, loading: Loading) -> float:
    """Radius in m of the contact by Hertz, in which steps along a path are counted.

    Parameters
    ----------
    body, other, loading
        Tables of a scene.

    Returns
    -------
    float
        (3 F R/(4 E*))^(1/3), of an ellipsoid with the geometric mean R of its radii (Johnson 1985, Eq. 4.22);
        under an approach d sqrt(R d). That of the flat end of a punch, and of a pressure that is given. 0
        without force, infinite below a plane.
    """
    if other is None:
        return stated(loading.radius)
    if other.shape == "flat":
        return inf
    if other.radii is None:
        return stated(other.flat_radius or other.radius)
    radius = sqrt(other.radii[0] * other.radii[1])
    if loading.approach is not None:
        return sqrt(radius * loading.approach)
    compliance = (1 - body.poisson**2) / body.young
    if other.young is not None:
        compliance += (1 - stated(other.poisson) ** 2) / other.young
    return float((0.75 * stated(loading.force) * radius * compliance) ** (1 / 3))


def conflicts_of_path(given: Mapping[str, Any]) -> Iterator[Conflict]:
    """Tables and keys that a path of a counter-body excludes, or the other way round."""
    moves = value_at(given, "loading.path") is not MISSING_INPUT and "counterbody" in given
    if not moves:
        if value_at(given, "counterbody.slip") is not MISSING_INPUT:
            yield "counterbody.slip", "only together with loading.path"
        if value_at(given, "loading.path.return") == "to-and-fro":
            yield "loading.path.return", '"lifted" where the pressure is given'
        return
    if value_at(given, "body.coating") is not MISSING_INPUT:
        yield "body.coating", f"with loading.path {NOT_YET}"
    yield from _conflicts_of_rough(given)
    if value_at(given, "friction.direction") == "alternating":
        yield "friction.direction", '"constant" with loading.path: the traction is along the motion'
    if value_at(given, "solver.method") == "paper":
        yield "solver.method", '"backward-euler" with loading.path: the loop of the paper knows no motion'


def _conflicts_of_rough(given: Mapping[str, Any]) -> Iterator[Conflict]:
    """What a plane that moves needs, and what a rough counter-body that moves excludes."""
    rough = value_at(given, "counterbody.surface") is not MISSING_INPUT
    if value_at(given, "counterbody.shape") == "flat":
        if not rough:
            yield "loading.path", "nothing moves: a plane needs [counterbody.surface], or leave it out"
        elif value_at(given, "counterbody.slip") == 0:
            yield "counterbody.slip", "above 0: nothing moves on a plane that rolls"
        if value_at(given, "loading.path.steps") is MISSING_INPUT:
            yield (
                "loading.path.steps",
                'required with counterbody.shape = "flat", which has no contact radius',
            )
    renewed = value_at(given, "counterbody.surface.renew") is True
    unloads = "wear" in given or value_at(given, "loading.path.return") != TO_AND_FRO
    if renewed and not unloads:
        yield "counterbody.surface.renew", 'false with return = "to-and-fro": the load stays on'
    if rough and value_at(given, "solver.uncertainty") is True:
        words = "its steps are whole cells, on others they would not be"
        yield "solver.uncertainty", f"false with [counterbody.surface] and loading.path: {words}"


def excesses_of_steps(path: Path, radius: float) -> Iterator[Conflict]:
    """Steps of which a path has none or too many, as it gives their size; radius: of the contact in m."""
    if radius == 0:
        yield "loading.force", "above 0 with loading.path: nothing else says how long its steps may be"
    elif path.step_per_radius is not None and path.step_per_radius * path.length > COUNT.high * radius:
        most = f"{COUNT.high * radius / path.length:.4g}"
        yield "loading.path.step_per_radius", f"at most {most}: this path may have {COUNT.high:g} steps"


def excesses_of_path(
    body: Body, other: CounterBody, loading: Loading, coefficient: float
) -> Iterator[Conflict]:
    """Good values of a path that do not go together. coefficient: the largest one of friction."""
    path, radius = stated(loading.path), contact_radius(body, other, loading)
    step, least = path.length / path.count(radius), ceil(path.length / radius - ROUNDING)
    if step > radius * (1 + ROUNDING):
        yield (
            "loading.path.steps",
            f"{least} or more: a step of {step:.4g} m is longer than the contact radius, {radius:.4g} m",
        )
    if coefficient > 0 and path.start[1] != path.end[1]:
        yield "loading.path.end", "the y of start with [friction]: the traction acts along x"
    if coefficient > 0 and other.slip == 0:
        yield "counterbody.slip", f"above 0 with friction.coefficient = {coefficient:g}: {STICKS}"


def excesses_of_grid(extent: tuple[float, float] | None, path_ends: Any, radius: float) -> Iterator[Conflict]:
    """A grid that does not hold the contact at both ends of the path. extent: sides in m."""
    far = [2 * (max(map(abs, ends)) + radius) for ends in zip(*path_ends, strict=True)]
    if extent is not None and any(side < least for side, least in zip(extent, far, strict=True)):
        words = " and ".join(f"{least:.4g} m" for least in far)
        yield "grid.extent", f"at least {words}, to hold the contact at both ends of loading.path"
