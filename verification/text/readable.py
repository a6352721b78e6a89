# SPDX-License-Identifier: MIT
"""Numbers for a person: SI values with a prefix, and quantities in the units of contact mechanics, GPa and
um.
"""

import math

PREFIXES = {-12: "p", -9: "n", -6: "u", -3: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T", 15: "P", 18: "E"}
WORKING_UNITS = {
    "Pa": {"GPa": 1e9, "MPa": 1e6},
    "m": {"mm": 1e-3, "um": 1e-6},
    "m2": {"mm^2": 1e-6, "um^2": 1e-12},
    "m3": {"mm^3": 1e-9, "um^3": 1e-18},
    "N": {"N": 1.0},
}
"""SI unit that ends a name -> units for a person, in SI; the first of which a value is at least a tenth."""


def with_prefix(value: float, unit: str, digits: int = 3) -> str:
    """A value in an SI unit (or bytes, "B") with a prefix that leaves 1 to 999: 1.2e13 B is "12 TB"."""
    if not math.isfinite(value) or value == 0:
        return f"{value:g} {unit}"
    rounded = float(f"{value:.{digits - 1}e}")
    power = 3 * math.floor(math.log10(abs(rounded)) / 3)
    least = 0 if unit == "B" else min(PREFIXES)
    power = min(max(power, least), max(PREFIXES))
    return f"{float(f'{value / 10.0**power:.{digits}g}'):g} {PREFIXES[power]}{unit}"


def in_working_unit(name: str, value: float, digits: int = 6, beside: float | None = None) -> tuple[str, str]:
    """("p_max_Pa", 2.1e9) is ("p_max", "2.1 GPa"), in a working unit. beside: the value that chooses it."""
    words, _, si = name.rpartition("_")
    units = WORKING_UNITS.get(si)
    if units is None:
        return name, f"{value:.{digits}g}"
    size_of = abs(value if beside is None else beside)
    unit, size = next((pair for pair in units.items() if size_of >= 0.1 * pair[1]), [*units.items()][-1])
    return words, f"{value / size:.{digits}g} {unit}"


def with_time(seconds: float, digits: int = 2) -> str:
    """A time to a few digits in s, min, h or days."""
    for size, unit in ((1, "s"), (60, "min"), (3600, "h")):
        if seconds < 100 * size:
            return f"{float(f'{seconds / size:.{digits}g}'):g} {unit}"
    return f"{float(f'{seconds / 86400:.{digits}g}'):g} days"
