# SPDX-License-Identifier: MIT
"""The coating of a scene in the units of the model, and estimates of its contact: they set meshes, never a result."""

from __future__ import annotations

import numpy as np

from fem_reference.axisymmetric import mesh as meshes
from fem_reference.common.elasticity import Film
from fem_reference.common.hertz import Scales, largest_mises, relative_moduli, scales
from sam.scene.remedies import either, less_friction, less_load
from sam.scene.result import Status
from sam.scene.schema import Scene

DECAY = 1.7
"""Share of the film in the compliance of a contact of radius a: 1 - exp(-DECAY h/a), within 0.07 for moduli 0.4 to 2."""

FLOWED = 1.0
"""Accumulated plastic strain of a film beyond which a small-strain solution means nothing."""


def film_of(scene: Scene, units: Scales) -> Film | None:
    """The coating in the units of the model."""
    coating = scene.body.coating
    if coating is None:
        return None
    return Film(coating.thickness / units.length, coating.young / units.modulus, coating.poisson)


def expected_radius(scene: Scene) -> float:
    """Estimate of the contact radius of a smooth elastic contact with the film over that without it (Hertz).

    a^3 is as the compliance, that of the film's material in the share 1 - exp(-DECAY h/a) and of the body's in the rest;
    by bisection between the radii on either material alone. 1 without a film, for a punch and a given pressure.
    """
    units = scales(scene)
    film = film_of(scene, units)
    smooth = scene.counterbody is not None and scene.counterbody.shape != "punch"
    if film is None or not smooth or units.peak_force == 0.0:
        return 1.0
    body = (1.0 - scene.body.poisson**2) / relative_moduli(scene)[0]
    other = (1.0 - film.poisson**2) / film.young - body  # compliances over 1/E* of the bare contact
    low, high = sorted((1.0, float(np.cbrt(1.0 + other))))
    for _ in range(50):
        middle = 0.5 * (low + high)
        share = -np.expm1(-DECAY * film.thickness / middle)
        low, high = (middle, high) if 1.0 + other * share > middle**3 else (low, middle)
    return high


def yielded_radius(scene: Scene) -> float:
    """Estimate of the contact radius over Hertz's when the film flows: mean pressure 3 Y in its share of the contact."""
    coating, units = scene.body.coating, scales(scene)
    if (
        coating is None
        or coating.yield_stress is None
        or scene.counterbody is None
        or units.peak_force == 0.0
    ):
        return 1.0
    peak = 1.5 * units.peak_force / np.pi * units.pressure
    if largest_mises(coating.poisson) * peak <= coating.yield_stress:
        return 1.0
    flowing = max(1.0, float(np.sqrt(2.0 / 9.0 * peak / coating.yield_stress)))
    return 1.0 - (flowing - 1.0) * float(np.expm1(-DECAY * coating.thickness / units.length))


def coated_core(scene: Scene, plastic: float | None) -> meshes.Core:
    """The well resolved part of the mesh: that of the larger contact, with and without the film.

    plastic: estimate of the radius when the body yields, None if it does not.
    """
    flows = scene.body.coating.yield_stress is not None
    reach = max(1.0, expected_radius(scene), plastic or 1.0, yielded_radius(scene))
    if flows or plastic is not None:
        return meshes.plastic_core(reach)
    return meshes.Core(meshes.ELASTIC.radius * reach, meshes.ELASTIC.depth * reach)


def coated_lines(scene: Scene, core: meshes.Core, punch: bool) -> tuple[np.ndarray, np.ndarray]:
    """(r, z) mesh lines: as for the body alone, sized by the smaller contact near it and by the larger one beyond.

    The interface is a line; the film has two elements or more through its thickness.
    """
    film, cells, box = film_of(scene, scales(scene)), scene.fem.cells_per_radius, scene.fem.box
    if punch:
        r, z = meshes.punch_lines(cells, box)
        return r, meshes.film_depths(film.thickness, box, meshes.Sizes(z[1], np.inf, (0.0, 0.0)))
    small, large = min(1.0, expected_radius(scene)), core.radius / meshes.ELASTIC.radius
    fine = small / cells
    coarse = fine if large < 2.0 * small else large / cells
    near = small if large >= 2.0 * small else large
    radial, axial = (
        meshes.Sizes(fine, coarse, (near * edge / large, edge)) for edge in (core.radius, core.depth)
    )
    uniform = fine * np.arange(int(np.ceil(round(radial.limits[0] / fine, 9))) + 1)
    r = np.concatenate([uniform, meshes.marched(uniform[-1], box, meshes.GROWTH * fine, radial)])
    return r, meshes.film_depths(film.thickness, box, axial)


SOFTER = "raise body.coating.thickness, or lower body.coating.young"


def judged(scene: Scene, status: Status, message: str, peeq: float) -> tuple[Status, str]:
    """Status and message of a solve, as given, unless the film flows without limit; peeq: the largest at the peak.

    A film that yields carries no traction beyond yield_stress/sqrt(3), that is with friction no pressure beyond this over the
    coefficient. A larger pressure that is given has no equilibrium; that of a contact levels off there, while the film is
    sheared until small strains mean nothing.
    """
    coating, mu = scene.body.coating, scene.coefficient
    if coating is not None and status is Status.NOT_CONVERGED and coating.young > scene.body.young:
        return status, f"{message}; if the film is too thin and stiff for the digits of a double, {SOFTER}"
    if coating is None or coating.yield_stress is None:
        return status, message
    words = f"the film flows, with a plastic strain beyond {FLOWED:g}"
    if mu > 0.0:
        most = coating.yield_stress / (np.sqrt(3.0) * mu)
        words = f"the film carries no pressure beyond {most:.4g} Pa with friction.coefficient = {mu:g}"
    if status is Status.CONVERGED and peeq > FLOWED:
        return (
            Status.NOT_CONVERGED,
            f"{words}: {either('raise body.coating.yield_stress', less_load(scene), less_friction(scene))}",
        )
    if status is Status.STEP_CUT_LIMIT and mu > 0.0:
        return status, f"{message}; {words}"
    return status, message
