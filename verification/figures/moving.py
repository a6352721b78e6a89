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
    log_ticks,
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


def new_strains(found: Mapping[str, Sequence[float]], floors: Sequence[float] = ()) -> Drawing:
    """The largest plastic strain that each pass adds to a cell of the steady part; no mark where it is 0.
    floors: strains below which a verdict counts none.
    """
    rows = Columns("run", "pass", "new strain")
    with sheet(6.6, 3.2) as (figure, axis):
        for (name, strains), (color, mark) in zip(found.items(), LOOKS, strict=False):
            numbers, strains = np.arange(1, len(strains) + 1), np.array(strains, dtype=float)
            shown = np.where(strains > 0.0, strains, np.nan)
            axis.semilogy(numbers, shown, color=color, marker=mark, fillstyle="none", label=name)
            rows.add(name, numbers, strains)
        for floor in floors:
            first = floor == floors[0]
            label = "floor of the verdict" if first else ""
            axis.axhline(floor, color=BLACK, linewidth=0.8, linestyle=":", label=label)
        axis.set(xlabel="pass", ylabel="largest new plastic strain")
        axis.xaxis.set_major_locator(MaxNLocator(integer=True))
        figure.legend(loc="outside right center")
    return Drawing(figure, rows)


def errors_over_counts(panels: Mapping[str, Mapping[str, Line]]) -> Drawing:
    """Relative errors (n,) over the number (n,) of steps or cells in a radius of the contact, logarithmic.
    panels: what is counted -> quantity -> line.
    """
    rows = Columns("counted", "quantity", "in a radius", "error_percent")
    with sheet(3.4 * len(panels), 3.0, len(panels), sharey=True) as (figure, axes):
        for axis, (counted, lines) in zip(axes, panels.items(), strict=True):
            for (name, (counts, errors)), (color, mark) in zip(lines.items(), LOOKS, strict=False):
                axis.loglog(counts, 1e2 * errors, color=color, marker=mark, label=name)
                axis.set_xticks(counts, map(str, counts))
                rows.add(counted, name, counts, 1e2 * errors)
            axis.minorticks_off()
            axis.set(xlabel=f"{counted} in $a$")
            log_ticks(axis.yaxis)
            axis.legend()
        axes[0].set_ylabel("error against the limit [%]")
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
            axis.plot(numbers, values, "o-", color=BLUE, markersize=4)
            axis.set(xlabel="pass", ylabel=words, xlim=(0.5, numbers[-1] + 0.5))
            axis.xaxis.set_major_locator(MaxNLocator(integer=True, min_n_ticks=2))
            zero_line(axis)
        rows.add(numbers, friction, wear)
    return Drawing(figure, rows)
