# SPDX-License-Identifier: MIT
"""An instrument's file read by SurfaceTopography, in a process of its own: see `sam.scene.inputs`."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
from numpy.typing import NDArray


class RefusedError(Exception):
    """A file without usable heights; the message says why."""


def answer(content: bytes, most: str, *formats: str) -> tuple[dict[str, Any], dict[str, NDArray[np.float64]]]:
    """The extent in m, and the heights in m, x first, nan where one is missing; at most so many a side."""
    head, heights = heights_in(content, list(formats), int(most))
    return head, {"heights": heights}


def heights_in(content: bytes, formats: list[str], most: int) -> tuple[dict[str, Any], NDArray[np.float64]]:
    """Words of the first format that opens, and heights (nx, ny) in m."""
    from SurfaceTopography.IO import open_topography

    reasons = []
    for name in formats:
        try:
            reader = open_topography(io.BytesIO(content), format=name)
        except Exception as error:  # readers of forty formats raise errors of as many kinds
            reasons.append(f"{type(error).__name__} {error}".strip())
            continue
        with reader:
            return _heights_of(reader, name, most)
    raise RefusedError("; ".join(reasons))


def _heights_of(reader: Any, name: str, most: int) -> tuple[dict[str, Any], NDArray[np.float64]]:
    """The heights of the channel that is the default of the format, or else of the first with heights."""
    usable = [channel for channel in reader.channels if channel.is_height_channel and channel.dim == 2]
    default = [channel for channel in usable if channel.index == reader.default_channel.index]
    channel = next(iter(default + usable), None)
    if channel is None or channel.is_uniform is False:
        raise RefusedError("no map of heights on a regular grid")
    if channel.nb_grid_pts is not None and max(channel.nb_grid_pts) > most:
        raise RefusedError(
            f"{' x '.join(map(str, channel.nb_grid_pts))} heights: at most {most} each way are allowed"
        )
    if channel.physical_sizes is None or len(channel.physical_sizes) != 2:
        raise RefusedError("the file does not say how large the map is")
    topography = channel.topography()
    if topography.unit is None:
        raise RefusedError("the file does not say in which unit its heights are")
    topography = topography.to_unit("m")
    heights: NDArray[np.float64] = np.ma.filled(np.ma.asarray(topography.heights(), dtype=float), np.nan)
    extent = [float(side) for side in topography.physical_sizes]
    return {"format": name, "extent": extent}, heights
