# SPDX-License-Identifier: MIT
"""The number of threads with which processes compute, set before they load numpy: standard library only."""

import os
from collections.abc import Iterator
from contextlib import contextmanager

THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS")
"""Environment variables that numpy's libraries read; what a result says of its threads."""
EVERY_LIBRARY = (*THREADS, "BLIS_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")


@contextmanager
def computing_with(threads: int) -> Iterator[None]:
    """Processes that are started in the block compute with so many threads; this one is left as it is."""
    before = {name: os.environ.get(name) for name in EVERY_LIBRARY}
    os.environ.update(dict.fromkeys(EVERY_LIBRARY, str(threads)))
    try:
        yield
    finally:
        for name, value in before.items():
            os.environ.pop(name) if value is None else os.environ.__setitem__(name, value)
