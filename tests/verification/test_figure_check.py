"""What cannot be read in a figure is found: each rule on a figure that breaks it, nothing on a good one."""

import numpy as np
import pytest
from matplotlib.ticker import FixedLocator

from verification.figures.check import findings
from verification.figures.style import BLUE, VERMILION, sheet

X = np.linspace(0.0, 10.0, 21)


def two_lines(axis):
    axis.plot(X, X, color=BLUE, label="one")
    axis.plot(X, 2.0 * X, color=VERMILION, linestyle="--", label="two")
    axis.set(xlabel="$x$ [µm]", ylabel="pressure [GPa]")


def good(figure, axis):
    two_lines(axis)
    axis.legend()


def named_beside(figure, axis):
    axis.get_legend().remove()
    axis.text(5.0, 4.0, "one", color=BLUE)
    axis.text(5.0, 12.0, "two", color=VERMILION)


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
        good(figure, axis)
        change(figure, axis)
    found = findings(figure)
    assert (expected in " ".join(found)) if expected else found == []


def with_bar(place):
    """Two maps of different fields, and the colour bar of the first beside the panel `place`."""
    with sheet(6.0, 3.0, 2) as (figure, axes):
        meshes = [
            axis.pcolormesh(np.arange(12.0).reshape(3, 4) * k, cmap="viridis")
            for k, axis in enumerate(axes, 1)
        ]
        figure.colorbar(meshes[0], ax=axes[place])
        figure.colorbar(meshes[1], ax=axes[1])
    return " ".join(findings(figure))


def test_a_colour_bar_belongs_to_the_panel_beside_it():
    assert with_bar(0) == "" and "is of another panel" in with_bar(1)


def test_a_map_without_colour_bar_is_found():
    with sheet(4.0, 3.0) as (figure, axis):
        axis.pcolormesh(X, X, np.outer(X, X))
    assert "have no colour bar" in " ".join(findings(figure))
