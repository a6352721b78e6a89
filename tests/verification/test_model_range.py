# SPDX-License-Identifier: MIT
"""Where the model ends: what is said, refused and stopped, and what says so of a scene that goes on."""

from math import pi, sqrt

import numpy as np
import pytest
from builders import MODULUS, RADIUS, SPHERE, STEEL, SWIFT, scene_text

import sam
from sam.scene import Result, Scene, Status
from verification.figures.run import drawings_of
from verification.runs import models
from verification.runs.files import read_run
from verification.runs.model_range import OUTSIDE, model_range, range_lines, with_range
from verification.runs.models import ModelError

ELASTIC, YIELDING = {}, {"plasticity": SWIFT}
ELLIPSOID = {"shape": "ellipsoid", "radius_x": RADIUS, "radius_y": 3 * RADIUS}
PUNCH = {"shape": "rounded-punch", "flat_radius": RADIUS, "radius": RADIUS / 2}
SMALL = {"cells": (33, 33)}


def scene(body=ELASTIC, other=SPHERE, poisson=0.3, **tables):
    tables = {"loading": {"force": 1.0}, "grid": SMALL} | tables
    return Scene(body=STEEL | {"poisson": poisson} | body, counterbody=other, **tables)


def force_at(ratio, body, poisson):
    """By Hertz or fully plastic, whichever has the larger contact, on a sphere."""
    hertz = 4 / 3 * 210e9 / (1 - poisson**2) * ratio**3 * RADIUS**2
    if body is ELASTIC:
        return hertz
    stress = 945e6 * (20 + 1e6 * 0.2 * ratio) ** 0.121
    return min(hertz, 3 * stress * pi * (ratio * RADIUS) ** 2)


@pytest.mark.parametrize("ratio", [0.02, 0.1, 0.3, 0.49, 0.51, 1.0, 2.5])
@pytest.mark.parametrize("poisson", [0.3, 0.49])
@pytest.mark.parametrize("body", [ELASTIC, YIELDING], ids=["elastic", "Swift"])
def test_a_sphere_is_said_or_refused_by_its_contact_radius(body, poisson, ratio):
    found = scene(body, poisson=poisson, loading={"force": force_at(ratio, body, poisson)})
    stated = model_range(found)
    assert stated["a_over_R"] == pytest.approx(ratio, rel=1e-6)
    sizes = {name: (abs(each["error"]), each["uncertainty"]) for name, each in stated["quantities"].items()}
    named = {name for name, (error, doubt) in sizes.items() if error > max(0.01, doubt)}
    said = " ".join(range_lines(stated))
    assert all((name.split("_")[0] in said) == (name in named) for name in ("contact_radius", "approach"))
    assert (body is ELASTIC and poisson == 0.3 and ratio == 0.1) <= ("mean pressure 2.9 % too low" in said)
    if ratio < 0.5:
        models.check(found, models.SAM)
        return
    words = r"loading.force = .* N, allowed: at most .*beyond_model = true"
    with pytest.raises(ModelError, match=words) as no:
        models.check(found, models.FEM)
    most = float(str(no.value).partition("at most about ")[2].split()[0])
    assert most == pytest.approx(force_at(0.5, body, poisson), rel=6e-3)  # three digits are said
    models.check(scene(body, loading={"force": most}, solver={"beyond_model": True}), models.SAM)


@pytest.mark.parametrize(
    ("other", "flat", "radii"),
    [(ELLIPSOID, 0.0, (RADIUS, 3 * RADIUS)), (PUNCH, PUNCH["flat_radius"], PUNCH["radius"])],
    ids=["ellipsoid", "rounded-punch"],
)
def test_other_shapes_count_by_their_larger_ratio_and_by_their_slope(other, flat, radii):
    """The contact by the estimate of SAM, which is another one."""
    with pytest.raises(ModelError, match=r"loading\.force") as no:
        models.check(scene(other=other, loading={"force": 1e5}, grid=None), models.SAM)
    most = float(str(no.value).partition("at most about ")[2].split()[0])
    axes = np.array(sam.hertz_semi_axes(scene(other=other, loading={"force": most})))
    assert max((axes - flat) / radii) == pytest.approx(0.5, abs=3e-3)
    models.check(scene(other=other, loading={"force": 0.99 * most}, grid=None), models.SAM)
    assert range_lines(model_range(scene(other=other, loading={"force": 0.2 * most})))


@pytest.mark.parametrize("ratio", [0.5, 2.0])
def test_a_rounded_punch_that_yields_counts_by_its_fully_plastic_contact(ratio):
    """Three times the yield stress at 0.2 (a - b)/R on its area."""
    stress = 945e6 * (20 + 1e6 * 0.2 * ratio) ** 0.121
    force = 3 * stress * pi * (PUNCH["flat_radius"] + ratio * PUNCH["radius"]) ** 2
    stated = model_range(scene(YIELDING, PUNCH, loading={"force": force}))
    assert stated["a_over_R"] == pytest.approx(ratio, rel=1e-6)


@pytest.mark.parametrize(
    ("body", "tables", "key", "most"),
    [
        (ELASTIC, {"loading": {"approach": 1e-4}}, "approach", RADIUS / 4),
        (YIELDING, {"loading": {"approach": 1e-4}}, "approach", RADIUS / 8),
        (ELASTIC, {"loading": {"prescribed": "hertz", "p0": 1e11, "radius": 1e-6}}, "p0", MODULUS / pi),
        (ELASTIC, {"loading": {"approach": 1e-4}, "other": PUNCH}, "approach", None),
    ],
)
def test_an_approach_and_a_given_pressure_count_by_the_sphere_that_makes_them(body, tables, key, most):
    other = None if key == "p0" else SPHERE
    with pytest.raises(ModelError, match=rf"loading\.{key} = ") as no:
        models.check(scene(body, **{"other": other} | tables), models.SAM)
    if most is None:  # of a rounded edge, Sneddon 1965
        b, edge = PUNCH["flat_radius"], PUNCH["radius"]
        a = b + edge / 2
        most = a / edge * (sqrt(a**2 - b**2) - b * np.arccos(b / a))
    assert float(str(no.value).partition("at most about ")[2].split()[0]) == pytest.approx(most, rel=6e-3)


def test_nothing_is_known_of_a_flat_punch_and_its_size_is_not_limited():
    found = scene(other={"shape": "punch", "radius": 1e-6}, loading={"force": 1e3})
    models.check(found, models.SAM)
    assert model_range(found) is None


@pytest.mark.parametrize(("ratio", "said"), [(0.04, 0), (0.2, 1)])
@pytest.mark.parametrize("body", [ELASTIC, YIELDING], ids=["elastic", "Swift"])
def test_below_a_cylinder_nothing_was_measured_and_that_is_said(body, ratio, said):
    """F = pi E* length a^2/(4 R); a solved contact counts by its own half-width."""
    modulus, cylinder = 210e9 / (1 - 0.3**2), {"shape": "cylinder", "radius": RADIUS, "length": 1e-3}
    load = {"force": pi / 4 * modulus * 1e-3 * ratio**2 * RADIUS}
    found = scene(body, cylinder, loading=load, grid={"cells": (33, 1)})
    values = {"contact_half_width_m": 0.9 * ratio * RADIUS, "peeq_max": 0.1}
    solved = Result("sam", Status.CONVERGED, values, {})
    for stated, share in ((model_range(found), 1.0), (model_range(found, solved), 0.9)):
        assert stated["a_over_R"] == pytest.approx(share * ratio, rel=1e-6)
        assert len(range_lines(stated)) == said and stated["quantities"] == {}
        assert all("not measured in plane strain" in line for line in range_lines(stated))


@pytest.mark.parametrize(("worn", "lost"), [(0.0, []), (0.03, ["lost height 5 % of the relief"])])
def test_a_rough_body_counts_by_its_slope_in_contact_and_its_strain(worn, lost):
    """A slope of 0.3, on cells of 1 by 2 m: a sphere at whose edge it is sqrt(2) larger."""
    surface = {"kind": "sinusoid", "amplitude": 1e-8, "wavelength_x": 1e-5}
    wear = {"wear": {"strain_limit": 0.02}, "loading": {"force": 1.0, "unload": True}}
    grid = {"cells": (16, 16), "extent": (2e-5, 2e-5)}
    found = scene(YIELDING, {"shape": "flat"}, grid=grid, surface=surface, **(wear if worn else {}))
    x, y = (each.ravel() for each in np.meshgrid([0.0, 1.0, 2.0], [0.0, 2.0, 4.0, 6.0], indexing="ij"))
    table = {"state": ["peak"] * x.size, "x_m": x, "y_m": y, "height_m": 0.3 * x, "p_Pa": 1.0 * (x < 2.0)}
    table["worn_m"] = np.full(x.size, worn)

    def solved(peeq):
        values = {"peeq_max": peeq, "contact_radius_m": 1e-6}
        return with_range(found, Result("sam", Status.CONVERGED, values, {"surface": table}))

    edge = 0.3 * sqrt(2)
    by_slope, by_strain = solved(0.02), solved(0.2)
    assert by_slope.model_range["a_over_R"] == pytest.approx(edge / sqrt(1 + edge**2), rel=1e-6)
    assert by_strain.model_range["a_over_R"] == pytest.approx(0.2 / 0.4)
    assert "rms slope 0.3" in by_slope.warnings[-1] and "plastic strain 20 %" in by_strain.warnings[-1]
    assert "rule of thumb" in by_slope.warnings[-1] and by_strain.status is Status.CONVERGED
    assert all((words in by_slope.warnings[-1]) == bool(lost) for words in lost or ["lost height"])


SOFT = '[body.coating]\nthickness = "20 um"\nyoung = "2 GPa"\npoisson = 0.3\n[grid]\ncells = [33, 33]\n'


@pytest.mark.parametrize(("more", "code", "status"), [("", 1, "outside-of-model"), ("x", 0, "converged")])
def test_what_only_the_solution_shows_ends_in_a_status_or_goes_on_marked(folder, samfem, more, code, status):
    """A soft coating, which the estimate leaves out."""
    text = scene_text().replace("0.65 N", "12 N") + SOFT
    (folder / "soft.toml").write_text(text + ("[solver]\nbeyond_model = true\n" if more else ""))
    said = samfem("solve", "soft.toml", code=code)
    run = read_run(folder / "soft-sam")
    summary, drawn = run.summary, drawings_of(run)
    assert summary["status"] == status and summary["model_range"]["outside"] is True
    radius = summary["quantities"]["contact_radius_m"]
    assert summary["model_range"]["a_over_R"] == pytest.approx(radius / RADIUS)
    assert "outside of the model: a/R = 0.5" in said.err and ("beyond_model = true" in said.err) == bool(code)
    assert len(run.tables) >= 4 and all((table[OUTSIDE] > 0.5).all() for table in run.tables.values())
    meshes = [*(folder / "soft-sam").glob("*.vt[ru]")]
    assert meshes and drawn and all(OUTSIDE.encode() in mesh.read_bytes() for mesh in meshes)
    for drawing in drawn.values():
        assert drawing.figure.get_supxlabel().startswith("outside of the model: a/R = 0.5")
        assert {*drawing.data[OUTSIDE]} == {summary["model_range"]["a_over_R"]}
