# SPDX-License-Identifier: MIT
"""Rows of the robustness matrix as `rows.toml` has them, their scenes, and the verdict on a cell.

A row is one extreme. Beforehand it says for each model whether it must be right (and by which checks), end in
an error (and which words tell the user what to change), or does not apply; each with the reason. A cell that
does otherwise is wrong, and so is one that dies of another exception, that numpy warns of, or whose numbers
are not finite.
"""

from __future__ import annotations

import re
import time
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from math import isfinite, pi
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from sam.scene import HeightMap, InputError, Result, Scene, SceneError, problems
from verification.cost.accuracy import solve
from verification.runs import models
from verification.runs.models import ModelError

RADIUS, FORCE, YOUNG, POISSON = 1e-4, 0.17, 210e9, 0.3
HERTZ = (0.75 * FORCE * RADIUS * (1 - POISSON**2) / YOUNG) ** (1 / 3)  # contact radius in m
UNITS = {"a": HERTZ, "E": YOUNG, "p0": 1.5 * FORCE / (pi * HERTZ**2)}
"""Of the numbers in `rows.toml`: contact radius in m, modulus and largest pressure in Pa of the base."""
BASE = {
    "title": "Stability",
    "body": {"young": YOUNG, "poisson": POISSON},
    "counterbody": {"shape": "sphere", "radius": RADIUS},
    "loading": {"force": FORCE},
    "grid": {"cells": (33, 33)},  # over four contact radii
    "fem": {"cells_per_radius": 8},
}
"""The scene that every row changes: a rigid sphere on steel, small enough for a second in either model."""
TOLERANCE = "the tolerance of the scene"
"""Why a certificate has its bound. A solver stops as near to it as it can: such a comparison tells least of a
cell."""


SIDE, PATCH, HIGH = 32e-6, 32, 1e-6  # of a rough patch: side in m, cells, what stands out of it in m


def heights(name: str) -> HeightMap:
    """A surface by its name: (nx, ny) heights in m on cells of SIDE/PATCH."""
    plain, x = np.zeros((PATCH, PATCH)), 2 * pi * (np.arange(PATCH) + 0.5) / PATCH
    wave = np.cos(x)[:, None] * np.ones(PATCH)
    raised: dict[str, tuple[Any, float]] = {
        "step": (np.s_[: PATCH // 2], HIGH),
        "ridge": (np.s_[:4], HIGH),
        "spike": (np.s_[PATCH // 2, PATCH // 2], HIGH),
        "hole": (np.s_[3, 3], np.nan),
        "endless": (np.s_[3, 3], np.inf),
        "raised": (np.s_[:], 1e-3),
    }
    if name in raised:
        where, height = raised[name]
        plain[where] = height
    values = {
        "half": plain[: PATCH // 2],
        "strip": plain[:4],
        "short": plain[:16, :16],
        "wave": 1e-8 * wave,
        "wave-twice": 2e-8 * wave,
        "wave-down": -2e-8 * wave,
        "two-parts": np.concatenate([plain, 2e-8 * wave]),
    }.get(name, plain)
    return HeightMap(values, tuple(SIDE * n / PATCH for n in values.shape))


def wide(radii: float, cells: int, depth: float, *, thickness: float = 0.0, even: int = 9) -> dict:
    """A grid over so many Hertz radii, its layers growing below the first `even`; their thickness in m, of a
    cell if 0.
    """
    thickness, faces = thickness or radii * HERTZ / cells, [0.0]
    while faces[-1] < depth * HERTZ:
        faces.append(faces[-1] + thickness * max(1.0, 1.2 ** (len(faces) - even)))
    sides = radii * HERTZ, radii * HERTZ
    return {"cells": (cells, cells), "extent": sides, "depths": tuple(faces)}


def meant(value: Any, key: str = "") -> Any:
    """A value of `rows.toml` as a scene has it: "none" takes a key away, "2 a" and "p0/3" are numbers in
    UNITS; names of heights, and arguments of `wide`.
    """
    if isinstance(value, Mapping):
        own = {name: meant(each, name) for name, each in value.items()}
        return wide(*own.pop("wide"), **own) if "wide" in own else own
    if isinstance(value, list):
        return tuple(meant(each, key) for each in value)
    if value == "none":
        return None
    if not isinstance(value, str):
        return value
    if key.endswith("path"):
        return heights(value)
    if product := re.fullmatch(r"(\S+) (a|E|p0)", value):
        return float(product[1]) * UNITS[product[2]]
    return UNITS["p0"] / float(value[3:]) if value.startswith("p0/") else value


def changed(table: Mapping, changes: Mapping[str, Any]) -> dict:
    """The table with other values, by dotted keys; None takes a key or a whole table away."""
    out = dict(table)
    for key, value in changes.items():
        head, _, rest = key.partition(".")
        if rest:
            out[head] = changed(out.get(head, {}), {rest: value})
        elif value is None:
            out.pop(head, None)
        else:
            out[head] = value
    return out


def scene_with(changes: Mapping[str, Any]) -> Scene:
    """The base with other values, as in `rows.toml`. Raises pydantic.ValidationError for what is no scene."""
    return Scene.model_validate(changed(BASE, meant(changes)))


def other(scene: Scene, changes: Mapping[str, Any]) -> Scene:
    """A scene with other values, checked anew; a height map stays what it is."""
    table = scene.model_dump(exclude_none=True)
    if scene.surface is not None:
        table["surface"] = {key: value for key, value in scene.surface if value is not None}
    return Scene.model_validate(changed(table, meant(changes)))


class Kind(StrEnum):
    """What a cell is."""

    RIGHT = "right"
    ERROR = "error"
    ABSENT = "not applicable"
    WRONG = "wrong"


@dataclass(frozen=True)
class Deviation:
    """One comparison. error: of `what`, with the sign taken off; bound: largest allowed, with the reason for
    its size.
    """

    what: str
    error: float
    bound: float
    reason: str

    @property
    def share(self) -> float:
        """Error over bound; infinite for what is not a number."""
        return self.error / self.bound if isfinite(self.error) else float("inf")


class NoisyError(RuntimeError):
    """A solve during which numpy or another library warned."""


class Bench:
    """Solves scenes, each once: what one row compares with may be the cell of another."""

    def __init__(self):
        self._solved: dict[tuple[str, str], tuple[Result, str]] = {}

    def solve(self, scene: Scene, model: str) -> Result:
        """The result, whatever its status. Raises ModelError, and NoisyError for a solve that was not
        silent.
        """
        if model == models.FEM:
            scene = scene.model_copy(update={"grid": None})  # it has a mesh of its own
        key = scene.model_dump_json(), model
        if key not in self._solved:
            with warnings.catch_warnings(record=True) as heard, np.errstate(all="warn", under="ignore"):
                warnings.simplefilter("always")
                result = solve(scene, model)
            self._solved[key] = (
                result,
                "; ".join(f"{each.message} ({Path(each.filename).name})" for each in heard[:3]),
            )
        result, said = self._solved[key]
        if said:
            raise NoisyError(said)
        return result

    def converged(self, scene: Scene, model: str) -> Result:
        """For a comparison. RuntimeError when it did not converge."""
        result = self.solve(scene, model)
        if not result.converged:
            raise RuntimeError(f"{model} for comparison ended {result.status}: {result.message}")
        return result


@dataclass(frozen=True)
class Trial:
    """A solved cell, for its checks."""

    scene: Scene
    model: str
    result: Result
    bench: Bench

    @property
    def quantities(self) -> Mapping[str, float | None]:
        return self.result.quantities


Check = Callable[[Trial], Iterable[Deviation]]


@dataclass(frozen=True)
class Right:
    """The cell must converge and hold every check."""

    reason: str
    checks: Sequence[Check]


@dataclass(frozen=True)
class Refused:
    """The cell must end in an error that says each of these words. status: of the result, None if it is
    refused unsolved.
    """

    reason: str
    says: Sequence[str]
    status: str | None = None


@dataclass(frozen=True)
class Absent:
    """The extreme is none of this model."""

    reason: str


Expectation = Right | Refused | Absent


@dataclass(frozen=True)
class Row:
    """An extreme. changes: what differs from the base; expected: model -> what must become of it; quick: at
    this level too.
    """

    name: str
    topic: str
    what: str
    changes: Mapping[str, Any]
    expected: Mapping[str, Expectation]
    quick: bool = False


@dataclass(frozen=True)
class Cell:
    """The verdict. text: message of an error, or what is wrong; deviations: of a right cell; seconds: of
    processor time.
    """

    kind: Kind
    text: str = ""
    deviations: Sequence[Deviation] = field(default=())
    seconds: float = 0.0

    @property
    def worst(self) -> Deviation | None:
        """The comparison that is nearest to its bound, certificates last."""
        return max(self.deviations, key=lambda each: (each.reason != TOLERANCE, each.share), default=None)


def judge(row: Row, model: str, bench: Bench) -> Cell:
    """Solve a cell and compare with what the row expects."""
    expected = row.expected[model]
    if isinstance(expected, Absent):
        return Cell(Kind.ABSENT, expected.reason)
    began, scene, result, text, wrong = time.process_time(), None, None, "", ""
    found: list[Deviation] = []
    try:
        scene = scene_with(row.changes)
        result = bench.solve(scene, model)
    except ValidationError as error:
        text = "; ".join(map(str, problems(error)))
    except (SceneError, InputError, ModelError) as error:
        text = str(error)
    except Exception as error:  # whatever else it is, it is wrong
        wrong = f"{type(error).__name__}: {error}"
    if result is not None and not result.converged:
        text = f"{result.status}: {result.message}"
    if isinstance(expected, Refused):
        wrong = wrong or _wrong_error(expected, result, text)
        return Cell(Kind.WRONG if wrong else Kind.ERROR, wrong or text, (), time.process_time() - began)
    if result is None:
        wrong = wrong or f"refused: {text}"
    elif not result.converged:
        wrong = text
    else:
        wrong, found = _wrong_result(expected, Trial(scene, model, result, bench))
    return Cell(Kind.WRONG if wrong else Kind.RIGHT, wrong, found, time.process_time() - began)


def _wrong_error(expected: Refused, result: Result | None, text: str) -> str:
    """What is wrong with an error; empty where it is the expected one."""
    if result is not None and result.converged:
        return "converged, but an error was expected"
    if expected.status != (None if result is None else result.status):
        return f"expected {expected.status or 'a refusal'}: {text}"
    missing = [word for word in expected.says if word not in text]
    return f"the message does not say {missing}: {text}" if missing else ""


def _wrong_result(expected: Right, trial: Trial) -> tuple[str, list[Deviation]]:
    """What is wrong with a converged result, empty where nothing is; and its comparisons."""
    broken = [name for name, value in trial.quantities.items() if value is not None and not isfinite(value)]
    if broken:
        return f"not finite: {', '.join(broken)}", []
    try:
        found = [deviation for check in expected.checks for deviation in check(trial)]
    except (RuntimeError, ValueError) as error:
        return str(error), []
    beyond = [each for each in found if not each.share <= 1.0]
    text = "; ".join(f"{each.what}: {each.error:.3g} > {each.bound:g}" for each in beyond)
    return text or ("" if found else "nothing was compared"), found
