# SPDX-License-Identifier: MIT
"""Results to an accuracy that a scene asks for.

The uncertainty is driven down from above. Load steps are chosen first, on coarse cells, where they cost
little. The cells follow: the grids so far say by their uncertainty how fine the next has to be, and are its
coarser companions, so that each refinement is one more solve. Nothing is solved that needs more memory than
the machine has, or more than LONGEST together with what was solved before.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import ceil, inf, sqrt
from typing import Any

import sam
from sam.grid import Room
from sam.scene import Result, Scene
from verification.cost import estimates
from verification.cost.choice import MOST_STEPS, Choice, chosen_scene, first_choice, quantities_of
from verification.runs import models
from verification.runs.provenance import memory_bytes
from verification.text.readable import with_prefix, with_time
from verification.uncertainty import (
    ORDERS,
    RATIO,
    STEP_FACTOR,
    STEP_ORDER,
    Family,
    Member,
    Solve,
    Solved,
    alone,
    assessed,
    bound,
    cost_of,
    members_of_box,
    members_of_steps,
    solve as solve_uncertain,
    under_resolved,
)

LONGEST = 900.0  # processor seconds that are foreseen for all solves of a scene together
FINER = 6  # grids beyond the first three at most
ROUNDS = 4  # of numbers of load steps
AIMED = 0.8  # of the accuracy: at which a refinement aims, as the uncertainty does not fall smoothly
OF_STEPS = 1 / 4  # of that the part of load steps; 3 times as many take 1.2 times the time (yielding spheres)
NEAREST = (
    1.3  # ratio of cell sizes of which two grids say something; the rule has 1.5, rounded to whole cells
)
# From a grid to the next: one that is hardly finer says no more than scatter does; errors are covered as
# often at a ratio of 2 as at 1.5.
LEAST, MOST = 1.15, 2.0
MORE_STEPS = 2.0  # times as many, where the steps of one solve were halved and those of another were not
MOST_TIMES = 8.0  # as many load steps from one round to the next: what 4, 3 and 2 steps say is rough


class BeyondError(models.ModelError):
    """A solve that is not made; the message says what it would need, and what is allowed."""


def solve(scene: Scene, model: str, solver: Solve | None = None) -> Result:
    """The result of a scene as it asks for it: plain, with its uncertainty, or to an accuracy.

    Raises what the solver raises, and ModelError as `first_choice` or where even the first grids need too
    much.
    """
    if scene.solver.accuracy is None:
        return solve_uncertain(scene, model, solver)
    search = Search(scene, model, solver or (lambda each, _: models.solve(each, model)))
    return search.result(first_choice(scene, model))


def missed(result: Result) -> str:
    """What an asked accuracy came to, where it was not reached; else empty."""
    found = result.discretisation.get("accuracy")
    if not found or found["reached"]:
        return ""
    words = f"accuracy {100 * found['asked']:g} % not reached with {found['with']}"
    if found["relative"] is None:
        return f"{words}: {found['quantity']} has no uncertainty: {found['why']}"
    return f"{words}: {found['quantity']} is known to {100 * found['relative']:.2g} %; {found['why']}"


@dataclass(frozen=True)
class Solution:
    """A solved grid. choice: what was asked for; member: what was made of it."""

    choice: Choice
    member: Member
    result: Result


@dataclass
class Attempt:
    """What some grids say of the finest of them.

    quantity: the one that is known worst; relative: its uncertainty, None where there is none; wanted: the
    next grid; why: what keeps it from being solved.
    """

    choice: Choice
    result: Result
    quantity: str
    relative: float | None
    wanted: Choice
    why: str = ""

    @property
    def known(self) -> float:
        """The relative uncertainty, infinite where there is none."""
        return inf if self.relative is None else self.relative


@dataclass
class Search:
    """The solves for the accuracy of a scene. kept: scene as text -> result; foreseen: processor seconds
    predicted for them; steps, boxes: solutions that differ in load steps, and in the finite-element box.
    """

    scene: Scene
    model: str
    solver: Solve
    kept: dict[str, Result] = field(default_factory=dict)
    foreseen: float = 0.0
    steps: Sequence[Solution] = ()
    boxes: Sequence[Solution] = ()

    @property
    def asked(self) -> float:
        """The accuracy that the scene asks for."""
        return self.scene.solver.accuracy

    def result(self, first: Choice) -> Result:
        """The finest result, or if none was good enough the best known, with what came of the accuracy."""
        try:
            count = self.number_of_steps(first) if first.steps else 0
            coarse = Choice(first.cells / RATIO, count)
            if self.model != models.SAM:
                self.boxes = self.solutions(coarse, members_of_box(self.member(coarse)))
            grids = [self.solution(Choice(first.cells / RATIO**k, count)) for k in (2, 1, 0)]
        except BeyondError as reason:
            raise models.ModelError(f"solver.accuracy = {self.asked:g}: {reason}") from None
        attempts = [self.attempt(grids)]
        while attempts[-1].known > self.asked and not attempts[-1].why:
            try:
                grids.append(self.solution(attempts[-1].wanted))
            except BeyondError as reason:
                attempts[-1].why = f"{attempts[-1].wanted} would be next: {reason}"
            else:
                attempts.append(self.attempt(grids))
        return self.concluded(attempts)

    def concluded(self, attempts: Sequence[Attempt]) -> Result:
        """The best of some attempts, with what came of all."""
        last, best = attempts[-1], min(attempts, key=lambda each: each.known)
        reached = best.known <= self.asked
        found = {
            "asked": self.asked,
            "quantity": best.quantity,
            "relative": best.relative,
            "reached": reached,
            "with": str(best.choice),
            "why": "" if reached else last.why,
            "attempts": [{"with": str(each.choice), "relative": each.relative} for each in attempts],
            "solves": len(self.kept),
        }
        first, *others = self.kept.values()
        named = {**best.result.discretisation, "accuracy": found}
        return replace(best.result, discretisation=named, cost=cost_of(first, others))

    def number_of_steps(self, first: Choice) -> int:
        """The load steps, by their part of the uncertainty on coarse cells."""
        choice, aim = Choice(first.cells / RATIO, first.steps), AIMED * OF_STEPS * self.asked
        for left in reversed(range(ROUNDS)):
            self.steps = self.solutions(choice, members_of_steps(self.member(choice)))
            part = max(self.part_of_steps(name) for name in quantities_of(self.scene))
            if part <= aim or choice.steps == MOST_STEPS or not left:
                break
            times = MORE_STEPS if part == inf else min(part / aim, MOST_TIMES)
            choice = replace(choice, steps=min(ceil(choice.steps * times), MOST_STEPS))
        return choice.steps

    def part_of_steps(self, name: str) -> float:
        """The relative uncertainty of a quantity by the load steps, infinite where there is none."""
        results = [each.result for each in self.steps]
        values = [result.quantities[name] for result in results]
        cuts = {result.cost.get("step_cuts") or 0 for result in results}
        if len(cuts) > 1 or not all(result.converged for result in results) or not all(values):
            return inf
        sizes = [each.member.size for each in self.steps]
        return bound(values, sizes, STEP_ORDER, STEP_FACTOR) / abs(values[0])

    def attempt(self, grids: Sequence[Solution]) -> Attempt:
        """What the grids so far say of the finest of them, and which is the next."""
        finest, sets = grids[-1], (companions(grids), self.steps, self.boxes)
        family = Family(*(tuple(each.member for each in some) for some in sets))
        result = assessed(self.scene, Solved(family, *([each.result for each in some] for some in sets)))
        known = {name: (result.uncertainty or {}).get(name, {}) for name in quantities_of(self.scene)}
        worst = max(known, key=lambda name: inf if (u := known[name].get("relative")) is None else u)
        relative, why = known[worst].get("relative"), ""
        times = max(self.finer(name, each, result) for name, each in known.items())
        if relative is None and not under_resolved(self.scene, finest.result, family):
            why = known[worst].get("flag", str(result.status))
        elif times == inf:
            why = f"more cells do not help: {self.beside(known[worst])}"
        elif len(grids) > FINER + 2:
            why = f"{FINER} finer grids were not enough"
        wanted = Choice(finest.choice.cells * min(max(times, LEAST), MOST), finest.choice.steps)
        if not why and self.member(wanted).size >= finest.member.size:
            why = "there is no finer grid"
        return Attempt(finest.choice, result, worst, relative, wanted, why)

    def finer(self, name: str, entry: Mapping[str, Any], result: Result) -> float:
        """By how much the cells have to be smaller for a quantity; infinite where they cannot help."""
        value = abs(result.quantities.get(name) or 0.0)
        if entry.get("relative") is None:
            return RATIO
        left = AIMED * self.asked * value - entry["u_steps"] - entry["u_box"]
        return (entry["u_cells"] / left) ** (1 / ORDERS[name]) if left > 0.0 else inf

    def beside(self, entry: Mapping[str, Any]) -> str:
        """What is left of an uncertainty by load steps and box, for the reader."""
        steps, box = entry["u_steps"], entry["u_box"]
        of_steps = f"{self.steps[0].choice.steps} load steps leave too much" if self.steps else ""
        return of_steps if steps >= box else f"fem.box = {self.scene.fem.box:g} leaves too much"

    def member(self, choice: Choice, room: Room | None = None) -> Member:
        """The scene on some cells, with some load steps; room: of a grid that was enlarged."""
        scene = alone(chosen_scene(self.scene, self.model, choice))
        if self.model != models.SAM:
            count = scene.fem.cells_per_radius
            return Member(scene, f"{count} elements in the radius", count, 1 / count)
        grid = sam.plan(scene).on(room or Room()).grid
        return Member(scene, f"{grid.nx} cells", grid.nx, sqrt(grid.hx * grid.hy))

    def solution(self, choice: Choice) -> Solution:
        """The scene on some cells, solved."""
        member = self.member(choice)
        (found,) = self.solutions(choice, [member])
        room = found.result.discretisation.get("grid_enlarged")
        return found if room is None else replace(found, member=self.member(choice, Room(**room)))

    def solutions(self, choice: Choice, members: Sequence[Member]) -> list[Solution]:
        """Some scenes, each solved once."""
        found = []
        for member in members:
            key = member.scene.model_dump_json()
            if key not in self.kept:
                self.foreseen += affordable(member.scene, self.model, self.foreseen)
                self.kept[key] = self.solver(member.scene, member.label)
            found.append(Solution(choice, member, self.kept[key]))
        return found


def affordable(scene: Scene, model: str, before: float) -> float:
    """Processor seconds that are predicted for a scene, after those before it. Raises BeyondError."""
    needs, there = estimates.estimate(scene, model), memory_bytes()
    if there and needs.memory_bytes > there:
        needed, machine = (with_prefix(number, "B") for number in (needs.memory_bytes, there))
        raise BeyondError(f"about {needed} of memory needed, {machine} available")
    if before + needs.time_s > LONGEST:
        own, all_of_it = with_time(needs.time_s), with_time(LONGEST)
        raise BeyondError(
            f"about {own} of processor time after {with_time(before)}, {all_of_it} allowed for all solves"
        )
    return needs.time_s


def companions(grids: Sequence[Solution]) -> list[Solution]:
    """The finest of some grids and the next two, none of them hardly coarser than the one before."""
    picked = [grids[-1]]
    for each in reversed(grids[:-1]):
        if len(picked) < 3 and each.member.size >= NEAREST * picked[-1].member.size:
            picked.append(each)
    return picked
