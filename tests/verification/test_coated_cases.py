# SPDX-License-Identifier: MIT
"""Coated and rough contacts: what is read of results that no solver made, scenes of recipes, and figures."""

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from made_results import Made, square_mesh

from sam.scene import Result, load_scene
from verification.cases.case import with_keys
from verification.cases.coated import films
from verification.cases.recipes import RECIPES
from verification.compare.measures import Plane, depths_compared
from verification.figures.maps import compared_mises, in_body
from verification.judging import error_of
from verification.quantities import QUANTITIES
from verification.references import coated_contact, contact_of
from verification.runs.models import FEM

SPHERE, SLIDING, ASPERITIES = (
    load_scene(f"verification/scenes/{name}.toml")
    for name in ("coated-sphere", "coated-sliding", "rough-asperities")
)


def varied(scene, **recipes):
    for name, value in recipes.items():
        scene = RECIPES[name.replace("_", "-")](scene, value)
    return scene


# --- coated spheres -------------------------------------------------------------------------------------


def test_scenes_have_the_cells_the_radius_and_the_interface_that_are_asked_for():
    for ratio in (0.2, 4.0):
        scene = varied(SPHERE, film=(ratio, 1.0, "steel"), coated_grid=24)
        contact, grid = coated_contact(scene), scene.grid
        assert contact.contact_radius * grid.cells[0] / grid.extent[0] == pytest.approx(24)
        assert grid.cells[0] % 2 == 1
        assert grid.extent[0] > 2.1 * max(contact.contact_radius, contact.bare.contact_radius)
    for counterbody in ("rigid", "steel"):
        bare = contact_of(varied(SPHERE, film_under=(counterbody, 2e-6, 100e-9, 80 / 210)))
        assert bare.contact_radius == pytest.approx(2e-6, rel=1e-12)
        assert bare.peak_pressure == pytest.approx(6.5e9, rel=1e-12)


def test_a_result_without_changes_is_no_answer():
    good = Made({"p_max_change": 0.1, "mises_max_change": 0.2})
    assert films.changes_of(good) == {"p": 0.1, "mises": 0.2}
    without = replace(good, quantities=good.quantities | {"p_max_change": None})
    for bad in (replace(good, converged=False), without):
        with pytest.raises(RuntimeError, match="sam ended"):
            films.changes_of(bad)


def patch(n: int, peak: float = 16.0) -> Made:
    """Pressure of a bump on n x n cells, `peak` in the middle."""
    x = 1e-6 * (np.arange(n) - (n - 1) / 2)
    p = np.maximum(0.0, 16.0 - 1e12 * (x[:, None] ** 2 + x[None, :] ** 2))
    p[n // 2, n // 2] = peak
    names = {"axis": ("mises_Pa", "sxx_Pa", "szz_Pa"), "line": ("p_Pa", "uz_m", "gap_m")}
    names["plane"] = ("mises_Pa",)
    tables = {table: {name: np.ones(5) for name in columns} for table, columns in names.items()}
    return Made(tables=tables, fields=square_mesh(x, p))


def test_aliases_and_numbers_that_are_not_finite_are_found():
    result = patch(9)
    assert films.alias(result, patch(13)) == 0.0 and films.unfinished(result) == 0
    assert films.alias(result, patch(13, peak=16.16)) == pytest.approx(0.01)
    result.tables["plane"]["mises_Pa"][2:4] = math.nan, math.inf
    assert films.unfinished(result) == 2


def plane(x, z, field) -> dict:
    """The table of a field in y = 0."""
    gx, gz = (grid.ravel() for grid in np.meshgrid(x, z, indexing="ij"))
    return {"state": ["peak"] * gx.size, "x_m": gx, "z_m": gz, "mises_Pa": field(gx, gz)}


def test_film_and_body_are_never_mixed():
    """A field that jumps at the interface and is linear below it, on other points than those of SAM."""

    def field(x, z):
        return np.where(z < 0.2e-6 * (1.0 - 1e-9), 100.0, 2.0 + 1e6 * (x + 3.0 * z))

    u, w = 1e-6 * (np.arange(-10, 10) + 0.5) / 10, 1e-6 * np.append(0.2, (np.arange(2, 10) + 0.5) / 10)
    fem = Made({}, {"plane": plane(u, np.union1d(w, [0.05e-6]), field)})
    found = in_body(fem, np.array([0.0, 0.33e-6]), np.array([0.1e-6, 0.3e-6, 0.61e-6]), 0.2e-6)
    assert np.isnan(found[:, 0]).all()
    exact = 2.0 + np.array([[0.0], [0.33]]) + 3.0 * np.array([[0.3, 0.61]])
    assert found[:, 1:] == pytest.approx(exact, rel=1e-12)
    scene = with_keys(SLIDING, "body.coating", thickness=0.2e-6)
    sam = Made({}, {"plane": plane(np.linspace(-1.6e-6, 1.6e-6, 52), np.arange(41) * 0.04e-6, field)})
    for factor in (1.0, 1.02):
        scaled = fem.tables["plane"] | {"mises_Pa": factor * fem.tables["plane"]["mises_Pa"]}
        both = QUANTITIES["mises-below-film"].between(scene, sam, replace(fem, tables={"plane": scaled}))
        assert np.asarray(both.value) * factor == pytest.approx(both.expected, rel=1e-12)
        assert both.value.shape == (20, 9)


# --- rough contacts -------------------------------------------------------------------------------------


def asperities(load=1.0, strain=1.0, dent=1.0) -> Result:
    """Three spots of constant pressure, bells of strain below, dents; factors on spot 1."""
    x = np.linspace(-5.5e-6, 5.5e-6, 12)
    p, z = np.zeros((12, 12)), np.linspace(0.1e-6, 3e-6, 24)
    for k, value in zip((2, 6, 10), (4e9 * load, 3e9, 2e9), strict=True):
        p[k - 1 : k + 1, 5:7] = value
    peeq = np.full((12, 1), 0.01) * np.exp(-(((z - 0.6e-6) / 0.5e-6) ** 2))
    peeq *= strain
    xx, yy = np.meshgrid(x, x, indexing="ij")
    surface = {"x_m": xx.ravel(), "y_m": yy.ravel(), "p_Pa": p.ravel(), "state": ["peak"] * 144}
    below = plane(x, z, lambda *_: peeq.ravel())
    uz = np.where(x < -2e-6, dent, 1.0) * 5e-9 * np.cos(x * 1e6) ** 2
    line = {"x_m": x, "uz_m": uz, "state": ["unloaded"] * 12}
    tables = {"surface": surface, "plane": below | {"peeq": below["mises_Pa"]}, "line": line}
    return Result("made", "converged", {}, tables)


@pytest.mark.parametrize(
    ("wrong", "off"),
    [
        ({}, {}),
        ({"load": 1.03}, {"load-1": 0.03, "nodal-pressure": None}),
        ({"strain": 1.1}, {"strain-1": 0.1, "strain-3": 0.1, "strain-below-spots": 0.1}),
        ({"dent": 0.7}, {"residual-line": None}),
        ({"load": 0.0}, {"spots": 1.0, "nodal-pressure": None}),
    ],
)
def test_each_quantity_of_rough_contacts_sees_its_own(wrong, off):
    names = "spots", "load-1", "load-2", "nodal-pressure", "strain-1", "strain-3"
    names += "strain-below-spots", "residual-line"
    fem = asperities(load=0.0) if "spots" in off else asperities()
    found = {name: QUANTITIES[name].between(ASPERITIES, asperities(**wrong), fem) for name in names}
    metrics = {name: "relative_l2" if np.ndim(each.value) else "absolute" for name, each in found.items()}
    metrics |= dict.fromkeys(("load-1", "load-2"), "relative") | {"strain-below-spots": "at_most"}
    errors = {name: error_of(metrics[name], each) for name, each in found.items()}
    if "spots" in off:
        missing = QUANTITIES["load-3"].between(ASPERITIES, fem, fem)
        assert errors["spots"] == 1.0 and math.isnan(missing.value)
        return
    for name, error in errors.items():
        if name in off and off[name] is None:
            assert error > 1e-3
        else:
            assert error == pytest.approx(off.get(name, 0.0), rel=1e-6, abs=1e-12)


def test_asperities_are_where_they_are_asked_for():
    layer = {"law": "linear", "yield_stress": 2.2e9, "modulus": 20e9}
    scene = with_keys(ASPERITIES, "body.plasticity", layer_thickness=0.9e-6)
    scene = varied(scene, layer=layer, friction="map", on_counterbody=True, asperities=24)
    assert scene.surface is None and scene.counterbody.surface.path.values.shape == (24, 24)
    assert 0.9e-6 in scene.grid.depths and scene.friction.path.values.shape == (24, 24)
    assert scene.grid.depths[-1] == 3.6e-6 and scene.body.plasticity.layer.law == "linear"


@pytest.mark.parametrize("jump, above, under", [(0.9, 0.85, 0.95), (0.85, 0.75, 0.85)])
def test_the_strain_on_either_side_of_a_jump_is_found_and_not_between_the_points_beside_it(
    jump, above, under
):
    x, z = np.linspace(-1.0, 1.0, 5), np.arange(5, 200, 10) / 100
    strain = np.where(z < jump, 1.0 + z, 0.5 - 0.1 * z)
    depths = Plane(x, z, strain * np.ones((5, 1)), jump)
    at_z = np.array([0.1, above - 0.01, under + 0.01, 1.5])
    expected = [1.1, 0.99 + above, 0.499 - 0.1 * under, 0.35]
    np.testing.assert_allclose(depths.below(0.0, at_z), expected, rtol=1e-9)
    compared = depths_compared(depths, 0.0, 0.5)
    between = (compared > above + 1e-9) & (compared < under - 1e-9)
    assert not between.any() and ((compared > under) & (compared < under + 0.1)).any() and compared[-1] > 1.5
    even = Plane(x, z, (1.0 + z) * np.ones((5, 1)))
    np.testing.assert_allclose(even.below(0.0, at_z), 1.0 + at_z, rtol=1e-9)


# --- figures --------------------------------------------------------------------------------------------


def test_maps_hold_their_numbers_if_there_are_enough():
    h, e = np.geomspace(0.01, 2.0, 5), np.geomspace(0.1, 10.0, 4)
    own = [{"thickness": x, "ratio": y, "p sam": x * y, "mises sam": -x * y} for x in h for y in e]
    frame = pd.DataFrame(own).assign(sweep="map", counterbody="rigid")
    expected = 100 * np.outer(h, e).ravel()
    maps = films.changes_of_paper(None, frame).drawing
    assert maps.data["change_percent"] == pytest.approx([*expected, *-expected])
    assert films.changes_of_paper(None, frame[:12]) is None


def test_planes_of_a_coated_body_leave_the_interface_blank():
    def jump(x, z):
        return np.where(z < 0.5, 2.0, 1.0)

    own = plane(np.linspace(-2.0, 2.0, 41), np.linspace(0.0, 2.4, 49), jump)
    half = {name: np.asarray(values)[own["x_m"] >= 0] for name, values in own.items()}
    peak = {"mises_max_depth_m": 0.3, "mises_max_Pa": 2.0}
    models = Made(peak, {"plane": own}), Made(peak, {"plane": half}, model=FEM)
    drawing = compared_mises(*models, 1.0, 1.0, film=0.5, element=0.3)
    assert not np.any(np.abs(np.asarray(drawing.data["z/a_0"]) - 0.5) < 0.25 * 0.3)
    assert np.nanmax(np.abs(drawing.data["SAM"] - drawing.data["FEM"])) < 1e-11
