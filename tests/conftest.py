# SPDX-License-Identifier: MIT
"""What holds for every test: no store of the user, one thread of BLAS for each process, a process for each core.

No test reads or fills the store of the user: without SAMFEM_STORE there is none, and tests of the store name their own.
`make test` shares the tests among processes, so that each has one thread unless the user asks for another number.
"""

import os

THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")

os.environ["SAMFEM_STORE"] = ""
for name in (
    THREADS
):  # read by BLAS when numpy is loaded: before the first test, and by the processes that are started
    os.environ.setdefault(name, "1")


def pytest_xdist_auto_num_workers() -> int:
    """Processes for `pytest -n auto`: the cores that this process may use, which can be fewer than the machine has."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
