# SPDX-License-Identifier: MIT
"""Keys of a scene that its schema makes sure of, where another key asks for them."""

from __future__ import annotations

from typing import TypeVar

T = TypeVar("T")


def needed(value: T | None) -> T:
    """The value of a key that the scene has, as the schema refuses it without.

    >>> needed(0.0)
    0.0
    """
    if value is None:
        raise ValueError("the scene lacks a key that its schema asks for")
    return value
