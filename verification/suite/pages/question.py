# SPDX-License-Identifier: MIT
"""A question of the first page, and what looks for its answer."""

from __future__ import annotations

from dataclasses import dataclass

from verification.suite.pages.findings import Part


@dataclass(frozen=True)
class Question:
    """A row of the index. page: with the evidence; note: what the numbers need to be understood."""

    words: str
    page: str
    parts: tuple[Part, ...] = ()
    note: str = ""
