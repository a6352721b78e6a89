# SPDX-License-Identifier: MIT
"""The pages: which families of cases stand on which."""

from __future__ import annotations

from dataclasses import dataclass

from verification.rows import case_files


@dataclass(frozen=True)
class Group:
    """A page. name: of its file; families: of the table of gates; about: one or two sentences for the
    reader.
    """

    name: str
    title: str
    families: tuple[str, ...]
    about: str


GROUPS = (
    Group(
        "elastic",
        "Elastic contact",
        ("hertz",),
        "Smooth elastic bodies at rest, against closed forms, and what must hold of any grid and any units.",
    ),
    Group(
        "plastic",
        "Elasto-plastic contact",
        ("plastic",),
        "Spheres that yield the body, loaded and unloaded: SAM and finite elements with the same load steps, "
        "refinement, and the plastic loop as the paper prints it.",
    ),
    Group(
        "sliding",
        "Contact with friction",
        ("sliding", "moving"),
        "Full slip along x, elastic and elasto-plastic, once, repeatedly and on a path.",
    ),
    Group(
        "cyclic",
        "Repeated loading",
        ("cyclic",),
        "Bodies with back-stresses under loads that come and go or travel: shakedown limits, SAM against "
        "finite elements over many cycles, and the verdict of both.",
    ),
    Group(
        "published",
        "Numbers of others",
        ("published",),
        "Formulas and limits that others published or that follow from their theory: where each is from, if "
        "it was read or derived, the values of both models, and how far they may be off and why.",
    ),
    Group(
        "coated",
        "Coated bodies",
        ("coated",),
        "Elastic and yielding films on a half-space: against integral transforms, finite elements and "
        "published tables, and where a film may be left out.",
    ),
    Group(
        "rough",
        "Rough bodies",
        ("rough",),
        "Asperities and generated patches, with and without friction and film.",
    ),
    Group(
        "running-in",
        "Running-in, tribofilm and wear",
        ("film", "running_in"),
        "The chemical film and its failure, wear over 25 cycles, and what the paper says of its five runs.",
    ),
    Group(
        "limits",
        "Limits of the model",
        ("limits",),
        "Where a flat surface and small strains stop being right: against finite strain and true geometry.",
    ),
    Group(
        "cost",
        "Error against run time",
        ("cost",),
        "Processor time to a given error for each method, and how time and memory grow with size.",
    ),
    Group(
        "peers",
        "Other programs",
        ("peers",),
        "The same contacts in Tamaas, ContactMechanics and aspher, solved on the same machine.",
    ),
    Group(
        "conditions",
        "Conditions and energy",
        ("certificates", "energy"),
        "Whether what the solvers return satisfies equilibrium, contact, friction and the flow rule, "
        "measured with formulas of their own, and whether the energy balances.",
    ),
    Group(
        "robustness",
        "Robustness",
        ("robustness",),
        "Extreme and wrong input, killed runs, and numbers of the core that were changed on purpose.",
    ),
)

OTHER = Group("other", "Further cases", (), "Cases that stand in no family of the table of gates.")


def group_of(case: str) -> Group:
    """The page of a case."""
    family = case_files()[case].family if case in case_files() else ""
    return next((group for group in GROUPS if family in group.families), OTHER)


def page_of(case: str) -> str:
    """The file where a case stands, and the place in it."""
    return f"{group_of(case).name}.html#{case}"
