# SPDX-License-Identifier: MIT
"""Nothing is computed or imported that a scene does not need, counted over a ladder of scenes; and the plan
says what runs.

What ran (`ladder`) must be what the stages of the plan need that run (`ladder_needs`), no more and no less:
kinds of work, transforms and modules. The rest is left out with a reason, and `samfem plan` prints the same.
"""

import ast
import json
import os
import subprocess
import sys
from collections.abc import Iterable
from functools import cache
from pathlib import Path

import ladder
import pytest
from ladder_needs import LADDER, NAMED, NEEDS, OPTIONAL, TOLD, TRANSFORMING, Part, names

from sam.scene.result import NO_FORCE
from verification.cost.plan import plan as printed_plan
from verification.runs import models
from verification.runs.models import FEM, FEM_3D, SAM

ROOT = Path(__file__).resolve().parents[2]
every_rung = pytest.mark.parametrize("model, rung", LADDER, ids=[":".join(each) for each in LADDER])


@cache
def climbed() -> dict[str, dict]:
    """What ran, by "model:rung": all rungs in two processes at once."""
    names = [f"{model}:{rung}" for model, rung in LADDER]
    parts = [run(names[first::2]) for first in (0, 1)]
    return {name: ran for each in parts for name, ran in finished(each).items()}


def run(names: Iterable[str]) -> subprocess.Popen:
    """A process of `ladder`, with one thread."""
    environment = os.environ | dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
    command = [sys.executable, str(ROOT / "tests" / "ladder.py"), *names]
    return subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment
    )


def finished(process: subprocess.Popen) -> dict[str, dict]:
    out, error = process.communicate()
    assert process.returncode == 0, error
    return json.loads(out)


def ran_in(model: str, rung: str) -> dict:
    return climbed()[f"{model}:{rung}"]


@cache
def planned(model: str, rung: str):
    """The plan of a rung; nothing is solved."""
    return models.plan(ladder.scene(rung), model)


def running(model: str, rung: str) -> frozenset[str]:
    """What the plan runs: its stages, and what it says of them beside."""
    plan = planned(model, rung)
    said = {stage.stage for stage in plan.stages if stage.runs}
    other = ladder.scene(rung).counterbody
    said |= {"rounded edge"} if other is not None and other.shape == "rounded-punch" else set()
    if model == SAM:
        said |= {"loops of the paper"} if plan.paper else set()
        said |= {"coupling = false"} if not plan.slip.coupled else set()
    return frozenset(said)


def at_work(model: str, rung: str, ran: dict) -> frozenset[str]:
    """What the plan runs, but what the solve itself found that it may leave out."""
    return running(model, rung) - {stage for stage, _ in ran["summary"]["left_out"]}


def needs(model: str, runs: frozenset[str]) -> list[Part]:
    """What stages that run need."""
    return [each for key, each in NEEDS[model].items() if applies(key, runs)]


def known(model: str) -> set[str]:
    """The stages of which something is needed, or which the result tells of."""
    named = {name.removeprefix("not ") for key in NEEDS[model] for name in names(key)}
    return named | {"unloading", "cycles after the first"}


def applies(key: str, runs: frozenset[str]) -> bool:
    """Whether all stages of a key run, and none of those after "not"."""
    return all((name.removeprefix("not ") in runs) != name.startswith("not ") for name in names(key))


def surprises(model: str, runs: frozenset[str], ran: dict) -> list[str]:
    """What a solve did that the stages do not need, or did not that they need, in words."""
    parts, work, summary = needs(model, runs), set(ran["work"]), ran["summary"]
    wanted = {kind for each in parts for kind in each.work}
    allowed = wanted | {kind for each in parts for kind in each.may}
    out = [f"not needed: {kind}" for kind in sorted(work - allowed)]
    out += [f"missing: {kind}" for kind in sorted(wanted - work)]
    modules = {name for each in parts for name in each.modules}
    loaded = {alias(name) for name in ran["modules"] if optional(model, name)}
    out += [f"not needed: module {name}" for name in sorted(loaded - modules)]
    out += [f"missing: module {name}" for name in sorted(modules - loaded)]
    libraries = {name for each in parts for name in each.libraries}
    out += [f"not needed: library {name}" for name in sorted(set(ran["others"]) - libraries)]
    astray = [kind for kind in sorted(ran["transforms"]) if model != SAM or not kind.startswith(TRANSFORMING)]
    out += [f"not needed: a transform of {kind or 'no work'}" for kind in astray]
    later = [note for cycle, note in zip(summary["cycles"], summary["notes"], strict=True) if cycle > 1]
    told = {
        "unloading": "unloaded" in summary["states"],
        "cycles after the first": any("equal to cycle 1" not in note for note in later),
    }
    return out + [f"not as planned: {stage}" for stage, found in told.items() if found != (stage in runs)]


def alias(name: str) -> str:
    """A module as the parts name it: itself, or all of its package."""
    if name in NAMED:
        return name
    ends = (f"{package}.*" for package in (name, name.rpartition(".")[0]))
    return next((each for each in ends if each in NAMED), name)


def optional(model: str, name: str) -> bool:
    """Whether a module is one that not every scene needs in this model."""
    own = name.split(".")[0] == ("sam" if model == SAM else "fem_reference")
    return (
        f"{name}.".startswith(tuple(f"{each}." for each in OPTIONAL))
        if own
        else not name.startswith("sam.scene")
    )


# the table


@every_rung
def test_what_the_plan_needs_runs_and_nothing_else(model, rung):
    ran = ran_in(model, rung)
    assert surprises(model, at_work(model, rung, ran), ran) == []


@every_rung
def test_a_plan_with_a_stage_more_or_less_is_not_what_ran(model, rung):
    ran = ran_in(model, rung)
    runs = at_work(model, rung, ran)
    stages = {stage.stage for stage in planned(model, rung).stages} & known(model)
    assert [name for name in sorted(stages) if not surprises(model, runs ^ {name}, ran)] == []


def test_every_need_is_used_and_every_stage_that_runs_is_known():
    runs = {(model, rung): running(model, rung) for model, rung in LADDER}
    for model, table in NEEDS.items():
        of_model = [each for (name, _), each in runs.items() if name == model]
        assert [key for key in table if not any(applies(key, each) for each in of_model)] == []
        assert frozenset().union(*of_model) <= known(model)


def test_every_probe_names_something():
    """A function that is renamed or moved must not go unseen."""
    for package, probes in ladder.PROBES.items():
        files = [path.relative_to(ROOT).with_suffix("") for path in sorted((ROOT / package).rglob("*.py"))]
        defined = [name for file in files for name in functions_of(".".join(file.parts))]
        assert [end for end in probes if not any(name.endswith(f".{end}") for name in defined)] == []


def functions_of(module: str) -> list[str]:
    """Full names of what a module defines, __init__ of data classes included."""
    body = ast.parse((ROOT / (module.replace(".", "/") + ".py")).read_text(encoding="utf-8")).body
    out = [f"{module}.{node.name}" for node in body if isinstance(node, ast.FunctionDef)]
    for node in body:
        if isinstance(node, ast.ClassDef):
            out += [
                f"{module}.{node.name}.{each.name}" for each in node.body if isinstance(each, ast.FunctionDef)
            ]
            out.append(f"{module}.{node.name}.__init__")
    return out


def test_every_influence_coefficient_has_a_probe():
    """Of the semi-analytical model: public functions that are named after coefficients, and methods of a
    coated body.
    """
    found = []
    for module in (
        "sam.kernels.patches",
        "sam.kernels.eigenstrain",
        "sam.kernels.layer_stress",
        "sam.layered.patches",
    ):
        found += [
            name
            for name in functions_of(module)
            if name.endswith("_coefficients") or ".LayeredPatches." in name
        ]
    public = {name for name in found if "._" not in name} - {
        f"sam.layered.patches.LayeredPatches.{name}" for name in ("response", "surface_response")
    }
    assert len(public) == 6
    assert [
        name for name in public if not any(name.endswith(f".{end}") for end in ladder.PROBES["sam"])
    ] == []


# how much of it


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
    assert transforms("no force") == [0, 0] and ran_in(SAM, "no force")["summary"]["cost"]["ffts"] == 0
    assert (
        transforms("given load", "contact search")
        == transforms("plastic, given load", "contact search")
        == [0, 0]
    )
    assert transforms("strong", "plastic") == [0, 0]
    assert (
        transforms("coupled", "contact search")[0] > transforms("decoupled", "contact search")[0] == 0
    )  # a mirrored quarter
    assert transforms("decoupled", "stress")[0] == 2 * transforms("elastic sphere", "stress")[0] > 0


def test_stresses_are_evaluated_once_for_a_state():
    """Of an elastic scene that is unloaded at its peak, and the zeros after it: coefficients of every depth
    once.
    """
    depths = ran_in(SAM, "unloaded")["summary"]["discretisation"]["depths"]
    ran = ran_in(SAM, "unloaded")["work"]
    assert ran["stress in y = 0"][0] == 2
    assert ran["stress under F3"] == ran_in(SAM, "elastic sphere")["work"]["stress under F3"]
    assert ran["stress under F3"][1] % (6 * depths) == 0


@pytest.mark.parametrize("rung", ["plastic", "plastic, coupled", "rough plastic", "chemical film"])
def test_the_elastic_peak_is_solved_once(rung):
    """One elastic solution says whether a body yields, and where plastic strain is first looked for; others
    are states.
    """
    ran, states = ran_in(SAM, rung)["work"], len(ran_in(SAM, rung)["summary"]["states"])
    passes = ran["stress in y = 0"][0] + ran.get("stress outside y = 0", [0])[0]
    assert passes == 1 + states


# the plan


@every_rung
def test_the_printed_plan_and_the_result_say_what_is_left_out(model, rung):
    """The plan, what is printed of it and the result say the same; an elastic outcome leaves out more."""
    entry = next(each for each in printed_plan(ladder.scene(rung))["models"] if each["model"] == model)
    assert entry["available"], entry["reason"]
    stages = planned(model, rung).stages
    printed = {(stage["stage"], stage["reason"], stage["runs"]) for stage in entry["stages"]}
    assert printed == {(stage.stage, stage.reason, stage.runs) for stage in stages}
    said = {(stage, reason) for stage, reason in ran_in(model, rung)["summary"]["left_out"]}
    idle = {(each.stage, each.reason) for each in stages if not each.runs and each.reason != NO_FORCE}
    more = {"eigenstrain kernels", "plastic loop"} if (model, rung) == (SAM, "strong") else set()
    assert idle <= said
    assert {stage for stage, _ in said - idle} == more


@every_rung
def test_every_stage_is_run_or_left_out_once_with_a_reason(model, rung):
    stages = planned(model, rung).stages
    listed = [stage.stage for stage in stages]
    assert len(listed) == len(set(listed))
    assert names(TOLD[model]) <= set(listed)
    assert all(stage.reason for stage in stages)
    unsized = {
        "tangential traction",
        "eigenstrain kernels",
    }  # the size of the latter: `samfem plan` predicts it
    assert all(stage.size for stage in stages if stage.runs and stage.stage not in unsized)


@every_rung
def test_stages_are_listed_in_the_order_in_which_they_begin(model, rung):
    """By their first work. Coupling begins with the contact, a bare body is made with the coated
    one, stresses anywhere hold those of y = 0, and where a body may yield its elastic peak does most of the
    others, and a film is tested with stresses at z = 0. Finite elements measure a track at the end.
    """
    order, begins = list(ran_in(model, rung)["work"]), {}
    runs = [stage.stage for stage in planned(model, rung).stages if stage.runs]
    applying = [key for key in NEEDS[model] if applies(key, running(model, rung))]
    free = {"coupling", "stress outside the plane y = 0", "bare body"}
    free |= {"moving counter-body"} if model == FEM_3D else set()
    if {"elastic peak", "chemical film"} & set(runs):
        free |= {
            "elastic peak",
            "contact search",
            "given pressure",
            "moving counter-body",
            "tangential kernels",
            "surface coefficients",
        }
        free |= {stage for stage in runs if stage.startswith("stress")}
    for stage in runs:
        own = [NEEDS[model][key] for key in applying if key.split(", ")[0] == stage]
        first = [order.index(kind) for need in own for kind in {need.first} | need.may if kind in order]
        if first and stage not in free:
            begins[stage] = min(first)
    assert list(begins) == sorted(begins, key=begins.get)


@pytest.mark.parametrize(
    "rung, part", [("elastic sphere", "half"), ("decoupled", "half"), ("rough elastic", "whole")]
)
def test_half_of_the_body_is_left_out_where_the_scene_is_symmetric(rung, part):
    mesh = next(each for each in planned(FEM_3D, rung).stages if each.stage == "mesh")
    assert f"{part} " in mesh.reason
    assert f"{part} block" in ran_in(FEM_3D, rung)["work"]


# these tests turn red


@cache
def spoilt() -> dict[str, dict]:
    """What runs when something runs that must not, by "model:rung:spoiler"."""
    return finished(
        run(f"{FEM if name == 'history' else SAM}:elastic sphere:{name}" for name in ladder.SPOILERS)
    )


@pytest.mark.parametrize(
    "model, spoiler, words",
    [
        (SAM, "traction", "not needed: stress under F1"),
        (SAM, "transform", "not needed: a transform of no work"),
        (SAM, "pictures", "not needed: library matplotlib"),
        (FEM, "history", "not needed: return map"),
    ],
)
def test_what_runs_wrongly_is_seen(model, spoiler, words):
    ran = spoilt()[f"{model}:elastic sphere:{spoiler}"]
    assert words in surprises(model, running(model, "elastic sphere"), ran)


def test_what_does_not_run_is_seen():
    elastic = ran_in(SAM, "elastic sphere")
    assert "missing: stress under F1" in surprises(SAM, running(SAM, "decoupled"), elastic)
    plastic = surprises(SAM, running(SAM, "plastic"), ran_in(SAM, "strong"))
    assert "missing: plastic step" in plastic
