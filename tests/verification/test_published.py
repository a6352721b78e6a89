# SPDX-License-Identifier: MIT
"""What is published says nothing of the machine that wrote it: no path outside the repository, in no file."""

import json
import re
import sys
import tempfile
from pathlib import Path

from builders import scene_text
from fake_case import FakeCase
from test_report import CASES, ROWS

from samfem.cli import main
from verification.suite import verify

ROOT = Path(__file__).resolve().parents[2]
TEXTS = {".html", ".json", ".csv", ".xml", ".svg", ".md", ".toml", ".vtu"}
EMBEDDED = re.compile(r"base64,[A-Za-z0-9+/=\s]+")
OF_A_MACHINE = re.compile(
    r"(?<![\w.:/<])/(?:tmp|home|root|work|usr|opt|var|mnt|srv|data|Users|private)/[\w.+-]+|\b[A-Za-z]:\\[\w.+-]+"
)
COARSE = '[grid]\ncells = [17, 17]\nlayers = 12\ndepth = "12 um"\n[fem]\ncells_per_radius = 5\nbox = 5\n'


def places_in(folder: Path, own: tuple[str, ...] = ()) -> list[str]:
    """The absolute paths in the text files of a folder, each as `file: text`; own: further texts."""
    found = []
    for path in sorted(folder.rglob("*")):
        if path.is_file() and path.suffix in TEXTS:
            text = EMBEDDED.sub("", path.read_text(encoding="utf-8"))
            hits = [*OF_A_MACHINE.findall(text), *(each for each in own if each in text)]
            found += [f"{path.relative_to(folder)}: {hit}" for hit in hits]
    return found


def test_nothing_published_names_a_machine():
    assert places_in(ROOT / "reports") == []


def test_nothing_that_a_command_writes_names_its_place(tmp_path, monkeypatch):
    """Scene, study and folders are given by absolute paths, and the store is elsewhere."""
    monkeypatch.setenv("SAMFEM_STORE", str(tmp_path / "store"))
    scene, study, out = tmp_path / "scene.toml", tmp_path / "study.toml", tmp_path / "out"
    scene.write_text(scene_text(add=COARSE))
    study.write_text('scene = "scene.toml"\n[vary]\n"loading.force" = { list = ["0.1 N", "0.2 N"] }\n')
    assert main(["solve", str(scene), "--out", str(out / "sam")]) == 0
    assert main(["compare", str(scene), "--out", str(out / "compare")]) in (0, 1)
    sweep = ["sweep", str(study), "--workers", "1", "--out", str(out / "sweep")]
    assert main(sweep) == 0
    for entry in (tmp_path / "store").glob("*.npz"):
        entry.write_bytes(entry.read_bytes()[:100])
    assert main(sweep) == 0
    assert "damaged" in json.loads((out / "sweep" / "sweep.json").read_text())["not_used_of_store"][0]

    def lost(context):
        (context.out.absolute() / "runs" / "lost.csv").read_text()

    monkeypatch.setattr(
        verify, "all_cases", lambda: CASES | {"bad": FakeCase("bad", "Bad", "Is it there?", does=lost)}
    )
    monkeypatch.setattr(verify, "load_rows", lambda: ROWS)
    monkeypatch.setattr(sys, "argv", ["samfem", "verify", "--out", str(out / "verify")])
    assert main(["verify", "--out", str(out / "verify")]) == 1
    assert len(list(out.rglob("*.json"))) >= 6
    own = (str(tmp_path), str(ROOT), sys.prefix, str(Path.home()) + "/", tempfile.gettempdir() + "/")
    assert places_in(out, own) == []
