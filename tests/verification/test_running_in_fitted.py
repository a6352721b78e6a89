# SPDX-License-Identifier: MIT
"""The inputs at which most statements on running-in hold: how near they are, and what they would mean."""

import numpy as np
import pytest
from made_results import context

from sam.scene import resolved
from verification.cases.running_in import running_in_fitted as fitted
from verification.cases.running_in.running_in_inputs import INPUTS, scene_at
from verification.cases.running_in.running_in_scenes import with_constant
from verification.cases.running_in.running_in_statements import BULK, A


@pytest.fixture(scope="module")
def printed(tmp_path_factory):
    here = context("running-in-sensitivity", tmp_path_factory.mktemp("scenes"))
    return {case: here.scene(f"running-in-{case}") for case in fitted.MATERIALS}


def points(printed, shares, counts):
    scenes = {
        (k, case): scene_at(scene, own, 7) for k, own in enumerate(shares) for case, scene in printed.items()
    }
    return fitted.Points(np.array(shares), np.array(counts), scenes, printed)


@pytest.mark.parametrize("case", [BULK, A])
def test_the_printed_inputs_are_those_of_the_scenes(printed, case):
    own = resolved(printed[case])
    again = resolved(scene_at(printed[case], fitted.printed_shares(), own["surface"]["seed"]))
    layer = again["body"]["plasticity"].pop("layer", None)
    own["body"]["plasticity"].pop("layer", None)
    assert again == _close(own)
    assert layer is None or layer["alpha"] == pytest.approx(own["body"]["plasticity"]["alpha"], rel=1e-12)


def _close(tree):
    if isinstance(tree, dict):
        return {key: _close(value) for key, value in tree.items()}
    if isinstance(tree, list | tuple):
        return type(tree)(map(_close, tree))
    return pytest.approx(tree, rel=1e-12) if isinstance(tree, float) else tree


def test_the_nearest_of_the_best_points_comes_first(printed):
    own = fitted.printed_shares()
    away = own + np.where(own < 0.5, 0.4, -0.4)
    found = points(printed, [away, own, 0.9 * own + 0.1 * away, np.full(len(INPUTS), 0.5)], [9, 4, 9, 3])
    assert found.best == [2, 0]
    assert found.away[[0, 1, 2]] == pytest.approx([0.4, 0.0, 0.04])
    table = fitted.fitted_table(found)
    assert table.columns == ("input", "printed inputs", "point 2: 9 hold", "point 0: 9 hold")
    assert all(len(row) == len(table.columns) for row in table.rows)
    assert {name: value for name, value, *_ in table.rows}["B of Swift's law [MPa]"] == "1.78e+03"


def test_hardness_is_that_of_the_law_at_a_strain_of_8_percent(printed):
    """1780 MPa (4 + 80000)^0.095 = 5.203 GPa, of curve A at the surface 0.8 of that."""
    assert fitted.hardness(printed[BULK]) == pytest.approx((2.8 * 5.2029e9, 3.0 * 5.2029e9), rel=1e-4)
    assert fitted.hardness(printed[A])[0] == pytest.approx(0.8 * 2.8 * 5.2029e9, rel=1e-4)


@pytest.mark.parametrize(("B", "judged"), [(1780e6, "1.78 times the hardest"), (900e6, "plausible")])
def test_a_hardness_beyond_that_of_steel_is_called_so(printed, B, judged):
    own = {case: with_constant(scene, B) for case, scene in printed.items()}
    shares = [fitted.printed_shares()]
    found = fitted.Points(np.array(shares), np.array([5]), {(0, case): own[case] for case in own}, printed)
    bulk = fitted.fitted_note(found).split("by Tabor, of ")[1].split(";")[0]
    assert bulk.startswith("bulk") and judged in bulk
    assert ("not plausible" in bulk) == (B > 1e9)
