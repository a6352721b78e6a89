# SPDX-License-Identifier: MIT
"""A script, run in a process of its own: what a reader of files answers, as a line of JSON and raw arrays.

Arguments: the script of the reader, bytes of address space and seconds of processor time that it may take,
and its arguments; the content is on stdin.
"""

from __future__ import annotations

import json
import os
import runpy
import sys

import numpy as np

WORDS = 200  # characters of a library's words


def _limit(memory: int, seconds: int) -> None:
    """Limits of this process; where the system knows none, the parent's clock has to do."""
    try:
        import resource  # noqa: PLC0415 - not on every system
    except ImportError:
        return
    for kind, most in (
        (resource.RLIMIT_CPU, seconds),
        (resource.RLIMIT_AS, memory),
        (resource.RLIMIT_CORE, 0),
    ):
        hard = resource.getrlimit(kind)[1]
        resource.setrlimit(kind, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard))


def main() -> None:
    """Read, answer."""
    stream = os.dup(1)
    os.dup2(2, 1)  # what a library prints is no answer
    reader, memory, seconds, *arguments = sys.argv[1:]
    _limit(int(memory), max(int(float(seconds)), 1))
    content, raw = sys.stdin.buffer.read(), []
    try:
        said, arrays = runpy.run_path(reader)["answer"](content, *arguments)
        raw = [np.ascontiguousarray(array) for array in arrays.values()]
        described = {name: (each.dtype.str, each.shape) for name, each in zip(arrays, raw, strict=True)}
        head = {"said": said, "arrays": described}
    except Exception as error:  # readers of forty formats raise errors of as many kinds
        words = f"{type(error).__name__} {error}".removeprefix("RefusedError ")
        head = {"refused": words.strip()[:WORDS]}
    with os.fdopen(stream, "wb") as answer:
        answer.write(json.dumps(head).encode() + b"\n")
        for array in raw:
            answer.write(array.data)


if __name__ == "__main__":
    main()
