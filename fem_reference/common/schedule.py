# SPDX-License-Identifier: MIT
"""The load steps of a scene with its checkpoints; of a coated one also those of the bare contact on the same mesh.

The bare contact, for comparison, follows the same steps up to the last peak if the body can yield; of an elastic one the peak
is enough. It comes after the coated one, and a checkpoint holds both.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from fem_reference.common.contact import Equilibrium
from fem_reference.common.loading import AT_REST, Model, Progressed, Sliding, Step, Target, all_targets, run
from sam.scene import Loading, Scene
from sam.scene.checkpoint import Checkpoint
from sam.scene.result import Progress


@dataclass(frozen=True)
class Pair:
    """The schedule of the coated contact and that of the bare one; None: not begun."""

    coated: Progressed | None = None
    bare: Progressed | None = None

    @classmethod
    def from_tree(cls, tree: dict) -> Pair:
        """From the tree of a checkpoint, see `sam.scene.checkpoint`."""
        return cls(*(part and Progressed.from_tree(part) for part in (tree["coated"], tree["bare"])))


@dataclass(frozen=True)
class Solved:
    """The steps of a scene; of a coated one the model of the bare contact and its steps, none if the coated one failed."""

    steps: list[Step]
    bare_model: Model | None = None
    bare_steps: list[Step] = field(default_factory=list)

    @property
    def all_steps(self) -> list[Step]:
        return self.steps + self.bare_steps


def solve_steps(
    scene: Scene,
    model: Model,
    build_bare: Callable[[], Model],
    progress: Progress | None,
    keep: Callable[[object, int, int], None] | None,
    start: Checkpoint | None,
    sliding: Sliding = AT_REST,
) -> Solved:
    """All steps of `model`, and for a coated scene those of the bare one.

    keep: called with a record, the steps done and those in all, after each step of a body that can yield.
    """
    if scene.body.coating is None:

        def kept(now: Progressed) -> None:
            keep(now, len(now.steps), len(now.steps) + len(now.targets))

        begin = Progressed.from_tree(start.tree()) if start else None
        return Solved(run(model, scene.loading, progress, keep and kept, begin, sliding))
    bare = build_bare()
    begin = Pair.from_tree(start.tree()) if start else Pair()
    return Solved(*_pair(model, bare, scene.loading, progress, keep, begin, sliding))


def _pair(
    coated: Model,
    bare: Model,
    loading: Loading,
    progress: Progress | None,
    keep: Callable[[object, int, int], None] | None,
    begin: Pair,
    sliding: Sliding,
) -> tuple[list[Step], Model, list[Step]]:
    targets = to_peak(bare, loading, sliding)
    before, after = (
        sum(not t.unloads for t in each) for each in (all_targets(coated, loading, sliding), targets)
    )

    def counted(first: int, last: int) -> Progress | None:
        return progress and (lambda stage, done, total: progress(stage, first + done, first + total + last))

    def keep_coated(now: Progressed) -> None:
        keep(Pair(now), len(now.steps), len(now.steps) + len(now.targets) + len(targets))

    def keep_bare(now: Progressed) -> None:
        done = len(steps) + len(now.steps)
        keep(Pair(finished, now), done, done + len(now.targets))

    steps = run(coated, loading, counted(0, after), keep and keep_coated, begin.coated, sliding)
    if not steps[-1].state.converged:
        return steps, bare, []
    finished = Progressed(coated.virgin(), [], steps)
    once = loading.model_copy(update={"cycles": 1})  # all its targets are given
    start = begin.bare or Progressed(bare.virgin(), targets)
    return steps, bare, run(bare, once, counted(before, 0), keep and keep_bare, start, sliding)


def to_peak(model: Model, loading: Loading, sliding: Sliding = AT_REST) -> list[Target]:
    """The targets of the bare contact."""
    targets = all_targets(model, loading, sliding)
    last = max(i for i, target in enumerate(targets) if not target.unloads)
    return targets[last : last + 1] if model.elastic else targets[: last + 1]


Measure = Callable[[Model, Equilibrium], dict[str, float]]
"""p_max_Pa, mises_max_film_Pa and mises_max_substrate_Pa of a state."""


def coated_quantities(
    solved: Solved, model: Model, peak: Equilibrium, measure: Measure
) -> dict[str, float | None]:
    """The quantities of a coated scene alone, none of any other.

    Relative changes are (coated - bare)/bare at equal force; None without a load, or if the bare contact did not converge.
    """
    if solved.bare_model is None:
        return {}
    coated = measure(model, peak)
    values = {name: coated[name] for name in ("mises_max_film_Pa", "mises_max_substrate_Pa")}
    if not solved.bare_steps or not solved.bare_steps[-1].state.converged:
        return values
    bare = measure(solved.bare_model, solved.bare_steps[-1].state)
    values |= {"p_max_bare_Pa": bare["p_max_Pa"], "mises_max_bare_Pa": bare["mises_max_substrate_Pa"]}
    for change, name in (("p_max_change", "p_max_Pa"), ("mises_max_change", "mises_max_substrate_Pa")):
        values[change] = coated[name] / bare[name] - 1.0 if bare[name] else None
    return values
