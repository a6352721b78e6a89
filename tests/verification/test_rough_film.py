# SPDX-License-Identifier: MIT
"""The film on a rough patch: the radius of a summit, depths of films, and the claim of `compare`."""

import numpy as np
import pytest
from builders import parsed
from made_results import Made, square_mesh

from sam.scene import load_scene
from verification.cases.rough import rough_film
from verification.compare import verdicts
from verification.compare.comparison import compare_scene

COATED = "[body.coating]\nthickness = '100 nm'\nyoung = '80 GPa'\npoisson = 0.3\n"


def changed(p: float | None, mises: float) -> Made:
    return Made({"p_max_change": p, "mises_max_change": mises})


def hertz_spot(a: float, h: float, n: int = 41) -> Made:
    """Hertz pressure of radius a at the middle of n x n cells of h."""
    x = (np.arange(n) - (n - 1) / 2) * h
    p = np.sqrt(np.maximum(1.0 - (x[:, None] ** 2 + x[None, :] ** 2) / a**2, 0.0))
    return Made(fields=square_mesh(x, 5e9 * p))


def test_radius_of_a_summit_is_that_of_its_sphere():
    """Second differences of sqrt(1 - r^2): too large by h^2/(4 a^2) of the curvature, half of it in the
    radius.
    """
    for cells in (4, 8):
        a = 2e-6
        assert rough_film.summit_radius(hertz_spot(a, a / cells)) == pytest.approx(a, rel=1 / (6 * cells**2))


def test_films_keep_the_depths_of_the_body():
    base = load_scene("verification/scenes/rough-patch.toml")
    depths = np.array(rough_film.with_film(base, 160e-9).grid.depths)
    assert (np.diff(depths) > 0).all() and depths[-1] == 6e-6 and np.isclose(depths, 160e-9, rtol=1e-9).any()


class TestVerdict:
    scene = parsed(add=COATED)

    def test_breaking_radius_is_that_of_the_closed_form(self):
        """Rigid sphere, 80 on 210 GPa: 5 % of the pressure at h/a0 = 0.065, of the stress at 0.058; 100 nm
        over it.
        """
        assert verdicts.breaking_radius(self.scene) == pytest.approx(100e-9 / 0.058, rel=0.01)

    def test_film_of_the_same_material_breaks_nothing(self):
        assert verdicts.breaking_radius(parsed(add=COATED.replace("80 GPa", "210 GPa"))) == 0.0

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

    def test_coated_scenes_compare_film_and_body_apart(self):
        results = [Made(tables={"line": {"state": ["peak"], "x_m": [0.0]}})] * 2
        names = {row.quantity for row in compare_scene(self.scene, *results)}
        assert {"mises_max_film_Pa", "mises_max_substrate_Pa", "p_max_bare_Pa"} <= names
        assert "mises_max_Pa" not in names
