# SPDX-License-Identifier: MIT
"""From a plan to the model of a body that yields, and its load history. Loaded where the elastic stress
yields.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from sam.elastic.problem import ElasticProblem
from sam.elastic.stress import ElasticPeak
from sam.planner.plan import Plan
from sam.plasticity.history import Found, begun, continued, first_box, solve_plastic
from sam.plasticity.load_step import CONTACT_SHARE, Problem
from sam.plasticity.model import Model, YieldingBody
from sam.plasticity.progress import Progressed
from sam.scene.result import Progress

# residual of a contact over the tolerance: the last move of the surface in the paper's loops leaves it
PAPER_SHARE = 1e2


def model_of(plan: Plan, problem: ElasticProblem) -> Model:
    """The model of a body that yields, as a plan has it.

    Parameters
    ----------
    plan
        A plan with plasticity.
    problem
        Its elastic bodies, see `Plan.problem`.

    Returns
    -------
    Model
        What stays the same over the load history.

    Raises
    ------
    ValueError
        For the plan of an elastic body.
    """
    plasticity = plan.plasticity
    if plasticity is None:
        raise ValueError("the plan has no plasticity")
    return Model(
        elastic=problem,
        body=YieldingBody(plan.pair.body, plasticity.strength()),
        schedule=plan.schedule,
        tolerance=plan.solver.tolerance,
        contact_share=CONTACT_SHARE if plan.paper is None else PAPER_SHARE,
        mirrored=_mirrored(plan),
        tribofilm=plan.tribofilm(plan.grid) if plan.tribofilm is not None else None,
        wear=plan.wear(plan.grid) if plan.wear is not None else None,
        roughness=plan.rough.roughness if plan.rough is not None else None,
        make=Problem if plan.paper is None else partial(plan.paper(), stop=plan.solver.stop),
        lengthens=plan.paper is None,
        judging=plan.judging,
        dissipates=plan.dissipates,
        track=plan.track,
        with_back=None if plan.with_back is None else plan.with_back(),
    )


def _mirrored(plan: Plan) -> tuple[bool, bool]:
    """Whether gap and loads are mirrored in x and in y: below a smooth body whose load does not leave the
    apex.

    What the paper's loops do is left as it is.
    """
    even = plan.rough is None and plan.paper is None and plan.slip.uniform
    path = plan.schedule.path
    return even and len(path) == 1, even and all(y == 0 for _, y in path)


def solve_yielding(
    plan: Plan,
    problem: ElasticProblem,
    report: Progress,
    *,
    keep: Callable[[Progressed, int, int], None] | None,
    start: Progressed | None,
    peak: ElasticPeak | None,
) -> Found:
    """The load history of a plan from its beginning, or from a record on.

    peak: of the body if it stayed elastic, which the first box is chosen from.
    """
    model = model_of(plan, problem)
    if start is not None:
        now = continued(model, start)
    elif peak is not None:
        now = begun(model, plan.schedule.targets, first_box(model, peak))
    else:
        raise ValueError("either a record or the elastic peak is needed")
    stop = plan.solver.stop if plan.paper is not None else None
    return solve_plastic(model, now, report, keep=keep, stop=stop)
