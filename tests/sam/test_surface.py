# SPDX-License-Identifier: MIT
"""Rough surfaces: generators against spectra and closed forms; form, holes, crop and resampling."""

import numpy as np
import pytest
from builders import measured_scene

from sam.grid.demands import RoughPatch
from sam.scene import Grid, HeightMap, SceneError, Surface, load_scene
from sam.scene.surface import (
    BORDER,
    border_cells,
    heights,
    mean_deviation,
    patch_of,
    processed,
    roughness,
    roughness_as_read,
    with_relief,
)
from sam.scene.surface.making import fitted_form, harmonic, resampled
from verification.robustness.fuzz import npz

SIDE = 64e-6
PATCH = (SIDE, SIDE)
SELF_AFFINE = {"kind": "self-affine", "ra": 0.27e-6, "cutoff_long": 32e-6, "cutoff_short": 4e-6}
SELF_AFFINE |= {"hurst": 0.8, "seed": 3}
TURNED = SELF_AFFINE | {"kind": "hard-turned", "feed": 20e-6, "nose_radius": 0.8e-3, "feed_share": 0.4}


def centres(n: int, h: float = 0.0) -> np.ndarray:
    """Of cells h wide; of n cells over the patch, if no width is given."""
    return (np.arange(n) - (n - 1) / 2) * (h or SIDE / n)


def on_grid(surface: Surface, n: int) -> np.ndarray:
    return heights(surface, centres(n), centres(n), PATCH)


# generators


@pytest.mark.parametrize("keys", [SELF_AFFINE | {"anisotropy": 1.5}, TURNED | {"feed": 82e-6}])
def test_a_finer_grid_has_the_same_surface(keys):
    """1e-13 of Ra is rounding. |h| has kinks where h = 0: its mean over 144 cells is 0.3 % off."""
    surface = Surface(**keys)
    coarse, fine = on_grid(surface, 48), on_grid(surface, 144)
    assert np.abs(fine[1::3, 1::3] - coarse).max() < 1e-12 * surface.ra
    assert np.abs(on_grid(Surface(**keys | {"seed": 4}), 48) - coarse).max() > surface.ra
    assert roughness(fine, 1, 1).sa == pytest.approx(0.27e-6, rel=3e-3)
    assert abs(fine.mean()) < 1e-3 * surface.ra
    assert mean_deviation(surface, PATCH) == pytest.approx(0.27e-6, rel=1e-12)


@pytest.mark.parametrize("anisotropy", [1.0, 1.5])
def test_spectrum_is_flat_then_falls_with_the_hurst_exponent_then_ends(anisotropy):
    n = 96
    power = np.abs(np.fft.fft2(on_grid(Surface(**SELF_AFFINE, anisotropy=anisotropy), n))) ** 2
    m = np.fft.fftfreq(n, 1 / n)
    q = np.hypot(m[:, None], anisotropy * m[None, :])  # periods in the side
    inside = (q > 0) & (q <= 16 * (1 + 1e-9))
    flat, falling = inside & (q <= 2), inside & (q > 2)
    level = power[flat].mean()
    assert np.allclose(power[flat], level, rtol=1e-9, atol=0)
    assert np.allclose(power[falling], level * (q[falling] / 2) ** -3.6, rtol=1e-9, atol=0)
    assert power[~inside].max() < 1e-24 * level


def test_feed_marks_are_arcs_of_the_nose_with_cusps_up():
    """Of full share x^2/(2 r) but for the waves left out; ideal Ra: f^2/(18 sqrt(3) r) = 0.0321 f^2/r."""
    feed, radius = 16e-6, 0.8e-3
    keys = TURNED | {"feed": feed, "nose_radius": radius, "feed_share": 1.0, "cutoff_short": 0.05e-6}
    surface = Surface(**keys | {"ra": feed**2 / (18 * np.sqrt(3) * radius)})
    x = np.linspace(-feed / 2, 1.5 * feed, 401)
    h = heights(surface, x, np.zeros(1), PATCH)[:, 0]
    t = np.mod(x, feed) - feed / 2  # cusps at 0 and feed
    exact = (t**2 - feed**2 / 12) / (2 * radius)
    # the rounded cusp: 320 waves, 1/320 of the first is missing
    assert np.abs(h - exact).max() < 0.02 * exact.max()
    assert min(x[h.argmax()], feed - x[h.argmax()]) == pytest.approx(0.0, abs=0.01 * feed)
    assert np.allclose(heights(surface, x, centres(5), PATCH), h[:, None])  # along y nothing changes


@pytest.mark.parametrize(("share", "radius"), [(0.4, 0.8e-3), (0.1, 0.5e-3)])
def test_a_turned_surface_is_marks_and_a_self_affine_part_by_the_roots_of_the_share(share, radius):
    """Least squares on both parts leaves nothing; marks: t^2/(2 r), feed 16 um down to 4 um: four waves."""
    feed, x = 16e-6, centres(48)
    h = on_grid(Surface(**TURNED | {"feed": feed, "nose_radius": radius, "feed_share": share}), 48)
    waves = [(feed / (np.pi * k)) ** 2 * np.cos(2 * np.pi * k * x / feed) for k in range(1, 5)]
    marks = sum(waves)[:, None] / (2 * radius) + 0 * h
    parts = np.stack([marks.ravel(), on_grid(Surface(**SELF_AFFINE), 48).ravel()])
    (of_marks, of_rest), left, *_ = np.linalg.lstsq(parts.T, h.ravel())
    assert left[0] < 1e-20 * (h**2).sum()
    assert of_marks / of_rest == pytest.approx(np.sqrt(share / (1 - share)), rel=1e-9)


def test_sinusoid_and_its_roughness():
    """Sa = 2 A/pi, Sq = A/sqrt 2, slope A q/sqrt 2; the product of two waves has (2/pi)^2 A and A/2."""
    amplitude, n = 1e-7, 512
    wave = {"kind": "sinusoid", "amplitude": amplitude, "wavelength_x": 16e-6}
    found = roughness(on_grid(Surface(**wave), n), SIDE / n, SIDE / n)
    assert found.sa == pytest.approx(2 / np.pi * amplitude, rel=1e-3)
    assert found.sq == pytest.approx(amplitude / np.sqrt(2), rel=1e-9)
    assert found.sdq == pytest.approx(2 * np.pi * amplitude / 16e-6 / np.sqrt(2), rel=1e-3)
    assert abs(found.ssk) < 1e-9
    both = Surface(**wave, wavelength_y=8e-6)
    assert roughness(on_grid(both, n), 1, 1).sq == pytest.approx(amplitude / 2, rel=1e-9)
    assert heights(both, np.zeros(1), np.zeros(1), PATCH)[0, 0] == amplitude
    h = np.exp(np.random.default_rng(1).normal(size=(50, 50)))
    z = (h - h.mean()) / h.std()
    assert roughness(h, 1, 1).ssk == pytest.approx(np.mean(z**3), rel=1e-12)
    assert roughness(np.ones((4, 4)), 1, 1).ssk == 0.0


def test_relief_leaves_the_inside_and_falls_smoothly_to_four_mean_deviations():
    n = 320
    x = centres(n)
    edge = np.append(x, SIDE / 2)
    flat = with_relief(np.zeros((n + 1, n)), (edge, x), PATCH, 0.25e-6)
    inside = np.abs(edge) < (0.5 - BORDER) * SIDE
    assert not flat[np.ix_(inside, inside[:-1])].any()
    assert np.allclose(flat[-1], -1e-6, rtol=1e-12)  # at the edge
    middle = flat[:, n // 2]
    assert (np.diff(middle[n // 2 :]) <= 0).all()
    slope = np.diff(middle) / np.diff(edge)
    assert np.abs(np.diff(slope)).max() < 0.15 * np.abs(slope).max()  # 30 cells in the strip: no kink
    assert flat.min() >= -1e-6 * (1 + 1e-12) and border_cells((64, 65)) == (6, 7)


# measured heights: form

CELL = (2e-6, 1e-6)


def measured(values: np.ndarray, cell=CELL, **keys) -> Surface:
    extent = tuple(n * h for n, h in zip(values.shape, cell, strict=True))
    return Surface(kind="file", path=HeightMap(values, extent), **keys)


def places(shape, cell=CELL):
    return np.meshgrid(*(centres(n, h) for n, h in zip(shape, cell, strict=True)), indexing="ij")


def noise(shape, seed=0):
    return np.random.default_rng(seed).normal(size=shape)


POLYNOMIALS = {
    "tilt": lambda x, y: [1 + 0 * x, x, y],
    "sphere": lambda x, y: [1 + 0 * x, x, y, x**2 + y**2],
    "quadratic": lambda x, y: [1 + 0 * x, x, y, x**2, x * y, y**2],
}


@pytest.mark.parametrize("form", POLYNOMIALS)
def test_the_form_is_that_of_a_general_least_squares_solver(form):
    """1e-9: the general solver works with metres, badly scaled. 1e-14: the form is fitted again to what is
    left, so that only the twenty roundings of its last evaluation stay.
    """
    terms = POLYNOMIALS[form](*places((31, 24)))
    scales = (1e-3, 0.02, -0.03, 40.0, 60.0, -50.0)
    exact = sum(scale * term for scale, term in zip(scales, terms, strict=False))
    missing = noise((31, 24), 1) > 0.9
    noisy, pure = (np.where(missing, np.nan, each) for each in (exact + 1e-7 * noise((31, 24)), exact))
    columns = np.stack([(term / np.abs(term).max())[~missing] for term in terms], axis=1)
    left = noisy[~missing] - columns @ np.linalg.lstsq(columns, noisy[~missing])[0]
    found = (noisy - fitted_form(noisy, CELL, form))[~missing]
    assert np.abs(found - left).max() < 1e-9 * np.abs(left).max()
    off = np.abs(fitted_form(pure, CELL, form) - exact)  # also in the holes
    assert off.max() < 1e-14 * np.abs(exact).max()


# missing points


@pytest.mark.parametrize(
    ("function", "cell", "hole"),
    [
        (lambda x, y: x * y, CELL, np.s_[5:15, 3:11]),
        (lambda x, y: x**3 - 3 * x * y**2, (1e-6, 1e-6), np.s_[5:15, 3:11]),  # the 4th derivatives vanish
        (lambda x, y: y + 0 * x, CELL, np.s_[:6, 3:11]),  # at the side x no flow through it
        (lambda x, y: x + 0 * y, CELL, np.s_[4:9, :]),  # from side to side
    ],
)
def test_a_hole_in_a_harmonic_function_is_filled_with_it(function, cell, hole):
    """The five-point equation is exact for these: 1e-12 is rounding."""
    exact = function(*places((20, 14), cell))
    values = exact.copy()
    values[hole] = np.nan
    values[17, 2] = np.nan
    assert np.abs(harmonic(values, cell) - exact).max() < 1e-12 * np.abs(exact).max()
    assert harmonic(exact, cell) is exact


def test_missing_points_are_refused_unless_asked_for_and_never_most_of_the_map():
    holes = [np.where(np.arange(120) < few, np.nan, 1.0).reshape(12, 10) for few in (60, 61, 120)]
    with pytest.raises(ValueError, match=r"60 of 120 heights are missing: fill them, or give surface.mi"):
        measured(holes[0])
    filled = processed(measured(holes[0], missing="harmonic"), (12, 10))
    assert np.allclose(filled, 1.0, rtol=1e-12)
    for values, words in zip(holes[1:], ("61 of 120", "120 of 120"), strict=True):
        with pytest.raises(
            ValueError, match=f"{words} heights are missing: at most 60 of them can be filled"
        ):
            measured(values, missing="harmonic")


# crop


@pytest.mark.parametrize(
    ("crop", "first", "cells"),
    [
        ((60e-6, 20e-6), (0, 0), (30, 20)),
        ((19.2e-6, 8.4e-6), (10, 6), (10, 8)),  # to whole cells
        ((-20e-6, 6e-6, 20e-6, 8e-6), (0, 12), (10, 8)),  # its middle there: touches both sides
        ((22e-6, 7e-6), (9, 6), (11, 7)),  # 9.5 and 6.5: the first of two cells as near
        ((1e-6, 0.5e-6, 22e-6, 7e-6), (10, 7), (11, 7)),
    ],
)
def test_a_crop_is_the_part_of_that_size_about_its_middle(crop, first, cells):
    values = noise((30, 20))
    cut = measured(values, crop=crop)
    part = values[first[0] : first[0] + cells[0], first[1] : first[1] + cells[1]]
    assert np.array_equal(processed(cut, cells), part)
    found, extent = patch_of(cut, None)
    assert found == cells and extent == pytest.approx((cells[0] * 2e-6, cells[1] * 1e-6), rel=1e-12)
    assert mean_deviation(cut, extent) == pytest.approx(np.abs(part - part.mean()).mean(), rel=1e-12)
    relief = Grid(border="relief")  # of the patch, not of the map
    cropped, alone = (RoughPatch.of(each, None, relief).heights() for each in (cut, measured(part)))
    assert np.array_equal(cropped, alone) and alone[0, 0] < part[0, 0]


# resampling


def cosine(n: int, k: int) -> np.ndarray:
    return np.cos(np.pi * k * (np.arange(n) + 0.5) / n)


def test_cosines_are_reproduced_on_any_cells_and_left_out_where_they_do_not_fit():
    """A few units of rounding of a sum of 100 terms: 1e-13."""
    for cells in ((64, 20), (96, 99), (25, 16), (41, 33)):
        found = resampled(np.outer(cosine(40, 7), cosine(33, 15)), cells)
        assert np.abs(found - np.outer(cosine(cells[0], 7), cosine(cells[1], 15))).max() < 1e-13
    assert np.abs(resampled(np.outer(cosine(40, 30), cosine(33, 2)), (25, 33))).max() < 1e-13


def test_the_grid_of_a_scene_may_differ_only_if_it_is_resampled(tmp_path):
    x, y = centres(12, 1e-6), centres(10, 1e-6)
    content = npz({"x_m": x, "y_m": y, "height_m": 1e-7 * np.cos(3e5 * x[:, None]) + 0 * y})
    grid = '[grid]\ncells = [24, 18]\nextent = ["12 um", "9 um"]\n'
    crop, resample = 'crop = ["12 um", "9 um"]\n', 'resample = "fourier"\n'
    scene = measured_scene(tmp_path, "h.npz", content, crop + resample, grid)
    assert patch_of(scene.surface, scene.grid) == ((24, 18), pytest.approx((12e-6, 9e-6), rel=1e-9))
    found = heights(scene.surface, np.zeros(24), np.zeros(18), (12e-6, 9e-6))
    expected = resampled(scene.surface.path.values[:, :9], (24, 18))  # 10 - 9 = 1: the first as near
    assert np.array_equal(found, expected)
    wider = grid.replace('"9 um"', '"10 um"')
    for keys, more, words in (
        (crop, grid, r"grid.cells = \[24, 18\]: \[12, 9\], the grid of surface.path after surface.crop: "),
        (crop + resample, wider, r"grid.extent = .*: 1.2e-05 m and 9e-06 m, the grid of surface.path after"),
    ):
        with pytest.raises(SceneError, match=words):
            measured_scene(tmp_path, "h.npz", content, keys, more)
    with pytest.raises(ValueError, match="no heights at 24 x 18 points"):
        processed(measured(noise((12, 10))), (24, 18))


def test_roughness_of_measured_points_only():
    """Of a plane wave on half of a map the other half of which is missing: as of that half alone."""
    half = noise((15, 20))
    whole = np.concatenate([half, np.full((15, 20), np.nan)])
    found, wanted = roughness_as_read(measured(whole, missing="harmonic")), roughness(half, *CELL)
    assert (found.sa, found.sq, found.ssk) == pytest.approx((wanted.sa, wanted.sq, wanted.ssk), rel=1e-12)
    slope_x, slope_y = np.gradient(half, *CELL)  # in the last row along x its neighbour is missing
    assert found.sdq == pytest.approx(np.sqrt(np.mean((slope_x**2 + slope_y**2)[:-1])), rel=1e-12)


def test_the_pin_is_what_its_recipe_makes():
    """Data to ten digits. Ra counts what is between the cells too: some 1e-4."""
    file = load_scene("verification/scenes/pin.toml").surface.measured
    recipe = load_scene("verification/scenes/pin-recipe.toml")
    made = on_grid(recipe.surface, 64)
    assert file.cells == (64, 64) and file.extent == pytest.approx(PATCH, rel=1e-9)
    assert np.abs(file.values - made).max() < 1e-9 * np.abs(made).max()
    assert roughness_as_read(Surface(kind="file", path=file)).sa == pytest.approx(0.27e-6, rel=2e-3)
    other = recipe.surface.model_copy(update={"seed": 3})
    assert np.abs(on_grid(other, 64) - file.values).max() > 0.1e-6
