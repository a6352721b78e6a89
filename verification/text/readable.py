# SPDX-License-Identifier: MIT
"""Numbers for a person: SI values with a prefix, and quantities in the units of contact mechanics, GPa and
um.
"""

from __future__ import annotations

import math

PREFIXES = {-12: "p", -9: "n", -6: "u", -3: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T", 15: "P", 18: "E"}
WORKING_UNITS = {
    "Pa": ("GPa", 1e9),
    "m": ("um", 1e-6),
    "m2": ("um^2", 1e-12),
    "m3": ("um^3", 1e-18),
    "N": ("N", 1.0),
}
"""SI unit at the end of the name of a quantity -> unit for a person, and what it is in SI."""


def with_prefix(value: float, unit: str, digits: int = 3) -> str:
    """A value in an SI unit (or in bytes, "B") with the prefix that leaves 1 to 999 before it: 1.2e13 B is
    "12 TB".
    """
    if not math.isfinite(value) or value == 0:
        return f"{value:g} {unit}"
    rounded = float(f"{value:.{digits - 1}e}")
    power = 3 * math.floor(math.log10(abs(rounded)) / 3)
    least = 0 if unit == "B" else min(PREFIXES)
    power = min(max(power, least), max(PREFIXES))
    return f"{float(f'{value / 10.0**power:.{digits}g}'):g} {PREFIXES[power]}{unit}"


def in_working_unit(name: str, value: float, digits: int = 6) -> tuple[str, str]:
    """A quantity in the unit of the contact, GPa, um or N: ("p_max_Pa", 2.1e9) is ("p_max", "2.1 GPa")."""
    words, _, si = name.rpartition("_")
    unit, size = WORKING_UNITS.get(si, ("", 1.0))
    if not unit:
        return name, f"{value:.{digits}g}"
    return words, f"{value / size:.{digits}g} {unit}"


def with_time(seconds: float, digits: int = 2) -> str:
    """A time to a few digits in s, min, h or days."""
    for size, unit in ((1, "s"), (60, "min"), (3600, "h")):
        if seconds < 100 * size:
            return f"{float(f'{seconds / size:.{digits}g}'):g} {unit}"
    return f"{float(f'{seconds / 86400:.{digits}g}'):g} days"
