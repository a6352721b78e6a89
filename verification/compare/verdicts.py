# SPDX-License-Identifier: MIT
"""Is the film negligible? The answer for a coated scene, and the contact radius below which it is not.

Bosman & Schipper (2011) leave the chemical film out of the normal contact, because a layered calculation
changes pressure and stress by less than 5 % (Table 1, Fig. 3).
"""

import math
from dataclasses import asdict, dataclass, replace

from sam.scene import Scene
from verification.compare.rows import Solution, judged, number
from verification.judging import Measured, Verdict
from verification.reference.coated_changes import breaking_thickness, mises_change, pressure_change
from verification.text.readable import with_prefix

LIMIT = 0.05
"""Largest relative change that the paper calls negligible."""
CLAIM = "claim, at most"
"""Metric of the rows that hold the film against the limit."""
CHANGES = {"p_max_change": "pressure", "mises_max_change": "von Mises stress of the body"}
NOT_JUDGED = "; the exit code is about the agreement of both models (--claim negligible-film: about this too)"
"""Said behind the verdict where the claim was not asked for."""
AGREED = 5e-3
"""Of the bare value: a change is a difference of two results on one grid, the errors of which are mostly
equal."""


@dataclass(frozen=True)
class FilmVerdict:
    """change_*: by the film, at equal force, of the model where it is larger; NaN where there is none.
    breaking_radius_m: contact radius, without the film, of the sphere for which a change reaches the limit; 0
    if none does, infinite if every one of more than the thickness does.
    """

    film_negligible: bool
    change_p_max: float
    change_mises_substrate: float
    limit: float
    breaking_radius_m: float

    def content(self) -> dict:
        """For verdict.json, which knows finite numbers only."""
        return {key: value if math.isfinite(value) else None for key, value in asdict(self).items()}

    @property
    def words(self) -> str:
        """For the reader."""
        pressure, mises = self.change_p_max, self.change_mises_substrate
        sizes = f"largest pressure {pressure:+.2%}, von Mises stress of the body {mises:+.2%}"
        answer = "negligible" if self.film_negligible else "NOT negligible"
        radius = with_prefix(self.breaking_radius_m, "m")
        radius = f"; a sphere breaks the limit below a contact radius of {radius}"
        known = math.isfinite(self.breaking_radius_m) and self.breaking_radius_m > 0
        return f"the film is {answer} (limit {self.limit:.0%}): {sizes}" + radius * known


def _both(sam: Solution, fem: Solution, name: str) -> list[float]:
    return [number(solved.quantities.get(name)) for solved in (sam, fem)]


def verdict(scene: Scene, sam: Solution, fem: Solution) -> FilmVerdict:
    """Of a coated scene, from both models."""
    pairs = [_both(sam, fem, name) for name in CHANGES]
    changes = [max(pair, key=abs) if all(map(math.isfinite, pair)) else math.nan for pair in pairs]
    negligible = all(abs(change) <= LIMIT for change in changes)
    return FilmVerdict(negligible, *changes, LIMIT, breaking_radius(scene))


def breaking_radius(scene: Scene, limit: float = LIMIT) -> float:
    """Of a sphere of the same materials, in m, see `FilmVerdict`; O'Sullivan & King (1988)."""
    body, film, other = scene.body, scene.body.coating, scene.counterbody
    counter = math.inf
    if other is not None and other.elastic:
        counter = other.young / (1.0 - other.poisson**2) / (body.young / (1.0 - body.poisson**2))
    ratio, nu = film.young / body.young, (film.poisson, body.poisson)
    try:
        how = [{"limit": limit, "change": change} for change in (pressure_change, mises_change)]
        found = min(breaking_thickness(ratio, *nu, counter, **each) for each in how)
    except ValueError:  # the limit is passed by the thinnest film of the search
        return math.inf
    return film.thickness / found


def change_rows(sam: Solution, fem: Solution) -> list[Verdict]:
    """The changes by the film of both models against each other."""
    limit = (AGREED, "differences of results with and without the film, whose errors are mostly equal")
    return [judged(name, "absolute", Measured(*_both(sam, fem, name)), limit) for name in CHANGES]


def claim_rows(claim: FilmVerdict, sam: Solution, fem: Solution) -> list[Verdict]:
    """The larger change of both models against the limit: rows that judge the claim."""
    rows = []
    for name, words in CHANGES.items():
        sizes = [abs(value) for value in _both(sam, fem, name)]
        worst = max(sizes) if all(map(math.isfinite, sizes)) else math.nan
        reason = f"negligible: it changes the largest {words} by no more (Bosman & Schipper 2011, section 2)"
        held = judged(f"size of {name}", "at_most", Measured(worst), (claim.limit, reason))
        row = held.row.model_copy(update={"metric": CLAIM})
        rows.append(replace(held, row=row, value=sizes[0], expected=sizes[1]))
    return rows
