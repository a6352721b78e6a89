# SPDX-License-Identifier: MIT
"""When a tribofilm breaks down: what a load step does to its state in each cell of the surface.

The film of Bosman & Schipper (2011, section 4) is bonded on the body, perfectly plastic (von Mises) and
tested with the low coefficient of friction. It fails where it thins by more than it grows again in a cycle
(paper Eq. 15, 17), or where it cannot bear the traction at all: sqrt(3) mu p >= sigma_y. A film that
becomes thicker loses nothing; the printed form, which only ever thickens under a pressure, is judged by the
size of its strain. A failure lasts until the end of the cycle, and the next cycle starts with a fresh film.

A step is backward Euler under mixed control, every cell by itself. Known at its end: the strains in the
plane, those of the body below (xx, yy, xy), and the stresses on top, s_zz = -p, s_xz = tau, s_yz = 0. That is
the plane-stress problem of Simo & Hughes (1998), section 3.4, with other stresses than 0 off the plane. With
S = s_xx + s_yy - 2 s_zz, D = s_xx - s_yy, T = s_xy and the flow rule d eps_p = lambda s',

    S = S_tr/(1 + a lambda), (D, T) = (D_tr, T_tr)/(1 + b lambda), a = E/(3 (1 - nu)), b = E/(1 + nu),    (a)
    q(lambda) = sqrt(S^2/4 + 3 D^2/4 + 3 T^2) = k,   k^2 = sigma_y^2 - 3 tau^2.                            (b)

Without k^2 > 0 the film cannot bear tau, whatever its strains: no equilibrium. 1/q is concave and grows in
lambda (a power mean of exponent -2 of 1 + a lambda and 1 + b lambda), so Newton's method on 1/q = 1/k climbs
to the root from below, from lambda = 0, and never passes it: it needs no bracket. Where only S or only (D, T)
is there it ends after one iteration.

For comparison only, the printed form: s_ii = E/(2 (1 + nu)) e_ii + nu E/((1 + nu)(1 - 2 nu)) (e_xx + e_yy +
e_zz) with all three strains of the body (Eq. 12), then s_zz + P for s_zz (Eq. 13) and s_xz = mu P (Eq. 14).
Used by default: the strains in the plane only, Hooke's law, s_zz = -P. Why: Hooke's law has E/(1 + nu) before
e_ii; a bonded film shares only the strains in the surface with the body; and equilibrium fixes s_zz, so that
Eq. 13 counts the pressure twice, and as a tension where compression is negative: under a pressure this film
grows thicker. The plastic strain follows by the radial return of that stress at a given strain with Hooke's
2G (Simo & Hughes 1998, box 3.1), so it always exists, at a shear stress below the mu P prescribed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sam.arrays import Array, Mask
from sam.scene.body import Friction
from sam.scene.section import stated


@dataclass(frozen=True, eq=False)
class FilmState:
    """Plastic strain (6, nx, ny) of the film since the start of the cycle, and its failed cells."""

    plastic: Array
    failed: Mask

    @classmethod
    def fresh(cls, shape: tuple[int, int]) -> FilmState:
        """A whole film without plastic strain on (nx, ny) cells."""
        return cls(np.zeros((6, *shape)), np.zeros(shape, dtype=bool))

    @property
    def thinning(self) -> Array:
        """Share of the thickness that plastic flow took, (nx, ny); negative where it is thicker."""
        return 0.0 - self.plastic[2]


@dataclass(frozen=True)
class Loads:
    """What acts on n whole cells of a film: plastic strain (6, n) at the beginning; strain of the
    surface, (3, n), and bulk_normal, its zz; pressure and shear in Pa, (n,).
    """

    plastic: Array
    strain: Array
    pressure: Array
    shear: Array
    bulk_normal: Array | None = None


ITERATIONS = 50  # limit: 2 to 5 are needed from 1 to 1e9 times k
ROUNDING = 1e-14  # of k: 45 roundings of a number


def bearable_radius(shear: Array, yield_stress: float) -> Array:
    """k in Pa of (b), 0 where there is no equilibrium; shear: tau in Pa, any shape."""
    return np.sqrt(np.maximum(yield_stress**2 - 3.0 * shear**2, 0.0))


def increment(loads: Loads, law: FilmLaw) -> Array:
    """Increment of the plastic strain, (6, n), of cells that bear their traction."""
    radius = bearable_radius(loads.shear, law.yield_stress)
    return flow(trial_stress(loads, law), loads.shear, radius, law)


def trial_stress(loads: Loads, law: FilmLaw) -> Array:
    """(S, D, T) of (a) in Pa, (3, n), without further flow: paper Eq. 12 by Hooke's law, s_zz by Eq. 13."""
    young, poisson, normal = law.young, law.poisson, -loads.pressure  # paper Eq. 13: s_zz = -P
    xx, yy, xy = loads.strain - loads.plastic[[0, 1, 5]]
    # s_xx + s_yy of paper Eq. 12, with E/(1 + nu) where E/(2 (1 + nu)) is printed, and s_zz = normal
    in_plane = (young * (xx + yy) + 2.0 * poisson * normal) / (1.0 - poisson)
    twice_shear = law.twice_shear
    return np.stack([in_plane - 2.0 * normal, twice_shear * (xx - yy), twice_shear * xy])


def flow(trial: Array, shear: Array, radius: Array, law: FilmLaw) -> Array:
    """Increment of plastic strain (6, n) that brings trial stresses (3, n) to radius k > 0, (n,), or 0."""
    a, b = law.young / (3.0 * (1.0 - law.poisson)), law.twice_shear
    along, across = trial[0] ** 2 / 4.0, 0.75 * trial[1] ** 2 + 3.0 * trial[2] ** 2
    factor = multiplier(along, across, radius, (a, b))
    S, D, T = trial[0] / (1.0 + a * factor), *(trial[1:] / (1.0 + b * factor))
    deviator = np.stack([S / 6.0 + D / 2.0, S / 6.0 - D / 2.0, -S / 3.0, np.zeros_like(S), shear, T])
    return factor * deviator


def multiplier(along: Array, across: Array, radius: Array, moduli: tuple[float, float]) -> Array:
    """lambda >= 0 in 1/Pa of (b), (n,); along: S_tr^2/4, across: 3 D_tr^2/4 + 3 T_tr^2."""
    (a, b), factor = moduli, np.zeros_like(along)
    for _ in range(ITERATIONS):
        x, y = 1.0 + a * factor, 1.0 + b * factor
        square = along / x**2 + across / y**2
        excess = np.sqrt(square) / radius - 1.0
        above = ~(excess <= ROUNDING)  # NaN too
        if not above.any():
            return factor
        slope = np.where(above, a * along / x**3 + b * across / y**3, 1.0)  # of -q^2/2
        factor = factor + np.where(above, excess * square / slope, 0.0)
    raise ArithmeticError("the return map of the film did not settle: its strains or stresses are not finite")


SHEAR = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])  # each shear component stands for two entries of the tensor


def printed_increment(loads: Loads, law: FilmLaw) -> Array:
    """Increment of the plastic strain, (6, n), of cells under the printed stress."""
    return radial_flow(printed_stress(loads, law), loads.plastic, law)


def printed_stress(loads: Loads, law: FilmLaw) -> Array:
    """Stress (6, n) in Pa by Eqs. 12-14 as printed, order 11 22 33 23 13 12."""
    young, poisson = law.young, law.poisson
    half, lame = young / (2.0 * (1.0 + poisson)), young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
    normals = np.stack([loads.strain[0], loads.strain[1], np.asarray(loads.bulk_normal)])
    stress = np.zeros((6, *loads.pressure.shape))
    stress[:3] = half * normals + lame * normals.sum(axis=0)  # paper Eq. 12
    stress[2] += loads.pressure  # paper Eq. 13
    stress[4] = loads.shear  # paper Eq. 14
    return stress


def radial_flow(stress: Array, plastic: Array, law: FilmLaw) -> Array:
    """Increment of the plastic strain (6, ...) after `plastic`, at given total strains; 0 below yield."""
    twice_shear, yield_stress = law.twice_shear, law.yield_stress
    deviator = stress - twice_shear * plastic
    deviator[:3] -= deviator[:3].mean(axis=0)
    q = np.sqrt(1.5 * np.einsum("i,i...,i...->...", SHEAR, deviator, deviator))
    return np.maximum(q - yield_stress, 0.0) / (twice_shear * np.maximum(q, yield_stress)) * deviator


@dataclass(frozen=True)
class FilmLaw:
    """The law of an elastic, perfectly plastic tribofilm, in Pa. limit: largest loss of thickness in
    a cycle, as a strain (paper Eq. 17); printed: Eq. 12 and 13 as printed.
    """

    young: float
    poisson: float
    yield_stress: float
    low: float
    high: float
    limit: float
    printed: bool = False

    @classmethod
    def of(cls, friction: Friction) -> FilmLaw:
        """The law of a scene; ValueError unless friction.law is "chemical-film"."""
        if not friction.film:
            raise ValueError(f'friction.law = "{friction.law}": a film needs "chemical-film"')
        return cls(
            young=stated(friction.film_young),
            poisson=stated(friction.film_poisson),
            yield_stress=stated(friction.film_yield),
            low=stated(friction.low),
            high=stated(friction.high),
            limit=friction.thinning_limit,
            printed=friction.form == "printed",
        )

    @property
    def twice_shear(self) -> float:
        """2 G = E/(1 + nu) in Pa."""
        return self.young / (1.0 + self.poisson)

    def step(
        self,
        state: FilmState,
        strain: ArrayLike,
        pressure: ArrayLike,
        *,
        sign: float = 1.0,
        bulk_normal: ArrayLike | None = None,
        limit: Array | None = None,
    ) -> FilmState:
        """The state at the end of a load step from `state` on (nx, ny) cells; without pressure a
        film may flow but not fail. strain: (3, nx, ny) xx, yy, xy of the body's surface since the
        start of the cycle; pressure in Pa; sign: of s_xz = -sign low p; bulk_normal: zz, for the
        printed form; limit: largest loss, (nx, ny). ValueError for other shapes, or numbers that
        are not finite.
        """
        strain, pressure, bulk = self._checked(state, strain, pressure, bulk_normal)
        bears = (bearable_radius(self.low * pressure, self.yield_stress) > 0.0) | self.printed
        alive = bears & ~state.failed
        loads = Loads(
            state.plastic[:, alive],
            strain[:, alive],
            pressure[alive],
            -sign * self.low * pressure[alive],  # paper Eq. 14
            None if bulk is None else bulk[alive],
        )
        flow_of = printed_increment if self.printed else increment
        plastic = state.plastic.copy()
        plastic[:, alive] += flow_of(loads, self)
        lost = np.abs(plastic[2]) if self.printed else -plastic[2]
        beyond = ~bears | (
            lost > (self.limit if limit is None else limit)
        )  # paper Eq. 15 does not hold, by Eq. 17
        return FilmState(plastic, state.failed | (beyond & (pressure > 0.0)))

    def coefficient(self, state: FilmState) -> Array:
        """Local coefficient of friction, (nx, ny)."""
        return np.where(state.failed, self.high, self.low)

    def _checked(
        self, state: FilmState, strain: ArrayLike, pressure: ArrayLike, bulk_normal: ArrayLike | None
    ) -> tuple[Array, Array, Array | None]:
        """strain, pressure and bulk_normal as arrays of floats."""
        strain, pressure = np.asarray(strain, dtype=float), np.asarray(pressure, dtype=float)
        shape = state.failed.shape
        if strain.shape != (3, *shape) or pressure.shape != shape:
            shapes = f"{(3, *shape)} and {shape}, as the film is"
            raise ValueError(f"strain {strain.shape} and pressure {pressure.shape} must be {shapes}")
        if not (np.isfinite(strain).all() and np.isfinite(pressure).all() and (pressure >= 0.0).all()):
            raise ValueError("strain and pressure must be finite, and the pressure nowhere below 0")
        bulk = None if bulk_normal is None else np.asarray(bulk_normal)
        if self.printed and (bulk is None or bulk.shape != shape):
            raise ValueError(f'bulk_normal, the strain zz of the body {shape}, is needed by form = "printed"')
        return strain, pressure, bulk
