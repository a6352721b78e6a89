# SPDX-License-Identifier: MIT
"""Points of measured tests: force over depth, or the profile of a dent; and what is wrong with them."""

from __future__ import annotations

import gzip
import io
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sam.scene import Problem, SceneError, in_unit, printable

COLUMNS = {
    "force": ("N", ("force", "load", "p", "f")),
    "depth": ("m", ("depth", "approach", "displacement", "uz", "h", "d")),
    "height": ("m", ("height", "z")),
    "x": ("m", ("x", "r", "radius", "position")),
    "strain": ("", ("strain", "e")),
    "stress": ("Pa", ("stress", "s")),
}
"""What a column is -> its SI unit, and the names that it may have before its unit."""
KINDS = {"curve": ("force", "depth"), "profile": ("x", "depth"), "tensile": ("strain", "stress")}
EXAMPLES = {"N": "mN", "m": "um", "Pa": "MPa", "": "percent"}
"""SI unit of a column -> the one in an example."""
PLAIN = {"": 1.0, "1": 1.0, "%": 0.01, "percent": 0.01}
LARGEST = 2**26  # bytes of a table
FEWEST = 8  # points of a branch or a profile
FOOT = 0.25  # share of the largest force at which a curve from the first touch has begun
DEEPEST = 0.3  # depth over the radius of the ball: beyond any contact that the model takes
STIFF = 5.0  # times less deep than Hertz: more than a wrong modulus explains
FALLING = 0.05  # share of the largest force by which loading may fall between neighbours: noise
GZIP = b"\x1f\x8b"
_HEAD = re.compile(r"\s*([A-Za-z]+)[\s_]*[\[(]?\s*([^\])\s_]*)\s*[\])]?\s*")


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
    x, depth = read_columns(content, kind, units, source)
    if kind == "profile":
        return Points(np.abs(x), depth, np.zeros(x.size, bool))
    return Points(x, depth, np.arange(x.size) > np.argmax(x))


def read_columns(content: bytes, kind: str, units: Sequence[str], source: str) -> list[np.ndarray]:
    """The columns of KINDS in a CSV file, or one compressed by gzip, in SI; otherwise as `read_points`."""
    import pandas as pd

    try:
        if content.startswith(GZIP):
            content = gzip.GzipFile(fileobj=io.BytesIO(content)).read(LARGEST)
        frame = pd.read_csv(io.BytesIO(content), comment="#", skipinitialspace=True)
    except (OSError, EOFError, ValueError) as error:
        raise refused(source, "", "", f"no table of numbers: {error}") from None
    if units and len(units) != len(frame.columns):
        raise refused(source, "units", str(len(units)), f"as many as there are columns, {len(frame.columns)}")
    found: dict[str, np.ndarray] = {}
    for k, head in enumerate(map(str, frame.columns)):
        parts = _HEAD.fullmatch(head)
        word, unit = (parts[1].lower(), units[k] if units else parts[2]) if parts else ("", "")
        name = next((name for name, (_, words) in COLUMNS.items() if word in words), "")
        if name:
            values = pd.to_numeric(frame.iloc[:, k], errors="coerce").to_numpy(float)
            if not np.isfinite(values).all():
                row = int(np.argmin(np.isfinite(values)))
                what, number = f"{head}, row {row + 1}", str(frame.iloc[row, k])
                raise refused(source, what, number, "a number in each row")
            found[name] = values * _factor(COLUMNS[name][0], unit, head, source)
    if "height" in found and "depth" not in found:
        found["depth"] = -found.pop("height")
    if missing := [name for name in KINDS[kind] if name not in found]:
        example = ", ".join(f"{name}_{EXAMPLES[COLUMNS[name][0]]}" for name in KINDS[kind])
        said = ", ".join(map(str, frame.columns))
        raise refused(source, "columns", printable(said[:60]), f"a column {missing[0]}: such as {example}")
    return [found[name] for name in KINDS[kind]]


def _factor(si: str, unit: str, head: str, source: str) -> float:
    """How many SI units the unit of a column is."""
    factor = in_unit(f"1 {unit}", si) if si and unit else PLAIN.get(unit) if not si else None
    if factor is None:
        words = f"a unit such as {EXAMPLES[si]} in the name of the column, or units in the test"
        raise refused(source, f"column {printable(head)}", printable(unit) or "without unit", words)
    return float(factor)


def faults(points: Points, kind: str, radius: float, elastic: float) -> list[Problem]:
    """What points say that cannot be of a ball of this radius in m; elastic: the approach of Hertz in m at
    the largest force.
    """
    if points.x.size < FEWEST:
        return [Problem("points", str(points.x.size), f"at least {FEWEST}")]
    if kind == "profile":
        reach, words = points.x.max(), f"of {1e-3 * radius:.3g} to {4.0 * radius:.3g} m: is its unit another?"
        fits = 1e-3 * radius < reach < 4.0 * radius
        return [] if fits else [Problem("x", f"up to {reach:.3g} m", words)]
    largest, deepest = float(points.x.max()), float(points.depth.max())
    if not elastic / STIFF < deepest < DEEPEST * radius:
        words = f"from {elastic:.3g} m (Hertz) to {DEEPEST * radius:.3g} m: another unit, sign or radius?"
        return [Problem("depth", f"at most {deepest:.3g} m", words)]
    up = ~points.unloading
    force, depth, back = points.x[up], points.depth[up], int(points.unloading.sum())
    first = np.interp(0.0, force[:FEWEST], depth[:FEWEST])
    fallen = (np.maximum.accumulate(force) - force).max()
    touch = f"points from the first touch on, some below {FOOT:g} of the largest force"
    order = "one loading and one unloading, in the order in which they were measured"
    near = "near zero there: count it from the first touch"
    rules = (
        (up.sum() < FEWEST, "loading", f"{up.sum()} points", f"at least {FEWEST} up to the largest force"),
        (force.min() > FOOT * largest, "force", f"from {force.min():.3g} N", touch),
        (fallen > FALLING * largest, "force", "falls before its peak", order),
        (abs(first) > FOOT * deepest, "depth", f"{first:.3g} m where the force is the least", near),
        (0 < back < FEWEST, "unloading", f"{back} points", f"at least {FEWEST}, or none"),
    )
    return [Problem(*problem) for wrong, *problem in rules if wrong]


def refused(source: str, key: str, value: str, allowed: str) -> SceneError:
    """The error of one thing in a file."""
    return SceneError([Problem(key, value, allowed)], source)
