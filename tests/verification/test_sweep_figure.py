# SPDX-License-Identifier: MIT
"""The figure of a sweep: scales, crosses, rows of panels."""

import numpy as np
from builders import scene_text

from verification.figures.sweep import summary
from verification.runs.study import read_study

STUDY = """
title = "odd $\\\\x"
scene = "sphere.toml"
[vary]
"loading.force" = { range = ["0.1 N", "0.4 N"], count = 4 }
"counterbody.radius" = { log = ["10 um", "1 mm"], count = 3 }
"title" = { list = ["$\\\\bad", "b"] }
"""


def test_a_grid_of_two_numbers_is_a_map(tmp_path):
    """Each cell has the value of its point, about which it lies; the point that failed is a cross."""
    (tmp_path / "sphere.toml").write_text(scene_text())
    (tmp_path / "study.toml").write_text(STUDY.replace('"title"', '#"title"'))
    content = read_study(tmp_path / "study.toml")
    rows = [
        dict(zip(content.study.vary, point.shown, strict=True)) | {"status": "converged"}
        for point in content.points
    ]
    for k, row in enumerate(rows):
        row |= {"p_max_Pa": 1e9 * k, "contact_radius_m": 1e-6, "approach_m": 1e-7, "peeq_max": 0.0}
    rows[-1] |= {"status": "failed", "p_max_Pa": None}
    figure = summary(content.study, rows).figure
    panel, *_ = figure.axes
    (drawn,) = panel.collections
    found = np.ma.filled(drawn.get_array(), np.nan).T.ravel()
    assert np.array_equal(found, [*range(len(rows) - 1), np.nan], equal_nan=True)
    edges = drawn.get_coordinates()[:, 0, 1]
    assert np.allclose(np.log10(edges), [0.5, 1.5, 2.5, 3.5])
    assert (panel.get_xlabel(), panel.get_yscale()) == ("normal force [N]", "log")
    (cross,) = panel.lines
    assert np.allclose(cross.get_xydata(), [0.4, 1000.0])
    figure.draw_without_rendering()
