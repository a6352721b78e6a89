# SPDX-License-Identifier: MIT
"""The cases of coated bodies: what they measure is right on made results, and perturbed answers turn their
gates red.
"""

import math

import numpy as np
import pytest
from made_results import Made, context, red, square_mesh

from sam.scene import load_scene
from verification.cases import all_cases
from verification.cases.case import Context
from verification.cases.coated import coated_sphere, film_limits, film_map, layered, thin_film
from verification.cases.recipes import cells_in_coated_contact
from verification.figures.coated import Map, PaperCase, change_maps, film_planes, response_errors
from verification.judging import Measured
from verification.reference.layered_errors import Worst
from verification.rows import load_rows
from verification.runs import models
from verification.runs.models import FEM

BASE = load_scene("verification/scenes/coated-sphere.toml")
PAPER = film_map.PAPER_RATIO


def gates_of(case: str) -> set[str]:
    return {gate.id.removeprefix(f"{case}.") for gate in load_rows() if gate.case == case}


# --- response and pavement ----------------------------------------------------------------------------------


def test_quick_points_hold_every_wave_number_and_the_ends():
    few = layered.points_of("quick")
    assert {point[0] for point in few} == set(layered.WAVES) and len(few) == 100
    assert {point[1] for point in few} == set(layered.RATIOS)


def test_a_worst_error_that_is_no_number_stays_the_worst():
    found = {name: Worst(1e-12, "here") for name in layered.NAMES}
    worst = layered.worst_of({1.0: found, 2.0: found | {"film": Worst(math.nan, "there")}, 3.0: found})
    assert math.isnan(worst["film"].error) and worst["film"].where == "there" and worst["jump"].error == 1e-12


class Perturbed(layered.Response):
    """A response off by a share of 1e-8, at the surface and in the film."""

    @property
    def surface(self):
        return super().surface * (1 + 1e-8)

    def stress(self, depth):
        in_plane, out = super().stress(depth)
        return (in_plane * (1 + 1e-8), out) if depth < self.layers.thickness else (in_plane, out)


def response_values(monkeypatch, tmp_path) -> dict:
    monkeypatch.setattr(layered, "points_of", lambda level: layered.all_points()[3::200])
    monkeypatch.setattr(layered.LayeredResponse, "figures", lambda self, found: ())
    return all_cases()["layered-response"].run(context("layered-response", tmp_path)).values


def test_a_wrong_response_is_noticed(monkeypatch, tmp_path):
    values = response_values(monkeypatch, tmp_path)
    assert red("layered-response", values, whole=True) == set()
    assert set(values) == {f"layered-response.{name}" for name in gates_of("layered-response")}
    monkeypatch.setattr("verification.reference.layered_errors.Response", Perturbed)
    assert red("layered-response", response_values(monkeypatch, tmp_path)) == {
        "c-zz",
        "matrix",
        "film",
        "jump",
    }


def test_wrong_coefficients_of_equal_materials_and_wrong_waves_are_noticed(monkeypatch, tmp_path):
    class Off(layered.LayeredPatches):
        def stress(self, *args, **keys):
            return super().stress(*args, **keys) * (1 + 1e-9)

        def displacement(self, *args, **keys):
            return super().displacement(*args, **keys) * (1 + 1e-9)

    monkeypatch.setattr(layered, "LayeredPatches", Off)
    monkeypatch.setattr(layered, "STEEL", (210e9, 0.3 + 1e-9))
    right = layered.wave_pressure_ratio
    monkeypatch.setattr(layered, "wave_pressure_ratio", lambda *args: right(*args) * (1 + 1e-9))
    wrong = red("layered-response", response_values(monkeypatch, tmp_path))
    assert wrong == {"equal-displacement", "equal-stress", "flattened"}


def test_an_overflow_of_short_waves_is_counted(monkeypatch):
    class Overflowing(layered.Response):
        def stress(self, depth):
            in_plane, out = super().stress(depth)
            return np.where(in_plane == 0, math.nan, in_plane), out

    assert layered.short_waves()[0] == 0
    monkeypatch.setattr(layered, "Response", Overflowing)
    assert layered.short_waves()[0] > 0


def test_flattened_sinusoids_have_the_published_ratios():
    """Five digits each, computed independently with other software; full contact p_k = z_k/c_zz(k)."""
    rigid, steel = (layered.wave_ratios(counter)[0] for counter in (math.inf, 210e9 / (1 - 0.3**2)))
    assert rigid == pytest.approx([0.68791, 0.81461, 0.91480, 0.95492, 0.97676, 0.99052], abs=5.1e-6)
    assert steel == pytest.approx([0.81510, 0.89783, 0.95550, 0.97694, 0.98824, 0.99524], abs=5.1e-6)


def test_the_cells_of_a_disc_have_its_area():
    """Closed forms: rounding. Whole cells at the centre, and none beyond the corner of the square around the
    disc.
    """
    share = layered.covered(20)
    times = np.where(np.arange(21) == 0, 1, 2)
    assert np.sum(share * times[:, None] * times) == pytest.approx(math.pi * 400, rel=1e-13)
    assert share[0, 0] == pytest.approx(1) and share[20, 20] == pytest.approx(0, abs=1e-12)
    assert np.all((share >= -1e-12) & (share <= 1 + 1e-12)) and share == pytest.approx(share.T, abs=1e-12)


def test_a_disc_of_cells_converges_to_the_disc(monkeypatch):
    """Second order: four times the cells, a sixteenth of the error, within the ups and downs of the edge."""
    exact = layered.interface_stress(1.0, 10.0)
    found = []
    for n in (10, 40):
        monkeypatch.setattr(layered, "DISC_CELLS", n)
        found.append(abs(layered.disc_by_cells(1.0, 10.0) - exact))
    assert 8 < found[0] / found[1] < 32


@pytest.mark.parametrize(
    "name, wrong, gates",
    [
        ("FOX", {1.0: (0.6464, 0.2914, 0.0809, 0.0188)}, {"fox"}),
        ("interface_stress", lambda radius, ratio: 1.000003 * RIGHT(radius, ratio), {"response", "bare"}),
        ("disc_by_cells", lambda radius, ratio: 1.001 * RIGHT(radius, ratio), {"cells"}),
    ],
)
def test_a_wrong_pavement_is_noticed(monkeypatch, tmp_path, name, wrong, gates):
    assert (
        red("pavement", all_cases()["pavement"].run(context("pavement", tmp_path)).values, whole=True)
        == set()
    )
    monkeypatch.setattr(layered, name, wrong)
    assert (
        red("pavement", all_cases()["pavement"].run(context("pavement", tmp_path)).values, whole=True)
        == gates
    )


RIGHT = layered.interface_stress


# --- coated sphere ------------------------------------------------------------------------------------------


def made_results(answer, factor: float = 1.0) -> dict[str, Made]:
    """What both models would return of the spectral solution itself; factor: on every pressure and stress."""
    contact = answer.contact
    quantities = {
        "p_center_Pa": factor * contact.central_pressure,
        "approach_m": contact.approach,
        "contact_radius_m": contact.contact_radius,
        "mises_max_substrate_Pa": factor * answer.mises_body,
        "mises_max_film_Pa": factor * answer.mises_film,
        "p_max_change": answer.changes[0],
        "mises_max_change": answer.changes[1],
    }
    x = contact.contact_radius * np.linspace(-1.1, 1.1, 45)
    mesh = square_mesh(x, factor * contact.pressure(np.hypot(x[:, None], x[None, :])))
    r = contact.contact_radius * np.linspace(0.0, 1.2, 61)
    line = {"line": {"state": ["peak"] * r.size, "x_m": r, "p_Pa": factor * contact.pressure(r)}}
    return {"SAM": Made(quantities, fields=mesh), "FEM": Made(quantities, line, model=FEM)}


def sphere_values(errors: dict) -> dict:
    values = {
        f"coated-sphere.{model.lower()}-{name}": Measured(value)
        for model, found in errors.items()
        for name, value in found.items()
    }
    return values | {"coated-sphere.reference": Measured(0.0)}


def test_measures_of_the_sphere_vanish_on_the_answer_and_see_each_quantity():
    answer = coated_sphere.answer_of(coated_sphere.coated_scene(BASE, PAPER, 0.5, "rigid"))
    exact = {name: coated_sphere.errors(result, answer) for name, result in made_results(answer).items()}
    assert max(max(each.values()) for each in exact.values()) < 1e-12
    stronger = {name: coated_sphere.errors(each, answer) for name, each in made_results(answer, 1.03).items()}
    for found in stronger.values():
        assert [found[name] for name in ("center", "pressure", "mises-body", "mises-film")] == pytest.approx(
            [0.03] * 4
        )
    wrong = {"center", "pressure", "mises-body", "mises-film"}
    expected = {f"{model}-{name}" for model in ("sam", "fem") for name in wrong} - {
        "fem-mises-film"
    }  # 4 % there
    assert red("coated-sphere", sphere_values(stronger), whole=True) == expected


def test_a_film_modulus_off_by_one_percent_is_noticed(monkeypatch, tmp_path):
    """The case itself on one film, SAM and FEM solved; the answer then that of a film stiffer by 1 %."""
    monkeypatch.setattr(coated_sphere, "QUICK", ((PAPER, 0.5, "rigid"),))
    monkeypatch.setattr(coated_sphere.CoatedSphere, "figures", lambda self, found: ())
    monkeypatch.setattr(Context, "solve", lambda self, model, scene, label: solved_once(model, scene))
    fine, known = coated_sphere.resolved_grid, {}
    monkeypatch.setattr(
        coated_sphere, "resolved_grid", lambda scene, contact: fine(scene, contact, 24)
    )  # faster

    def solved_once(model, scene):
        if model not in known:
            known[model] = models.solve(scene, model)
        return known[model]

    assert (
        red(
            "coated-sphere",
            all_cases()["coated-sphere"].run(context("coated-sphere", tmp_path)).values,
            whole=True,
        )
        == set()
    )
    right = coated_sphere.answer_of

    def stiffer(scene):
        film = scene.body.coating.model_copy(update={"young": 1.01 * scene.body.coating.young})
        return right(scene.model_copy(update={"body": scene.body.model_copy(update={"coating": film})}))

    monkeypatch.setattr(coated_sphere, "answer_of", stiffer)
    noticed = red(
        "coated-sphere", all_cases()["coated-sphere"].run(context("coated-sphere", tmp_path)).values
    )
    assert {"sam-center", "sam-approach", "sam-p-change", "sam-mises-body", "sam-mises-change"} <= noticed
    assert {"fem-center", "fem-approach", "fem-p-change"} <= noticed


def test_films_of_the_levels():
    assert coated_sphere.films("quick") == list(coated_sphere.QUICK)
    full = coated_sphere.films("full")
    assert len(full) == 16 and set(coated_sphere.QUICK) <= set(full)


def test_the_grid_of_the_sphere_has_its_cells_and_room_for_both_contacts():
    for ratio, h in ((0.2, 1.0), (4.0, 1.0)):
        scene = coated_sphere.coated_scene(BASE, ratio, h, "steel")
        answer = coated_sphere.answer_of(scene)
        grid = coated_sphere.resolved_grid(scene, answer.contact, 24).grid
        a, widest = (
            answer.contact.contact_radius,
            max(answer.contact.contact_radius, answer.contact.bare.contact_radius),
        )
        assert a * grid.cells[0] / grid.extent[0] == pytest.approx(24) and grid.cells[0] % 2 == 1
        assert grid.extent[0] > 2.1 * widest
        assert cells_in_coated_contact(scene, 24).grid.depths[1] == scene.body.coating.thickness


# --- figures ------------------------------------------------------------------------------------------------


def test_figures_hold_their_numbers(tmp_path):
    kh = np.geomspace(1e-2, 1e2, 5)
    drawing = response_errors(dict.fromkeys(layered.NAMES.values(), (kh, kh * 1e-15)), {"all": 1e-9})
    assert len(drawing.data["kh"]) == 25 and max(drawing.data["error"]) == pytest.approx(1e-13, abs=0)
    h, e = np.geomspace(0.01, 2.0, 5), np.geomspace(0.1, 10.0, 4)
    change = np.outer(h, np.log(e))
    maps = change_maps([Map("one", h, e, change), Map("two", h, e, -change)], PaperCase(PAPER, {"1": 0.1}))
    assert maps.data["change_percent"] == pytest.approx(
        100 * np.concatenate([change.ravel(), -change.ravel()])
    )
    assert len(maps.figure.axes) == 3


def test_planes_of_a_coated_body_leave_the_interface_blank():
    x, z = np.linspace(-2.0, 2.0, 41), np.linspace(0.0, 2.4, 49)
    gx, gz = (g.ravel() for g in np.meshgrid(x, z, indexing="ij"))
    jump = np.where(gz < 0.5, 2.0, 1.0)
    plane = {"state": ["peak"] * gx.size, "x_m": gx, "z_m": gz, "mises_Pa": jump}
    mirrored = {name: np.asarray(values)[gx >= 0] for name, values in plane.items()}
    peak = {"mises_max_depth_m": 0.3, "mises_max_Pa": 2.0}
    drawing = film_planes(
        Made(peak, {"plane": plane}),
        Made(peak, {"plane": mirrored}, model=FEM),
        (1.0, 1.0),
        film=0.5,
        element=0.3,
    )
    assert not np.any(np.abs(np.asarray(drawing.data["z/a_0"]) - 0.5) < 0.25 * 0.3)
    assert np.nanmax(np.abs(drawing.data["SAM"] - drawing.data["FEM"])) < 1e-11


def test_the_cases_are_known():
    names = [
        case.name
        for case in film_map.CASES + film_limits.CASES + layered.CASES + coated_sphere.CASES + thin_film.CASES
    ]
    assert set(names) <= set(all_cases()) and len(names) == 7
