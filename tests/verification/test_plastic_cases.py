# SPDX-License-Identifier: MIT
"""The elasto-plastic cases: their gates turn red when SAM is wrong, their figures are drawn, their scenes are
as said.

SAM is played by FEM seen on the cells and layers of SAM: every field is right to interpolation, until one is
changed.
"""

from dataclasses import replace
from math import pi
from types import SimpleNamespace

import numpy as np
import pytest
from made_results import context, red, with_column, with_quantities
from scipy.interpolate import LinearNDInterpolator

from sam.scene import FieldMesh
from verification.cases import all_cases
from verification.cases.plastic.paper_loop import EULER, STRAIN, STRESS, Law, excess_of, gates
from verification.cases.plastic.plastic import SPHERES, compared, plots, with_allowance
from verification.cases.plastic.plastic_history import cycles, largest_change
from verification.cases.published.indentation import curve
from verification.cases.recipes import Resolution, at_ratio, initial_yield, layer_faces, resolved_at
from verification.figures.plastic import iso_lines
from verification.reference.convergence import extrapolate
from verification.reference.indentation import onset
from verification.references import contact_of
from verification.runs import models
from verification.runs.models import FEM, SAM
from verification.runs.sampling import means_of_cells, means_of_line, ring_edges, rows_of

CASE = "plastic-swift-rigid-4"
STATES = ("peak", "unloaded")


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    """As in the case, with a mesh and load steps that take a second."""
    base = at_ratio(context(CASE, tmp_path_factory.mktemp("scene")).scene("plastic-swift-rigid"), 4.0)
    loading = base.loading.model_copy(update={"steps": 4})
    return resolved_at(base.model_copy(update={"loading": loading}), Resolution(20, 8))


@pytest.fixture(scope="module")
def fem(scene):
    return models.solve(scene, FEM)


@pytest.fixture(scope="module")
def sam(scene, fem):
    """The answer of FEM on the cells and layers of SAM."""
    n, (extent, _) = scene.grid.cells[0], scene.grid.extent
    x = (np.arange(n) - (n - 1) / 2) * extent / n
    z = np.convolve(scene.grid.depths, (0.5, 0.5), "valid")
    surface = np.interp(np.hypot(x[:, None], x), *rows_of(fem.tables["line"], "peak", "x_m", "p_Pa"))
    tables = {
        "axis": sampled(fem.tables["axis"], z),
        "line": fem.tables["line"],
    }  # a cell on the edge has no right value
    tables |= {"plane": plane(fem.tables["plane"], x, z), "history": fem.tables["history"]}
    found = {"cells": (n, n), "cell_m": (extent / n, extent / n)}
    cost = {"operator_applications": 40, "plastic_iterations": 40, "setup_s": 1.0, "solve_s": 1.0}
    return replace(fem, model=SAM, tables=tables, fields=quads(x, surface), discretisation=found, cost=cost)


def sampled(table, at):
    out = {"state": [state for state in STATES for _ in at], "z_m": np.tile(at, 2)}
    for name in set(table) - set(out):
        known = [rows_of(table, state, "z_m", name) for state in STATES]
        out[name] = np.concatenate([np.interp(at, *pair) for pair in known])
    return out


def plane(table, x, z):
    places = np.meshgrid(np.abs(x), z, indexing="ij")
    out = {"state": [state for state in STATES for _ in range(x.size * z.size)]}
    out |= {"x_m": np.tile(np.repeat(x, z.size), 2), "z_m": np.tile(z, 2 * x.size)}
    for name in ("peeq", "mises_Pa"):
        out[name] = []
        for state in STATES:
            r, depth, values = rows_of(table, state, "x_m", "z_m", name)
            both = np.stack([np.append(r, -r), np.append(depth, depth)], axis=1)
            near = (np.abs(both) < 5 * x.max()).all(axis=1)
            field = LinearNDInterpolator(both[near], np.append(values, values)[near], fill_value=0.0)
            out[name].extend(field(*places).ravel())
    return out


def quads(x, pressure):
    edges = np.append(x, 2 * x[-1] - x[-2]) - (x[1] - x[0]) / 2
    points = np.stack(
        [*np.meshgrid(edges, edges, indexing="ij"), np.zeros((edges.size,) * 2)], axis=-1
    ).reshape(-1, 3)
    node = np.arange(edges.size**2).reshape(edges.size, -1)
    cells = np.stack([node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:]], axis=-1).reshape(-1, 4)
    return FieldMesh(points, {"quad": cells}, cell_data={"p_Pa": pressure.ravel()})


def with_pressure(result, factor):
    data = {"p_Pa": factor * result.fields.cell_data["p_Pa"]}
    return replace(result, fields=replace(result.fields, cell_data=data))


def test_equal_answers_hold_every_gate(scene, sam, fem):
    assert red(CASE, compared(scene, sam, fem), whole=True) == set()


@pytest.mark.parametrize(
    ("gate", "wrong"),
    [
        ("peeq-max", lambda sam: with_quantities(sam, peeq_max=1.011)),
        ("peeq-max", lambda sam: with_quantities(sam, peeq_max=np.nan)),
        ("residual-centre", lambda sam: with_quantities(sam, residual_uz_center_m=0.979)),
        ("peeq-axis", lambda sam: with_column(sam, "axis", "peeq", lambda v: 1.025 * v)),
        ("peeq-plane", lambda sam: with_column(sam, "plane", "peeq", lambda v: 1.035 * v)),
        ("pressure pressure-rings", lambda sam: with_pressure(sam, 1.015)),
        (
            "pressure",
            lambda sam: with_pressure(
                sam, 1.0 + 0.015 * (-1.0) ** np.arange(sam.fields.cell_data["p_Pa"].size)
            ),
        ),
        (
            "peeq-plane",
            lambda sam: with_column(sam, "plane", "peeq", lambda v: 0.0 * v, states=("peak",)),
        ),
    ],
)
def test_wrong_answer_turns_its_gate_red(scene, sam, fem, gate, wrong):
    """Each change is a quarter or more beyond the tolerance, and touches the gates named only."""
    assert red(CASE, compared(scene, wrong(sam), fem), whole=True) == set(gate.split())


class TestAllowance:
    """Refinement uncertainties of a sphere whose coarser answers are 0.7 (SAM) and 0.5 % (FEM) below the
    finer ones.
    """

    @staticmethod
    def shares(tmp_path, scene, sam, fem, error):
        coarser = {SAM: with_pressure(with_quantities(sam, peeq_max=0.993), 0.993)}
        coarser[FEM] = with_quantities(fem, peeq_max=0.995)
        solver = context("plastic-perfect-3", tmp_path)
        solver.solve = lambda model, *_: coarser[model]
        wrong = with_pressure(with_quantities(sam, peeq_max=1.0 + error), 1.0 + error)
        shares, table = with_allowance(solver, scene, {SAM: wrong, FEM: fem})
        return {gate: share.value for gate, share in shares.items()}, table

    def test_difference_is_measured_in_both_uncertainties(self, tmp_path, scene, sam, fem):
        """Quick level: 16 and 14 cells, 32 and 16 elements, so the changes count 7 times and once."""
        error = 0.02
        shares, _ = self.shares(tmp_path, scene, sam, fem, error)
        sam_peeq, fem_peeq = 7.0 * (1.02 / 0.993 - 1.0), 1.0 / 0.995 - 1.0
        assert shares["peeq-max"] == pytest.approx(error / (sam_peeq + fem_peeq), rel=1e-6)
        assert shares["pressure"] == pytest.approx(
            error / (7.0 * (1.02 - 0.993)), rel=0.02
        )  # FEM: the same line twice

    def test_an_error_beyond_them_is_red(self, tmp_path, scene, sam, fem):
        """The limit is 1 % where nothing changes under refinement: SAM as wrong on the coarser grid."""
        solver = context("plastic-perfect-3", tmp_path)
        wrong = with_pressure(with_quantities(sam, peeq_max=1.012), 1.012)
        solver.solve = lambda model, *_: {SAM: wrong, FEM: fem}[model]
        shares, _ = with_allowance(solver, scene, {SAM: wrong, FEM: fem})
        assert red("plastic-perfect-3", shares, whole=True) >= {"peeq-max", "pressure"}


def test_figures_of_a_case(tmp_path, scene, sam, fem):
    """At the quick level all are on the page; the maps are of the accumulated plastic strain, in %."""
    figures = [context(CASE, tmp_path).save(plot) for plot in plots(sam, fem, contact_of(scene), True)]
    assert [figure.embedded for figure in figures] == [True] * 4
    for figure in figures:
        assert all((tmp_path / path).stat().st_size > 1000 for path in (figure.png, figure.csv))
    header, *rows = (tmp_path / figures[0].csv).read_text(encoding="utf-8").splitlines()
    column = header.split(",").index("SAM")
    largest = max(float(row.split(",")[column]) for row in rows)
    assert largest == pytest.approx(1e2 * fem.quantities["peeq_max"], rel=0.02)  # a cell beside the maximum


def test_iso_line_of_the_proof_strain_is_drawn_when_it_is_reached():
    assert 0.2 in iso_lines(0.5) and 0.2 in iso_lines(3.0) and 0.2 not in iso_lines(0.19)
    for largest in (0.011, 0.5, 3.0):
        levels = iso_lines(largest)
        assert levels.size >= 3 and np.all(np.diff(levels) > 0.0) and levels[-1] < largest


def test_every_sphere_has_the_force_of_its_level(tmp_path):
    """F = pi^3 p0^3 R^2/(6 E*^2), E* by hand; the scenes of the paper carry theirs."""
    for sphere in SPHERES:
        scene = context(CASE, tmp_path).scene(sphere.scene)
        p0 = 6.5e9 if sphere.ratio is None else sphere.ratio * initial_yield(scene)
        scene = scene if sphere.ratio is None else at_ratio(scene, sphere.ratio)
        modulus = 210e9 / 0.91 / (2 if scene.counterbody.elastic else 1)
        force = pi**3 * p0**3 * scene.counterbody.radius**2 / (6 * modulus**2)
        assert scene.loading.force == pytest.approx(force, rel=1e-5)  # six digits in the files
        assert scene.loading.steps == 10 and scene.loading.unload


def test_cases_of_the_issue_are_there():
    cases = all_cases()
    levels = [
        f"plastic-swift-{kind}-{level}" for kind in ("rigid", "steel") for level in ("2", "3", "4", "6-2")
    ]
    levels += [f"plastic-{law}-{level}" for law in ("perfect", "linear") for level in (3, 4)]
    levels += [
        "plastic-paper-1780",
        "plastic-paper-1280",
        "plastic-elastic-limit",
        "plastic-reload",
        "plastic-convergence",
    ]
    assert set(levels) <= set(cases)
    assert all("full" in cases[name].levels for name in levels)


class TestRings:
    edges = ring_edges(0.1, 1.0)

    def test_edges_cover_the_reach(self):
        assert self.edges == pytest.approx(np.linspace(0.0, 1.0, 11)) and ring_edges(0.3, 1.0)[
            -1
        ] == pytest.approx(1.2)

    def test_line_gives_the_exact_means_of_a_cone(self):
        """p = 1 - r: mean over a..b is 1 - (2/3)(b^3 - a^3)/(b^2 - a^2), whatever the nodes."""
        r = np.array([0.0, 0.07, 0.5, 0.55, 1.0, 1.3])
        found = means_of_line(r, np.maximum(1.0 - r, 0.0), self.edges)
        exact = 1.0 - 2.0 / 3.0 * np.diff(self.edges**3) / np.diff(self.edges**2)
        assert found == pytest.approx(exact, rel=1e-13)

    def test_cells_approach_the_means_of_hertz(self):
        """p = sqrt(1 - r^2): mean (2/3)((1 - a^2)^1.5 - (1 - b^2)^1.5)/(b^2 - a^2); second order inside,
        h^1.5 at the edge.
        """
        exact = -2.0 / 3.0 * np.diff((1.0 - self.edges**2).clip(0.0) ** 1.5) / np.diff(self.edges**2)
        worst = []
        for n in (41, 161):
            x = (np.arange(n) - (n - 1) / 2) * 2.4 / n
            p = np.sqrt(np.maximum(1.0 - x[:, None] ** 2 - x**2, 0.0))
            worst.append(np.max(np.abs(means_of_cells(x, x, p, self.edges) - exact)))
        assert worst[0] < 0.02 and worst[1] < worst[0] / 4.0


class TestResolution:
    def test_layers_halve_where_cells_double(self):
        coarse, fine = layer_faces(10), layer_faces(20)
        assert fine[::2] == pytest.approx(coarse, rel=1e-14)
        assert np.allclose(np.diff(coarse)[:10], 0.1, rtol=1e-12) and np.all(np.diff(coarse, 2) > -1e-12)

    def test_apex_is_a_cell_centre(self, scene):
        assert scene.grid.cells[0] % 2 == 1
        cell = scene.grid.extent[0] / scene.grid.cells[0]
        assert contact_of(scene).contact_radius / cell == pytest.approx(20.0, rel=1e-12)


class TestExtrapolation:
    @pytest.mark.parametrize(("order", "factor"), [(1.0, 0.3), (1.7, -0.4), (2.0, 5.0)])
    def test_power_law_is_recovered(self, order, factor):
        h = 1.0 / np.array([5.0, 10.0, 20.0, 40.0])
        limit = extrapolate(h, 3.0 + factor * h**order)
        assert limit.limit == pytest.approx(3.0, rel=1e-6) and limit.order == pytest.approx(order, abs=1e-4)
        assert limit.observed and limit.scatter < 1e-6
        assert limit.uncertainty == pytest.approx(abs(factor) * h[-1] ** order / 3.0, rel=1e-3)

    def test_scatter_is_no_order(self):
        limit = extrapolate([0.2, 0.1, 0.05], [1.0, 1.2, 1.1])
        assert not limit.observed and limit.scatter > 0.05

    @pytest.mark.parametrize("values", [[1.0, 2.0], [1.0, np.nan, 2.0]])
    def test_what_cannot_be_extrapolated_is_refused(self, values):
        with pytest.raises(ValueError):
            extrapolate([0.4, 0.2, 0.1], values)

    def test_two_sizes_are_no_ladder(self):
        with pytest.raises(ValueError):
            extrapolate([0.4, 0.2, 0.2], [1.0, 2.0, 3.0])


class TestHistory:
    def test_strain_of_the_second_cycle_is_seen(self, fem):
        history = {name: list(values) for name, values in fem.tables["history"].items()}
        twice = {name: values * 2 for name, values in history.items()}
        twice["cycle"] = [1] * len(history["step"]) + [2] * len(history["step"])
        same = replace(fem, tables={"history": twice})
        assert cycles(same) == (fem.quantities["peeq_max"], fem.quantities["peeq_max"], 0.0)
        more = replace(same, tables={"history": twice | {"peeq_max": [*twice["peeq_max"][:-1], 0.006]}})
        assert cycles(more)[1] == 0.006

    def test_change_of_the_elastic_answer_is_seen(self, fem):
        assert largest_change(fem, fem) == 0.0
        assert largest_change(with_quantities(fem, approach_m=1.0 + 1e-9), fem) == pytest.approx(
            1e-9, rel=1e-6
        )
        other = with_column(fem, "line", "p_Pa", lambda v: v + 1e-6 * v.max())
        assert largest_change(other, fem) == pytest.approx(1e-6, rel=1e-6)


class TestPaperLoop:
    @staticmethod
    def runs(fem, scene, stated=None):
        """The stop on stress 4 % off with one step and 0.4 % with ten; certificates from the fields, or as
        `stated`.
        """
        off = {
            (EULER, 1): 1.0,
            (STRESS, 1): 1.04,
            (STRAIN, 1): 0.9,
            (EULER, 10): 1.0,
            (STRESS, 10): 1.004,
            (STRAIN, 10): 0.99,
        }
        honest = excess_of(fem, scene) if stated is None else stated
        checked = replace(fem, certificate={"yield_excess": honest, "flow_residual": 0.0})
        return {key: with_quantities(checked, peeq_max=factor) for key, factor in off.items()}

    def test_shrinking_error_and_honest_certificate_hold(self, fem, scene):
        found = gates(Law("Swift", 4.0, scene, self.runs(fem, scene)))
        assert found["stress-shrinks"].value == pytest.approx(0.1, rel=1e-9) and found["stated"].value == 0.0
        named = {f"swift-{name}": value for name, value in found.items()}
        assert not {name for name in red("paper-loop", named, whole=True) if name.startswith("swift")}

    def test_certificate_that_says_less_than_the_fields_is_red(self, fem, scene):
        """The stress of one cell 1 % above its yield stress, and a certificate that knows nothing of it."""
        peeq = np.array(fem.tables["plane"]["peeq"])
        cell = int(np.argmax(peeq))
        limit = float(scene.body.plasticity.curve().stress(peeq[cell]))
        wrong = with_column(
            fem, "plane", "mises_Pa", lambda v: np.where(np.arange(v.size) == cell, 1.01 * limit, v)
        )
        assert excess_of(wrong, scene) == pytest.approx(0.01, rel=1e-9)
        found = gates(Law("Swift", 4.0, scene, self.runs(wrong, scene, stated=0.0)))
        assert "swift-stated" in red("paper-loop", {f"swift-{name}": value for name, value in found.items()})


def test_indentation_counts_resolved_load_steps_within_the_fits_only():
    """Approach 1 to 30 w_c, load equal to it; the first contacts are a few elements, the last are beyond w* =
    20.
    """
    w = np.arange(1.0, 31.0)
    unit = onset(1.615, 105e-6, 210e9 / 0.91, 1e9)
    history = {"approach_m": w * unit.approach, "force_N": w * unit.load, "contact_area_m2": w * unit.area}
    found = curve(SimpleNamespace(tables={"history": history}), unit)
    assert found[0] == pytest.approx(np.arange(4.0, 22.0)) and found[1] == pytest.approx(
        found[0]
    )  # sqrt(4/30) > 0.35
