# SPDX-License-Identifier: MIT
"""The stories of the guide work as they stand: their commands, one after the other, in an empty folder. The
first story, `first-contact`, is run by `.ci/wheel`, with the package installed as its reader installs it.
"""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
GUIDE = ROOT / "docs" / "guide"
STORIES = {
    "own-data": ("sphere-compare/compare.csv", "page/report.html"),
    "continuous-integration": ("ball-compare/compare.csv", "contacts.xml", "contacts/report.html"),
    "measured-surface": ("pin-sam/surface.csv", "pin-sam/figures/pressure.png", "running-in.toml"),
}
"""Page -> files that are there at its end."""
LONGEST_S = 120  # what a reader is promised


def commands(page: str) -> str:
    """The shell blocks of a page as a script that stops at the first error."""
    blocks = re.findall(r"^```sh\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)
    return "\n".join(["set -euo pipefail", *blocks])


@pytest.fixture(scope="module")
def store(tmp_path_factory):
    """One store: the stories begin with the same scene."""
    return tmp_path_factory.mktemp("store")


@pytest.mark.parametrize("name", STORIES)
def test_a_story_runs_as_it_stands(tmp_path, store, name):
    (programs := tmp_path / "bin").mkdir()
    for program, words in (("samfem", " -m samfem.cli"), ("python", "")):
        (programs / program).write_text(f'#!/bin/sh\nexec "{sys.executable}"{words} "$@"\n')
        (programs / program).chmod(0o755)
    (folder := tmp_path / "empty").mkdir()
    path = os.pathsep.join([str(programs), os.environ["PATH"]])
    script = commands((GUIDE / f"{name}.md").read_text(encoding="utf-8"))
    ended = subprocess.run(
        ["bash", "-c", script],
        cwd=folder,
        env={**os.environ, "PATH": path, "PYTHONPATH": str(ROOT), "SAMFEM_STORE": str(store)},
        capture_output=True,
        text=True,
        timeout=LONGEST_S,
    )
    assert ended.returncode == 0, ended.stdout[-2000:] + ended.stderr[-2000:]
    assert [file for file in STORIES[name] if not (folder / file).exists()] == []
