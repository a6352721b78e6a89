# SPDX-License-Identifier: MIT
"""Every condition of a solution, measured after the solve on what was returned, by `verification.checks`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from verification.cases.case import FEM_3D, SAM, Case, Context, Measured, Plot, SmallTable, package_of
from verification.cases.certificates.certificates_measures import OF_GROUP, Conditions, solved
from verification.cases.certificates.certificates_scenes import (
    COEFFICIENT,
    HIGH,
    LEVEL,
    LOW,
    PATCH_CELLS,
    PERFECT_RATIO,
    RATIO,
    SPATIAL_MESH,
    STEPS,
    groups,
)
from verification.cases.recipes import Resolution
from verification.figures.residuals import histories

NAMES = {
    "load": "load: |sum of p - F|/F",
    "complementarity": "contact: |gap| where p > 0, penetration elsewhere, over the approach",
    "displacement": "the same on all cells, displacements summed directly over pressure, traction and "
    "plastic strain",
    "friction": "friction: |q - μp| over p_max; at nodes of FEM over F",
    "equilibrium": "equilibrium: nodal forces on free degrees of freedom over F",
    "yield": "yield: (σ_vM - σ_y)/σ_y",
    "flow": "flow rule: 2G |Δεᵖ - 3/2 Δγ s/σ_vM| over σ_y0, Δεᵖ without volume, Δγ its length and never "
    "negative",
    "consistency": "consistency: |σ_vM - σ_y|/σ_y where Δγ > 0",
    "surface": "surface: tractions at z = 0 or extrapolated to it less those returned, away from the edge of "
    "contact, over p_max",
    "stress": "stress below the surface of elastic SAM, summed directly over pressure and traction, over "
    "p_max",
    "fields": "stress and plastic strain of the returned elements less the means of their points, over the "
    "largest",
    "interface": "film: jumps of σ_zz, σ_xz, σ_yz over p_max, and of ε_xx, ε_yy, ε_xy over p_max/E",
    "film": "chemical film where it is whole: its plastic strain, thinning and traction beyond their limits, "
    "over the limits; cells that have healed",
    "planes": "planes: force through z = const over the load, less 1",
    "histories": "histories: steps that were accepted above the residual where they may stop",
}
CONTACT, FLOW = ("load", "complementarity", "histories"), ("yield", "flow", "consistency")
MEASURED = {
    "sam": (*CONTACT, *FLOW, "displacement", "friction", "surface", "stress", "planes"),
    "fem": (*CONTACT, *FLOW, "equilibrium", "surface", "planes"),
    "coated": (*CONTACT, "displacement", "friction", "surface", "interface"),
    "rough": (*CONTACT, *FLOW, "displacement", "friction", "surface", "stress", "film"),
    "fem-3d": (*CONTACT, *FLOW, "equilibrium", "friction", "fields"),
}
"""Conditions of each group of scenes: each is a gate."""
TITLES = {
    "sam": "SAM, sphere",
    "fem": "axisymmetric FEM",
    "coated": "SAM, film",
    "rough": "SAM, rough",
    "fem-3d": "FEM in three dimensions",
}
SHORT = {"sam": "SAM", "fem": "FEM", "coated": "SAM", "rough": "SAM", "fem-3d": "FEM 3D"}


@dataclass(frozen=True)
class CertifiedScenes:
    """found: group -> name of a scene -> what was measured of it."""

    found: Mapping[str, Mapping[str, Conditions]]
    resolution: Resolution


class Certificates(Case):
    """Each scene solved with the models that apply, and every condition measured."""

    def solve(self, context: Context) -> CertifiedScenes:
        found: dict[str, dict[str, Conditions]] = {group: {} for group in MEASURED}
        for group, name, model, scene in groups(context):
            found[group][name] = OF_GROUP[group](scene, *solved(scene, model))
        return CertifiedScenes(found, LEVEL[context.level])

    def measure(self, each: CertifiedScenes) -> dict[str, Measured]:
        return gated(each.found)

    def setup(self, each: CertifiedScenes) -> list[tuple[str, str]]:
        return [
            (
                "Spheres",
                f"rigid, unloaded again: elastic, Swift (p₀/σ_y0 = {RATIO:g}), perfectly plastic "
                f"({PERFECT_RATIO:g})",
            ),
            ("Sliding", f"Swift steel, coefficient {COEFFICIENT:g}, SAM and FEM in three dimensions"),
            (
                "Films",
                "elastic, at rest and sliding, SAM (sliding also FEM in three dimensions); film and body "
                "that yield, FEM",
            ),
            (
                "Rough",
                f"self-affine patch with relief, elastic or Swift steel; map of friction ({LOW:g}, "
                f"{HIGH:g}), chemical film",
            ),
            (
                "Spheres",
                f"{each.resolution.sam} cells, {each.resolution.fem} elements in the elastic contact radius; "
                f"{STEPS} load steps",
            ),
            (
                "Others",
                f"{SPATIAL_MESH} hexahedra in the radius; {PATCH_CELLS[SAM]}² cells, {PATCH_CELLS[FEM_3D]}² "
                "nodes of a patch",
            ),
        ]

    def tables(self, each: CertifiedScenes) -> list[SmallTable]:
        return [table_of(group, scenes) for group, scenes in each.found.items()]

    def figures(self, each: CertifiedScenes) -> Iterator[Plot]:
        curves = {
            f"{name}, {SHORT[group]}": one.curves
            for group, scenes in each.found.items()
            for name, one in scenes.items()
        }
        yield Plot(
            histories(curves),
            "residuals",
            "Residuals over the iterations",
            "Semi-logarithmic curves of the residual of each load step, falling to the tolerance of the "
            "model",
            "Each curve is one attempt at a load step; the dotted line is where it may stop. Elastic SAM: "
            "contact; plastic SAM: yield and flow rule, the contact inside; FEM: forces of Newton's method. "
            "A residual of exactly zero, as after elastic unloading, has no place on this axis.",
        )


def gated(found: Mapping[str, Mapping[str, Conditions]]) -> dict[str, Measured]:
    """The largest value of each condition in each group. ValueError for one that no scene of the group was
    measured for.
    """
    values = {}
    for group, conditions in MEASURED.items():
        for what in conditions:
            measured = [one.values[what] for one in found[group].values() if what in one.values]
            if not measured:
                raise ValueError(f"{group}: no scene has {what}")
            values[f"{group}-{what}"] = Measured(max(measured), 0 if what == "histories" else None)
    return values


def table_of(group: str, found: Mapping[str, Conditions]) -> SmallTable:
    """One row a condition, a column for each scene of a group."""
    rows = []
    for what in [name for name in NAMES if name in MEASURED[group]]:
        values = [each.values.get(what) for each in found.values()]
        rows.append(
            (NAMES[what], *("" if value is None else f"{value:.1e}" if value else "0" for value in values))
        )
    return SmallTable(
        f"Conditions, measured on what was returned: {TITLES[group]}", ("condition", *found), rows
    )


CASES = (Certificates("certificates", needs=package_of("reference", "mpmath")),)
