# SPDX-License-Identifier: MIT
"""The cases of films that change little: map, limits, layer, grids coarser than a film; on made results, and
perturbed.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from made_results import Made, context, red, square_mesh

from sam.scene import load_scene
from verification.cases import all_cases
from verification.cases.case import Context
from verification.cases.coated import film_limits, film_map, thin_film
from verification.cases.coated.film_map import Changes
from verification.references import contact_of
from verification.runs import models
from verification.runs.models import FEM, SAM

BASE = load_scene("verification/scenes/coated-sphere.toml")


def changed(scene, error: float = 0.0, share: float = 1.0) -> dict:
    """Both changes of the spectral solution, with an error, or for a film modulus that is a share of the
    scene's.
    """
    film, a = scene.body.coating, contact_of(scene).contact_radius
    counterbody = "steel" if scene.counterbody.elastic else "rigid"
    found = film_map.of_spectral(share * film.young / scene.body.young, film.thickness / a, counterbody)
    return {"p_max_change": found.p + error, "mises_max_change": found.mises + error}


def made_solve(monkeypatch, module, errors: dict[str, float], share: float = 1.0) -> None:
    """No solver: results with the changes of the spectral solution, off by the error of each model."""

    def made(scene, model):
        own = {"mises_max_film_Pa": 3e9, "mises_max_substrate_Pa": 4e9}
        return Made(own | changed(scene, errors.get(model, 0.0), share), model=model)

    monkeypatch.setattr(models, "solve", made)
    monkeypatch.setattr(Context, "solve", lambda self, model, scene, label: made(scene, model))


@pytest.mark.parametrize(
    "errors, gates",
    [
        ({}, set()),
        ({SAM: 6e-3, FEM: 6e-3}, {"sam-p", "sam-mises"}),
        ({SAM: -1e-3, FEM: 5e-3}, {"fem-p", "fem-mises"}),
    ],
)
def test_gates_of_the_map(monkeypatch, tmp_path, errors, gates):
    made_solve(monkeypatch, film_map, errors)
    outcome = all_cases()["film-map"].run(context("film-map", tmp_path))
    assert red("film-map", outcome.values, whole=True) == gates
    assert len(outcome.tables[0].rows) == 2 and len(outcome.tables[1].rows) == 4


def test_a_map_names_the_place_of_its_largest_difference(monkeypatch):
    size = film_map.THICKNESSES["quick"].size, film_map.MODULI["quick"].size
    sam = {name: np.zeros(size) for name in film_map.NAMES}
    sam["p"][1, 0] = -0.02
    maps = {"rigid": film_map.Field(sam, {name: np.zeros(size) for name in film_map.NAMES})}
    grid = film_map.THICKNESSES["quick"], film_map.MODULI["quick"]
    row = film_map.error_table(film_map.Maps(None, *grid, (), maps)).rows[0]
    assert row[2] == "2" and row[3] == "h/a₀ = 1, E₁/E₂ = 0.2"


def test_a_result_without_changes_is_no_answer():
    good = Made({"p_max_change": 0.1, "mises_max_change": 0.2})
    assert film_map.of_result(good) == Changes(0.1, 0.2)
    for bad in (
        replace(good, converged=False),
        replace(good, quantities=good.quantities | {"p_max_change": None}),
    ):
        with pytest.raises(RuntimeError, match="sam ended"):
            film_map.of_result(bad)


def test_paper_points_lie_on_the_map():
    paper = {film_map.PAPER_FILM / a for a in film_map.RADII}
    h = film_map.THICKNESSES["full"]
    assert min(paper) == pytest.approx(0.02) and max(paper) == pytest.approx(0.2)
    assert h[0] <= min(paper) and max(paper) <= h[-1] and len(film_map.BOTH) >= 10


def test_the_sphere_of_a_film_has_the_radius_and_pressure_asked_for():
    for counterbody in ("rigid", "steel"):
        bare = contact_of(film_limits.sphere_scene(BASE, film_limits.paper_film(), 2e-6, counterbody))
        assert bare.contact_radius == pytest.approx(2e-6, rel=1e-12) and bare.peak_pressure == pytest.approx(
            6.5e9, rel=1e-12
        )


@pytest.mark.parametrize(
    "share, errors, gates", [(1.0, {}, set()), (1.01, {}, {"sam-at-limit", "fem-at-limit"})]
)
def test_gates_of_the_limits(monkeypatch, tmp_path, share, errors, gates):
    """A film modulus that is off by 1 % in both models: 5 % of change become 4.9 %."""
    made_solve(monkeypatch, film_limits, errors, share)
    outcome = all_cases()["film-limits"].run(context("film-limits", tmp_path))
    assert red("film-limits", outcome.values, whole=True) == gates
    assert "above 1.72 µm under a rigid sphere and 0.90 µm under a steel sphere" in outcome.notes[0]
    assert [row[2:] for row in outcome.tables[1].rows] == [("1.542", "1.723"), ("0.752", "0.896")]


@pytest.mark.parametrize(
    "errors, gates", [({}, set()), ({SAM: 3e-4, FEM: 3e-4}, {"sam-p", "sam-mises", "fem-p", "fem-mises"})]
)
def test_gates_of_the_layer(monkeypatch, tmp_path, errors, gates):
    made_solve(monkeypatch, film_limits, errors)
    assert (
        red("nc-layer", all_cases()["nc-layer"].run(context("nc-layer", tmp_path)).values, whole=True)
        == gates
    )


def test_a_limit_that_the_thinnest_film_passes_is_said_so(monkeypatch):
    assert film_limits.spelt(math.nan) == "below 0.002" and film_limits.spelt(0.06482) == "0.0648"

    def passed(*_, **_by_name):
        raise ValueError("limit = 0.01 is passed at thickness/a0 = 0.002 already")

    monkeypatch.setattr(film_limits, "breaking_thickness", passed)
    assert math.isnan(film_limits.broken_at.__wrapped__(1e-3, "rigid", 0.01, "p"))


# --- thin film ----------------------------------------------------------------------------------------------


def patch_result(n: int, change=None) -> Made:
    x = 1e-6 * (np.arange(n) - (n - 1) / 2)
    p = np.maximum(0.0, 16.0 - 1e12 * (x[:, None] ** 2 + x[None, :] ** 2))
    if change:
        p = change(p)
    names = {
        "axis": ("mises_Pa", "sxx_Pa", "szz_Pa"),
        "line": ("p_Pa", "uz_m", "gap_m"),
        "plane": ("mises_Pa",),
    }
    tables = {table: {name: np.ones(5) for name in columns} for table, columns in names.items()}
    return Made({"p_max_change": 0.0, "mises_max_change": 0.0}, tables, square_mesh(x, p))


def test_numbers_that_are_not_finite_are_counted():
    result = patch_result(9)
    assert thin_film.unfinished(result) == 0
    result.tables["plane"]["mises_Pa"][2:4] = math.nan, math.inf
    assert thin_film.unfinished(result) == 2


def test_a_pressure_that_depends_on_the_patch_is_an_alias():
    patch, spectral = thin_film.PATCHES[0], Changes(0.0, 0.0)
    same = thin_film.SolvedPatch(patch, patch_result(9), patch_result(13), spectral)
    assert same.alias == 0.0
    other = replace(same, wider=patch_result(13, lambda p: p + 0.16 * (np.arange(13) == 6)))
    assert other.alias == pytest.approx(0.01)


@pytest.mark.parametrize(
    "error, broken, gates",
    [
        (0.0, False, set()),
        (2e-3, False, {f"{n}-{q}" for n in ("coarse", "fine") for q in ("p", "mises")}),
        (0.0, True, {"unfinished"}),
    ],
)
def test_gates_of_thin_films(monkeypatch, tmp_path, error, broken, gates):
    def made(self, model, scene, label):
        result = patch_result(scene.grid.cells[0])
        if broken:
            result.tables["line"]["uz_m"][0] = math.nan
        return replace(result, quantities=changed(scene, error))

    monkeypatch.setattr(Context, "solve", made)
    monkeypatch.setattr(thin_film, "error_of_parts", lambda kind: 1e-11)
    outcome = all_cases()["thin-film-grids"].run(context("thin-film-grids", tmp_path))
    assert red("thin-film-grids", outcome.values, whole=True) == gates


@pytest.mark.parametrize("kind, method", [("displacement", "displacement"), ("stress", "stress")])
def test_coefficients_with_an_image_are_noticed(monkeypatch, kind, method):
    """A part that does not add up, 1e-7 of every coefficient of small cells, and the sum is off by as
    much.
    """
    monkeypatch.setattr(thin_film, "LAGS", ((0, 0), (2, 1)))
    monkeypatch.setattr(thin_film, "PARTS", 31)
    assert thin_film.error_of_parts(kind) < 1e-9
    right = getattr(thin_film.LayeredPatches, method)

    def wrong(self, lags, *rest, **keys):
        return right(self, lags, *rest, **keys) * (1.0 if lags.hx > 5e-7 else 1 + 1e-7)

    monkeypatch.setattr(thin_film.LayeredPatches, method, wrong)
    assert thin_film.error_of_parts(kind) > 5e-8
