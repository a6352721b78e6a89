# SPDX-License-Identifier: MIT
"""What a fit found, in words and tables for a reader: parameters, what stays open, a test that would decide
it, residuals, and the classical numbers beside it.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import pi, sqrt
from typing import Any

import numpy as np

from sam.scene import Scene, unit_of_key
from verification.fit.definition import OF_THE_MACHINE, Test
from verification.fit.fitting import CONFIDENCE, Fitted, Further
from verification.text.readable import with_prefix

LINKED = 0.8  # of a correlation, from which on it is said
TOO_LARGE = 1.6  # times the stated noise
UPPER = 0.5  # share of the largest force down to which unloading is fitted by a power law
AT_BOUND = 1e-3  # of the width of the bounds
RANGE = 0.2  # a/R beyond which the bias by small strains is said before all else
TABOR_STRAIN, TABOR_FACTOR = 0.2, 3.0
CLASSICAL = ("name", "value", "where_it_is_wrong")
PARAMETERS = ("parameter", "value", "low", "high", "u_noise", "u_numerical", "bias_of_model", "unit")


def parameter_rows(fitted: Fitted) -> list[tuple[Any, ...]]:
    """The rows of PARAMETERS, in SI; the last three numbers are relative for a positive parameter."""
    parts = (np.sqrt(np.diag(part)) for part in (fitted.noise_part, fitted.numerical_part))
    rows = []
    for p, noise, numerical, bias in zip(fitted.parameters, *parts, fitted.bias, strict=True):
        size = 1.0 if p.logarithmic else p.scale
        spread = (size * float(each) for each in (noise, numerical, bias))
        value, ends = fitted.values[p.name], fitted.intervals[p.name]
        rows.append((p.name, value, *ends, *spread, _unit(p.name)))
    return rows


def shown(fitted: Fitted) -> list[tuple[str, str, str]]:
    """The parameters for a person: name, value, confidence interval."""
    rows = []
    for p in fitted.parameters:
        numbers = fitted.values[p.name], *fitted.intervals[p.name]
        value, low, high = (_number(number, _unit(p.name)) for number in numbers)
        rows.append((p.name, value, f"{low} to {high}"))
    return rows


def findings(fitted: Fitted) -> Iterator[str]:
    """What a reader must know before the parameters are used, a sentence each."""
    for p, x in zip(fitted.parameters, fitted.sought, strict=True):
        low, high = float(p.sought(p.low)), float(p.sought(p.high))
        if min(x - low, high - x) < AT_BOUND * (high - low):
            yield f"{p.name} ends at a bound of its range: widen it, or give the parameter."
    for width, weights in fitted.open_combinations:
        names = [f"{'+' if weight > 0 else '-'}{name.rpartition('.')[2]}" for name, weight in weights.items()]
        alone = "is" if len(names) == 1 else "together are"
        yield (
            f"The data do not determine {', '.join(names)}, which {alone} free by a factor of "
            f"{np.exp(width):.2g} either way at {CONFIDENCE:.0%} confidence (signs: directions of change)."
        )
    yield from map(_of_further, fitted.further[:1])
    correlations, names = fitted.correlations, [p.name for p in fitted.parameters]
    for i, j in zip(*np.triu_indices(len(names), 1), strict=True):
        if abs(correlations[i, j]) > LINKED:
            yield (
                f"{names[i]} and {names[j]} have the correlation {correlations[i, j]:.3f}: use them together "
                "only, as the yield curve and its band do."
            )
    for test, residuals in zip(fitted.definition.tests, fitted.residuals, strict=True):
        size = float(np.sqrt((residuals**2).mean()))
        if test.noise is not None and residuals.size > 1 and size > TOO_LARGE:
            yield (
                f"The residuals of {test.name} are {size:.1f} times the stated noise: the noise is more, the "
                "law is another, or the material piles up or sinks in beyond what small strains describe."
            )
    if not fitted.settled:
        yield "The parameters have not settled: take more cells and load steps, or narrower bounds."
    off = fitted.bias / fitted.half_widths
    if fitted.ratio > RANGE or np.abs(off).max() > 1.0:
        worst = int(np.abs(off).argmax())
        yield (
            f"The contact reaches a/R = {fitted.ratio:.2g}. Small strains of a flat half-space put "
            f"{names[worst]} off by {off[worst]:+.1f} of its half-width, and others by what the column "
            "bias_of_model says: the fit does not take that off."
        )


def classical(fitted: Fitted) -> Iterator[tuple[str, str, str]]:
    """What is read off the curves by hand: name, value, and where it is wrong."""
    for test in fitted.definition.tests:
        ball, force = test.scene.counterbody, test.scene.loading.force
        assert ball is not None and ball.radius is not None and force is not None
        back = test.points.unloading
        if test.kind != "curve" or not back.any():
            continue
        young, depth = oliver_pharr(test)
        off = f"{100 * (young / fitted.scene().body.young - 1):+.1f} %"
        why = f"{off} of the fit: no pile-up, a power law of the upper half"
        yield f"E of {test.name} by Oliver & Pharr", with_prefix(young, "Pa"), why
        radius = sqrt(depth * (2.0 * ball.radius - depth))
        hardness, strain = force / (pi * radius**2), TABOR_STRAIN * radius / ball.radius
        flow = hardness / TABOR_FACTOR
        x, stress, _, _ = fitted.yield_curve()
        own = float(np.interp(strain, x, stress))
        words = f"fully plastic contact; {100 * (flow / own - 1):+.0f} % of the fit's curve there"
        if strain > x[-1]:
            words += ", which ends before"
        name = f"flow stress of {test.name} by Tabor at a strain of {strain:.3g}"
        yield name, with_prefix(flow, "Pa"), words


def oliver_pharr(test: Test) -> tuple[float, float]:
    """E of the body in Pa and the contact depth in m, by Oliver & Pharr, J. Mater. Res. 7 (1992) 1564.

    F = c (d - d_f)^m of the upper half of the unloading, S = dF/dd at its top, contact depth d - 3/4 F/S,
    E* = S sqrt(pi)/(2 sqrt(A)), A of the ball at the contact depth.
    """
    from scipy.optimize import least_squares  # noqa: PLC0415 - with the fit only

    scene, back = test.scene, test.points.unloading
    ball = scene.counterbody
    assert ball is not None and ball.radius is not None
    force, depth = test.points.x[back], test.points.depth[back]
    top, deepest = float(force.max()), float(depth.max())
    upper = force > UPPER * top

    def misfit(x: np.ndarray) -> np.ndarray:
        found = x[0] * np.clip(depth[upper] / deepest - x[2], 1e-9, None) ** x[1]
        return np.asarray(found - force[upper] / top)

    last = min(0.9, float(depth.min()) / deepest)
    start = [1.0 / (1.0 - last) ** 1.4, 1.4, last]
    c, m, rest = least_squares(misfit, start, bounds=([0.0, 1.0, -1.0], [np.inf, 3.0, 0.99])).x
    stiffness = c * m * (1.0 - rest) ** (m - 1.0) * top / deepest
    contact = deepest - 0.75 * top / stiffness
    area = pi * contact * (2.0 * ball.radius - contact)
    compliance = 2.0 * sqrt(area / pi) / stiffness
    if ball.young is not None and ball.poisson is not None:
        compliance -= (1.0 - ball.poisson**2) / ball.young
    return (1.0 - scene.body.poisson**2) / compliance, contact


def content(fitted: Fitted, solves: int) -> dict[str, Any]:
    """The record of a fit, without a time or a place, so that the same fit is the same bytes."""
    definition = fitted.definition
    return {
        "format": "samfem fit 1",
        "title": definition.title,
        "model": definition.model,
        "confidence": CONFIDENCE,
        "parameters": [dict(zip(PARAMETERS, row, strict=True)) for row in parameter_rows(fitted)],
        "correlations": fitted.correlations,
        "findings": list(findings(fitted)),
        "tests": [
            {
                "name": test.name,
                "kind": test.kind,
                "points": test.points.x.size,
                "sigma_m": sigma,
                "noise": "estimated" if test.noise is None else "stated",
                "rms_residual": float(np.sqrt((residuals**2).mean())),
            }
            for test, sigma, residuals in zip(definition.tests, fitted.sigma, fitted.residuals, strict=True)
        ],
        "classical": [dict(zip(CLASSICAL, row, strict=True)) for row in classical(fitted)],
        "further_tests": [vars(each) for each in fitted.further],
        "largest_strain": fitted.strain,
        "a_over_R": fitted.ratio,
        "model_solves": solves,
    }


def _of_further(best: Further) -> str:
    wide = ", ".join(f"{np.expm1(each):.0%}" for each in best.half_widths)
    return (
        f"Of the further tests that were looked at, a ball of radius {with_prefix(best.radius, 'm')} under "
        f"{with_prefix(best.force, 'N')} would narrow the parameters most, to half-widths of {wide}."
    )


def _unit(name: str) -> str:
    plain = name.partition(" of ")[0]
    return OF_THE_MACHINE.get(plain) or unit_of_key(Scene, name.removesuffix(".0"))


def _number(value: float, unit: str) -> str:
    return with_prefix(value, unit) if unit in ("m", "Pa", "N") else f"{value:.4g} {unit}".strip()
