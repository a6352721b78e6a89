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


# --- place and orientation ----------------------------------------------------------------------------------


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
