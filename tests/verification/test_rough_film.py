# SPDX-License-Identifier: MIT
"""The film on a rough patch: the radius of a summit, depths of films, and the claim of `compare`."""

import numpy as np
import pytest
from builders import parsed
from made_results import Made

from verification.compare import verdicts

COATED = "[body.coating]\nthickness = '100 nm'\nyoung = '80 GPa'\npoisson = 0.3\n"


def changed(p: float | None, mises: float) -> Made:
    return Made({"p_max_change": p, "mises_max_change": mises})


class TestVerdict:
    scene = parsed(add=COATED)

    def test_breaking_radius_is_that_of_the_closed_form(self):
        """Rigid sphere, 80 on 210 GPa: 5 % of the stress at h/a0 = 0.058."""
        assert verdicts.breaking_radius(self.scene) == pytest.approx(100e-9 / 0.058, rel=0.01)

    @pytest.mark.parametrize(
        ("sam", "fem", "holds", "failed"),
        [
            (changed(-0.02, -0.03), changed(-0.021, -0.03), True, set()),
            (changed(-0.02, -0.06), changed(-0.021, -0.06), False, {"size of mises_max_change"}),
            (changed(-0.049, -0.03), changed(-0.051, -0.03), False, {"size of p_max_change"}),
            (changed(-0.02, -0.03), changed(-0.03, -0.03), True, {"p_max_change"}),
            (changed(None, -0.03), changed(-0.03, -0.03), False, {"p_max_change", "size of p_max_change"}),
        ],
    )
    def test_claim_and_agreement(self, sam, fem, holds, failed, monkeypatch):
        monkeypatch.setattr(verdicts, "breaking_radius", lambda scene: 1.7e-6)
        claim = verdicts.verdict(self.scene, sam, fem)
        rows = verdicts.change_rows(sam, fem) + verdicts.claim_rows(claim, sam, fem)
        assert claim.film_negligible == holds and {row.quantity for row in rows if not row.passed} == failed
        assert ("NOT negligible" in claim.words) != holds
        assert all(value is None or np.isfinite(value) for value in claim.content().values())
