# SPDX-License-Identifier: MIT
"""Tracks of a counter-body that moves: the groove along the path, and what each pass adds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.ticker import MaxNLocator

from verification.figures.style import (
    BLACK,
    BLUE,
    GREEN,
    ORANGE,
    PURPLE,
    VERMILION,
    Columns,
    Drawing,
    sheet,
    zero_line,
)

Line = tuple[np.ndarray, np.ndarray]
LOOKS = tuple(zip((BLUE, VERMILION, GREEN, ORANGE, PURPLE, BLACK), "os^Dvx", strict=True))


def grooves(found: Mapping[str, Line], length: float) -> Drawing:
    """Depths (n,) over distances from the start (n,), both in radii of the contact; length of the path."""
    rows = Columns("run", "s/a", "uz/a")
    with sheet(6.2, 3.2) as (figure, axis):
        for (name, (way, depth)), (color, _) in zip(found.items(), LOOKS, strict=False):
            axis.plot(way, 1e3 * depth, color=color, label=name)
            rows.add(name, way, depth)
        for end, name in ((0.0, "ends of the path"), (length, "")):
            axis.axvline(end, color=BLACK, linewidth=0.6, linestyle=":", label=name)
        axis.set(xlabel="distance from the start, $s/a$", ylabel=r"$10^3\, u_z/a$")
        axis.invert_yaxis()
        axis.legend(loc="lower right")
    return Drawing(figure, rows)


def new_strains(found: Mapping[str, Sequence[float]]) -> Drawing:
    """The largest plastic strain that each pass adds to a cell of the steady part; no mark where it is 0."""
    rows = Columns("run", "pass", "new strain")
    with sheet(5.0, 3.2) as (figure, axis):
        for (name, strains), (color, mark) in zip(found.items(), LOOKS, strict=False):
            numbers, strains = np.arange(1, len(strains) + 1), np.array(strains, dtype=float)
            axis.semilogy(
                numbers, np.where(strains > 0.0, strains, np.nan), color=color, marker=mark, label=name
            )
            rows.add(name, numbers, strains)
        axis.set(xlabel="pass", ylabel="largest new plastic strain")
        axis.xaxis.set_major_locator(MaxNLocator(integer=True))
        axis.legend()
    return Drawing(figure, rows)


def of_passes(passes: Mapping[str, Sequence]) -> Drawing:
    """Coefficient of friction and wear of each pass, from passes.csv."""
    rows = Columns("pass", "friction", "wear [um3]")
    numbers, friction = np.asarray(passes["pass"]), np.asarray(passes["friction_mean"], dtype=float)
    wear = 1e18 * np.asarray(passes["wear_of_pass_m3"], dtype=float)
    with sheet(6.2, 2.8, 2) as (figure, axes):
        for axis, values, words in zip(
            axes, (friction, wear), ("coefficient of friction", "wear [µm³]"), strict=True
        ):
            axis.plot(numbers, values, "o-")
            axis.set(xlabel="pass", ylabel=words)
            axis.xaxis.set_major_locator(MaxNLocator(integer=True))
            zero_line(axis)
        rows.add(numbers, friction, wear)
    return Drawing(figure, rows)
