# SPDX-License-Identifier: MIT
"""The table [compare] of a scene: how two results of it are judged. It changes no result."""

from __future__ import annotations

from typing import Literal

from sam.scene.section import Section


class Compare(Section):
    """claim "negligible-film": a comparison fails if the film changes pressure or stress of the body by more
    than its limit.
    """

    claim: Literal["negligible-film"] | None = None
