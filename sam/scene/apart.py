# SPDX-License-Identifier: MIT
"""Files of other programs, read in a process of their own with limits on time and memory.

Whatever the bytes are and whatever a library makes of them, the answer is arrays or a refusal.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sam.scene.errors import printable
from sam.scene.inputs import InputError

SECONDS = 120.0  # by the clock, for a start of 2 s on a busy machine and the largest file
CHILD = Path(__file__).with_name("apart_child.py")


def read_apart(
    reader: Path, *arguments: str, content: bytes = b"", memory: int
) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    """What a reader makes of a file.

    Parameters
    ----------
    reader
        A script that defines `answer(content, *arguments)`, which returns what JSON holds and arrays by name;
        its process imports nothing of this package.
    arguments
        Passed on.
    content
        Passed on, by stdin.
    memory
        Bytes of address space that its process may take.

    Returns
    -------
    tuple
        What `answer` returned.

    Raises
    ------
    InputError
        If it raised, did not end in time, ended without an answer or answered nonsense.
    """
    command = [sys.executable, "-P", str(CHILD), str(reader), str(memory), str(SECONDS / 2), *arguments]
    # the library of instruments loads matplotlib, which else makes a folder in that of the user
    alone = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MPLCONFIGDIR": os.devnull}
    how: dict[str, Any] = {
        "stdout": subprocess.PIPE,
        "stderr": subprocess.DEVNULL,
        "env": {**os.environ, **alone},
    }
    try:
        said = subprocess.run(command, input=content, timeout=SECONDS, check=False, **how).stdout
        head = json.loads(said[: said.index(b"\n")])
    except subprocess.TimeoutExpired:
        raise InputError(f"its reader did not end in {SECONDS:g} s") from None
    except (OSError, ValueError):
        raise InputError("its reader ended without an answer") from None
    try:
        if "refused" in head:
            raise InputError(printable(str(head["refused"])))
        return head["said"], _arrays(head["arrays"], memoryview(said)[said.index(b"\n") + 1 :])
    except (KeyError, OverflowError, TypeError, ValueError) as error:
        raise error if isinstance(error, InputError) else InputError("its reader answered nonsense") from None


def _arrays(described: dict[str, tuple[str, list[int]]], raw: memoryview) -> dict[str, NDArray[Any]]:
    """The arrays one after the other, as type and shape describe them. Raises TypeError or ValueError."""
    arrays, start = {}, 0
    for name, (kind, shape) in described.items():
        if np.dtype(kind).kind not in "fiu":
            raise TypeError(kind)
        arrays[name] = np.ndarray(shape, kind, raw, start)
        start += arrays[name].nbytes
    return arrays
