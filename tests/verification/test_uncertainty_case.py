# SPDX-License-Identifier: MIT
"""The case uncertainty: what counts, and that another rule turns it red."""

import pandas as pd
import pytest
from made_results import context, of_frame, red

from verification.cases.cost import uncertainty as study

CASE = "uncertainty"


@pytest.fixture(scope="module")
def frame(tmp_path_factory) -> pd.DataFrame:
    """The bare elastic problems, whose answers are closed forms."""
    where = context(CASE, tmp_path_factory.mktemp("case"))
    closed = ("Hertz", "sliding", "ellipsoid", "rounded")
    own = [each for each in study.subjects(study=True) if each[0].startswith(closed)]
    return pd.DataFrame([row for subject in own for row in study.rows_of(where, *subject)])


def gates(frame: pd.DataFrame, factor: float = 1.0) -> set[str]:
    """Those that are red where the uncertainties are wider by a factor."""
    wider = frame.assign(**{"over-error": factor * frame["over-error"]})
    wider["covered-by-uncertainty"] = (wider["error"] <= factor * frame["uncertainty"]).astype(float)
    return red(CASE, of_frame(CASE, wider), whole=True)


def test_the_rule_holds_and_another_factor_turns_it_red(frame):
    """The textbook rule fails here; a sixth of the uncertainty covers too little; six times say nothing."""
    assert gates(frame) == set()
    assert "covered" in gates(frame, 1 / 6) and {"not-too-wide", "area-not-too-wide"} <= gates(frame, 6.0)
    assert gates(frame.assign(**{"covered-by-textbook": 1.0})) == {"textbook"}


def test_what_a_doubtful_reference_says_does_not_count():
    entry = {"values": [1.0, 1.2, 1.5], "cells": [4, 3, 2], "u_num": 0.3, "u_steps": 0.0, "u_box": 0.0}
    known, unknown = (study.judged(entry, 1.0, doubt=0.3 / each) for each in (3.1, 2.9))
    assert known["covered-by-uncertainty"] == 1.0 and "over-error" not in unknown
    assert study.judged(entry, 2.0, doubt=0.0)["covered-by-uncertainty"] == 0.0
    frame = pd.DataFrame([{"problem": "a", **known}, {"problem": "b", **unknown}])
    assert study.problems(frame, "over-error") == 1.0


def test_medians_are_of_quantities_with_three_values():
    of = {
        "peeq_max": (2.0, 3.0, 9.0),
        "p_max_Pa": (4.0, 5.0, 6.0),
        study.AREA: (7.0, 8.0, 9.0),
        "few": (1.0, 1.0),
    }
    rows = pd.DataFrame([{"quantity": name, "x": each} for name, own in of.items() for each in own])
    assert study.smallest_median(rows, "x") == 3.0 and study.largest_median(rows, "x") == 5.0
