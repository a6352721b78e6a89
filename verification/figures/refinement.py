# SPDX-License-Identifier: MIT
"""Values over the size of steps or cells with their extrapolation to zero, and points over published
correlations.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from verification.figures.style import BLACK, FEM, GREEN, ORANGE, SAM, Columns, Drawing, sheet
from verification.reference.convergence import Limit

_MARKS = {"SAM": SAM | {"marker": "o", "fillstyle": "none"}, "FEM": FEM | {"marker": "x"}}
_FITS = (
    {"color": BLACK, "linestyle": "-", "linewidth": 1.2},
    {"color": ORANGE, "linestyle": "--", "linewidth": 1.6},
)
Curves = Mapping[str, tuple[np.ndarray, np.ndarray, Limit]]


def refinement(panels: Mapping[str, Curves], xlabels: Mapping[str, str], ylabel: str) -> Drawing:
    """Strains in % over h, down to their limits at h = 0; panels: title -> "SAM" or "FEM" -> (h, strain,
    limit).
    """
    rows = Columns("panel", "series", "h", "strain_percent", "limit_percent")
    with sheet(4.2 * len(panels), 3.4, len(panels), sharey=True) as (figure, axes):
        for axis, (title, curves) in zip(axes, panels.items(), strict=True):
            for name, (h, strain, limit) in curves.items():
                look = _MARKS[name]
                order = f"order {limit.order:.2f}" if limit.observed else "no order observed"
                axis.plot(h, 1e2 * strain, **look | {"linestyle": "none"})
                axis.plot([], [], **look | {"linewidth": 1.0}, label=f"{name}: {order}")
                dense = np.linspace(0.0, h.max(), 200)
                axis.plot(
                    dense, 1e2 * limit(dense), color=look["color"], linestyle=look["linestyle"], linewidth=1.0
                )
                axis.plot(
                    0.0,
                    1e2 * limit.limit,
                    marker="D",
                    markersize=5,
                    linestyle="none",
                    color=look["color"],
                    clip_on=False,
                )
                rows.add(title, name, h, 1e2 * strain, 1e2 * limit.limit)
            axis.plot([], [], marker="D", markersize=5, color=BLACK, linestyle="none", label="limit")
            axis.set(title=title.capitalize(), xlabel=xlabels[title], xlim=(0.0, None))
            axis.legend()
        axes[0].set_ylabel(ylabel)
    return Drawing(figure, rows)


def correlations(
    panels: Mapping[str, tuple[Mapping[str, Callable], Mapping[str, tuple[np.ndarray, np.ndarray]]]],
    limits: tuple[float, float],
    band: float,
) -> Drawing:
    """Ratios over w* with published fits, and underneath the distance from the first fit.

    panels: label -> (name of the fit -> function of w*, "SAM" or "FEM" -> (w*, ratio)); band: tolerance,
    shaded.
    """
    rows = Columns("panel", "series", "w", "ratio", "percent_from_first_fit")
    dense = np.geomspace(*limits, 400)
    with sheet(4.2 * len(panels), 4.4, (2, len(panels)), sharex=True, height_ratios=(3, 1.6)) as (
        figure,
        axes,
    ):
        for (upper, lower), (label, (fits, series)) in zip(axes.T, panels.items(), strict=True):
            first = next(iter(fits.values()))
            for (name, fit), look in zip(fits.items(), _FITS, strict=True):
                upper.loglog(dense, fit(dense), **look, label=name)
                lower.plot(dense, 1e2 * (fit(dense) / first(dense) - 1.0), **look)
            for name, (w, ratio) in series.items():
                distance = 1e2 * (ratio / first(w) - 1.0)
                look = _MARKS[name] | {"linestyle": "none"}
                upper.loglog(w, ratio, **look, label=name)
                lower.plot(w, distance, **look)
                rows.add(label, name, w, ratio, distance)
            lower.axhspan(-1e2 * band, 1e2 * band, color=GREEN, alpha=0.15, linewidth=0.0)
            lower.set(xlabel="approach $w^*$", ylabel="difference [%]")
            upper.set(ylabel=label)
            upper.legend()
        figure.align_ylabels()
    return Drawing(figure, rows)
