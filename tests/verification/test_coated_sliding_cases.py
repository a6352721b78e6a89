# SPDX-License-Identifier: MIT
"""The cases of coated sliding contacts: measures on made results, and red gates for wrong ones."""

from functools import cache

import numpy as np
import pytest
from made_results import Made, red
from test_friction_cases import like_fem, like_sam, of_plane, strain

from fem_reference.common.schedule import Load
from fem_reference.spatial import recovery
from fem_reference.spatial.model import build as build_in_space
from fem_reference.spatial.planner import plan as plan_in_space
from fem_reference.spatial.tables import plane_table
from sam.scene import load_scene
from sam.solver import solve as solve_by_sam
from verification.cases import all_cases
from verification.cases.coated import coated_sliding, coated_traction
from verification.figures.film import in_body
from verification.references import contact_of
from verification.rows import load_rows

SLIDING = load_scene("verification/scenes/coated-sliding.toml")


def sliding_pair(sam=None, fem=None, factor=1.0, skew=0.1) -> coated_sliding.SlidingPair:
    """Equal fields on the grids of both models; lengths in contact radii, film of 0.2."""
    coating = SLIDING.body.coating.model_copy(update={"thickness": 0.2})
    scene = SLIDING.model_copy(update={"body": SLIDING.body.model_copy(update={"coating": coating})})
    quantities = {"mises_max_substrate_Pa": 2.0, "p_max_change": -0.13, "mises_max_change": -0.15}
    coupled, other = like_sam(skew=skew), like_fem()

    def mises(x, z):
        return factor * (60.0 * strain(x, z) + 0.5)

    depths = np.union1d(np.arange(41) * 0.04, [0.2])
    coupled.tables["plane"] = of_plane(np.arange(-26, 27) / 16, depths, "mises_Pa", mises)
    other.tables["plane"] = of_plane(
        (np.arange(-16, 16) + 0.5) / 10, (np.arange(15) + 0.5) / 10, "mises_Pa", mises_right
    )
    coupled.quantities.update(quantities | (sam or {}))
    other.quantities.update(quantities | (fem or {}))
    return coated_sliding.SlidingPair(scene, coupled, coupled, other, 1.0)


def mises_right(x, z):
    return 60.0 * strain(x, z) + 0.5


class TestCoatedSliding:
    prefix = "mu-0-1-h-0-2-"

    def red(self, pair):
        return red("coated-sliding", coated_sliding.compared(pair), self.prefix)

    def test_equal_fields_hold_every_gate(self):
        assert self.red(sliding_pair()) == set()

    @pytest.mark.parametrize(
        ("wrong", "gates"),
        [
            ({"factor": 1.02}, {"mises-plane", "mises-largest"}),
            ({"skew": 0.0}, {"centroid", "pressure"}),
            ({"sam": {"p_max_change": -0.133}}, {"p-change"}),
            ({"sam": {"mises_max_change": -0.156}}, {"mises-change"}),
            ({"sam": {"mises_max_substrate_Pa": 2.03}}, {"mises-body"}),
        ],
    )
    def test_wrong_fields_turn_red(self, wrong, gates):
        assert gates <= self.red(sliding_pair(**wrong))

    def test_scenes_hold_the_interface_and_the_apex(self):
        a = contact_of(SLIDING).contact_radius
        assert a == pytest.approx(1e-6, rel=1e-3)
        for share in coated_sliding.THICKNESSES:
            scene = coated_sliding.scene_of(SLIDING, 0.4, share)
            assert scene.body.coating.thickness in scene.grid.depths and scene.grid.cells[0] % 2 == 1
            assert scene.friction.coefficient == 0.4 and scene.fem.box == 6.0
            inside = np.array(scene.grid.depths)[np.array(scene.grid.depths) < scene.body.coating.thickness]
            assert scene.body.coating.thickness - inside[-1] < 1e-5 * a and np.diff(inside).max() < 0.05 * a

    def test_section_never_mixes_film_and_body(self):
        """A field that jumps at the interface and is linear below it."""
        u, w = (np.arange(-10, 10) + 0.5) / 10, (np.arange(10) + 0.5) / 10
        fem = Made(
            {},
            {"plane": of_plane(u, w, "mises_Pa", lambda x, z: np.where(z < 0.2, 100.0, 2.0 + x + 3.0 * z))},
        )
        found = in_body(fem, np.array([0.0, 0.33]), np.array([0.2, 0.3, 0.61]), 0.2)
        assert np.isnan(found[:, 0]).all()
        assert found[:, 1:] == pytest.approx(
            2.0 + np.array([[0.0], [0.33]]) + 3.0 * np.array([[0.3, 0.61]]), rel=1e-12
        )

    def test_every_gate_has_its_value(self):
        cases = all_cases()
        assert cases["coated-sliding"].levels == ("full",) and cases["film-yield"].levels == ("quick", "full")
        listed = {gate.id for gate in load_rows() if gate.case == "coated-sliding"}
        names = {
            f"coated-sliding.{coated_sliding.spelt(mu, h)}"
            for mu in coated_sliding.FRICTION
            for h in coated_sliding.THICKNESSES
        }
        assert {
            gate.rsplit("-h-0-", 1)[0] + "-h-0-" + gate.rsplit("-h-0-", 1)[1][0] for gate in listed
        } == names


@cache
def given_tractions():
    """Scene of the case, closed form, and the model of FEM with its solution: of the coated contact alone."""
    scene = coated_traction.scene_of(SLIDING)
    model = build_in_space(plan_in_space(scene))
    state = model.load(Load(model.scales.peak_force, coated_traction.FRICTION), model.virgin())
    return scene, coated_traction.largest(scene), model, recovery.stresses(model, state)


class TestCoatedTraction:
    def fem(self) -> dict:
        scene, right, _, s = given_tractions()
        names = {"mises_max_film_Pa": True, "mises_max_substrate_Pa": False}
        found = Made(
            {name: recovery.largest_in_layer(s, film)[0] for name, film in names.items()},
            {"plane": plane_table("peak", s)},
        )
        measured = coated_traction.measured(scene, found, right)
        return {f"fem-{name}": value for name, value in measured.items()}

    def test_read_at_the_faces_fem_holds_its_gates(self):
        assert red("coated-traction", self.fem()) == set()

    def test_read_at_the_centres_of_elements_it_does_not(self, monkeypatch):
        monkeypatch.setattr(recovery, "LEVELS", 1)
        assert red("coated-traction", self.fem()) == {"fem-body", "fem-film", "fem-interface"}

    def test_sam_holds_its_gates_and_a_wrong_answer_does_not(self):
        scene, right, *_ = given_tractions()
        own = solve_by_sam(scene)

        def gates(factor):
            largest = ("mises_max_film_Pa", "mises_max_substrate_Pa")
            quantities = {name: own.quantities[name] * factor for name in largest}
            plane = own.tables["plane"] | {"mises_Pa": own.tables["plane"]["mises_Pa"] * factor}
            measured = coated_traction.measured(scene, Made(quantities, {"plane": plane}), right)
            return red("coated-traction", {f"sam-{name}": value for name, value in measured.items()})

        assert gates(1.0) == set() and gates(1.006) == {"sam-body", "sam-film", "sam-interface"}

    def test_every_gate_has_its_value(self):
        listed = {gate.id for gate in load_rows() if gate.case == "coated-traction"}
        assert listed == {
            f"coated-traction.{model}-{name}"
            for model in ("sam", "fem")
            for name in ("body", "film", "interface")
        }
        assert all_cases()["coated-traction"].levels == ("quick", "full")
