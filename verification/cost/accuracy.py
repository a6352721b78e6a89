# SPDX-License-Identifier: MIT
"""Results to an accuracy that a scene asks for: the cells, layers and load steps with which it begins, how
many the table of advice has for it, and the search.

The search begins with the fewest cells and load steps that have an uncertainty, and refines what is missing:
the parts of the uncertainty by cells and by load steps say how many of each would reach it in the least time.
Load steps are tried on the coarsest cells, where they cost little. Grids that were solved are the coarser
companions of the next. Nothing is solved that needs more memory than the machine has, or more than LONGEST
together with what was solved before.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from math import ceil, inf, sqrt

import sam
from sam.grid import Room
from sam.scene import Result, Scene
from verification.cost import advice, estimates
from verification.runs import models
from verification.runs.files import Run
from verification.runs.provenance import memory_bytes
from verification.scenes import with_keys
from verification.text.readable import with_prefix, with_time
from verification.uncertainty import solving
from verification.uncertainty.rule import STEP_FACTOR, bound

ADVISED = dict.fromkeys((advice.ELASTIC, advice.COATED), "p_max_Pa")
ADVISED |= dict.fromkeys((advice.YIELDING, advice.DEEP, advice.SLIDING), "peeq_max")
"""Kind of scene -> the quantity that its table of advice is about."""
# Of the accuracy: the errors that the table of advice is asked for. The uncertainty is 3 to 4 times an error
# in the median (case uncertainty-study), and its parts by cells and load steps add up.
CELLS_SHARE, STEPS_SHARE = 1 / 4.5, 1 / 9
FEWEST_CELLS = 4.2  # in the contact radius of the coarsest of three grids: below four it has no uncertainty
# From each of the first three grids to the next, so that rounding to whole cells leaves 1.3; elements: more.
RATIOS = dict.fromkeys(models.MODELS, solving.RATIO) | {models.SAM: 1.4}
FEWEST_STEPS = 6  # 4, 3 and 2 steps may agree by chance: linear hardening, 0.29 of the error
MOST_STEPS = 1000
MOST_CELLS = 4097


@dataclass(frozen=True)
class Choice:
    """cells: in the contact radius; steps: of the load, 0 where they decide nothing."""

    cells: float
    steps: int

    def __str__(self) -> str:
        steps = f" and {self.steps} load steps" if self.steps else ""
        return f"{self.cells:.3g} cells in the contact radius{steps}"


def quantities_of(scene: Scene) -> tuple[str, ...]:
    """Those whose accuracy is asked for: by the scene, else the one of its table of advice."""
    own = scene.solver.accuracy_of
    return tuple(own) if own else (ADVISED[advice.kind_of(scene)],)


def first_choice(scene: Scene, model: str) -> Choice:
    """With what the first three grids of a scene end: what the table of advice has, or with a history the
    fewest cells and steps, as too fine a grid costs more there. Raises ModelError as `expected`, and for
    quantities without an uncertainty.
    """
    advised = expected(scene, model)
    for name in quantities_of(scene):
        if reason := solving.why_not(name, scene):
            raise models.ModelError(f'solver.accuracy_of = ["{name}"]: {reason}: remove it')
    return Choice(FEWEST_CELLS * RATIOS[model] ** 2, FEWEST_STEPS) if solving.has_history(scene) else advised


def expected(scene: Scene, model: str) -> Choice:
    """What the table has for the accuracy of a scene. Raises ModelError for what was not measured."""
    accuracy, kind = scene.solver.accuracy, advice.kind_of(scene)
    if kind not in ADVISED:
        what = "remove it, no error was measured for such scenes"
        raise models.ModelError(f"solver.accuracy = {accuracy:g}: {what}")
    cells = _resolution(kind, model, accuracy * CELLS_SHARE, 0.5)
    if cells is None:
        what = f"larger, or another --model: {model} does not reach it"
        raise models.ModelError(f"solver.accuracy = {accuracy:g}: {what}")
    steps = 0
    if solving.has_history(scene):
        steps = ceil(_resolution(kind, advice.LOAD_STEPS, accuracy * STEPS_SHARE, 1.0) or scene.loading.steps)
    steps = min(max(steps, FEWEST_STEPS), MOST_STEPS) if steps else 0
    return Choice(max(cells, FEWEST_CELLS * RATIOS[model] ** 2), steps)


def chosen_scene(scene: Scene, model: str, choice: Choice) -> Scene:
    """The scene with these cells and load steps, asked for its uncertainty."""
    scene = solving.alone(scene)
    found = with_keys(scene, "solver", uncertainty=True)
    if model == models.SAM:
        grid = sam.choose_grid(scene)
        a, b = sam.hertz_semi_axes(scene)
        factor = (sqrt(a * b / (grid.hx * grid.hy)) if grid.ny > 1 else a / grid.hx) / choice.cells
        more = (min(solving.coarser(count, factor) + 2 * (factor < 1), MOST_CELLS) for count in grid.shape)
        cells = tuple(n if count > 1 else 1 for n, count in zip(more, grid.shape, strict=True))
        found = with_keys(found, "grid", cells=cells)
    else:
        found = with_keys(found, "fem", cells_per_radius=ceil(choice.cells))
    if not choice.steps:
        return found
    steps, loading = {"steps": choice.steps}, scene.loading
    if loading.unload_steps:
        steps["unload_steps"] = min(ceil(loading.unload_steps * choice.steps / loading.steps), MOST_STEPS)
    return with_keys(found, "loading", **steps)


def _resolution(kind: str, method: str, error: float, power: float) -> float | None:
    """Cells or load steps to an error, of the table; beyond its smallest error with a power. None: never."""
    own = [row for row in advice.table() if row.kind == kind and row.method == method]
    own.sort(key=lambda row: -row.error)
    if not own:
        return None
    row = next((row for row in own if row.error <= error), own[-1])
    return None if row.bound == advice.NEVER else row.resolution * max(row.error / error, 1.0) ** power


LONGEST = 900.0  # processor seconds that are foreseen for all solves of a scene together
ROUNDS = 8  # of grids, and of numbers of load steps for one of them
AIMED = 0.8  # of the accuracy: at which a refinement aims, as the uncertainty does not fall smoothly
NEAREST = 1.3  # ratio of cell sizes of which two grids say something, rounded to whole cells
# From a grid to the next: one that is hardly finer says no more than scatter does, by which coarse cells
# ask for more than is needed.
LEAST, MOST = 1.15, 1.5
STEEPEST = 1.5  # times its formal order: to which that seen on three grids counts, as coarse cells scatter
MOST_TIMES = 3  # as many load steps from one round to the next: what 4, 3 and 2 steps say is rough
BEFORE_CELLS = 1 / 2  # of the accuracy: what load steps may leave before the part by cells is known
WORTH = 1.25  # of the time: to be saved by other load steps, which have to be tried on coarse cells first
# Of a solve: its time grows as cells^4 (steps + 20), in yielding spheres.
CELLS_POWER, FREE_STEPS = 4.0, 20.0


class BeyondError(models.ModelError):
    """A solve that is not made; the message says what it would need, and what is allowed."""


def solve(scene: Scene, model: str, solver: solving.Solve | None = None) -> Result:
    """The result of a scene as it asks for it. Raises what the solver does, and ModelError of the search."""
    if scene.solver.accuracy is None:
        return solving.solve(scene, model, solver)
    search = Search(scene, model, solver or (lambda each, _: models.solve(each, model)))
    return search.result(first_choice(scene, model))


def missed(result: Result | Run) -> str:
    """What an asked accuracy came to, where it was not reached; else empty."""
    found = result.discretisation.get("accuracy")
    if not found or found["reached"]:
        return ""
    words = f"accuracy {100 * found['asked']:g} % not reached with {found['with']}"
    if found["relative"] is None:
        return f"{words}: {found['quantity']} has no uncertainty: {found['why']}"
    return f"{words}: {found['quantity']} is known to {100 * found['relative']:.2g} %; {found['why']}"


@dataclass
class Attempt:
    """What some grids say of the finest: the quantity known worst, its relative uncertainty, why it ends."""

    choice: Choice
    result: Result
    quantity: str
    relative: float | None
    why: str = ""

    @property
    def known(self) -> float:
        """The relative uncertainty, infinite where there is none."""
        return inf if self.relative is None else self.relative


@dataclass
class Search:
    """The solves for the accuracy of a scene. ladder: cells in the contact radius of its grids, coarsest
    first; kept: scene as text -> result; grids: choice -> its member; foreseen: processor seconds predicted
    for all; steps, boxes: members that differ in load steps, and in the finite-element box.
    """

    scene: Scene
    model: str
    solver: solving.Solve
    ladder: list[float] = field(default_factory=list)
    kept: dict[str, Result] = field(default_factory=dict)
    grids: dict[Choice, solving.Member] = field(default_factory=dict)
    foreseen: float = 0.0
    steps: Sequence[solving.Member] = ()
    boxes: Sequence[solving.Member] = ()

    @property
    def asked(self) -> float:
        """The accuracy that the scene asks for."""
        return self.scene.solver.accuracy

    def result(self, first: Choice) -> Result:
        """The finest result, or if none was good enough the best known, with what came of the accuracy."""
        attempts: list[Attempt] = []
        choice, ratio = first, RATIOS[self.model]
        self.ladder = [first.cells / ratio**k for k in (2, 1, 0)]
        try:
            while not attempts or (attempts[-1].known > self.asked and not attempts[-1].why):
                most = inf if attempts else BEFORE_CELLS * AIMED * self.asked
                choice = replace(choice, steps=self.on_coarse_cells(choice.steps, most))
                if attempts:
                    choice, tried = self.wanted(attempts[-1], choice.steps), choice.steps
                    if choice.steps > tried:
                        continue
                if choice.cells > self.ladder[-1]:
                    self.ladder.append(choice.cells)
                attempts.append(self.attempt(choice))
                if len(attempts) == ROUNDS:
                    attempts[-1].why = f"{ROUNDS} rounds of grids were not enough"
        except BeyondError as reason:
            if not attempts:
                raise models.ModelError(f"solver.accuracy = {self.asked:g}: {reason}") from None
            attempts[-1].why = str(reason)
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
        return replace(best.result, discretisation=named, cost=solving.cost_of(first, others))

    def on_coarse_cells(self, count: int, most: float) -> int:
        """Solve with load steps, and in boxes, on the coarsest cells; the number of steps, which is more than
        `count` where with fewer the steps of some solves were halved, or leave more than `most`.
        """
        for _ in range(ROUNDS if count else 0):
            choice = Choice(self.ladder[0], count)
            tried = self.solved(choice, solving.members_of_steps(self.member(choice)))
            self.steps = [*tried, *(each for each in self.steps if self.tells_more(each, tried))]
            part = max(map(self.part_of_steps, quantities_of(self.scene)))
            if count == MOST_STEPS or (part < inf and part <= most):
                break
            times = solving.RATIO if part == inf else min(max(part / most, solving.RATIO), MOST_TIMES)
            count = min(ceil(count * times), MOST_STEPS)
        if self.model != models.SAM and not self.boxes:
            choice = Choice(self.ladder[0], count)
            self.boxes = self.solved(choice, solving.members_of_box(self.member(choice)))
        return count

    def tells_more(self, earlier: solving.Member, tried: Sequence[solving.Member]) -> bool:
        """Whether a solution with fewer load steps counts beside three others, which may agree by chance."""
        cuts = tried[0].result.cost.get("step_cuts")
        return (
            earlier.result.converged
            and earlier.result.cost.get("step_cuts") == cuts
            and earlier.size >= NEAREST * tried[0].size
            and earlier.number not in [each.number for each in tried]
        )

    def part_of_steps(self, name: str) -> float:
        """The relative uncertainty of a quantity by the load steps, infinite where there is none."""
        if not self.steps:
            return 0.0
        results = [each.result for each in self.steps]
        values = [result.quantities[name] for result in results]
        cuts = {result.cost.get("step_cuts") or 0 for result in results}
        if len(cuts) > 1 or not all(result.converged for result in results) or not all(values):
            return inf
        sizes = [each.size for each in self.steps]
        return bound(values, sizes, solving.STEP_ORDER, STEP_FACTOR) / abs(values[0])

    def attempt(self, choice: Choice) -> Attempt:
        """What a grid and its companions say of it."""
        family = solving.Family(self.with_companions(choice), self.steps, self.boxes)
        result = solving.assessed(self.scene, family)
        known = {name: (result.uncertainty or {}).get(name, {}) for name in quantities_of(self.scene)}
        worst = max(known, key=lambda name: inf if (u := known[name].get("relative")) is None else u)
        relative, why = known[worst].get("relative"), ""
        if relative is None and not solving.under_resolved(self.scene, family.cells[0].result, family):
            why = known[worst].get("flag", str(result.status))
        return Attempt(choice, result, worst, relative, why)

    def with_companions(self, choice: Choice) -> list[solving.Member]:
        """A grid and the next two coarser ones, none hardly coarser than the one before. Those of an elastic
        body are solved in one step, at the depths of its largest stresses, or at one where no stress is asked
        for.
        """
        picked = [self.solution(choice)]
        depths = solving.depths_of_maxima(solving.alone(self.scene), picked[0].result)
        if depths is not None and not any(map(of_stress, quantities_of(self.scene))):
            depths = depths[:1]
        for cells in reversed(self.ladder):
            fewer = Choice(cells, choice.steps)
            if len(picked) < 3 and self.member(fewer).size >= NEAREST * picked[-1].size:
                picked.append(self.solution(fewer, depths))
        return picked

    def wanted(self, attempt: Attempt, count: int) -> Choice:
        """The cells and load steps that are foreseen to reach the accuracy in the least time, by the parts of
        the uncertainty by cells and box of the last attempt, and by load steps of `count`. Raises BeyondError
        where none does.
        """
        choice = attempt.choice
        if attempt.relative is None:
            return Choice(choice.cells * RATIOS[self.model], count)
        counts = [count]
        while counts[-1] and counts[-1] < MOST_STEPS:
            counts.append(min(ceil(LEAST * counts[-1]), MOST_STEPS))
        finer = {each: self.finer(attempt, count, each) for each in counts}

        def time(each: int) -> float:
            return finer[each] ** CELLS_POWER * (each + FREE_STEPS) * (1.0 if each == count else WORTH)

        best = min(finer, key=time)
        if finer[best] == inf:
            entry = attempt.result.uncertainty[attempt.quantity]
            left = f"{self.steps[0].number} load steps leave too much" if self.steps else ""
            box = f"fem.box = {self.scene.fem.box:g} leaves too much"
            said = box if entry["u_box"] > entry["u_steps"] else left
            raise BeyondError(f"more cells do not help: {said}")
        times = min(max(finer[best], LEAST), MOST)
        if finer[best] <= 1.0 and best > choice.steps:
            times = 1.0
        return Choice(choice.cells * times, min(best, MOST_TIMES * count))

    def finer(self, attempt: Attempt, count: int, wanted: int) -> float:
        """By how much cells must be smaller with these load steps, by the order seen; infinite if no help."""
        found = 1.0
        for name in quantities_of(self.scene):
            entry, value = attempt.result.uncertainty[name], abs(attempt.result.quantities[name])
            left = AIMED * self.asked - self.part_of_steps(name) * count / max(wanted, 1)
            left -= entry["u_box"] / value
            formal = solving.ORDERS[name]
            order = min(max(entry["order_seen"] or 0.0, formal), STEEPEST * formal)
            times = (entry["u_cells"] / value / left) ** (1 / order) if left > 0.0 else inf
            found = max(found, times)
        return found

    def member(
        self, choice: Choice, room: Room | None = None, depths: Sequence[float] | None = None
    ) -> solving.Member:
        """The scene on some cells. room: of an enlarged grid; depths: of a coarser companion, if not all."""
        scene = solving.alone(chosen_scene(self.scene, self.model, choice))
        if self.model != models.SAM:
            count = scene.fem.cells_per_radius
            return solving.Member(scene, f"{count} elements in the radius", count, 1 / count)
        if depths is not None:
            scene = solving.in_one_step(with_keys(scene, "grid", depths=tuple(depths)))
        grid = sam.plan(scene).on(room or Room()).grid
        return solving.Member(scene, f"{grid.nx} cells", grid.nx, solving.cell_size(grid))

    def solution(self, choice: Choice, depths: Sequence[float] | None = None) -> solving.Member:
        """The scene on some cells, solved once; depths: as those of `member`."""
        if choice not in self.grids:
            (found,) = self.solved(choice, [self.member(choice, depths=depths)])
            result, room = found.result, found.result.discretisation.get("grid_enlarged")
            if room is not None:
                found = self.member(choice, Room(**room), depths)
            if depths is not None and len(depths) == 1:
                left = {k: None if of_stress(k) else v for k, v in result.quantities.items()}
                result = replace(result, quantities=left)
            self.grids[choice] = replace(found, result=result)
        return self.grids[choice]

    def solved(self, choice: Choice, members: Sequence[solving.Member]) -> list[solving.Member]:
        """Some scenes, each solved once. Raises BeyondError, which names the choice."""
        for member in members:
            key = member.scene.model_dump_json()
            if key not in self.kept:
                self.foreseen += affordable(choice, member.scene, self.model, self.foreseen)
                self.kept[key] = self.solver(member.scene, member.label)
        return [replace(each, result=self.kept[each.scene.model_dump_json()]) for each in members]


def of_stress(name: str) -> bool:
    """Whether a quantity is a largest stress, which is looked for over depth."""
    return name.startswith("mises")


def affordable(choice: Choice, scene: Scene, model: str, before: float) -> float:
    """Processor seconds that are predicted for a scene, after those before it. Raises BeyondError."""
    needs, there = estimates.estimate(scene, model), memory_bytes()
    if there and needs.memory_bytes > there:
        needed, machine = (with_prefix(number, "B") for number in (needs.memory_bytes, there))
        raise BeyondError(f"{choice} would be next: about {needed} of memory needed, {machine} available")
    if before + needs.time_s > LONGEST:
        own, all_of_it = with_time(needs.time_s), with_time(LONGEST)
        time = f"{own} of processor time after {with_time(before)}, {all_of_it} allowed for all solves"
        raise BeyondError(f"{choice} would be next: about {time}")
    return needs.time_s
