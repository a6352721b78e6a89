# SPDX-License-Identifier: MIT
"""Whether an accuracy that a scene asks for is reached, and never missed unsaid, in ten scenes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sam.scene import Result, Scene
from verification.cases.case import (
    FEM,
    SAM,
    Case,
    Context,
    Measured,
    SmallTable,
    with_keys,
    with_loading,
)
from verification.cases.cost.uncertainty import sliding, solved
from verification.cases.recipes import at_ratio
from verification.cost.accuracy import solve
from verification.cost.choice import Choice, chosen_scene, quantities_of
from verification.cost.estimates import estimate
from verification.references import REFERENCES, coated_contact
from verification.runs import models
from verification.runs.models import ModelError
from verification.runs.store import solve_or_reuse
from verification.text.readable import with_time
from verification.uncertainty import alone, has_history

ACCURACIES = (0.05, 0.02, 0.01, 0.005)
ELEMENTS, STEPS = 32, (20, 40)  # of the finite-element references, extrapolated in the load steps
LADDER, LADDER_STEPS = (3.0, 4.5, 6.7, 10.0, 15.0), (1, 2, 4, 8, 16)  # of the best fixed grid
SHORT = 0.5  # s of processor time: a solve that takes less is timed three times
FILM = 5.0  # modulus of the stiff film over that of the body


@dataclass(frozen=True)
class Subject:
    """A scene, and the true value of the quantity that its accuracy is about."""

    name: str
    scene: Scene
    truth: Callable[[Context, Scene], float]


@dataclass(frozen=True)
class Run:
    """What came of an accuracy.

    reached: as it was said; error: the true one; took: cells and load steps; why: it was refused or not
    reached; seconds, finest, fixed: processor time of all solves, of the one that took longest, and of the
    cheapest grid whose true error is no larger than was asked.
    """

    subject: str
    asked: float
    reached: bool = False
    relative: float | None = None
    error: float = np.nan
    took: str = ""
    why: str = ""
    seconds: float = 0.0
    finest: float = 0.0
    fixed: float = np.nan
    yields: bool = False

    @property
    def unsaid(self) -> bool:
        """Whether it was said to be reached, and was not."""
        return self.reached and not self.error <= self.asked

    @property
    def over_fixed(self) -> float:
        """Processor time over that of the best fixed grid, which only who knows the answer can choose."""
        return self.seconds / self.fixed


def of_finite_elements(context: Context, scene: Scene) -> float:
    """The largest strain of the axisymmetric model, extrapolated to infinitely many load steps."""
    few, many = (
        solved(context, with_loading(with_keys(scene, "fem", cells_per_radius=ELEMENTS), steps=steps), FEM)
        for steps in STEPS
    )
    return 2 * many.quantities["peeq_max"] - few.quantities["peeq_max"]


def of_film(_: Context, scene: Scene) -> float:
    """The largest pressure, by integral transforms."""
    return coated_contact(scene).largest_pressure()[0]


def subjects(context: Context) -> list[Subject]:
    """Ten scenes; their loads are not those of the table of advice."""

    def closed(reference: str) -> Callable[[Context, Scene], float]:
        return lambda _, scene: float(REFERENCES[reference](scene).values["p-max"])

    sphere, ellipse, coated = map(context.scene, ("hertz-sphere", "hertz-ellipse", "coated-sphere"))
    found = {
        "elastic sphere": (with_loading(sphere, force=0.2), closed("hertz-sphere")),
        "ellipse 3 : 1": (ellipse.model_copy(update={"grid": None}), closed("hertz-ellipse")),
        "sliding sphere": (sliding(sphere), closed("hertz-sphere")),
        "soft film": (coated, of_film),
        "stiff film": (with_keys(coated, "body.coating", young=FILM * coated.body.young), of_film),
    }
    for name, file, ratio in (
        ("Swift, p0 = 3.5 yield stresses", "plastic-swift-rigid", 3.5),
        ("Swift, 5", "plastic-swift-rigid", 5.0),
        ("perfect, 4", "plastic-perfect", 4.0),
        ("linear, 3.5", "plastic-linear", 3.5),
        ("Swift, steel on steel, 4", "plastic-swift-steel", 4.0),
    ):
        scene = with_loading(at_ratio(context.scene(file), ratio), steps=5, unload=False)
        found[name] = scene.model_copy(update={"grid": None}), of_finite_elements
    return [Subject(name, *each) for name, each in found.items()]


def runs_of(context: Context, subject: Subject, accuracies: Sequence[float]) -> Iterator[Run]:
    """A scene at some accuracies; every solve is made once, and kept in the store; the time of a
    short one is the least of three, as the first of its kind also loads what it needs.
    """
    kept: dict[str, Result] = {}

    def by_sam(scene: Scene) -> Result:
        if (text := scene.model_dump_json()) not in kept:
            result = solve_or_reuse(context.store, scene, SAM)[0]
            if (least := result.cost["cpu_s"]) < SHORT:
                least = min(least, *(models.solve(scene, SAM).cost["cpu_s"] for _ in range(2)))
            kept[text] = replace(result, cost={**result.cost, "cpu_s": least})
        return kept[text]

    truth = subject.truth(context, subject.scene)
    for accuracy in accuracies:
        context.progress(f"accuracy: {subject.name}, {100 * accuracy:g} %", 0, 1)
        yield run_of(by_sam, subject, accuracy, truth)


def run_of(by_sam: Callable[[Scene], Result], subject: Subject, accuracy: float, truth: float) -> Run:
    """The scene at an accuracy."""
    scene = with_keys(subject.scene, "solver", accuracy=accuracy)
    seconds = []

    def solver(each: Scene, _: str) -> Result:
        result = by_sam(each)
        seconds.append(result.cost.get("cpu_s") or 0.0)
        return result

    try:
        result = solve(scene, SAM, solver)
    except ModelError as error:
        return Run(subject.name, accuracy, why=str(error))
    found, (name,) = result.discretisation["accuracy"], quantities_of(scene)
    return Run(
        subject.name,
        accuracy,
        found["reached"],
        found["relative"],
        abs(result.quantities[name] / truth - 1),
        found["with"],
        found["why"],
        sum(seconds),
        max(seconds),
        best_fixed(by_sam, subject, accuracy, truth),
        yields=has_history(scene),
    )


def best_fixed(by_sam: Callable[[Scene], Result], subject: Subject, accuracy: float, truth: float) -> float:
    """Processor time of the first of some grids, by predicted time, whose true error is no larger; nan if all
    are larger.
    """
    (name,) = quantities_of(subject.scene)
    steps = LADDER_STEPS if has_history(subject.scene) else (0,)
    scenes = [
        alone(chosen_scene(subject.scene, SAM, Choice(cells, count))) for cells in LADDER for count in steps
    ]
    for scene in sorted(scenes, key=lambda each: estimate(each, SAM).time_s):
        result = by_sam(scene)
        if result.converged and abs(result.quantities[name] / truth - 1) <= accuracy:
            return result.cost.get("cpu_s") or 0.0
    return np.nan


class Accuracy(Case):
    """Ten scenes at four accuracies by SAM."""

    def solve(self, context: Context) -> list[Run]:
        return [run for each in subjects(context) for run in runs_of(context, each, ACCURACIES)]

    def measure(self, found: Sequence[Run]) -> dict[str, Measured | float]:
        return {
            "reached": float(np.mean([run.reached and not run.unsaid for run in found])),
            "unsaid": float(sum(run.unsaid for run in found)),
            "over-fixed": medians(found)[0],
        }

    def notes(self, found: Sequence[Run]) -> Iterator[str]:
        for words, own in (("stay elastic", False), ("yield", True)):
            if runs := [run for run in found if run.yields is own]:
                whole, margin, search = medians(runs)
                yield (
                    f"Scenes that {words}: processor time is {whole:.2g} times that of the best fixed grid "
                    f"in the median. The finest grid takes {margin:.2g} times as much as that one, the price "
                    f"of a margin for errors that are not known, all solves {search:.2g} times as much as "
                    f"the finest, the price of showing it."
                )

    def tables(self, found: Sequence[Run]) -> Iterator[SmallTable]:
        rows = []
        for run in found:
            said = "reached" if run.reached else run.why
            relative = "-" if run.relative is None else f"{1e2 * run.relative:.2g}"
            best = (with_time(run.fixed), f"{run.over_fixed:.2g}") if run.fixed > 0.0 else ("none", "")
            shown = (run.took, with_time(run.seconds), with_time(run.finest), *best)
            rows.append(
                (run.subject, f"{1e2 * run.asked:g}", said, relative, f"{1e2 * run.error:.2g}", *shown)
            )
        columns = "scene|asked [%]|said|uncertainty [%]|true error [%]|with|all solves|the finest"
        yield SmallTable("Accuracies", f"{columns}|best fixed grid|all / best".split("|"), rows)


def medians(found: Sequence[Run]) -> tuple[float, float, float]:
    """Over runs that were reached: time of all solves over that of the best fixed grid, of the finest over
    the same, and of all solves over the finest.
    """
    runs = [run for run in found if run.reached and run.fixed > 0.0]
    ratios = [(run.over_fixed, run.finest / run.fixed, run.seconds / run.finest) for run in runs]
    whole, margin, search = np.median(ratios, axis=0) if ratios else (np.nan,) * 3
    return float(whole), float(margin), float(search)


CASES = (Accuracy("accuracy"),)
