# SPDX-License-Identifier: MIT
"""What quantities and cases take of results, tracks, passes and histories made by hand."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from made_results import Made, of_plane, square_mesh

import verification
from sam.scene import read_scene
from verification.cases.case import with_loading
from verification.cases.compared import refinement
from verification.cases.periodic import area_over_load, lateral, periodic_peers
from verification.cases.recipes import layer_faces, load_ratio
from verification.cases.sweep import Measured
from verification.judging import error_of
from verification.peers import running as peers
from verification.quantities import OF_TRACKS, QUANTITIES, Reference, Solved, Values, refined
from verification.reference.convergence import extrapolate
from verification.reference.westergaard import WavyContact
from verification.references import double_wave, wave
from verification.runs import sampling
from verification.runs.models import FEM, SAM

X, Y, Z = np.linspace(-3.0, 3.0, 13), np.linspace(-2.0, 2.0, 9), np.linspace(0.0, 4.0, 9)


def pressure(x, y):
    """Of no symmetry, so that a transposed field differs."""
    return 10.0 + 3.0 * x + np.cos(y - 0.3) * x**2


def mises(z):
    return 5.0 + z * np.exp(-z)


def peak(**columns):
    size = len(next(iter(columns.values())))
    return {"state": ["peak"] * size + ["unloaded"] * size} | {
        k: [*v, *(0.0 * v)] for k, v in columns.items()
    }


def made(model: str, change=lambda field: field):
    """A result with these fields; change: of the pressure (nx, ny), and of every other field."""
    fields = square_mesh(X, change(pressure(X[:, None], Y[None, :])), Y)
    r = np.linspace(0.0, 3.0, 31)
    tables = {
        "line": peak(x_m=r, p_Pa=change(pressure(r, 0.0))),
        "axis": peak(z_m=Z, mises_Pa=change(mises(Z))),
    }
    quantities = {each.row: change(np.array(7.0)) for each in QUANTITIES.values() if " " not in each.row}
    certificate = {"force_balance": float(change(np.array(1e-9)))}
    return Made(quantities, tables, fields, model=model, certificate=certificate)


SCALARS = {name: 7.0 for name, quantity in QUANTITIES.items() if quantity.row and " " not in quantity.row}
LOAD = float(np.sum(pressure(X[:, None], Y[None, :])) * 0.25)
EXACT = Reference({**SCALARS, "load": LOAD, "pressure": pressure, "mises-axis": mises}, {}, deepest=2.5)
HELD = [name for name, quantity in QUANTITIES.items() if quantity.of and name in EXACT.values]


def error(name, result, reference=EXACT):
    measured = QUANTITIES[name].against(name, result, reference)
    return error_of("relative_l2" if np.ndim(measured.value) else "relative", measured)


@pytest.mark.parametrize("name", HELD)
@pytest.mark.parametrize("model", [SAM, FEM])
def test_a_quantity_is_its_definition_and_a_wrong_field_is_seen(name, model):
    if (name, model) == ("load", FEM):
        return  # its own error, not a value: a row of kind bound
    assert error(name, made(model)) < 1e-14
    assert error(name, made(model, lambda field: 1.01 * field)) == pytest.approx(0.01, rel=1e-9)
    assert error(name, made(model, lambda field: field + 0.1)) > 1e-3


def test_a_transposed_or_mirrored_pressure_is_seen():
    for change in (lambda p: p[::-1], lambda p: p[:, ::-1] if p.ndim > 1 else p + p.size * 1e-3):
        assert error("pressure", made(SAM, lambda p, change=change: change(p) if p.ndim else p)) > 1e-4


def test_a_field_counts_as_far_as_its_reference_says():
    deep = made(SAM, lambda f: np.where(np.arange(f.size) * 0.5 > 2.5, 0.0, f) if f.shape == Z.shape else f)
    assert error("mises-axis", deep) < 1e-14
    inside = Reference(EXACT.values, {}, inside=1.0)
    punch = made(SAM, lambda f: np.where(np.arange(f.size) > 10, 0.0, f) if f.shape == (31,) else f)
    assert error("pressure", punch, inside) < 1e-14
    values = QUANTITIES["pressure"].of(punch, inside)
    assert isinstance(values, Values) and values.places[0].max() == 1.0 and values.values.size == 11


def test_the_width_of_a_strip_is_where_its_pressure_ends_and_its_outermost_cells_do_not_count():
    wave = WavyContact(1e-3, 1.0, 1.0, 0.2e-3 * np.pi)
    x = (np.arange(96) + 0.5) / 96 - 0.5
    p = np.repeat(wave.pressure(x)[:, None], 3, axis=1)
    p[[*np.flatnonzero(p[:, 0])[[0, -1]]]] *= 0.5
    result = Made({}, {}, square_mesh(x, p, np.arange(3.0) / 96), model=SAM)
    reference = Reference({"strip-width": 2 * wave.half_width}, {"wave": 1.0})
    assert error("strip-width", result, reference) < 1e-12
    p[40] *= 1.01
    wrong = replace(result, fields=square_mesh(x, p, np.arange(3.0) / 96))
    assert error("strip-width", wrong, reference) > 1e-4


# quantities of a sphere that moves


def run(n: int, *, depth: float = 1.0, strain: float = 1.0) -> Made:
    """A track whose values are off by 1/n^2 of themselves."""
    off, x = 1 - 1 / n**2, np.linspace(-2.0, 2.0, 9)
    track = {"x_m": x, "uz_m": depth * off * (1 + 0.1 * np.abs(x))}
    return Made({"groove_deepest_m": 1.2 * depth * off, "peeq_max": strain * off}, {"track": track})


def solved(results: dict[str, Made]) -> Solved:
    return Solved(None, Reference({}, {"a": 1.0}), results)


def test_limits_of_second_order_are_recovered_and_those_of_both_models_held_against_each_other():
    runs = {name: run(int(name[4:])) for name in ("sam-8", "sam-12")}
    runs |= {name: run(int(name[4:]), depth=1.03, strain=0.98) for name in ("fem-6", "fem-8")}
    runs["cost-sam-4"] = run(4, depth=9.0)  # of no model that is compared
    found = solved(runs)
    for name, sam, fem in (("groove", 1.0, 1.03), ("deepest", 1.2, 1.236), ("strain", 1.0, 0.98)):
        measured = QUANTITIES[f"{name}-refined"].whole(found)
        assert (measured.value, measured.expected) == pytest.approx((sam, fem), rel=1e-12)
    finest = 1.03 * (1 - 1 / 8**2)
    off = abs(1 - 1 / 12**2 - finest) / finest
    assert QUANTITIES["groove"].whole(found) == pytest.approx(off, rel=1e-12)
    assert refined({12: run(12)}, OF_TRACKS["largest plastic strain"]) == 1 - 1 / 12**2


def passed(energy, strain, verdict="shakedown", floor=7e-5) -> Made:
    tables = {"cycles": {"dissipated_J": energy}, "passes": {"new_strain_max": strain}}
    return Made({}, tables, verdict={"class": verdict, "floor": floor})


def test_passes_of_both_models_are_held_over_the_first_and_those_that_count_over_themselves():
    right = passed((4.0, 0.2, 0.03), (6e-3, 3e-4, 4e-5))
    other = passed((4.0, 0.3, 0.03), (6e-3, 6e-4, 4e-5), "settling")
    found = solved({"sam-12": right, "fem-6": other})
    exact = {"energy": 0.025, "strain": 0.05, "own-energy": 1.0 / 3.0, "own-strain": 0.5}
    assert {name: QUANTITIES[name].whole(found) for name in exact} == pytest.approx(exact, rel=1e-12)
    assert QUANTITIES["counted"].whole(found) == 2.0 and QUANTITIES["verdict"].whole(found).value == 2.0
    assert QUANTITIES["shakes-down"].whole(solved({"sam-6": right})).value == 1.0
    assert QUANTITIES["alternates"].whole(solved({"sam-6": right})).value == 0.0


def cone(cells: int, top: float) -> Made:
    """SAM with p = top (1 - |x|) (1 - |y|), which is linear along each line of cells on either side."""
    x = np.linspace(-1.0, 1.0, cells)
    p = top * np.outer(1 - np.abs(x), 1 - np.abs(x))
    return Made({"peeq_max": top}, fields=square_mesh(x, p))


def line(top: float) -> Made:
    """FEM with p = top (1 - r)."""
    table = {"state": ["peak"] * 3, "x_m": [0.0, 1.0, 2.0], "p_Pa": [top, 0.0, 0.0]}
    return Made({"peeq_max": top}, {"line": table}, model="fem-axisymmetric")


@pytest.mark.parametrize("name", ["peeq-max", "pressure"])
def test_what_refinement_allows(name):
    """Changes of 0.7 % (SAM) over a ratio of 8/7 and of 0.5 % (FEM) over one of 2; else 1 %."""
    scene = SimpleNamespace(body=SimpleNamespace(plasticity=True))
    sam, fem = cone(33, 1.02), line(1.0)
    coarser = (cone(17, 1.02 - 0.007), 8 / 7), (line(0.995), 2.0)
    found = Solved(scene, None, {"sam": sam, "fem": fem}, coarser=coarser)
    of_sam, of_fem, apart, allowed = refinement(found, QUANTITIES[name])
    if name == "peeq-max":
        expected = 7 * 0.007 / 1.013, 0.005 / 0.995, 0.02
    else:
        p, q = (QUANTITIES[name].between(scene, cone(33, top), fem) for top in (1.02, 1.013))
        norm = np.linalg.norm
        expected = 7 * norm(p.value - q.value) / norm(p.expected), 0.005, error_of("relative_l2", p)
    assert (of_sam, of_fem, apart) == pytest.approx(expected, rel=1e-9) and allowed == of_sam + of_fem
    same = Solved(scene, None, {"sam": sam, "fem": fem}, coarser=((sam, 8 / 7), (fem, 2.0)))
    assert refinement(same, QUANTITIES[name])[-1] == 0.01


def test_the_second_cycle_is_held_against_the_first_peak():
    history = {"cycle": [1, 1, 1, 2, 2], "force_N": [0.0, 1.0, 0.0, 1.0, 0.0]}
    history |= {"approach_m": [0.0, 2e-6, 1e-6, 2.002e-6, 1e-6], "peeq_max": [0.0, 0.01, 0.01, 0.01, 0.011]}
    made = Made(tables={"history": history})
    peeq = QUANTITIES["peeq-reloaded"].against("peeq-reloaded", made, None)
    assert (peeq.value, peeq.expected) == (0.011, 0.01)
    assert QUANTITIES["approach-reloaded"].of(made, None) == pytest.approx(1e-3, rel=1e-9)


class TestSampling:
    def test_unequal_cells_keep_their_directions(self):
        nodes = np.array([[x, y, 0.0] for x in (0.0, 2.0, 4.0) for y in (0.0, 1.0, 2.0, 3.0)])
        quads = np.array([[k, k + 4, k + 5, k + 1] for k in (0, 1, 2, 4, 5, 6)])
        x, y, p = sampling.surface_pressure(nodes, quads, np.arange(6.0))
        assert x.tolist() == [1.0, 3.0] and y.tolist() == [0.5, 1.5, 2.5]
        assert p.tolist() == [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]]

    def test_hertz_pressure_is_interpolated_to_rounding(self):
        """p^2 is quadratic in r: lines between nodes 1/400 apart err by 1/(8 * 400^2) of p0^2."""
        r = np.linspace(0.0, 2.0, 801)
        line = {"state": ["peak"] * r.size, "x_m": r, "p_Pa": np.sqrt(np.maximum(1.0 - r**2, 0.0))}
        x, y = np.array([-0.31, 0.123]), np.array([0.4567])
        exact = 1.0 - (x[:, None] ** 2 + y**2)
        assert np.abs(sampling.pressure_on(x, y, {"line": line}) ** 2 - exact).max() <= 1.0 / (4.0 * 400**2)

    def test_linear_field_is_reproduced_and_nothing_extrapolated(self):
        r, z = np.linspace(0.02, 3.0, 41), np.linspace(0.03, 3.0, 43)
        plane = of_plane(r, z, "mises_Pa", lambda _, z: 2.0 + 5.0 * z)
        x, depths = np.array([-1.0, 0.0, 0.7]), np.array([0.0, 0.5, 1.0])
        field = sampling.plane_field_on(x, depths, {"plane": plane}, "mises_Pa")
        assert np.isnan(field[:, 0]).all() and np.allclose(field[:, 1:], [4.5, 7.0], rtol=1e-12)
        whole = of_plane(2.0 * (r - 1.5), z, "mises_Pa", lambda x, _: 3.5 + x / 2.0)  # not symmetric
        field = sampling.plane_field_on(np.array([-1.0, 0.7]), np.array([0.5]), {"plane": whole}, "mises_Pa")
        assert np.allclose(field[:, 0], [3.0, 3.85], rtol=1e-12)


class TestRings:
    edges = sampling.ring_edges(0.1, 1.0)

    def test_line_gives_the_exact_means_of_a_cone(self):
        """p = 1 - r: mean over a..b is 1 - (2/3)(b^3 - a^3)/(b^2 - a^2), whatever the nodes."""
        r = np.array([0.0, 0.07, 0.5, 0.55, 1.0, 1.3])
        found = sampling.means_of_line(r, np.maximum(1.0 - r, 0.0), self.edges)
        exact = 1.0 - 2.0 / 3.0 * np.diff(self.edges**3) / np.diff(self.edges**2)
        assert found == pytest.approx(exact, rel=1e-13)

    def test_cells_count_by_their_area_in_a_ring(self):
        """Four squares around the axis with sides of 1 m, and four beyond them in x."""
        p = np.array([[9.0, 9.0], [1.0, 2.0], [3.0, 4.0], [7.0, 7.0]])
        x, y = np.arange(4) - 1.5, np.arange(2) - 0.5
        inner, outer, last = sampling.means_of_cells(x, y, p, np.array([0.0, 1.0, 1.5, 2.3]))
        assert inner == pytest.approx(2.5, rel=1e-14) and 2.5 < outer < 8.0
        assert last == pytest.approx(8.0, rel=1e-14)


class TestResolution:
    def test_layers_halve_where_cells_double(self):
        coarse, fine = layer_faces(10), layer_faces(20)
        assert fine[::2] == pytest.approx(coarse, rel=1e-14)
        assert np.allclose(np.diff(coarse)[:10], 0.1, rtol=1e-12) and np.all(np.diff(coarse, 2) > -1e-12)


class TestExtrapolation:
    @pytest.mark.parametrize(("order", "factor"), [(1.0, 0.3), (1.7, -0.4), (2.0, 5.0)])
    def test_power_law_is_recovered(self, order, factor):
        h = 1.0 / np.array([5.0, 10.0, 20.0, 40.0])
        limit = extrapolate(h, 3.0 + factor * h**order)
        assert limit.limit == pytest.approx(3.0, rel=1e-6) and limit.order == pytest.approx(order, abs=1e-4)
        assert limit.observed and limit.scatter < 1e-6
        assert limit.uncertainty == pytest.approx(abs(factor) * h[-1] ** order / 3.0, rel=1e-3)

    @pytest.mark.parametrize("values", [[1.0, 2.0], [1.0, np.nan, 2.0]])
    def test_what_cannot_be_extrapolated_is_refused(self, values):
        with pytest.raises(ValueError, match="values"):
            extrapolate([0.4, 0.2, 0.1], values)


SCENE, _ = read_scene(Path(verification.__file__).with_name("scenes") / "wavy-periodic.toml")


def test_held_sides_keep_what_hooke_says_and_free_ones_nothing():
    strain = np.zeros((6, 4, 2, 3))
    strain[:2, 1] = np.array([2e-3, -4e-4])[:, None, None]  # a quarter of the patch has it
    nu, pressure = 0.3, SCENE.loading.mean_pressure
    stress = np.zeros_like(strain)
    stress[0], stress[1] = (-210e9 / (1 - nu**2) * (e + nu * f) for e, f in ((5e-4, -1e-4), (-1e-4, 5e-4)))
    loaded = stress.copy()
    loaded[:2] -= nu / (1 - nu) * pressure
    grids = {
        state: {
            "body": SimpleNamespace(z=np.arange(4.0), cell_data={"stress_Pa": s, "plastic_strain": strain})
        }
        for state, s in (("peak", loaded), ("unloaded", stress))
    }
    result = SimpleNamespace(grids=grids)
    held, free = (with_loading(SCENE, lateral=name) for name in ("held", "free"))
    assert lateral.off_hand(held, result, None) < 1e-12
    assert lateral.off_hand(free, result, None) == pytest.approx(1.0, rel=1e-12)
    found: Measured = lateral.mean_stress(held, result, None)
    np.testing.assert_allclose(found.value, found.expected, rtol=1e-12)
    grids["unloaded"]["body"].cell_data["stress_Pa"] = 1.01 * stress
    assert lateral.off_hand(held, result, None) == pytest.approx(0.01 / 1.01)


def test_loads_of_waves_are_those_of_their_exact_contact():
    exact = wave(SCENE)
    assert load_ratio(SCENE, 0.5).loading.mean_pressure == pytest.approx(0.5 * exact.units["p0"], rel=1e-12)
    surface = SCENE.surface.model_copy(update={"wavelength_y": 20e-6})
    grid = SCENE.grid.model_copy(update={"cells": (32, 32), "extent": (20e-6, 20e-6)})
    scene = load_ratio(SCENE.model_copy(update={"surface": surface, "grid": grid}), 1.1)
    found = double_wave(scene)
    assert found.values["share"] == 1.0 and found.values["area"] == pytest.approx(4e-10)
    largest = found.units["p0"] * (1.1 + np.cos(np.pi / 32) ** 2)
    assert found.values["p-max"] == pytest.approx(largest, rel=1e-12)


def test_rows_take_where_the_area_departs_and_times_within_the_error():
    rows = pd.DataFrame({"index": [1.0, 2.0, 4.0], "over": [1.0, 1.0, 1.1], "kappa": [2.0, 2.2, 2.4]})
    assert area_over_load.departs(rows, "over") == pytest.approx(2 * 2**0.5)
    assert area_over_load.bar(rows, "kappa") == pytest.approx(0.2 / 3**0.5)
    times = pd.DataFrame(
        {
            "model": [peers.SAM] * 2 + [peers.TAMAAS] * 2,
            "seconds": [1.0, 2.0, 8.0, 30.0],
            "error": [1e-3, 1e-5, 1e-3, 1e-6],
        }
    )
    assert periodic_peers.tamaas_over_sam(times, "seconds") == 15.0
