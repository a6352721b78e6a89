# SPDX-License-Identifier: MIT
"""The tribofilm that decides on the local coefficient of friction: its state and its law."""

from __future__ import annotations

from sam.tribofilm.law import FilmLaw, FilmState

__all__ = ["FilmLaw", "FilmState"]
