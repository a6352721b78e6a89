# SPDX-License-Identifier: MIT
"""Measured tests: force over depth, the profile of a dent, or its depth alone; and what is wrong with them."""

from __future__ import annotations

import io
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sam.scene import Problem, SceneError, in_unit

COLUMNS = {
    "force": ("N", ("force", "load", "p", "f")),
    "depth": ("m", ("depth", "approach", "displacement", "uz", "h", "d")),
    "height": ("m", ("height", "z")),
    "x": ("m", ("x", "r", "radius", "position")),
}
"""What a column is -> its SI unit, and the names that it may have before its unit."""
KINDS = {"curve": ("force", "depth"), "profile": ("x", "depth")}
FEWEST = 8  # points of a branch or a profile
FOOT = 0.25  # share of the largest force at which a curve from the first touch has begun
DEEPEST = 0.3  # depth over the radius of the ball: beyond any contact that the model takes
FALLING = 0.05  # share of the largest force by which loading may fall between neighbours: noise
_HEAD = re.compile(r"\s*([A-Za-z]+)[\s_]*[\[(]?\s*([^\])\s]*)\s*[\])]?\s*")


@dataclass(frozen=True)
class Points:
    """Of a test in SI, (n,) each: x, the force in N or the distance from the axis in m; depth in m into the
    body; unloading: which points of a curve were measured as the force fell.
    """

    x: np.ndarray
    depth: np.ndarray
    unloading: np.ndarray


def read_points(content: bytes, kind: str, units: Sequence[str], source: str) -> Points:
    """The points in a CSV file. units: of its columns in order, in place of those in their names.

    Raises SceneError with what is wrong with the file.
    """
    columns = read_columns(content, units, source)
    wanted = KINDS[kind]
    if "height" in columns and "depth" not in columns:
        columns["depth"] = -columns.pop("height")
    if missing := [name for name in wanted if name not in columns]:
        example = ", ".join(f"{name}_{'mN' if COLUMNS[name][0] == 'N' else 'um'}" for name in wanted)
        raise refused(source, "columns", ", ".join(columns), f"a column {missing[0]}: such as {example}")
    x, depth = (columns[name] for name in wanted)
    if kind == "profile":
        return Points(np.abs(x), depth, np.zeros(x.size, bool))
    return Points(x, depth, np.arange(x.size) > np.argmax(x))


def read_columns(content: bytes, units: Sequence[str], source: str) -> dict[str, np.ndarray]:
    """The columns of a CSV file in SI by what they are (keys of COLUMNS)."""
    import pandas as pd

    try:
        frame = pd.read_csv(io.BytesIO(content), comment="#", skipinitialspace=True)
    except (ValueError, UnicodeDecodeError) as error:
        raise refused(source, "", "", f"no table of numbers: {error}") from None
    if units and len(units) != len(frame.columns):
        raise refused(source, "units", str(len(units)), f"as many as there are columns, {len(frame.columns)}")
    found: dict[str, np.ndarray] = {}
    for k, head in enumerate(map(str, frame.columns)):
        parts = _HEAD.fullmatch(head)
        word, unit = (parts[1].lower(), units[k] if units else parts[2]) if parts else ("", "")
        name = next((name for name, (_, words) in COLUMNS.items() if word in words), "")
        if not name:
            continue
        factor = in_unit(f"1 {unit}", COLUMNS[name][0]) if unit else None
        if factor is None:
            kind = "force, such as mN" if COLUMNS[name][0] == "N" else "length, such as um"
            where = "in the name of the column (depth_um), or units in the test"
            raise refused(source, f"column {head}", unit or "no unit", f"a unit of {kind}, {where}")
        values = pd.to_numeric(frame.iloc[:, k], errors="coerce").to_numpy(float)
        if not np.isfinite(values).all():
            row = int(np.argmin(np.isfinite(values)))
            raise refused(source, f"{head}, row {row + 1}", str(frame.iloc[row, k]), "a number in each row")
        found[name] = values * float(factor)
    return found


def faults(points: Points, kind: str, radius: float, elastic: float) -> list[Problem]:
    """What points say that cannot be of a ball of this radius in m; elastic: the approach of Hertz in m at
    the largest force, the least that is possible without a compliance that is too low.
    """
    deepest, count = float(np.abs(points.depth).max(initial=0.0)), points.x.size
    if count < FEWEST:
        return [Problem("points", str(count), f"at least {FEWEST}")]
    if kind == "profile":
        if points.x.max() > 4.0 * radius or points.x.max() < 1e-3 * radius:
            words = f"at most four radii of the ball, {radius:g} m: is the unit of length another?"
            return [Problem("x", f"up to {points.x.max():.3g} m", words)]
        return []
    up, found = ~points.unloading, []
    force, largest = points.x[up], points.x.max()
    if largest <= 0.0:
        return [
            Problem(
                "force", f"at most {largest:.3g} N", "positive when the ball is pressed on: change the sign"
            )
        ]
    if deepest > DEEPEST * radius or points.depth.max() < elastic / 5.0:
        words = f"{elastic:.3g} m (elastic) to {DEEPEST:g} radii, {DEEPEST * radius:.3g} m"
        what = f"up to {points.depth.max():.3g} m"
        return [Problem("depth", what, f"{words}: is a unit, the sign or the radius another?")]
    if up.sum() < FEWEST:
        found.append(Problem("loading", f"{up.sum()} points", f"at least {FEWEST} before the largest force"))
    elif force.min() > FOOT * largest:
        words = f"points from the first touch on, below {FOOT:g} of the largest force"
        found.append(Problem("force", f"from {force.min():.3g} N", words))
    elif (np.maximum.accumulate(force) - force).max() > FALLING * largest:
        words = "one loading and one unloading in the order in which they were measured"
        found.append(Problem("force", "falls and rises again before its peak", words))
    elif abs(np.interp(0.0, force[:FEWEST], points.depth[up][:FEWEST])) > 0.5 * deepest:
        words = "near zero where the force is zero: count it from the first touch, or make zero unknown"
        found.append(Problem("depth", f"{points.depth[up][0]:.3g} m at the first point", words))
    if points.unloading.any() and points.unloading.sum() < FEWEST:
        words = f"at least {FEWEST} points of it, or none"
        found.append(Problem("unloading", f"{points.unloading.sum()} points", words))
    return found


def refused(source: str, key: str, value: str, allowed: str) -> SceneError:
    """The error of one thing in a file."""
    return SceneError([Problem(key, value, allowed)], source)
