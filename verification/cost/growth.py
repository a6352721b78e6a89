# SPDX-License-Identifier: MIT
"""Ladders of one kind of scene each, from small to large: what a solve takes, beside what `samfem plan` says
it will take.

`python -m verification.cost.growth` solves them all and prints what the constants of
`verification.cost.estimates` should be.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from typing import Any

import numpy as np
from scipy import fft

from sam.scene import CounterSurface, Progress, Scene, Solver, read_scene
from verification.cost import estimates
from verification.cost.measured import alone, idle_bytes, solve_alone
from verification.runs import models
from verification.scenes import with_keys

POISSON, SHEAR = 0.3, 80e9  # of the box that is applied by itself
CELL = 1e-6  # its cells, cubes, in m
PLANE = {"kind": "self-affine", "sq": 10e-9, "cutoff_long": 32e-6, "cutoff_short": 12e-6, "hurst": 0.8}
PLANE |= {"seed": 1, "renew": True}  # a rough counter-body, new in each cycle
SHORT_S, REPEATS = 2.0, 3  # a solve shorter than that is repeated, and the median taken


@dataclass(frozen=True)
class Rung:
    """A scene of a ladder. size: what grows: cells, cycles, or (None) the unknowns that the result names."""

    family: str
    label: str
    model: str
    scene: Scene
    size: float | None = None


def scene_of(name: str) -> Scene:
    """The scene of `verification/scenes/<name>.toml`."""
    with resources.as_file(resources.files("verification").joinpath("scenes", f"{name}.toml")) as path:
        return read_scene(path)[0]


def measured_at(rung: Rung, idle: int) -> dict[str, Any]:
    """What the solve of a rung took, each time in a process of its own, and what the plan of the scene says:
    bytes above a process that has solved nothing (idle), median seconds.
    """
    results = [solve_alone(rung.scene, rung.model)]
    while results[0].cost["cpu_s"] < SHORT_S and len(results) < REPEATS:
        results.append(solve_alone(rung.scene, rung.model))
    said = estimates.estimate(rung.scene, rung.model)
    return {
        "model": rung.model,
        "family": rung.family,
        "scene": rung.label,
        "size": float(rung.size or results[0].discretisation["dofs"]),
        "cpu-s": float(np.median([result.cost["cpu_s"] for result in results])),
        "predicted-s": said.time_s,
        "memory": max(result.cost["peak_memory_bytes"] for result in results) - idle,
        "predicted-memory": said.memory_bytes - round(estimates.IDLE_BYTES),
        "converged": all(result.converged for result in results),
    }


def climb(rungs: Sequence[Rung], report: Progress = lambda *_: None) -> list[dict[str, Any]]:
    """`measured_at` for each rung."""
    idle = {model: idle_bytes(model) for model in dict.fromkeys(rung.model for rung in rungs)}
    taken = []
    for k, rung in enumerate(rungs, start=1):
        taken.append(measured_at(rung, idle[rung.model]))
        report(f"{rung.family}, {rung.label}", k, len(rungs))
    return taken


def applied(nx: int, ny: int, layers: int, error: float = 0.0) -> dict[str, Any]:
    """The residual-stress operator of a box of cells, in a process of its own: processor seconds of one
    application, alone and over those of as many transforms, and of the set-up; bytes of its coefficients and
    of all; error: of sweeps, 0: it is dense.
    """
    setup, times, stored, peak = alone(_applied, nx, ny, layers, error)
    apply_s, transform_s = np.array(times).T
    size = {"cells": nx * ny * layers, "plane": nx * ny, "depth": layers}
    cost = {"cpu-s": float(np.median(apply_s)), "over-transforms": float(np.median(apply_s / transform_s))}
    cost |= {"set-up-s": setup, "stored": stored, "memory": peak - idle_bytes(models.SAM)}
    return {"model": models.SAM, "scene": f"{nx} × {ny} × {layers}"} | size | cost


def _applied(
    nx: int, ny: int, layers: int, error: float
) -> tuple[float, list[tuple[float, float]], int, int]:
    from sam.contact import Counters
    from sam.kernels import Cuboids, Lags
    from sam.plasticity import BoxOperator

    began = time.process_time()
    box = Cuboids(Lags(nx, ny, CELL, CELL), tuple(CELL * np.arange(layers + 1.0)), POISSON)
    operator = BoxOperator(box, SHEAR, Counters(), tolerance=1e-3, swept=error)
    setup = time.process_time() - began
    strain = np.random.default_rng(0).standard_normal((6, layers, nx, ny))
    single, padded = strain.astype(np.float32), (2 * nx, 2 * ny)
    operator.stress(None, operator.response(operator.transformed(strain)))  # makes plans of the transforms
    peak = models.peak_memory()

    def once() -> tuple[float, float]:
        """Seconds of an application, and of transforms of all layers there and back, a moment later."""
        began = time.process_time()
        operator.stress(None, operator.response(operator.transformed(strain)))
        ended = time.process_time()
        fft.irfft2(fft.rfft2(single, s=padded), s=padded)
        return ended - began, time.process_time() - ended

    times: list[tuple[float, float]] = []
    while len(times) < 5 or (sum(map(sum, times)) < 1.0 and len(times) < 50):
        times.append(once())
    return setup, times, operator.memory, peak


# The ladders


def _patch(scene: Scene, cells: int) -> Scene:
    """The rough scene on n x n of its cells, under the same mean pressure."""
    share = (cells / scene.grid.cells[0]) ** 2
    side = cells / scene.grid.cells[0] * scene.grid.extent[0]
    scene = with_keys(scene, "grid", cells=(cells, cells), extent=(side, side))
    scene = with_keys(scene, "loading", force=share * scene.loading.force)
    return scene.model_copy(update={"solver": Solver(tolerance=1e-3)})


def square(
    family: str, sizes: Iterable[int], name: str, *, bare: bool = False, grid: Mapping = {}, **loading
) -> list[Rung]:
    """A scene of SAM on n x n cells; bare: without its film; grid, loading: keys of them."""
    scene = with_keys(scene_of(name), "loading", **loading)
    if bare:
        scene = with_keys(scene, "body", coating=None)
    scenes = {n: with_keys(scene, "grid", cells=(n, n), **grid) for n in sizes}
    return [Rung(family, f"{n} x {n} cells", models.SAM, each, n**2) for n, each in scenes.items()]


def running_in(sizes: Iterable[int]) -> list[Rung]:
    """A cycle on a rough patch, with film and wear, in cells of 1 um."""
    scene = with_keys(scene_of("running-in-bulk"), "loading", steps=3, unload_steps=3, cycles=1)
    return [Rung("running-in", f"{n} x {n} cells", models.SAM, _patch(scene, n), n**2) for n in sizes]


def cycles(counts: Iterable[int], *, family: str = "cycles", renewed: bool = False) -> list[Rung]:
    """The same patch, small, over more and more cycles; renewed: against a rough plane, other in each."""
    scene = _patch(with_keys(scene_of("running-in-bulk"), "loading", steps=3, unload_steps=3), 32)
    if renewed:
        scene = with_keys(scene, "counterbody", surface=CounterSurface(**PLANE))
    cycled = {n: with_keys(scene, "loading", cycles=n) for n in counts}
    return [Rung(family, f"{n} cycle{'s' * (n > 1)}", models.SAM, each, n) for n, each in cycled.items()]


def elements(
    family: str, model: str, sizes: Iterable[int], name: str = "hertz-sphere", *, steps: int = 1
) -> list[Rung]:
    """The rigid sphere with more and more elements in the contact radius; unknowns are counted."""
    scene = with_keys(scene_of(name), "loading", steps=steps, unload=False)
    meshed = {n: with_keys(scene, "fem", cells_per_radius=n) for n in sizes}
    return [Rung(family, f"{n} elements in a", model, each) for n, each in meshed.items()]


ONE_STEP = {"steps": 1, "unload": False}
LOADED = {"steps": 5, "unload": False}
CONTACTS, PLASTIC = (65, 129, 257, 513, 1025, 2049), f"{models.FEM}, plastic"
YIELDING = "plastic-swift-rigid"
"""Swift steel at four times the load of first yield's pressure."""
FAMILIES: Mapping[str, Callable[[], list[Rung]]] = {
    "contact": lambda: square(
        "elastic contact", CONTACTS, "hertz-sphere", grid={"depths": (0.0,)}, **ONE_STEP
    ),
    "stresses": lambda: square("elastic, all depths", (65, 129, 257, 513), "hertz-sphere", **ONE_STEP),
    "cycles": lambda: cycles((1, 2, 4, 8, 16)),
    "cycles, renewed": lambda: cycles((1, 2, 4, 8), family="cycles, renewed", renewed=True),
    "axisymmetric": lambda: elements(models.FEM, models.FEM, (4, 8, 16, 32, 64)),
    "spatial": lambda: elements(models.FEM_3D, models.FEM_3D, (3, 4, 5, 6, 8)),
    "rough": lambda: square("rough", (64, 128, 256), "rough-patch", bare=True),
    "coated": lambda: square("coated", (65, 129, 257), "coated-sphere", **ONE_STEP),
    "rough, coated": lambda: square("rough, coated", (64, 128), "rough-patch"),
    "plastic": lambda: square("plastic", (33, 45, 63, 89), YIELDING, **LOADED),
    "running-in": lambda: running_in((32, 48, 64)),
    "axisymmetric, plastic": lambda: elements(PLASTIC, models.FEM, (8, 16, 32), YIELDING, steps=5),
    "axisymmetric, steps": lambda: elements(f"{models.FEM}, 4 steps", models.FEM, (32, 64), steps=4),
}
"""The ladders of the case `growth`, all of which are predicted, and the factors fitted to them."""
STORED = ("boxes",)  # counts of what is stored, and nothing beside it: their factor is 1
# bytes over an idle process, and seconds, from which a prediction counts
MEMORY_MATTERS, TIME_MATTERS = 100e6, 0.5


# The factors of `verification.cost.estimates`


def fitted(
    counts: Sequence[Mapping[str, float]],
    measured: Sequence[float],
    matters: float,
    known: Mapping[str, float],
) -> dict[str, float]:
    """Factors >= 0 of the counts by least squares of the errors, each over what was measured or, if that is
    smaller, over `matters`; known: factors that are not sought.
    """
    from scipy.optimize import nnls

    names = [name for name in dict.fromkeys(name for each in counts for name in each) if name not in known]
    weight = 1.0 / np.maximum(np.asarray(measured, dtype=float), matters)
    rest = measured - np.array([sum(known[n] * each.get(n, 0.0) for n in known) for each in counts])
    rows = weight[:, None] * np.array([[each.get(name, 0.0) for name in names] for each in counts])
    scale = rows.max(axis=0)
    found = nnls(rows / scale, weight * rest)[0] / scale
    return dict(zip(names, found.tolist(), strict=True)) | dict(known)


def factors(
    rungs: Sequence[Rung], taken: Sequence[Mapping[str, Any]]
) -> tuple[dict[str, dict[str, float]], dict[str, dict[str, float]]]:
    """(MEMORY, TIME) that suit what was measured."""
    memory, seconds = {}, {}
    for model in dict.fromkeys(rung.model for rung in rungs):
        counts = [estimates.counted(rung.scene, model) for rung in rungs if rung.model == model]
        own = [row for row in taken if row["model"] == model]
        known = {name: 1.0 for name in STORED if any(name in count.bytes for count in counts)}
        bytes_, taken_s = [row["memory"] for row in own], [row["cpu-s"] for row in own]
        memory[model] = fitted([count.bytes for count in counts], bytes_, MEMORY_MATTERS, known)
        seconds[model] = fitted([count.work for count in counts], taken_s, TIME_MATTERS, {})
    return memory, seconds


def main(arguments: Sequence[str]) -> None:
    """Solve the ladders (all, or those that are named) and print the factors."""
    rungs = [rung for name in arguments or FAMILIES for rung in FAMILIES[name]()]
    taken = climb(rungs, lambda stage, k, n: print(f"{k} of {n}: {stage}", flush=True))
    for row in taken:
        print(
            f"{row['family']:24} {row['scene']:20} {row['cpu-s']:8.3g} s, said {row['predicted-s']:8.3g}; "
            f"{row['memory'] / 1e6:8.4g} MB, said {row['predicted-memory'] / 1e6:8.4g}",
            "" if row["converged"] else "not converged",
        )
    for name, found in zip(("MEMORY", "TIME"), factors(rungs, taken), strict=True):
        print(f"{name} = {{")
        for model, of in found.items():
            print(f"    {model!r}: {{{', '.join(f'{key!r}: {value:.3g}' for key, value in of.items())}}},")
        print("}")


if __name__ == "__main__":
    main(sys.argv[1:])
