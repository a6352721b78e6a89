# SPDX-License-Identifier: MIT
"""A sweep on a Dask cluster that loses a worker on the way: its table is the process pool's, byte for byte."""

from __future__ import annotations

import os
import random
import tempfile
import time
from pathlib import Path

from verification.robustness.kills import children, finish, kill, run, start
from verification.suite.cases.case import Case, Context, Outcome, SmallTable, package_of
from verification.suite.cases.faults import STUDY, SWEPT
from verification.suite.gates import Measured

SEED = 418
RUNS = 10
WORKERS = 2


def run_case(context: Context) -> Outcome:
    """The study of the case `faults` on the pool, then on clusters of two workers, one of which is killed."""
    rng = random.Random(SEED)
    with tempfile.TemporaryDirectory(prefix="samfem-cluster-") as name:
        base = Path(name)
        for file, text in (("sphere.toml", SWEPT), ("study.toml", STUDY)):
            (base / file).write_text(text)
        ended = run([*_words(base, "pool"), "--workers", str(WORKERS)], base / "pool-store")
        if ended.code != 0:
            raise RuntimeError(f"the sweep on processes ended in {ended.code}: {ended.text[-300:]}")
        table = (base / "pool" / "sweep.csv").read_bytes()
        found = []
        for k in range(RUNS):
            found.append(swept(base, f"dask-{k}", ended.seconds * rng.random()))
            context.progress(f"{context.case}: sweeps on a cluster", k + 1, RUNS)
        equal = [content == table for content, _, _ in found]
    rows = [
        (str(k + 1), str(lost), f"{delay:.2f} s", "yes" if same else "no")
        for k, ((_, lost, delay), same) in enumerate(zip(found, equal, strict=True))
    ]
    values = {"unequal-tables": equal.count(False), "without-a-kill": sum(lost == 0 for _, lost, _ in found)}
    return Outcome(
        {f"{context.case}.{gate}": Measured(value, 0) for gate, value in values.items()},
        [("Cluster", f"{WORKERS} workers on this machine, kill -9 of one of them, seed {SEED}")],
        tables=[SmallTable("Sweeps", ("run", "workers killed", "after", "table equal to the pool's"), rows)],
    )


def swept(base: Path, name: str, delay: float) -> tuple[bytes, int, float]:
    """(sweep.csv, workers killed, delay) of a sweep on a cluster of its own, one worker of which dies after `delay`."""
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
    return (base / name / "sweep.csv").read_bytes(), len(victims), delay


def _is_worker(pid: int, client: int) -> bool:
    """Whether a process below this one is a worker of the cluster, and not of the client that sweeps on it."""
    try:
        words = Path(f"/proc/{pid}/cmdline").read_bytes()
    except OSError:
        return False
    return b"spawn_main" in words and pid not in children(client)


def _words(base: Path, name: str) -> list[str]:
    return ["sweep", str(base / "study.toml"), "--out", str(base / name)]


CASES = (
    Case(
        "cluster",
        "Sweep on a cluster",
        "Is the table of a sweep on a Dask cluster that loses a worker the one of the process pool?",
        run_case,
        levels=("full",),
        needs=package_of("dask", "distributed"),
    ),
)
