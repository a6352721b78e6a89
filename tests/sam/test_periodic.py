# SPDX-License-Identifier: MIT
"""Patches that repeat, against closed forms, sums over images and the same patch with another period."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import sam
from sam.contact.convolution import Counters
from sam.contact.normal import Search, solve_contact
from sam.contact.operators import PeriodicHalfSpaces
from sam.grid.cells import Window
from sam.grid.demands import step_across, tapered
from sam.kernels.patches import STRESS, Cuboids, Lags, displacement_coefficients, stress_coefficients
from sam.kernels.waves import in_cells, load_waves
from sam.plasticity.spectra import BoxOperator, PeriodicOperator
from sam.plasticity.swept import PeriodImages
from sam.results.tables import spots_of
from sam.scene import HeightMap, Scene

HELD, NU = PeriodicHalfSpaces(), 0.3


def wave(n: int, k: float = 1.0) -> np.ndarray:
    return np.cos(2 * np.pi * k * (np.arange(n) + 0.5) / n)[:, None]


@pytest.mark.parametrize("z", [None, 0.0, 0.1, 0.7])
@pytest.mark.parametrize("load", [3, 1])
def test_coefficients_are_sums_over_images(z, load):
    """Of the displacement in the direction of the load (z None), and of the stress at a depth."""
    cells, aspect, numbers = (8, 6), 1.3, (4, 8, 16, 32)
    kind, names = ("displacement", (str(load),)) if z is None else ("stress", STRESS)
    odd = [np.array([(name + str(load)).count(axis) % 2 for name in names]) for axis in "12"]
    waves = load_waves(kind, names, Lags(*cells, 1.0, aspect), NU, load=load, depths=(z or 0.0,))
    lags = Lags(*(n * (numbers[-1] + 1) for n in cells), 1.0, aspect)
    if z is None:
        free = displacement_coefficients(lags, NU, component=load, load=load)[None]
    else:
        free = stress_coefficients(lags, z, NU, load=load)[:, 0]
    sums = []
    for number in numbers:  # as many on both sides of each lag, those at the ends half
        part = free
        for axis, n, sign in zip((1, 2), cells, odd, strict=True):
            lag = np.arange(-n * number, n * number + 1)
            some = np.moveaxis(part.take(np.abs(lag), axis), axis, -1)
            some = some * np.where(lag < 0, (-1.0) ** sign[:, None, None], 1.0)
            some[..., 0] = (some[..., 0] + some[..., -1]) / 2
            some = some[..., :-1].reshape(*some.shape[:-1], -1, n).sum(axis=-2)
            part = np.moveaxis(some, -1, axis)
        sums.append(part - part.mean(axis=(1, 2), keepdims=True))
    for power in (1, 2, 3):
        sums = [(2**power * b - a) / (2**power - 1) for a, b in pairwise(sums)]
    np.testing.assert_allclose(in_cells(waves, cells, names, load), sums[0], rtol=0, atol=5e-7)


def test_harmonic_loads_by_hand():
    """Stress of p = 1 + cos x and q = .5 (Johnson 1985, by superposition of Boussinesq's)."""
    n, z = 32, 3.0
    k, p, q = 2 * np.pi / n, np.repeat(1 + wave(n), 4, 1), np.full((n, 4), 0.5)
    cell = np.sinc(k / 2 / np.pi)
    for bodies, lateral in ((HELD, -NU / (1 - NU)), (PeriodicHalfSpaces(free=True), 0.0)):
        loads, window = {3: p, 1: q}, Window(0, 0, n, 4)
        s = bodies.stresses(loads, (2.0, 2.0), [2 * z], window, nu=NU, counters=Counters())[:, 0]
        of_wave, fall = cell * wave(n), np.exp(-k * z)
        np.testing.assert_allclose(s[2], -1 - (1 + k * z) * fall * of_wave + 0 * p, atol=1e-7)
        np.testing.assert_allclose(s[0], lateral - (1 - k * z) * fall * of_wave + 0 * p, atol=1e-7)
        np.testing.assert_allclose(s[1], lateral - 2 * NU * fall * of_wave + 0 * p, atol=1e-7)
        np.testing.assert_allclose(s[4].mean(), -0.5, atol=1e-12)


def test_friction_turns_the_pressure_of_a_wave_in_full_contact():
    """u = (1 - i c/2) p/k of both tractions together (c: coupling) closes the wave."""
    n, amplitude, c = 64, 1e-3, 0.3
    k = 2 * np.pi
    gap = np.repeat(amplitude * (1 - wave(n)), 2, axis=1)
    contact = solve_contact(gap, (1 / n, 1 / n), 2.0, 0.02 / n, coupling=c, bodies=HELD, search=Search(1e-9))
    x = (np.arange(n) + 0.5) / n
    exact = 0.01 + amplitude * k / np.hypot(1, c / 2) * np.cos(k * x + np.arctan(c / 2))
    assert contact.converged and (contact.pressure > 0).all()
    np.testing.assert_allclose(contact.pressure[:, 0], exact, rtol=1.5e-3)
    assert contact.approach == pytest.approx(gap.mean(), rel=1e-9)


FACES = (0.0, 0.5, 1.2, 2.0, 3.4, 5.0)
BOX = Cuboids(Lags(16, 12, 1.0, 1.25), FACES, NU)
STRAIN = np.random.default_rng(1).standard_normal((6, 5, 16, 12))


def operator(box: Cuboids = BOX, bodies: PeriodicHalfSpaces = HELD) -> PeriodicOperator:
    return PeriodicOperator(bodies, box, 1.0, Counters(), swept=1e-7)


def stress_of(box: BoxOperator, strain: np.ndarray) -> np.ndarray:
    return box.stress(None, box.response(box.transformed(strain)))


def test_plastic_strain_is_that_in_a_box_and_in_its_images():
    small = replace(BOX, lags=Lags(8, 6, 1.0, 1.25))
    inside, images = STRAIN[..., :8, :6], PeriodImages(small, (8, 6), (16, 12), 1e-5)
    found = stress_of(BoxOperator(small, 1.0, Counters()), inside)
    found += images.fields(images.values(images.moments(inside)))
    alone = np.zeros_like(STRAIN)
    alone[..., :8, :6] = inside
    np.testing.assert_allclose(stress_of(operator(), alone)[..., :8, :6], found, rtol=0, atol=1e-4)


def test_plastic_strain_repeats_wherever_the_period_begins():
    moved = np.roll(STRAIN, (5, 7), axis=(2, 3))
    box, twice = operator(), operator(replace(BOX, lags=Lags(32, 12, 1.0, 1.25)))
    stress = stress_of(box, STRAIN)
    np.testing.assert_allclose(stress_of(box, moved), np.roll(stress, (5, 7), (2, 3)), rtol=0, atol=1e-12)
    tiled = stress_of(twice, np.tile(STRAIN, (1, 1, 2, 1)))
    np.testing.assert_allclose(tiled, np.tile(stress, (1, 1, 2, 1)), rtol=0, atol=1e-4)


def test_laterally_uniform_strain_by_hand():
    """s_11 = -2 mu (e_11 + nu e_22)/(1 - nu), s_12 = -2 mu e_12, s_i3 = 0, or nothing where it may spread."""
    e = np.broadcast_to(STRAIN.mean(axis=(2, 3), keepdims=True), STRAIN.shape)
    exact = np.zeros_like(e)
    exact[0] = -2 * (e[0] + NU * e[1]) / (1 - NU)
    exact[1] = -2 * (e[1] + NU * e[0]) / (1 - NU)
    exact[5] = -2 * e[5]
    box = operator()
    np.testing.assert_allclose(stress_of(box, e), exact, rtol=0, atol=1e-12)
    np.testing.assert_allclose(stress_of(operator(bodies=PeriodicHalfSpaces(free=True)), e), 0, atol=1e-12)
    np.testing.assert_allclose(box.displacement(box.transformed(e)), 0, atol=1e-12)


def test_harmonic_dilatation_moves_the_surface_by_hand():
    """u_z = -2 (1 + nu) e int e^{-kz} dz, of centres of dilatation (Mindlin and Cheng 1950)."""
    n, strain = 32, np.zeros((6, 5, 32, 12))
    strain[:3, 2:4] = wave(n)
    box = operator(replace(BOX, lags=Lags(n, 12, 1.0, 1.25)))
    k = 2 * np.pi / n
    exact = -2 * (1 + NU) * (np.exp(-k * FACES[2]) - np.exp(-k * FACES[4])) / k * np.sinc(k / 2 / np.pi)
    found = box.displacement(box.transformed(strain))
    np.testing.assert_allclose(found, exact * wave(n) + 0 * found, rtol=0, atol=1e-4)
    along = HELD.moved(strain, replace(BOX, lags=Lags(n, 12, 1.0, 1.25)), 1)
    sine = np.sin(2 * np.pi * (np.arange(n) + 0.5) / n)[:, None]
    np.testing.assert_allclose(along, -exact * sine + 0 * found, rtol=0, atol=1e-4)


def wavy(**edits) -> Scene:
    """A patch of one wave of steel that yields, under a flat; edits: keys of tables."""
    tables = {
        "body": {"young": 210e9, "poisson": NU, "plasticity": {"law": "perfect", "yield_stress": 1e9}},
        "counterbody": {"shape": "flat"},
        "surface": {"kind": "sinusoid", "amplitude": 1e-7, "wavelength_x": 16e-6},
        "loading": {"mean_pressure": 350e6},
        "grid": {"cells": (16, 8), "extent": (16e-6, 8e-6), "periodic": "xy", "layers": 6, "depth": 6e-6},
        "solver": {"tolerance": 1e-4},
    }
    return Scene(**{name: table | edits.get(name, {}) for name, table in tables.items()})


def test_a_wave_at_the_border_yields_like_one_in_the_middle():
    grid = {"cells": (24, 4), "extent": (24e-6, 4e-6), "layers": 5, "depth": 5e-6}
    result = sam.solve(wavy(grid=grid, surface={"wavelength_x": 12e-6}))
    p = np.reshape(result.tables["surface"]["p_Pa"], (24, 4))
    np.testing.assert_allclose(np.roll(p, 12, axis=0), p, rtol=0, atol=1e-5 * p.max())
    assert result.quantities["peeq_max"] > 1e-4 and result.quantities["contact_spots"] == 2
    assert {"padding", "images of the period"} <= {each.stage for each in result.left_out}


def test_heights_that_do_not_repeat_are_refused_or_tapered():
    x = (np.arange(40) + 0.5) / 40
    waves = np.sin(2 * np.pi * 3 * x)[:, None] + np.cos(2 * np.pi * 2 * x[:32])
    assert step_across(waves[:, :20]) < 1.6 and step_across(waves) > 3
    found = tapered(waves, 0.5)
    assert step_across(found) < 1.6
    middle = slice(10, 30), slice(8, 24)
    np.testing.assert_array_equal(found[middle], waves[middle])
    surface = {"kind": "file", "path": HeightMap(1e-8 * waves, (40e-6, 32e-6))}
    tables = {"body": {"young": 2e11, "poisson": NU}, "counterbody": {"shape": "flat"}}
    tables |= {"grid": {"periodic": "xy"}, "loading": {"mean_pressure": 1e8}}
    with pytest.raises(
        sam.UnsupportedScene, match=r"surface.path = .* 3 times .*or surface.taper is allowed"
    ):
        sam.solve(Scene(**tables, surface=surface))
    result = sam.solve(Scene(**tables, surface=surface | {"taper": 0.5}))
    change = 1e-8 * np.sqrt(np.mean((found - waves) ** 2))
    assert f"heights are changed by {change:.4g} m (rms)" in " ".join(result.warnings)
    assert result.converged and result.quantities["force_N"] == pytest.approx(1e8 * 40e-6 * 32e-6)


@pytest.mark.parametrize(
    ("edits", "words"),
    [
        ({"grid": {"cells": (15, 8)}}, r"grid.cells = \[15, 8\].* even numbers of cells is allowed"),
        ({"grid": {"extent": (24e-6, 8e-6)}}, "grid.extent = 2.4e-05 m: a whole multiple of 1.6e-05 m"),
        ({"solver": {"operator": "dense"}}, 'solver.operator = "dense": "swept" is allowed'),
    ],
)
def test_what_a_periodic_patch_cannot_have(edits, words):
    with pytest.raises(sam.UnsupportedScene, match=words):
        sam.check(wavy(**edits))


def test_an_approach_is_less_than_the_mean_gap():
    def pressed(**loading):
        loading = {"mean_pressure": None, **loading}
        return wavy(body={"plasticity": None}, loading=loading, grid={"layers": None, "depth": None})

    result = sam.solve(pressed(approach=0.9e-7))
    again = pressed(force=result.quantities["force_N"])
    assert sam.solve(again).quantities["approach_m"] == pytest.approx(0.9e-7, rel=1e-6)
    with pytest.raises(sam.UnsupportedScene, match=r"loading.approach = 1e-07 m: .*less than 9.808e-08 m"):
        sam.solve(pressed(approach=1e-7))


def test_spots_go_on_across_the_border():
    p = np.zeros((6, 7))
    p[0, 2] = p[-1, 2] = p[-1, 1] = p[3, 0] = p[3, -1] = p[2, 4] = 1.0
    assert spots_of(p, (True, True)).max() == 3 and spots_of(p, (False, False)).max() == 5
