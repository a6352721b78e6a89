# SPDX-License-Identifier: MIT
"""The tests in this process: collected once, run one by one in forks, with what they execute and the time
they take.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import pytest

from verification.robustness.mutants.inject import ROOT

SECONDS = 1.0
"""Of processor time, with what it sets up: a test is fast below it."""


@dataclass(frozen=True)
class Seen:
    """A test on its own. called: (file, first line) of each function of the project that ran in it."""

    passed: bool
    seconds: float
    called: frozenset[tuple[str, int]]


@dataclass(frozen=True)
class TestVerdict:
    """Of one test: passed or not, how long, and the kind of error."""

    passed: bool
    seconds: float
    error: str = ""


class Session:
    """Calls `work(items)` in place of running the tests that pytest has collected; items: node id -> test."""

    def __init__(self, work: Callable[[dict[str, pytest.Item]], None]):
        self.work = work

    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        self.work({item.nodeid: item for item in session.items})
        return True


def with_tests(files: Sequence[str], work: Callable[[dict[str, pytest.Item]], None]) -> None:
    """Collect the tests of these files of tests/ and call work(items). RuntimeError where that fails."""
    _no_shrinking()
    words = ["-o", "addopts=", "-p", "no:cacheprovider", "-p", "no:terminal", f"--rootdir={ROOT}"]
    code = pytest.main(
        [*words, *(str(path) for file in files for path in (ROOT / "tests").rglob(file))],
        plugins=[Session(work)],
    )
    if code != 0:
        raise RuntimeError(f"the tests could not be collected: pytest ended with {code!r}")


def _no_shrinking() -> None:
    """Properties draw the same examples each time, and stop at the first that fails."""
    from hypothesis import Phase, settings

    settings.register_profile(
        "mutants", derandomize=True, database=None, phases=(Phase.explicit, Phase.generate)
    )
    settings.load_profile("mutants")


def run(item: pytest.Item, following: pytest.Item | None = None) -> TestVerdict:
    """Run one test with what it sets up and, unless the following one shares it, takes down.

    Without pytest's reports: to show why a test failed takes it longer than most of the tests do.
    """
    state, error, start = item.session._setupstate, "", time.process_time()
    item._initrequest()
    try:
        try:
            state.setup(item)
            item.runtest()
        finally:
            state.teardown_exact(following)
    except pytest.skip.Exception:
        pass
    except (Exception, pytest.fail.Exception) as failure:
        error = type(failure).__name__
    return TestVerdict(not error, time.process_time() - start, error)


def observed(item: pytest.Item, packages: tuple[str, ...]) -> Seen:
    """Run one test and note the functions of these folders that it calls."""
    called: set = set()

    def trace(frame, event, argument):
        called.add(frame.f_code)

    sys.settrace(trace)
    try:
        verdict = run(item)
    finally:
        sys.settrace(None)
    own = {
        (code.co_filename, code.co_firstlineno) for code in called if code.co_filename.startswith(packages)
    }
    return Seen(verdict.passed, verdict.seconds, frozenset(own))
