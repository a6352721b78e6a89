# SPDX-License-Identifier: MIT
"""The cases of sliding contacts: what they measure is right on fields in closed form, and wrong fields turn
gates red.
"""

from dataclasses import replace

import numpy as np
import pytest
from builders import GIVEN, PATH, friction_text as friction, given_pressure, parsed
from made_results import Made, red, square_mesh

from sam.scene import UNLOADED, FieldMesh, Friction, load_scene, parse_scene
from verification.cases import all_cases
from verification.cases.recipes import Resolution
from verification.cases.sliding import cyclic, given_traction
from verification.cases.sliding.friction import COUPLED, DECOUPLED, FIGURE_8, Sliding, compared, sliding_scene
from verification.cases.sliding.sliding_sphere import crossing, limit_of_root, overtaking
from verification.compare.comparison import compare_scene
from verification.compare.sliding_measures import (
    Plane,
    contour,
    depths_compared,
    hat_means,
    nodal_pressures,
    patch_distance,
    patch_pressures,
    profile_difference,
)
from verification.cost.plan import plan, plan_lines
from verification.reference.hamilton import sliding_stress
from verification.references import contact_of
from verification.runs import models

CASE = "figure-8-4"
PREFIX = "mu-0-4-"
LARGEST = {"peeq_max": 0.01, "peeq_max_depth_m": 0.35}


def strain(x, z):
    """A smooth zone that leans to +x, 1 % at its largest, zero outside an ellipse."""
    return 0.01 * np.maximum(0.0, 1.0 - ((x - 0.2 * z) / 1.1) ** 2 - ((z - 0.35) / 0.75) ** 2) ** 2


def pressure(x, y, shift):
    """A pressure like that of Hertz with a skew share, zero outside r = 1."""
    return np.sqrt(np.maximum(1.0 - (x**2 + y**2), 0.0)) * (1.0 + shift * x)


def of_plane(x, z, name="peeq", values=strain):
    at = np.meshgrid(x, z, indexing="ij")
    return {
        "state": ["peak"] * at[0].size,
        "x_m": at[0].ravel(),
        "z_m": at[1].ravel(),
        name: values(*at).ravel(),
    }


def like_sam(skew=0.1, scale=1.0, factor=1.0) -> Made:
    """On cells of 1/16, with the mean of 8 x 8 points of each."""
    n, h = 71, 1.0 / 16
    x = (np.arange(n) - (n - 1) / 2) * h
    fine = (x[:, None] + ((np.arange(8) + 0.5) / 8 - 0.5) * h).ravel()
    p = scale * pressure(fine[:, None], fine[None, :], skew).reshape(n, 8, n, 8).mean(axis=(1, 3))
    plane = of_plane(x, np.arange(24) / 16 + 1 / 32, values=lambda a, b: factor * strain(a, b))
    centre = float((x[:, None] * p).sum() / p.sum())
    quantities = LARGEST | {"p_max_Pa": p.max(), "pressure_centroid_x_m": centre}
    return Made(quantities, {"plane": plane}, square_mesh(x, p))


def like_fem(h=0.1) -> Made:
    """Nodes h apart in the half y >= 0; the pressure of a node is that of the exact one over its shape
    function.
    """
    x, y = np.arange(-14, 15) * h, np.arange(0, 15) * h
    fine = (np.arange(-1600, 1600) + 0.5) / 1000
    over_x = hat_means(x, np.append(fine - 5e-4, 1.6))
    over_y = hat_means(np.concatenate([-y[:0:-1], y]), np.append(fine - 5e-4, 1.6))[y.size - 1 :]
    p = over_x @ pressure(fine[:, None], fine[None, :], 0.1) @ over_y.T
    points = np.array([[a, b, c] for a in x for b in y for c in (0.0, 1.0)])
    nodal = np.zeros((x.size, y.size, 2))
    nodal[..., 0] = p
    mesh = FieldMesh(points, {}, point_data={"p_Pa": nodal.ravel()})
    weight = np.where(y > 0, 1.0, 0.5)
    centre = float((x[:, None] * p * weight).sum() / (p * weight).sum())
    quantities = LARGEST | {"p_max_Pa": p.max(), "pressure_centroid_x_m": centre}
    plane = of_plane((np.arange(-14, 14) + 0.5) * h, (np.arange(15) + 0.5) * h)
    return Made(quantities, {"plane": plane}, mesh)


def pair(**sam) -> Sliding:
    return Sliding({COUPLED: like_sam(**sam), DECOUPLED: like_sam(skew=0.0)}, like_fem(), 1.0)


class TestMeasures:
    def test_hats_take_means_exactly(self):
        """Of constants and, inside, of linear functions sampled at the centres of cells that divide the
        elements evenly.
        """
        nodes, h = np.array([-1.0, -0.5, 0.0, 0.25, 1.0]), 0.25 / 10
        faces = np.linspace(-1.0, 1.0, 81)
        matrix, centres = hat_means(nodes, faces), (faces[1:] + faces[:-1]) / 2
        assert matrix.sum(axis=1) == pytest.approx(np.ones(5), abs=1e-14)
        exact = nodes[1:-1] + (np.diff(nodes)[1:] - np.diff(nodes)[:-1]) / 3.0  # centre of an uneven triangle
        assert (matrix @ centres)[1:-1] == pytest.approx(exact, abs=h**2)

    def test_equal_pressures_are_equal_on_the_nodes(self):
        """What is left is the ring of cells of 1/16 on the edge, with a mean each: sqrt(h) of p0 over h of
        the area.
        """
        p, reference, area = nodal_pressures(like_sam(), like_fem())
        assert np.sqrt(np.sum(area * (p - reference) ** 2) / np.sum(area * reference**2)) < 1.0 / 16**1.5
        assert 2.0 * area.sum() == pytest.approx(2.8**2, rel=1e-12)

    def test_hats_keep_the_force(self):
        """Hats of one width add up to one, so that the sum of their means is the force; half of it on y
        >= 0.
        """
        fem = like_fem()
        p = patch_pressures(fem, fem, 0.2)
        force = 0.2**2 * (2.0 * p[:, 1:].sum() + p[:, 0].sum())
        assert force == pytest.approx(2.0 / 3.0 * np.pi, rel=2e-4)
        assert (
            patch_distance(like_sam(), fem, 0.2) < 0.4 / 16**1.5
            and patch_distance(like_sam(skew=0.0), fem, 0.2) > 0.02
        )

    def test_profiles_and_contours_of_a_known_zone(self):
        """Boundary of 0.2 %: 1 - u^2 - v^2 = sqrt(0.2), an ellipse with semi-axes times sqrt(1 - sqrt(0.2)),
        sheared along x.
        """
        plane = Plane.of(like_sam(), 1.0)
        size = np.sqrt(1.0 - np.sqrt(0.2))
        found, lean = contour(plane, 0.002, 0.05), np.hypot(1.1, 0.2 * 0.75)
        assert found.depth == pytest.approx(0.35 + 0.75 * size, abs=0.01)
        assert found.length == pytest.approx(2.0 * lean * size, abs=0.02)
        assert found.right + found.left == pytest.approx(2.0 * 0.2 * 0.35, abs=0.02)
        assert contour(plane, 0.011, 0.05) is None
        assert plane.at(np.array([0.11]), np.array([0.5]))[0, 0] == pytest.approx(strain(0.11, 0.5), rel=1e-3)
        assert np.isnan(plane.at(np.array([0.0]), np.array([0.0]))).all()

    def test_profile_difference_is_that_of_the_strains(self):
        fem = Plane.of(like_fem(), 1.0)
        assert depths_compared(fem, 0.0)[0] == 0.3 and depths_compared(fem, 0.0)[-1] < 1.0
        assert profile_difference(Plane.of(like_sam(), 1.0), fem, 0.0) < 0.01
        assert profile_difference(Plane.of(like_sam(factor=1.04), 1.0), fem, 0.0) == pytest.approx(
            0.04, abs=0.01
        )


class TestGates:
    def test_equal_fields_hold_every_gate(self):
        assert red(CASE, compared(pair(), 0.4), PREFIX) == set()

    @pytest.mark.parametrize(
        ("wrong", "gates"),
        [
            ({"factor": 1.05}, {"axis", "column"}),
            ({"factor": 2.0}, {"contour-0-2-depth", "contour-0-2-length"}),
            ({"scale": 1.05}, {"p-max", "pressure"}),
            ({"skew": 0.05}, {"decoupled", "decoupled-hats"}),
        ],
    )
    def test_wrong_fields_turn_red(self, wrong, gates):
        assert gates <= red(CASE, compared(pair(**wrong), 0.4), PREFIX)

    def test_shifted_pressure_turns_the_centroid_red(self):
        found = pair()
        sam = found.sam[COUPLED]
        moved = sam.quantities["pressure_centroid_x_m"] + 0.006
        wrong = replace(sam, quantities=sam.quantities | {"pressure_centroid_x_m": moved})
        found = replace(found, sam=found.sam | {COUPLED: wrong})
        assert red(CASE, compared(found, 0.4), PREFIX) == {"centroid"}

    def test_without_friction_nothing_is_asked_of_the_coupling(self):
        assert not {"centroid", "decoupled", "decoupled-hats"} & set(compared(pair(), 0.0))


def test_levels_and_scenes_are_as_the_cases_say():
    cases = all_cases()
    levels = {f"figure-8-{level.name}": level.level for level in FIGURE_8}
    full = dict.fromkeys(("figure-8-3", "figure-8-4", "figure-8-6-2"), "full")
    assert levels == full | {"figure-8-quick": "quick"} and set(levels) <= set(cases)
    base = load_scene("verification/scenes/plastic-swift-rigid.toml")
    scene = sliding_scene(base, 4.0, 0.2, Resolution(16, 10), coupling=False)
    assert scene.friction == Friction(coefficient=0.2, coupling=False) and scene.fem.cells_per_radius == 10
    assert contact_of(scene).peak_pressure == pytest.approx(4.0 * 945e6 * 20**0.121, rel=1e-6)
    assert sliding_scene(base, 4.0, 0.0, Resolution(16, 10)).friction is None


class TestElasticStresses:
    @pytest.fixture
    def scene(self):
        return parse_scene(given_pressure(GIVEN + "[friction]\ncoefficient = 0.4\n").encode(), "")

    def block(self, scene, wrong: float = 0.0) -> Made:
        """Hexahedra of a/8 that hold the exact stress at their centres; one component of one element
        wrong.
        """
        a, h = scene.loading.radius, scene.loading.radius / 8
        corners = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)], dtype=float)
        low = np.array([[i, j, k] for i in range(-10, 10) for j in range(10) for k in range(12)], dtype=float)
        points = ((low[:, None] + corners) * h).reshape(-1, 3)
        x, y, z = ((low + 0.5) * h).T
        stress = sliding_stress(x, y, z, 1.0, contact_radius=a, nu=0.3, friction=0.4) * scene.loading.p0
        stress[np.argmin(np.abs(x) + np.abs(z - 0.5 * a)), 4] += wrong * scene.loading.p0
        cells = np.arange(8 * len(low)).reshape(-1, 8)
        return Made({}, {}, FieldMesh(points, {"hexahedron": cells}, cell_data={"stress_Pa": stress}))

    def test_exact_stresses_have_no_error_and_a_wrong_one_its_own(self, scene):
        assert (
            given_traction.element_errors(given_traction.Given(scene, None, self.block(scene))).max() < 1e-12
        )
        wrong = given_traction.Given(scene, None, self.block(scene, wrong=0.016))
        errors = given_traction.element_errors(wrong)
        assert errors[4] == pytest.approx(0.016, rel=1e-9) and np.delete(errors, 4).max() < 1e-12

    def test_axis_of_sam(self, scene):
        z = np.linspace(0.0, 2.0, 41) * scene.loading.radius
        exact = sliding_stress(
            0.0, 0.0, z, scene.loading.p0, contact_radius=scene.loading.radius, nu=0.3, friction=0.4
        )
        names = (f"{name}_Pa" for name in given_traction.COMPONENTS)
        axis = {"state": ["peak"] * z.size, "z_m": z} | dict(zip(names, exact.T, strict=True))
        found = given_traction.Given(scene, Made({}, {"axis": axis}), None)
        assert given_traction.axis_errors(found).max() < 1e-12
        axis["sxz_Pa"] = -axis["sxz_Pa"]  # sliding the other way
        assert given_traction.axis_errors(found)[4] > 0.1


class TestCrossing:
    def test_parabola_in_the_root_of_the_size_is_recovered(self):
        h = 1.0 / np.array([18.0, 36.0, 72.0, 144.0])
        assert limit_of_root(h, 0.3 + 0.4 * np.sqrt(h) - 0.1 * h) == pytest.approx(0.3, abs=1e-12)

    def test_closed_form_and_cells(self):
        """Hamilton's closed form has it at 0.305; cells of a/18 see too little of the edge, those of a/36
        less so.
        """
        assert overtaking() == pytest.approx(0.305, abs=5e-4)
        coarse, fine = crossing(36), crossing(72)
        assert overtaking() < fine < coarse < 0.45


class TestCyclic:
    def test_upper_bound_is_that_of_the_literature(self):
        """4.68 without friction (Ponter, Hearle and Johnson 1985); hardly less with traction, and 1/mu where
        the surface decides.
        """
        assert cyclic.upper_bound(0.0) == pytest.approx(4.675, abs=2e-3)
        assert cyclic.upper_bound(0.2) == pytest.approx(4.6715, abs=1e-3)
        assert cyclic.upper_bound(0.25) == 4.0 and cyclic.upper_bound(0.5) == 2.0

    def test_travels_lie_on_either_side_of_it_and_on_the_grid(self):
        for travel in cyclic.TRAVELS:
            below = travel.over_shear < cyclic.upper_bound(travel.friction)
            assert below == (travel.over_shear == cyclic.SETTLES)
            scene = cyclic.travelling(travel, 12)
            ends = np.abs([scene.loading.path.start[0], scene.loading.path.end[0]])
            assert ends.max() + 1.5 * scene.loading.radius < scene.grid.extent[0] / 2

    @pytest.mark.parametrize(
        ("strains", "moved", "wrong"),
        [
            ([0.01, 0.01, 0.01], 1.0e-8, set()),
            ([0.01, 0.01, 0.0101], 1.0e-8, {"constant-sam-adds", "constant-fem-adds"}),
            ([0.01, 0.01, 0.01], 1.1e-8, {"constant-moved"}),
        ],
    )
    def test_growth_and_motion_under_one_sign_turn_red(self, strains, moved, wrong):
        tables = {"cycles": {"peeq_max": strains}}
        sam, fem = (Made({"residual_ux_center_m": each}, tables) for each in (moved, 1.0e-8))
        values = cyclic.CASES[0].values({"constant": cyclic.CyclicResults(None, {"SAM": sam, "FEM": fem})})
        assert red("cyclic-sliding", values) == wrong and len(values) == 3

    def test_growth_below_the_limit_and_none_above_it_are_red(self):
        def found(added):
            """Results whose plastic strain grows at one place alone, not where it is largest."""
            planes = ([0.0, 0.02, 0.01], [0.0, 0.02, 0.01 + 2 * added])
            return cyclic.Passes(
                tuple(Made({}, {"plane": {"state": [UNLOADED] * 3, "peeq": peeq}}) for peeq in planes)
            )

        case = cyclic.CASES[1]
        right = {travel: found(1e-7 if travel.over_shear < 4.5 else 3e-4) for travel in cyclic.TRAVELS}
        assert red("travelling-load", case.values(right)) == set()
        right[cyclic.TRAVELS[2]], right[cyclic.TRAVELS[5]] = found(2e-5), found(5e-5)
        assert red("travelling-load", case.values(right)) == {"settles-01", "apart-01", "grows-02"}


class TestCompare:
    scene = parse_scene(friction("coefficient = 0.2").encode(), "")

    def made(self, mirrored=False) -> Made:
        x, z = (np.arange(-24, 24) + 0.5) / 10, (np.arange(24) + 0.5) / 10
        sign = -1.0 if mirrored else 1.0
        line = {"state": ["peak"] * x.size, "x_m": x}
        line |= {"p_Pa": pressure(x, 0.0, 0.3 * sign), "uz_m": np.exp(-((x - 0.1 * sign) ** 2))}
        plane = of_plane(x, z, "mises_Pa", lambda a, b: np.exp(-((a - 0.2 * sign) ** 2) - (b - 0.5) ** 2))
        axis = {"state": ["peak"] * z.size, "z_m": z, "mises_Pa": np.exp(-((z - 0.5) ** 2))}
        names = (
            "approach_m",
            "contact_radius_m",
            "p_max_Pa",
            "p_center_Pa",
            "force_N",
            "pressure_centroid_x_m",
        )
        quantities = dict.fromkeys(names, 1.0) | {"pressure_centroid_x_m": 0.02 * sign}
        return Made(quantities, {"line": line, "plane": plane, "axis": axis})

    def test_equal_results_agree_and_the_surface_maximum_is_left_out(self):
        rows = compare_scene(self.scene, self.made(), self.made())
        assert all(row.passed for row in rows) and "mises_max_Pa" not in {row.quantity for row in rows}

    def test_sliding_the_other_way_is_noticed(self):
        """Every field that has two sides differs when they are exchanged."""
        rows = compare_scene(self.scene, self.made(mirrored=True), self.made())
        wrong = {row.quantity for row in rows if not row.passed}
        fields = {"p_Pa over the contact", "uz_m on the line", "mises_Pa in the plane y = 0"}
        assert wrong == fields | {"pressure_centroid_x_m"}


def test_cheapest_reference_of_a_scene():
    assert models.cheapest_reference(parsed()) == models.FEM
    assert models.cheapest_reference(parse_scene(friction("coefficient = 0.1").encode(), "")) == models.FEM_3D
    assert models.cheapest_reference(parse_scene(friction("coefficient = 0").encode(), "")) == models.FEM
    with pytest.raises(models.ModelError, match=r"fem-axisymmetric: body.poisson"):
        models.cheapest_reference(parsed(("0.3", "0.5")))


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        (GIVEN, ["given pressure", 'loading.prescribed = "hertz"']),
        (GIVEN + PATH, ['loading.prescribed = "hertz", and travels', "steps 5", "loading.path"]),
        (GIVEN + "[friction]\ncoefficient = 0.2\n", ["tangential kernels", "friction.coefficient = 0.2"]),
    ],
)
def test_plan_of_given_pressures(lines, words):
    text = "\n".join(plan_lines(plan(parse_scene(given_pressure(lines).encode(), ""))))
    assert all(word in text for word in words) and "fem-3d: about" in text
