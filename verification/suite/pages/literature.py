# SPDX-License-Identifier: MIT
"""The literature that the cases name, with the identifiers (DOI) of what has one: literature.csv."""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping
from functools import cache
from importlib import resources
from typing import NamedTuple

NOT_CONFIRMED = "not confirmed"


class Work(NamedTuple):
    """A publication. mark: a regular expression that finds it in the words of a case; doi: as public lists of
    references or the first page of the work have it, NOT_CONFIRMED where none was found, empty without.
    """

    mark: str
    text: str
    doi: str


@cache
def works() -> tuple[Work, ...]:
    """All rows of the file."""
    text = (
        resources.files("verification.suite").joinpath("pages", "literature.csv").read_text(encoding="utf-8")
    )
    return tuple(Work(**row) for row in csv.DictReader(text.splitlines()))


def works_of(case: Mapping) -> list[tuple[str, str]]:
    """(citation, link) of what the question, the equations and the notes of a case refer to; no link without
    a confirmed DOI.
    """
    words = [text for row in case["equations"] for text in row]
    text = "\n".join([*words, case["question"], *case["notes"]])
    return [_cited(work) for work in works() if re.search(work.mark, text)]


def _cited(work: Work) -> tuple[str, str]:
    if work.doi == NOT_CONFIRMED:
        return f"{work.text} (DOI {work.doi})", ""
    return work.text, f"https://doi.org/{work.doi}" if work.doi else ""
