# SPDX-License-Identifier: MIT
"""Whether an accuracy that a scene asks for is reached, and never missed unsaid, in ten scenes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from sam.scene import Scene
from verification.cost.accuracy import quantities_of, solve
from verification.runs.models import ModelError
from verification.runs.store import solve_or_reuse
from verification.suite.cases.case import (
    FEM,
    SAM,
    Case,
    Context,
    Measured,
    SmallTable,
    with_keys,
    with_loading,
)
from verification.suite.cases.coated_sphere import answer_of
from verification.suite.cases.uncertainty_study import of_ellipse, of_hertz, plastic, sliding, solved
from verification.text.readable import with_time

ACCURACIES = (0.05, 0.02, 0.01, 0.005)
ELEMENTS, STEPS = 32, (20, 40)  # of the finite-element references, extrapolated in the load steps
FILM = 5.0  # modulus of the stiff film over that of the body


@dataclass(frozen=True)
class Subject:
    """A scene, and the true value of the quantity that its accuracy is about."""

    name: str
    scene: Scene
    truth: Callable[[Context, Scene], float]


@dataclass(frozen=True)
class Run:
    """What came of an accuracy. reached: as it was said; error: the true one; took: cells and load steps;
    seconds: of all solves of the last attempt.
    """

    subject: str
    asked: float
    reached: bool = False
    relative: float | None = None
    error: float = np.nan
    took: str = ""
    seconds: float = 0.0
    refused: str = ""

    @property
    def unsaid(self) -> bool:
        """Whether it was said to be reached, and was not."""
        return self.reached and not self.error <= self.asked


def of_finite_elements(context: Context, scene: Scene) -> float:
    """The largest strain of the axisymmetric model, extrapolated to infinitely many load steps."""
    few, many = (
        solved(context, with_loading(with_keys(scene, "fem", cells_per_radius=ELEMENTS), steps=steps), FEM)
        for steps in STEPS
    )
    return 2 * many.quantities["peeq_max"] - few.quantities["peeq_max"]


def of_film(_: Context, scene: Scene) -> float:
    """The largest pressure, by integral transforms."""
    return answer_of(scene).contact.largest_pressure()[0]


def subjects(context: Context) -> list[Subject]:
    """Ten scenes; their loads are not those of the table of advice."""

    def closed(truth) -> Callable[[Context, Scene], float]:
        return lambda where, scene: truth(where, scene)["p_max_Pa"][0]

    sphere, coated = context.scene("hertz-sphere"), context.scene("coated-sphere")
    ellipse = context.scene("hertz-ellipse").model_copy(update={"grid": None})
    stiff = with_keys(coated, "body.coating", young=FILM * coated.body.young)
    swift, elements = "plastic-swift-rigid", of_finite_elements
    yielding = {
        "Swift, p0 = 3.5 yield stresses": (swift, 3.5),
        "Swift, 5": (swift, 5.0),
        "perfect, 4": ("plastic-perfect", 4.0),
        "linear, 3.5": ("plastic-linear", 3.5),
        "Swift, steel on steel, 4": ("plastic-swift-steel", 4.0),
    }
    return [
        Subject("elastic sphere", with_loading(sphere, force=0.2), closed(of_hertz)),
        Subject("ellipse 3 : 1", ellipse, closed(of_ellipse)),
        Subject("sliding sphere", sliding(sphere), closed(of_hertz)),
        Subject("soft film", coated, of_film),
        Subject("stiff film", stiff, of_film),
        *(
            Subject(name, with_loading(plastic(context, *which), unload=False), elements)
            for name, which in yielding.items()
        ),
    ]


def run_of(context: Context, subject: Subject, accuracy: float) -> Run:
    """The scene at an accuracy; every solve of it is kept in the store."""
    scene = with_keys(subject.scene, "solver", accuracy=accuracy)
    context.progress(f"accuracy: {subject.name}, {100 * accuracy:g} %", 0, 1)
    try:
        result = solve(scene, SAM, lambda each, _: solve_or_reuse(context.store, each, SAM)[0])
    except ModelError as error:
        return Run(subject.name, accuracy, refused=str(error))
    found, (name,) = result.discretisation["accuracy"], quantities_of(scene)
    error = abs(result.quantities[name] / subject.truth(context, subject.scene) - 1)
    took, seconds = str(found["with"]), result.cost.get("cpu_s") or 0.0
    return Run(subject.name, accuracy, found["reached"], found["relative"], error, took, seconds)


class Accuracy(Case):
    """Ten scenes at four accuracies by SAM."""

    def solve(self, context: Context) -> list[Run]:
        return [run_of(context, each, accuracy) for each in subjects(context) for accuracy in ACCURACIES]

    def measure(self, found: Sequence[Run]) -> dict[str, Measured | float]:
        return {
            "reached": float(np.mean([run.reached and not run.unsaid for run in found])),
            "unsaid": float(sum(run.unsaid for run in found)),
        }

    def tables(self, found: Sequence[Run]) -> Iterator[SmallTable]:
        rows = [
            (
                run.subject,
                f"{1e2 * run.asked:g}",
                run.refused or ("reached" if run.reached else "not reached"),
                "-" if run.relative is None else f"{1e2 * run.relative:.2g}",
                f"{1e2 * run.error:.2g}",
                run.took,
                with_time(run.seconds),
            )
            for run in found
        ]
        heads = ("scene", "asked [%]", "said", "uncertainty [%]", "true error [%]", "with", "last attempt")
        yield SmallTable("Accuracies", heads, rows)


CASES = (
    Accuracy(
        "accuracy",
        "Accuracy on demand",
        "Is an accuracy that a scene asks for reached, and never missed without a word?",
        levels=("full",),
    ),
)
