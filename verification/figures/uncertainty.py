# SPDX-License-Identifier: MIT
"""The uncertainty of numbers over their true error, by two rules."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from verification.figures.style import BLACK, BLUE, VERMILION, Columns, Drawing, sheet

_LOOKS = ((BLUE, "o"), (VERMILION, "x"))
Points = Sequence[tuple[str, str, float, float]]
"""Scene, quantity, relative error and relative uncertainty of each value."""


def coverage(panels: Mapping[str, Points]) -> Drawing:
    """panels: rule -> points; what lies below the line is not covered."""
    rows = Columns("rule", "scene", "quantity", "error_percent", "uncertainty_percent")
    with sheet(4.0 * len(panels), 3.8, len(panels), sharey=True) as (figure, axes):
        for axis, (title, points), (colour, mark) in zip(axes, panels.items(), _LOOKS, strict=True):
            errors, bounds = ([1e2 * point[k] for point in points] for k in (2, 3))
            look = {"color": colour, "marker": mark, "markersize": 3.0}
            axis.loglog(errors, bounds, linestyle="none", **look, label="a value")
            ends = [min(errors), max(bounds)]
            axis.loglog(ends, ends, color=BLACK, linewidth=1.0, label="uncertainty = error")
            axis.set(title=title, xlabel="error [%]")
            axis.legend()
            for scene, quantity, error, bound in points:
                rows.add(title, scene, quantity, 1e2 * error, 1e2 * bound)
        axes[0].set_ylabel("uncertainty [%]")
    return Drawing(figure, rows)
