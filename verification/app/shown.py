# SPDX-License-Identifier: MIT
"""What `samfem solve` prints: how a solve ended, in what time, on how many cells, and its quantities."""

from __future__ import annotations

from collections.abc import Mapping

from sam.scene import Result
from verification.runs.files import Run
from verification.text.readable import in_working_unit, with_prefix, with_time

ROUNDING = 1e-12
"""Of the contact radius: a length below it is shown as 0 to a person."""


def status_line(result: Result | Run) -> str:
    """Status, time and cells or elements, on one line."""
    cost = result.cost
    seconds = sum(cost.get(name) or 0.0 for name in ("setup_s", "solve_s"))
    return f"{result.status} in {with_time(seconds)}: {_cells(result.discretisation)}"


def load_line(result: Result | Run) -> str:
    """At which load the quantities are, where that is not the peak; else empty."""
    last = result.last_fitting
    return (
        f"the peak load was not reached; at the last load that fitted, {last['force_N']:.6g} N:"
        if last
        else ""
    )


def _cells(found: Mapping[str, object]) -> str:
    """The discretisation in words."""
    if "cells" in found:
        size = " x ".join(dict.fromkeys(with_prefix(side, "m") for side in found["cell_m"]))
        (nx, ny), touching = found["cells"], found["contact_cells"]
        return f"{nx} x {ny} cells of {size}, {touching} in contact, {found['depths']} depths"
    smallest = with_prefix(found["h_m"], "m")
    return f"{found['elements']} elements, the smallest {smallest}, {found['dofs']} unknowns"


def quantity_rows(result: Result | Run, terminal: bool) -> list[tuple[str, str]]:
    """Name and value of each quantity that applies: for a terminal in GPa, um and N, else in SI as
    summary.json has them.

    Where the peak load was not reached, those of the last load that was, see `load_line`.
    """
    values = result.last_fitting or result.quantities
    found = {name: value for name, value in values.items() if value is not None}
    if terminal:
        least = ROUNDING * (found.get("contact_radius_m") or 0.0)
        noise = {name for name, value in found.items() if name.endswith("_m") and abs(value) < least}
        return [in_working_unit(name, 0.0 if name in noise else value) for name, value in found.items()]
    return [(name, f"{value:.6g}") for name, value in found.items()]
