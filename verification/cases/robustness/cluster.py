# SPDX-License-Identifier: MIT
"""A sweep on a Dask cluster that loses a worker on the way: its table is the process pool's, byte for
byte.
"""

from __future__ import annotations

import os
import random
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from verification.cases.case import Case, Context, Measured, SmallTable, package_of
from verification.cases.robustness.faults import STUDY, SWEPT
from verification.robustness.kills import children, finish, kill, run, start

SEED = 418
RUNS = 10
WORKERS = 2


@dataclass(frozen=True)
class Swept:
    """A sweep on a cluster. table: its sweep.csv; lost: workers killed, after `delay` in s; same: as the
    pool's.
    """

    table: bytes
    lost: int
    delay: float
    same: bool = False


class ClusterSweep(Case):
    """The study of the case `faults` on the pool, then on clusters of two workers, one of which is killed."""

    def solve(self, context: Context) -> list[Swept]:
        rng, found = random.Random(SEED), []
        with tempfile.TemporaryDirectory(prefix="samfem-cluster-") as name:
            base = Path(name)
            for file, text in (("sphere.toml", SWEPT), ("study.toml", STUDY)):
                (base / file).write_text(text)
            ended = run([*_words(base, "pool"), "--workers", str(WORKERS)], base / "pool-store")
            if ended.code != 0:
                raise RuntimeError(f"the sweep on processes ended in {ended.code}: {ended.text[-300:]}")
            table = (base / "pool" / "sweep.csv").read_bytes()
            for k in range(RUNS):
                one = swept(base, f"dask-{k}", ended.seconds * rng.random())
                found.append(replace(one, same=one.table == table))
                context.progress(f"{self.name}: sweeps on a cluster", k + 1, RUNS)
        return found

    def measure(self, found: list[Swept]) -> dict[str, Measured]:
        return {
            "unequal-tables": Measured(sum(not each.same for each in found), 0),
            "without-a-kill": Measured(sum(each.lost == 0 for each in found), 0),
        }

    def setup(self, found: list[Swept]) -> list[tuple[str, str]]:
        return [("Cluster", f"{WORKERS} workers on this machine, kill -9 of one of them, seed {SEED}")]

    def tables(self, found: list[Swept]) -> Iterator[SmallTable]:
        yield SmallTable(
            "Sweeps",
            ("run", "workers killed", "after", "table equal to the pool's"),
            [
                (str(k), str(each.lost), f"{each.delay:.2f} s", "yes" if each.same else "no")
                for k, each in enumerate(found, start=1)
            ],
        )


def swept(base: Path, name: str, delay: float) -> Swept:
    """A sweep on a cluster of its own, one worker of which dies after `delay`."""
    import distributed

    with distributed.LocalCluster(
        n_workers=WORKERS,
        threads_per_worker=1,
        dashboard_address=None,
        local_directory=str(base / f"{name}-space"),
    ) as cluster:
        process = start(
            [*_words(base, name), "--scheduler", cluster.scheduler_address], base / f"{name}-store"
        )
        time.sleep(delay)
        alive = [pid for pid in children(os.getpid()) if _is_worker(pid, process.pid)]
        victims = alive[:1] if process.poll() is None else []
        kill(victims)
        ended = finish(process)
    if ended.code != 0:
        raise RuntimeError(f"{name} ended in {ended.code}: {ended.text[-300:]}")
    return Swept((base / name / "sweep.csv").read_bytes(), len(victims), delay)


def _is_worker(pid: int, client: int) -> bool:
    """Whether a process below this one is a worker of the cluster, and not of the client that sweeps on
    it.
    """
    try:
        words = Path(f"/proc/{pid}/cmdline").read_bytes()
    except OSError:
        return False
    return b"spawn_main" in words and pid not in children(client)


def _words(base: Path, name: str) -> list[str]:
    return ["sweep", str(base / "study.toml"), "--out", str(base / name)]


CASES = (ClusterSweep("cluster", needs=package_of("dask", "distributed")),)
