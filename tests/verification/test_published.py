# SPDX-License-Identifier: MIT
"""What is published says nothing of the machine that wrote it: no path outside the repository, in no file."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TEXTS = {".html", ".json", ".csv", ".xml", ".svg", ".md", ".toml", ".vtu"}
EMBEDDED = re.compile(r"base64,[A-Za-z0-9+/=\s]+")
OF_A_MACHINE = re.compile(
    r"(?<![\w.:/<])/(?:tmp|home|root|work|usr|opt|var|mnt|srv|data|Users|private)/[\w.+-]+|\b[A-Za-z]:\\[\w.+-]+"
)


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
