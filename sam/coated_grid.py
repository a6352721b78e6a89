# SPDX-License-Identifier: MIT
"""Cells and output depths of a coated scene: how wide its contact is, and depths in the film and below it."""

from __future__ import annotations

from math import sqrt

import numpy as np

from sam.coated_radius import contact_radius
from sam.coating import Film
from sam.grid import contact_modulus
from sam.scene import Scene

LEVELS = 8  # output depths in the film at least, of equal distance
FILM_SIDE = 1 - 1e-6  # thicknesses: the deepest of them, the film's side of the interface
# times the deepest of the other depths (two contact radii): a thicker film is all that is looked at
REACH = 5.0
BELOW = (1.05, 1.1, 1.2, 1.35, 1.5)  # thicknesses: output depths below a film where the other depths end
CLOSE = 0.25  # of the distance of the other depths: none of them is closer to the interface
# the contact of the bare body fits into a default grid up to 1.6 x 3 contact radii
BARE_ROOM, MOST_ROOM = 1.6, 3.0


def contact_scale(scene: Scene) -> float:
    """Estimated contact radius over that of the bare body; 1 where the radius is given (punch, given pressure).

    An ellipse is scaled like the circle under a sphere with the geometric mean of its radii.
    """
    other = scene.counterbody
    if other is None or other.shape == "punch":
        return 1.0
    film, force, radius = Film(scene), scene.loading.force, sqrt(other.radii[0] * other.radii[1])
    coating = scene.body.coating
    of_film = 1 / ((1 - coating.poisson**2) / coating.young + film.compliance)
    bare = tuple(
        (3 * force * radius / (4 * modulus)) ** (1 / 3) for modulus in (contact_modulus(scene), of_film)
    )
    return contact_radius(film.response, force, radius, bare) / bare[0]


def room_for_bare(scale: float) -> float:
    """By how much a default grid is wider than for the coated contact alone, so that it holds the bare one to compare with."""
    return float(np.clip(1 / (BARE_ROOM * scale), 1.0, MOST_ROOM))


def depths_with_film(depths: np.ndarray, thickness: float) -> np.ndarray:
    """Output depths of a bare body, ascending from 0, made those of a coated one.

    In the film the given ones, at least LEVELS, and the film's side of the interface; then the interface, where values are
    those of the body below; then the given ones that are deeper, and some below a film that reaches as deep as they do. No
    interface and nothing below it where that is out of REACH.
    """
    deepest, spacing = depths[-1], depths[1] - depths[0]
    inside = depths[depths < thickness - CLOSE * spacing]
    if thickness > REACH * deepest:
        return inside
    if len(inside) < LEVELS:
        inside = thickness * np.arange(LEVELS - 1) / (LEVELS - 1)
    inside = np.append(inside, FILM_SIDE * thickness)
    below = depths[depths > thickness + CLOSE * spacing]
    deeper = [share * thickness for share in BELOW if share * thickness > deepest]
    return np.concatenate([inside, [thickness], below, deeper])
