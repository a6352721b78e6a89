# SPDX-License-Identifier: MIT
"""Least squares of measured tests by a model of the contact, with what they leave open.

Of a test the model gives depths d(theta) at the forces, or the places, of its points. The start is sought on
a grid with half the cells and load steps (index c), by derivatives there and Broyden's updates; the best
theta then on that of the scene (index f), with derivatives of its own: those of d_c differ where little is
determined, and an estimate by them scatters more than they say. What is compared with the points is

    d_f(theta) + zero + compliance F.                                                                  (a)

With the residuals r over their standard deviations, J = dr/dtheta and W, far less than the inverse squares
of the widths of the bounds, so that a variable that is not determined has a variance beyond them, the
covariance is

    C = (J^T J + W)^-1 + G N G^T,        G = (J^T J + W)^-1 J^T,                                       (b)

N that of the numerical error over the points of a branch of a test, e = d_f - d_c in standard deviations:

    N_ij = (e/K)^2 exp(-(pi m (u_i - u_j)/U)^2/2),    e^2 the mean of e_i^2, u = sqrt(x), U its range. (c)

An error of second order is a third of its change by half the grid (Richardson), K = 3: as a mean over a
branch that is one standard deviation, and needs no factor of verification/uncertainty/rule.py, which is for a
single value. m is how often e_i changes its sign on the branch: a Gaussian process with this covariance does
so as often per U (Rice, Bell Syst. Tech. J. 24 (1945) 46, Eq. 3.3-11). The edge of the contact moves over
elements, whose number in the radius goes with u, and the error of d_f passes zero at other loads than e does.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from scipy.linalg import block_diag
from scipy.optimize import least_squares
from scipy.stats import norm, t as student

from sam.scene import Scene
from verification.fit.definition import COMPLIANCE, ZERO, Definition, Parameter, Test, Variables, with_load
from verification.fit.measured import Points
from verification.fit.solves import Answer, Answers, FitError

CONFIDENCE = 0.9
QUANTILE = float(norm.ppf(0.5 + CONFIDENCE / 2.0))
ENDS = ("low", "start", "high")
# of the width of the bounds for a difference and an update: less shows the moving mesh
STEP, LEAST = 0.1, 0.02
FIRST, LATER = 6, 3  # evaluations of all tests on the coarse grid, and in a round on the fine one
ROUNDS = 3  # on the fine grid, at most; after each the noise is estimated
SETTLED = 0.3  # standard deviations by which the parameters may still move in the last round
DETERMINED = 0.35  # of a logarithm: a half-width of 42 %; of others the same share of their bounds
NAMED = 0.4  # of the largest weight in a combination, from which on a parameter is named
FACTORS = ((8.0, 1.0), (1.0, 0.3), (0.1, 1.0))
"""(force, radius) of the further tests that are looked at, over those of the first; the last where the body
has layers: one without strains less under less force, as under a larger ball, and noise hides more."""
RICHARDSON = 3.0  # K of (c); by twice the cells, depths of two steels are off by 0.26 of the change
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
    and a/R of all tests; settled: whether the last round moved little; further: tests that were looked at,
    best first.
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
        """Of the variables, at CONFIDENCE: that of the noise with Student's factor of so few points."""
        free = sum(r.size for r in self.residuals) - self.sought.size
        factor = student.ppf(0.5 + CONFIDENCE / 2.0, max(free, 1)) / QUANTILE
        return np.asarray(factor**2 * self.noise_part + self.numerical_part)

    @property
    def values(self) -> dict[str, float]:
        """Parameter -> its value in SI."""
        return {p.name: float(p.value(x)) for p, x in zip(self.parameters, self.sought, strict=True)}

    @cached_property
    def half_widths(self) -> np.ndarray:
        """Of the variables, at CONFIDENCE."""
        return np.asarray(QUANTILE * np.sqrt(np.diag(self.covariance)))

    @property
    def intervals(self) -> dict[str, tuple[float, float]]:
        """Parameter -> its confidence interval in SI, within its bounds."""
        found = {}
        for p, x, w in zip(self.parameters, self.sought, self.half_widths, strict=True):
            low, high = np.clip([float(p.value(x - w)), float(p.value(x + w))], p.low, p.high)
            found[p.name] = float(low), float(high)
        return found

    @property
    def correlations(self) -> np.ndarray:
        """Of the variables, (p, p)."""
        size = np.sqrt(np.diag(self.covariance))
        return self.covariance / np.outer(size, size)

    @cached_property
    def open_combinations(self) -> list[tuple[float, dict[str, float]]]:
        """What is not determined: eigenvectors of the covariance, scaled so that the largest weight is one,
        along which that parameter has a half-width beyond DETERMINED, the widest first, with their weights.
        """
        n = len(self.definition.of_scene)
        values, vectors = np.linalg.eigh(self.covariance[:n, :n])
        found = []
        for value, vector in zip(values[::-1], vectors.T[::-1], strict=True):
            largest = vector[np.abs(vector).argmax()]
            width, weights = QUANTILE * np.sqrt(value) * abs(largest), (vector / largest).tolist()
            if width > DETERMINED:
                named = zip(self.parameters, weights, strict=False)
                found.append((float(width), {p.name: weight for p, weight in named if abs(weight) > NAMED}))
        return sorted(found, key=lambda each: -each[0])

    def scene(self, values: Variables | None = None) -> Scene:
        """The first test's scene with the parameters."""
        values = self.values if values is None else values
        return self.definition.tests[0].at({p.name: values[p.name] for p in self.definition.of_scene})

    def curve(self, values: Variables) -> tuple[np.ndarray, np.ndarray]:
        """Plastic strain up to the largest reached, and the flow stress in tension in Pa, with back-stresses,
        (n,) each, of parameters within their bounds. Of the layer, where it is sought.
        """
        strain = np.concatenate([[0.0], np.geomspace(1e-4, 1.0, 40) * self.strain])
        inside = {p.name: float(np.clip(values[p.name], p.low, p.high)) for p in self.parameters}
        plasticity = self.scene(inside).body.plasticity
        assert plasticity is not None
        layer = any(".layer." in p.name for p in self.parameters)
        law = plasticity.layer if layer and plasticity.layer is not None else plasticity
        stress, back = np.asarray(law.curve().stress(strain), dtype=float), law.back_stress()
        for C, g in () if back is None else zip(back.modulus, back.recovery, strict=True):
            stress = stress + (C * strain if g == 0.0 else -C / g * np.expm1(-g * strain))
        return strain, stress

    def yield_curve(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """`curve` at the best parameters, and its band, the least and largest at CONFIDENCE, (n,) each."""

        def stress(sought: np.ndarray) -> np.ndarray:
            pairs = zip(self.parameters, sought, strict=True)
            return self.curve({p.name: float(p.value(x)) for p, x in pairs})[1]

        draws = np.random.default_rng(SEED).multivariate_normal(self.sought, self.covariance, DRAWS)
        ends = [0.5 - CONFIDENCE / 2, 0.5 + CONFIDENCE / 2]
        return *self.curve(self.values), *np.quantile([stress(each) for each in draws], ends, 0)


def fit(definition: Definition, answers: Answers, *, ahead: bool = True) -> Fitted:
    """The best parameters, by what `answers` says of the tests, such as `Solves`.

    ahead: look for a further test where something stays open. Raises FitError of the answers.
    """
    search = _Search(definition, answers)
    low, start, high = (np.array([float(p.sought(getattr(p, e))) for p in search.parameters]) for e in ENDS)
    return search.result(*search.climb(start, (low, high)), ahead=ahead)


@dataclass
class _Search:
    """The search of a fit. fine: on the grid of the scene; far: parameters whose differences go to a bound;
    sigma: standard deviation of each test in m.
    """

    definition: Definition
    answers: Answers
    fine: bool = False
    far: set[int] = field(default_factory=set)
    sigma: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        tests = self.definition.tests
        self.parameters = (*self.definition.of_scene, *self.definition.of_machine)
        self.wide = np.array([float(p.sought(p.high) - p.sought(p.low)) for p in self.parameters])
        self.n, self.ends = len(self.definition.of_scene), np.cumsum([t.points.x.size for t in tests])[:-1]
        self.sigma = np.array([test.noise or np.abs(test.points.depth).max() / 100.0 for test in tests])

    def climb(
        self, x: np.ndarray, bounds: tuple[np.ndarray, np.ndarray]
    ) -> tuple[np.ndarray, np.ndarray, bool]:
        """The best variables, the derivatives there, and whether the last round moved little."""
        x, *_ = self.best(x, bounds, self.jacobian(x), FIRST)
        self.fine = True
        jacobian = self.jacobian(x)
        for _ in range(ROUNDS):
            before, jacobian = x, jacobian * self.estimate(x)[:, None]
            x, jacobian, found = self.best(x, bounds, jacobian, LATER)
            moved = np.abs(x - before)
            tried = found or moved.any()  # else every step was refused
            if tried and (moved <= SETTLED * np.sqrt(np.diag(self.of_noise(jacobian)))).all():
                return x, jacobian, True
        return x, jacobian, False

    def best(
        self, x: np.ndarray, bounds: tuple[np.ndarray, np.ndarray], jacobian: np.ndarray, most: int
    ) -> tuple[np.ndarray, np.ndarray, bool]:
        """Least squares on this grid, the derivatives by Broyden's updates, and whether they ended."""
        last: dict[str, np.ndarray] = {}

        def updated(at: np.ndarray) -> np.ndarray:
            found, new = self.residuals(at), jacobian
            if last:
                new, step = last["J"], at - last["x"]
                if (np.abs(step) > LEAST * self.wide).any():
                    new = new + np.outer(found - last["r"] - new @ step, step) / (step @ step)
            last.update(x=at.copy(), r=found, J=new)
            return new

        inside = np.clip(x, np.nextafter(bounds[0], np.inf), np.nextafter(bounds[1], -np.inf))
        shift = inside - 1.0  # the trust region begins with the norm of the variables
        how: dict[str, Any] = {"bounds": tuple(end - shift for end in bounds), "max_nfev": most}
        how |= {"method": "dogbox", "x_scale": "jac", "xtol": 1e-6, "gtol": 1e-6}
        how |= {"ftol": 1e-3 if self.fine else 3e-3, "jac": lambda at: updated(at + shift)}
        answer = least_squares(lambda at: self.residuals(at + shift), inside - shift, **how)
        return answer.x + shift, updated(answer.x + shift), answer.status > 0

    def result(self, x: np.ndarray, jacobian: np.ndarray, settled: bool, *, ahead: bool) -> Fitted:
        """The fit, with what is known of its parameters."""
        tests, noise = self.definition.tests, self.of_noise(jacobian)
        inverse, parts = noise @ jacobian.T, np.split(self.residuals(x), self.ends)
        answers = [self.answer(test, x) for test in tests]
        off = np.concatenate([each.off / s for each, s in zip(answers, self.sigma, strict=True)])
        fitted = Fitted(
            definition=self.definition,
            parameters=self.parameters,
            sought=x,
            jacobian=jacobian,
            noise_part=noise,
            numerical_part=inverse @ self.numerical(x) @ inverse.T,
            bias=inverse @ off,
            residuals=tuple(parts),
            sigma=tuple(map(float, self.sigma)),
            strain=max(each.strain for each in answers),
            ratio=max(each.ratio for each in answers),
            settled=settled,
        )
        further = self.further(fitted) if ahead and fitted.open_combinations else ()
        return replace(fitted, further=further)

    def answer(self, test: Test, x: np.ndarray) -> Answer:
        """What the model says of a test."""
        pairs = zip(self.definition.of_scene, x, strict=False)
        return self.answers(test, {p.name: float(p.value(v)) for p, v in pairs}, self.fine)

    def depths(self, x: np.ndarray) -> list[np.ndarray]:
        """Depths in m at the points of each test."""
        return [self.answer(test, x).depths for test in self.definition.tests]

    def residuals(self, x: np.ndarray) -> np.ndarray:
        """Model less measured depth over its standard deviation, (a)."""
        tests = zip(self.definition.tests, self.depths(x), self.machine(x), strict=True)
        return self.whitened([d + m - test.points.depth for test, d, m in tests])

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
        """Derivatives of the residuals, (points, p), by differences; those of the machine need no solve. Of a
        step that the points cannot show at CONFIDENCE the mesh has too large a part: it goes to a bound.
        """
        base, rest, columns = self.depths(x), self.machine(x), []
        for k, p in enumerate(self.parameters):
            low, high = (float(p.sought(end)) - x[k] for end in (p.low, p.high))
            usual, most = STEP * self.wide[k], max(low, high, key=abs)
            for step in (most,) if k in self.far else (usual if high > usual else -usual, most):
                other = x.copy()
                other[k] += step
                new, old = (self.depths(other), base) if k < self.n else (self.machine(other), rest)
                change = self.whitened([f - g for f, g in zip(new, old, strict=True)])
                if np.linalg.norm(change) > QUANTILE:
                    break
                self.far.add(k)
            columns.append(change / step)
        return np.stack(columns, axis=1)

    def of_noise(self, jacobian: np.ndarray) -> np.ndarray:
        """The first term of (b)."""
        return np.asarray(np.linalg.inv(jacobian.T @ jacobian + np.diag((LOOSE * self.wide) ** -2.0)))

    def estimate(self, x: np.ndarray) -> np.ndarray:
        """Find the standard deviations that are not given, by the residuals of their tests; at each point the
        old one over the new.
        """
        before = self.sigma.copy()
        for k, part in enumerate(np.split(self.residuals(x), self.ends)):
            if self.definition.tests[k].noise is None:
                self.sigma[k] *= np.sqrt((part**2).sum() / max(part.size - x.size, 1))
        return np.repeat(before / self.sigma, [t.points.x.size for t in self.definition.tests])

    def numerical(self, x: np.ndarray) -> np.ndarray:
        """N of (c), (points, points)."""
        coarse, blocks = replace(self, fine=False), []
        changes = self.whitened(self.depths(x)) - self.whitened(coarse.depths(x))
        for test, change in zip(self.definition.tests, np.split(changes, self.ends), strict=True):
            for branch in filter(np.any, (~test.points.unloading, test.points.unloading)):
                u, e = np.sqrt(test.points.x[branch]), change[branch]
                turns = np.count_nonzero(np.diff(np.sign(e[np.argsort(u)])))
                away = np.pi * turns * (u[:, None] - u) / (np.ptp(u) or 1.0)
                blocks.append((e**2).mean() / RICHARDSON**2 * np.exp(-(away**2) / 2.0))
        return np.asarray(block_diag(*blocks))

    def further(self, fitted: Fitted) -> tuple[Further, ...]:
        """Further tests with forty points and the noise of the first, the best first."""
        first, found = self.definition.tests[0], []
        ball, load = first.scene.counterbody, first.scene.loading.force
        assert ball is not None and ball.radius is not None and load is not None
        plasticity = first.scene.body.plasticity
        layered = plasticity is not None and bool(plasticity.profile or plasticity.layer_thickness)
        for more, larger in FACTORS if layered else FACTORS[:-1]:
            force, radius = more * load, larger * ball.radius
            share, back = np.linspace(0.05, 1.0, 20), np.arange(40) >= 20
            points = Points(np.tile(share, 2) * force, np.ones(40), back)
            scene = with_load(first.scene, force, radius=radius)
            test = Test(f"F {more:g}, R {larger:g}", "curve", scene, points, self.sigma[0])
            alone = replace(self.definition, tests=(test,), of_machine=())
            try:
                own = replace(self, definition=alone, fine=False).jacobian(fitted.sought[: self.n])
            except FitError:  # beyond the model
                continue
            own = np.pad(own, ((0, 0), (0, fitted.sought.size - self.n)))
            both = self.of_noise(np.concatenate([fitted.jacobian, own]))
            wide = QUANTILE * np.sqrt(np.diag(both)[: self.n])
            found.append(Further(force, radius, tuple(map(float, wide))))
        return tuple(sorted(found, key=lambda each: max(each.half_widths)))
