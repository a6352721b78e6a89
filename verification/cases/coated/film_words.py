# SPDX-License-Identifier: MIT
"""The tables of the case film_yield, and its answer in words, all from the numbers."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from sam.scene import Coating
from verification.cases.case import SmallTable, number
from verification.cases.coated.film_contacts import LARGEST_STRAIN, FilmContact, SolvedFilm
from verification.compare.verdicts import LIMIT
from verification.reference.bonded_film import flow_gradient

LEAST_STRAIN = 1e-3
"""Of a body without film, below which a relative change of it says nothing."""
CLAIM = f"{1e2 * LIMIT:g} %"


def by_kind(found: Sequence[SolvedFilm]) -> dict[tuple[str, str], list[SolvedFilm]]:
    """The contacts of each pair of materials."""
    kinds: dict[tuple[str, str], list[SolvedFilm]] = {}
    for one in found:
        kinds.setdefault(one.contact.kind, []).append(one)
    return kinds


def claims(found: Sequence[SolvedFilm]) -> SmallTable:
    """For each pair of materials: how many contacts hold the claim, the largest changes of those with an
    answer, which fail.
    """
    rows = []
    for kind, ones in by_kind(found).items():
        known = [one for one in ones if one.negligible is not None]
        largest = (f"{1e2 * change:+.2f} %" for change in largest_changes(known))
        failing = [one.contact.words for one in known if not one.negligible]
        open_ones = [one.contact.words for one in ones if one.negligible is None]
        rows.append(
            (
                *kind,
                (f"{len(known) - len(failing)} of {len(ones)}"),
                *largest,
                "; ".join(failing) or "none",
                "; ".join(open_ones) or "none",
            )
        )
    return SmallTable(
        f"Does the film change pressure and stress by less than {CLAIM}?",
        (
            *(
                "body",
                "film",
                f"below {CLAIM}",
                "largest change of p_max",
                "of the body's von Mises",
                "fails in",
            ),
            f"no answer (film squeezed by more than {1e2 * LARGEST_STRAIN:g} %)",
        ),
        rows,
    )


def largest_changes(found: Sequence[SolvedFilm]) -> list[float]:
    """Of the largest pressure and of the body's von Mises stress, by size."""
    return [max((one.changes[k] for one in found), key=abs, default=math.nan) for k in (0, 1)]


def numbers(found: Sequence[SolvedFilm], steel: bool, film_yield: float) -> SmallTable:
    """Every contact with one counter-body."""
    rows = []
    for one in found:
        contact, q = one.contact, one.result.quantities
        if contact.steel != steel:
            continue
        rows.append(
            (
                f"{1e6 * contact.radius:g}",
                f"{1e-9 * contact.p0:g}",
                *contact.kind,
                number(1e-9 * q["p_max_bare_Pa"], 4),
                *(f"{1e2 * change:+.2f}" for change in one.changes),
                *(f"{1e2 * strain:.3f}" for strain in (one.bare_strain, one.body_strain)),
                f"{1e2 * one.film_strain:.2f}",
                number(1e-9 * one.film_mises, 3),
                f"{one.film_mises / film_yield:.2f}",
            )
        )
    columns = (
        *(
            "a₀ [µm]",
            "p₀ [GPa]",
            "body",
            "film",
            "p_max bare [GPa]",
            "its change [%]",
            "change of the body's von Mises [%]",
        ),
        *("largest plastic strain of the body, bare [%]", "with film [%]", "of the film [%]"),
        *("von Mises in the film [GPa]", "over its yield stress"),
    )
    return SmallTable("Sphere of steel" if steel else "Rigid sphere", columns, rows)


def refinement(pairs: Iterable[tuple[SolvedFilm, SolvedFilm]]) -> SmallTable:
    """What is left of the elements."""
    rows = []
    for coarse, fine in pairs:
        for one in (coarse, fine):
            changes_of = (f"{1e2 * change:+.2f} %" for change in one.changes)
            strains_of = (f"{1e2 * strain:.3f} %" for strain in (one.body_strain, one.film_strain))
            rows.append(
                (
                    one.contact.body,
                    one.contact.words,
                    (f"{one.scene.fem.cells_per_radius}"),
                    *changes_of,
                    *strains_of,
                )
            )
    columns = (
        "body",
        "contact",
        "elements in a₀",
        "change of p_max",
        "of the body's von Mises",
        "strain of the body",
        "of the film",
    )
    return SmallTable("Refinement, a film that yields", columns, rows)


def answer(found: Sequence[SolvedFilm], film: Coating) -> list[str]:
    """The question in words, from the numbers. film: that which yields."""
    kinds = by_kind(found)
    elastic = kinds["elastic", "elastic"]
    passing = {place(one.contact) for one in elastic if one.negligible}
    notes = [
        f"As the paper calculates, with film and body elastic, the film changes both by less than {CLAIM} in "
        f"{len(passing)} of {len(elastic)} contacts."
    ]
    notes.append(in_short(found, passing))
    notes += [survival(kind, ones, passing) for kind, ones in kinds.items() if kind != ("elastic", "elastic")]
    return [*notes, of_strains(found), of_extrusion(found, film)]


def in_short(found: Sequence[SolvedFilm], passing: set) -> str:
    """What yielding of body and film leaves of the claim."""
    parts = []
    for words, body, film in (
        ("a body that yields under an elastic film", True, False),
        ("a film that yields on an elastic body", False, True),
        ("both yielding", True, True),
    ):
        ones = [one for one in found if (one.contact.body != "elastic", one.contact.yields) == (body, film)]
        kept = [one for one in ones if place(one.contact) in passing]
        if kept:
            open_ones = sum(one.negligible is None for one in kept)
            without = f" ({open_ones} without an answer)" if open_ones else ""
            parts.append(f"{words} in {sum(one.negligible is True for one in kept)} of {len(kept)}{without}")
    return f"In short: where it does, the claim survives {', '.join(parts)}."


def place(contact: FilmContact) -> tuple[float, float, bool]:
    """The contact whatever its materials."""
    return contact.radius, contact.p0, contact.steel


def survival(kind: tuple[str, str], ones: Sequence[SolvedFilm], passing: set) -> str:
    """Which answers of the elastic calculation another pair of materials keeps."""
    body, film = kind
    words = "Elastic body" if body == "elastic" else f"Body that yields ({body})"
    words += ", elastic film" if film == "elastic" else ", film that yields"
    kept = [one for one in ones if place(one.contact) in passing]
    known = [one for one in ones if one.negligible is not None]
    lost = [one.contact.words for one in kept if one.negligible is False]
    gained = [one.contact.words for one in known if place(one.contact) not in passing and one.negligible]
    text = (
        f"{words}: the claim survives in {sum(one.negligible is True for one in kept)} of these {len(kept)}"
    )
    text += f" and fails in {'; '.join(lost)}" if lost else ""
    text += f"; it holds besides in {'; '.join(gained)}" if gained else ""
    text += f"; {len(ones) - len(known)} without an answer" if len(known) < len(ones) else ""
    return (
        f"{text}. Largest changes: "
        f"{' and '.join(f'{1e2 * change:+.1f} %' for change in largest_changes(known))}."
    )


def of_strains(found: Sequence[SolvedFilm]) -> str:
    """What pressure and stress do not show: the plastic strain of the body."""
    yields = [one for one in found if one.contact.body != "elastic" and one.bare_strain > LEAST_STRAIN]
    known = [one for one in yields if one.negligible is not None]

    def spared(one: SolvedFilm) -> float:
        return 1.0 - one.body_strain / one.bare_strain

    most = max(known, key=spared)
    text = (
        "A body that yields hides the film from this measure, as its von Mises stress is its yield stress. "
        f"Its largest plastic strain falls by up to {1e2 * spared(most):.0f} % ({most.contact.body}, "
        f"{most.contact.words})"
    )
    within = [spared(one) for one in known if one.negligible]
    if within:
        text += (
            f", and by up to {1e2 * max(within):.0f} % where pressure and stress change by less than {CLAIM}"
        )
    return f"{text} (strains above {1e2 * LEAST_STRAIN:g} % without film)."


def of_extrusion(found: Sequence[SolvedFilm], film: Coating) -> str:
    """How far the film is squeezed, and the pressure gradient that it can hold."""
    most = max((one for one in found if one.contact.yields), key=lambda one: one.film_strain)
    gradient = flow_gradient(film.yield_stress, film.thickness)
    steep = sorted({one.contact.p0 / one.contact.radius for one in found if one.negligible is None})
    text = (
        f"The film that yields is squeezed by up to {1e2 * most.film_strain:.0f} % ({most.contact.body}, "
        f"{most.contact.words}), most near the edge of the contact. Bonded below and smooth above, it holds "
        f"a pressure gradient of about σ_y/(√3 h) = {1e-15 * gradient:.2f} GPa/µm"
    )
    if steep:
        words = ", ".join(f"{1e-15 * each:g}" for each in steep)
        text += f"; in the contacts without an answer p₀/a₀ is {words} GPa/µm, and it flows out"
    return f"{text}. Its strains at the edge are estimates: they grow with finer elements."
