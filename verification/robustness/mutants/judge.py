# SPDX-License-Identifier: MIT
"""Each mutant against the fast tests that run its code, the fastest first, until one fails.

The tests are collected once in this process, and each is run in a fork of it.
"""

import functools
import gc
import os
import pickle
import signal
import sys
import time
from collections import Counter, defaultdict
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from multiprocessing import Pipe
from multiprocessing.connection import Connection, wait
from types import FunctionType, ModuleType
from typing import Any

import numpy as np
import pytest
from _pytest.tmpdir import tmppath_result_key  # noqa: PLC2701 - what a report sets

from verification.robustness.mutants import inject
from verification.robustness.mutants.changes import Mutant
from verification.robustness.mutants.scope import NUMBERS, mutants_of

WORKERS = 2
SECONDS = 1.0
"""Of processor time, with what it sets up: a test is fast below it."""
ALONE, TOGETHER = 2 * SECONDS, 15.0
"""Processor seconds that a test may take while observed, and all that one mutant meets."""
ASKED = 5.0
"""Seconds that the tests asked about one mutant took together while they were observed, the fastest first."""
PARAMETERS = 100
KILLED, SURVIVED, STRUCTURE = "killed", "survived", "structure"


@dataclass(frozen=True)
class Seen:
    """A test by itself. called: (file, first line) of changed functions that ran; met: integers by floats."""

    passed: bool
    seconds: float
    called: frozenset[tuple[str, int]]
    met: frozenset[Mutant]


@dataclass(frozen=True)
class MutantVerdict:
    """outcome: see above; by: the test that failed; seconds: processor time; error: kind; asked: tests."""

    mutant: Mutant
    outcome: str
    by: str = ""
    seconds: float = 0.0
    error: str = ""
    asked: int = 0


def forked(tasks: Iterable[tuple[Any, Callable[[], Any]]], seconds: float) -> Iterator[tuple[Any, Any]]:
    """(name, answer) as tasks end, each in a fork; None: died, or took more than `seconds` (0: any)."""
    running: dict[Connection, tuple[Any, int]] = {}
    left, more = iter(tasks), True
    while more or running:
        while more and len(running) < WORKERS:
            if more := (task := next(left, None)) is not None:
                connection, child = _start(task[1], seconds)
                running[connection] = task[0], child
        for connection in wait(list(running)) if running else ():
            name, child = running.pop(connection)
            try:
                answer = connection.recv()
            except (EOFError, OSError):  # it died, perhaps while it wrote
                answer = None
            connection.close()
            os.waitpid(child, 0)
            yield name, answer


def _start(task: Callable[[], Any], seconds: float) -> tuple[Connection, int]:
    reading, writing = Pipe(duplex=False)
    if child := os.fork():
        writing.close()
        return reading, child
    try:
        reading.close()
        signal.signal(signal.SIGPROF, signal.SIG_DFL)
        signal.setitimer(signal.ITIMER_PROF, seconds)
        quiet = os.open(os.devnull, os.O_WRONLY)
        os.dup2(quiet, 1)
        os.dup2(quiet, 2)
        answer = pickle.dumps(task())
        signal.setitimer(signal.ITIMER_PROF, 0)
        writing.send_bytes(answer)
    finally:
        os._exit(0)
    raise AssertionError("not reached")


class Session:
    """Calls `work(items)` in place of running collected tests; items: node id -> test; failed: files."""

    def __init__(self, work: Callable[[dict[str, pytest.Item]], None]):
        self.work, self.failed = work, []

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        self.failed += [report.nodeid] if report.failed else []

    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        self.work(few(session.items))
        return True


def with_tests(files: Sequence[str], work: Callable[[dict[str, pytest.Item]], None]) -> list[str]:
    """Collect tests, call work(items); the files without. RuntimeError where pytest ends otherwise."""
    from hypothesis import Phase, settings

    # properties draw the same examples each time, and stop at the first that fails
    phases = (Phase.explicit, Phase.generate)
    settings.register_profile("mutants", derandomize=True, database=None, phases=phases)
    settings.load_profile("mutants")
    words = "-s -o addopts= -p no:cacheprovider -p no:terminal --continue-on-collection-errors".split()
    paths = (path for file in files for path in (inject.ROOT / "tests").rglob(file))
    found = {path for path in paths if path.parent.name != "system"}
    session = Session(work)
    code = pytest.main([*words, f"--rootdir={inject.ROOT}", *map(str, sorted(found))], plugins=[session])
    if code not in (pytest.ExitCode.OK, pytest.ExitCode.TESTS_FAILED):
        raise RuntimeError(f"the tests could not be collected: pytest ended with {code!r}")
    return session.failed


def run(item: pytest.Item, following: pytest.Item | None = None) -> tuple[bool, float, str]:
    """Run one test with what it sets up and, unless the following one shares it, takes down: whether it
    passed, processor seconds, kind of the error. Without pytest's reports: to show why a test failed takes it
    longer than most of the tests do.
    """
    state, error, start = item.session._setupstate, "", time.process_time()
    item.stash[tmppath_result_key] = {}  # without it tmp_path ends in an error
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
    return not error, time.process_time() - start, error


def few(items: Iterable[pytest.Item]) -> dict[str, pytest.Item]:
    """Node id -> test; of a test with more than PARAMETERS sets of them, that many, evenly drawn."""
    functions = defaultdict(list)
    for item in items:
        functions[item.nodeid.partition("[")[0]].append(item)
    drawn = (ones[:: -(-len(ones) // PARAMETERS)] for ones in functions.values())
    return {item.nodeid: item for ones in drawn for item in ones}


def uses(test: ModuleType, modules: Collection[str], tests: tuple[str, ...] = ()) -> bool:
    """Whether a module of tests, or a helper of it, imports one of the modules or a name of its package."""
    packages = {name.rpartition(".")[0] for name in modules if name.count(".") > 1}
    for value in list(vars(test).values()):
        owner = value.__name__ if isinstance(value, ModuleType) else getattr(value, "__module__", None)
        if owner in modules or (isinstance(owner, str) and owner.rpartition(".")[0] in packages):
            return True
        helper = sys.modules.get(owner) if isinstance(owner, str) and owner not in tests else None
        own = (getattr(helper, "__file__", None) or "").startswith(f"{inject.ROOT}/tests/")
        if own and uses(helper, modules, (*tests, test.__name__, owner)):
            return True
    return False


def prepare() -> None:
    """Before forks that change the program: what they look up, and memory that they need not copy."""
    for kind in (FunctionType, functools._lru_cache_wrapper):
        inject.living(kind)
    gc.freeze()


def observe(
    modules: Sequence[str], items: Mapping[str, pytest.Item], progress: Callable[[int, int], None]
) -> tuple[dict[str, Seen], frozenset[Mutant], list[str]]:
    """What each test runs and takes, without those that are slow or fail; the integers that meet a float when
    their module is loaded; the tests that fail by the fault of the rewriting. All modules are rewritten with
    every number as it is, and each test is run on its own, in a fork that remembers nothing.
    """
    prepare()
    files = frozenset(import_module(name).__file__ for name in modules)

    def alone(item: pytest.Item, numbers: Mapping) -> Seen:
        inject.forget()
        called: set = set()
        sys.settrace(lambda frame, event, argument: called.add(frame.f_code))
        try:
            passed, seconds, _ = run(item)
        finally:
            sys.settrace(None)
        own = {(code.co_filename, code.co_firstlineno) for code in called if code.co_filename in files}
        met = frozenset(mutant for mutant, number in numbers.items() if number.met)
        return Seen(passed, seconds, frozenset(own), met)

    def all_of_them():
        numbers: dict = {}
        for module in modules:
            if whole := [m for m in mutants_of(module) if m.kind in NUMBERS and m.kind != "row"]:
                numbers |= inject.put(whole, 1.0)
        loaded = frozenset(mutant for mutant, number in numbers.items() if number.met)
        for number in numbers.values():
            number.met = False
        answers = {}
        tasks = ((name, lambda item=item: alone(item, numbers)) for name, item in items.items())
        for done, (name, answer) in enumerate(forked(tasks, ALONE), start=1):
            progress(done, len(items))
            answers[name] = answer
        return answers, loaded

    ((_, (answers, loaded)),) = forked([("rewritten", all_of_them)], 0.0)
    failing = [name for name, answer in answers.items() if answer is not None and not answer.passed]
    plain = forked([(name, lambda name=name: run(items[name])[0]) for name in failing], ALONE)
    seen = {name: answer for name, answer in answers.items() if answer is not None and answer.passed}
    return seen, loaded, [name for name, passed in plain if passed]


def askable(mutant: Mutant, seen: Mapping[str, Seen], loaded: Collection[Mutant]) -> list[str]:
    """Tests in which the integer meets a float; those that run the function of any other mutant, or
    any of the module if it is outside of one, first those that run a function that names the constant. The
    fastest first.
    """
    file = import_module(mutant.module).__file__
    if mutant.integer and mutant not in loaded:
        chosen = [name for name, test in seen.items() if mutant in test.met]
    elif mutant.code:
        chosen = [name for name, test in seen.items() if (file, mutant.code) in test.called]
    else:
        chosen = [name for name, test in seen.items() if any(where == file for where, _ in test.called)]
    constant = "" if mutant.code else mutant.text.partition(" = ")[0]
    codes = (function.__code__ for function in inject.living(FunctionType))
    naming = {(code.co_filename, code.co_firstlineno) for code in codes if constant in code.co_names}
    chosen = sorted(chosen, key=lambda name: (not naming & seen[name].called, seen[name].seconds))
    return chosen[: int(np.searchsorted(np.cumsum([seen[name].seconds for name in chosen]), ASKED)) + 1]


def ask(mutant: Mutant, names: Sequence[str], items: Mapping[str, pytest.Item]) -> MutantVerdict:
    """In a fork: the mutant put in, then the tests. A test that fails but is not fast does not count."""
    try:
        inject.put([mutant])
    except Exception as error:
        return MutantVerdict(mutant, KILLED, "loading the module", 0.0, type(error).__name__)
    for k, name in enumerate(names):
        following = items[names[k + 1]] if k + 1 < len(names) else None
        passed, seconds, error = run(items[name], following)
        if not passed and seconds < SECONDS:
            return MutantVerdict(mutant, KILLED, name, seconds, error, k + 1)
    outcome = SURVIVED if names or not mutant.integer else STRUCTURE
    return MutantVerdict(mutant, outcome, asked=len(names))


def judge(
    mutants: Iterable[Mutant],
    items: Mapping[str, pytest.Item],
    observed: tuple[Mapping[str, Seen], frozenset[Mutant]],
    progress: Callable[[int, int], None],
) -> list[MutantVerdict]:
    """The judgements as they come; asked first are the tests that killed most in the same module."""
    prepare()
    mutants = list(mutants)
    kills: Counter[tuple[str, str]] = Counter()
    judged = []

    def tasks():
        for mutant in mutants:
            names = sorted(askable(mutant, *observed), key=lambda name: -kills[mutant.module, name])
            yield mutant, lambda mutant=mutant, names=names: ask(mutant, names, items)

    for done, (mutant, answer) in enumerate(forked(tasks(), TOGETHER), start=1):
        judged.append(answer or MutantVerdict(mutant, KILLED, "out of time", 0.0, "Timeout"))
        kills[mutant.module, judged[-1].by] += judged[-1].outcome == KILLED
        progress(done, len(mutants))
    return judged
