# SPDX-License-Identifier: MIT
"""What is measured of sliding contacts is right on fields in closed form."""

import numpy as np
import pytest
from builders import GIVEN, friction_text as friction, given_pressure, parsed
from made_results import Made, of_plane

from sam.scene import FieldMesh, parse_scene
from verification.cases.sliding.sliding_sphere import limit_of_root, overtaking
from verification.compare.measures import (
    COMPONENTS,
    Plane,
    depths_compared,
    hat_means,
    limit_of_strain,
    profile_difference,
)
from verification.quantities import QUANTITIES
from verification.reference.hamilton import sliding_stress
from verification.reference.shakedown import upper_bound
from verification.reference.stress import von_mises
from verification.references import hamilton
from verification.runs import models


def strain(x, z):
    """A smooth zone that leans to +x, 1 % at its largest, zero outside an ellipse."""
    return 0.01 * np.maximum(0.0, 1.0 - ((x - 0.2 * z) / 1.1) ** 2 - ((z - 0.35) / 0.75) ** 2) ** 2


def plane(x, z, factor=1.0) -> Made:
    """The zone at the points of a grid in y = 0, times a factor."""
    return Made({}, {"plane": of_plane(x, z, "peeq", lambda a, b: factor * strain(a, b))})


def like_sam(factor=1.0) -> Made:
    """On cells of 1/16."""
    return plane(np.arange(-35, 36) / 16, np.arange(24) / 16 + 1 / 32, factor)


class TestMeasures:
    def test_hats_take_means_exactly(self):
        """Of constants and, inside, of linear functions at the centres of cells."""
        nodes, h = np.array([-1.0, -0.5, 0.0, 0.25, 1.0]), 0.25 / 10
        faces = np.linspace(-1.0, 1.0, 81)
        matrix, centres = hat_means(nodes, faces), (faces[1:] + faces[:-1]) / 2
        assert matrix.sum(axis=1) == pytest.approx(np.ones(5), abs=1e-14)
        exact = nodes[1:-1] + (np.diff(nodes)[1:] - np.diff(nodes)[:-1]) / 3.0  # centre of an uneven triangle
        assert (matrix @ centres)[1:-1] == pytest.approx(exact, abs=h**2)

    def test_profile_difference_is_that_of_the_strains(self):
        fem = Plane.of(plane((np.arange(-14, 14) + 0.5) / 10, (np.arange(15) + 0.5) / 10).tables)
        assert depths_compared(fem, 0.0)[0] == 0.3 and depths_compared(fem, 0.0)[-1] < 1.0
        assert profile_difference(Plane.of(like_sam().tables), fem, 0.0) < 0.01
        larger = Plane.of(like_sam(factor=1.04).tables)
        assert profile_difference(larger, fem, 0.0) == pytest.approx(0.04, abs=0.01)


def test_limits_are_recovered_of_errors_of_second_order_in_cells_and_first_order_in_steps():
    def run(count, steps):
        factor = (1.0 + 3.0 / count**2) * (1.0 + 0.2 / steps)
        return like_sam(factor=factor)

    sizes = ((12, 1), (16, 1), (12, 5), (12, 10))
    results = {f"limit-sam-{count}-{steps}": run(count, steps) for count, steps in sizes}
    z = np.array([0.3, 0.5])
    exact = Plane.of(like_sam().tables).below(0.1, z)
    assert limit_of_strain(results, "sam", a=1.0, x=0.1, z=z) == pytest.approx(exact, rel=1e-12)


class TestElasticStresses:
    scene = parse_scene(given_pressure(GIVEN + "[friction]\ncoefficient = 0.4\n").encode(), "")
    a, p0, reference = scene.loading.radius, scene.loading.p0, hamilton(scene)

    def errors(self, result) -> np.ndarray:
        return np.array([QUANTITIES[name].of(result, self.reference) for name in COMPONENTS])

    def exact(self, x, y, z):
        return sliding_stress(x, y, z, self.p0, contact_radius=self.a, nu=0.3, friction=0.4)

    def test_exact_stresses_of_sam_have_no_error_and_sliding_the_other_way_a_large_one(self):
        z = np.linspace(0.0, 2.0, 41) * self.a
        names = (f"{name}_Pa" for name in COMPONENTS)
        axis = {"state": ["peak"] * z.size, "z_m": z}
        axis |= dict(zip(names, self.exact(0.0, 0.0, z).T, strict=True))
        plane = {"state": ["peak"] * z.size, "x_m": 0.3 * z, "z_m": z}
        plane["mises_Pa"] = von_mises(self.exact(0.3 * z, 0.0, z))
        found = Made({}, {"axis": axis, "plane": plane}, FieldMesh(np.zeros((0, 3)), {}))
        assert self.errors(found).max() < 1e-12 and QUANTITIES["plane"].of(found, self.reference) < 1e-12
        axis["sxz_Pa"] = -axis["sxz_Pa"]
        assert self.errors(found)[4] > 0.1


class TestCrossing:
    def test_parabola_in_the_root_of_the_size_is_recovered(self):
        h = 1.0 / np.array([18.0, 36.0, 72.0, 144.0])
        assert limit_of_root(h, 0.3 + 0.4 * np.sqrt(h) - 0.1 * h) == pytest.approx(0.3, abs=1e-12)
        assert overtaking() == pytest.approx(0.305, abs=5e-4)  # Hamilton's closed form


def test_upper_bound_is_that_of_the_literature():
    """4.68 without friction (Ponter, Hearle and Johnson 1985); 1/mu where the surface decides."""
    assert upper_bound(0.0) == pytest.approx(4.675, abs=2e-3)
    assert upper_bound(0.2) == pytest.approx(4.6715, abs=1e-3)
    assert upper_bound(0.25) == 4.0 and upper_bound(0.5) == 2.0


def test_cheapest_reference_of_a_scene():
    assert models.cheapest_reference(parsed()) == models.FEM
    assert models.cheapest_reference(parse_scene(friction("coefficient = 0.1").encode(), "")) == models.FEM_3D
    assert models.cheapest_reference(parse_scene(friction("coefficient = 0").encode(), "")) == models.FEM
    with pytest.raises(models.ModelError, match=r"fem-axisymmetric: body.poisson"):
        models.cheapest_reference(parsed(("0.3", "0.5")))
