# SPDX-License-Identifier: MIT
"""What `samfem solve` prints: how a solve ended, in what time, on how many cells, and its quantities."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

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


def undecided_line(result: Result | Run) -> str:
    """How many more load cycles would tell what becomes of the body, where that is undecided; else empty."""
    verdict = result.verdict
    if not verdict or verdict["class"] != "undecided":
        return ""
    more = verdict.get("periods_to_decide")
    what = f"about {more * verdict['cycles_in_period']} more of loading.cycles" if more else "no more cycles"
    hint = "" if more else ", a smaller solver.tolerance might"
    return f"what becomes of the body under repeated loading is undecided: {what} would decide it{hint}"


def _cells(found: Mapping[str, Any]) -> str:
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


def uncertain_table(result: Result | Run, terminal: bool) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Heads and rows: name, value, uncertainty, and the shares of cells, load steps and box in percent."""
    parts = {name: f"u_{name}" for name in ("cells", "steps", "box")}
    found, rows = result.uncertainty or {}, []
    shown = {name for name in parts if any(entry.get(parts[name]) for entry in found.values())}
    for words, value in zip(_known(result), quantity_rows(result, terminal), strict=True):
        entry = found.get(words, {})
        total, size = entry.get("u_num"), abs(result.quantities[words] or 0.0)
        of_parts = [_percent(entry.get(key), size) for name, key in parts.items() if name in shown]
        around = ""
        if total is not None:
            around = in_working_unit(words, total, digits=2)[1] if terminal else f"{total:.2g}"
        order = "" if entry.get("order_seen") is None else f"{entry['order_seen']:.2g}"
        short = "not converging" if total is not None and entry["flag"] else ""
        rows.append((*value, around, _percent(total, size), *of_parts, order, short))
    heads = ("quantity", result.model, "+-", "%", *(name for name in parts if name in shown))
    return (*heads, "order seen", ""), rows


def uncertain_lines(result: Result | Run) -> list[str]:
    """What the uncertainty is taken from, and which quantities have none, with the reason."""
    lines: list[str] = []
    without: dict[str, list[str]] = {}
    for name, entry in (result.uncertainty or {}).items():
        if entry["u_num"] is None:
            without.setdefault(entry["flag"], []).append(name)
        elif not lines:
            cells = ", ".join(f"{number:g}" for number in entry["cells"])
            steps = ", ".join(f"{number:g}" for number in entry["steps"])
            what = "cells" if "cells" in result.discretisation else "elements in the radius"
            on = f"; 2 times, from {steps} load steps on coarse ones" if steps else ""
            lines.append(f"uncertainty: 3 times the estimated error, from {cells} {what}{on}")
    return lines + [f"no uncertainty: {', '.join(names)}: {reason}" for reason, names in without.items()]


def _known(result: Result | Run) -> list[str]:
    """Names of the quantities that apply, in the order of `quantity_rows`."""
    return [name for name, value in (result.last_fitting or result.quantities).items() if value is not None]


def _percent(part: float | None, size: float) -> str:
    return "" if part is None or not size else f"{100 * part / size:.2g}"
