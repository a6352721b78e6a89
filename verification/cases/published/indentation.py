# SPDX-License-Identifier: MIT
"""Load and contact area of a perfectly plastic half-space against published finite-element correlations."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from sam.scene import Result, Scene
from verification.cases.case import (
    FEM,
    SAM,
    Case,
    Context,
    Plot,
    SmallTable,
    elastic_text,
    with_loading,
)
from verification.cases.recipes import Resolution, initial_yield, resolved_at
from verification.figures.refinement import correlations
from verification.reference.indentation import JacksonGreen, KogutEtsion, Onset, onset
from verification.references import contact_of

AT = Resolution(14, 16)
LARGEST = 20.0  # w*: beyond it the two correlations part, 14 % at 110
RESOLVED = 0.35  # contact radius over that at the largest load from which a point counts
BAND = 0.05
NAMES = {SAM: "SAM", FEM: "FEM"}


@dataclass(frozen=True)
class Indented:
    """points: "SAM", "FEM" -> what `curve` returns; first: the contact at first yield; fits: name ->
    correlation.
    """

    scene: Scene
    first: Onset
    points: Mapping[str, tuple[np.ndarray, np.ndarray, np.ndarray]]
    fits: Mapping[str, JacksonGreen | KogutEtsion]


class Indentation(Case):
    """Every load step of one run of each model is a point of the load and the area curve."""

    def solve(self, context: Context) -> Indented:
        scene = context.scene("plastic-perfect")
        elastic, stress = contact_of(scene), initial_yield(scene)
        jackson = JacksonGreen(scene.body.poisson, stress / elastic.modulus)
        first = onset(jackson.factor, elastic.radius, elastic.modulus, stress)
        force = first.load * float(jackson.load(LARGEST))
        scene = resolved_at(with_loading(scene, force=force, unload=False, steps=20), AT)
        points = {name: curve(context.solve(model, scene, model), first) for model, name in NAMES.items()}
        fits = {"Jackson & Green 2005": jackson, "Kogut & Etsion 2002": KogutEtsion(scene.body.poisson)}
        return Indented(scene, first, points, fits)

    def measure(self, found: Indented) -> dict[str, float]:
        return {
            f"{name.lower()}-{what}-{fit_name.split()[0].lower()}": np.max(
                np.abs(values / getattr(fit, what)(w) - 1.0)
            )
            for name, (w, load, area) in found.points.items()
            for what, values in (("load", load), ("area", area))
            for fit_name, fit in found.fits.items()
        }

    def setup(self, found: Indented) -> list[tuple[str, str]]:
        scene, first = found.scene, found.first
        return [
            ("Half-space", f"{elastic_text(scene.body)}, perfectly plastic"),
            ("Yield stress", f"{initial_yield(scene) / 1e9:g} GPa"),
            ("Sphere", f"R = {scene.counterbody.radius * 1e6:g} µm, rigid"),
            (
                "First yield",
                f"w_c = {first.approach * 1e9:.3f} nm, P_c = {first.load * 1e3:.4f} mN, A_c = "
                f"{first.area * 1e12:.4f} µm²",
            ),
            ("Load", f"{scene.loading.force:.5g} N in {scene.loading.steps} steps, each of them a point"),
        ]

    def tables(self, found: Indented) -> list[SmallTable]:
        return [table(name, *points, fits=found.fits) for name, points in found.points.items()]

    def figures(self, found: Indented) -> Iterator[Plot]:
        panels = {
            f"{what} ${ratio}$": (
                {name: getattr(fit, what) for name, fit in found.fits.items()},
                {name: (points[0], points[k]) for name, points in found.points.items()},
            )
            for k, what, ratio in ((1, "load", "P/P_c"), (2, "area", "A/A_c"))
        }
        yield Plot(
            correlations(panels, (1.0, LARGEST), BAND),
            "correlations",
            "Load and area over the approach",
            "Log-log curves of the load and of the contact area over the approach, each divided by its value "
            "at first yield: points of SAM and FEM on the correlations of Jackson & Green and of Kogut & "
            "Etsion, distances underneath.",
            f"Underneath: distance from Jackson & Green; shaded: ±{100 * BAND:g} %. Kogut & Etsion jump at "
            "w* = 6.",
        )


def curve(result: Result, first: Onset) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """w*, P* and A* of the load steps whose contact is resolved and whose w* is within the fits."""
    w, load, area = (
        np.asarray(result.tables["history"][name], dtype=float) / unit
        for name, unit in zip(
            ("approach_m", "force_N", "contact_area_m2"),
            (first.approach, first.load, first.area),
            strict=True,
        )
    )
    use = (np.sqrt(area / area.max()) >= RESOLVED) & (w <= 1.05 * LARGEST)
    return w[use], load[use], area[use]


def table(name: str, w: np.ndarray, load: np.ndarray, area: np.ndarray, *, fits: Mapping) -> SmallTable:
    """Each point and its distance from each fit in %."""
    columns = ["w*", "P*", "A*"]
    cells = [[f"{v:.2f}" for v in column] for column in (w, load, area)]
    for fit_name, fit in fits.items():
        columns += [f"P*, {fit_name.split()[0]}", f"A*, {fit_name.split()[0]}"]
        cells += [
            [f"{1e2 * (v / e - 1.0):+.1f} %" for v, e in zip(values, expected, strict=True)]
            for values, expected in ((load, fit.load(w)), (area, fit.area(w)))
        ]
    return SmallTable(
        f"{name}, and its distance from the fits", columns, [list(row) for row in zip(*cells, strict=True)]
    )


CASES = (Indentation("indentation"),)
