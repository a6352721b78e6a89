# SPDX-License-Identifier: MIT
"""What workers run in the tests of sweeps. Light: a new process imports this file and little else."""

import os
import signal
from pathlib import Path

MARKER = "SAMFEM_TEST_MARKER"
"""Environment variable: a file that says that the worker was killed already."""
SPECIAL = 0.3
"""The force in N of the scene that is not like the others."""


def double(value: float) -> float:
    return 2.0 * value


def environment() -> dict[str, str]:
    return dict(os.environ)


def die(_value: float = 0.0) -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def solve_but_die_once(scene, model, code, *how):
    """The worker of the special scene is killed, the first time; the marker is MARKER."""
    from samfem.sweeping import solve_scene

    marker = Path(os.environ[MARKER])
    if scene.loading.force == SPECIAL and not marker.exists():
        marker.touch()
        die()
    return solve_scene(scene, model, code, *how)


def solve_but_die(scene, model, code, *how):
    from samfem.sweeping import solve_scene

    return die() if scene.loading.force == SPECIAL else solve_scene(scene, model, code, *how)


def solved(asked):
    """The results of pairs (scene, model)."""
    from verification.runs import models

    return [models.solve(scene, model) for scene, model in asked]
