# SPDX-License-Identifier: MIT
"""Rough bodies in the semi-analytical model: against smooth bodies of the same shape, Hertz, Westergaard,
refinement, borders.
"""

import numpy as np
import pytest
from builders import scene as small_scene

import sam
from sam.results.rough import too_few_cells
from sam.scene import (
    Body,
    Coating,
    CounterBody,
    Friction,
    Grid,
    HeightMap,
    Loading,
    Scene,
    Solver,
    Status,
    Surface,
    resolved,
)
from verification.cost.plan import plan, plan_lines
from verification.reference.hertz import CircularContact
from verification.runs.files import read_run, write_run

STEEL = Body(young=210e9, poisson=0.3)
FLAT = CounterBody(shape="flat")
MODULUS = 210e9 / 0.91
R, F = 100e-6, 0.05
A0 = (3 * F * R / (4 * MODULUS)) ** (1 / 3)
SELF_AFFINE = {
    "kind": "self-affine",
    "ra": 0.27e-6,
    "cutoff_long": 32e-6,
    "cutoff_short": 12e-6,
    "hurst": 0.8,
    "anisotropy": 1.5,
    "seed": 1,
}


def centres(n: int, side: float) -> np.ndarray:
    return ((np.arange(n) + 0.5) / n - 0.5) * side


def of_heights(height, n: int, side: float, counter=FLAT, force=F, body=STEEL, grid=None, **keys) -> Scene:
    """A scene whose surface is given by height(x, y) at n x n cells."""
    x, y = centres(n, side)[:, None], centres(n, side)[None, :]
    surface = Surface(kind="file", path=HeightMap(height(x, y) + 0 * x * y, (side, side)))
    return Scene(
        body=body, counterbody=counter, surface=surface, loading=Loading(force=force), grid=grid, **keys
    )


def patch(n: int, counter=FLAT, force=0.6, border="relief", loading=(), **keys) -> Scene:
    """A self-affine patch of 64 um."""
    grid = Grid(cells=(n, n), extent=(64e-6, 64e-6), border=border)
    surface = Surface(**SELF_AFFINE)
    load = Loading(force=force, **dict(loading))
    return Scene(body=STEEL, counterbody=counter, surface=surface, loading=load, grid=grid, **keys)


def column(result, table: str, name: str) -> np.ndarray:
    return np.asarray(result.tables[table][name])


# --- the same shape, smooth or as heights -------------------------------------------------------------------


@pytest.mark.parametrize("mu", [0.0, 0.3])
def test_a_paraboloid_of_heights_is_the_sphere(mu):
    """The same cells, gaps equal but for rounding: pressures to 1e-9 (the contact's own tolerance is 1e-10).

    With friction the rigid counter-body couples, and the largest stress leaves the axis, but not the plane y
    = 0.
    """
    n, side = 49, 4 * A0
    friction = Friction(coefficient=mu) if mu else None
    depths = tuple(np.linspace(0, 1.5 * A0, 16))
    grid = {"cells": (n, n), "extent": (side, side), "depths": depths}
    smooth = small_scene(counterbody={"radius": R}, loading={"force": F}, friction=mu, grid=grid)
    rough = of_heights(
        lambda x, y: -(x**2 + y**2) / (2 * R), n, side, friction=friction, grid=Grid(depths=depths)
    )
    one, other = sam.solve(smooth), sam.solve(rough)
    assert one.converged and other.converged
    for name, value in one.quantities.items():
        if value is not None and name not in ("pressure_centroid_x_m", "p_center_Pa"):
            assert other.quantities[name] == pytest.approx(value, rel=1e-7, abs=1e-20), name
    assert (
        one.quantities["p_center_Pa"] > 0 and other.quantities["p_center_Pa"] is None
    )  # a patch has no centre
    for table, name in (("line", "p_Pa"), ("line", "uz_m"), ("plane", "mises_Pa"), ("axis", "sxx_Pa")):
        a, b = column(one, table, name), column(other, table, name)
        assert np.abs(a - b).max() < 1e-8 * np.abs(a).max()
    if not mu:
        assert other.quantities["approach_m"] == pytest.approx(
            CircularContact(F, R, MODULUS).approach, rel=5e-3
        )


def test_curvatures_of_profile_and_heights_add():
    """A sphere of 2 R on heights of 2 R is a sphere of R on a plane; only the sum of both is in the gap."""
    half = CounterBody(shape="sphere", radius=2 * R)
    both = of_heights(lambda x, y: -(x**2 + y**2) / (4 * R), 33, 4 * A0, counter=half)
    a, b = sam.solve(both), sam.solve(of_heights(lambda x, y: -(x**2 + y**2) / (2 * R), 33, 4 * A0))
    assert (
        np.abs(column(a, "surface", "p_Pa") - column(b, "surface", "p_Pa")).max()
        < 1e-8 * a.quantities["p_max_Pa"]
    )


def test_a_pit_below_a_punch_carries_nothing():
    """The profile of a punch stays: cells beside it cannot touch, whatever the heights."""
    punch = CounterBody(shape="punch", radius=6e-6)
    result = sam.solve(
        of_heights(lambda x, y: -1e-6 * ((x**2 + y**2) < (2e-6) ** 2), 41, 16e-6, counter=punch)
    )
    p = column(result, "surface", "p_Pa").reshape(41, 41)
    assert result.converged and p[20, 20] == 0 and p[20, 31] > 0 and not p[0].any()


def test_the_approach_is_zero_at_first_touch():
    """Heights may be counted from anywhere: moved up by 1 um nothing changes."""
    results = [
        sam.solve(of_heights(lambda x, y, up=up: up - (x**2 + y**2) / (2 * R), 33, 4 * A0))
        for up in (0.0, 1e-6)
    ]
    approach = [result.quantities["approach_m"] for result in results]
    assert approach[0] == pytest.approx(A0**2 / R, rel=1e-2) and approach[1] == pytest.approx(
        approach[0], rel=1e-7
    )
    zero = sam.solve(of_heights(lambda x, y: -(x**2 + y**2) / (2 * R), 33, 4 * A0, force=0.0))
    assert zero.converged and zero.quantities["approach_m"] == 0.0 and zero.quantities["mises_max_Pa"] == 0.0


# --- against closed forms -----------------------------------------------------------------------------------


def test_two_asperities_share_the_load_like_two_hertz_contacts():
    """Each has F/2; the other displaces its ground by (F/2)/(pi E* d), nearly even over it: of order (a/d)^2
    = 0.3 % in pressure.

    1 % for 8 cells in the contact radius. The largest von Mises stress is found below the spots, far from y =
    0.
    """
    side, n, a = 12 * A0, 97, A0 * 0.5 ** (1 / 3)
    d = side / 2

    def two(x, y):
        return np.maximum(-(x**2 + (y - d / 2) ** 2), -(x**2 + (y + d / 2) ** 2)) / (2 * R)

    depths = tuple(np.linspace(0, 1.2 * a, 25))
    result = sam.solve(of_heights(two, n, side, grid=Grid(depths=depths)))
    p0 = 1.5 * (F / 2) / (np.pi * a**2)
    q = result.quantities
    assert result.converged and q["p_max_Pa"] == pytest.approx(p0, rel=0.015)
    assert q["approach_m"] == pytest.approx(a**2 / R + F / 2 / (np.pi * MODULUS * d), rel=0.01)
    assert q["contact_area_m2"] == pytest.approx(2 * np.pi * a**2, rel=0.02)
    assert q["mises_max_Pa"] == pytest.approx(0.62004 * p0, rel=0.015)  # Johnson 1985, for nu = 0.3 at 0.48 a
    assert q["mises_max_depth_m"] == pytest.approx(0.48 * a, rel=0.04)
    assert column(result, "plane", "mises_Pa").max() < 0.2 * p0
    halves = column(result, "surface", "p_Pa").reshape(n, n).sum(axis=0)
    assert halves[: n // 2].sum() == pytest.approx(halves[n // 2 + 1 :].sum(), rel=1e-6)


def test_ripple_in_full_contact_has_the_pressure_of_westergaard():
    """A ripple A cos(q x) deep inside of a large contact adds E* q A/2 cos(q x) (Johnson 1985, Eq. 13.6).

    Amplitudes by projection on five waves in the middle. Pressures even over a cell miss a part of order (q
    h)^2: halving the cells takes away about three quarters of the difference.
    """
    radius, waves = 20e-6, 9
    force = 4 * MODULUS * radius**3 / (3 * 1e-3)  # of a sphere of 1 mm: contact radius 20 um
    sphere, side = CounterBody(shape="sphere", radius=1e-3), 48e-6
    wave = 2 * radius / waves
    amplitude, errors = 2e-9, []
    for n in (86, 172):
        scenes = [
            of_heights(
                lambda x, y, h=h: h * np.cos(2 * np.pi * x / wave),
                n,
                side,
                sphere,
                force,
                grid=Grid(depths=(0.0,)),
            )
            for h in (0.0, amplitude)
        ]
        plain, rippled = (column(sam.solve(scene), "surface", "p_Pa").reshape(n, n) for scene in scenes)
        x = centres(n, side)
        middle = np.abs(x) < 2.5 * wave
        extra = (rippled - plain)[middle][:, np.abs(x) < wave].mean(axis=1)
        found = 2 * np.mean(extra * np.cos(2 * np.pi * x[middle] / wave))
        errors.append(found / (MODULUS * np.pi / wave * amplitude) - 1)
    assert abs(errors[1]) < 0.02 and abs(errors[1]) < 0.5 * abs(errors[0])


# --- generated patches --------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def patches():
    return {n: sam.solve(patch(n)) for n in (64, 128)}


def test_the_same_patch_on_a_finer_grid(patches):
    """With twelve cells in the shortest wave at 64 x 64 and twice as many at 128: 0.5 % in pressure, 1 % in
    stress.
    """
    coarse, fine = (patches[n].quantities for n in (64, 128))
    assert all(result.converged for result in patches.values())
    assert coarse == coarse | {
        "p_max_Pa": pytest.approx(fine["p_max_Pa"], rel=5e-3),
        "mises_max_Pa": pytest.approx(fine["mises_max_Pa"], rel=1e-2),
        "approach_m": pytest.approx(fine["approach_m"], rel=1e-2),
    }
    assert max(patches[128].certificate.values()) < 3e-10


def test_the_largest_stress_is_looked_for_below_the_whole_patch(patches):
    result = patches[64]
    assert result.quantities["mises_max_Pa"] > 1.1 * column(result, "plane", "mises_Pa").max()
    assert all(entry.stage != "stress outside the plane y = 0" for entry in result.left_out)


def test_blocks_of_depths_change_nothing(patches, monkeypatch):
    monkeypatch.setattr("sam.elastic.problem.BYTES_AT_ONCE", 1)
    again = sam.solve(patch(64))
    assert again.quantities == patches[64].quantities
    assert np.array_equal(column(again, "plane", "mises_Pa"), column(patches[64], "plane", "mises_Pa"))


def test_steps_and_unloading_end_where_one_step_does(patches):
    result = sam.solve(patch(64, loading={"steps": 4, "unload": True, "cycles": 2}))
    assert result.converged
    for name in ("p_max_Pa", "approach_m", "mises_max_Pa", "contact_area_m2"):
        assert result.quantities[name] == pytest.approx(patches[64].quantities[name], rel=1e-7)
    cycles = result.tables[
        "cycles"
    ]  # of the part without border: a sample of the surface, whose Ra is 0.27 um
    assert cycles["sa_m"][0] == pytest.approx(0.27e-6, rel=0.2) and cycles["sq_m"][0] > cycles["sa_m"][0]
    assert abs(cycles["ssk"][0]) < 1.5
    assert list(column(result, "history", "force_N")[:5]) == pytest.approx([0.15, 0.3, 0.45, 0.6, 0.0])


def test_friction_on_a_rough_patch(patches):
    """Coupled against a rigid plane the pressure changes a little; decoupled not at all; the stress near the
    surface rises.
    """
    smooth = patches[64].quantities
    coupled, apart = (
        sam.solve(patch(64, friction=Friction(coefficient=0.4, coupling=c))) for c in (True, False)
    )
    assert (
        coupled.converged
        and apart.converged
        and coupled.quantities["friction_coefficient"] == pytest.approx(0.4)
    )
    assert apart.quantities["p_max_Pa"] == smooth["p_max_Pa"]
    assert 0 < abs(coupled.quantities["p_max_Pa"] / smooth["p_max_Pa"] - 1) < 0.05
    assert apart.quantities["mises_max_Pa"] > 1.1 * smooth["mises_max_Pa"]
    friction = column(coupled, "surface", "friction")
    assert np.allclose(friction[column(coupled, "surface", "p_Pa") > 0], 0.4)
    assert coupled.certificate["gap_in_contact"] < 3e-10


# --- coated patches -----------------------------------------------------------------------------------------


def coated(scene: Scene, young: float, **keys) -> Scene:
    film = Coating(thickness=1e-7, young=young, poisson=0.3)
    return scene.model_copy(update={"body": Body(young=210e9, poisson=0.3, coating=film)})


def test_a_coated_patch_is_compared_with_the_bare_one_below_the_whole_patch(patches):
    """80 GPa on steel, 0.1 um: less pressure and stress below it. The bare values are those of the bare
    scene's own solve, the stress at the depths of the coated one from the interface on.
    """
    result = sam.solve(coated(patch(64), 80e9))
    q, bare = result.quantities, patches[64].quantities
    depths = column(result, "axis", "z_m")
    assert result.converged and np.count_nonzero(depths < 1e-7) >= 8 and 1e-7 in depths
    assert q["p_max_bare_Pa"] == pytest.approx(bare["p_max_Pa"], rel=1e-8)
    assert q["p_max_change"] == pytest.approx(q["p_max_Pa"] / q["p_max_bare_Pa"] - 1, rel=1e-12)
    below = Grid(cells=(64, 64), extent=(64e-6, 64e-6), border="relief", depths=tuple(depths[depths >= 1e-7]))
    alone = sam.solve(patch(64).model_copy(update={"grid": below})).quantities
    assert q["mises_max_bare_Pa"] == pytest.approx(alone["mises_max_Pa"], rel=1e-8)
    assert -0.1 < q["p_max_change"] < -0.005 and -0.1 < q["mises_max_change"] < -0.005
    assert q["mises_max_substrate_Pa"] == pytest.approx(
        (1 + q["mises_max_change"]) * q["mises_max_bare_Pa"], rel=1e-12
    )


def test_a_film_of_the_same_material_changes_nothing(patches):
    """1e-8: the table of the layered coefficients holds zeros then."""
    q = sam.solve(coated(patch(64), 210e9)).quantities
    assert abs(q["p_max_change"]) < 1e-8 and abs(q["mises_max_change"]) < 1e-8
    assert q["p_max_Pa"] == pytest.approx(patches[64].quantities["p_max_Pa"], rel=1e-8)


# --- borders, warnings, record ------------------------------------------------------------------------------


def ridge(x, y):
    """Along y, from border to border."""
    return -(x**2) / (2 * R) + 0 * y


def test_a_contact_at_the_edge_is_a_warning_and_its_border_does_not_count():
    """The ends of a ridge that is cut carry more than its middle, which is a long cylinder: p0 = sqrt(F'
    E*/(pi R)).

    For smooth bodies the same is an error.
    """
    force, side, n = 2.0, 40e-6, 64
    result = sam.solve(of_heights(ridge, n, side, force=force))
    p = column(result, "surface", "p_Pa").reshape(n, n)
    assert result.status is Status.CONVERGED and "the outer 6 x 6 cells do not count" in result.warnings[-1]
    assert result.quantities["p_max_Pa"] == p[6:-6, 6:-6].max() < 0.8 * p.max()
    assert column(result, "history", "p_max_Pa")[-1] == result.quantities["p_max_Pa"]
    cylinder = {"shape": "ellipsoid", "radius_x": R, "radius_y": 1e3 * R}
    grid = {"cells": (n, n), "extent": (side, side)}
    smooth = small_scene(counterbody=cylinder, loading={"force": force}, grid=grid)
    assert sam.solve(smooth).status is Status.CONTACT_AT_GRID_EDGE


def test_a_contact_near_the_edge_counts_as_long_as_it_does_not_touch_it():
    """An asperity seven cells from the edge, with a contact radius of six: in what would be left out."""
    n, side = 128, 8 * A0
    place = centres(n, side)[7]
    depths = Grid(depths=(0.0, 0.48 * A0 / 20 ** (1 / 3)))  # the largest stress lies at 0.48 contact radii
    result = sam.solve(
        of_heights(lambda x, y: -((x - place) ** 2 + y**2) / (2 * R), n, side, force=F / 20, grid=depths)
    )
    p = column(result, "surface", "p_Pa").reshape(n, n)
    assert result.converged and p[:12].max() == p.max() > 0 and not p[0].any()
    assert result.quantities["p_max_Pa"] == p.max()
    assert result.quantities["mises_max_Pa"] == pytest.approx(
        0.62 * p.max(), rel=0.02
    )  # as among six cells in the radius


def test_relief_keeps_the_contact_off_the_border():
    result = sam.solve(
        of_heights(lambda x, y: 20 * ridge(x, y), 64, 40e-6, force=0.5, grid=Grid(border="relief"))
    )
    p = column(result, "surface", "p_Pa").reshape(64, 64)
    assert result.converged and not p[[0, -1]].any() and not p[:, [0, -1]].any()
    assert p[32, 20:44].min() > 0 and not any("edge" in text for text in result.warnings)


def test_small_spots_and_short_waves_are_warned_of():
    """At 24 cells the shortest wave of 12 um has 4.5, at 16 it has 3."""
    small, short = "too few cells in 2 of 2 spots", "3 cells in the shortest wavelength"
    assert small in sam.solve(patch(24)).warnings[0] and short in sam.solve(patch(16)).warnings[0]
    assert sam.solve(patch(64, force=1e-4)).status is Status.UNDER_RESOLVED
    assert sam.solve(patch(128)).warnings == ()


def spots_of(*counts: int, load: float = 1.0) -> np.ndarray:
    """Pressures of spots in rows of their own, the first with the load per cell given, the others with 1."""
    pressure = np.zeros((2 * len(counts) + 1, 40))
    for k, count in enumerate(counts):
        pressure[2 * k + 1, 1 : count + 1] = 1.0 if k else load
    return pressure


@pytest.mark.parametrize(
    "pressure, words",
    [
        (
            spots_of(32, 23, 18, 15, 8, 2, 1, load=1.01),
            ("4 of 5 spots", "23, 18, 15, 8 cells; together 64.4 %"),
        ),
        (spots_of(32, 28, 1, load=1.01), ()),
        (spots_of(1, 30, 30, load=1.1), ("1 of 3 spots", "(1 cells; together 1.8 %")),  # the largest pressure
        (
            np.kron(np.eye(2), np.ones((4, 6))),
            ("2 of 2 spots", "24, 24 cells; together 100 %"),
        ),  # at a corner
        (np.zeros((4, 4)), ()),
    ],
)
def test_every_spot_that_carries_a_twentieth_of_the_load_is_judged(pressure, words):
    """28 cells are needed: pi 3^2."""
    found = too_few_cells(pressure)
    assert bool(found) == bool(words) and all(each in found for each in words)


def test_surface_table_and_fields_hold_the_heights(tmp_path):
    scene = of_heights(lambda x, y: -(x**2 + 2 * y**2) / (2 * R), 12, 4 * A0)
    result = sam.solve(scene.model_copy(update={"loading": Loading(force=F, unload=True)}))
    write_run(result, scene, tmp_path / "run")
    run = read_run(tmp_path / "run")
    table = run.tables["surface"]
    assert (
        list(table) == ["state", "x_m", "y_m", "height_m", "p_Pa", "worn_m", "friction"]
        and len(table["x_m"]) == 2 * 144
    )
    assert np.allclose(
        table["height_m"], -(table["x_m"] ** 2 + 2 * table["y_m"] ** 2) / (2 * R), rtol=0, atol=1e-20
    )
    peak, h = table["state"] == "peak", 4 * A0 / 12
    assert table["p_Pa"][peak].sum() * h**2 == pytest.approx(F, rel=1e-9) and not table["p_Pa"][~peak].any()
    assert np.array_equal(np.isfinite(table["friction"]), table["p_Pa"] > 0) and not table["worn_m"].any()
    assert run.summary["scene"] == resolved(scene) and run.scene == scene
    assert result.fields.cell_data["height_m"][:144] == pytest.approx(table["height_m"][:144])
    assert not (tmp_path / "run" / "cycles.csv").exists()
    smooth = small_scene(counterbody={"radius": R}, loading={"force": F}, grid={"cells": (17, 17)})
    plain = sam.solve(smooth)
    assert "surface" not in plain.tables and "height_m" not in plain.fields.cell_data


def test_depths_are_fine_near_the_surface_and_reach_an_eighth_of_the_side():
    grid = sam.choose_grid(patch(64))
    steps = np.diff(grid.depths)
    assert grid.depths[0] == 0 and np.allclose(steps[:8], 0.25e-6) and (np.diff(steps) > -1e-12).all()
    assert 8e-6 <= grid.depths[-1] < 1.2 * 8e-6


def test_the_plan_tells_what_is_computed_below_a_patch():
    text = "\n".join(plan_lines(plan(patch(64))))
    assert "stress lies anywhere below the patch" in text and "left out  stress outside the plane" not in text
    assert "that of surface.path" in "\n".join(plan_lines(plan(of_heights(ridge, 16, 40e-6))))


def test_a_tolerance_that_cannot_be_met_is_not_called_converged(monkeypatch):
    """1e-14 is met here; a share of it is below rounding."""
    scene = patch(64, solver=Solver(tolerance=1e-14))
    assert sam.solve(scene).converged
    monkeypatch.setattr("sam.elastic.problem.REACHED", 1e-18)
    result = sam.solve(scene)
    assert result.status is Status.NOT_CONVERGED and "stagnated" in result.message
