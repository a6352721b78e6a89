# SPDX-License-Identifier: MIT
"""Published figures are smaller than drawn ones, and show and hold the same."""

import gzip

import numpy as np
import pytest
from PIL import Image

from verification.cases.case import Figure
from verification.suite import lighter as module
from verification.suite.lighter import lighter


@pytest.fixture
def drawn(tmp_path):
    """A smooth map of many colours, with noise that packs badly, on a transparent sheet; and its table."""
    x = np.linspace(0.0, 255.0, 400)
    colours = np.stack(np.broadcast_arrays(x, x[:, None], 128.0, 255.0), axis=-1)
    colours[..., :3] += np.random.default_rng(1).uniform(-3.0, 3.0, (400, 400, 3))
    colours[:20, ..., 3] = 0.0
    Image.fromarray(np.clip(colours, 0, 255).astype(np.uint8)).save(tmp_path / "map.png", dpi=(200, 200))
    rows = "x,y\n" + "".join(f"{k},{k * k}\n" for k in range(2000))
    (tmp_path / "map.csv").write_text(rows, encoding="utf-8")
    return tmp_path


def test_large_files_shrink_and_keep_what_they_hold(drawn):
    whole, rows = (drawn / "map.png").stat().st_size, (drawn / "map.csv").read_bytes()
    assert whole > module.LARGE
    with Image.open(drawn / "map.png") as picture:
        before = np.asarray(picture.convert("RGBA"), dtype=int)
    found = lighter(Figure("", "", "", "map.png", "map.csv"), drawn)
    assert found.csv == "map.csv.gz" and not (drawn / "map.csv").exists()
    assert gzip.decompress((drawn / "map.csv.gz").read_bytes()) == rows
    assert (drawn / "map.png").stat().st_size < 0.6 * whole
    with Image.open(drawn / "map.png") as picture:
        after = np.asarray(picture.convert("RGB"), dtype=int)
        assert picture.info["dpi"] == pytest.approx((200, 200), abs=0.1)
    assert (after[:20] == 255).all()
    assert np.abs(after[20:] - before[20:, :, :3]).mean() < 8.0


def test_small_files_stay_as_they_are(drawn, monkeypatch):
    monkeypatch.setattr(module, "LARGE", 10**9)
    monkeypatch.setattr(module, "PACKED", 10**9)
    kept = {path.name: path.read_bytes() for path in drawn.iterdir()}
    figure = Figure("", "", "", "map.png", "map.csv")
    assert lighter(figure, drawn) == figure
    assert lighter(Figure("", "", "", "map.png"), drawn).csv == ""
    assert {path.name: path.read_bytes() for path in drawn.iterdir()} == kept
