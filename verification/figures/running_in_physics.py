# SPDX-License-Identifier: MIT
"""Running-in under other physics: the worn volume over the cycles, for each material and counter-body."""

from __future__ import annotations

import itertools
from collections.abc import Mapping

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from verification.figures.style import BLACK, BLUE, GREEN, VERMILION, Columns, Drawing, sheet

COLORS, LINES = (BLUE, GREEN, VERMILION), ("-", "--")
"""Of the ways to harden, and of the signs of friction, in order."""
Series = Mapping[tuple[str, str], np.ndarray]
"""(hardening, sign of friction) -> (cycles,) volume in um3 after each cycle."""


def volumes(panels: Mapping[tuple[str, str], Series]) -> Drawing:
    """A row for each material, with a scale of its own, a column for each counter-body; colours say how the
    body hardens, dashes whether friction changes its sign. panels: (material, counter-body) -> its lines.
    """
    numbers = Columns("material", "counter-body", "hardening", "friction", "cycle", "volume_um3")
    materials, counters = (list(dict.fromkeys(names)) for names in zip(*panels, strict=True))
    hardenings, signs = _names(panels)
    size = (len(materials), len(counters))
    with sheet(2.3 * max(3, size[1]), 1.1 + 1.6 * size[0], size, sharex=True, sharey="row") as (figure, axes):
        for (row, material), (column, counter) in itertools.product(
            enumerate(materials), enumerate(counters)
        ):
            panel = axes[row, column]
            for (hardening, sign), volume in panels[material, counter].items():
                look = {"color": hardenings[hardening], "linestyle": signs[sign], "linewidth": 1.3}
                volume = np.append(0.0, volume)
                panel.plot(np.arange(volume.size), volume, **look)
                numbers.add(material, counter, hardening, sign, np.arange(volume.size), volume)
            panel.xaxis.set_major_locator(MaxNLocator(5, integer=True))
        for row, material in zip(axes, materials, strict=True):
            row[0].set_ylabel(f"{material} [µm³]")
            row[0].set_ylim(bottom=0.0)
        for panel, counter in zip(axes[0], counters, strict=True):
            panel.set_title(_broken(counter))
        for panel in axes[-1]:
            panel.set_xlabel("cycle")
        named = [Line2D([], [], color=color, label=name) for name, color in hardenings.items()]
        named += [
            Line2D([], [], color=BLACK, linestyle=line, label=f"{name} friction")
            for name, line in signs.items()
        ]
        figure.legend(handles=named, loc="outside lower center", ncols=len(named))
    return Drawing(figure, numbers)


def _names(panels: Mapping[tuple[str, str], Series]) -> tuple[dict[str, str], dict[str, str]]:
    """Colour of each way to harden, dash of each sign, in the order in which they come."""
    keys = list(dict.fromkeys(key for lines in panels.values() for key in lines))
    hardenings, signs = (list(dict.fromkeys(key[k] for key in keys)) for k in (0, 1))
    return dict(zip(hardenings, COLORS, strict=False)), dict(zip(signs, LINES, strict=False))


def _broken(title: str) -> str:
    """In two lines at the last comma."""
    first, comma, rest = title.rpartition(", ")
    return f"{first},\n{rest}" if comma else title
