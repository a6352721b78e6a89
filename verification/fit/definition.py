# SPDX-License-Identifier: MIT
"""A fit: a scene, the tests that were measured on its body, and what is unknown. From a TOML file or from
Python to what is fitted, or to every error of it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise, product
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import BeforeValidator, Field, ValidationError

from sam.scene import (
    Conflict,
    Fem,
    InputError,
    Number,
    Problem,
    Scene,
    SceneError,
    Section,
    below,
    check_kind,
    in_unit,
    load_scene,
    parse_toml,
    problems,
    read_limited,
    scene_of,
    spelling,
    tables_of,
    unit_of_key,
)
from verification.fit.measured import LARGEST, Points, faults, read_points
from verification.runs import models
from verification.runs.model_range import contact_modulus
from verification.runs.study import refused

ZERO, COMPLIANCE = "zero", "compliance"
OF_THE_MACHINE = {ZERO: "m", COMPLIANCE: "m/N"}
"""What is unknown of the tests and not of the scene: the depth at which the counting began, of each curve;
the deflection of the machine in a force. Both are linear, and need no solve."""
STEPS = 12
"""Load steps to the peak, and half as many back, where the scene has no number of them."""
CELLS = 8
"""Elements in the contact radius, where the scene has no table [fem]; both are halved for the coarse grid."""
SIDE = 37
"""Cells along a side of the patch of SAM, where the scene has no number of them: depths of a Swift steel are
within 0.04 % of those on its own grid, in a fifth of the time, and uncertainties have a third grid."""
Length = Annotated[float, Number("a length", 1e-12, 1e3, "m", "1 um")]
Force = Annotated[float, Number("a force", 1e-12, 1e9, "N", "10 N")]
Pressure = Annotated[float, Number("a pressure", 1e3, 1e15, "Pa", "210 GPa")]
Poisson = Annotated[float, Number("a number", 0.0, 0.5)]


def _bounds(value: object) -> tuple[Any, ...]:
    if not isinstance(value, list | tuple) or len(value) not in (2, 3):
        raise refused("[least, largest] or [least, start, largest]")
    return tuple(value)


Variables = Mapping[str, float]
"""Unknown key of a scene -> its value in SI."""
Bounds = Annotated[tuple[Any, ...], BeforeValidator(_bounds)]


class Measured(Section):
    """The table [[tests]] of a fit: a measured curve, the profile of a dent, or its depth on the axis.

    file: CSV in the folder of the fit; units: of its columns, where their names have none; radius, young,
    poisson: of the ball, where not that of the scene; force: the largest, of a curve that of its points;
    depth: of a dent, in place of a file; noise: one standard deviation of a depth; estimated from
    the residuals if not given.
    """

    of_scene: ClassVar[bool] = False

    file: str | None = None
    kind: Literal["curve", "profile", "depth"] = "curve"
    units: list[str] = Field(default_factory=list)
    radius: Length | None = None
    young: Pressure | None = None
    poisson: Poisson | None = None
    force: Force | None = None
    depth: Length | None = None
    noise: Length | None = None

    @classmethod
    def conflicts(cls, given: Mapping[str, Any]) -> Iterator[Conflict]:
        """What a kind needs and does not take."""
        kind = given.get("kind", "curve")
        needed = {"profile": ("file", "force"), "depth": ("depth", "force")}.get(kind, ("file",))
        yield from ((key, f'required with kind = "{kind}"') for key in needed if key not in given)
        if kind != "depth" and "depth" in given:
            yield "depth", 'only with kind = "depth": a curve and a profile have their depths in the file'
        if kind == "depth" and "noise" not in given:
            yield "noise", 'required of a single depth: one standard deviation, such as "20 nm"'


class Fit(Section):
    """The content of a fit file. scene: a file in its folder, or the tables of the scene; unknown: key ->
    [least, largest] or [least, start, largest].
    """

    of_scene: ClassVar[bool] = False

    title: str = ""
    scene: Any
    model: Literal["sam", "fem-axisymmetric", "fem-3d"] | None = None
    tests: list[Measured] = Field(min_length=1, max_length=50)
    unknown: dict[str, Bounds] = Field(min_length=1, max_length=12)


@dataclass(frozen=True)
class Parameter:
    """An unknown with its bounds and start, in SI; where it is positive ln(value/start) is sought."""

    name: str
    low: float
    start: float
    high: float

    @property
    def logarithmic(self) -> bool:
        """Whether ratios of its values count."""
        return self.low > 0.0

    def sought(self, value: Any) -> Any:
        """The variable of the least squares at a value."""
        return np.log(value / self.start) if self.logarithmic else np.asarray(value) / self.scale

    def value(self, sought: Any) -> Any:
        """Back from there."""
        return self.start * np.exp(sought) if self.logarithmic else np.asarray(sought) * self.scale

    @property
    def scale(self) -> float:
        """A size, so that all variables are of order one."""
        return max(abs(self.low), abs(self.high))


@dataclass(frozen=True)
class Test:
    """A measured test in SI. scene: with its ball and its load; noise: of a depth in m, None: estimated."""

    name: str
    kind: str
    scene: Scene
    points: Points
    noise: float | None

    def at(self, values: Variables) -> Scene:
        """Its scene with values of unknown keys. Raises SceneError where they do not go together."""
        tables = tables_of(self.scene)
        for key, value in values.items():
            _put(tables, key, value)
        return Scene(**tables)


@dataclass(frozen=True)
class Definition:
    """What is fitted. of_scene: the unknowns that are keys of the scene; of_machine: the others."""

    title: str
    model: str
    tests: tuple[Test, ...]
    of_scene: tuple[Parameter, ...]
    of_machine: tuple[Parameter, ...] = ()


def read_definition(path: str | Path) -> Definition:
    """The fit in a TOML file. Raises SceneError with everything that is wrong with it."""
    path = Path(path)
    try:
        content = read_limited(path)
    except InputError as error:
        raise SceneError([Problem("", "", str(error))], str(path)) from None
    table = parse_toml(content, str(path))
    check_kind(table, "fit", str(path))
    return _made(table, path.parent, str(path))


def definition_of(given: Mapping[str, Any]) -> Definition:
    """The fit that Python gives: the keys of its file, in SI or with units; scene: also a Scene; a test may
    have its table as `data`, a DataFrame, in place of a file. Raises SceneError.
    """
    return _made(given, None, "fit")


def _made(table: Mapping[str, Any], folder: Path | None, source: str) -> Definition:
    tests = [dict(test) if isinstance(test, Mapping) else test for test in table.get("tests", ())]
    frames = [test.pop("data", None) if isinstance(test, dict) else None for test in tests]
    for k, (test, frame) in enumerate(zip(tests, frames, strict=True)):
        if frame is not None:
            test.setdefault("file", f"data {k + 1}")
    try:
        fit = Fit.model_validate({**table, "tests": tests}, context={"spelling": "file"} if folder else {})
    except ValidationError as error:
        raise SceneError(problems(error), source) from None
    scene = _scene(fit.scene, folder, source)
    found: list[Problem] = []
    unknown = [_parameter(key, bounds, scene, found) for key, bounds in fit.unknown.items()]
    if found:
        raise SceneError(found, source)
    made = [
        _test(k, test, scene, _points(test, frame, folder, f"{source}: tests[{k}]"))
        for k, (test, frame) in enumerate(zip(fit.tests, frames, strict=True))
    ]
    model = fit.model or _cheapest(made[0].scene)
    curves, ours = [test.name for test in made if test.kind == "curve"], list[Parameter]()
    for each in unknown:
        names = [f"{ZERO} of {name}" for name in curves] if each.name == ZERO else [each.name]
        ours += [replace(each, name=name) for name in names if each.name in OF_THE_MACHINE]
    theirs = tuple(each for each in unknown if each.name not in OF_THE_MACHINE)
    if not theirs:
        raise SceneError([Problem("unknown", "no key of the scene", 'such as "body.plasticity.B"')], source)
    for test, end in product(made, ("low", "start", "high")):
        try:
            models.check(test.at({each.name: getattr(each, end) for each in theirs}), model)
        except models.ModelError as error:
            words = f"narrower bounds, or tests within the range of the model: {error}"
            wrong = Problem("unknown", f"the {end} values, with {test.name}", words)
            raise SceneError([wrong], source) from None
    return Definition(fit.title, model, tuple(made), theirs, tuple(ours))


def _scene(given: Any, folder: Path | None, source: str) -> Scene:
    """The scene of the fit, with [loading] made up where it has none: that comes with the tests."""
    if isinstance(given, Scene):
        return given
    if isinstance(given, Mapping):
        usual = {"force": "1 N" if folder else 1.0, "steps": STEPS, "unload": True}
        tables = {"loading": usual, **given}
        return scene_of(tables, f"{source}: scene") if folder else Scene(**tables)
    try:
        return load_scene(Path(given) if folder is None else below(folder, str(given), "fit"))
    except (InputError, TypeError) as error:
        raise SceneError([Problem("scene", spelling(given), str(error))], source) from None


def _parameter(key: str, bounds: tuple[Any, ...], scene: Scene, found: list[Problem]) -> Parameter:
    """An unknown; what is wrong with it is added to `found`."""
    unit = OF_THE_MACHINE.get(key) or unit_of_key(Scene, key.removesuffix(".0"))
    numbers = [number for value in bounds if (number := _number(value, unit)) is not None]
    if len(numbers) < len(bounds) or not all(a < b for a, b in pairwise(numbers)):
        like = f"strings in units of {unit}" if unit else "numbers"
        words = f"[least, largest] or [least, start, largest], {like}, ascending"
        found.append(Problem(f"unknown.{key}", spelling(list(bounds)), words))
        return Parameter(key, 1.0, 1.0, 1.0)
    low, high = numbers[0], numbers[-1]
    middle = float(np.sqrt(low * high)) if low > 0.0 else (low + high) / 2.0
    made = Parameter(key, low, numbers[1] if len(numbers) == 3 else middle, high)
    if key not in OF_THE_MACHINE:
        try:
            _put(tables_of(scene), key, low)
        except (KeyError, TypeError, IndexError):
            words = f"a number of the scene, which it must have, or one of {', '.join(OF_THE_MACHINE)}"
            found.append(Problem("unknown", key, f'{words}: such as "body.plasticity.B"'))
    return made


def _number(value: Any, unit: str) -> float | None:
    """A bound in SI; None for what is none."""
    if isinstance(value, str):
        exact = in_unit(value, unit) if unit else None
        return None if exact is None else float(exact)
    return float(value) if isinstance(value, int | float) and not isinstance(value, bool) else None


def _put(tables: dict[str, Any], key: str, value: float) -> None:
    """Put a number in the place of another of the tables; KeyError, TypeError or IndexError without one."""
    *above, name = key.split(".")
    inner: Any = tables
    for part in above:
        inner = inner[part]
    place: Any = int(name) if isinstance(inner, list) else name
    if isinstance(inner[place], bool) or not isinstance(inner[place], int | float | str):
        raise TypeError(key)
    inner[place] = value


def with_load(scene: Scene, force: float, **ball: float | None) -> Scene:
    """The scene with a force and what is given of its ball."""
    tables = tables_of(scene)
    steps = scene.loading.steps if scene.loading.steps > 1 else STEPS
    unload = {"unload": True, "unload_steps": scene.loading.unload_steps or max(steps // 2, 2)}
    tables["loading"] = {"force": force, "steps": steps, **unload}
    if scene.fem == Fem():
        tables["fem"] = {"cells_per_radius": CELLS}
    if scene.grid is None:
        tables["grid"] = {"cells": [SIDE, SIDE]}
    tables["counterbody"] |= {key: value for key, value in ball.items() if value is not None}
    return Scene(**tables)


def _points(test: Measured, frame: Any, folder: Path | None, source: str) -> tuple[Points, str]:
    """The points of a test, and what messages name. Raises SceneError."""
    if test.kind == "depth":
        return Points(np.zeros(1), np.array([test.depth], dtype=float), np.zeros(1, bool)), source
    name, content = str(test.file), b"" if frame is None else frame.to_csv(index=False).encode()
    if frame is None:
        try:
            content = read_limited(Path(name) if folder is None else below(folder, name, "fit"), LARGEST)
        except InputError as error:
            raise SceneError([Problem("file", spelling(name), str(error))], source) from None
    return read_points(content, test.kind, test.units, f"{source} ({name})"), f"{source} ({name})"


def _test(k: int, test: Measured, scene: Scene, measured: tuple[Points, str]) -> Test:
    """A test. Raises SceneError for points that cannot be of it."""
    points, source = measured
    if scene.counterbody is None or scene.counterbody.shape != "sphere":
        raise SceneError([Problem("counterbody.shape", "another", '"sphere"')], source)
    force = test.force or float(points.x.max(initial=0.0))
    if not 0.0 < force < 1e9:
        raise SceneError([Problem("force", f"{force:g} N", "positive where the ball is pressed on")], source)
    own = with_load(scene, force, radius=test.radius, young=test.young, poisson=test.poisson)
    ball = own.counterbody
    assert ball is not None and ball.radius is not None
    elastic = float((0.75 * force / contact_modulus(own)) ** (2.0 / 3.0) * ball.radius ** (-1.0 / 3.0))
    if found := [] if test.kind == "depth" else faults(points, test.kind, ball.radius, elastic):
        raise SceneError(found, source)
    return Test(f"test {k + 1}", test.kind, own, points, test.noise)


def _cheapest(scene: Scene) -> str:
    """The semi-analytical model where it can represent the scene, else axisymmetric finite elements."""
    try:
        models.check(scene, models.SAM)
    except models.ModelError:
        return models.FEM
    return models.SAM
