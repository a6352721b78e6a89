# SPDX-License-Identifier: MIT
"""How time and memory grow with cells, cycles and unknowns, and how well `samfem plan` predicts both."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from verification.cases.case import FEM_3D, Case, Context, Plot, SmallTable
from verification.cost import growth
from verification.cost.growth import MEMORY_MATTERS, TIME_MATTERS, Applied, Taken
from verification.figures.lines import Curve, growth as draw, predicted
from verification.reference.convergence import Power, fit_power

BOXES = ((16, 16, 8), (32, 32, 16), (64, 64, 32), (128, 128, 32))  # of the exponent in cells
PLANES = ((16, 16, 16), (32, 32, 16), (64, 64, 16), (128, 128, 16))
DEPTHS = ((64, 64, 4), (64, 64, 8), (64, 64, 16), (64, 64, 32))
UPPER_CELLS = (
    257**2
)  # smaller contacts are fixed costs: some milliseconds of setting up, arrays in the caches
UPPER_CYCLES = 2  # the first one has the set-up in it
GATED = ("contact", "stresses", "operator", "cycles")  # exponents; the others are reported
MEMORY_ALLOWED, TIME_ALLOWED = 1.2, 2.0  # factors between predicted and measured


@dataclass(frozen=True)
class Climbed:
    """found: family -> its rungs; boxes: the operator by itself, over cells, the plane and depth."""

    found: Mapping[str, Sequence[Taken]]
    boxes: Mapping[str, Sequence[Applied]]

    @property
    def every(self) -> list[Taken]:
        """The rungs of all families."""
        return [each for family in self.found.values() for each in family]

    @cached_property
    def powers(self) -> dict[str, Power]:
        """Of processor time."""
        return exponents(self.found, self.boxes)

    @cached_property
    def memory(self) -> dict[str, Power]:
        """Family -> exponent of its memory."""
        return {name: memory_power(self.found[name]) for name in ("contact", "stresses")}


class Growth(Case):
    """The ladders solved, their exponents, and the plan compared with them."""

    def solve(self, context: Context) -> Climbed:
        rungs = {name: make() for name, make in growth.FAMILIES.items()}
        taken = iter(growth.climb([rung for each in rungs.values() for rung in each], context.progress))
        found = {name: [next(taken) for _ in each] for name, each in rungs.items()}
        sizes = {"cells": BOXES, "plane": PLANES, "depth": DEPTHS}
        boxes = {name: [growth.applied(*box) for box in each] for name, each in sizes.items()}
        return Climbed(found, boxes)

    def measure(self, climbed: Climbed) -> dict[str, float]:
        every = climbed.every
        late = sum(not each.converged for each in every if each.rung.model != FEM_3D)
        return {f"exponent-{name}": climbed.powers[name].exponent for name in GATED} | {
            "memory-error": worst(*memories(every), MEMORY_MATTERS) - 1.0,
            "time-factor": worst(*times(every), TIME_MATTERS),
            "unconverged": late,
        }

    def setup(self, climbed: Climbed) -> Iterator[tuple[str, str]]:
        median = f"median of {growth.REPEATS} below {growth.SHORT_S:g} s"
        yield "Each point", f"a solve in a process of its own, one thread; {median}"
        over = "over that of a process that has loaded the model and solved nothing"
        yield "Memory", f"largest resident memory {over}"
        yield "Elastic contact", "rigid sphere, one step, over 4a each way, stresses at z = 0 alone"
        depths = "the depths of a user who names none, less the time of the former"
        yield "Stresses", f"the same with {depths}"
        stored = "product with the stored matrices, back to the cells; single precision"
        yield "Operator", f"transform of the strain, {stored}"
        yield "Exponents", f"least squares in log-log ± standard error; contact: from {UPPER_CELLS} cells on"

    def tables(self, climbed: Climbed) -> Iterator[SmallTable]:
        rows = [
            (_NAMES[name][0], of, _NAMES[name][1], f"{power.first:.0f}", f"{power.last:.0f}", str(power))
            for of, powers in (("processor time", climbed.powers), ("memory", climbed.memory))
            for name, power in powers.items()
        ]
        yield SmallTable("Exponents", ("what", "of", "in", "from", "to", "exponent"), rows)
        unique = {(box.nx, box.ny, box.layers): box for each in climbed.boxes.values() for box in each}
        rows = [
            (
                *(f"{box.nx} × {box.ny} × {box.layers}", f"{box.cells}", f"{box.setup_s:.3g}"),
                *(f"{1e3 * box.apply_s:.3g}", f"{box.stored / 1e6:.4g}", f"{box.memory / 1e6:.4g}"),
            )
            for box in sorted(unique.values(), key=lambda box: box.cells)
        ]
        columns = "box|cells|set-up [s]|application [ms]|stored [MB]|memory with the set-up [MB]"
        yield SmallTable("Residual-stress operator by itself", columns.split("|"), rows)
        rows = []
        for each in climbed.every:
            said, rung = each.expected, each.rung
            off = f"{1e2 * (said.memory_bytes / each.memory - 1):+.0f} %"
            memory = (f"{each.memory / 1e6:.4g}", f"{said.memory_bytes / 1e6:.4g}")
            counted = off if each.memory >= MEMORY_MATTERS else "not counted"
            time = (f"{each.cpu_s:.3g}", f"{said.time_s:.3g}")
            rows.append((rung.family, rung.label, *time, *memory, counted))
        columns = "scene|size|time [s]|predicted [s]|memory [MB]|predicted [MB]|off by"
        yield SmallTable("Measured, and predicted by samfem plan", columns.split("|"), rows)

    def notes(self, climbed: Climbed) -> Iterator[str]:
        yield (
            "The operator is dense over the layers: its cost is in proportion to the cells in the plane, and "
            "to the square of the number of layers. In cells that is an exponent between 1 (more cells in "
            "the plane) and 4/3 (all three sides doubled)."
        )

    def figures(self, climbed: Climbed) -> list[Plot]:
        fits = ", ".join(f"{_NAMES[name][0]} {power}" for name, power in climbed.powers.items())
        return [
            Plot(
                draw(_growth(climbed)),
                "time-memory",
                "Time and memory over size",
                "Log-log plots of processor time and memory over cells, cycles and unknowns. Exponents: "
                f"{fits}.",
                "Lines: least squares through the points they cover; numbers: exponents ± standard error.",
            ),
            Plot(
                predicted(_prediction(climbed.every)),
                "predicted",
                "Predicted over measured",
                "Log-log plots of predicted over measured memory and processor time, one mark a solve.",
                f"Shaded: factor {MEMORY_ALLOWED:g} for memory, {TIME_ALLOWED:g} for time; counted right of "
                "the dotted line.",
            ),
        ]


def exponents(
    found: Mapping[str, Sequence[Taken]], boxes: Mapping[str, Sequence[Applied]]
) -> dict[str, Power]:
    """Of processor time, over the ranges that the table names."""
    contact = {each.size: each.cpu_s for each in found["contact"]}
    stresses = {each.size: each.cpu_s - contact[each.size] for each in found["stresses"]}
    cells, plane, depth = boxes["cells"], boxes["plane"], boxes["depth"]
    return {
        "contact": fit_power(list(contact), list(contact.values()), UPPER_CELLS),
        "stresses": fit_power(list(stresses), list(stresses.values())),
        "operator": fit_power([box.cells for box in cells], [box.apply_s for box in cells]),
        "operator-plane": fit_power([box.nx * box.ny for box in plane], [box.apply_s for box in plane]),
        "operator-depth": fit_power([box.layers for box in depth], [box.apply_s for box in depth]),
        "operator-setup": fit_power([box.cells for box in cells], [box.setup_s for box in cells]),
        "cycles": _of(found["cycles"], UPPER_CYCLES),
        "axisymmetric": _of(found["axisymmetric"]),
        "spatial": _of(found["spatial"]),
    }


def _of(taken: Sequence[Taken], first: float = 0.0) -> Power:
    return fit_power([each.size for each in taken], [each.cpu_s for each in taken], first)


def memory_power(taken: Sequence[Taken]) -> Power:
    """Of memory, over the three largest."""
    return fit_power([each.size for each in taken[-3:]], [each.memory for each in taken[-3:]])


def memories(taken: Sequence[Taken]) -> tuple[np.ndarray, np.ndarray]:
    """(measured, predicted) in bytes over an idle process."""
    return np.array([each.memory for each in taken]), np.array([each.expected.memory_bytes for each in taken])


def times(taken: Sequence[Taken]) -> tuple[np.ndarray, np.ndarray]:
    """(measured, predicted) in s."""
    return np.array([each.cpu_s for each in taken]), np.array([each.expected.time_s for each in taken])


def worst(measured: np.ndarray, expected: np.ndarray, least: float) -> float:
    """Largest factor, one way or the other, among the points with `least` or more measured."""
    use = measured >= least
    with np.errstate(divide="ignore"):
        return float(np.exp(np.abs(np.log(expected[use] / measured[use])).max(initial=0.0)))


_NAMES = {
    "contact": ("elastic contact, whole solve", "cells"),
    "stresses": ("elastic stresses at all depths", "cells"),
    "operator": ("residual-stress operator, an application", "cells of the box"),
    "operator-plane": ("the same, more cells in the plane", "cells in the plane"),
    "operator-depth": ("the same, more layers", "layers"),
    "operator-setup": ("its set-up", "cells of the box"),
    "cycles": ("running-in, whole solve", "cycles"),
    "axisymmetric": ("axisymmetric finite elements, elastic", "unknowns"),
    "spatial": ("finite elements in 3D, elastic", "unknowns"),
}


_ELEMENTS = (("axisymmetric", "axisymmetric"), ("3D", "spatial"))


def _growth(climbed: Climbed) -> dict[str, tuple[str, dict[str, Curve], dict[str, Curve]]]:
    """The columns of the figure: title -> (label of x, seconds, bytes)."""
    powers, memory = climbed.powers, climbed.memory

    def curve(family: str, of: str, power: Power | None = None) -> Curve:
        return _curve(climbed.found[family], "size", of, power)

    def of_box(of: str, power: Power | None = None) -> Curve:
        return _curve(climbed.boxes["cells"], "cells", of, power)

    return {
        "Elastic, SAM": (
            "cells",
            {
                "contact": curve("contact", "cpu_s", powers["contact"]),
                "with all depths": curve("stresses", "cpu_s"),
            },
            {
                "contact": curve("contact", "memory", memory["contact"]),
                "with all depths": curve("stresses", "memory", memory["stresses"]),
            },
        ),
        "Residual-stress operator": (
            "cells of the box",
            {
                "an application": of_box("apply_s", powers["operator"]),
                "set-up": of_box("setup_s", powers["operator-setup"]),
            },
            {"stored": of_box("stored"), "with the set-up": of_box("memory")},
        ),
        "Running-in": (
            "cycles",
            {"running-in": curve("cycles", "cpu_s", powers["cycles"])},
            {"running-in": curve("cycles", "memory")},
        ),
        "Finite elements, elastic": (
            "unknowns",
            {label: curve(name, "cpu_s", powers[name]) for label, name in _ELEMENTS},
            {label: curve(name, "memory") for label, name in _ELEMENTS},
        ),
    }


def _curve(points: Sequence, size: str, of: str, power: Power | None) -> Curve:
    """An attribute of points over another."""
    return Curve(*(np.array([float(getattr(each, key)) for each in points]) for key in (size, of)), power)


def _prediction(taken: Sequence[Taken]) -> dict[str, tuple[float, float, dict[str, tuple[list, list]]]]:
    """The panels of the figure: title -> (factor that is allowed, value from which it counts, families)."""

    def families(pick: Callable) -> dict[str, tuple[list, list]]:
        of = {
            name: [each for each in taken if each.rung.family == name]
            for name in dict.fromkeys(each.rung.family for each in taken)
        }
        return {name: tuple(values.tolist() for values in pick(each)) for name, each in of.items()}

    in_mb = families(lambda each: tuple(1e-6 * np.maximum(values, 1e5) for values in memories(each)))
    return {
        "Memory over idle [MB]": (MEMORY_ALLOWED, 1e-6 * MEMORY_MATTERS, in_mb),
        "Processor time [s]": (TIME_ALLOWED, TIME_MATTERS, families(times)),
    }


CASES = (Growth("growth", alone=True),)
