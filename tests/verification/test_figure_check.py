"""Each rule of a figure finds what breaks it, its picture keeps its colours, and a sweep is drawn with each
value at its point.
"""

import io

import numpy as np
import pytest
from builders import scene_text
from matplotlib.ticker import FixedLocator
from PIL import Image

from verification.figures.check import findings
from verification.figures.style import BLUE, GREEN, VERMILION, encoded, sheet
from verification.figures.sweep import summary
from verification.runs.study import read_study

X = np.linspace(0.0, 10.0, 21)


def named_beside(figure, axis):
    axis.get_legend().remove()
    axis.text(5.0, 4.0, "one", color=BLUE)
    axis.text(5.0, 12.0, "two", color=VERMILION)


def with_bound(figure, axis):
    axis.errorbar([5.0], [5.0], xerr=[1.0], xuplims=True, color=BLUE, label="_")
    axis.errorbar([np.nan], [5.0], color=GREEN, marker="D")


def touching(figure, axis):
    axis.text(2.0, 5.0, "the first")
    axis.text(2.4, 5.1, "the second")


def beyond_the_sheet(figure, axis):
    axis.set_in_layout(False)
    axis.text(9.0, 3.0, "a long text that goes on to the right")


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (lambda figure, axis: None, ""),
        (named_beside, ""),
        (with_bound, ""),
        (touching, "collide"),
        (beyond_the_sheet, "leaves the sheet"),
        (lambda figure, axis: axis.set_title("p0 = 4 sigma_y0"), "name of a variable"),
        (lambda figure, axis: axis.yaxis.set_major_locator(FixedLocator([10.0])), "fewer than two numbers"),
        (lambda figure, axis: axis.set(xlabel="cycle", xlim=(1.0, 2.0)), "broken numbers"),
        (lambda figure, axis: axis.plot(X, 3.0 * X, color=BLUE, linestyle=":"), "no legend has the line"),
        (lambda figure, axis: axis.get_legend().remove(), "no legend has the line"),
        (
            lambda figure, axis: figure.legend(*axis.get_legend_handles_labels(), loc="lower center"),
            "a legend covers",
        ),
    ],
)
def test_a_broken_rule_is_found_and_a_good_figure_has_none(change, expected):
    with sheet(4.0, 3.0) as (figure, axis):
        axis.plot(X, X, color=BLUE, label="one")
        axis.plot(X, 2.0 * X, color=VERMILION, linestyle="--", label="two")
        axis.set(xlabel="$x$ [µm]", ylabel="pressure [GPa]")
        axis.legend()
        change(figure, axis)
    found = findings(figure)
    assert (expected in " ".join(found)) if expected else found == []


@pytest.mark.parametrize(
    "place, expected", [(0, ""), (1, "is of another panel"), (None, "have no colour bar")]
)
def test_a_map_has_a_colour_bar_which_belongs_to_the_panel_beside_it(place, expected):
    """Two maps of different fields, and the colour bar of the first beside the panel `place`, or none."""
    with sheet(6.0, 3.0, 2) as (figure, axes):
        one, other = (
            axis.pcolormesh(np.arange(12.0).reshape(3, 4) * k, cmap="viridis")
            for k, axis in enumerate(axes, 1)
        )
        figure.colorbar(other, ax=axes[1])
        if place is not None:
            figure.colorbar(one, ax=axes[place])
    found = findings(figure)
    assert (expected in " ".join(found)) if expected else found == []


def test_the_palette_of_a_picture_keeps_the_colours_of_its_bars():
    """Two maps of 256 colours beside each other, whose values take up only the lower half of the second."""
    with sheet(8.0, 3.0, 2) as (figure, axes):
        for axis, look in zip(
            axes, ({"cmap": "viridis"}, {"cmap": "RdBu_r", "vmin": -1.0, "vmax": 1.0}), strict=True
        ):
            values = np.sin(np.linspace(0.0, np.pi, 1600)).reshape(40, 40)
            figure.colorbar(axis.pcolormesh(-values, **look), ax=axis, orientation="horizontal")
    figure.draw_without_rendering()
    figure.set_layout_engine("none")  # which would move the panels a little each time
    exact, small = (
        np.asarray(Image.open(io.BytesIO(encoded(figure, small=small))).convert("RGB"), dtype=int)
        for small in (False, True)
    )
    # by some of 255 where neighbours in a map share a colour, or shades of letters and lines
    assert np.abs(small - exact).max() < 16


# the figure of a sweep


STUDY = """
scene = "sphere.toml"
[vary]
"loading.force" = { range = ["0.1 N", "0.4 N"], count = 4 }
"counterbody.radius" = { log = ["10 um", "1 mm"], count = 3 }
"""


def test_a_grid_of_two_numbers_is_a_map(tmp_path):
    """Each cell has the value of its point, about which it lies; the point that failed is a cross."""
    (tmp_path / "sphere.toml").write_text(scene_text())
    (tmp_path / "study.toml").write_text(STUDY)
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
