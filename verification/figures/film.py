# SPDX-License-Identifier: MIT
"""The figures of films that yield, of the frame of `verification.cases.coated.film_yield`: what
they change over the contact radius, and pressures.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from verification.figures.lines import Curve, curves
from verification.figures.style import BLACK, BLUE, GREEN, VERMILION, Drawing
from verification.runs.sampling import peak

if TYPE_CHECKING:
    from pandas import DataFrame

GIGA, MICRO, PERCENT = 1e-9, 1e6, 1e2


def _series(body: str, film: str) -> str:
    """The name of a curve."""
    return f"body {body}, " + ("no film" if film == "bare" else f"film {film}")


LOOKS = {
    _series(body, film): {"color": color, "linewidth": width, "linestyle": line}
    for body, color in {"elastic": BLACK, "B 945": BLUE, "B 1780": VERMILION}.items()
    for film, width, line in (("bare", 0.9, ":"), ("elastic", 1.4, "-"), ("yields", 1.4, "--"))
}
"""Of each curve by its name: colour by body, line by film."""


def changes(found: DataFrame, limit: float) -> Drawing:
    """Changes of the largest pressure and of the von Mises stress of the body over the contact radius."""
    panels: dict[str, dict[str, Curve]] = {}
    ends = MICRO * np.array([found["radius"].min(), found["radius"].max()])
    for name, words in (("p_change", "largest pressure"), ("mises_change", "von Mises in the body")):
        for counter, ones in found.groupby("counterbody"):
            panel = panels[f"{words}, {counter}"] = {}
            for kind, own in ones.sort_values("radius").groupby(["body", "film"], sort=False):
                xy = (own[["radius", name]].to_numpy() * (MICRO, PERCENT)).T
                panel[_series(*kind)] = Curve(*xy, look={"marker": "o", "markersize": 4})
            panel["limit"] = Curve(ends, np.full(2, -PERCENT * limit))
    looks = LOOKS | {"limit": {"color": GREEN, "linewidth": 1.0, "linestyle": "-."}}
    return curves(panels, r"$a_0$ [$\mu$m]", "change [%]", looks=looks)


def pressures(found: DataFrame, bare_radius: float) -> Drawing:
    """Pressure in GPa over r/a0: a panel for each contact radius, without film and with each."""
    panels: dict[str, dict[str, Curve]] = {}
    for _, one in found[found["body"] != "B 1780"].iterrows():
        panel = panels.setdefault(_title(one["radius"]), {})
        runs = (("bare", one["bare"], bare_radius), (one["film"], one["result"], one["radius"]))
        for film, result, a in runs:
            r, p = peak(result.tables["line"], "x_m", "p_Pa")
            panel[_series(one["body"], film)] = Curve(r[use := r <= 1.4 * a] / a, GIGA * p[use])
    return curves(panels, "$r/a_0$", "pressure [GPa]", looks=LOOKS)


def _title(radius: float) -> str:
    """The contact radius of a panel."""
    return rf"$a_0$ = {MICRO * radius:g} $\mu$m"
