# SPDX-License-Identifier: MIT
"""Where small strain and the flat surface stop being good: against finite strain with the sphere's true
geometry.

`python -m verification.cases.limits.model_limits` writes data/model_range.csv, what samfem says of a scene.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fem_reference.finite_strain import Curve, build, curve_of, load_to
from sam.scene import Scene
from verification.cases.case import Case, Context, Measured, Plot, SmallTable
from verification.cases.limits.model_limits_curves import (
    COLUMN_OF,
    ELASTIC,
    FRESH,
    LIMIT,
    MODELS,
    OTHERS,
    PLASTIC,
    QUANTITIES,
    RADIUS,
    RESOLVED,
    YOUNG,
    Body,
    Difference,
    differences,
    errors_of_flat,
    law_of,
    loaded,
    range_rows,
    with_spread,
)
from verification.figures.lines import limits as drawn
from verification.references import contact_of
from verification.runs.model_range import COLUMNS, KEPT, WORDS, errors
from verification.runs.tables import columns_text

COARSER = 10  # elements in the largest contact radius, for the influence of the mesh
PLATEAU = 3.0
"""Mean pressure over yield stress of a fully plastic contact: Tabor (1951); Mesarovic and Fleck, Proc. R.
Soc. A 455 (1999).
"""


def curves(context: Context, body: Body, elements: int) -> dict[str, Curve]:
    """Load steps of both models on the same mesh. RuntimeError if one does not converge."""
    found = {}
    for number, kind in enumerate(MODELS, start=1):
        context.progress(f"{context.case}, {body.name}, {MODELS[kind]}", number, len(MODELS))
        found[kind] = loaded(body, elements, kind)
    return found


def loaded_once(kind: str, reach: float, elements: int) -> tuple[Scene, Curve]:
    """An elastic contact of a/R = reach, in one step."""
    scene = Body("small load", 0.3, reach, elements, 1).scene(elements)
    model = build(scene, kind)
    return scene, curve_of(model, load_to(model, [1.0]))


def small_load() -> dict[str, Measured]:
    """At a/R = 1e-3 by the finite model against Hertz; at 2e-3 the first-order change by true geometry alone.

    By Johnson's u_r = -(1 - 2 nu)(1 + nu) a^2 p0/(3 E r) (1 - (1 - r^2/a^2)^(3/2)) the gap changes by r
    u_r/R; the radial part p r/R of a pressure along the normal moves the surface by that of the bracket which
    is left. Both together are uniform: the contact stays that of Hertz, its radius moves by u_r(a), and the
    approach by as much relatively.
    """
    scene, curve = loaded_once("finite", 1e-3, 16)
    exact, nu = contact_of(scene), scene.body.poisson
    flat, sphere = (loaded_once(kind, 2e-3, 32)[1] for kind in ("flat", "sphere"))
    first = -2.0 / (3.0 * np.pi) * (1.0 - 2.0 * nu) / (1.0 - nu)

    def change(name: str) -> float:
        return float(getattr(sphere, name)[-1] / getattr(flat, name)[-1] - 1.0) / flat.radius[-1]

    return {
        "small-radius": Measured(curve.radius[-1] * RADIUS, exact.contact_radius, unit="m"),
        "small-approach": Measured(curve.approach[-1] * RADIUS, exact.approach, unit="m"),
        "first-order-radius": Measured(change("radius"), first),
        "first-order-approach": Measured(change("approach"), first),
    }


@dataclass(frozen=True)
class ComparedCurves:
    """found: name of a body -> model -> its curve; fits: name -> quantity -> difference; other: of the first
    body on a coarser mesh.
    """

    bodies: Sequence[Body]
    found: Mapping[str, Mapping[str, Curve]]
    fits: Mapping[str, Mapping[str, Difference]]
    other: Mapping[str, Difference]

    @property
    def quantities(self) -> dict[str, str]:
        """Those that any body has -> words."""
        return {n: words for n, words in QUANTITIES.items() if any(n in each for each in self.fits.values())}


class ModelLimits(Case):
    """Both Poisson's ratios; the limits of the first on two meshes."""

    def bodies(self, level: str) -> Sequence[Body]:
        """What is pressed at a level."""
        return ELASTIC if level == "full" else ELASTIC[:1]

    def solve(self, context: Context) -> ComparedCurves:
        bodies = self.bodies(context.level)
        found = {body.name: curves(context, body, body.elements) for body in bodies}
        fits = {body.name: differences(found[body.name], body.elements) for body in bodies}
        return ComparedCurves(bodies, found, fits, differences(curves(context, bodies[0], COARSER), COARSER))

    def measure(self, compared: ComparedCurves) -> dict[str, Measured | float]:
        return small_load() | limits_of(compared) | {"table": off_table(compared)}

    def setup(self, compared: ComparedCurves) -> Iterator[tuple[str, str]]:
        yield "Sphere", f"R = {RADIUS * 1e6:g} µm, rigid"
        yield "Models", "; ".join(MODELS.values()) + ": same elements, same mesh, same load steps"
        yield "Compared", "at equal force, over the contact radius a of the model with finite strain"
        fitted = "in the contact radius on; below them the fit runs to no difference"
        yield "Load steps", f"counted from {RESOLVED} elements {fitted}"
        rms = "its rms over the area of contact is 0.7 of it"
        yield "Slope", f"of the sphere at the edge of contact, tan(arcsin a/R); {rms}"
        yield "Limit", f"a/R at which the fit x (c₁ + c₂ x + c₃ x²) to the differences passes {LIMIT:.0%}"

    def tables(self, compared: ComparedCurves) -> Iterator[SmallTable]:
        yield limit_table(compared)
        yield curve_table(compared)

    def figures(self, compared: ComparedCurves) -> Iterator[Plot]:
        panels = {
            title: {
                body: (fit.x, fit.values, fit)
                for body, found in compared.fits.items()
                if (fit := found.get(name))
            }
            for name, title in compared.quantities.items()
        }
        yield Plot(
            drawn(panels, LIMIT),
            "differences",
            "What finite strain and true geometry change",
            "Relative differences at equal force over the contact radius divided by that of the sphere, a "
            "panel for each quantity, points of the load steps and fitted curves.",
            f"Points: load steps; lines: fits from which the limits are taken; shaded: ±{LIMIT:.0%}.",
        )


class ModelLimitsPlastic(ModelLimits):
    """Two materials; the limits of the first on two meshes, and the plateau of the mean pressure of the
    other.
    """

    def bodies(self, level: str) -> Sequence[Body]:
        return PLASTIC

    def measure(self, compared: ComparedCurves) -> dict[str, Measured | float]:
        perfect = PLASTIC[1]
        return limits_of(compared) | {
            "table": off_table(compared),
            "hardness": hardness(compared.found[perfect.name]["finite"], perfect),
            "perfect-limit": compared.fits[perfect.name]["pressure"].good_to(),
        }


class ModelLimitsStated(Case):
    """What is said of a scene, against materials and meshes that the table behind it was not made of."""

    def solve(self, context: Context) -> dict[str, dict[str, Difference]]:
        return {body.name: errors_of_flat(body, curves(context, body, body.elements)) for body in FRESH}

    def measure(self, found: dict[str, dict[str, Difference]]) -> dict[str, Measured | float]:
        ids = ("elastic", "yields")
        return {
            name: max(row[-1] for row in stated_rows(body, found[body.name]))
            for name, body in zip(ids, FRESH, strict=True)
        }

    def setup(self, found: dict[str, dict[str, Difference]]) -> Iterator[tuple[str, str]]:
        yield "Sphere", f"R = {RADIUS * 1e6:g} µm, rigid"
        yield "Materials", "; ".join(body.name for body in FRESH)
        yield "Stated", "by samfem plan and solve, from the table of the cases model-limits"
        yield "Factor", "between stated and measured, once the stated uncertainty is taken off their distance"

    def tables(self, found: dict[str, dict[str, Difference]]) -> list[SmallTable]:
        rows = [
            [body.name, f"{x:g}", WORDS[name], *(f"{100 * value:+.1f} %" for value in values), f"{times:.2f}"]
            for body in FRESH
            for x, name, *values, times in stated_rows(body, found[body.name])
        ]
        columns = ["material", "a/R", "quantity", "stated", "uncertainty", "measured", "factor"]
        return [SmallTable("Error of small strains of a flat half-space at equal force", columns, rows)]


def stated_rows(body: Body, fits: Mapping[str, Difference]) -> list[tuple]:
    """a/R, quantity, stated error with its uncertainty, measured error, and the factor between them."""
    rows = []
    for x in (0.1, 0.2, 0.3):
        stated = errors(law_of(body), body.poisson, x)
        for name, fit in fits.items():
            (error, around), measured = stated[COLUMN_OF[name]], float(fit(x))
            rows.append((x, COLUMN_OF[name], error, around, measured, factor(error, around, measured)))
    return rows


def factor(stated: float, uncertainty: float, measured: float) -> float:
    """By which two errors differ, once the stated one is moved by its uncertainty towards the other; infinite
    where they have other signs.
    """
    nearest = stated + np.clip(measured - stated, -uncertainty, uncertainty)
    ratio = nearest / measured
    return float(max(ratio, 1.0 / ratio)) if ratio > 0.0 else np.inf


def off_table(compared: ComparedCurves) -> float:
    """Largest difference of the errors in data/model_range.csv from those that are found here."""
    apart = []
    for body in compared.bodies:
        rows = range_rows(body, compared.found[body.name])
        for k, x in enumerate(rows["a_over_R"]):
            kept = errors(law_of(body), body.poisson, float(x))
            apart += [abs(kept[name][0] - rows[name][k]) for name in kept]
    return float(max(apart))


def limits_of(compared: ComparedCurves) -> dict[str, float]:
    """The limits of the first body, and what the coarser mesh changes there."""
    values = {}
    for name, fit in compared.fits[compared.bodies[0].name].items():
        values[f"{name}-limit"] = limit = fit.good_to()
        values[f"{name}-mesh"] = float(compared.other[name](limit) - fit(limit))
    return values


def hardness(curve: Curve, body: Body) -> Measured:
    """Mean pressure over yield stress where it is fully plastic, averaged over the load steps, against
    PLATEAU.
    """
    fully = (curve.radius >= 0.1) & (curve.radius <= 0.2)
    modulus = YOUNG / (1.0 - body.poisson**2)
    return Measured(float(curve.pressure[fully].mean()) * modulus / body.plasticity["yield_stress"], PLATEAU)


def words(fit: Difference) -> str:
    """The limit and its range by the error of the fit; or beyond which contact it lies."""
    low, limit, high = (fit.limit(errors) for errors in (1.0, 0.0, -1.0))
    if np.isinf(limit):
        return f"> {fit.x.max():.2f}"
    return f"{limit:.3f} ({low:.3f} to {high:.3f})" if np.isfinite(high) else f"{limit:.3f} (from {low:.3f})"


def slope(x: float) -> float:
    """Of the sphere at the edge of a contact of a/R = x."""
    return x / np.sqrt(1.0 - x**2)


def slope_words(fit: Difference) -> str:
    """The slope at the limit, or beyond which it lies."""
    return f"{'> ' if np.isinf(fit.limit()) else ''}{slope(fit.good_to()):.3f}"


def limit_table(compared: ComparedCurves) -> SmallTable:
    """a/R of LIMIT of each material and quantity, and the slope of the sphere there."""
    rows, names = [], compared.quantities

    def row(name: str, found: Mapping[str, Difference], said: Callable[[Difference], str]) -> None:
        rows.append([name, *(said(found[each]) if each in found else "" for each in names)])

    for body, found in compared.fits.items():
        row(body, found, words)
        row(f"{body}: slope there", found, slope_words)
    row(f"{compared.bodies[0].name}, {COARSER} elements in a", compared.other, words)
    text = f"a/R at which the small-strain, flat model is off by {LIMIT:.0%}; in brackets by two standard "
    return SmallTable(f"{text}errors of the fit", ["material", *names.values()], rows)


def curve_table(compared: ComparedCurves) -> SmallTable:
    """Differences by the fit at some a/R, and the mean pressure of the finite model over E*."""
    rows = []
    for body, each in compared.fits.items():
        curve, largest = compared.found[body]["finite"], 1.02 * each["radius"].x.max()
        for x in (x for x in (0.05, 0.1, 0.15, 0.2, 0.3, 0.4) if x <= largest):
            mean = np.interp(x, curve.radius, curve.pressure)
            cells = (f"{1e2 * float(each[n](x)):+.1f} %" if n in each else "" for n in QUANTITIES)
            rows.append([body, f"{x:g}", f"{slope(x):.3f}", f"{mean:.4f}", *cells])
    return SmallTable(
        "Finite strain over small strain at equal force, less one, by the fits",
        ["material", "a/R", "slope", "p_m/E*, finite strain", *QUANTITIES.values()],
        rows,
    )


CASES = (
    ModelLimits("model-limits"),
    ModelLimitsPlastic("model-limits-plastic"),
    ModelLimitsStated("model-limits-stated"),
)


def main() -> None:
    """Measure data/model_range.csv anew."""
    found = {}
    for body in (*ELASTIC, *PLASTIC, *OTHERS):
        print(body.name, flush=True)
        found[body.name] = range_rows(body, {kind: loaded(body, body.elements, kind) for kind in MODELS})
    parts = []
    for body in (*ELASTIC, *PLASTIC):
        same = next(each for each in PLASTIC + ELASTIC if law_of(each) == law_of(body))
        others = [found[each.name] for each in OTHERS if law_of(each) == law_of(body)]
        parts.append(with_spread(found[body.name], found[same.name], others))
    table = {name: np.concatenate([part[name] for part in parts]) for name in COLUMNS}
    rounded = {name: each.round(5) if each.dtype.kind == "f" else each for name, each in table.items()}
    target = Path(__file__).parents[2] / "data" / KEPT
    target.write_text(columns_text(rounded), encoding="utf-8")
    print(f"{target}: {len(table['law'])} rows")


if __name__ == "__main__":
    main()
