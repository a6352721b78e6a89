# SPDX-License-Identifier: MIT
"""The contacts of the case film_yield: what they are, their scenes, and what is read from their results."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sam.scene import CounterBody, Plasticity, Result, Scene
from verification.cases.case import with_mesh
from verification.compare.verdicts import LIMIT
from verification.reference.bonded_film import elastic_mises, in_plane_strain, plastic_strain
from verification.reference.coated_changes import film_contact, mises_change, pressure_change
from verification.reference.hertz import effective_modulus
from verification.references import contact_of
from verification.runs.sampling import peak

LARGEST_STRAIN = 0.14
"""Of a film, up to which small strains on its undeformed thickness are taken for an answer: half of it is
their own error, and with elements of half the size the strain at the edge grows by a tenth; beyond, by half
of itself and more.
"""
RADII = (5e-6, 2e-6, 1e-6)
PRESSURES = (4e9, 6.5e9)
BARE_RADIUS = 2e-6
"""Elastic contact radius in m at which the contacts without film are solved, one for all of them."""
STEEL = {"young": 210e9, "poisson": 0.3}
BODIES = {
    "elastic": None,
    "B 945": Plasticity(law="swift", B=945e6, C=20.0, n=0.121),
    "B 1780": Plasticity(law="swift", B=1780e6, C=4.0, n=0.095),
}
"""Steel of the substrate: elastic, the set published for 52100, and what the paper prints in section 5 for
its own.
"""


@dataclass(frozen=True)
class FilmContact:
    """One contact. radius: a0 of the elastic contact without film, m; p0: its largest pressure, Pa; yields:
    the film does.
    """

    radius: float
    p0: float
    steel: bool
    body: str
    yields: bool

    @property
    def words(self) -> str:
        """The contact for the reader."""
        return f"{self.counter}, a₀ = {1e6 * self.radius:g} µm, p₀ = {1e-9 * self.p0:g} GPa"

    @property
    def counter(self) -> str:
        """The counter-body in a word."""
        return "steel" if self.steel else "rigid"

    @property
    def kind(self) -> tuple[str, str]:
        """Of the materials: body, film."""
        return self.body, "yields" if self.yields else "elastic"

    @property
    def alone(self) -> FilmContact:
        """The same without film, at one contact radius for all."""
        return FilmContact(BARE_RADIUS, self.p0, self.steel, self.body, False)

    @property
    def label(self) -> str:
        """For a folder."""
        return (
            "-".join((*self.kind, self.counter, (f"{1e6 * self.radius:g}um-{1e-8 * self.p0:g}")))
            .lower()
            .replace(" ", "")
        )


@dataclass(frozen=True)
class SolvedFilm:
    """The results of a contact. bare: without film on a mesh of its own, at BARE_RADIUS.

    Without film nothing has a length, and all that is relative to a0 is as at any contact radius.
    """

    contact: FilmContact
    scene: Scene
    result: Result
    bare: Result

    @property
    def changes(self) -> tuple[float, float]:
        """Of the largest pressure and of the largest von Mises stress of the body by the film."""
        return self.result.quantities["p_max_change"], self.result.quantities["mises_max_change"]

    @property
    def negligible(self) -> bool | None:
        """Whether the claim of Bosman & Schipper (2011) holds; None if the film is squeezed out of reach of
        small strains.
        """
        return (
            None
            if self.film_strain > LARGEST_STRAIN
            else all(abs(change) <= LIMIT for change in self.changes)
        )

    @property
    def bare_strain(self) -> float:
        """Largest plastic strain of the body without film."""
        return self.bare.quantities["peeq_max"]

    @property
    def body_strain(self) -> float:
        """Largest plastic strain of the body with its film."""
        return self._largest_strain(film=False)

    @property
    def film_strain(self) -> float:
        """Largest plastic strain of the film."""
        return self._largest_strain(film=True)

    @property
    def film_mises(self) -> float:
        """Largest von Mises stress in the film in Pa: of one that yields at the points where it is held to
        its yield stress.
        """
        if not self.contact.yields:
            return self.result.quantities["mises_max_film_Pa"]
        z, mises = peak(self.result.tables["plane"], "z_m", "mises_Pa")
        return float(mises[z < self.thickness].max())

    @property
    def film_profile(self) -> tuple[np.ndarray, np.ndarray]:
        """Radii in m of the columns of Gauss points, and the mean plastic strain of the film in each, (n,)
        both.
        """
        r, z, strain = peak(self.result.tables["plane"], "x_m", "z_m", "peeq")
        inside = z < self.thickness
        radii, column = np.unique(np.round(r[inside] / r.max(), 12), return_inverse=True)
        return radii * r.max(), np.bincount(column, strain[inside]) / np.bincount(column)

    @property
    def thickness(self) -> float:
        """Of the film, m."""
        return self.scene.body.coating.thickness

    @property
    def thin_film(self) -> float:
        """What `at_centre` is on an elastic body, the film much thinner than the contact is wide."""
        body, film, p = self.scene.body, self.scene.body.coating, self.result.quantities["p_center_Pa"]
        strain = in_plane_strain(p, body.young, body.poisson)
        if self.contact.yields:
            return plastic_strain(p, strain, (film.young, film.poisson, film.yield_stress))
        return elastic_mises(p, strain, film.young, film.poisson)

    @property
    def at_centre(self) -> float:
        """On the axis, mean over the film: plastic strain of one that yields, else von Mises stress in Pa."""
        z, values = peak(self.result.tables["axis"], "z_m", "peeq" if self.contact.yields else "mises_Pa")
        return float(values[z < self.thickness].mean())

    @property
    def gradient(self) -> float:
        """Fall of the pressure over r in Pa/m, the line fitted to it from 0.4 to 0.8 of the contact radius
        without film.
        """
        r, p = peak(self.result.tables["line"], "x_m", "p_Pa")
        part = (r >= 0.4 * self.contact.radius) & (r <= 0.8 * self.contact.radius)
        return -float(np.polynomial.polynomial.polyfit(r[part] - r[part][0], p[part], 1)[1])

    def _largest_strain(self, film: bool) -> float:
        """In the film or in the body: on the axis and at the Gauss points."""
        found = []
        for name in ("axis", "plane"):
            z, strain = peak(self.result.tables[name], "z_m", "peeq")
            found.append(strain[(z < self.thickness) == film].max())
        return float(max(found))


def scene_of(base: Scene, contact: FilmContact, cells: int, film: bool = True) -> Scene:
    """The scene of a contact; film: False without coating."""
    other = STEEL if contact.steel else {}
    modulus = effective_modulus(base.body.young, base.body.poisson, *other.values())
    radius = (
        2.0 * contact.radius * modulus / (math.pi * contact.p0)
    )  # Johnson (1985), Eq. 4.24: p0 = 2 a E*/(pi R)
    force = 2.0 / 3.0 * math.pi * contact.radius**2 * contact.p0
    coating = (
        base.body.coating if contact.yields else base.body.coating.model_copy(update={"yield_stress": None})
    )
    body = {"plasticity": BODIES[contact.body], "coating": coating if film else None}
    changed = {
        "body": base.body.model_copy(update=body),
        "counterbody": CounterBody(shape="sphere", radius=radius, **other),
        "loading": base.loading.model_copy(update={"force": force}),
    }
    return with_mesh(base.model_copy(update=changed), cells)


def exact_changes(found: SolvedFilm) -> tuple[float, float]:
    """Of an elastic film on an elastic body, from the closed form of the layered half-space."""
    body, film, other = found.scene.body, found.scene.body.coating, found.scene.counterbody
    counter = math.inf
    if other.elastic:
        counter = other.young / (1.0 - other.poisson**2) / (body.young / (1.0 - body.poisson**2))
    thickness = film.thickness / contact_of(found.scene).contact_radius
    contact = film_contact(thickness, film.young / body.young, film.poisson, body.poisson, counter=counter)
    return pressure_change(contact), mises_change(contact)
