# SPDX-License-Identifier: MIT
"""The load steps of a plan with its checkpoints; of a coated contact also those of the bare one on the same
mesh.

The bare contact, for comparison, follows the same steps up to the last peak if the body can yield; of an
elastic one the peak is enough. It comes after the coated one, and a checkpoint holds both.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar

from fem_reference.common.loading import Progressed, Step, Strained, run
from fem_reference.common.model import ContactModel
from fem_reference.common.plan import Plan
from sam.scene.checkpoint import Checkpoint
from sam.scene.result import Progress

Keep = Callable[[object, int, int], None]
"""Called with a record, the steps done and those in all."""
M = TypeVar("M", bound=ContactModel)


@dataclass(frozen=True)
class Pair:
    """The steps of the coated contact and those of the bare one; None: not begun."""

    coated: Progressed | None = None
    bare: Progressed | None = None


def recorded_steps(record: Checkpoint, coated: bool) -> list[Step]:
    """The steps of a checkpoint, those of the coated contact alone."""
    now = record.record(Pair).coated if coated else record.record(Progressed)
    return [] if now is None else now.steps


@dataclass(frozen=True)
class Solved(Generic[M]):
    """The model of a plan and its steps; of a coated one also those of the bare contact, no steps if the
    coated one failed.
    """

    model: M
    steps: list[Step]
    bare_model: M | None = None
    bare_steps: list[Step] = field(default_factory=list)

    @property
    def all_steps(self) -> list[Step]:
        """The steps of both contacts."""
        return self.steps + self.bare_steps


def solved_steps(
    model: M,
    build_bare: Callable[[Plan], M],
    *,
    progress: Progress | None = None,
    keep: Keep | None = None,
    start: Checkpoint | None = None,
    strained: Strained | None = None,
) -> Solved[M]:
    """All steps of a plan, and for a coated contact those of the bare one.

    build_bare: makes the model of the bare contact; keep: called after each step of a body that can yield;
    start: a checkpoint to go on from; strained: as in `run`, of a contact without coating.
    """
    plan = model.plan
    if plan.bare is not None:
        begin = start.record(Pair) if start else Pair()
        return _coated_then_bare(model, build_bare(plan.bare), begin, progress=progress, keep=keep)

    def kept(now: Progressed) -> None:
        if keep:
            keep(now, len(now.steps), len(now.steps) + len(now.targets))

    first = start.record(Progressed) if start else None
    keeping = kept if keep else None
    steps = run(model, plan.schedule, progress=progress, keep=keeping, begin=first, strained=strained)
    return Solved(model, steps)


def _coated_then_bare(
    coated: M, bare: M, begin: Pair, *, progress: Progress | None, keep: Keep | None
) -> Solved[M]:
    """The steps of the coated contact, then those of the bare one unless it failed."""
    schedule, later = coated.plan.schedule, bare.plan.schedule

    def counted(first: int, last: int) -> Progress | None:
        return progress and (lambda stage, done, total: progress(stage, first + done, first + total + last))

    def keep_coated(now: Progressed) -> None:
        if keep:
            keep(Pair(now), len(now.steps), len(now.steps) + len(now.targets) + len(later.targets))

    def keep_bare(now: Progressed) -> None:
        if keep:
            done = len(steps) + len(now.steps)
            keep(Pair(finished, now), done, done + len(now.targets))

    steps = run(
        coated,
        schedule,
        progress=counted(0, later.loading_steps),
        keep=keep_coated if keep else None,
        begin=begin.coated,
    )
    if not steps[-1].state.converged:
        return Solved(coated, steps, bare)
    finished = Progressed(coated.virgin(), (), steps)
    later = later.with_forces({(step.cycle, step.number): step.state.force for step in steps})
    bare_steps = run(
        bare,
        later,
        progress=counted(schedule.loading_steps, 0),
        keep=keep_bare if keep else None,
        begin=begin.bare,
    )
    return Solved(coated, steps, bare, bare_steps)


Measure = Callable[[M, Any], dict[str, float]]
"""p_max_Pa, mises_max_film_Pa and mises_max_substrate_Pa of a model in a state."""


def coated_quantities(solved: Solved[M], peak: Any, measure: Measure[M]) -> dict[str, float | None]:
    """The quantities of a coated scene alone, none of any other. peak: the state that is reported.

    Relative changes are (coated - bare)/bare at equal force; None without a load, or if the bare contact
    did not converge.
    """
    if solved.bare_model is None:
        return {}
    coated = measure(solved.model, peak)
    values: dict[str, float | None] = {
        name: coated[name] for name in ("mises_max_film_Pa", "mises_max_substrate_Pa")
    }
    if not solved.bare_steps or not solved.bare_steps[-1].state.converged:
        return values
    bare = measure(solved.bare_model, solved.bare_steps[-1].state)
    values |= {"p_max_bare_Pa": bare["p_max_Pa"], "mises_max_bare_Pa": bare["mises_max_substrate_Pa"]}
    for change, name in (("p_max_change", "p_max_Pa"), ("mises_max_change", "mises_max_substrate_Pa")):
        values[change] = coated[name] / bare[name] - 1.0 if bare[name] else None
    return values
