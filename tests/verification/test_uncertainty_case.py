# SPDX-License-Identifier: MIT
"""The case uncertainty: which errors count, and of which quantities medians are taken."""

import pandas as pd

from verification.cases.cost import uncertainty as study


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
