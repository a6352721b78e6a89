# SPDX-License-Identifier: MIT
"""What holds for every test: no store of the user, one thread of BLAS for each process, a process for each
core.

No test reads or fills the store of the user: without SAMFEM_STORE there is none, and tests of the store name
their own. `make test` shares the tests among processes, so that each has one thread unless the user asks for
another number.
"""

import os

THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")

os.environ["SAMFEM_STORE"] = ""
for name in THREADS:  # BLAS reads them when numpy is loaded, here and in the processes that are started
    os.environ.setdefault(name, "1")

from hypothesis import settings  # noqa: E402 - it loads numpy

# the same examples in every run, on a machine of any speed; nothing is written
settings.register_profile("fixed", derandomize=True, deadline=None)
settings.load_profile("fixed")


def pytest_xdist_auto_num_workers() -> int:
    """Processes for `pytest -n auto`: the cores that this process may use, which can be fewer than the
    machine has.
    """
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
