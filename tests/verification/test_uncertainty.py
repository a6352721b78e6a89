# SPDX-License-Identifier: MIT
"""The uncertainty of quantities: the rule against powers of h, the scenes it is taken from, the command."""

import json
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from builders import PERFECT, SPHERE, STEEL, scene_text

from sam import choose_grid
from sam.scene import Result, Scene, Status
from verification.cases.cost import uncertainty as study
from verification.runs import models
from verification.runs.files import read_run
from verification.runs.models import FEM, FEM_3D, SAM
from verification.uncertainty.rule import bound, converging, order_seen
from verification.uncertainty.solving import family, solve, step_counts

ASKED = {"uncertainty": True}
GRID = {"cells": (33, 33)}
ELASTIC = {"body": STEEL, "counterbody": SPHERE, "loading": {"force": 0.1}, "grid": GRID, "solver": ASKED}
YIELDING = ELASTIC | {"body": STEEL | {"plasticity": PERFECT}, "loading": {"force": 0.1, "steps": 9}}
SINUSOID = {"kind": "sinusoid", "amplitude": 1e-7, "wavelength_x": 1e-5}
ROUGH = ELASTIC | {"counterbody": {"shape": "flat"}, "surface": SINUSOID}
ROUGH |= {"grid": {"cells": (48, 48), "extent": (3e-5, 3e-5)}}


@pytest.mark.parametrize("sizes", [(1.0, 1.5, 2.3), (1.0, 0.6, 0.4)], ids=["coarser", "finer"])
@pytest.mark.parametrize("order", [1.0, 2.0])
def test_an_error_of_the_formal_order_is_covered_three_times(order, sizes):
    """f = 7 - 5 h^p: exactly 3 times the error of the first value, and p is seen."""
    values = [7.0 - 5.0 * h**order for h in sizes]
    assert bound(values, sizes, order) == pytest.approx(3 * 5.0 * sizes[0] ** order, rel=1e-12)
    assert order_seen(values, sizes) == pytest.approx(order, rel=1e-9) and converging(values, sizes)


def test_the_larger_of_both_changes_counts():
    """By hand: 1, 1.1, 0.6 at h = 1, 2, 3: 3 max(0.1/3, 0.4/8) with order 2; no order is seen."""
    assert bound((1.0, 1.1, 0.6), (1, 2, 3), 2.0) == pytest.approx(0.15, rel=1e-12)
    assert order_seen((1.0, 1.1, 0.6), (1, 2, 3)) is None and converging((1.0, 1.1, 0.6), (1, 2, 3))
    assert not converging((1.0, 1.6, 1.8), (1, 2, 3)) and order_seen((1.0, 1.6, 1.8), (1, 2, 3)) is None


def test_orders_are_looked_for_between_a_thousandth_and_twelve_where_changes_fall():
    """A change as large as the one before has none, though one would make it of sizes in different ratios."""
    sizes = np.array([1.0, 1.3, 1.8])
    for order, seen in ((12.0, 11.995), (1e-3, 1.0005e-3)):
        assert order_seen(7.0 - 5.0 * sizes**seen, sizes) == pytest.approx(seen, rel=1e-6)
        assert order_seen(7.0 - 5.0 * sizes ** (order**2 / seen), sizes) is None
    sizes = (1.0, 2.0, 2.9)
    assert order_seen((1.0, 1.9998, 3.0), sizes) is not None and order_seen((1.0, 2.0002, 3.0), sizes) is None


@pytest.mark.parametrize("sizes", [(1.0,), (1.0, 1.0), (0.0, 1.0), (1.0, 2.0, 3.0)])
def test_sizes_that_say_nothing_are_refused(sizes):
    with pytest.raises(ValueError, match="two or more"):
        bound((1.0, 2.0), sizes, 2.0)


def test_the_cells_and_layers_of_a_yielding_scene_grow_together():
    scene = Scene(**YIELDING | {"grid": {"cells": (65, 65)}})
    found = family(scene, SAM)
    assert [member.number for member in found.cells] == [65, 43, 29]
    assert [member.number for member in found.steps] == [9, 6, 4]
    assert not any(member.scene.solver.uncertainty for member in found.all) and len(found.all) == 5
    grids = [choose_grid(member.scene) for member in found.cells]
    assert np.ptp([grid.nx * grid.hx for grid in grids]) < 1e-12 * grids[0].nx * grids[0].hx
    assert np.ptp([grid.faces[-1] for grid in grids]) == 0.0
    layers = np.array([len(grid.depths) for grid in grids])
    assert np.allclose(layers / layers[0], [1, 43 / 65, 29 / 65], atol=0.5 / layers[0])


def test_a_face_at_a_kink_of_the_yield_stress_stays():
    plasticity = PERFECT | {"layer": {"law": "perfect", "yield_stress": 2e9}, "layer_thickness": 0.4e-6}
    scene = Scene(**YIELDING | {"body": STEEL | {"plasticity": plasticity}})
    assert all(0.4e-6 in member.scene.grid.depths for member in family(scene, SAM).cells[1:])


def test_a_row_of_cells_below_a_cylinder_stays_one_whose_size_is_its_width():
    cylinder = {"shape": "cylinder", "radius": 1e-2, "length": 1e-2}
    scene = Scene(body=STEEL | {"plasticity": PERFECT}, counterbody=cylinder, loading={"force": 12250.0})
    cells = family(scene, SAM).cells
    sizes = [member.size * member.number / cells[0].size / cells[0].number for member in cells]
    assert sizes == pytest.approx([1, 1, 1], rel=1e-12)  # over the same side
    assert [member.scene.grid.cells[1] for member in cells[1:]] == [1, 1]


def test_the_mesh_and_the_box_of_the_finite_elements():
    found = family(Scene(**YIELDING), FEM)
    assert [member.number for member in found.cells] == [16, 9, 5]
    assert [member.scene.fem.box for member in found.box] == [10.0, pytest.approx(10 / 1.5)]
    assert {member.scene.fem.cells_per_radius for member in (*found.steps, *found.box)} == {5}
    assert not family(Scene(**ELASTIC), FEM).steps
    for box, boxes in ((4.5, 2), (4.4, 0)):  # none of less than three radii
        assert len(family(Scene(**ELASTIC | {"fem": {"box": box}}), FEM).box) == boxes
    for count, counts in ((9, [9, 6, 4]), (12, [12, 8, 5]), (32, [32, 16, 8])):
        scene = Scene(**ELASTIC | {"fem": {"cells_per_radius": count}})
        assert [member.number for member in family(scene, FEM).cells] == counts
    assert [member.number for member in family(Scene(**ELASTIC), FEM_3D).cells] == [16, 11, 7]


@pytest.mark.parametrize("model", [SAM, FEM])
def test_the_others_of_an_elastic_body_take_its_load_at_once(model):
    scene = Scene(**ELASTIC | {"loading": {"force": 0.1, "steps": 9, "unload": True, "unload_steps": 4}})
    first, *others = (member.scene.loading for member in family(scene, model).all)
    assert first == scene.loading
    assert {(each.steps, each.unload_steps, each.unload) for each in others} == {(1, None, True)}
    path = {"start": (0.0, 0.0), "end": (1e-6, 0.0), "steps": 3}
    moved = family(Scene(**ELASTIC | {"loading": {"force": 0.1, "steps": 2, "path": path}}), SAM)
    assert {member.scene.loading.steps for member in moved.cells} == {2}


def test_steps_along_a_path_become_fewer_with_those_that_put_the_load_on():
    path = {"start": (0.0, 0.0), "end": (1e-6, 0.0), "steps": 20}
    given = {"prescribed": "hertz", "p0": 4e9, "radius": 1e-6, "steps": 4, "path": path}
    scene = Scene(**{key: YIELDING[key] for key in ("body", "solver")}, loading=given)
    found = [member.scene.loading for member in family(scene, SAM).steps]
    assert [(each.steps, each.path.steps) for each in found] == [(4, 20), (3, 13), (2, 9)]


@pytest.mark.parametrize(
    "count, counts", [(1, (1, 2, 3)), (2, (2, 3, 5)), (4, (4, 3, 2)), (5, (5, 3, 2)), (20, (20, 13, 9))]
)
def test_numbers_of_load_steps(count, counts):
    assert step_counts(count) == counts


def made(scene: Scene, **cost) -> Result:
    """A result whose strain is 5 + 400/cells^2 + 0.2/steps, on a contact of a quarter of the grid."""
    cells, steps = scene.grid.cells[0], scene.loading.steps
    strain = 5 + 400 / cells**2 + 0.2 / steps
    values = {"peeq_max": strain, "contact_radius_m": 1e-4, "mises_max_depth_m": 1.0, "force_N": 0.1}
    found = {"cells": [cells, cells]}
    return Result(SAM, Status.CONVERGED, values, {}, discretisation=found, cost={"solve_s": 1.0} | cost)


def entries(scene: Scene, solver) -> dict:
    return solve(scene, SAM, solver).uncertainty


def test_cells_and_steps_are_added_up():
    """Of the strain above, with the rule's factors: 3 400/65^2 + 2 0.2/9 f(65)/f(29); force is given."""
    scene = Scene(**YIELDING | {"grid": {"cells": (65, 65), "extent": (4e-4, 4e-4)}})
    found, result = entries(scene, lambda each, _: made(each)), made(scene)
    entry, values = found["peeq_max"], [5 + 400 / n**2 + 0.2 / 9 for n in (65, 43, 29)]
    assert entry["u_cells"] == pytest.approx(3 * 400 / 65**2, rel=1e-9)
    assert entry["u_steps"] == pytest.approx(2 * 0.2 / 9 * values[0] / values[2], rel=1e-9)
    assert entry["u_num"] == entry["u_cells"] + entry["u_steps"] and entry["values"] == values
    assert entry["order_seen"] == pytest.approx(2.0) and entry["flag"] == "" and "force_N" not in found
    moves = "the place of a maximum moves by whole points"
    assert found["mises_max_depth_m"] == {"u_num": None, "flag": moves}

    def outlined(each, _):
        area = {"contact_area_m2": np.pi * 1e-8 * (1 + 400 / each.grid.cells[0] ** 2)}
        return replace(made(each), quantities=made(each).quantities | area)

    found, edge = entries(scene, outlined), np.pi * 1e-8 * 400 / 65**2
    assert found["contact_area_m2"]["u_cells"] == pytest.approx(2 * edge, rel=1e-9)
    assert found["peeq_max"]["u_cells"] == entry["u_cells"]
    least = entries(scene, lambda *_: result)["peeq_max"]  # without any change
    assert least["u_num"] == scene.solver.tolerance * least["values"][0] and least["relative"] == 1e-6


def test_values_that_agree_by_chance_leave_what_the_edge_of_the_contact_does():
    """0.1 of the value, of the area 0.3, over the square of the cells in the radius."""
    scene = Scene(**ELASTIC | {"grid": {"cells": (65, 65), "extent": (4e-4, 4e-4)}})
    result = made(scene)
    touching = replace(result, quantities=result.quantities | {"contact_area_m2": np.pi * 1e-8})
    found = entries(scene, lambda *_: touching)
    exact = 0.1 * result.quantities["peeq_max"] / 16.25**2
    assert found["peeq_max"]["u_cells"] == found["peeq_max"]["u_num"] == pytest.approx(exact, rel=1e-12)
    assert found["contact_area_m2"]["u_cells"] == pytest.approx(0.3 * np.pi * 1e-8 / 16.25**2, rel=1e-12)
    nodal = solve(scene, FEM, lambda *_: replace(touching, model=FEM)).uncertainty
    assert nodal["peeq_max"]["u_cells"] == 0.0


def test_the_edge_of_a_contact_inside_an_element_leaves_something_of_the_approach_alone():
    """Of a body that yields, 20 elements in the radius; that of an elastic one is at a node."""
    wet = {"contact_area_m2": np.pi * 1e-8, "approach_m": 2e-7, "peeq_max": 0.01}
    result = Result(FEM, Status.CONVERGED, wet, {}, cost={"solve_s": 1.0})
    own = {"grid": None, "fem": {"cells_per_radius": 20}}
    scenes = (Scene(**tables | own) for tables in (YIELDING, ELASTIC))
    yielding, elastic = (solve(scene, FEM, lambda *_: result).uncertainty for scene in scenes)
    assert yielding["approach_m"]["u_cells"] == pytest.approx(0.1 * 2e-7 / 20**2, rel=1e-12)
    assert yielding["peeq_max"]["u_cells"] == 0.0 == elastic["approach_m"]["u_cells"]


@pytest.mark.parametrize(
    "cells, spoilt, words",
    [
        (33, {}, "under-resolved: 15 cells, 3.8 in the contact radius, 4 needed"),
        (65, {"29 cells": {"status": Status.UNDER_RESOLVED}}, "29 cells: under-resolved"),
        (65, {"6 load steps on 29 cells": {"cost": {"step_cuts": 2}}}, "raise loading.steps"),
    ],
)
def test_solves_that_are_no_family_give_none(cells, spoilt, words):
    """Too coarse a grid, one that does not converge, halved load steps in one of the solves."""
    scene = Scene(**YIELDING | {"grid": {"cells": (cells, cells), "extent": (4e-4, 4e-4)}})

    found = entries(scene, lambda each, label: replace(made(each), **spoilt.get(label, {})))["peeq_max"]
    assert found["u_num"] is None and words in found["flag"]


@pytest.mark.parametrize(
    ("solver", "status", "found"),
    [(ASKED, Status.NOT_CONVERGED, {}), ({}, Status.CONVERGED, None)],
    ids=["not converged", "not asked for"],
)
def test_nothing_more_is_solved(solver, status, found):
    calls, failed = [], Result(SAM, status, {"peeq_max": None}, {})
    result = solve(Scene(**YIELDING | {"solver": solver}), SAM, lambda *call: calls.append(call) or failed)
    assert len(calls) == 1 and result.uncertainty == found and "quantities" not in result.tables


@pytest.mark.parametrize(
    "tables, larger, solves",
    [
        (YIELDING | {"grid": {"cells": (65, 65)}}, {"43 cells": (65, 65), "29 cells": (45, 45)}, 7),
        (ROUGH | {"body": YIELDING["body"]}, {"22 cells": (22, 22)}, 7),
        (ROUGH, {}, 3),
    ],
    ids=["sphere", "rough", "elastic and rough"],
)
def test_coarse_grids_that_the_plastic_zone_leaves_have_more_cells_of_the_same_size(tables, larger, solves):
    """Each is solved again, once; a rough patch has more layers alone, and an elastic one nothing more."""
    calls, more = {}, " and more beside them"

    def solver(each: Scene, label: str) -> Result:
        at_edge = bool(calls) and more not in label
        calls[label] = each
        return replace(made(each), status=Status.PLASTIC_ZONE_AT_GRID_EDGE if at_edge else Status.CONVERGED)

    found = entries(Scene(**tables), solver)["peeq_max"]
    assert len(calls) == solves and (found["u_num"] is None) == ("surface" in tables)
    for label, cells in larger.items():
        small, large = choose_grid(calls[label]), choose_grid(calls[label + more])
        beside = (cells[0] - small.nx) // 2
        assert large.shape == cells
        assert large.x[beside : cells[0] - beside] == pytest.approx(small.x, rel=1e-12)
        assert list(large.faces[: len(small.faces)]) == list(small.faces)
        assert 1.5 * small.faces[-1] <= large.faces[-1] < 2 * small.faces[-1]


def test_a_coarser_grid_that_the_model_refuses_gives_none():
    """The rounded edge of a punch on two cells."""
    punch = {"shape": "rounded-punch", "flat_radius": 1e-5, "radius": 1e-4}
    scene = Scene(**ELASTIC | {"counterbody": punch, "loading": {"force": 0.3}, "grid": {"cells": (65, 65)}})
    found = entries(scene, lambda each, _: made(each))["peeq_max"]
    assert found["u_num"] is None and "grid.cells" in found["flag"]


def test_of_a_rough_body_only_what_the_balance_of_forces_decides():

    def solver(each: Scene, _label: str) -> Result:
        values = {"approach_m": 1 + 1 / each.grid.cells[0], "p_max_Pa": 1.0}
        return replace(made(each), quantities=values)

    found = entries(Scene(**ROUGH), solver)
    assert found["approach_m"]["u_num"] > 0.0 and found["approach_m"]["cells"] == [48, 32, 22]
    assert found["p_max_Pa"]["u_num"] is None and "single spot" in found["p_max_Pa"]["flag"]


FINER = ELASTIC | {"grid": {"cells": (39, 39)}}
FILM = {"coating": {"young": 5e10, "poisson": 0.3, "thickness": 1e-6}}


@pytest.mark.parametrize(
    "tables, share", [(FINER | {"body": STEEL | FILM}, 0.6), (ROUGH, 0.1)], ids=["coated", "rough"]
)
def test_depths_without_a_maximum_are_left_out_of_the_others_and_change_nothing(tables, share):
    scene, seen = Scene(**tables), []

    def solver(each: Scene, label: str) -> Result:
        seen.append((each, models.solve(each, SAM)))
        return seen[-1][1]

    found = solve(scene, SAM, solver).uncertainty
    deep = len(choose_grid(scene).depths)
    assert all(len(choose_grid(each).depths) < share * deep for each, _ in seen[1:])
    whole = models.solve(family(scene, SAM).cells[-1].scene, SAM).quantities
    values = {name: whole[name] for name, entry in found.items() if entry["u_num"]}
    assert values and {name: found[name]["values"][-1] for name in values} == values


def test_what_a_doubtful_reference_says_does_not_count():
    """In the case of the uncertainties: one that is known to less than a third of an uncertainty counts."""
    entry = {"values": [1.0, 1.2, 1.5], "cells": [4, 3, 2], "u_num": 0.3, "u_steps": 0.0, "u_box": 0.0}
    known, unknown = (study.judged(entry, 1.0, doubt=0.3 / each) for each in (3.1, 2.9))
    assert known["covered-by-uncertainty"] == 1.0 and "over-error" not in unknown
    assert study.judged(entry, 2.0, doubt=0.0)["covered-by-uncertainty"] == 0.0
    values = (study.judged(entry, 1.2, doubt=doubt) for doubt in (0.09, 0.11))
    named = ({"problem": f"film {k}", "quantity": study.AREA} | each for k, each in enumerate(values))
    rows = pd.DataFrame(list(named))
    told = [each[:5] for each in study.both_rules(rows).rows]
    assert told == [[name, "1", "1", "100", "1.5"] for name in ("film", "contact area")]


def test_medians_are_of_quantities_with_three_values():
    of = {"peeq_max": (2.0, 3.0, 9.0), "p_max_Pa": (4.0, 5.0, 6.0), "few": (1.0, 1.0)}
    of[study.AREA] = 7.0, 8.0, 9.0
    rows = pd.DataFrame([{"quantity": name, "x": each} for name, own in of.items() for each in own])
    assert study.smallest_median(rows, "x") == 3.0 and study.largest_median(rows, "x") == 5.0


# the command


TEXT = scene_text(add="[grid]\ncells = [37, 37]\n")


@pytest.fixture
def sphere(folder):
    (folder / "sphere.toml").write_text(TEXT)
    return folder


def test_the_command_prints_and_writes_it(sphere, samfem):
    said = samfem("solve", "sphere.toml", "--uncertainty").out
    assert "uncertainty: 3 times the estimated error, from 37, 25, 17 cells" in said
    run = read_run(sphere / "sphere-sam")
    table = run.tables["quantities"].set_index("quantity")
    assert table.u_num["p_max_Pa"] == run.uncertainty["p_max_Pa"]["u_num"] > 0.0
    assert "whole points" in table.flag["mises_max_depth_m"]
    plain = json.loads((sphere / "sphere-sam" / "summary.json").read_text())["quantities"]
    samfem("solve", "sphere.toml", "--out", "plain")
    again = read_run(sphere / "plain")
    assert again.quantities == plain and again.uncertainty is None and "quantities" not in again.tables
    assert not (sphere / "sphere-sam" / "members").exists()


def test_no_uncertainty_at_all_is_an_error_that_says_what_to_change(sphere, samfem):
    (sphere / "sphere.toml").write_text(TEXT.replace("37, 37", "33, 33"))
    said = samfem("solve", "sphere.toml", "--uncertainty", code=1)
    assert "sam: no uncertainty of any quantity: the coarsest grid is under-resolved: 15 cells" in said.err
    assert said.err.endswith("raise grid.cells to [37, 37]\n") and "+-" not in said.out


def test_resume_begins_with_the_first_solve_that_is_not_finished(sphere, samfem, monkeypatch):
    original, calls = models.solve, []

    def interrupted(scene, *rest, **how):
        calls.append(scene.grid.cells[0])
        if len(calls) == 3:
            raise KeyboardInterrupt
        return original(scene, *rest, **how)

    monkeypatch.setattr(models, "solve", interrupted)
    command = ("solve", "sphere.toml", "--uncertainty", "--out")
    assert "--resume continues with 17 cells" in samfem(*command, "out", code=130).err
    assert not (sphere / "out" / "summary.json").exists()
    assert "25 cells: already solved" in samfem(*command, "out", "--resume").err
    assert calls == [37, 25, 17, 17]
    samfem(*command, "whole")
    tables = {path.name: path.read_bytes() for path in (sphere / "whole").glob("*.csv")}
    assert tables == {path.name: path.read_bytes() for path in (sphere / "out").glob("*.csv")}
    assert read_run(sphere / "out").uncertainty == read_run(sphere / "whole").uncertainty
    assert "already finished" in samfem(*command, "out", "--resume").err


@pytest.mark.parametrize(
    "change, words",
    [
        ({"solver": "extrapolate = true"}, "solver.uncertainty = true: false with extrapolate"),
        ({"surface": 'kind = "file"\npath = "map.csv"'}, 'surface.path without resample = "fourier"'),
    ],
)
def test_what_has_no_coarser_grid_is_refused(sphere, refused, change, words):
    rows = [f"{x},{y},{1e-9 * x * y}" for x in range(9) for y in range(9)]
    (sphere / "map.csv").write_text("\n".join(["x_m,y_m,height_m", *rows]))
    text = scene_text() + "".join(f"[{table}]\n{keys}\n" for table, keys in change.items())
    (sphere / "other.toml").write_text(text)
    assert words in refused("solve", "other.toml", "--uncertainty")
    solver = "" if "solver" in change else "[solver]\n"
    (sphere / "asked.toml").write_text(f"{text}{solver}uncertainty = true\n")
    assert words in refused("solve", "asked.toml")
