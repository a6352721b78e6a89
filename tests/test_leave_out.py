# SPDX-License-Identifier: MIT
"""Nothing is computed or imported that a scene does not need, counted over a ladder of scenes; and the plan says what runs.

PARTS say what a part of a scene needs, and why; RUNGS of which parts a scene consists. What ran (`ladder`) must be the sum of them,
no more and no less: kinds of work, transforms and modules. Independently of that table, what ran must be what
`samfem plan` lists as stages that run, and the rest must be left out with a reason.
"""

from __future__ import annotations

import ast
import json
import os
import subprocess
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pathlib import Path

import ladder
import pytest

from verification import models
from verification.models import FEM, FEM_3D, SAM
from verification.plan import plan

ROOT = Path(__file__).resolve().parent.parent


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
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment)


def finished(process: subprocess.Popen) -> dict[str, dict]:
    out, error = process.communicate()
    assert process.returncode == 0, error
    return json.loads(out)


def needs(model: str, rung: str) -> list[Part]:
    return [PARTS[name if name in PARTS else name.replace("-", " ")] for name in RUNGS[model][rung].split()]


def surprises(model: str, rung: str, ran: dict) -> list[str]:
    """What a solve did that its parts do not need, or did not that they need, in words."""
    parts, work = needs(model, rung), set(ran["work"])
    wanted = {kind for each in parts for kind in each.work}
    allowed = wanted | {kind for each in parts for kind in each.may}
    out = [f"not needed: {kind}" for kind in sorted(work - allowed)] + [
        f"missing: {kind}" for kind in sorted(wanted - work)
    ]
    modules = {name for each in parts for name in each.modules}
    loaded = {name for name in ran["modules"] if optional(model, name)}
    out += [f"not needed: module {name}" for name in sorted(loaded - modules)]
    out += [f"missing: module {name}" for name in sorted(modules - set(ran["modules"]))]
    libraries = {name for each in parts for name in each.libraries}
    out += [f"not needed: library {name}" for name in sorted(set(ran["others"]) - libraries)]
    astray = [kind for kind in sorted(ran["transforms"]) if model != SAM or not kind.startswith(TRANSFORMING)]
    return out + [f"not needed: a transform of {kind or 'no work'}" for kind in astray]


def optional(model: str, name: str) -> bool:
    """Whether a module is one that not every scene needs in this model."""
    packages = name.split(".")
    if packages[0] == "verification" or (packages[0] == "fem_reference") != (model != SAM):
        return not name.startswith("sam.scene")
    return any(".".join(packages[:k]) in EVERY for k in range(1, len(packages) + 1))


# the table


@pytest.mark.parametrize("model, rung", LADDER, ids=[":".join(each) for each in LADDER])
def test_only_what_a_scene_needs_runs(model, rung):
    assert surprises(model, rung, climbed()[f"{model}:{rung}"]) == []


def test_every_part_has_a_reason_and_is_used():
    used = {id(each) for model, rung in LADDER for each in needs(model, rung)}
    assert all(each.reason for each in PARTS.values())
    assert [name for name, each in PARTS.items() if id(each) not in used] == []
    assert set(RUNGS[SAM]) == set(ladder.SCENES)


def test_every_probe_names_something():
    """A function that is renamed or moved must not go unseen."""
    for package, probes in ladder.PROBES.items():
        names = [
            ".".join(path.relative_to(ROOT).with_suffix("").parts) for path in sorted((ROOT / package).rglob("*.py"))
        ]
        defined = [name for module in names for name in functions_of(module)]
        assert [end for end in probes if not any(name.endswith(f".{end}") for name in defined)] == []


def functions_of(module: str) -> list[str]:
    """Full names of what a module defines, __init__ of data classes included."""
    tree = ast.parse((ROOT / (module.replace(".", "/") + ".py")).read_text(encoding="utf-8"))
    out = [f"{module}.{node.name}" for node in tree.body if isinstance(node, ast.FunctionDef)]
    for node in tree.body:
        if isinstance(node, ast.ClassDef):
            out += [f"{module}.{node.name}.{each.name}" for each in node.body if isinstance(each, ast.FunctionDef)]
            out.append(f"{module}.{node.name}.__init__")
    return out


def test_every_influence_coefficient_has_a_probe():
    """Of the semi-analytical model: functions that are named after coefficients, and those of a coated body."""
    found = []
    for module in ("sam.kernels.patches", "sam.kernels.eigenstrain", "sam.layered.patches"):
        found += [name for name in functions_of(module) if name.endswith("_coefficients") or ".LayeredPatches." in name]
    public = [name for name in found if not name.split(".")[-1].startswith("_") and not name.endswith(".response")]
    assert len(public) >= 6
    assert [name for name in public if not any(name.endswith(f".{end}") for end in ladder.PROBES["sam"])] == []


# transforms


def transforms(rung: str, beginning: str = "") -> list[int]:
    """Calls and values of a rung of the semi-analytical model, in kinds of work that begin so."""
    counts = climbed()[f"{SAM}:{rung}"]["transforms"]
    chosen = [count for kind, count in counts.items() if kind.startswith(beginning)]
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
        ("strong", "strong", "plastic"),
        ("plastic, unloaded", "plastic", "stress beside the box"),  # nothing is strained on the way back
        ("plastic, unloaded", "plastic", "u3 beside the box"),
    ],
)
def test_a_rung_that_adds_no_work_adds_no_transform(rung, same, beginning):
    assert transforms(rung, beginning) == transforms(same, beginning)


def test_transforms_that_a_scene_has_no_use_for():
    assert transforms("no force") == [0, 0] and climbed()[f"{SAM}:no force"]["summary"]["cost"]["ffts"] == 0
    assert transforms("given load", "contact search") == transforms("plastic, given load", "contact search") == [0, 0]
    assert transforms("strong", "plastic") == [0, 0]
    assert transforms("coupled", "contact search")[0] > transforms("decoupled", "contact search")[0] > 0
    assert transforms("decoupled", "stress")[0] == 2 * transforms("elastic sphere", "stress")[0]


def test_wear_out_of_reach_costs_nothing():
    """The same work as without [wear] but for its cycles: none of it is of wear."""
    ran = climbed()[f"{SAM}:wear out of reach"]
    assert not {"tearing", "remap"} & set(ran["work"])
    assert all("wear" not in name and "tearing" not in name for name in ran["modules"])


# the plan

def names(text: str) -> set[str]:
    return {each.strip() for each in text.split(",")}


@cache
def planned(model: str, rung: str) -> list[dict]:
    entry = next(each for each in plan(ladder.scene(rung))["models"] if each["model"] == model)
    assert entry["available"], entry["reason"]
    return entry["stages"]


def at_work(model: str, ran: dict) -> set[str]:
    """The stages that ran, by what they do."""
    out = {stage for stage, kinds in STAGES[model].items() if names(kinds) & set(ran["work"])}
    summary = ran["summary"]
    if "unloaded" in summary["states"]:
        out.add("unloading")
    if any(
        cycle > 1 and "equal to cycle 1" not in note
        for cycle, note in zip(summary["cycles"], summary["notes"], strict=True)
    ):
        out.add("cycles after the first")
    if "coated solid" in ran["work"] and "solid" in ran["work"]:
        out.add("bare body")
    return out


@pytest.mark.parametrize("model, rung", LADDER, ids=[":".join(each) for each in LADDER])
def test_the_plan_lists_what_runs_and_the_result_what_was_left_out(model, rung):
    """`samfem plan`, `left_out` of the result and what was counted say the same; an elastic outcome leaves out more."""
    ran, stages = climbed()[f"{model}:{rung}"], planned(model, rung)
    left_out = {stage for stage, _ in ran["summary"]["left_out"]}
    assert at_work(model, ran) == {stage["stage"] for stage in stages if stage["runs"]} - left_out
    unplanned = [
        [stage["stage"], stage["reason"]]
        for stage in stages
        if not stage["runs"] and stage["reason"] != "loading.force is zero: no contact"
    ]
    said = ran["summary"]["left_out"]
    assert [each for each in unplanned if each not in said] == []
    more = [stage for stage, reason in said if [stage, reason] not in unplanned]
    assert set(more) == ({"eigenstrain kernels", "plastic loop"} if rung == "strong" and model == SAM else set())


@pytest.mark.parametrize("model, rung", LADDER, ids=[":".join(each) for each in LADDER])
def test_every_stage_is_run_or_left_out_once_with_a_reason(model, rung):
    stages = planned(model, rung)
    listed = [stage["stage"] for stage in stages]
    assert sorted(listed) == sorted(set(listed))
    assert names(TOLD[model]) - set(listed) == set()
    assert all(stage["reason"] for stage in stages)
    assert all(stage["size"] for stage in stages if stage["runs"] and stage["stage"] not in ("tangential traction",))


@pytest.mark.parametrize("model, rung", LADDER, ids=[":".join(each) for each in LADDER])
def test_stages_are_listed_in_the_order_in_which_they_begin(model, rung):
    """By the first kind of work of each; what decides on yielding takes contact and stresses first, and is not compared."""
    order = list(climbed()[f"{model}:{rung}"]["work"])
    begins = {}
    for stage in (each["stage"] for each in planned(model, rung) if each["runs"] and each["stage"] in STAGES[model]):
        first = [order.index(kind) for kind in names(STAGES[model][stage]) if kind in order]
        if first and stage not in FREE:
            begins[stage] = min(first)
    assert list(begins) == sorted(begins, key=begins.get)


FREE = {
    "elastic peak",
    "tangential kernels",
    "stresses at the output depths",
    "stress outside the plane y = 0",
    "coupling",
    "layered coefficients",
}
FREE |= {"contact search", "given pressure"}


def test_left_out_means_no_mesh_of_the_other_half():
    """Three-dimensional: half of the body where the scene is symmetric to y = 0, the whole of a rough one."""
    for rung, kind in (("elastic sphere", "half"), ("decoupled", "half"), ("rough elastic", "whole")):
        mesh = next(each for each in planned(FEM_3D, rung) if each["stage"] == "mesh")
        assert mesh["reason"].startswith(("half of" if kind == "half" else "the whole"))
        assert f"{kind} block" in climbed()[f"{FEM_3D}:{rung}"]["work"]


# the tests turn red


@pytest.mark.parametrize(
    "model, spoiler, words",
    [
        (SAM, "traction", "not needed: stress under F1"),
        (SAM, "transform", "not needed: a transform of no work"),
        (SAM, "layers", "not needed: module sam.layered.patches"),
        (SAM, "pictures", "not needed: library matplotlib"),
        (FEM, "history", "not needed: return map"),
    ],
)
def test_a_stage_that_runs_wrongly_is_seen(model, spoiler, words):
    ran = spoilt()[f"{model}:elastic sphere:{spoiler}"]
    assert words in surprises(model, "elastic sphere", ran)
    runs = {stage["stage"] for stage in planned(model, "elastic sphere") if stage["runs"]}
    if spoiler in ("traction", "history"):
        assert at_work(model, ran) > runs


@cache
def spoilt() -> dict[str, dict]:
    return finished(run(f"{FEM if name == 'history' else SAM}:elastic sphere:{name}" for name in ladder.SPOILERS))


def test_a_stage_that_is_not_planned_or_not_run_is_seen():
    ran = climbed()[f"{SAM}:decoupled"]
    assert "not needed: stress under F1" in surprises(SAM, "elastic sphere", ran)
    assert "missing: stress under F1" in surprises(SAM, "decoupled", climbed()[f"{SAM}:elastic sphere"])
    assert "missing: module sam.plastic.run" in surprises(SAM, "plastic", climbed()[f"{SAM}:strong"])


def test_left_out_of_a_model_is_what_the_plan_says():
    for model, rung in LADDER:
        left = [(entry.stage, entry.reason) for entry in models.left_out(ladder.scene(rung), model)]
        assert set(left) <= {(stage["stage"], stage["reason"]) for stage in planned(model, rung) if not stage["runs"]}


