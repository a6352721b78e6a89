# SPDX-License-Identifier: MIT
"""The statements of the paper on running-in, on made histories."""

from dataclasses import replace

import numpy as np
import pytest
from made_histories import CYCLES, as_the_paper_says, history

from verification.cases.running_in.running_in_statements import (
    BULK,
    HARDENING,
    INF,
    STATEMENTS,
    A,
    B,
    Judgement,
    Statement,
    judge,
)
from verification.cases.running_in.running_in_tables import findings_note, statements_table


class TestStatements:
    def test_all_hold_for_histories_as_the_paper_describes_them(self):
        judged = [judge(statement, [as_the_paper_says()] * 10) for statement in STATEMENTS]
        assert {
            one.statement.words: one.judgement for one in judged if one.judgement is not Judgement.HELD
        } == {}
        assert all(one.agreeing == 10 for one in judged)

    @pytest.mark.parametrize(
        ("case", "wrong", "failing"),
        [
            (
                BULK,
                lambda h: replace(h, volume=h.cycle * 1e-19),
                ("worn in the first six", "hardly any wear later"),
            ),
            (
                BULK,
                lambda h: replace(h, friction=h.friction - 0.06),
                ("stays high", "friction below that of bulk", "below bulk"),
            ),
            (A, lambda h: replace(h, volume=0 * h.volume), ("curve A: wears linearly",)),
            (
                B,
                lambda h: replace(h, friction=h.friction + 0.1),
                ("whole surface protected", "B below A and hardening"),
            ),
            (B, lambda h: replace(h, sa=2 * h.sa), ("roughness falls more",)),
            (HARDENING, lambda h: replace(h, volume=3 * h.volume), ("as much as bulk",)),
        ],
    )
    def test_other_histories_fail_the_statement(self, case, wrong, failing):
        changed = as_the_paper_says()
        changed[case] = wrong(changed[case])
        failed = [
            j.statement.words
            for j in (judge(s, [changed] * 5) for s in STATEMENTS)
            if j.judgement is Judgement.FAILED
        ]
        assert all(any(words in statement for statement in failed) for words in failing)

    def test_surfaces_that_disagree_decide_nothing(self):
        wet = next(s for s in STATEMENTS if "whole surface protected" in s.words)
        good, bad = as_the_paper_says(), as_the_paper_says()
        bad[B] = replace(bad[B], friction=bad[B].friction + 0.2)
        verdicts = [judge(wet, [bad] * k + [good] * (5 - k)).judgement for k in range(6)]
        assert verdicts == [Judgement.HELD] * 2 + [Judgement.OPEN] * 2 + [Judgement.FAILED] * 2
        assert judge(wet, [{}] * 5).judgement is Judgement.OPEN
        assert judge(wet, [good, good, good, {}, {}]).judgement is Judgement.OPEN

    def test_nothing_worn_says_nothing_of_when(self):
        none = as_the_paper_says()
        none[BULK] = replace(none[BULK], volume=0 * none[BULK].volume)
        first = judge(STATEMENTS[0], [none] * 5)
        assert first.judgement is Judgement.OPEN and np.isnan(first.values).all()

    def test_the_median_decides_with_what_the_surfaces_scatter(self):
        """Values 1 to 10 have the hinges 3 and 8; five of ten say nothing: nor does the median."""
        judged = judge(of_friction((-INF, 6.0)), surfaces(range(1, 11)))
        assert (judged.agreeing, judged.judgement, judged.by_median) == (6, Judgement.OPEN, Judgement.HELD)
        assert judged.spread.interquartile == 5.0 and judged.margin == pytest.approx(0.1) and judged.is_close
        far = judge(of_friction((12.0, INF)), surfaces(range(1, 11)))
        assert far.by_median is far.judgement is Judgement.FAILED
        assert far.margin == pytest.approx(1.3) and not far.is_close
        silent = judge(of_friction((-INF, 6.0)), surfaces([1.0] * 5 + [np.nan] * 5))
        assert silent.by_median is Judgement.OPEN and not silent.is_close

    @pytest.mark.parametrize(
        ("values", "margin"),
        [
            ([2.0] * 10, INF),
            ([5.0] * 10, 0.0),
            ([INF] * 10, INF),
            ([1.0] * 5 + [INF] * 5, INF),
            ([1.0] * 7 + [INF] * 3, 0.0),
        ],
    )
    def test_values_without_scatter_and_without_bound(self, values, margin):
        """Infinite ratios count as numbers: they fail what is asked to be small."""
        judged = judge(of_friction((-INF, 5.0)), surfaces(values))
        assert judged.margin == margin
        assert judged.agreeing == sum(value <= 5.0 for value in values)
        assert "nan" not in "".join(statements_table({"one": [judged]}).rows[0])

    def test_runs_that_are_missing_are_surfaces_that_say_nothing(self):
        judged = judge(of_friction((-INF, 5.0)), [*surfaces([1.0] * 8), {}, {}])
        assert judged.judgement is judged.by_median is Judgement.HELD
        row = statements_table({"one": [judged], "other": [judged]}).rows[0]
        assert row[5] == row[9] == "8 of 10, none on 2"
        assert row[6] == "held" and row[4] == "1 (1 to 1)"

    def test_notes_name_what_fails_and_what_is_close(self):
        changed = as_the_paper_says()
        changed[A] = replace(changed[A], volume=0 * changed[A].volume)
        text = findings_note("printed inputs", [judge(each, [changed] * 10) for each in STATEMENTS])
        assert text.startswith(
            "Printed inputs: of 17 statements 15 held, 2 failed, 0 not decided by the median"
        )
        failed = text[text.index("Failed") :]
        assert "curve A: wears linearly" in failed and "hardening and bulk below A and B" in failed
        assert "Decided by less" not in text


def of_friction(asked) -> Statement:
    """Asks for the friction of curve B after the last cycle."""
    return Statement("0", "friction", (B,), "μ", lambda h: h[B].at("friction", 25), asked)


def surfaces(frictions):
    """A made history of curve B for each friction."""
    return [{B: history(CYCLES, friction)} for friction in frictions]
