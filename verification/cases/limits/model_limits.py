# SPDX-License-Identifier: MIT
"""A sphere pressed into a body by small strain on a flat surface and by finite strain with the sphere's true
geometry, and where the two come apart.

`python -m verification.cases.limits.model_limits` writes data/model_range.csv, what samfem says of a scene.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fem_reference import plastic_radius
from fem_reference.finite_strain import Curve, build, curve_of, load_to
from sam.scene import Scene
from verification.cases.case import Context, DataFrame
from verification.references import contact_of
from verification.runs.model_range import (
    COLUMNS,
    ELASTIC as ELASTIC_LAW,
    KEPT,
    PERFECT as PERFECT_LAW,
    SWIFT as SWIFT_LAW,
    WORDS,
    errors,
)
from verification.runs.tables import columns_text

LIMIT = 0.05
"""Relative difference from which on the models of the scenes are called no good."""
QUANTITIES = {
    "pressure": "mean pressure",
    "radius": "contact radius",
    "approach": "approach",
    "strain": "largest plastic strain",
}
COLUMN_OF = dict(zip(QUANTITIES, WORDS, strict=True))
"""Names of the quantities in the table of `verification.runs.model_range`."""
STEP = 0.025  # of a/R in that table: linear in between, fits are off by less than 0.002 by their curvature
POWERS = np.arange(1, 4)
RESOLVED = 6  # elements in the contact radius from which a load step counts
YOUNG, RADIUS = 210e9, 105e-6
SWIFT = {"law": "swift", "B": 945e6, "C": 20.0, "n": 0.121}
MODELS = {"flat": "small strain, flat surface", "finite": "finite strain, true sphere"}
OFF = f"a/R at which the flat model is off by {LIMIT:.0%}; in brackets by two standard errors of the fit"
COARSER = 10  # elements in the largest contact radius, for the influence of the mesh
PLATEAU = 3.0
"""Mean pressure over yield stress of a fully plastic contact: Tabor (1951); Mesarovic and Fleck, Proc. R.
Soc. A 455 (1999).
"""


@dataclass(frozen=True)
class Body:
    """A material and how far it is pressed. elements: in the largest contact radius; hardness: mean pressure
    there, about, None for Hertz; steps: load steps, the contact radius about equal parts of the largest,
    `reach` times that of the sphere.
    """

    name: str
    poisson: float
    reach: float
    elements: int
    steps: int
    plasticity: Mapping[str, object] | None = None
    hardness: float | None = None

    def scene(self, elements: int) -> Scene:
        """The scene with so many elements in the largest contact radius."""
        modulus = YOUNG / (1.0 - self.poisson**2)
        mean = self.hardness or 4.0 / (3.0 * np.pi) * modulus * self.reach
        body = {"young": YOUNG, "poisson": self.poisson} | (
            {"plasticity": self.plasticity} if self.plasticity else {}
        )
        scene = Scene(
            body=body,
            counterbody={"shape": "sphere", "radius": RADIUS},
            loading={"force": mean * np.pi * (self.reach * RADIUS) ** 2},
            fem={"cells_per_radius": 4, "box": 25.0},
        )
        cells = max(4, round(elements / (plastic_radius(scene) or 1.0)))
        return scene.model_copy(update={"fem": scene.fem.model_copy(update={"cells_per_radius": cells})})


ELASTIC = tuple(Body(f"elastic, ν = {nu:g}", nu, 0.4, 16, 20) for nu in (0.3, 0.49, 0.0))
PERFECT = {"law": "perfect", "yield_stress": YOUNG / 300}
PLASTIC = (
    Body("Swift steel", 0.3, 0.4, 16, 60, SWIFT, 11.2e9),
    Body("perfectly plastic, yield strain 1/300", 0.3, 0.3, 16, 80, PERFECT, 2.8 * PERFECT["yield_stress"]),
    Body("Swift steel, ν = 0.49", 0.49, 0.4, 16, 60, SWIFT, 11.2e9),
)
WEAKER = PERFECT | {"yield_stress": YOUNG / 600}
OTHERS = (
    Body("0.6 of the Swift steel", 0.3, 0.35, 10, 40, SWIFT | {"B": 0.6 * SWIFT["B"]}, 6.5e9),
    Body("Swift, n = 0.06", 0.3, 0.35, 10, 40, SWIFT | {"B": 1.3e9, "n": 0.06}, 7.5e9),
    Body("perfectly plastic, yield strain 1/600", 0.3, 0.25, 10, 50, WEAKER, 2.85 * WEAKER["yield_stress"]),
)
"""Materials by which an error differs that is taken from those above: a part of its uncertainty."""
FRESH = (
    Body("elastic, ν = 0.4", 0.4, 0.32, 20, 16),
    Body("1.3 of the Swift steel", 0.3, 0.35, 10, 40, SWIFT | {"B": 1.3 * SWIFT["B"]}, 14e9),
)
"""Materials and a mesh that the table of `verification.runs.model_range` was not made of."""


@dataclass(frozen=True)
class Difference:
    """Relative difference of a quantity at equal force over a/R of the finite model, and its fit x (c1 + c2 x
    + c3 x^2). covariance: (3, 3) of the coefficients, by the scatter of the points about the fit.
    """

    x: np.ndarray
    values: np.ndarray
    coefficients: np.ndarray
    covariance: np.ndarray

    @classmethod
    def of(cls, x: np.ndarray, values: np.ndarray) -> Difference:
        """Least squares; at least four points."""
        powers = x[:, None] ** POWERS
        coefficients = np.linalg.lstsq(powers, values, rcond=None)[0]
        variance = np.sum((powers @ coefficients - values) ** 2) / (x.size - POWERS.size)
        return cls(x, values, coefficients, variance * np.linalg.inv(powers.T @ powers))

    def __call__(self, x: np.ndarray) -> np.ndarray:
        """The fit."""
        return np.asarray(x)[..., None] ** POWERS @ self.coefficients

    def error(self, x: np.ndarray) -> np.ndarray:
        """Two standard deviations of the fit."""
        powers = np.asarray(x)[..., None] ** POWERS
        return 2.0 * np.sqrt(np.einsum("...i,ij,...j->...", powers, self.covariance, powers))

    def limit(self, errors: float = 0.0) -> float:
        """a/R at which the fit, its errors taken outwards, first reaches LIMIT; infinite if it does not."""
        dense = np.linspace(0.0, self.x.max(), 4001)
        beyond = np.flatnonzero(np.abs(self(dense)) + errors * self.error(dense) >= LIMIT)
        return float(dense[beyond[0]]) if beyond.size else np.inf

    def good_to(self) -> float:
        """The limit, or the largest contact that was looked at."""
        return min(self.limit(), float(self.x.max()))


def loaded(body: Body, elements: int, kind: str) -> Curve:
    """All load steps of one model."""
    model = build(body.scene(elements), kind)
    steps = load_to(model, (np.arange(1, body.steps + 1) / body.steps) ** 2)
    if not steps[-1].state.converged:
        raise RuntimeError(f"{body.name}, {MODELS[kind]}: step {len(steps)} of {body.steps} did not converge")
    return curve_of(model, steps)


def differences(found: Mapping[str, Curve], elements: int) -> dict[str, Difference]:
    """Quantity -> difference of the two models at equal force, at the steps whose contact is resolved."""
    flat, true = found["flat"], found["finite"]
    x = true.radius
    use = x >= RESOLVED / elements * x.max()
    both = {name: (getattr(flat, name)[use], getattr(true, name)[use]) for name in QUANTITIES}
    return {name: Difference.of(x[use], t / f - 1.0) for name, (f, t) in both.items() if (f > 0.0).all()}


def range_rows(body: Body, found: Mapping[str, Curve]) -> DataFrame:
    """Rows of the table of `model_range`: errors of the flat model over its a/R with two standard errors."""
    import pandas as pd

    fits = errors_of_flat(body, found)
    x = STEP * np.arange(1, int(fits["radius"].x.max() / STEP + 0.01) + 1)
    columns = {"law": law_of(body), "poisson": body.poisson, "a_over_R": x}
    for name, fit in fits.items():
        columns |= {COLUMN_OF[name]: fit(x), f"u_{COLUMN_OF[name]}": fit.error(x)}
    return pd.DataFrame(columns).reindex(columns=list(COLUMNS))


def errors_of_flat(body: Body, found: Mapping[str, Curve]) -> dict[str, Difference]:
    """Quantity -> error of the flat model at equal force, over its own a/R."""
    return differences({"flat": found["finite"], "finite": found["flat"]}, body.elements)


def law_of(body: Body) -> str:
    """Of a body in the table."""
    law = (body.plasticity or {}).get("law")
    return {None: ELASTIC_LAW, "swift": SWIFT_LAW, "perfect": PERFECT_LAW}[law]


def with_spread(rows: DataFrame, same: DataFrame, others: Sequence[DataFrame]) -> DataFrame:
    """The rows, whose uncertainty has in it by how much `others` differ from `same`, all of one law."""
    widened = rows.copy()
    for name in WORDS if others else ():
        one, *rest = (np.interp(rows["a_over_R"], each["a_over_R"], each[name]) for each in (same, *others))
        widened[f"u_{name}"] += np.max(np.abs(np.array(rest) - one), axis=0)
    return widened


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


def small_load() -> dict[str, float]:
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
        "small-radius": curve.radius[-1] * RADIUS,
        "small-radius expected": exact.contact_radius,
        "small-approach": curve.approach[-1] * RADIUS,
        "small-approach expected": exact.approach,
        "first-order-radius": change("radius"),
        "first-order-radius expected": first,
        "first-order-approach": change("approach"),
        "first-order-approach expected": first,
    }


def compared(context: Context, bodies: Sequence[Body]) -> Iterator[dict[str, Any]]:
    """The differences of each body; the limits of the first, on a coarser mesh too; what the table is off."""
    found = {body.name: curves(context, body, body.elements) for body in bodies}
    fits = {body.name: differences(found[body.name], body.elements) for body in bodies}
    other = differences(curves(context, bodies[0], COARSER), COARSER)
    named = fits | {f"{bodies[0].name}, {COARSER} elements in a": other}
    for name, each in named.items():
        row = {"sweep": OFF, "material": name} | {QUANTITIES[of]: words(fit) for of, fit in each.items()}
        if name in fits:
            row["a-over-R"] = each["radius"].x
            for of, fit in each.items():
                row |= {f"difference-of-{of}": fit.values, f"difference-of-{of} expected": fit(fit.x)}
        yield row
    values = {"table": off_table(bodies, found)}
    for name, fit in fits[bodies[0].name].items():
        values[f"{name}-limit"] = limit = fit.good_to()
        values[f"{name}-mesh"] = float(other[name](limit) - fit(limit))
    if bodies == PLASTIC:
        perfect = PLASTIC[1]
        values["perfect-limit"] = fits[perfect.name]["pressure"].good_to()
        values |= {"hardness": hardness(found[perfect.name]["finite"], perfect), "hardness expected": PLATEAU}
    yield {"sweep": "values"} | values


def elastic(context: Context) -> Iterator[dict[str, Any]]:
    """All Poisson's ratios, at the quick level the first; and small loads."""
    yield from compared(context, ELASTIC if context.level == "full" else ELASTIC[:1])
    yield {"sweep": "small load"} | small_load()


def plastic(context: Context) -> Iterator[dict[str, Any]]:
    """Three materials, and the plateau of the mean pressure of the perfectly plastic one."""
    return compared(context, PLASTIC)


def stated(context: Context) -> Iterator[dict[str, Any]]:
    """What is said of other materials and meshes: stated error and uncertainty, measured error, factor."""
    for body in FRESH:
        fits = errors_of_flat(body, curves(context, body, body.elements))
        for x in (0.1, 0.2, 0.3):
            said = errors(law_of(body), body.poisson, x)
            for name, fit in fits.items():
                (error, around), measured = said[COLUMN_OF[name]], float(fit(x))
                row = {
                    "sweep": "stated",
                    "material": body.name,
                    "law": (body.plasticity or {"law": "elastic"})["law"],
                    "a over R": x,
                }
                row |= {"quantity": WORDS[COLUMN_OF[name]], "said": error, "uncertainty": around}
                yield row | {"measured": measured, "factor": factor(error, around, measured)}


def factor(stated: float, uncertainty: float, measured: float) -> float:
    """By which two errors differ once the stated one is moved by its uncertainty; infinite by sign."""
    nearest = stated + np.clip(measured - stated, -uncertainty, uncertainty)
    ratio = nearest / measured
    return float(max(ratio, 1.0 / ratio)) if ratio > 0.0 else np.inf


def off_table(bodies: Sequence[Body], found: Mapping[str, Mapping[str, Curve]]) -> float:
    """Largest difference of the errors in data/model_range.csv from those that are found here."""
    apart = []
    for body in bodies:
        for row in range_rows(body, found[body.name]).to_dict("records"):
            kept = errors(law_of(body), body.poisson, row["a_over_R"])
            apart += [abs(kept[name][0] - row[name]) for name in kept]
    return float(max(apart))


def hardness(curve: Curve, body: Body) -> float:
    """Mean pressure over yield stress where it is fully plastic, averaged over the load steps."""
    fully = (curve.radius >= 0.1) & (curve.radius <= 0.2)
    modulus = YOUNG / (1.0 - body.poisson**2)
    return float(curve.pressure[fully].mean()) * modulus / body.plasticity["yield_stress"]


def words(fit: Difference) -> str:
    """The limit and its range by the error of the fit; or beyond which contact it lies."""
    low, limit, high = (fit.limit(errors) for errors in (1.0, 0.0, -1.0))
    if np.isinf(limit):
        return f"> {fit.x.max():.2f}"
    return f"{limit:.3f} ({low:.3f} to {high:.3f})" if np.isfinite(high) else f"{limit:.3f} (from {low:.3f})"


def main() -> None:
    """Measure data/model_range.csv anew."""
    import pandas as pd

    found = {}
    for body in (*ELASTIC, *PLASTIC, *OTHERS):
        print(body.name, flush=True)
        found[body.name] = range_rows(body, {kind: loaded(body, body.elements, kind) for kind in MODELS})
    parts = []
    for body in (*ELASTIC, *PLASTIC):
        same = next(each for each in PLASTIC + ELASTIC if law_of(each) == law_of(body))
        others = [found[each.name] for each in OTHERS if law_of(each) == law_of(body)]
        parts.append(with_spread(found[body.name], found[same.name], others))
    table = pd.concat(parts).round(5)
    target = Path(__file__).parents[2] / "data" / KEPT
    target.write_text(columns_text({name: table[name].to_numpy() for name in COLUMNS}), encoding="utf-8")
    print(f"{target}: {len(table)} rows")


if __name__ == "__main__":
    main()
