# SPDX-License-Identifier: MIT
"""Measured surfaces: form, holes, crop and resampling against closed forms and general solvers; the shipped
pin.
"""

import numpy as np
import pytest
from builders import measured_scene as rough

from sam.grid.rough import RoughPatch
from sam.scene import Grid, HeightMap, Scene, SceneError, Surface, load_scene, resolved
from sam.scene.surface import heights, mean_deviation, patch_of, processed, roughness, roughness_as_read
from sam.scene.surface.measured import fitted_form, harmonic, resampled
from sam.scene.surface.readers import read_named
from verification.robustness.fuzz import npz
from verification.runs.store import identity
from verification.scenes.pin import DATA, RECIPE, pin_heights, pin_table

CELL = (2e-6, 1e-6)


def surface(values: np.ndarray, cell=CELL, **keys) -> Surface:
    extent = tuple(n * h for n, h in zip(values.shape, cell, strict=True))
    return Surface(kind="file", path=HeightMap(values, extent), **keys)


def centres(n: int, h: float) -> np.ndarray:
    return (np.arange(n) - (n - 1) / 2) * h


def places(shape, cell=CELL):
    return np.meshgrid(*(centres(n, h) for n, h in zip(shape, cell, strict=True)), indexing="ij")


def waves(shape, seed=0):
    return np.random.default_rng(seed).normal(size=shape)


# --- form ---------------------------------------------------------------------------------------------------

POLYNOMIALS = {
    "tilt": lambda x, y: [1 + 0 * x, x, y],
    "sphere": lambda x, y: [1 + 0 * x, x, y, x**2 + y**2],
    "quadratic": lambda x, y: [1 + 0 * x, x, y, x**2, x * y, y**2],
}


@pytest.mark.parametrize("form", POLYNOMIALS)
def test_the_form_is_that_of_a_general_least_squares_solver(form):
    """On measured points only. 1e-9: the general solver works with metres, badly scaled; its own residual is
    that small.

    1e-14: as the form is fitted again to what is left, only the twenty roundings of its last evaluation stay.
    """
    x, y = places((31, 24))
    terms = POLYNOMIALS[form](x, y)
    scales = (1e-3, 0.02, -0.03, 40.0, 60.0, -50.0)
    exact = sum(scale * term for scale, term in zip(scales, terms, strict=False))
    noisy = exact + 1e-7 * waves((31, 24))
    missing = waves((31, 24), 1) > 0.9
    noisy[missing] = exact_with_holes = np.nan
    found = fitted_form(noisy, CELL, form)
    columns = np.stack([(term / np.abs(term).max())[~missing] for term in terms], axis=1)
    left = noisy[~missing] - columns @ np.linalg.lstsq(columns, noisy[~missing])[0]
    assert (
        np.isnan(exact_with_holes)
        and np.abs((noisy - found)[~missing] - left).max() < 1e-9 * np.abs(left).max()
    )
    pure = np.where(missing, np.nan, exact)
    assert (
        np.nanmax(np.abs(fitted_form(pure, CELL, form) - exact)) < 1e-14 * np.abs(exact).max()
    )  # also in the holes


def test_a_form_is_found_on_the_whole_map_before_it_is_cropped():
    values = 1e-7 * waves((30, 20)) + 0.01 * places((30, 20))[0]
    keys = {"form": "tilt", "crop": (20e-6, 8e-6)}
    whole = processed(surface(values, form="tilt"), (30, 20))
    part = processed(surface(values, **keys), (10, 8))
    assert np.array_equal(part, whole[10:20, 6:14])
    later = values[10:20, 6:14] - fitted_form(values[10:20, 6:14], CELL, "tilt")
    assert np.abs(part - later).max() > 0.1 * np.abs(part).max()
    assert np.array_equal(processed(surface(values), (30, 20)), values)  # nothing asked for, nothing done


# --- missing points -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("function", "cell", "hole"),
    [
        (lambda x, y: x * y, CELL, np.s_[5:15, 3:11]),
        (lambda x, y: x**2 - y**2, (1e-6, 1e-6), np.s_[5:15, 3:11]),
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


def test_missing_points_are_refused_unless_asked_for_and_never_most_of_the_map():
    values = np.where(waves((12, 10)) > 1.5, np.nan, 1.0)
    with pytest.raises(
        ValueError,
        match=rf"{np.isnan(values).sum()} of 120 heights are missing: fill them, or give surface.mi",
    ):
        surface(values)
    assert not np.isnan(processed(surface(values, missing="harmonic"), (12, 10))).any()
    for few in (60, 61):
        holes = np.where(np.arange(120) < few, np.nan, 1.0).reshape(12, 10)
        if few == 60:
            assert np.allclose(processed(surface(holes, missing="harmonic"), (12, 10)), 1.0, rtol=1e-12)
        else:
            with pytest.raises(
                ValueError, match="61 of 120 heights are missing: at most 60 of them can be filled"
            ):
                surface(holes, missing="harmonic")
    with pytest.raises(ValueError, match="120 of 120 heights are missing: at most 60"):
        surface(np.full((12, 10), np.nan), missing="harmonic")


# --- crop ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("crop", "first", "cells"),
    [
        ((20e-6, 8e-6), (10, 6), (10, 8)),
        ((60e-6, 20e-6), (0, 0), (30, 20)),
        ((19.2e-6, 8.4e-6), (10, 6), (10, 8)),  # to whole cells
        ((-20e-6, 6e-6, 20e-6, 8e-6), (0, 12), (10, 8)),  # its middle there: touches both sides
        ((22e-6, 7e-6), (9, 6), (11, 7)),  # 9.5 and 6.5: the first of two cells as near
        ((1e-6, 0.5e-6, 22e-6, 7e-6), (10, 7), (11, 7)),
    ],
)
def test_a_crop_is_the_part_of_that_size_about_its_middle(crop, first, cells):
    values = waves((30, 20))
    cut = surface(values, crop=crop)
    part = values[first[0] : first[0] + cells[0], first[1] : first[1] + cells[1]]
    assert np.array_equal(processed(cut, cells), part)
    found, extent = patch_of(cut, None)
    assert found == cells and extent == pytest.approx((cells[0] * 2e-6, cells[1] * 1e-6), rel=1e-12)
    assert mean_deviation(cut, extent) == pytest.approx(np.abs(part - part.mean()).mean(), rel=1e-12)
    relief, own = Grid(border="relief"), surface(part)
    cropped, alone = (RoughPatch.of(each, None, relief).heights() for each in (cut, own))
    assert (
        np.array_equal(cropped, alone) and alone[0, 0] < part[0, 0]
    )  # the border of the patch, not of the map


@pytest.mark.parametrize(
    ("crop", "message"),
    [
        ((61e-6, 8e-6), "sides above 0, at most those of the map, 6e-05 m x 2e-05 m"),
        ((-20e-6, 8e-6), "sides above 0"),
        ((0.0, 8e-6), "sides above 0"),
        ((22e-6, 0.0, 20e-6, 8e-6), "from the middle of the map, inside of it"),
        ((0.0, -7e-6, 20e-6, 8e-6), "inside of it"),
        ((4e-6, 8e-6), "at least 3 cells each way, of 2e-06 m x 1e-06 m"),
        ((1e-6,), r"\[lx, ly\], or \[x, y, lx, ly\]"),
        ((1e-6, 2e-6, 3e-6), r"\[lx, ly\], or \[x, y, lx, ly\]"),
        ("all", r"\[lx, ly\], or \[x, y, lx, ly\]"),
    ],
)
def test_a_crop_outside_of_the_map_is_refused(crop, message):
    with pytest.raises(ValueError, match=message):
        surface(waves((30, 20)), crop=crop)


# --- resampling ---------------------------------------------------------------------------------------------


def cosine(n: int, k: int) -> np.ndarray:
    return np.cos(np.pi * k * (np.arange(n) + 0.5) / n)


def test_cosines_are_reproduced_on_any_cells_and_left_out_where_they_do_not_fit():
    """A few units of rounding of a sum of 100 terms: 1e-13."""
    for cells in ((64, 20), (96, 99), (25, 16), (41, 33)):
        found = resampled(np.outer(cosine(40, 7), cosine(33, 15)), cells)
        assert np.abs(found - np.outer(cosine(cells[0], 7), cosine(cells[1], 15))).max() < 1e-13
    assert np.abs(resampled(np.outer(cosine(40, 30), cosine(33, 2)), (25, 33))).max() < 1e-13
    assert np.abs(resampled(np.ones((40, 33)), (7, 200)) - 1).max() < 1e-13


def test_to_finer_cells_and_back_is_the_same_surface():
    """Also of heights that use every wave; and to coarser cells and back if the surface is band-limited."""
    h = waves((40, 33))
    assert np.abs(resampled(resampled(h, (101, 77)), (40, 33)) - h).max() < 1e-12
    smooth = resampled(waves((20, 15)), (40, 33))
    assert np.abs(resampled(resampled(smooth, (25, 16)), (40, 33)) - smooth).max() < 1e-12
    assert np.abs(resampled(resampled(h, (25, 16)), (40, 33)) - h).max() > 0.1


def test_the_grid_of_a_scene_may_differ_only_if_it_is_resampled(tmp_path):
    x, y = centres(12, 1e-6), centres(10, 1e-6)
    content = npz({"x_m": x, "y_m": y, "height_m": 1e-7 * np.cos(3e5 * x[:, None]) + 0 * y})
    grid = '[grid]\ncells = [24, 18]\nextent = ["12 um", "9 um"]\n'
    crop = 'crop = ["12 um", "9 um"]\n'
    with pytest.raises(
        SceneError, match=r"grid.cells = \[24, 18\]: \[12, 9\], the grid of surface.path after surface.crop: "
    ):
        rough(tmp_path, "h.npz", content, crop, grid)
    scene = rough(tmp_path, "h.npz", content, crop + 'resample = "fourier"\n', grid)
    assert patch_of(scene.surface, scene.grid) == ((24, 18), pytest.approx((12e-6, 9e-6), rel=1e-9))
    found = heights(scene.surface, np.zeros(24), np.zeros(18), (12e-6, 9e-6))
    assert np.array_equal(
        found, resampled(scene.surface.path.values[:, :9], (24, 18))
    )  # 10 - 9 = 1: the first as near
    with pytest.raises(
        SceneError, match=r"grid.extent = .*: 1.2e-05 m and 9e-06 m, the grid of surface.path after"
    ):
        rough(tmp_path, "h.npz", content, crop + 'resample = "fourier"\n', grid.replace('"9 um"', '"10 um"'))
    with pytest.raises(ValueError, match="no heights at 24 x 18 points"):
        processed(surface(waves((12, 10))), (24, 18))


# --- as a whole ---------------------------------------------------------------------------------------------

KEYS = (
    'form = "sphere"\nmissing = "harmonic"\ncrop = ["1 um", "0 um", "16 um", "12 um"]\nresample = "fourier"\n'
)


def measured(folder, keys: str = KEYS) -> Scene:
    """20 x 16 um of a rough cap with a hole and single points missing, part of it on finer cells."""
    x, y = places((20, 16), (1e-6, 1e-6))
    values = 2e-8 * resampled(waves((8, 6)), (20, 16)) - (x**2 + y**2) / 2e-3 + 0.01 * y + 3e-6
    values[4:7, 9:12] = values[15, 3] = np.nan
    content = npz({"x_m": x[:, 0], "y_m": y[0], "height_m": values})
    return rough(
        folder,
        "h.npz",
        content,
        keys,
        '[grid]\ncells = [32, 24]\nborder = "relief"\ndepths = ["0 um", "1 um"]\n',
    )


def test_what_is_done_to_a_file_is_part_of_the_scene(tmp_path):
    scene = measured(tmp_path)
    read = Scene(**resolved(scene))
    assert (
        read == scene
        and identity(read, "sam") == identity(scene, "sam")
        and read.surface.crop == scene.surface.crop
    )
    assert resolved(scene)["surface"]["form"] == "sphere"
    for old, new in (("sphere", "tilt"), ("1 um", "0 um"), ('form = "sphere"\n', "")):
        other = measured(tmp_path, KEYS.replace(old, new, 1))
        assert other != scene and identity(other, "sam") != identity(scene, "sam")
        assert not np.array_equal(processed(other.surface, (32, 24)), processed(scene.surface, (32, 24)))
    for call in (roughness_as_read, lambda found: processed(found, (32, 24))):
        with pytest.raises(ValueError, match="only its digest is at hand"):
            call(read.surface)
    with pytest.raises(
        ValueError, match=r'kind = "sinusoid" takes amplitude, wavelength_x, wavelength_y: remove it'
    ):
        Surface(kind="sinusoid", amplitude=1e-6, wavelength_x=1e-5, form="sphere")


def test_roughness_of_measured_points_only():
    """Of a plane wave on half of a map the other half of which is missing: as of that half alone."""
    half = waves((15, 20))
    whole = np.concatenate([half, np.full((15, 20), np.nan)])
    found, wanted = roughness_as_read(surface(whole, missing="harmonic")), roughness(half, *CELL)
    assert (found.sa, found.sq, found.ssk) == pytest.approx((wanted.sa, wanted.sq, wanted.ssk), rel=1e-12)
    slope_x, slope_y = np.gradient(
        half, *CELL
    )  # in the last row along x there is no slope: its neighbour is missing
    assert found.sdq == pytest.approx(np.sqrt(np.mean((slope_x**2 + slope_y**2)[:-1])), rel=1e-12)


# --- the shipped pin ----------------------------------------------------------------------------------------


def test_the_pin_is_what_its_recipe_makes():
    """Data to ten digits. Ra is that of the surface between the cells as well: sampling 64 x 64 changes it by
    some 1e-4.
    """
    file = read_named("pin.csv", DATA.read_bytes())
    _, _, made = pin_heights()
    assert file.cells == (64, 64) and file.extent == pytest.approx((64e-6, 64e-6), rel=1e-9)
    assert np.abs(file.values - made).max() < 1e-9 * np.abs(made).max()
    assert pin_table().count("\n") == 1 + 64 * 64 and DATA.stat().st_size < 300_000
    assert roughness_as_read(Surface(kind="file", path=file)).sa == pytest.approx(0.27e-6, rel=2e-3)
    other = load_scene(RECIPE).surface.model_copy(update={"seed": 3})
    assert np.abs(heights(other, *(centres(64, 1e-6),) * 2, (64e-6, 64e-6)) - file.values).max() > 0.1e-6
