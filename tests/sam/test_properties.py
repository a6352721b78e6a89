# SPDX-License-Identifier: MIT
"""What no contact may depend on, for any gap, load and body: units, place, orientation, the way to the load.
Small grids.
"""

import numpy as np
import pytest
from builders import scene as small_scene
from hypothesis import given, settings, strategies as st
from plastic_start import begin
from rounding import FAR

import fem_reference
import sam
from sam.contact.convolution import Counters
from sam.contact.normal import Search, solve_contact
from sam.contact.stress import stresses
from sam.grid.cells import Window
from sam.kernels.patches import Cuboids, Lags
from sam.plasticity import Extent
from sam.plasticity.history import attempt
from sam.plasticity.spectra import BoxOperator
from sam.scene import (
    Body,
    CounterBody,
    Friction,
    Grid,
    HeightMap,
    Loading,
    Plasticity,
    Scene,
    Solver,
    Surface,
)
from sam.schedule import Load

PROPERTY = settings(max_examples=20, deadline=None, derandomize=True)
FEWER = settings(max_examples=10, deadline=None, derandomize=True)  # of those that solve plastic scenes
SEED, FACTOR = st.integers(0, 10**6), st.floats(1e-6, 1e6)
COUPLING = st.just(0.0) | st.floats(0.02, 0.3)
UM, MODULUS, TOLERANCE = 1e-6, 2e11, 1e-11
CLOSE = 1e-8  # of the largest value: solutions with residuals of TOLERANCE from other starts
MIRROR_X = np.array([1, 1, 1, 1, -1, -1.0])[:, None, None, None]  # strains 13 and 12 under x -> -x
MIRROR_Y = np.array([1, 1, 1, -1, 1, -1.0])[:, None, None, None]


def waves(seed: int, shape=(20, 16), cells=4) -> np.ndarray:
    """Random heights of about 1 on cells, without waves shorter than `cells` cells."""
    spectrum = np.fft.rfft2(np.random.default_rng(seed).normal(size=shape))
    k = np.hypot(np.fft.fftfreq(shape[0])[:, None], np.fft.rfftfreq(shape[1])[None])
    field = np.fft.irfft2(np.where(k <= 1 / cells, spectrum, 0.0), shape)
    return field / np.abs(field).max()


def bowl(shape, radius=4.0, at=(0.0, 0.0)) -> np.ndarray:
    """(x^2 + y^2)/(2 radius) in cells, about a point beside the middle."""
    x, y = (np.arange(n) - (n - 1) / 2 - a for n, a in zip(shape, at, strict=True))
    return (x[:, None] ** 2 + y[None, :] ** 2) / (2 * radius)


def contact_of(gap, force=0.02, h=(UM, UM), coupling=0.0, **search):
    return solve_contact(
        gap, h, MODULUS, force, coupling=coupling, search=Search(**{"tolerance": TOLERANCE} | search)
    )


def same(found, expected, tolerance=CLOSE) -> bool:
    found, expected = np.asarray(found), np.asarray(expected)
    return bool(np.abs(found - expected).max() <= tolerance * np.abs(expected).max())


# --- units and similarity -----------------------------------------------------------------------------------


@PROPERTY
@given(SEED, FACTOR, FACTOR, st.floats(0.3, 3.0), COUPLING)
def test_units_of_a_contact_change_neither_iterations_nor_digits(seed, length, stress, aspect, coupling):
    """Inside all is dimensionless. Equal iterations: far above rounding, see `rounding`."""
    gap, (hx, hy) = 0.05 * UM * waves(seed), (UM, aspect * UM)
    for tolerance in (FAR, TOLERANCE):
        base = contact_of(gap, h=(hx, hy), coupling=coupling, tolerance=tolerance)
        other = solve_contact(
            length * gap, (length * hx, length * hy), stress * MODULUS, 0.02 * stress * length**2,
            coupling=coupling, search=Search(tolerance),
        )  # fmt: skip
        assert base.converged and (other.iterations == base.iterations or tolerance < FAR)
    assert same(other.pressure / stress, base.pressure)
    assert same(other.displacement / length, base.displacement)
    assert abs(other.approach / length - base.approach) <= CLOSE * np.abs(base.displacement).max()


@PROPERTY
@given(SEED, st.floats(1e-3, 1e3), COUPLING)
def test_heights_and_force_in_proportion_keep_the_contact(seed, share, coupling):
    """The contact is homogeneous of degree one: the pressure follows the factor. Hertz: a force s^3 on
    lengths s, over s^2.
    """
    gap = bowl((20, 16)) * UM * 0.01 + 0.02 * UM * waves(seed)
    for tolerance in (FAR, TOLERANCE):
        base = contact_of(gap, coupling=coupling, tolerance=tolerance)
        other = contact_of(share * gap, force=0.02 * share, coupling=coupling, tolerance=tolerance)
        assert other.iterations == base.iterations or tolerance < FAR
    assert same(other.pressure / share, base.pressure) and same(other.gap / share, base.gap)


@PROPERTY
@given(st.floats(1e-9, 1e9), COUPLING, st.integers(2, 6))
def test_a_flat_punch_is_linear_in_the_force(share, coupling, radius):
    x = np.arange(17) - 8
    gap = np.where(np.hypot(x[:, None], x) <= radius, 0.0, np.inf)
    one, other = contact_of(gap, coupling=coupling), contact_of(gap, force=0.02 * share, coupling=coupling)
    assert same(other.pressure / share, one.pressure, 1e-10)
    if coupling == 0.0:
        assert (one.pressure[np.isfinite(gap)] > 0).all()


def sphere(
    young=210e9, radius=105e-6, force=0.05, *, steps=2, plastic=None, mu=None, scale=(1.0, 1.0), **more
) -> Scene:
    """17 x 17 cells below a rigid sphere.

    plastic: [body.plasticity]; scale: of lengths and stresses; more: keys of [loading] and [grid].
    """
    return small_scene(
        *scale,
        body={"young": young, "plasticity": plastic},
        counterbody={"radius": radius},
        loading={"force": force, "steps": steps, **more.get("loading", {})},
        friction=mu,
        grid={"cells": (17, 17), **more.get("grid", {})},
        solver={"tolerance": 1e-5},
    )


def steel(force: float, hardening: float = 0.0) -> dict:
    """Yields under 0.05 N; [body.plasticity] for `sphere`."""
    return {"force": force, "plastic": {"law": "linear", "yield_stress": 1.2e9, "modulus": hardening * 210e9}}


POWER = {"contact_area_m2": 2, "approach_m": 1, "residual_uz_center_m": 1, "peeq_max": 0}
COUNTS = ("contact_iterations", "plastic_iterations", "operator_applications", "ffts", "step_cuts")


@FEWER
@given(FACTOR, FACTOR, st.sampled_from([None, steel(0.05, 0.02)["plastic"]]), st.sampled_from([None, 0.2]))
def test_units_of_a_scene_change_neither_counters_nor_digits(length, stress, plastic, mu):
    keys = {"plastic": plastic, "mu": mu, "loading": {"unload": True}}
    base, other = sam.solve(sphere(**keys)), sam.solve(sphere(scale=(length, stress), **keys))
    assert base.converged and other.status == base.status
    assert [other.cost[name] for name in COUNTS] == [base.cost[name] for name in COUNTS]
    for name, power in POWER.items():
        if base.quantities[name]:
            assert other.quantities[name] / length**power == pytest.approx(base.quantities[name], rel=1e-10)
    for name in ("p_max_Pa", "mises_max_Pa", "residual_mises_max_Pa"):
        if base.quantities[name]:
            assert other.quantities[name] / stress == pytest.approx(base.quantities[name], rel=1e-10)


@FEWER
@given(
    st.floats(0.05, 20.0),
    st.floats(0.03, 0.12),
    st.sampled_from([0.0, 0.02, 0.1]),
    st.sampled_from([None, 0.3]),
)
def test_equal_ratio_of_pressure_to_yield_stress_is_a_similar_contact(blunter, force, hardening, mu):
    """Radius and moduli times s at equal force: equal pressures, strains over s (Johnson 1985, section 6.3).
    Not the units.

    1e-8: other roundings, and the contact is solved to 1e-7.
    """

    def solved(s):
        plastic = {"law": "linear", "yield_stress": 1.2e9, "modulus": hardening * s * 210e9}
        return sam.solve(
            sphere(s * 210e9, s * 105e-6, force, plastic=plastic, mu=mu, loading={"unload": True})
        ).quantities

    base, other = solved(1.0), solved(blunter)
    for name, power in (
        ("p_max_Pa", 0),
        ("contact_area_m2", 0),
        ("mises_max_Pa", 0),
        ("approach_m", 1),
        ("peeq_max", 1),
    ):
        assert other[name] * blunter**power == pytest.approx(base[name], rel=CLOSE), name


@FEWER
@given(FACTOR, FACTOR, st.sampled_from([None, steel(0.05, 0.02)["plastic"]]))
def test_units_of_a_scene_change_nothing_in_finite_elements(length, stress, plastic):
    def solved(scale):
        scene = sphere(scale=scale, plastic=plastic, loading={"unload": True})
        return fem_reference.solve(
            scene.model_copy(update={"fem": scene.fem.model_copy(update={"cells_per_radius": 4})})
        )

    base, other = solved((1.0, 1.0)), solved((length, stress))
    assert other.status == base.status and other.cost["newton_iterations"] == base.cost["newton_iterations"]
    for name in ("approach_m", "contact_radius_m"):
        assert other.quantities[name] / length == pytest.approx(base.quantities[name], rel=1e-10)
    assert other.quantities["p_max_Pa"] / stress == pytest.approx(base.quantities["p_max_Pa"], rel=1e-10)


# --- place and orientation ----------------------------------------------------------------------------------


@PROPERTY
@given(SEED, st.integers(-6, 6), st.integers(-5, 5), COUPLING)
def test_a_contact_moves_with_its_gap_by_whole_cells(seed, i, j, coupling):
    """A rough summit in the middle of a larger grid, and elsewhere on it."""
    whole, summit = np.full((32, 28), np.inf), bowl((16, 14)) * 0.02 * UM + 0.05 * UM * waves(seed, (16, 14))
    centred, moved = whole.copy(), whole.copy()
    centred[8:24, 7:21] = summit
    moved[8 + i : 24 + i, 7 + j : 21 + j] = summit
    base, other = contact_of(centred, coupling=coupling), contact_of(moved, coupling=coupling)
    assert base.converged and other.converged
    assert same(other.pressure, np.roll(base.pressure, (i, j), axis=(0, 1)))
    assert other.approach == pytest.approx(base.approach, abs=CLOSE * np.abs(base.displacement).max())


@PROPERTY
@given(SEED, st.floats(0.4, 2.5), st.sampled_from([(20, 16), (15, 21)]))
def test_reflections_and_quarter_turns_turn_the_contact(seed, aspect, shape):
    gap, hx, hy = 0.05 * UM * waves(seed, shape), UM, aspect * UM
    base = contact_of(gap, h=(hx, hy))
    assert same(contact_of(gap[::-1], h=(hx, hy)).pressure[::-1], base.pressure)
    assert same(contact_of(gap[:, ::-1], h=(hx, hy)).pressure[:, ::-1], base.pressure)
    assert same(contact_of(np.ascontiguousarray(gap.T), h=(hy, hx)).pressure.T, base.pressure)


@PROPERTY
@given(SEED, st.floats(0.02, 0.3))
def test_sliding_the_other_way_is_the_mirror_image(seed, coupling):
    """And the mirror in y slides the same way; in x it does not."""
    gap = 0.05 * UM * waves(seed)
    base = contact_of(gap, coupling=coupling).pressure
    assert same(contact_of(gap[::-1], coupling=-coupling).pressure[::-1], base)
    assert same(contact_of(gap[:, ::-1], coupling=coupling).pressure[:, ::-1], base)
    assert not same(contact_of(gap[::-1], coupling=coupling).pressure[::-1], base, 1e-4)


def rough(values: np.ndarray, friction=None, force=0.03, steps=1) -> Scene:
    """A perfectly plastic patch with these heights in um below a rigid plane."""
    extent = tuple(n * UM for n in values.shape)
    return Scene(
        body=Body(young=210e9, poisson=0.3, plasticity=Plasticity(law="perfect", yield_stress=2e9)),
        counterbody=CounterBody(shape="flat"),
        surface=Surface(kind="file", path=HeightMap(values * UM, extent)),
        loading=Loading(force=force, steps=steps, unload=True),
        friction=friction,
        grid=Grid(cells=values.shape, extent=extent, depths=(0.0, 0.5e-6, 1e-6, 1.7e-6, 2.6e-6, 4e-6, 6e-6)),
        solver=Solver(tolerance=1e-6),
    )


def committed(scene: Scene, sign: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """(pressure, plastic strain) of the step to the peak, on the whole grid. sign: of the traction
    along x.
    """
    model, now = begin(
        scene, lambda model: Extent(Window(0, 0, model.grid.nx, model.grid.ny), len(model.grid.depths))
    )
    now, trial = attempt(model, now, Load(scene.loading.force, sign))
    assert trial is not None and trial.converged and trial.plastic
    return now.state.pressure, now.state.material.strain


@FEWER
@given(SEED)
def test_a_rough_yielding_patch_turns_with_its_heights(seed):
    """Plastic strains to 1e-4 of the largest: the flow rule holds to 1e-6 of the yield stress in the cell,
    perfect plasticity.
    """
    heights = 0.3 * waves(seed, (16, 12), 5) - 0.03 * bowl((16, 12))
    p, strain = committed(rough(heights))
    for turned, sign, axis in ((heights[::-1], MIRROR_X, -2), (heights[:, ::-1], MIRROR_Y, -1)):
        pressure, found = committed(rough(turned))
        assert same(np.flip(pressure, axis), p, 1e-4) and same(np.flip(sign * found, axis), strain, 1e-4)
    pressure, found = committed(rough(heights.T))
    exchanged = found[[1, 0, 2, 4, 3, 5]].swapaxes(-1, -2)
    assert same(pressure.T, p, 1e-4) and same(exchanged, strain, 1e-4)


@FEWER
@given(SEED, st.floats(0.05, 0.4))
def test_a_yielding_patch_sliding_the_other_way_is_the_mirror_image(seed, mu):
    heights, friction = 0.3 * waves(seed, (16, 12), 5) - 0.03 * bowl((16, 12)), Friction(coefficient=mu)
    p, strain = committed(rough(heights, friction))
    pressure, found = committed(rough(heights[::-1], friction), sign=-1.0)
    assert same(pressure[::-1], p, 1e-4) and same(np.flip(MIRROR_X * found, -2), strain, 1e-4)
    pressure, found = committed(rough(heights[:, ::-1], friction))
    assert same(pressure[:, ::-1], p, 1e-4) and same(np.flip(MIRROR_Y * found, -1), strain, 1e-4)


# --- superposition and the way to the load ------------------------------------------------------------------


@PROPERTY
@given(SEED, st.floats(0.0, 0.5), st.floats(-2.0, 2.0))
def test_stresses_of_two_loads_add_up(seed, nu, factor):
    rng, grid = np.random.default_rng(seed), (9, 8)
    first, second = rng.normal(size=(2, 2, *grid))

    def of(p, q):
        return stresses({3: p, 1: q}, (1.0, 0.8), np.array([0.0, 0.7, 2.0]), Window(0, 0, *grid), nu=nu)

    assert same(of(*(first + factor * second)), of(*first) + factor * of(*second), 1e-12)


@PROPERTY
@given(SEED, st.floats(0.0, 0.499), st.floats(-2.0, 2.0))
def test_plastic_strains_add_up(seed, nu, factor):
    rng, faces = np.random.default_rng(seed), np.array([0.0, 0.5, 1.2, 2.5])
    operator = BoxOperator(Cuboids(Lags(6, 5, 1.0, 0.8), tuple(faces), nu), 2.0, Counters())
    first, second = rng.normal(size=(2, 6, 3, 6, 5))

    def of(strain):
        transformed = operator.transformed(strain)
        residual = operator.displacement(transformed)
        return operator.stress(None, operator.response(transformed)), residual

    for found, one, other in zip(of(first + factor * second), of(first), of(second), strict=True):
        assert same(found, one + factor * other, 1e-12)


@PROPERTY
@given(SEED, st.lists(st.floats(1e-3, 1.0), min_size=1, max_size=3), COUPLING)
def test_an_elastic_contact_forgets_the_way_to_its_load(seed, forces, coupling):
    """Each step starts from the pressure of the one before, up or down."""
    gap = bowl((20, 16)) * 0.01 * UM + 0.03 * UM * waves(seed)
    direct, start = contact_of(gap, coupling=coupling), None
    for force in forces:
        start = contact_of(gap, force=force, coupling=coupling, start=start).pressure
    assert same(contact_of(gap, coupling=coupling, start=start).pressure, direct.pressure)


@PROPERTY
@given(st.integers(2, 12), st.sampled_from([None, 0.3]), st.floats(1e-3, 1.0))
def test_an_elastic_scene_forgets_its_load_steps(steps, mu, force):
    one, many = (sam.solve(sphere(force=force, steps=n, mu=mu)).quantities for n in (1, steps))
    for name in ("p_max_Pa", "approach_m", "mises_max_Pa"):
        assert many[name] == pytest.approx(one[name], rel=CLOSE)


@FEWER
@given(st.integers(2, 6), st.floats(1e-3, 1.0))
def test_elastic_finite_elements_forget_their_load_steps(steps, force):
    def solved(n):
        scene = sphere(force=force, steps=n)
        return fem_reference.solve(
            scene.model_copy(update={"fem": scene.fem.model_copy(update={"cells_per_radius": 4})})
        )

    one, many = solved(1).quantities, solved(steps).quantities
    for name in ("p_max_Pa", "approach_m", "contact_radius_m"):
        assert many[name] == pytest.approx(one[name], rel=CLOSE)


# --- order --------------------------------------------------------------------------------------------------


@PROPERTY
@given(SEED, st.floats(1e-4, 1.0), st.floats(1.01, 5.0))
def test_more_force_never_opens_an_elastic_contact(seed, force, more):
    """Force is the derivative of the energy, convex in the approach: it rises. Cells in contact stay in
    contact.
    """
    gap = 0.1 * UM * waves(seed)
    low, high = contact_of(gap, force=force), contact_of(gap, force=more * force)
    assert high.approach > low.approach
    assert (high.pressure > 0)[low.pressure > 0].all()
    assert (high.gap <= low.gap + CLOSE * np.abs(low.displacement).max()).all()


@FEWER
@given(st.floats(0.02, 0.2), st.sampled_from([0.0, 0.02, 0.1]), st.sampled_from([None, 0.3]))
def test_approach_area_and_strain_rise_with_the_force_on_a_yielding_body(force, hardening, mu):
    scene = sphere(steps=5, mu=mu, grid={"extent": (14e-6, 14e-6)}, **steel(force, hardening))
    history = sam.solve(scene).tables["history"]
    assert (np.diff(history["approach_m"]) > 0).all()
    for name in ("contact_area_m2", "peeq_max"):  # whole cells, and nothing before yield
        assert (np.diff(history[name]) >= 0).all(), name
