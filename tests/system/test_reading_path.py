# SPDX-License-Identifier: MIT
"""The reading path of docs/architecture.md: its files exist, hold what it names, and are short; and what is
read first, that a solve checks, plans and estimates a scene once, is so.
"""

import re
import sys
from collections import Counter
from pathlib import Path

import pytest
from builders import SWIFT, scene

import sam
from sam.half_space import circular_contact_radius
from sam.planner import bodies, make, stages

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
MOST = 2800


def path(page: str) -> dict[str, list[str]]:
    """File -> the names that are to be read in it."""
    section = page.split("### A reading path")[1].split("\n## ")[0]
    rows = re.findall(r"^\| `([^`]+)` \| (.+) \|$", section, re.MULTILINE)
    return {file: re.findall(r"`([^`]+)`", words) for file, words in rows}


def lines(file: str) -> int:
    return len((ROOT / file).read_text(encoding="utf-8").splitlines())


def test_the_path_is_short_and_leads_from_the_solver_to_the_kernels():
    files = list(path(PAGE))
    assert files[0] == "sam/solver.py" and files[-1].startswith("sam/kernels/")
    assert 1000 < sum(map(lines, files)) <= MOST


def test_each_file_defines_what_is_to_be_read_in_it():
    for file, names in path(PAGE).items():
        source = (ROOT / file).read_text(encoding="utf-8")
        assert (
            names
            and [
                name
                for name in names
                for part in name.split(".")
                if not re.search(rf"^ *(def|class) {part}\b", source, re.MULTILINE)
            ]
            == []
        ), file


ONCE = (make.check_bodies, make.plan_of, make.schedule_of, stages.stages_of, bodies._by_hertz)


@pytest.mark.parametrize("body", [{}, {"plasticity": SWIFT}], ids=["elastic", "plastic"])
def test_a_solve_checks_plans_and_estimates_a_scene_once(body):
    names = {function.__code__: function.__name__ for function in (*ONCE, circular_contact_radius)}
    calls = Counter()

    def count(frame, event, _argument):
        if event == "call" and frame.f_code in names:
            calls[names[frame.f_code]] += 1

    a_scene = scene(body=body, loading={"force": 0.05}, grid={"cells": (9, 9)}, solver={"tolerance": 1e-3})
    sys.setprofile(count)
    try:
        sam.solve(a_scene)
    finally:
        sys.setprofile(None)
    assert calls == dict.fromkeys(names.values(), 1)
