# SPDX-License-Identifier: MIT
"""Data of the user beside both models: errors that are put in are found, wrong data refused by name."""

import numpy as np
import pandas as pd
import pytest
import pyvista
from builders import parsed
from stored import BOTH
from vtkmodules.vtkIOExodus import vtkExodusIIWriter

from sam import hertz_semi_axes
from sam.scene import Scene, SceneError, resolved
from samfem.compared import NOT_COMPARED, asked
from samfem.refusals import SeveralError
from verification.compare.comparison import CENTRE
from verification.compare.own_data import _expected, read_data
from verification.runs.files import write_run
from verification.runs.store import Store, solve_or_reuse

SCENE = parsed()
PRESSURES = ("p_max_Pa", "p_center_Pa", "p_Pa over the contact")
OF_STRESS = ("mises_max_Pa", "mises_max_depth_m", "mises_Pa on the axis", "mises_Pa in the plane y = 0")


ABAQUS = """file = "abaqus.vtu"
length_unit = "mm"
stress_unit = "MPa"
axes = { x = "x", z = "-y" }
pressure = "CPRESS"
displacement = "U"
stress = "S"
components = ["xx", "yy", "zz", "xy", "xz", "yz"]
"""
STRESS = ABAQUS[ABAQUS.index("stress = ") :]
FROM_SCENE = [0, 2, 1, 4, 5, 3]
"""S11 (radial), S22 (axial, upwards), S33 (hoop), S12, S13, S23 among xx, yy, zz, yz, xz, xy of a result."""


def abaqus_mesh(fem) -> pyvista.UnstructuredGrid:
    """The axisymmetric result in mm and MPa, y upwards."""
    points, quads = np.asarray(fem.fields.points), np.asarray(fem.fields.cells["quad"])
    places = 1e3 * points[:, [0, 2, 1]] * [1.0, -1.0, 1.0]
    mesh = pyvista.UnstructuredGrid({pyvista.CellType.QUAD: quads}, places)
    mesh.point_data["CPRESS"] = np.asarray(fem.fields.point_data["p_Pa"]) * 1e-6
    uz = np.asarray(fem.fields.point_data["uz_m"])
    mesh.point_data["U"] = np.stack([0 * uz, -1e3 * uz, 0 * uz], axis=1)
    stress = np.asarray(fem.fields.cell_data["stress_Pa"])[:, FROM_SCENE] * 1e-6
    mesh.cell_data["S"] = stress * [1, 1, 1, -1, 1, -1]  # axial upwards: shear with it changes its sign
    return mesh


def mirrored(mesh: pyvista.UnstructuredGrid) -> pyvista.UnstructuredGrid:
    """Both sides of the axis: the plane y = 0 of a mesh in space."""
    other = mesh.copy()
    other.points[:, 0] *= -1.0
    return mesh.merge(other, merge_points=False)


@pytest.fixture(scope="module")
def store(tmp_path_factory):
    return Store(tmp_path_factory.mktemp("store"))


@pytest.fixture(scope="module")
def results(store):
    """(SAM, FEM) of the default scene, kept in the store."""
    return tuple(solve_or_reuse(store, SCENE, model)[0] for model in BOTH)


@pytest.fixture
def beside(results, store, tmp_path):
    """Quantity -> row of the one data that are compared, and the frame of the comparison."""

    def run(path):
        found = asked(SCENE, data=[tmp_path / path]).answer(store=store)
        assert not found.failed
        return {row.quantity: row for row in found.beside[0]}, found.frame.set_index("quantity")

    return run


@pytest.fixture
def mapped(tmp_path):
    """Writes a mesh and its mapping, with pieces of the text replaced."""

    def write(mesh, *edits, name="abaqus.vtu"):
        text = ABAQUS
        for old, new in (("abaqus.vtu", name), *edits):
            assert old in text
            text = text.replace(old, new)
        if mesh is not None:
            mesh.save(tmp_path / name)
        (tmp_path / "abaqus.toml").write_text(text)
        return "abaqus.toml"

    return write


def test_a_run_beside_both_models_is_compared_as_the_model_is(results, beside, tmp_path):
    """The finite-element run as data gives the rows of SAM and FEM; only the order of a sum may differ."""
    write_run(results[1], SCENE, tmp_path / "own")
    rows, frame = beside("own")
    assert len(rows) == len(frame) and (frame["own_passed"] == "True").all()
    for name, row in rows.items():
        exact = row.row.metric == "relative_l2"
        close = 1e-12 if exact else 1e-6
        assert row.error == pytest.approx(frame["difference"][name], rel=close, abs=0.0 if exact else close)
        assert row.expected == pytest.approx(frame["fem"][name], rel=close)
    assert (frame["own_tolerance"] == frame["tolerance"]).all()


def test_a_history_gives_the_quantities_of_its_largest_force(results, beside, tmp_path):
    columns = "force_N", "approach_m", "contact_area_m2"
    history = pd.DataFrame({name: results[1].tables["history"][name] for name in columns})
    history["approach_m"] *= 1.01
    history.assign(force_N=history["force_N"] / 4).to_csv(tmp_path / "quarter.csv", index=False)
    rows, _ = beside("quarter.csv")  # of the body
    assert not rows["force_N"].passed and rows["force_N"].error == pytest.approx(3.0)
    history.to_csv(tmp_path / "own.csv", index=False)
    rows, _ = beside("own.csv")
    assert set(rows) == {"force_N", "approach_m", "contact_radius_m"}
    assert rows["contact_radius_m"].passed and rows["force_N"].passed
    assert rows["approach_m"].error == pytest.approx(0.01 / 1.01, abs=3e-4) and not rows["approach_m"].passed


def test_a_mesh_in_other_units_and_axes_agrees(results, beside, mapped):
    rows, frame = beside(mapped(abaqus_mesh(results[1])))
    assert all(row.passed for row in rows.values())
    assert {*PRESSURES, *OF_STRESS, "uz_m on the line"} <= set(rows)
    assert set(frame.index[frame["abaqus_passed"] == NOT_COMPARED]) == {"approach_m", "contact_radius_m"}


def test_a_mesh_that_is_shifted_by_a_tenth_of_the_contact_is_off_by_a_tenth(results, beside, mapped):
    shift = 0.1 * results[1].quantities["contact_radius_m"] * 1e3
    rows, _ = beside(mapped(mirrored(abaqus_mesh(results[1]))))
    assert all(row.passed for row in rows.values())
    rows, _ = beside(mapped(mirrored(abaqus_mesh(results[1])).translate((shift, 0.0, 0.0))))
    assert rows[CENTRE].error == pytest.approx(0.1, abs=2e-3) and not rows[CENTRE].passed
    assert not rows["p_Pa over the contact"].passed and rows["p_max_Pa"].passed
    at = f"origin = [{shift}, 0.0, 0.0]\n"
    rows, _ = beside(mapped(None, ("axes", at + "axes")))  # said where it is, all is well
    assert all(row.passed for row in rows.values()) and rows[CENTRE].error < 1e-3


def test_an_exodus_mesh_is_read(results, beside, mapped, tmp_path):
    mesh = abaqus_mesh(results[1])
    mesh.cell_data.clear()
    writer = vtkExodusIIWriter()
    writer.SetFileName(str(tmp_path / "own.exo"))
    writer.SetInputData(mesh)
    writer.Write()
    rows, _ = beside(mapped(None, (STRESS, ""), name="own.exo"))
    assert set(rows) == {*PRESSURES, CENTRE, "uz_m on the line"} and all(row.passed for row in rows.values())


def test_a_mesh_of_several_steps_is_read_at_its_last_or_a_named_one(results, beside, mapped, tmp_path):
    mesh, sets = abaqus_mesh(results[1]), ""
    for step, share in ((1, 0.5), (2, 2.0)):  # the second is the whole pressure
        mesh.point_data["CPRESS"] *= share
        mesh.save(tmp_path / f"own-{step}.vtu")
        sets += f'<DataSet timestep="{step}" file="own-{step}.vtu"/>'
    (tmp_path / "own.pvd").write_text(f'<VTKFile type="Collection"><Collection>{sets}</Collection></VTKFile>')
    assert beside(mapped(None, name="own.pvd"))[0]["p_max_Pa"].passed
    rows, _ = beside(mapped(None, ("axes", "step = 1\naxes"), name="own.pvd"))
    assert rows["p_max_Pa"].error == pytest.approx(1.0, abs=1e-2)  # half of it
    third = mapped(None, ("axes", "step = 3\naxes"), name="own.pvd")
    assert "step = 3: at most 2" in refused(third, tmp_path)


def refused(name, folder, scene=SCENE) -> str:
    with pytest.raises(SceneError) as caught:
        read_data(folder / name, scene)
    return str(caught.value)


# fmt: off
WRONG_MAPPINGS = {
    "stress unit": ([('"MPa"', '"GPa"')], "line.p_Pa = at most 8.47 TPa: it is in Pa, and expected at"),
    "length unit": ([('"mm"', '"m"')], 'length_unit = "m": the contact is at the origin with a radius'),
    "small length unit": ([('"mm"', '"um"')], 'length_unit = "um"'),
    "no unit": ([('"mm"', '"MPa"')], 'length_unit = "MPa": a unit of the dimension of m'),
    "missing unit": ([('length_unit = "mm"\n', "")], "length_unit is missing: required"),
    "upside down": ([('"-y"', '"y"')], 'axes.z = "y": the contact is at the origin'),
    "place": ([("axes", "origin = [1, 0.0, 0.0]\naxes")], "they do not overlap"),
    "step": ([("axes", "step = 0\naxes")], "a whole number from 1"),
    "origin": ([("axes", "origin = [1.0, 0.0]\naxes")], "three numbers in length_unit"),
    "one axis": ([('"-y"', '"x"')], "another axis of the mesh than x, which is x"),
    "array": ([('"CPRESS"', '"CPRES"')], "unknown array 'CPRES' (did you mean CPRESS?): the mesh has CPRESS"),
    "components": ([('"S"', '"U"')], "6 components, here 3"),
    "key": ([("pressure", "presure")], "presure = \"CPRESS\": unknown key, did you mean pressure?"),
    "file": ([("abaqus.vtu", "none.vtu")], 'file = "none.vtu": no mesh: cannot be read'),
    "no mesh": ([("abaqus.vtu", "abaqus.toml")], 'file = "abaqus.toml": no mesh: its name ends in none of'),
    "above": ([("abaqus.vtu", "../abaqus.vtu")], "outside the folder of the mapping: copy it there"),
    "absolute": ([("abaqus.vtu", "/abaqus.vtu")], 'file = "/abaqus.vtu": a path from the'),
    "escapes in a key": ([("stress_unit", '"\\u001b[31m\\n"')], "?[31m? = "),
    "not TOML": ([("=", ":")], "not TOML"),
}
# fmt: on


@pytest.mark.parametrize("edits, words", WRONG_MAPPINGS.values(), ids=WRONG_MAPPINGS)
def test_a_wrong_mapping_is_refused_by_name(results, mapped, tmp_path, edits, words):
    assert words in refused(mapped(abaqus_mesh(results[1]), *edits), tmp_path)


LINE = "x_m,p_Pa\n-3e-6,7e9\n0,8e9\n3e-6,7e9\n"
WRONG_TABLES = {
    "column": (LINE.replace("p_Pa", "p_MPa"), "unknown column 'p_MPa' (did you mean p_Pa"),
    "unit": (LINE.replace("e9", "e3"), "p_Pa = at most 8 kPa: it is in Pa, and expected at about 8.47 GPa"),
    "length in mm": (LINE.replace("3e-6", "3e-3"), "the place, or the unit of length, is another"),
    "length in km": (LINE.replace("3e-6", "3e-9"), "the unit of length is another"),
    "sign": (LINE.replace(",", ",-").replace(",-p", ",p"), "p > 0 is compressive: change the sign"),
    "upside down": ("z_m,mises_Pa\n-3e-6,5e9\n-1e-6,4e9\n", "the axis is upside down"),
    "empty cell": (LINE.replace("8e9", ""), 'p_Pa, row 2 = "nan": a number in each row'),
    "text": (LINE.replace("8e9", "large"), "no table of numbers"),
    "short row": (LINE.replace(",8e9", ""), "no table of numbers"),
    "state": ("state," + LINE.replace("\n", "\nlast,")[:-5], 'state, row 1 = "last": "peak" or "unloaded"'),
    "no rows": ("x_m,p_Pa\n", "the table has no rows"),
    "no place": ("p,q\n1,2\n", "lengths in m as x_m for the line"),
    "bytes": ("x_m,p_Pa\n\x00\xff", "no table of numbers"),
}


@pytest.mark.parametrize("text, words", WRONG_TABLES.values(), ids=WRONG_TABLES)
def test_a_wrong_table_is_refused_by_name(tmp_path, text, words):
    (tmp_path / "own.csv").write_bytes(text.encode("latin-1"))
    said = refused("own.csv", tmp_path)
    assert words in said and "own.csv" in said


PUNCH = Scene(**resolved(SCENE) | {"counterbody": {"shape": "punch", "radius": 1e-5}})


@pytest.mark.parametrize("scene", [SCENE, PUNCH], ids=["sphere", "punch"])
@pytest.mark.parametrize("over", [True, False])
def test_values_up_to_a_hundred_times_the_expected_are_of_the_unit(tmp_path, scene, over):
    size, path = _expected(scene)[1]["p_max_Pa"], tmp_path / "own.csv"
    last = size * 100.0 if over else size / 100.0
    path.write_text(f"p_max_Pa\n{last!r}\n")
    assert read_data(path, scene).quantities == {"p_max_Pa": last}
    path.write_text(f"p_max_Pa\n{last * (1.0005 if over else 0.9995)!r}\n")
    assert "the unit is another" in refused("own.csv", tmp_path, scene)


@pytest.mark.parametrize("of_cells", [False, True])
def test_a_coarse_mesh_is_read_at_eight_nodes_or_between_nodes(tmp_path, of_cells):
    """Linear fields, eight nodes on the line, none on the axis; what is of cells counts below the surface."""
    a = max(hertz_semi_axes(SCENE))
    mesh = pyvista.ImageData(dimensions=(8, 3, 9), spacing=(a, a, a / 2), origin=(-3.5 * a, -a, 0.0))
    x, _, z = mesh.points.T / a
    mesh.point_data["p"] = mesh.point_data["q"] = 1e9 * (1.0 + x / 10 + z / 10)
    data, count = (mesh.cell_data, mesh.n_cells) if of_cells else (mesh.point_data, mesh.n_points)
    data["e"] = np.full(count, 0.01)
    mesh.cast_to_unstructured_grid().save(tmp_path / "own.vtu")
    units = 'file = "own.vtu"\nlength_unit = "m"\nstress_unit = "Pa"\naxes = { z = "z" }\n'
    (tmp_path / "own.toml").write_text(units + 'pressure = "p"\nmises = "q"\npeeq = "e"\n')
    line, axis, plane = map(read_data(tmp_path / "own.toml", SCENE).tables.get, ("line", "axis", "plane"))
    assert line["x_m"] / a == pytest.approx(np.arange(-3.5, 4.0))
    assert axis["z_m"] / a == pytest.approx(np.linspace(0.0, 4.0, 401)[of_cells:])
    assert len(plane["x_m"]) == 8 * (8 if of_cells else 9)
    assert line["p_Pa"] == pytest.approx(1e9 * (1.0 + line["x_m"] / a / 10))
    assert axis["mises_Pa"] == pytest.approx(1e9 * (1.0 + axis["z_m"] / a / 10))
    assert plane["peeq"] == pytest.approx(0.01)


def test_what_is_no_data_is_refused_by_name(tmp_path):
    (tmp_path / "mesh.vtu").write_text("")
    (tmp_path / "empty").mkdir()
    (tmp_path / "fem.csv").write_text(LINE)
    assert "cannot be read" in refused("none.csv", tmp_path)
    assert "the mapping (TOML) that names and explains a mesh" in refused("mesh.vtu", tmp_path)
    assert "has none of axis.csv, line.csv" in refused("empty", tmp_path)
    assert "fem is a column of compare.csv: rename the data" in refused("fem.csv", tmp_path)
    for place in (tmp_path, tmp_path / "empty"):
        (place / "own.csv").write_text(LINE)
    with pytest.raises(SceneError, match="each with a name of its own"):
        asked(SCENE, data=[tmp_path / "own.csv", tmp_path / "empty" / "own.csv"])
    still = Scene(**{**resolved(SCENE), "loading": {"force": 0.0}})
    assert "the load is zero" in refused("none.csv", tmp_path, still)


def test_everything_that_is_wrong_is_said_at_once(tmp_path):
    (tmp_path / "own.csv").write_text(LINE.replace("p_Pa", "p"))
    data = [tmp_path / "own.csv", tmp_path / "none.csv"]
    with pytest.raises(SeveralError) as caught:
        asked(SCENE, data=data, tolerances={"p": 1}, claim="negligible-film")
    for words in ("--claim", "tolerances.p = 1", "own.csv: p", "none.csv: cannot be read"):
        assert words in str(caught.value)
