# SPDX-License-Identifier: MIT
"""Fits that others published: unloading and linear hardening below a sphere, against both models; and where a
sliding contact yields first.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np

from sam.scene import Body, CounterBody, Fem, Friction, Grid, Loading, Plasticity, Result, Scene
from verification.cases.case import (
    FEM,
    SAM,
    Case,
    Context,
    Measured,
    SmallTable,
    elastic_text,
    off_text,
)
from verification.reference.hamilton import largest_von_mises
from verification.reference.hertz import effective_modulus
from verification.reference.indentation import Ghaednia, JacksonGreen, Onset, onset, residual_share

MODELS = {"SAM": SAM, "FEM": FEM}
RADIUS, STEPS = 1e-3, 8
YOUNG, POISSON, YIELD_STRESS, TANGENT = 200e9, 0.3, 750e6, 0.02
"""Of the body that is unloaded; the hardening of 2 % for which the fit was made."""
APPROACHES = (3, 5, 8, 12, 20)
"""w*, approaches over that at first yield."""
ELEMENTS = 12


def plastic_slope(young: float, tangent: float) -> float:
    """Slope of the stress over the plastic strain, of a total tangent that is given over young."""
    return tangent * young / (1.0 - tangent)


def sphere_on(body: Body, loading: Loading, **other: float) -> Scene:
    """A sphere on a body, rigid or of its own moduli; the cells are those that SAM chooses."""
    return Scene(
        title="Sphere on a body with linear hardening",
        body=body,
        counterbody=CounterBody(shape="sphere", radius=RADIUS, **other),
        loading=loading,
        fem=Fem(cells_per_radius=ELEMENTS),
    )


@dataclass(frozen=True)
class Unloaded:
    """first: the contact at first yield; results: w* asked for -> name of the model -> result."""

    body: Body
    first: Onset
    results: Mapping[int, Mapping[str, Result]]

    def points(self) -> Iterator[tuple[int, str, float, float]]:
        """w* asked for, model, w* reached, displacement that stays over the approach."""
        for asked, models in self.results.items():
            for name, result in models.items():
                approach = float(result.quantities["approach_m"])
                share = float(result.quantities["residual_uz_center_m"]) / approach
                yield asked, name, approach / self.first.approach, share


class Unloading(Case):
    """What stays of the approach after unloading, against the fit of Etsion et al."""

    def solve(self, context: Context) -> Unloaded:
        law = Plasticity(law="linear", yield_stress=YIELD_STRESS, modulus=plastic_slope(YOUNG, TANGENT))
        body = Body(young=YOUNG, poisson=POISSON, plasticity=law)
        modulus = effective_modulus(YOUNG, POISSON)
        jackson = JacksonGreen(POISSON, YIELD_STRESS / modulus)
        first = onset(jackson.factor, RADIUS, modulus, YIELD_STRESS)
        results: dict[int, dict[str, Result]] = {}
        for w in APPROACHES:
            loading = Loading(force=first.load * float(jackson.load(w)), steps=STEPS, unload=True)
            scene = sphere_on(body, loading)
            results[w] = {n: context.solve(m, scene, f"{n.lower()}-{w}") for n, m in MODELS.items()}
        return Unloaded(body, first, results)

    def measure(self, found: Unloaded) -> dict[str, Measured]:
        values, shares = {}, {}
        for asked, name, w, share in found.points():
            shares[asked, name] = share
            values[f"{name.lower()}-{asked}"] = Measured(share, float(residual_share(w)))
        for asked in found.results:
            values[f"between-{asked}"] = Measured(shares[asked, "SAM"], shares[asked, "FEM"])
        return values

    def setup(self, found: Unloaded) -> list[tuple[str, str]]:
        hardening = f"tangent {100 * TANGENT:g} % of E"
        return [
            ("Half-space", f"{elastic_text(found.body)}, σ_y = {YIELD_STRESS / 1e6:g} MPa, {hardening}"),
            ("Sphere", f"R = {RADIUS * 1e3:g} mm, rigid"),
            ("First yield", f"w_c = {found.first.approach * 1e9:.2f} nm, by Jackson & Green"),
            ("Load steps", f"{STEPS}, and as many of unloading"),
        ]

    def tables(self, found: Unloaded) -> Iterator[SmallTable]:
        rows = [
            (name, f"{w:.2f}", f"{share:.4f}", f"{residual_share(w):.4f}", off_text(share, residual_share(w)))
            for _, name, w, share in found.points()
        ]
        columns = ("model", "w*", "w_res/w_max", "Etsion et al.", "difference")
        yield SmallTable("Displacement that stays, over the largest approach", columns, rows)

    def notes(self, found: Unloaded) -> Iterator[str]:
        yield (
            "Below w* = 3 the fit is no gate: its form makes it zero at w* = 1, where a body begins to yield "
            "and both models differ from each other by less than from it."
        )


@dataclass(frozen=True)
class Hardened:
    """A body and a sphere of the fit. tangent: total, over young; depth: approach over the radius."""

    name: str
    body: tuple[float, float, float]
    other: tuple[float, float]
    tangent: float
    depth: float

    @property
    def fit(self) -> Ghaednia:
        """The fit; it holds for the body that yields."""
        young, nu, stress = self.body
        modulus = effective_modulus(young, nu, *self.other)
        return Ghaednia(modulus, young, nu, stress, self.tangent)

    @property
    def scene(self) -> Scene:
        """Under the force of the fit."""
        young, nu, stress = self.body
        law = Plasticity(law="linear", yield_stress=stress, modulus=plastic_slope(young, self.tangent))
        force = float(self.fit.load(self.depth)) * self.fit.modulus * RADIUS**2
        body = Body(young=young, poisson=nu, plasticity=law)
        other, other_nu = self.other
        return sphere_on(body, Loading(force=force, steps=STEPS), young=other, poisson=other_nu)


STEEL, SOFT = (200e9, 0.3, 750e6), (71e9, 0.33, 500e6)
SETS = (
    Hardened("steel", STEEL, (200e9, 0.3), 0.02, 0.005),
    Hardened("aluminium", SOFT, (200e9, 0.3), 0.1, 0.005),
    Hardened("aluminium-deep", SOFT, (200e9, 0.3), 0.1, 0.01),
    Hardened("steel-deep", (200e9, 0.33, 500e6), (200e9, 0.33), 0.04, 0.005),
)


class Hardening(Case):
    """Approach and contact radius under the force of the fit of Ghaednia et al."""

    def solve(self, context: Context) -> dict[Hardened, dict[str, Result]]:
        return {
            each: {n: context.solve(m, each.scene, f"{n.lower()}-{each.name}") for n, m in MODELS.items()}
            for each in SETS
        }

    def measure(self, found: dict[Hardened, dict[str, Result]]) -> dict[str, Measured]:
        values = {}
        for each, results in found.items():
            for name, result in results.items():
                approach, radius = reached(result)
                key = f"{name.lower()}-{each.name}"
                values[f"{key}-approach"] = Measured(approach, each.depth)
                values[f"{key}-radius"] = Measured(radius, float(each.fit.area_radius(each.depth)))
        return values

    def setup(self, found: dict[Hardened, dict[str, Result]]) -> Iterator[tuple[str, str]]:
        for each, results in found.items():
            young, nu, stress = each.body
            force = next(iter(results.values())).quantities["force_N"]
            words = f"E = {young / 1e9:g} GPa, ν = {nu:g}, σ_y = {stress / 1e6:g} MPa"
            words += f", tangent {100 * each.tangent:g} % of E; sphere E = {each.other[0] / 1e9:g} GPa"
            yield each.name, f"{words}, R = {RADIUS * 1e3:g} mm; F = {force:.4g} N"

    def tables(self, found: dict[Hardened, dict[str, Result]]) -> Iterator[SmallTable]:
        rows = []
        for each, results in found.items():
            fit = each.depth, float(each.fit.area_radius(each.depth))
            for name, result in results.items():
                ours = reached(result)
                pairs = zip(ours, fit, strict=True)
                cells = [text for one, other in pairs for text in (f"{one:.5f}", off_text(one, other))]
                rows.append((each.name, name, *cells))
        columns = ("body", "model", "approach/R", "from the fit", "a/R", "from the fit")
        yield SmallTable("Under the force of the fit", columns, rows)


def reached(result: Result) -> tuple[float, float]:
    """Approach and contact radius at the peak, over the radius of the sphere."""
    found = result.quantities
    return float(found["approach_m"]) / RADIUS, float(found["contact_radius_m"]) / RADIUS


FRICTIONS: Sequence[float] = (0.0, 0.1, 0.2, 0.3)
FIRST = {0.0: 2.793, 0.1: 2.774, 0.2: 2.716, 0.3: 2.625}
"""p0/k at first yield, nu = 0.3: computed once by quadrature of point forces over the disc."""


class FirstYield(Case):
    """The largest von Mises stress below a given pressure of Hertz with full slip."""

    def solve(self, context: Context) -> dict[tuple[str, float], Result]:
        found = {}
        for mu in FRICTIONS:
            scene = Scene(
                title="Given pressure of Hertz with traction",
                body=Body(young=210e9, poisson=POISSON),
                loading=Loading(prescribed="hertz", p0=1e9, radius=1e-5),
                friction=Friction(coefficient=mu) if mu else None,
                grid=Grid(cells=(65, 65), extent=(4e-5, 4e-5), depths=tuple(np.arange(1, 61) * 2.5e-7)),
            )
            found["SAM", mu] = context.solve(SAM, scene, f"sam-{mu:g}")
            if not mu:
                found["FEM", mu] = context.solve(FEM, scene, f"fem-{mu:g}")
        return found

    def measure(self, found: dict[tuple[str, float], Result]) -> dict[str, Measured]:
        return {
            f"{name.lower()}-{mu:g}".replace(".", ""): Measured(yields_at(result), FIRST[mu])
            for (name, mu), result in found.items()
        }

    def tables(self, found: dict[tuple[str, float], Result]) -> Iterator[SmallTable]:
        rows = []
        for (name, mu), result in found.items():
            exact = sqrt(3.0) / largest_von_mises(1.0, 1.0, POISSON, mu)[0][0]
            rows.append((name, f"{mu:g}", f"{yields_at(result):.4f}", f"{exact:.4f}", f"{FIRST[mu]:.3f}"))
        columns = ("model", "μ", "p₀/k", "Hamilton's closed form", "quadrature")
        yield SmallTable("First yield below the surface, p₀ over the shear yield stress k", columns, rows)


def yields_at(result: Result) -> float:
    """p0/k at which the largest von Mises stress of a unit of p0 reaches the yield stress."""
    found = result.quantities
    return sqrt(3.0) * float(found["p_max_Pa"]) / float(found["mises_max_Pa"])


CASES = (
    Unloading("unloading-fit"),
    Hardening("hardening-fit"),
    FirstYield("first-yield"),
)
