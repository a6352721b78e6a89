# SPDX-License-Identifier: MIT
"""Where scenes are solved: processes on this machine, or an existing Dask cluster; both are
concurrent.futures.Executor.

`run` sends tasks to either and repeats a task whose worker died. Nothing here or in a worker is loaded before
it is needed: a worker must set its threads before numpy counts the cores.
"""

from __future__ import annotations

import logging
import multiprocessing
import os
import signal
import sys
import threading
from collections import Counter, deque
from collections.abc import Callable, Hashable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, CancelledError, Executor, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from dataclasses import dataclass
from importlib import import_module
from multiprocessing.connection import Connection
from typing import Any, Self, TypeVar

from verification.runs.threads import computing_with

MOST_DEATHS = 3
POLL_S = 1.0
CONNECT_S = 10.0
GONE = "the scheduler is gone: start the sweep again, what is finished is kept"
Key = TypeVar("Key", bound=Hashable)
WORKER_DIED = "its worker died at every attempt: killed, or out of memory"


@dataclass(frozen=True)
class Failure:
    """A task without a value, and why."""

    reason: str


def run(
    workers: Processes | Cluster, function: Callable[..., Any], tasks: Mapping[Key, tuple[Any, ...]]
) -> Iterator[tuple[Key, Any, int]]:
    """(key, value or Failure, repeats so far) of each task function(*arguments), as they finish.

    A task that raises is a Failure, one whose worker died is repeated. Raises ConnectionError if the cluster
    is gone.
    """
    waiting, suspects, deaths, repeats = deque(tasks), deque[Key](), Counter[Key](), 0
    running: dict[Future[Any], Key] = {}
    while waiting or suspects or running:
        room = workers.slots() - len(running)
        if suspects:
            room, chosen = int(not running), suspects
        else:
            chosen = waiting
        for key in [chosen.popleft() for _ in range(min(max(room, 0), len(chosen)))]:
            running[workers.executor.submit(function, *tasks[key])] = key
        for future in wait(running, timeout=POLL_S, return_when=FIRST_COMPLETED).done:
            key = running.pop(future)
            if future.cancelled() or isinstance(error := future.exception(), CancelledError):
                raise ConnectionError(GONE)
            if error is None:
                yield key, future.result(), repeats
            elif not workers.died(error):
                yield key, Failure(f"{type(error).__name__}: {error}"), repeats
            else:
                deaths[key] += 1
                if deaths[key] == workers.most_deaths:
                    yield key, Failure(WORKER_DIED), repeats
                else:
                    repeats += 1
                    (suspects if workers.alone else waiting).appendleft(key)


class Processes(Executor):
    """Processes, each a pool of its own: one that is killed takes only its own task along, and is replaced.

    A worker has one thread, and ends at once when this process is gone or the block is left by an exception.
    fresh: each task gets a new process, so that none finds what another left there. alone: whether a death
    tells only that one of several tasks is to blame, so that the next attempt has to be alone; most_deaths:
    attempts of one task that may end by it.
    """

    alone, most_deaths = False, MOST_DEATHS

    def __init__(self, count: int, *, fresh: bool = False):
        self._replaced, self._count, self._fresh = 0, count, fresh
        # fork would copy locks held by threads of this process
        self._context = multiprocessing.get_context("spawn")
        self._reader, self._writer = self._context.Pipe(duplex=False)  # its end is the sign to the workers
        self._lanes: list[tuple[ProcessPoolExecutor, Future[Any] | None]] = []

    @property
    def executor(self) -> Executor:
        return self

    @property
    def lost(self) -> int:
        """Workers that died."""
        return self._replaced + len(self._broken())

    def slots(self) -> int:
        """Tasks to keep in it."""
        return self._count

    def died(self, error: BaseException | None) -> bool:
        return isinstance(error, BrokenProcessPool)

    def submit(self, function: Callable[..., Any], /, *arguments: Any, **keywords: Any) -> Future[Any]:
        """As Executor.submit. Raises BrokenProcessPool if new processes die before they take a task."""
        for k in self._broken():
            self._renew(k)
        idle = [k for k, (_, last) in enumerate(self._lanes) if last is None or last.done()]
        if not idle and len(self._lanes) < self._count:
            self._lanes.append((self._new(), None))
            idle = [len(self._lanes) - 1]
        k = idle[0] if idle else 0  # with every process busy the task waits for the first
        if self._fresh and self._lanes[k][1] is not None:
            self._lanes[k][0].shutdown()
            self._lanes[k] = (self._new(), None)
        for attempts_left in reversed(range(MOST_DEATHS)):
            try:
                with computing_with(1):
                    future = self._lanes[k][0].submit(function, *arguments, **keywords)
                _leave_writing_to_the_worker(self._lanes[k][0])
                break
            except BrokenProcessPool:  # killed while it had nothing to do
                self._renew(k)
                if not attempts_left:
                    raise
        self._lanes[k] = (self._lanes[k][0], future)
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """As Executor.shutdown; without wait the processes end at once."""
        if not wait:
            self._writer.close()
        for pool, _ in self._lanes:
            pool.shutdown(wait=True, cancel_futures=cancel_futures or not wait)
        self._writer.close()
        self._reader.close()

    def __exit__(self, kind: object, *_: object) -> None:
        self.shutdown(wait=kind is None)

    def _new(self) -> ProcessPoolExecutor:
        return ProcessPoolExecutor(1, self._context, initializer=_start, initargs=(self._reader,))

    def _renew(self, k: int) -> None:
        self._replaced += 1
        self._lanes[k][0].shutdown(wait=False)
        self._lanes[k] = (self._new(), None)

    def _broken(self) -> list[int]:
        """Lanes whose process died with its task."""
        ended = [(k, last) for k, (_, last) in enumerate(self._lanes) if last is not None and last.done()]
        return [k for k, last in ended if not last.cancelled() and self.died(last.exception())]


def _leave_writing_to_the_worker(pool: ProcessPoolExecutor) -> None:
    """Close the writing end of the results that this process holds, once the only worker has its own.

    The pipe then ends with a worker that is killed while it writes; with this end open, the pool would wait
    for the rest of the result for ever.
    """
    results: Any = pool._result_queue  # noqa: SLF001 - the pool has no public way to its pipe
    results._writer.close()  # noqa: SLF001


def _start(parent: Connection) -> None:
    """First in a worker: the terminal's interrupt is for the parent; when that is gone, so is the worker."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with, args=(parent,), daemon=True).start()


def _end_with(parent: Connection) -> None:
    try:
        parent.recv_bytes()
    except (EOFError, OSError):
        os._exit(1)


class Cluster:
    """A Dask cluster that is running already. The scheduler itself repeats tasks of dead workers, a few
    times.
    """

    # the first death may be a neighbour's fault, the one after it, alone, is its own
    alone, most_deaths = True, 2

    def __init__(self, address: str):
        """Raises OSError if there is no scheduler with workers at the address, ImportError if distributed
        cannot be loaded.
        """
        try:
            distributed: Any = import_module("distributed")
        except ImportError:
            raise
        except Exception as error:  # its psutil needs /proc
            raise ImportError(f"{type(error).__name__}: {error}") from None
        for name in ("distributed", "distributed.client"):  # what matters is said by us
            logging.getLogger(name).setLevel(logging.CRITICAL)
        try:
            self._client = distributed.Client(address, timeout=CONNECT_S, set_as_default=False)
        except (ValueError, TypeError) as error:  # no address at all
            raise OSError(str(error)) from None
        try:
            self._client.wait_for_workers(1, timeout=CONNECT_S)
        except Exception as error:
            self._client.close()
            raise OSError(f"no workers there after {CONNECT_S:g} s") from error
        self.executor: Executor = self._client.get_executor(pure=False)
        self.lost, self._killed, self._told = 0, distributed.KilledWorker, False
        self._workers: set[str] = set()

    def slots(self) -> int:
        """Two tasks for each thread of the cluster as it is now, so that no worker waits."""
        try:
            workers = self._client.nthreads()
        except OSError:
            raise ConnectionError(GONE) from None
        self.lost += len(self._workers - set(workers))
        self._workers = set(workers)
        if not workers and not self._told:
            words = "samfem: sweep: the cluster has no workers now: waiting for some"
            print(words, file=sys.stderr, flush=True)
        self._told = not workers
        return 2 * sum(workers.values()) or 1

    def died(self, error: BaseException) -> bool:
        return isinstance(error, self._killed) or _died_with_its_result(error)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        if kind is None:
            with suppress(ConnectionError):
                self.slots()  # counts those lost since the last task was handed out
        self.executor.shutdown(wait=kind is None)
        self._client.close()


def _died_with_its_result(error: BaseException) -> bool:
    """Whether the worker of a task died just after its result was here: the executor of distributed asks for
    the result and then for the status, which is no longer `finished`, and takes the result apart as an error.
    """
    trace = error.__traceback__
    return (
        isinstance(error, TypeError)
        and trace is not None
        and trace.tb_next is None
        and trace.tb_frame.f_code.co_name == "_cascade_future"
    )
