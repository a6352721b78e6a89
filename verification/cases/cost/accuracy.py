# SPDX-License-Identifier: MIT
"""Whether an accuracy that a scene asks for is reached, and never missed unsaid, in ten scenes."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from sam.scene import Result, Scene
from verification.cases.case import FEM, SAM, Context, with_keys, with_loading
from verification.cases.cost.uncertainty import sliding, solved
from verification.cases.recipes import at_ratio
from verification.cost.accuracy import Choice, chosen_scene, quantities_of, solve
from verification.cost.estimates import estimate
from verification.references import REFERENCES, coated_contact
from verification.runs import models
from verification.runs.store import solve_or_reuse
from verification.uncertainty.solving import alone, has_history

ACCURACIES = (0.05, 0.02, 0.01)
ELEMENTS, STEPS = 32, (10, 20)  # of the finite-element references, extrapolated in the load steps
LADDER, LADDER_STEPS = (3.0, 4.5, 6.7, 10.0, 15.0), (1, 2, 4, 8, 16)  # of the best fixed grid
SHORT = 0.5  # s of processor time: a solve that takes less is timed three times
FILM = 5.0  # modulus of the stiff film over that of the body
YIELDING = {
    "Swift, p0 = 3.5 yield stresses": ("plastic-swift-rigid", 3.5),
    "Swift, 5": ("plastic-swift-rigid", 5.0),
    "perfect, 4": ("plastic-perfect", 4.0),
    "linear, 3.5": ("plastic-linear", 3.5),
    "Swift, steel on steel, 4": ("plastic-swift-steel", 4.0),
}
"""Scene, and p0 over the initial yield stress."""


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


def subjects(context: Context) -> Mapping[str, tuple[Scene, Callable[[Context, Scene], float]]]:
    """Name -> scene, whose load is not of the table of advice, and the truth about its quantity."""

    def closed(_: Context, scene: Scene, *, reference: str) -> float:
        return float(REFERENCES[reference](scene).values["p-max"])

    of_sphere, of_ellipse = (partial(closed, reference=f"hertz-{shape}") for shape in ("sphere", "ellipse"))
    sphere, ellipse, coated = map(context.scene, ("hertz-sphere", "hertz-ellipse", "coated-sphere"))
    found: dict[str, Any] = {
        "elastic sphere": (with_loading(sphere, force=0.2), of_sphere),
        "ellipse 3 : 1": (ellipse.model_copy(update={"grid": None}), of_ellipse),
        "sliding sphere": (sliding(sphere), of_sphere),
        "soft film": (coated, of_film),
        "stiff film": (with_keys(coated, "body.coating", young=FILM * coated.body.young), of_film),
    }
    for name, (file, ratio) in YIELDING.items():
        scene = with_loading(at_ratio(context.scene(file), ratio), steps=5, unload=False)
        found[name] = scene.model_copy(update={"grid": None}), of_finite_elements
    return found


def frame(context: Context) -> Iterator[dict[str, Any]]:
    """A row for each scene and accuracy."""
    for name, (scene, truth) in subjects(context).items():
        context.progress(f"accuracy: {name}", 0, 1)
        kind, yields = (
            ("scenes that yield", "yes") if has_history(scene) else ("scenes that stay elastic", "no")
        )
        for row in searched(context, scene, truth(context, scene), ACCURACIES):
            yield {"sweep": kind, "model": "sam", "contact": name, "yields": yields} | row


def searched(
    context: Context, scene: Scene, truth: float, accuracies: Sequence[float]
) -> Iterator[dict[str, Any]]:
    """A scene at some accuracies. Every solve is made once, and kept in the store; the time of a short one is
    the least of three, as the first of its kind also loads what it needs. all, finest: processor seconds of
    all solves, and of the one that took longest; best-fixed: of the cheapest grid whose true error is no
    larger, which only who knows the answer can choose.
    """
    kept: dict[str, Result] = {}
    (name,) = quantities_of(scene)

    def by_sam(each: Scene, _: str = "") -> Result:
        if (text := each.model_dump_json()) not in kept:
            result = solve_or_reuse(context.store, each, SAM)[0]
            if (least := result.cost["cpu_s"]) < SHORT:
                least = min(least, *(models.solve(each, SAM).cost["cpu_s"] for _ in range(2)))
            kept[text] = replace(result, cost={**result.cost, "cpu_s": least})
        return kept[text]

    def off(result: Result) -> float:
        return abs(result.quantities[name] / truth - 1)

    counts = LADDER_STEPS if has_history(scene) else (0,)
    fixed = [alone(chosen_scene(scene, SAM, Choice(cells, count))) for cells in LADDER for count in counts]
    fixed.sort(key=lambda each: estimate(each, SAM).time_s)
    for accuracy in accuracies:
        row, seconds = {"asked": accuracy}, []

        def solver(each: Scene, _: str, seconds: list[float] = seconds) -> Result:
            seconds.append(by_sam(each).cost["cpu_s"])
            return by_sam(each)

        try:
            result = solve(with_keys(scene, "solver", accuracy=accuracy), SAM, solver)
        except models.ModelError as error:
            yield row | {"reached": 0.0, "unsaid": 0.0, "said": str(error)}
            continue
        found, error = result.discretisation["accuracy"], off(result)
        unsaid = found["reached"] and not error <= accuracy
        good = (made for each in fixed if (made := by_sam(each)).converged and off(made) <= accuracy)
        best = next((made.cost["cpu_s"] for made in good), np.nan)
        over = best if found["reached"] else np.nan
        row |= {"reached": float(found["reached"] and not unsaid), "unsaid": float(unsaid)}
        row |= {"said": "reached" if found["reached"] else found["why"], "with": found["with"]}
        row |= {"uncertainty": found["relative"], "error": error}
        row |= {"all": sum(seconds), "finest": max(seconds), "best-fixed": best}
        yield row | {"over-fixed": sum(seconds) / over, "finest-over-fixed": max(seconds) / over}
