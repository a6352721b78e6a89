# SPDX-License-Identifier: MIT
"""Packages that tests can do without, on machines that cannot load them."""

from pathlib import Path
from types import ModuleType

import pytest


def dask_distributed() -> ModuleType:
    """The package; skips where it cannot be loaded."""
    if not Path("/proc/self").exists():
        pytest.skip("distributed reads /proc, which this machine has not")
    return pytest.importorskip("distributed")
