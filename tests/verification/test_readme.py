# SPDX-License-Identifier: MIT
"""README.md and the guide have the numbers of the published pages, and get those of others by one command."""

import copy
import json
import re
from pathlib import Path

import pytest
from made_histories import as_the_paper_says
from made_studies import verdicts

from verification.suite.readme import renewed

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def published() -> dict:
    return json.loads((ROOT / "reports" / "results.json").read_text(encoding="utf-8"))


def changed(results, **gates):
    new = copy.deepcopy(results)
    for gate in new["gates"]:
        gate.update(gates.get(gate["id"].replace(".", "_").replace("-", "_"), {}))
    return new


@pytest.mark.parametrize("page", ["README.md", "docs/guide/which-model.md"])
def test_the_numbers_are_those_of_the_published_pages(published, page):
    """Of a report of an older version all but the answer about running-in: its cases have no data."""
    text = (ROOT / page).read_text(encoding="utf-8")
    texts = [renewed(text, published), text]
    if not any("data" in case for case in published["cases"]):
        texts = [
            re.sub(r"\n- \[Does the model of running-in.*?(?=\n<!--)", "", t, flags=re.DOTALL) for t in texts
        ]
    assert texts[0] == texts[1]


def test_failed_gates_are_named_and_counted(published):
    none = copy.deepcopy(published)
    for gate in none["gates"]:
        gate["status"] = "passed" if gate["status"] == "failed" else gate["status"]
    for case in none["cases"]:
        case["status"] = "passed" if case["status"] == "failed" else case["status"]
    assert "Every gate of the published pages holds." in renewed(README, none)
    running_in = next(case for case in none["cases"] if case["name"] == "running-in")
    running_in["data"] = {"statements": {"printed inputs": verdicts([as_the_paper_says()])}}
    one = renewed(README, changed(none, pavement_fox={"status": "failed", "error": 2.0, "tolerance": 1.0}))
    assert "One gate fails on the published pages: `pavement.fox` (2 against \u2264 1)." in one
    assert "Yes. With the inputs that the paper prints, 17 of its 17 statements" in " ".join(one.split())
    next(case for case in none["cases"] if case["name"] == "pavement")["status"] = "failed"
    assert "have a figure that cannot be read: `pavement`." in " ".join(renewed(README, none).split())
