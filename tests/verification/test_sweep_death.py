# SPDX-License-Identifier: MIT
"""A worker of a Dask cluster that dies in the moment between its result and the status of its task."""

import asyncio
import importlib
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from types import SimpleNamespace

from optional_packages import dask_distributed

from samfem.executors import Cluster, Failure


def cascaded(status, result) -> BaseException:
    """What the executor of distributed makes of a task with this result, and this status when it is asked
    for after it.
    """
    dask_distributed()
    cascade = importlib.import_module("distributed.cfexecutor")._cascade_future

    async def asked(**_):
        return result

    async def answer():
        found = Future()
        await cascade(SimpleNamespace(status=status, _result=asked), found)
        return found.exception()

    return asyncio.run(answer())


def test_a_task_whose_worker_dies_just_after_its_result_is_no_failure():
    def raised(error):
        try:
            raise error
        except TypeError as found:
            return TypeError, found, found.__traceback__

    workers = SimpleNamespace(_killed=BrokenProcessPool)
    assert Cluster.died(workers, cascaded("lost", Failure("any value")))
    assert not Cluster.died(workers, cascaded("error", raised(TypeError("of the task"))))
