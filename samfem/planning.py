# SPDX-License-Identifier: MIT
"""The command plan: what a scene will compute, what is left out, and what that takes."""

from __future__ import annotations

from pathlib import Path

from sam.scene import read_scene
from verification.cost import plan as plan_of
from verification.runs.files import json_text
from verification.runs.model_range import refusal
from verification.runs.models import ModelError
from verification.text.console import print_table


def plan(path: Path, as_json: bool) -> int:
    """Print what the scene will compute. Raises ModelError for a contact beyond the range of every model."""
    scene, _ = read_scene(path)
    if reason := refusal(scene):
        raise ModelError(reason)
    content = plan_of.plan(scene)
    if as_json:
        print(json_text(content).rstrip())
        return 0
    print("\n".join(plan_of.advice_lines(content)))
    table = content["advice"]["table"]
    if table["rows"]:
        print_table(table["columns"], table["rows"])
    print("\n".join(plan_of.model_lines(content)))
    return 0
