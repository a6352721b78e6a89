# SPDX-License-Identifier: MIT
"""What a solve costs: each in a process of its own, and in the unit of a fixed kernel."""

from __future__ import annotations

import multiprocessing
import time
from concurrent.futures import ProcessPoolExecutor
from importlib import import_module
from pkgutil import walk_packages

import numpy as np
from scipy import fft

from sam.scene import Result, Scene
from verification.runs import models
from verification.runs.threads import computing_with

LIBRARIES = tuple(
    f"scipy.{name}" for name in "fft interpolate ndimage optimize sparse.linalg special".split()
)
KERNEL_SIDE, KERNEL_REPEATS = 384, 24  # of the calibration: about 0.2 s on a processor of 2020


def solve_alone(scene: Scene, model: str, threads: int = 1) -> Result:
    """`models.solve` in a new process with loaded modules: its cost holds that process' processor time of the
    solve and peak memory, interpreter and libraries included (see `idle_bytes`).
    """
    return alone(_solve_loaded, scene, model, threads=threads)


def solve_forked(scene: Scene, model: str) -> Result:
    """`models.solve` in a fork of a process that has loaded every model and solved nothing: in less time than
    `solve_alone`, for times only, as its memory is not its own.
    """
    context = multiprocessing.get_context("forkserver")
    places = sorted(set(models.MODELS.values()))
    context.set_forkserver_preload([name for place in places for name in parts(place)])
    with computing_with(1), ProcessPoolExecutor(1, mp_context=context) as executor:
        return executor.submit(models.solve, scene, model).result()


def idle_bytes(model: str) -> int:
    """Peak memory of a process that has loaded `model` and the libraries, and solved nothing."""
    return alone(_loaded, model)


def alone(function, *arguments, threads: int = 1):
    """The value of a function of a module, called in a new process that computes with so many threads."""
    context = multiprocessing.get_context("spawn")
    with computing_with(threads), ProcessPoolExecutor(1, mp_context=context) as executor:
        return executor.submit(function, *arguments).result()


def parts(place: str) -> list[str]:
    """The modules of the package of a model, and the libraries that they import where they need them."""
    package = import_module(place.partition(".")[0])
    return [*(found.name for found in walk_packages(package.__path__, f"{package.__name__}.")), *LIBRARIES]


def load(model: str) -> None:
    """Import all that a model needs."""
    for name in parts(models.MODELS[model]):
        import_module(name)


def _solve_loaded(scene: Scene, model: str) -> Result:
    load(model)
    return models.solve(scene, model)


def _loaded(model: str) -> int:
    load(model)
    return models.peak_memory()


def calibration_s() -> float:
    """Processor seconds of a fixed kernel of transforms and products of matrices, median of three."""
    field = np.random.default_rng(0).standard_normal((KERNEL_SIDE, KERNEL_SIDE))

    def once() -> float:
        began, x = time.process_time(), field
        for _ in range(KERNEL_REPEATS):
            x = fft.irfft2(fft.rfft2(x) * 0.5, s=x.shape)
            x = x + 1e-3 * (x @ field)
            x /= np.abs(x).max()
        return time.process_time() - began

    return float(np.median([once() for _ in range(3)]))
