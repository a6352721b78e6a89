# SPDX-License-Identifier: MIT
"""The sources use the standard terms of the field: private words that were replaced do not come back."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
STANDARD = {
    r"\blifts?\b|\blifted\b": "residual displacement, raises, unloaded",
    r"\btorn\b|\btears?\b|\btearing\b": "removed, removal",
    r"\binert\b": "equivalent mutant",
    r"\bstability matrix\b": "robustness matrix",
    r"\bpatience\b": "stagnation limit",
    r"\bsettled\b": "converged, steady, shakedown",
    r"\bcertify\w*|\bcertified\b": "check, a-posteriori check",
    r"\bledgers?\b": "wear state",
    r"\bSELF_STIFFNESS\b": "algorithmic stiffness of the fixed-point map",
    r"\blocked (by|energy)\b": "stored (cold-work) energy",
}
"""Private word -> what to write instead."""
SOURCES = [
    path
    for folder in ("samfem", "sam", "fem_reference", "verification", "tests", "docs")
    for path in sorted((ROOT / folder).rglob("*"))
    if path.suffix in (".py", ".md", ".toml") and path != Path(__file__)
]
PUBLIC = ("mutation.not-inert", "not-inert", '"lifted"')


def private_words(text: str) -> list[str]:
    """Private words of a text, with what to write instead."""
    for name in PUBLIC:
        text = text.replace(name, "")
    return [
        f"{found.group()}: {standard}"
        for word, standard in STANDARD.items()
        for found in re.finditer(word, text, re.IGNORECASE)
    ]


def test_no_private_word_is_written():
    found = {str(path.relative_to(ROOT)): private_words(path.read_text()) for path in SOURCES}
    assert {path: words for path, words in found.items() if words} == {}


@pytest.mark.parametrize(
    "text", ["the surface is lifted", "material that tears", "inert constants", "certify(scene)"]
)
def test_a_private_word_is_found(text):
    assert private_words(text)


@pytest.mark.parametrize("text", ["a shift", 'id = "mutation.not-inert"', "certificates.sam-load", "inertia"])
def test_public_names_and_other_words_are_not(text):
    assert not private_words(text)
