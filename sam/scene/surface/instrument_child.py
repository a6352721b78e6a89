# SPDX-License-Identifier: MIT
"""A script, run in a process of its own: an instrument's file on stdin, its heights on stdout.

Arguments: the formats to try, as SurfaceTopography calls them, then the most cells of a side. Answer: a line
of JSON, with "refused", or with format, cells and extent in m, followed by the heights in m, float64, x
first, nan where one is missing.
"""

from __future__ import annotations

import io
import json
import os
import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray

SECONDS = 60  # of processor time: half of what the parent waits by the clock
BYTES = 4 << 30  # of address space: a file may hold at most 256 MiB
WORDS = 200  # characters of the library's words


class RefusedError(Exception):
    """A file without usable heights; the message says why."""


def heights_in(content: bytes, formats: list[str], most: int) -> tuple[dict[str, Any], NDArray[np.float64]]:
    """What the first format that opens says of the file, and the heights in m, (nx, ny).
    Raises RefusedError.
    """
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
    usable = [found for found in reader.channels if found.is_height_channel and found.dim == 2]
    default = [found for found in usable if found.index == reader.default_channel.index]
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
    return {"format": name, "cells": list(heights.shape), "extent": extent}, heights


def _limit() -> None:
    """Limits of this process; where the system knows none, the parent's clock has to do."""
    try:
        import resource  # noqa: PLC0415 - not on every system
    except ImportError:
        return
    for kind, most in (
        (resource.RLIMIT_CPU, SECONDS),
        (resource.RLIMIT_AS, BYTES),
        (resource.RLIMIT_CORE, 0),
    ):
        hard = resource.getrlimit(kind)[1]
        resource.setrlimit(kind, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard))


def main() -> None:
    """Read, answer."""
    answer = os.dup(1)
    os.dup2(2, 1)  # what the library prints is no answer
    _limit()
    content, (*formats, most) = sys.stdin.buffer.read(), sys.argv[1:]
    try:
        head, heights = heights_in(content, formats, int(most))
        raw = np.ascontiguousarray(heights, dtype="<f8").tobytes()
    except Exception as error:
        words = str(error) if isinstance(error, RefusedError) else f"{type(error).__name__} {error}"
        head, raw = {"refused": words[:WORDS]}, b""
    with os.fdopen(answer, "wb") as stream:
        stream.write(json.dumps(head).encode() + b"\n" + raw)


if __name__ == "__main__":
    main()
