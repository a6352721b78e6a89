# SPDX-License-Identifier: MIT
"""What no contact may depend on, for any gap, load and body: units, orientation, the way to the load."""

import numpy as np
from hypothesis import given, settings, strategies as st
from plastic_start import begin
from rounding import FAR

from sam.contact.convolution import Counters
from sam.contact.normal import Search, solve_contact
from sam.contact.stress import stresses
from sam.grid.cells import Window
from sam.kernels.patches import Cuboids, Lags
from sam.plasticity import Extent
from sam.plasticity.history import attempt
from sam.plasticity.spectra import BoxOperator
from sam.scene import Body, CounterBody, Grid, HeightMap, Loading, Plasticity, Scene, Solver, Surface
from sam.schedule import Load

PROPERTY = settings(max_examples=8, deadline=None, derandomize=True)
SEED, FACTOR = st.integers(0, 10**6), st.floats(1e-6, 1e6)
COUPLING = st.just(0.0) | st.floats(0.02, 0.3)
UM, MODULUS, TOLERANCE = 1e-6, 2e11, 1e-11
CLOSE = 1e-8  # of the largest value: solutions with residuals of TOLERANCE from other starts


def waves(seed: int, shape=(20, 16), cells=4) -> np.ndarray:
    """Random heights of about 1 on cells, without waves shorter than `cells` cells."""
    spectrum = np.fft.rfft2(np.random.default_rng(seed).normal(size=shape))
    k = np.hypot(np.fft.fftfreq(shape[0])[:, None], np.fft.rfftfreq(shape[1])[None])
    field = np.fft.irfft2(np.where(k <= 1 / cells, spectrum, 0.0), shape)
    return field / np.abs(field).max()


def bowl(shape, radius=4.0) -> np.ndarray:
    """(x^2 + y^2)/(2 radius) in cells, about the middle."""
    x, y = (np.arange(n) - (n - 1) / 2 for n in shape)
    return (x[:, None] ** 2 + y[None, :] ** 2) / (2 * radius)


def contact_of(gap, force=0.02, h=(UM, UM), modulus=MODULUS, *, coupling=0.0, **search):
    search = Search(**{"tolerance": TOLERANCE} | search)
    return solve_contact(gap, h, modulus, force, coupling=coupling, search=search)


def same(found, expected, tolerance=CLOSE) -> bool:
    found, expected = np.asarray(found), np.asarray(expected)
    return bool(np.abs(found - expected).max() <= tolerance * np.abs(expected).max())


@PROPERTY
@given(SEED, FACTOR, FACTOR, st.floats(0.3, 3.0), COUPLING)
def test_units_of_a_contact_change_neither_iterations_nor_digits(seed, length, stress, aspect, coupling):
    """Inside all is dimensionless. Equal iterations: far above rounding, see `rounding`."""
    gap, h, force = 0.05 * UM * waves(seed), np.array([UM, aspect * UM]), 0.02 * stress * length**2
    for tolerance in (FAR, TOLERANCE):
        keys = {"coupling": coupling, "tolerance": tolerance}
        base = contact_of(gap, h=h, **keys)
        other = contact_of(length * gap, force, length * h, stress * MODULUS, **keys)
        assert base.converged and (other.iterations == base.iterations or tolerance < FAR)
    assert same(other.pressure / stress, base.pressure)
    assert same(other.displacement / length, base.displacement)
    assert abs(other.approach / length - base.approach) <= CLOSE * np.abs(base.displacement).max()


@PROPERTY
@given(SEED, st.floats(0.4, 2.5), st.sampled_from([(20, 16), (15, 21)]), st.floats(0.02, 0.3))
def test_reflections_and_quarter_turns_turn_the_contact(seed, aspect, shape, coupling):
    """Sliding the other way is the mirror image; the mirror in y slides the same way, in x it does not."""
    gap, hx, hy = 0.05 * UM * waves(seed, shape), UM, aspect * UM
    base = contact_of(gap, h=(hx, hy))
    assert same(contact_of(np.ascontiguousarray(gap.T), h=(hy, hx)).pressure.T, base.pressure, 1e-9)
    assert same(contact_of(gap[:, ::-1], h=(hx, hy)).pressure[:, ::-1], base.pressure, 1e-9)
    base = contact_of(gap, coupling=coupling).pressure
    assert same(contact_of(gap[::-1], coupling=-coupling).pressure[::-1], base, 1e-9)
    assert same(contact_of(gap[:, ::-1], coupling=coupling).pressure[:, ::-1], base, 1e-9)
    assert not same(contact_of(gap[::-1], coupling=coupling).pressure[::-1], base, 1e-4)


def test_a_contact_moves_with_its_gap():
    """By whole cells, on a wider grid. Both are solved to residuals of 1e-11, here amplified tenfold."""
    gap, found = 0.05 * UM * waves(1), []
    for i, j in ((0, 12), (7, 0)):
        room, window = np.full((27, 28), np.inf), np.s_[i : i + 20, j : j + 16]
        room[window] = gap
        found.append(contact_of(room).pressure[window])
    assert same(*found, 1e-9)


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


@PROPERTY
@given(SEED, st.floats(0.0, 0.499), st.floats(-2.0, 2.0))
def test_stresses_of_loads_and_of_plastic_strains_add_up(seed, nu, factor):
    rng = np.random.default_rng(seed)
    operator = BoxOperator(Cuboids(Lags(6, 5, 1.0, 0.8), (0.0, 0.5, 1.2, 2.5), nu), 2.0, Counters())

    def of_loads(loads):
        grid = Window(0, 0, 9, 8)
        return stresses({3: loads[0], 1: loads[1]}, (1.0, 0.8), np.array([0.0, 0.7, 2.0]), grid, nu=nu)

    def of_strain(strain):
        transformed = operator.transformed(strain)
        return operator.stress(None, operator.response(transformed))

    for of, shape in ((of_loads, (2, 9, 8)), (of_strain, (6, 3, 6, 5))):
        first, second = rng.normal(size=(2, *shape))
        assert same(of(first + factor * second), of(first) + factor * of(second), 1e-12)


def committed(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(pressure, plastic strain) of a perfectly plastic patch with these heights in um below a rigid plane,
    in one step to the peak.
    """
    extent = tuple(n * UM for n in values.shape)
    scene = Scene(
        body=Body(young=210e9, poisson=0.3, plasticity=Plasticity(law="perfect", yield_stress=2e9)),
        counterbody=CounterBody(shape="flat"),
        surface=Surface(kind="file", path=HeightMap(values * UM, extent)),
        loading=Loading(force=0.03, unload=True),
        grid=Grid(cells=values.shape, extent=extent, depths=(0.0, 0.5e-6, 1e-6, 1.7e-6, 2.6e-6, 4e-6, 6e-6)),
        solver=Solver(tolerance=1e-6),
    )
    model, now = begin(scene, lambda model: Extent(model.grid.whole, len(model.grid.depths)))
    now, trial = attempt(model, now, Load(0.03))
    assert trial is not None and trial.converged and trial.plastic
    return now.state.pressure, now.state.material.strain


def test_a_rough_yielding_patch_turns_with_its_heights():
    """Plastic strains to 1e-4 of the largest: the flow rule holds to 1e-6 of the yield stress in the cell,
    perfect plasticity.
    """
    heights = 0.3 * waves(1, (16, 12), 5) - 0.03 * bowl((16, 12))
    p, strain = committed(heights)
    pressure, found = committed(heights[::-1])
    signs = np.array([1, 1, 1, 1, -1, -1.0])[:, None, None, None]  # strains 13 and 12 under x -> -x
    assert same(pressure[::-1], p, 1e-4) and same((signs * found)[:, :, ::-1], strain, 1e-4)
    pressure, found = committed(heights.T)
    exchanged = found[[1, 0, 2, 4, 3, 5]].swapaxes(-1, -2)
    assert same(pressure.T, p, 1e-4) and same(exchanged, strain, 1e-4)
