# SPDX-License-Identifier: MIT
"""The advice of `samfem plan`: which measurement a scene is nearest to, and the lines that it gets."""

import json
import math
from itertools import product
from pathlib import Path

import pytest
from builders import running_in

from sam.scene import load_scene
from samfem.cli import main
from verification.cases.case import with_loading
from verification.cases.cost.work_precision import ADVISED
from verification.cases.cost.work_precision_problems import PROBLEMS
from verification.cases.recipes import Resolution, at_ratio, sliding_scene
from verification.cost import advice
from verification.cost.advice import (
    COATED,
    DEEP,
    ELASTIC,
    LOAD_STEPS,
    NEVER,
    ON_TWO_GRIDS,
    ROUGH,
    ROUGH_YIELDING,
    RUNNING_IN,
    SLIDING,
    YIELDING,
    AdviceRow,
    advice_of,
    kind_of,
)
from verification.cost.contact import expected_contact, hertz_of
from verification.cost.plan import plan
from verification.cost.precision import TARGETS
from verification.runs.models import FEM, FEM_3D, MODELS, SAM
from verification.text.console import table_lines

SCENES = Path(advice.__file__).parents[1] / "scenes"


def scene(name: str):
    return load_scene(SCENES / f"{name}.toml")


def row(kind, method, numbers, *, error=0.01, bound="") -> AdviceRow:
    """numbers: resolution, seconds and time over the least."""
    unit = "load steps" if method == LOAD_STEPS else "cells in the contact radius"
    resolution, seconds, relative = numbers
    cost = (seconds, 10 * seconds, relative)
    return AdviceRow(kind, "largest plastic strain", method, error, bound, resolution, unit, 5, *cost)


ROWS = (
    row(YIELDING, SAM, (7.3, 0.42, 1.0)),
    row(YIELDING, FEM, (11.0, 1.3, 3.1)),
    row(YIELDING, FEM_3D, (math.nan,) * 3, bound=NEVER),
    row(YIELDING, LOAD_STEPS, (14.2, 3.0, math.nan)),
    row(YIELDING, SAM, (3.0, 0.1, 1.0), error=0.05, bound="<"),
    row(ELASTIC, SAM, (3.0, 0.05, 1.0)),
)


def test_every_problem_of_the_case_is_the_nearest_to_itself_and_its_table_fits_80_columns():
    for problem in PROBLEMS:
        own = problem.scene(scene(problem.file))
        assert kind_of(own) == problem.kind
        found = advice_of(own, (SAM, FEM, FEM_3D))["table"]
        assert max(map(len, table_lines(found["columns"], found["rows"]))) <= 75


@pytest.mark.parametrize("ratio, kind", [(1.5, ELASTIC), (1.7, YIELDING), (4.4, YIELDING), (4.6, DEEP)])
def test_a_sphere_is_judged_by_its_elastic_pressure(ratio, kind):
    assert kind_of(at_ratio(scene("plastic-swift-rigid"), ratio)) == kind


def test_other_scenes():
    assert kind_of(sliding_scene(scene("plastic-swift-rigid"), 1.5, 0.3, Resolution(4, 4))) == SLIDING
    assert kind_of(scene("hertz-ellipse")) == ELASTIC
    assert kind_of(scene("rough-patch")) == ROUGH and kind_of(scene("rough-asperities")) == ROUGH_YIELDING
    assert kind_of(scene("coated-sliding")) == COATED and kind_of(running_in()) == RUNNING_IN
    assert kind_of(scene("flat-punch")) is None and kind_of(scene("misfit-sphere")) is None
    assert kind_of(with_loading(scene("plastic-perfect"), force=0.0)) == ELASTIC
    assert kind_of(with_loading(scene("plastic-perfect"), force=1e-300)) == ELASTIC


def test_a_given_pressure_is_no_result_but_the_strain_below_it_is():
    given = {"force": None, "prescribed": "hertz", "radius": 5e-6}
    elastic = with_loading(scene("hertz-sphere"), p0=3e9, **given).model_copy(update={"counterbody": None})
    assert kind_of(elastic) is None
    yielding = scene("plastic-swift-rigid").model_copy(update={"counterbody": None})
    assert kind_of(with_loading(yielding, p0=4e9, **given)) == YIELDING
    assert kind_of(with_loading(yielding, p0=7e9, **given)) == DEEP
    assert kind_of(with_loading(yielding, p0=15e9, **given)) is None


def test_table_names_method_cells_time_and_origin():
    yielding = at_ratio(scene("plastic-swift-rigid"), 3.0)
    found = advice_of(yielding, (SAM, FEM, FEM_3D), ROWS)
    assert "case work-precision" in found["words"] and "largest plastic strain" in found["words"]
    assert "cells in the contact radius, load steps, processor time (about)" in found["words"]
    assert found["table"]["columns"] == ["error", "method", "cells", "steps", "time", "ratio"]
    assert found["table"]["rows"] == [  # ten steps, five measured; the largest error first
        ["5 %", "sam", "<= 3", "-", "0.2 s", "1"],
        ["1 %", "sam", "8", "15", "0.8 s", "1"],
        ["1 %", "fem-axisymmetric", "11", "15", "3 s", "3.1"],
        ["1 %", "fem-3d", "not reached", "15", "-", "-"],
    ]
    assert json.loads(json.dumps(found))["rows"][2]["seconds"] is None
    assert {row["method"] for row in advice_of(yielding, (SAM,), ROWS)["rows"]} == {SAM, LOAD_STEPS}
    elastic = advice_of(with_loading(scene("hertz-sphere"), steps=40), (SAM,), ROWS)
    assert elastic["rows"][0]["seconds"] == 0.05  # does not grow with its steps


def test_the_committed_table_covers_every_kind_and_error():
    rows = advice.table()
    assert {row.kind for row in rows} == {problem.kind for problem in PROBLEMS}
    for problem in PROBLEMS:
        own = [row for row in rows if row.kind == problem.kind]
        methods = {ADVISED[method.name] for method in problem.methods if method.name in ADVISED}
        measured = {(row.method, row.error) for row in own if row.method != LOAD_STEPS}
        assert measured == set(product(methods, TARGETS))
        for row in own:
            assert (row.bound == NEVER) == math.isnan(row.seconds)
            assert row.method in (*MODELS, ON_TWO_GRIDS, LOAD_STEPS) and row.bound in ("", "<", NEVER)


def test_plan_is_short_and_in_numbers_the_same(capsys):
    file = SCENES / "plastic-swift-rigid.toml"
    found = plan(load_scene(file))
    assert main(["plan", str(file), "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == json.loads(json.dumps(found.content))
    assert main(["plan", str(file)]) == 0
    assert (short := capsys.readouterr().out.splitlines()) == str(found).splitlines()
    assert len(short) == 5 + len(found.warnings)
    assert f"sam {found.cells_in_radius:.3g}, 0.3 %" in short[1] and max(map(len, short)) <= 112
    assert (found.error, found.contact["over_yield"]) == (0.003, pytest.approx(4.0, rel=1e-3))


def test_the_expected_contact_is_that_of_hertz_and_of_a_light_rough_contact():
    """An approach is turned into its force; below a plane the share has the slope 2 over p/(E* h')."""
    pressed = scene("hertz-ellipse")
    exact = hertz_of(pressed)
    by_approach = {"force": None, "approach": exact["approach_m"]}
    again = hertz_of(with_loading(pressed, **by_approach))
    assert again.pop("force_N") == pytest.approx(pressed.loading.force, rel=1e-9)
    assert again == pytest.approx({name: exact[name] for name in again}, rel=1e-9)
    found = expected_contact(pressed)
    assert found["p0_Pa"] == pytest.approx(exact["p_max_Pa"], rel=1e-6)
    light = expected_contact(with_loading(scene("pin-recipe"), force=1e-4))
    over = light["p_nominal_Pa"] / (2 * light["p_spots_Pa"])
    assert light["contact_share"] == pytest.approx(2 * over, rel=1e-3)
    assert not hertz_of(scene("coated-sphere")) and not hertz_of(scene("rough-patch"))
