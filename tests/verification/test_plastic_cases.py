# SPDX-License-Identifier: MIT
"""What the elasto-plastic cases look at: allowances, means over rings, extrapolation, load histories."""

from types import SimpleNamespace

import numpy as np
import pytest
from made_results import Made, of_plane, square_mesh

from verification.cases.compared import refinement
from verification.cases.recipes import layer_faces
from verification.judging import error_of
from verification.quantities import QUANTITIES, Solved
from verification.reference.convergence import extrapolate
from verification.runs.sampling import (
    means_of_cells,
    means_of_line,
    plane_field_on,
    pressure_on,
    ring_edges,
    surface_pressure,
)


def cone(cells: int, top: float) -> Made:
    """SAM with p = top (1 - |x|) (1 - |y|), which is linear along each line of cells on either side."""
    x = np.linspace(-1.0, 1.0, cells)
    p = top * np.outer(1 - np.abs(x), 1 - np.abs(x))
    return Made({"peeq_max": top}, fields=square_mesh(x, p))


def line(top: float) -> Made:
    """FEM with p = top (1 - r)."""
    table = {"state": ["peak"] * 3, "x_m": [0.0, 1.0, 2.0], "p_Pa": [top, 0.0, 0.0]}
    return Made({"peeq_max": top}, {"line": table}, model="fem-axisymmetric")


@pytest.mark.parametrize("name", ["peeq-max", "pressure"])
def test_what_refinement_allows(name):
    """Changes of 0.7 % (SAM) over a ratio of 8/7 and of 0.5 % (FEM) over one of 2; else 1 %."""
    scene = SimpleNamespace(body=SimpleNamespace(plasticity=True))
    sam, fem = cone(33, 1.02), line(1.0)
    coarser = (cone(17, 1.02 - 0.007), 8 / 7), (line(0.995), 2.0)
    found = Solved(scene, None, {"sam": sam, "fem": fem}, coarser=coarser)
    of_sam, of_fem, apart, allowed = refinement(found, QUANTITIES[name])
    if name == "peeq-max":
        expected = 7 * 0.007 / 1.013, 0.005 / 0.995, 0.02
    else:
        p, q = (QUANTITIES[name].between(scene, cone(33, top), fem) for top in (1.02, 1.013))
        norm = np.linalg.norm
        expected = 7 * norm(p.value - q.value) / norm(p.expected), 0.005, error_of("relative_l2", p)
    assert (of_sam, of_fem, apart) == pytest.approx(expected, rel=1e-9) and allowed == of_sam + of_fem
    same = Solved(scene, None, {"sam": sam, "fem": fem}, coarser=((sam, 8 / 7), (fem, 2.0)))
    assert refinement(same, QUANTITIES[name])[-1] == 0.01


def test_the_second_cycle_is_held_against_the_first_peak():
    history = {"cycle": [1, 1, 1, 2, 2], "force_N": [0.0, 1.0, 0.0, 1.0, 0.0]}
    history |= {"approach_m": [0.0, 2e-6, 1e-6, 2.002e-6, 1e-6], "peeq_max": [0.0, 0.01, 0.01, 0.01, 0.011]}
    made = Made(tables={"history": history})
    peeq = QUANTITIES["peeq-reloaded"].against("peeq-reloaded", made, None)
    assert (peeq.value, peeq.expected) == (0.011, 0.01)
    assert QUANTITIES["approach-reloaded"].of(made, None) == pytest.approx(1e-3, rel=1e-9)


class TestSampling:
    def test_unequal_cells_keep_their_directions(self):
        nodes = np.array([[x, y, 0.0] for x in (0.0, 2.0, 4.0) for y in (0.0, 1.0, 2.0, 3.0)])
        quads = np.array([[k, k + 4, k + 5, k + 1] for k in (0, 1, 2, 4, 5, 6)])
        x, y, p = surface_pressure(nodes, quads, np.arange(6.0))
        assert x.tolist() == [1.0, 3.0] and y.tolist() == [0.5, 1.5, 2.5]
        assert p.tolist() == [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]]

    def test_hertz_pressure_is_interpolated_to_rounding(self):
        """p^2 is quadratic in r: lines between nodes 1/400 apart err by 1/(8 * 400^2) of p0^2."""
        r = np.linspace(0.0, 2.0, 801)
        line = {"state": ["peak"] * r.size, "x_m": r, "p_Pa": np.sqrt(np.maximum(1.0 - r**2, 0.0))}
        x, y = np.array([-0.31, 0.123]), np.array([0.4567])
        exact = 1.0 - (x[:, None] ** 2 + y**2)
        assert np.abs(pressure_on(x, y, {"line": line}) ** 2 - exact).max() <= 1.0 / (4.0 * 400**2)

    def test_linear_field_is_reproduced_and_nothing_extrapolated(self):
        r, z = np.linspace(0.02, 3.0, 41), np.linspace(0.03, 3.0, 43)
        plane = of_plane(r, z, "mises_Pa", lambda _, z: 2.0 + 5.0 * z)
        x, depths = np.array([-1.0, 0.0, 0.7]), np.array([0.0, 0.5, 1.0])
        field = plane_field_on(x, depths, {"plane": plane}, "mises_Pa")
        assert np.isnan(field[:, 0]).all() and np.allclose(field[:, 1:], [4.5, 7.0], rtol=1e-12)
        whole = of_plane(2.0 * (r - 1.5), z, "mises_Pa", lambda x, _: 3.5 + x / 2.0)  # not symmetric
        field = plane_field_on(np.array([-1.0, 0.7]), np.array([0.5]), {"plane": whole}, "mises_Pa")
        assert np.allclose(field[:, 0], [3.0, 3.85], rtol=1e-12)


class TestRings:
    edges = ring_edges(0.1, 1.0)

    def test_line_gives_the_exact_means_of_a_cone(self):
        """p = 1 - r: mean over a..b is 1 - (2/3)(b^3 - a^3)/(b^2 - a^2), whatever the nodes."""
        r = np.array([0.0, 0.07, 0.5, 0.55, 1.0, 1.3])
        found = means_of_line(r, np.maximum(1.0 - r, 0.0), self.edges)
        exact = 1.0 - 2.0 / 3.0 * np.diff(self.edges**3) / np.diff(self.edges**2)
        assert found == pytest.approx(exact, rel=1e-13)

    def test_cells_count_by_their_area_in_a_ring(self):
        """Four squares around the axis with sides of 1 m, and four beyond them in x."""
        p = np.array([[9.0, 9.0], [1.0, 2.0], [3.0, 4.0], [7.0, 7.0]])
        x, y = np.arange(4) - 1.5, np.arange(2) - 0.5
        inner, outer, last = means_of_cells(x, y, p, np.array([0.0, 1.0, 1.5, 2.3]))
        assert inner == pytest.approx(2.5, rel=1e-14) and 2.5 < outer < 8.0
        assert last == pytest.approx(8.0, rel=1e-14)


class TestResolution:
    def test_layers_halve_where_cells_double(self):
        coarse, fine = layer_faces(10), layer_faces(20)
        assert fine[::2] == pytest.approx(coarse, rel=1e-14)
        assert np.allclose(np.diff(coarse)[:10], 0.1, rtol=1e-12) and np.all(np.diff(coarse, 2) > -1e-12)


class TestExtrapolation:
    @pytest.mark.parametrize(("order", "factor"), [(1.0, 0.3), (1.7, -0.4), (2.0, 5.0)])
    def test_power_law_is_recovered(self, order, factor):
        h = 1.0 / np.array([5.0, 10.0, 20.0, 40.0])
        limit = extrapolate(h, 3.0 + factor * h**order)
        assert limit.limit == pytest.approx(3.0, rel=1e-6) and limit.order == pytest.approx(order, abs=1e-4)
        assert limit.observed and limit.scatter < 1e-6
        assert limit.uncertainty == pytest.approx(abs(factor) * h[-1] ** order / 3.0, rel=1e-3)

    @pytest.mark.parametrize("values", [[1.0, 2.0], [1.0, np.nan, 2.0]])
    def test_what_cannot_be_extrapolated_is_refused(self, values):
        with pytest.raises(ValueError, match="values"):
            extrapolate([0.4, 0.2, 0.1], values)
