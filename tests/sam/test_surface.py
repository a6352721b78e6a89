# SPDX-License-Identifier: MIT
"""Rough surfaces: their table in a scene, generators against spectra and closed forms, readers against files
that lie.
"""

import re

import numpy as np
import pytest

import fem_reference
from sam.scene import Scene, Surface, parse_scene
from sam.scene.surface import BORDER, border_cells, heights, mean_deviation, roughness, with_relief
from verification.robustness.hostile import WAVES

SIDE = 64e-6
PATCH = (SIDE, SIDE)
SELF_AFFINE = {
    "kind": "self-affine",
    "ra": 0.27e-6,
    "cutoff_long": 32e-6,
    "cutoff_short": 4e-6,
    "hurst": 0.8,
    "seed": 3,
}
TURNED = SELF_AFFINE | {"kind": "hard-turned", "feed": 20e-6, "nose_radius": 0.8e-3, "feed_share": 0.4}


def centres(n: int, side: float = SIDE) -> np.ndarray:
    return ((np.arange(n) + 0.5) / n - 0.5) * side


def on_grid(surface: Surface, n: int, patch=PATCH) -> np.ndarray:
    return heights(surface, centres(n, patch[0]), centres(n, patch[1]), patch)


# --- generators ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "keys", [SELF_AFFINE, SELF_AFFINE | {"anisotropy": 1.5}, TURNED, TURNED | {"feed": 82e-6}]
)
def test_a_finer_grid_has_the_same_surface(keys):
    """Every third cell centre of the finer grid is one of the coarser: 1e-13 of Ra is rounding."""
    surface = Surface(**keys)
    coarse, fine = on_grid(surface, 48), on_grid(surface, 144)
    assert np.abs(fine[1::3, 1::3] - coarse).max() < 1e-12 * surface.ra
    assert np.abs(on_grid(Surface(**keys | {"seed": 4}), 48) - coarse).max() > surface.ra


@pytest.mark.parametrize(
    "keys", [SELF_AFFINE, TURNED, TURNED | {"feed_share": 0.0}, TURNED | {"feed_share": 1.0}]
)
def test_ra_is_that_of_the_surface_on_any_grid(keys):
    """The mean of |h| has kinks where h = 0, so that its sum over cells converges fast but not at once: 0.3 %
    at 150 cells.
    """
    surface = Surface(**keys)
    for n in (150, 400):
        h = on_grid(surface, n)
        assert roughness(h, 1, 1).sa == pytest.approx(0.27e-6, rel=3e-3)
        assert abs(h.mean()) < 1e-3 * surface.ra
    assert mean_deviation(surface, PATCH) == pytest.approx(0.27e-6, rel=1e-12)


def test_sq_instead_of_ra():
    """By Parseval's theorem exact on every grid that holds all waves."""
    surface = Surface(**{key: value for key, value in SELF_AFFINE.items() if key != "ra"}, sq=0.5e-6)
    assert roughness(on_grid(surface, 40), 1, 1).sq == pytest.approx(0.5e-6, rel=1e-12)


@pytest.mark.parametrize("anisotropy", [1.0, 1.5, 0.6])
def test_spectrum_is_flat_then_falls_with_the_hurst_exponent_then_ends(anisotropy):
    surface = Surface(**SELF_AFFINE, anisotropy=anisotropy)
    n = 96
    power = np.abs(np.fft.fft2(on_grid(surface, n))) ** 2
    m = np.fft.fftfreq(n, 1 / n)
    q = np.hypot(m[:, None], anisotropy * m[None, :])  # periods in the side
    inside = (q > 0) & (q <= 16 * (1 + 1e-9))
    flat, falling = inside & (q <= 2), inside & (q > 2)
    level = power[flat].mean()
    assert np.allclose(power[flat], level, rtol=1e-9, atol=0)
    assert np.allclose(power[falling], level * (q[falling] / 2) ** -3.6, rtol=1e-9, atol=0)
    assert power[~inside].max() < 1e-24 * level


def test_feed_marks_are_arcs_of_the_nose_with_cusps_up():
    """Of full share the scaled arcs: in the valley, x^2/(2 r) but for the waves left out; Ra by the mean of
    |t^2 - mean|.

    Ideal Ra: integral of |t^2 - f^2/12|/(2 r) over a period = f^2/(18 sqrt(3) r) = 0.0321 f^2/r.
    """
    feed, radius = 16e-6, 0.8e-3
    ideal = feed**2 / (18 * np.sqrt(3) * radius)
    assert ideal == pytest.approx(0.0321 * feed**2 / radius, rel=1e-3)
    keys = TURNED | {
        "feed": feed,
        "nose_radius": radius,
        "feed_share": 1.0,
        "cutoff_short": 0.05e-6,
        "ra": ideal,
    }
    x = np.linspace(-feed / 2, 1.5 * feed, 401)
    h = heights(Surface(**keys), x, np.zeros(1), PATCH)[:, 0]
    t = np.mod(x, feed) - feed / 2  # cusps at 0 and feed
    exact = (t**2 - feed**2 / 12) / (2 * radius)
    assert (
        np.abs(h - exact).max() < 0.02 * exact.max()
    )  # the rounded cusp: 320 waves, 1/320 of the first is missing
    assert x[h.argmax()] == pytest.approx(0.0, abs=0.01 * feed) or x[h.argmax()] == pytest.approx(
        feed, abs=0.01 * feed
    )
    assert np.allclose(heights(Surface(**keys), x, centres(5), PATCH), h[:, None])  # along y nothing changes


@pytest.mark.parametrize(("share", "radius"), [(0.4, 0.8e-3), (0.1, 0.8e-3), (0.4, 0.5e-3)])
def test_a_turned_surface_is_marks_and_a_self_affine_part_by_the_roots_of_the_share(share, radius):
    """Least squares on both parts leaves nothing; marks: t^2/(2 r), feed 16 um, down to 4 um: four waves of
    known height.
    """
    feed, x = 16e-6, centres(48)
    keys = TURNED | {"feed": feed, "nose_radius": radius, "feed_share": share}
    h = heights(Surface(**keys), x, x, PATCH)
    marks = sum(
        (feed / (np.pi * k)) ** 2 / (2 * radius) * np.cos(2 * np.pi * k * x / feed) for k in range(1, 5)
    )
    parts = np.stack([(marks[:, None] + 0 * h).ravel(), on_grid(Surface(**SELF_AFFINE), 48).ravel()])
    (of_marks, of_rest), left, *_ = np.linalg.lstsq(parts.T, h.ravel())
    assert left[0] < 1e-20 * (h**2).sum()
    assert of_marks / of_rest == pytest.approx(np.sqrt(share / (1 - share)), rel=1e-9)


def test_sinusoid_and_its_roughness():
    """Sa = 2 A/pi, Sq = A/sqrt 2, slope A q/sqrt 2; the product of two waves has (2/pi)^2 A and A/2."""
    amplitude, n = 1e-7, 512
    wave = roughness(
        on_grid(Surface(kind="sinusoid", amplitude=amplitude, wavelength_x=16e-6), n), SIDE / n, SIDE / n
    )
    assert wave.sa == pytest.approx(2 / np.pi * amplitude, rel=1e-3)
    assert wave.sq == pytest.approx(amplitude / np.sqrt(2), rel=1e-9)
    assert wave.sdq == pytest.approx(2 * np.pi * amplitude / 16e-6 / np.sqrt(2), rel=1e-3)
    assert abs(wave.ssk) < 1e-9
    both = Surface(kind="sinusoid", amplitude=amplitude, wavelength_x=16e-6, wavelength_y=8e-6)
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


# --- the table in a scene -----------------------------------------------------------------------------------


def waves(*changes: tuple[str, str]) -> Scene:
    text = WAVES
    for pattern, replacement in changes:
        text, count = re.subn(pattern, replacement, text, flags=re.MULTILINE)
        assert count == 1, pattern
    return parse_scene(text.encode(), "s")


def test_a_model_that_has_no_rough_bodies_says_so():
    scene = waves(('"flat"', '"sphere"\nradius = "1 mm"'))
    with pytest.raises(
        fem_reference.UnsupportedScene, match=r'surface.kind = "hard-turned": .* a smooth body'
    ):
        fem_reference.check(scene)
