# SPDX-License-Identifier: MIT
"""Tables in and out as CSV: numbers keep every digit, what is not a number is an empty cell.

pandas is loaded where a table is read, not with this module: to plan and to solve need none.
"""

from __future__ import annotations

import csv
import io
import re
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from pandas import DataFrame

TEXT_COLUMNS = ("state", "note", "verdict", "quantity", "flag")
"""Columns of the tables of a run that hold text; all others hold numbers."""
_QUOTED = re.compile(rb'"[^"]*"')


def contact_size(quantities: Mapping[str, float | None]) -> float:
    """Radius of a contact, or half-width of one below a cylinder, in m; 0 without one."""
    return quantities.get("contact_radius_m") or quantities.get("contact_half_width_m") or 0.0


def csv_text(columns: Sequence[str], rows: Iterable[Sequence]) -> str:
    """Rows as CSV: floats with the shortest digits that read back the same, None and NaN as empty cells."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([None if value != value else value for value in row] for row in rows)
    return text.getvalue()


def columns_text(table: Mapping[str, Sequence[Any] | np.ndarray]) -> str:
    """The same of a mapping from column name to values. Raises ValueError for columns of unequal length."""
    columns = [values.tolist() if isinstance(values, np.ndarray) else values for values in table.values()]
    return csv_text(list(table), zip(*columns, strict=True))


def read_table(content: bytes) -> DataFrame:
    """The table in a CSV file: floats (NaN: an empty cell), texts in TEXT_COLUMNS. Raises ValueError."""
    import pandas as pd

    kinds: defaultdict[str, type] = defaultdict(lambda: float, dict.fromkeys(TEXT_COLUMNS, str))
    table = pd.read_csv(io.BytesIO(content), dtype=kinds, na_values=[""], keep_default_na=False)
    if not len(table):  # pandas forgets the kinds of columns without rows
        table = table.astype({name: kinds[name] for name in table.columns})
    cells = _QUOTED.sub(b"", content).count(b",") + len(table) + 1
    if cells != len(table.columns) * (len(table) + 1):  # pandas fills rows that are too short
        raise ValueError(f"{cells} cells for {len(table)} rows of {len(table.columns)} columns")
    return table.fillna(dict.fromkeys(set(TEXT_COLUMNS) & set(table), ""))


def read_any_table(content: bytes) -> DataFrame:
    """The table of a comparison or a sweep: numbers, truths or texts. ValueError for no table."""
    import pandas as pd

    return pd.read_csv(io.BytesIO(content), keep_default_na=False, na_values=[""])


def frame_of(table: Mapping[str, Sequence[Any]]) -> DataFrame:
    """A table of a result as `read_table` gives it back from a file."""
    return read_table(columns_text(table).encode())
