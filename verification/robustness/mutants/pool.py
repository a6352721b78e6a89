# SPDX-License-Identifier: MIT
"""Work in forks of this process, a few at a time: each changes its own copy of the program, and hands back
one object.
"""

from __future__ import annotations

import os
import pickle
import selectors
import signal
from collections.abc import Callable, Iterable, Iterator
from typing import Any

WORKERS = 2


def forked(tasks: Iterable[tuple[Any, Callable[[], Any]]], seconds: float) -> Iterator[tuple[Any, Any]]:
    """(name, what the task returned) as they end; None for one that died or took more than `seconds` of
    processor time.
    """
    running: dict[int, tuple[Any, int, bytearray]] = {}
    selector, left = selectors.DefaultSelector(), iter(tasks)
    more = True
    while more or running:
        while more and len(running) < WORKERS:
            task = next(left, None)
            if task is None:
                more = False
                break
            reading, child = _start(task[1], seconds)
            running[reading] = (task[0], child, bytearray())
            selector.register(reading, selectors.EVENT_READ)
        for key, _ in selector.select() if running else ():
            name, child, held = running[key.fd]
            if part := os.read(key.fd, 1 << 16):
                held += part
                continue
            selector.unregister(key.fd)
            os.close(key.fd)
            os.waitpid(child, 0)
            del running[key.fd]
            yield name, pickle.loads(bytes(held)) if held else None


def _start(task: Callable[[], Any], seconds: float) -> tuple[int, int]:
    reading, writing = os.pipe()
    child = os.fork()
    if child:
        os.close(writing)
        return reading, child
    try:
        os.close(reading)
        signal.signal(signal.SIGPROF, signal.SIG_DFL)
        signal.setitimer(signal.ITIMER_PROF, seconds)
        quiet = os.open(os.devnull, os.O_WRONLY)
        os.dup2(quiet, 1)
        os.dup2(quiet, 2)
        answer = pickle.dumps(task())
        signal.setitimer(signal.ITIMER_PROF, 0)
        with os.fdopen(writing, "wb") as pipe:
            pipe.write(answer)
    finally:
        os._exit(0)
    raise AssertionError("not reached")
