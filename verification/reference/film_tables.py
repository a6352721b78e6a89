# SPDX-License-Identifier: MIT
"""Tables 2 and 3 of Bosman & Schipper (2011): chemical films of other studies, and how fast they grow.

Table 2 has a row for each study, in the units printed; where one value is printed the columns low and high
are equal, and thickness_bound keeps the sign (<, >, ~) that stands beside it. An empty cell: not given.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from importlib import resources

Rows = Sequence[Mapping[str, str]]


def table(number: int) -> Rows:
    """Column -> text of each row of Table 2 or 3."""
    file = resources.files("verification").joinpath("data", f"table-{number}.csv")
    return list(csv.DictReader(file.read_text(encoding="ascii").splitlines()))


def mean_of(rows: Rows, name: str) -> tuple[float, int]:
    """Mean over the studies that give a quantity, and how many they are.

    name: "thickness" (nm) or "young" (GPa); ranges count at their middle, bounds as values.
    """
    low, high = (next(key for key in rows[0] if key.startswith(f"{name}_{end}")) for end in ("low", "high"))
    middles = [(float(row[low]) + float(row[high])) / 2.0 for row in rows if row[low]]
    return sum(middles) / len(middles), len(middles)


def growth_coefficients() -> dict[float, float]:
    """Bath temperature in degrees Celsius -> K_0 in nm/s^0.5 of Table 3."""
    return {float(row["bath_C"]): float(row["diffusion_nm_per_sqrt_s"]) for row in table(3)}
