# SPDX-License-Identifier: MIT
"""Each script of the gallery is short, runs, says how well its numbers are known and what they warn
of, draws, leaves no file.
"""

import re
import runpy
import warnings
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

SCRIPTS = sorted((Path(__file__).resolve().parents[2] / "docs" / "gallery").glob("*/*.py"))


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_a_script_of_the_gallery_runs(script, folder, monkeypatch, capsys):
    assert len(script.read_text(encoding="utf-8").splitlines()) <= 40
    monkeypatch.delenv("DISPLAY", raising=False)  # else `plt.show` warns that it cannot
    plt.switch_backend("Agg")
    plt.close("all")
    with warnings.catch_warnings(record=True) as heard:
        warnings.simplefilter("always")
        runpy.run_path(str(script), run_name="__main__")
    said = capsys.readouterr()
    assert re.search(r"\d+ cells of|\d+ elements", said.out) and said.err == ""
    assert all(f"warning: {each.message}" in said.out for each in heard)
    assert re.search(r"^uncertainty: .* times the estimated error", said.out, re.MULTILINE)
    assert plt.get_fignums()
    plt.close("all")
    assert list(folder.iterdir()) == []
