# SPDX-License-Identifier: MIT
"""Each mutant against the fast tests that run its code, the fastest first, until one fails."""

from __future__ import annotations

import functools
import gc
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib import import_module
from types import FunctionType

import numpy as np
import pytest

from verification.robustness.mutants import inject
from verification.robustness.mutants.fasttests import SECONDS, Seen, TestVerdict, observed, run
from verification.robustness.mutants.numbers import FACTOR, Mutant, find, rows
from verification.robustness.mutants.pool import forked
from verification.robustness.mutants.scope import TABLES

ALONE, TOGETHER = 2 * SECONDS, 60.0
"""Seconds of processor time that a test may take while observed, which takes longer, and all that one mutant
meets."""
ASKED = 5.0
"""Seconds that the tests asked about one mutant took together while they were observed, the fastest first."""
CHUNK = 20
PACKAGES = ("sam", "fem_reference", "verification/uncertainty")
"""Folders of what is perturbed."""
KILLED, SURVIVED, STRUCTURE = "killed", "survived", "structure"


@dataclass(frozen=True)
class MutantVerdict:
    """outcome: one of those above; by: the test that failed; seconds: its processor time; error: its kind;
    asked: tests run.
    """

    mutant: Mutant
    outcome: str
    by: str = ""
    seconds: float = 0.0
    error: str = ""
    asked: int = 0


def mutants_of(module: str) -> list[Mutant]:
    """All mutants of a module, and of the table that it reads."""
    found = find(module, inject.source_of(module))
    for owner, function in TABLES:
        if owner == module:
            read = getattr(import_module(module), function).__wrapped__
            found += [
                replace(row, code=read.__code__.co_firstlineno) for row in rows(module, function, read())
            ]
    return found


def prepare() -> None:
    """Before forks that perturb: what they look up, and memory that they need not copy."""
    for kind in (FunctionType, functools._lru_cache_wrapper):
        inject.living(kind)
    gc.freeze()


def observe(items: Mapping[str, pytest.Item], progress: Callable[[int, int], None]) -> dict[str, Seen]:
    """What each test runs and takes, on its own in a fork that remembers nothing; without those that are slow
    or fail.
    """
    prepare()
    packages = tuple(f"{inject.ROOT / name}/" for name in PACKAGES)

    def alone(item: pytest.Item) -> Seen:
        inject.forget()
        return observed(item, packages)

    tasks = ((name, lambda item=item: alone(item)) for name, item in items.items())
    seen = {}
    for done, (name, answer) in enumerate(forked(tasks, ALONE), start=1):
        progress(done, len(items))
        if answer is not None and answer.passed:
            seen[name] = answer
    return seen


def askable(mutant: Mutant, seen: Mapping[str, Seen]) -> list[str]:
    """Tests that run the function of the mutant, any of the module's if it is outside of one; the fastest
    first.
    """
    file = import_module(mutant.module).__file__
    if mutant.code:
        chosen = [name for name, test in seen.items() if (file, mutant.code) in test.called]
    else:
        chosen = [name for name, test in seen.items() if any(where == file for where, _ in test.called)]
    chosen = sorted(chosen, key=lambda name: seen[name].seconds)
    return chosen[: int(np.searchsorted(np.cumsum([seen[name].seconds for name in chosen]), ASKED)) + 1]


def ask(
    mutants: list[Mutant], factor: float, names: Sequence[str], items: Mapping[str, pytest.Item]
) -> MutantVerdict:
    """In a fork: the mutant put in, then the tests. A test that fails but is not fast does not count."""
    try:
        numbers = inject.put(mutants, factor)
    except Exception as error:
        return MutantVerdict(mutants[0], KILLED, "loading the module", 0.0, type(error).__name__)
    for k, name in enumerate(names):
        following = items[names[k + 1]] if k + 1 < len(names) else None
        verdict: TestVerdict = run(items[name], following)
        if not verdict.passed and verdict.seconds < SECONDS:
            return MutantVerdict(mutants[0], KILLED, name, verdict.seconds, verdict.error, k + 1)
    met = not numbers or any(number.met for number in numbers.values())
    return MutantVerdict(mutants[0], SURVIVED if met or not names else STRUCTURE, asked=len(names))


def judge(
    mutants: Iterable[Mutant],
    items: Mapping[str, pytest.Item],
    seen: Mapping[str, Seen],
    progress: Callable[[int, int], None],
) -> list[MutantVerdict]:
    """The judgements as they come; asked first are the tests that killed most in the same module."""
    prepare()
    mutants = list(mutants)
    kills: Counter[tuple[str, str]] = Counter()

    def tasks():
        for mutant in mutants:
            names = sorted(askable(mutant, seen), key=lambda name: -kills[mutant.module, name])
            yield mutant, lambda mutant=mutant, names=names: ask([mutant], FACTOR, names, items)

    judged = []
    for done, (mutant, answer) in enumerate(forked(tasks(), TOGETHER), start=1):
        judged.append(answer or MutantVerdict(mutant, KILLED, "out of time", 0.0, "Timeout"))
        kills[mutant.module, judged[-1].by] += judged[-1].outcome == KILLED
        progress(done, len(mutants))
    return judged


def control(modules: Iterable[str], items: Mapping[str, pytest.Item], seen: Mapping[str, Seen]) -> list[str]:
    """All modules rewritten with every number as it is: the tests that fail then, by the fault of the
    rewriting.
    """

    def failing(names: Sequence[str]) -> list[str]:
        for module in modules:
            if mutants := [mutant for mutant in mutants_of(module) if mutant.kind != "row"]:
                inject.put(mutants, 1.0)
        return [name for name in names if not run(items[name]).passed]

    prepare()
    names = list(seen)
    chunks = [names[k : k + CHUNK] for k in range(0, len(names), CHUNK)]
    answers = forked([(chunk, lambda chunk=chunk: failing(chunk)) for chunk in chunks], CHUNK * ALONE)
    return [name for chunk, failed in answers for name in (chunk if failed is None else failed)]
