# SPDX-License-Identifier: MIT
"""Nothing is computed that a scene does not need, counted over a ladder of scenes; and the plan
says what runs.

What ran (`ladder`) must be what the stages of the plan need that run (NEEDS), no more and no less.
The rest is left out with a reason, and `samfem plan` prints the same.
"""

import re
from functools import cache
from pathlib import Path

import ladder
import pytest
from ladder import SCENES

from sam.scene.result import NO_FORCE
from verification.cost.plan import plan as printed_plan
from verification.runs import models
from verification.runs.models import FEM, FEM_3D, SAM

KERNELS = sorted(Path(__file__).parents[2].glob("sam/kernels/*.py"))
IN_BOX = "residual stress, u3 of plastic strain, stress beside the box"
OUTSIDE = "stress outside the plane y = 0"
RETURN_MAP = "return mapping and plastic history"
STRESSES, TRACTION = "stresses at the output depths", "tangential kernels"
OF_LAYERS = "layered u3 under F1, layered stress under F1, layered u1 under F3, layered u1 under F1"
OF_TRACTION = "stress under F1, u1 under F3 in y = 0, u1 under F1 in y = 0, u1 under F3, u1 under F1"
OF_ELEMENTS = {
    "film elements": "coated solid, layered far field",
    "not film elements": "solid",
    "bare body": "solid",
    "contact search": "contact search",
    "given pressure": "given pressure, forces of a given pressure",
    RETURN_MAP: "return map, plastic history",
    f"{RETURN_MAP}, unloading": "unloading by Newton",
}
NEEDS: dict[str, dict[str, str]] = {
    SAM: {
        "grid, not volume grid": "grid",
        "grid, rounded edge": "gap of a rounded edge",
        "volume grid": "volume grid",
        "surface heights": "heights",
        "counter-surface heights": "counter heights",
        "surface coefficients": "u3 under F3 | layered u3 under F3",
        "layered coefficients": "layered u3 under F3, layered stress under F3, layered body",
        f"layered coefficients, {TRACTION}": OF_LAYERS,
        "coupling": "u3 under F1, its traction",
        "contact search": "contact search, surface displacement",
        "given pressure": "given pressure | surface displacement",
        "moving counter-body": "motion of the counter-body",
        "misfit strain": "displacement by a misfit strain",
        f"misfit strain, {STRESSES}": "stress of a misfit strain",
        "elastic peak": "yield stress",
        "eigenstrain kernels": f"plastic box, {IN_BOX} | u3 beside the box, shear across y",
        f"eigenstrain kernels, {TRACTION}": "sliding plastic box, u1 beside the box, u1 of plastic strain",
        "plastic loop": "plastic step",
        "plastic loop, loops of the paper": "loops of the paper",
        "back-stresses": "return map with back-stresses",
        "verdict on repeated loading": "verdict",
        "chemical film": "film law",
        "worn geometry": "removal, remap",
        f"{STRESSES}, not misfit strain": "stress under F3 | layered stress under F3",
        f"{STRESSES}, not {OUTSIDE}": "stress in y = 0",
        f"not {STRESSES}": "| stress in y = 0",
        OUTSIDE: "stress outside y = 0 | stress in y = 0, shear across y",
        TRACTION: f"{OF_TRACTION} | layered stress under F1",
        # the traction moves no gap, but it moves the body: u_z in y = 0
        f"not coupling, not coupling = false, {TRACTION}": "u3 under F1 | u3 under F1 in y = 0",
        "bare comparison": "bare comparison",
    },
    FEM: OF_ELEMENTS
    | {
        "mesh": "plane mesh",
        "mesh, not mesh of the counter-body": "one body",
        "mesh of the counter-body": "two bodies",
        "mesh, rounded edge": "lines of a rounded edge",
        "misfit strain": "misfit strain | given pressure",
        "back-stresses": "return map with back-stresses",
        "verdict on repeated loading": "verdict",
        "stresses at the Gauss points": "stresses",
    },
    FEM_3D: OF_ELEMENTS
    | {
        "mesh, not surface heights, not counter-surface heights": "half block",
        "mesh, surface heights": "whole block",
        "mesh, counter-surface heights": "whole block",
        "surface heights": "heights",
        "counter-surface heights": "counter heights | heights",
        "tangential traction": "slipping step, tangential far field",
        "not tangential traction": "step without slip",
        "moving counter-body": "motion of the counter-body",
        "stresses in the elements": "stresses",
    },
}
"""Of each model: stages of a plan, those that it must not have after "not" -> kinds of work (see
ladder.PROBES) that they need together, and after the bar those that the program is free to do without.
"""
OF_FEM = """elastic sphere; unloaded; cycles; elastic counter-body; rounded edge; no friction after all;
no force; coated; given load; plastic; back-stresses; plastic, unloaded; plastic cycles;
plastic, given load; moved; moved, coated; moved, plastic; misfit, plastic"""
OF_FEM_3D = """elastic sphere; decoupled; elastic, alternating; coated; given load, sliding; plastic;
rough elastic; rough counter-body; moved; moved, rough; moving; moving, plastic; moving, rough"""
RUNGS = {SAM: list(SCENES)} | {
    model: text.replace("\n", " ").split("; ") for model, text in ((FEM, OF_FEM), (FEM_3D, OF_FEM_3D))
}
LADDER = [(model, rung) for model, rungs in RUNGS.items() for rung in rungs]
"""The scenes that each model solves."""
TRANSFORMING = (
    *("contact search", "surface displacement", "stress", "u1", "u3", "layered", "plastic"),
    "sliding plastic",
)
"""Beginnings of the kinds of work that transform; the finite-element models do not."""
ALWAYS = {RETURN_MAP, "film elements", "tangential traction", "worn geometry", "unloading"}
TOLD = {
    SAM: {"surface heights", "volume grid", "layered coefficients", "eigenstrain kernels", "plastic loop"}
    | {"chemical film", "worn geometry", OUTSIDE, TRACTION, "unloading"},
    FEM: ALWAYS,
    FEM_3D: ALWAYS,
}
"""Stages of each model that a user is told of in any case: run, or left out and why."""
every_rung = pytest.mark.parametrize("model, rung", LADDER, ids=[":".join(each) for each in LADDER])


climbed = cache(lambda: ladder.climb(LADDER))


def ran_in(model: str, rung: str) -> dict:
    return climbed()[model, rung]


@cache
def planned(model: str, rung: str):
    """The plan of a rung; nothing is solved."""
    return models.plan(ladder.scene(rung), model)


def running(model: str, rung: str) -> frozenset[str]:
    """What the plan runs: its stages, and what it says of them beside."""
    plan, other = planned(model, rung), ladder.scene(rung).counterbody
    said = {stage.stage for stage in plan.stages if stage.runs}
    said |= {"rounded edge"} if other is not None and other.shape == "rounded-punch" else set()
    if model == SAM:
        said |= {"loops of the paper"} if plan.paper else set()
        said |= {"coupling = false"} if not plan.slip.coupled else set()
    return frozenset(said)


def known(model: str) -> set[str]:
    """The stages of which something is needed, or which the result tells of."""
    named = {name.removeprefix("not ") for key in NEEDS[model] for name in key.split(", ")}
    return named | {"unloading", "cycles after the first"}


def applies(key: str, runs: frozenset[str]) -> bool:
    """Whether all stages of a key run, and none of those after "not"."""
    return all((name.removeprefix("not ") in runs) != name.startswith("not ") for name in key.split(", "))


def surprises(model: str, runs: frozenset[str], ran: dict) -> list[str]:
    """What a solve did that the stages do not need, or did not that they need, in words."""
    wanted, allowed = set(), set()
    for text in (each for key, each in NEEDS[model].items() if applies(key, runs)):
        work, may = (set(filter(None, part.strip().split(", "))) for part in (text + "|").split("|")[:2])
        wanted, allowed = wanted | work, allowed | work | may
    out = [f"not needed: {kind}" for kind in sorted(set(ran["work"]) - allowed)]
    out += [f"missing: {kind}" for kind in sorted(wanted - set(ran["work"]))]
    astray = [kind for kind in sorted(ran["transforms"]) if model != SAM or not kind.startswith(TRANSFORMING)]
    out += [f"not needed: a transform of {kind or 'no work'}" for kind in astray]
    later = [note for cycle, note in zip(ran["cycles"], ran["notes"], strict=True) if cycle > 1]
    told = {"unloading": "unloaded" in ran["states"]}
    told["cycles after the first"] = any("equal to cycle 1" not in note for note in later)
    return out + [f"not as planned: {stage}" for stage, found in told.items() if found != (stage in runs)]


@every_rung
def test_what_the_plan_needs_runs_and_nothing_else(model, rung):
    """But what the solve itself found that it may leave out."""
    ran = ran_in(model, rung)
    assert surprises(model, running(model, rung) - {stage for stage, _ in ran["left_out"]}, ran) == []


def test_every_need_is_used_and_every_stage_that_runs_is_known():
    for model, table in NEEDS.items():
        runs = [running(model, rung) for rung in RUNGS[model]]
        assert [key for key in table if not any(applies(key, each) for each in runs)] == []
        assert frozenset().union(*runs) <= known(model)


def test_every_probe_names_something_and_every_influence_coefficient_has_a_probe():
    """A function that is renamed or moved must not go unseen. Coefficients are functions named so."""
    wrapped = {end for ran in climbed().values() for end in ran["wrapped"]}
    assert wrapped == {end for probes in ladder.PROBES.values() for end in probes}
    names = re.findall(r"(?m)^def ([a-z]\w*_coefficients)\(", "".join(map(Path.read_text, KERNELS)))
    assert len(names) == 4 and all(any(end.endswith(name) for end in wrapped) for name in names)


def transforms(rung: str, beginning: str = "") -> list[int]:
    """Calls and values of a rung of the semi-analytical model, in kinds of work that begin so."""
    chosen = [count for kind, count in ran_in(SAM, rung)["transforms"].items() if kind.startswith(beginning)]
    return [sum(each) for each in zip(*chosen, strict=True)] if chosen else [0, 0]


@pytest.mark.parametrize(
    "rung, same, beginning",
    [
        ("unloaded", "elastic sphere", ""),  # elastic unloading is known
        ("cycles", "elastic sphere", ""),  # so are further cycles
        ("no friction after all", "elastic sphere", ""),
        ("decoupled", "elastic sphere", "contact search"),  # what moves no gap costs the contact nothing
        ("like bodies", "elastic counter-body", "contact search"),
        ("rough elastic, sliding", "rough elastic", "contact search"),
        ("elastic, alternating", "coupled", ""),  # cycles are mirror images
        ("plastic, unloaded", "plastic", "stress beside the box"),  # nothing is strained on the way back
        ("plastic, unloaded", "plastic", "u3 beside the box"),
    ],
)
def test_a_rung_that_adds_no_work_adds_no_transform(rung, same, beginning):
    assert transforms(rung, beginning) == transforms(same, beginning)


def test_transforms_that_a_scene_has_no_use_for():
    assert transforms("no force") == [0, 0] and ran_in(SAM, "no force")["ffts"] == 0
    for rung in ("given load", "plastic, given load", "decoupled"):  # the last finds it on a mirrored quarter
        assert transforms(rung, "contact search")[0] == 0
    assert transforms("strong", "plastic") == [0, 0] and transforms("coupled", "contact search")[0] > 0
    assert transforms("decoupled", "stress")[0] == 2 * transforms("elastic sphere", "stress")[0] > 0


def test_stresses_are_evaluated_once_for_a_state_and_the_elastic_peak_is_solved_once():
    """Of an elastic scene that is unloaded at its peak, and the zeros after it: coefficients of every depth
    once. One elastic solution says whether a body yields, and where plastic strain is first looked for.
    """
    ran = ran_in(SAM, "unloaded")
    assert ran["work"]["stress in y = 0"][0] == 2
    assert ran["work"]["stress under F3"] == ran_in(SAM, "elastic sphere")["work"]["stress under F3"]
    assert ran["work"]["stress under F3"][1] % (6 * ran["depths"]) == 0
    for rung in ("plastic", "plastic, coupled", "rough plastic", "chemical film"):
        ran = ran_in(SAM, rung)
        passes = [ran["work"].get(f"stress {where} y = 0", [0])[0] for where in ("in", "outside")]
        assert sum(passes) == 1 + len(ran["states"])


@every_rung
def test_the_plan_the_printed_plan_and_the_result_say_what_is_left_out(model, rung):
    """Every stage once and with a reason; an elastic outcome leaves out more."""
    stages = planned(model, rung).stages
    listed = [stage.stage for stage in stages]
    assert len(listed) == len(set(listed)) and set(listed) >= TOLD[model]
    assert all(stage.reason for stage in stages)
    unsized = {"tangential traction", "eigenstrain kernels"}  # of the latter `samfem plan` predicts the size
    assert all(stage.size for stage in stages if stage.runs and stage.stage not in unsized)
    shown = printed_plan(ladder.scene(rung)).content["models"]
    (entry,) = (each for each in shown if each["model"] == model)
    assert entry["available"], entry["reason"]
    printed = {(stage["stage"], stage["reason"], stage["runs"]) for stage in entry["stages"]}
    assert printed == {(stage.stage, stage.reason, stage.runs) for stage in stages}
    said = set(ran_in(model, rung)["left_out"])
    idle = {(each.stage, each.reason) for each in stages if not each.runs and each.reason != NO_FORCE}
    more = {"eigenstrain kernels", "plastic loop"} if (model, rung) == (SAM, "strong") else set()
    assert idle <= said and {stage for stage, _ in said - idle} == more
