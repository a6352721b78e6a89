# SPDX-License-Identifier: MIT
"""Least squares of measured tests by a model of the contact, with what they leave open.

Of a test k the model gives depths d_k(theta) at the forces, or the places, of its points; it is solved on two
grids, with half the cells and load steps (c) and as the scene says (f). What is compared with the points is

    d(theta) = d_c(theta) + [d_f(theta_0) - d_c(theta_0)] + zero + compliance F,                           (a)

with theta_0 moved to the best theta until that no longer moves. Derivatives of d_c are differences at the
start, then Broyden's updates, and differences again at the end. With the residuals r over their standard
deviations, J = dr/dtheta and W, far less than the inverse squares of the widths of the bounds, so that a
variable that is not determined has a variance beyond them, the covariance is

    C = (J^T J + W)^-1 + sum_b (G e_b) (G e_b)^T,        G = (J^T J + W)^-1 J^T,                           (b)

where e_b is the bracket of (a), in standard deviations, on a branch b of a test and zero elsewhere: the
numerical errors of loading and unloading of each test are taken as independent.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import norm, t as student

from sam.scene import Scene
from verification.fit.definition import COMPLIANCE, ZERO, Definition, Parameter, Test, Variables
from verification.fit.measured import Points
from verification.fit.solves import Answer, Answers, FitError

CONFIDENCE = 0.9
QUANTILE = float(norm.ppf(0.5 + CONFIDENCE / 2.0))
ENDS = ("low", "start", "high")
STEP = 0.1  # of the width of the bounds for a difference: a smaller one shows the moving mesh
ROUNDS = 3  # times that theta_0 is moved, at most
SETTLED = 0.3  # standard deviations by which the parameters may still move with theta_0
FIRST, LATER = (
    6,
    2,
)  # evaluations of the coarse model before theta_0 and after each, that of the start included
DETERMINED = 0.35  # of a logarithm: a half-width of 42 %; of others the same share of their bounds
NAMED = 0.3  # weight of a parameter in a combination, from which on it is named
FACTORS = ((0.1, 1.0), (8.0, 1.0), (1.0, 0.3), (1.0, 3.0))
"""(force, radius) of the further tests that are looked at, over those of the first."""
NUMERICAL = (
    1.0  # of the change between the grids: as the edge falls between elements, the finer may be as far off
)
LOOSE = 100.0  # widths of the bounds: a standard deviation that says that nothing is known
DRAWS, SEED = 400, 1


@dataclass(frozen=True)
class Further:
    """A further test: force in N, radius in m; half_widths: of the parameters with it, in logarithms."""

    force: float
    radius: float
    half_widths: tuple[float, ...]


@dataclass(frozen=True)
class Fitted:
    """The parameters and what is known of them.

    sought: (p,) variables at the best fit; jacobian: of the residuals; noise_part, numerical_part: the terms
    of (b); bias: by how much small strains of a flat half-space move the variables; residuals: of each test,
    model less measured, in standard deviations, which are sigma, in m; strain, ratio: the largest plastic one
    and a/R of all tests; settled: whether theta_0 was found; further: tests that were looked at, best first.
    """

    definition: Definition
    parameters: tuple[Parameter, ...]
    sought: np.ndarray
    jacobian: np.ndarray
    noise_part: np.ndarray
    numerical_part: np.ndarray
    bias: np.ndarray
    residuals: tuple[np.ndarray, ...]
    sigma: tuple[float, ...]
    strain: float
    ratio: float
    settled: bool
    further: tuple[Further, ...] = ()

    @cached_property
    def covariance(self) -> np.ndarray:
        """Of the variables."""
        return self.noise_part + self.numerical_part

    @property
    def values(self) -> dict[str, float]:
        """Parameter -> its value in SI."""
        return {p.name: float(p.value(x)) for p, x in zip(self.parameters, self.sought, strict=True)}

    @cached_property
    def half_widths(self) -> np.ndarray:
        """Of the variables, at CONFIDENCE."""
        free = sum(r.size for r in self.residuals) - self.sought.size
        noise = student.ppf(0.5 + CONFIDENCE / 2.0, max(free, 1)) / QUANTILE
        variance = noise**2 * np.diag(self.noise_part) + np.diag(self.numerical_part)
        return np.asarray(QUANTILE * np.sqrt(variance))

    @property
    def intervals(self) -> dict[str, tuple[float, float]]:
        """Parameter -> its confidence interval in SI, within its bounds."""
        ends = zip(self.parameters, self.sought, self.half_widths, strict=True)
        return {p.name: _clipped(p, x - w, x + w) for p, x, w in ends}

    @property
    def correlations(self) -> np.ndarray:
        """Of the variables, (p, p)."""
        size = np.sqrt(np.diag(self.covariance))
        return self.covariance / np.outer(size, size)

    @cached_property
    def open_combinations(self) -> list[tuple[float, dict[str, float]]]:
        """What is not determined: half-width in logarithms, and the parameters of a singular vector with
        their weights, the widest first.
        """
        n = len(self.definition.of_scene)
        values, vectors = np.linalg.eigh(self.covariance[:n, :n])
        wide = QUANTILE * np.sqrt(values)
        found = []
        for width, vector in sorted(zip(wide, vectors.T, strict=True), key=lambda pair: -pair[0]):
            if width > DETERMINED:
                vector = vector * np.sign(vector[np.abs(vector).argmax()])
                named = zip(self.parameters, vector, strict=False)
                found.append((float(width), {p.name: float(v) for p, v in named if abs(v) > NAMED}))
        return found

    def scene(self, values: Variables | None = None) -> Scene:
        """The first test's scene with the parameters."""
        values = self.values if values is None else values
        return self.definition.tests[0].at({p.name: values[p.name] for p in self.definition.of_scene})

    def yield_curve(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Plastic strain up to the largest reached, yield stress in Pa there, and its band, (n,) each: the
        least and largest at CONFIDENCE, of parameters within their bounds. Of the layer, where it is sought.
        """
        layer = any(".layer." in p.name for p in self.parameters)
        strain = np.concatenate([[0.0], np.geomspace(1e-4, 1.0, 40) * self.strain])

        def curve(sought: np.ndarray) -> np.ndarray:
            pairs = zip(self.parameters, sought, strict=True)
            values = {p.name: float(np.clip(p.value(x), p.low, p.high)) for p, x in pairs}
            plasticity = self.scene(values).body.plasticity
            assert plasticity is not None
            law = plasticity.layer if layer and plasticity.layer is not None else plasticity
            return np.asarray(law.curve().stress(strain), dtype=float)

        draws = np.random.default_rng(SEED).multivariate_normal(self.sought, self.covariance, DRAWS)
        low, high = np.quantile(
            [curve(each) for each in draws], [0.5 - CONFIDENCE / 2, 0.5 + CONFIDENCE / 2], 0
        )
        return strain, curve(self.sought), low, high


def _clipped(p: Parameter, low: float, high: float) -> tuple[float, float]:
    """An interval of a variable in SI, within the bounds."""
    ends = np.clip([float(p.value(low)), float(p.value(high))], p.low, p.high)
    return float(ends[0]), float(ends[1])


def fit(definition: Definition, answers: Answers, *, ahead: bool = True) -> Fitted:
    """The best parameters, by what `answers` says of the tests, such as `Solves`.

    ahead: look for a further test where something stays open. Raises FitError of the answers.
    """
    search = _Search(definition, answers)
    low, start, high = (np.array([float(p.sought(getattr(p, e))) for p in search.parameters]) for e in ENDS)
    x, settled = search.climb(start, (low, high))
    return search.result(x, settled=settled, ahead=ahead)


@dataclass
class _Search:
    """sigma: of each test in m; correction: of its depths, the bracket of (a), in m."""

    definition: Definition
    answers: Answers
    sigma: np.ndarray = field(init=False)
    correction: list[np.ndarray] = field(init=False)

    def __post_init__(self) -> None:
        tests = self.definition.tests
        self.parameters = (*self.definition.of_scene, *self.definition.of_machine)
        self.n, self.ends = len(self.definition.of_scene), np.cumsum([t.points.x.size for t in tests])[:-1]
        self.sigma = np.array([test.noise or np.abs(test.points.depth).max() / 100.0 for test in tests])
        self.correction = [np.zeros(test.points.x.size) for test in tests]

    def climb(self, x: np.ndarray, bounds: tuple[np.ndarray, np.ndarray]) -> tuple[np.ndarray, bool]:
        """The best variables, and whether theta_0 has settled there."""
        x, jacobian = self.best(x, bounds, self.jacobian(x), FIRST)
        for _ in range(ROUNDS):
            pairs = zip(self.depths(x, fine=True), self.depths(x), strict=True)
            self.correction = [fine - coarse for fine, coarse in pairs]
            before, jacobian = x, jacobian * self.estimate(x)[:, None]
            x, jacobian = self.best(x, bounds, jacobian, LATER)
            if (np.abs(x - before) <= SETTLED * np.sqrt(np.diag(self.of_noise(jacobian)))).all():
                return x, True
        return x, False

    def best(
        self, x: np.ndarray, bounds: tuple[np.ndarray, np.ndarray], jacobian: np.ndarray, most: int
    ) -> tuple[np.ndarray, np.ndarray]:
        """The least squares with this correction, and the derivatives there by Broyden's updates."""
        last: dict[str, np.ndarray] = {}

        def updated(at: np.ndarray) -> np.ndarray:
            found, new = self.residuals(at), jacobian
            if last:
                new, step = last["J"], at - last["x"]
                if step.any():
                    new = new + np.outer(found - last["r"] - new @ step, step) / (step @ step)
            last.update(x=at.copy(), r=found, J=new)
            return new

        inside = np.clip(x, np.nextafter(bounds[0], np.inf), np.nextafter(bounds[1], -np.inf))
        shift = inside - 1.0  # the trust region begins with the norm of the variables
        how: dict[str, Any] = {"bounds": tuple(end - shift for end in bounds), "max_nfev": most}
        how |= {"method": "dogbox", "x_scale": "jac", "ftol": 1e-3, "xtol": 1e-6, "gtol": 1e-6}
        answer = least_squares(
            lambda at: self.residuals(at + shift), inside - shift, lambda at: updated(at + shift), **how
        )
        return answer.x + shift, updated(answer.x + shift)

    def result(self, x: np.ndarray, *, settled: bool, ahead: bool) -> Fitted:
        """The fit, with what is known of its parameters."""
        jacobian, residuals, tests = self.jacobian(x), self.residuals(x), self.definition.tests
        noise, parts = self.of_noise(jacobian), np.split(residuals, self.ends)
        inverse = noise @ jacobian.T
        moved = [inverse @ (NUMERICAL * shift) for shift in self.branches()]
        answers = [self.answer(test, x, fine=True) for test in tests]
        off = np.concatenate([each.off / s for each, s in zip(answers, self.sigma, strict=True)])
        fitted = Fitted(
            definition=self.definition,
            parameters=self.parameters,
            sought=x,
            jacobian=jacobian,
            noise_part=noise,
            numerical_part=np.sum([np.outer(each, each) for each in moved], axis=0),
            bias=inverse @ off,
            residuals=tuple(parts),
            sigma=tuple(map(float, self.sigma)),
            strain=max(each.strain for each in answers),
            ratio=max(each.ratio for each in answers),
            settled=settled,
        )
        further = self.further(fitted) if ahead and fitted.open_combinations else ()
        return replace(fitted, further=further)

    def answer(self, test: Test, x: np.ndarray, *, fine: bool = False) -> Answer:
        """What the model says of a test."""
        pairs = zip(self.definition.of_scene, x, strict=False)
        return self.answers(test, {p.name: float(p.value(v)) for p, v in pairs}, fine)

    def depths(self, x: np.ndarray, *, fine: bool = False) -> list[np.ndarray]:
        """Depths in m at the points of each test."""
        return [self.answer(test, x, fine=fine).depths for test in self.definition.tests]

    def residuals(self, x: np.ndarray) -> np.ndarray:
        """Model less measured depth over its standard deviation, (a)."""
        tests = zip(self.definition.tests, self.depths(x), self.correction, self.machine(x), strict=True)
        return self.whitened([d + c + m - test.points.depth for test, d, c, m in tests])

    def whitened(self, depths: list[np.ndarray]) -> np.ndarray:
        """Depths of all tests over their standard deviations."""
        return np.concatenate([d / s for d, s in zip(depths, self.sigma, strict=True)])

    def machine(self, x: np.ndarray) -> list[np.ndarray]:
        """What zero and compliance add to the depths of each test, in m."""
        named = {p.name: float(p.value(v)) for p, v in zip(self.parameters, x, strict=True)}
        added = []
        for test in self.definition.tests:
            slope = named.get(COMPLIANCE, 0.0) if test.kind == "curve" else 0.0
            added.append(named.get(f"{ZERO} of {test.name}", 0.0) + slope * test.points.x)
        return added

    def jacobian(self, x: np.ndarray) -> np.ndarray:
        """Derivatives of the residuals, (points, p), by differences; those of the machine need no solve."""
        base, rest, columns = self.depths(x), self.machine(x), []
        for k, p in enumerate(self.parameters):
            other, step = x.copy(), STEP * float(p.sought(p.high) - p.sought(p.low))
            step *= 1.0 if p.sought(p.high) - x[k] > step else -1.0
            other[k] += step
            new, old = (self.depths(other), base) if k < self.n else (self.machine(other), rest)
            columns.append(self.whitened([(f - g) / step for f, g in zip(new, old, strict=True)]))
        return np.stack(columns, axis=1)

    def of_noise(self, jacobian: np.ndarray) -> np.ndarray:
        """The first term of (b)."""
        wide = np.array([float(p.sought(p.high) - p.sought(p.low)) for p in self.parameters])
        return np.asarray(np.linalg.inv(jacobian.T @ jacobian + np.diag((LOOSE * wide) ** -2.0)))

    def estimate(self, x: np.ndarray) -> np.ndarray:
        """Find the standard deviations that are not given, by the residuals of their tests; at each point the
        old one over the new.
        """
        before = self.sigma.copy()
        for k, part in enumerate(np.split(self.residuals(x), self.ends)):
            if self.definition.tests[k].noise is None:
                self.sigma[k] *= np.sqrt((part**2).sum() / max(part.size - x.size, 1))
        return np.repeat(before / self.sigma, [t.points.x.size for t in self.definition.tests])

    def branches(self) -> list[np.ndarray]:
        """The correction of each branch of each test over sigma, zero at the points of all others."""
        whole, tests = self.whitened(self.correction), self.definition.tests
        labels = np.concatenate([2 * k + test.points.unloading for k, test in enumerate(tests)])
        return [np.where(labels == label, whole, 0.0) for label in np.unique(labels)]

    def further(self, fitted: Fitted) -> tuple[Further, ...]:
        """Further tests with forty points and the noise of the first, the best first."""
        first, found = self.definition.tests[0], []
        ball, load = first.scene.counterbody, first.scene.loading.force
        assert ball is not None and ball.radius is not None and load is not None
        for more, larger in FACTORS:
            force, radius = more * load, larger * ball.radius
            share, back = np.linspace(0.05, 1.0, 20), np.arange(40) >= 20
            points = Points(np.tile(share, 2) * force, np.ones(40), back)
            test = Test(
                f"F {more:g}, R {larger:g}", "curve", first.loaded(force, radius), points, self.sigma[0]
            )
            alone = replace(self.definition, tests=(test,), of_machine=())
            try:
                own = _Search(alone, self.answers).jacobian(fitted.sought[: self.n])
            except FitError:  # beyond the model
                continue
            own = np.pad(own, ((0, 0), (0, fitted.sought.size - self.n)))
            both = self.of_noise(np.concatenate([fitted.jacobian, own]))
            wide = QUANTILE * np.sqrt(np.diag(both)[: self.n])
            found.append(Further(force, radius, tuple(map(float, wide))))
        return tuple(sorted(found, key=lambda each: max(each.half_widths)))


ENDS = ("low", "start", "high")
