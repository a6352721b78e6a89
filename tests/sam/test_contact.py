# SPDX-License-Identifier: MIT
"""The contact solver against Hertz, and its certificates against fields computed anew."""

import numpy as np
import pytest

from sam.contact.convolution import Convolution
from sam.contact.normal import Search, around, no_contact, solve_contact
from sam.grid.cells import CellGrid, Window
from sam.kernels.patches import Lags, displacement_coefficients
from sam.results.history import contact_area
from verification.reference.elliptic import EllipticContact

P0 = 2 / np.pi  # Hertz with a = R = E* = 1: F = 4/3, approach 1


def sphere(n, extent=4.0, force=4 / 3, **options):
    h = extent / n
    x = (np.arange(n) - (n - 1) / 2) * h
    gap0 = (x[:, None] ** 2 + x[None, :] ** 2) / 2
    return solve_contact(gap0, (h, h), 1.0, force, search=Search(**options)), gap0, h


def area_of(contact, hx=1.0, hy=1.0):
    return contact_area(contact, CellGrid(*contact.pressure.shape, hx, hy, np.zeros(1)))


@pytest.mark.parametrize("cells, limit", [(8, 5e-3), (16, 2e-3), (32, 1e-3)])
@pytest.mark.parametrize("ratio, slender", [(1.0, 1.0), (1.0, 0.5), (4.0, 1.0), (4.0, 2.0)])
def test_area_within_the_outline(cells, limit, ratio, slender):
    """A sphere and an ellipsoid, their apex anywhere in a cell of the shape of the contact or more slender.

    Measured: 0.33, 0.11 and 0.03 % at most. The number of the cells, less a share for each face that is out
    of contact, was 2.5, 1.3 and 0.44 % off.
    """
    exact, draw = EllipticContact(1.0, 1.0, ratio, 1.0), np.random.default_rng(1)
    a, b = exact.semi_axes
    hx, hy = a / cells * slender**0.5, b / cells / slender**0.5
    for _ in range(4):
        (x, y) = (
            (np.arange(-n, n + 1) + draw.random()) * h
            for n, h in ((int(1.4 * a / hx), hx), (int(1.4 * b / hy), hy))
        )
        contact = solve_contact(x[:, None] ** 2 / 2 + y**2 / (2 * ratio), (hx, hy), 1.0, 1.0)
        assert area_of(contact, hx, hy) == pytest.approx(np.pi * a * b, rel=limit)


def test_area_below_a_punch_and_up_to_the_edge_of_the_grid_is_that_of_the_cells():
    punch = np.where(np.random.default_rng(2).random((9, 7)) < 0.7, 0.0, np.inf)
    for gap0 in (punch, np.zeros((5, 8))):
        contact = solve_contact(gap0, (1.0, 2.0), 1.0, 1.0)
        assert area_of(contact, 1.0, 2.0) == pytest.approx(2.0 * (contact.pressure > 0).sum(), rel=1e-14)


def test_the_certificate_describes_the_returned_field():
    """Gap, penetration and load recomputed from the pressure alone, by a direct sum over all cells."""
    contact, gap0, h = sphere(25)
    coefficients = h * 2 * displacement_coefficients(Lags(25, 25, 1.0, 1.0), nu=0.0)  # E* = 1
    i = np.arange(25)
    lag = np.abs(i[:, None] - i[None, :])
    u = np.einsum("ikjm,km->ij", coefficients[lag[:, :, None, None], lag[None, None, :, :]], contact.pressure)
    gap = gap0 + u - contact.approach
    in_contact = contact.pressure > 0
    scale = coefficients[0, 0] * contact.pressure.max()
    assert np.abs(gap[in_contact]).max() < 1e-9 * scale and gap[~in_contact].min() > -1e-9 * scale
    assert np.allclose(gap, contact.gap, rtol=0, atol=1e-12)
    assert np.allclose(u, contact.displacement, rtol=0, atol=1e-12)
    assert contact.pressure.sum() * h * h == pytest.approx(4 / 3, rel=1e-12)


def test_the_box_does_not_change_the_answer():
    """A start on the wrong cells makes a box that is too small; the check on the full grid lets it grow."""
    right, gap0, _ = sphere(65)
    start = np.zeros_like(gap0)
    start[10:13, 50:53] = 1.0
    other, _, _ = sphere(65, start=start)
    assert other.converged and np.abs(other.pressure - right.pressure).max() < 1e-8 * P0
    assert right.box.nx < 65  # and the box did leave cells out


def test_rough_surface_passes_its_checks():
    """Random heights, three loads from few spots to full contact; area grows with load."""
    rng = np.random.default_rng(5)
    n = 96
    k = np.hypot(np.fft.fftfreq(n)[:, None], np.fft.rfftfreq(n)[None, :])
    spectrum = np.where((k > 3 / n) & (k < 0.2), 1.0 / np.maximum(k, 1e-9) ** 1.8, 0.0)
    heights = np.fft.irfft2(spectrum * np.fft.rfft2(rng.standard_normal((n, n))), s=(n, n))
    gap0 = -heights / heights.std()
    areas = []
    for force in (1.0, 100.0, 1e6):
        contact = solve_contact(gap0, (1.0, 1.3), 1.0, force)
        assert contact.converged and contact.tension == 0.0 and contact.load_error < 1e-12
        areas.append((contact.pressure > 0).mean())
    assert areas[0] < areas[1] < areas[2] == 1.0


def test_bad_arguments_are_refused_by_name():
    plane = np.zeros((8, 8))
    for name, args in {
        "hx": (plane, (0.0, 1.0), 1.0, 1.0),
        "hy": (plane, (1.0, -1.0), 1.0, 1.0),
        "modulus": (plane, (1.0, 1.0), np.nan, 1.0),
        "force": (plane, (1.0, 1.0), 1.0, np.inf),
        "gap0": (np.full((8, 8), np.nan), (1.0, 1.0), 1.0, 1.0),
    }.items():
        with pytest.raises(ValueError, match=name):
            solve_contact(*args)
    with pytest.raises(ValueError, match="gap0"):
        solve_contact(np.full((8, 8), np.inf), (1.0, 1.0), 1.0, 1.0)


def test_out_of_iterations_is_not_converged():
    contact, _, _ = sphere(129, max_iterations=2)
    assert not contact.converged and contact.residual > 1e-10


def test_no_force_no_contact():
    contact = no_contact(np.array([[2.0, 1.0], [3.0, 1.5]]))
    assert contact.approach == 1.0 and contact.pressure.sum() == 0.0 and contact.gap.min() == 0.0


def test_boxaround_cells_stays_on_the_grid():
    cells = np.zeros((20, 30), dtype=bool)
    cells[0, 29] = True
    assert around(cells) == Window(0, 26, 4, 4)
    assert Convolution.lags_needed(Window(0, 0, 3, 3), Window(0, 0, 20, 30)) == (20, 30)


def test_a_tolerance_below_rounding_is_not_converged_and_ends():
    """No division by a vanished residual, no endless loop: the best that double precision gives, honestly
    named.
    """
    contact, _, _ = sphere(65, tolerance=1e-18)
    assert not contact.converged and contact.residual < 1e-12 and contact.iterations < 400
    assert contact.pressure.max() == pytest.approx(P0, rel=5e-4)
