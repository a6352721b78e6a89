# SPDX-License-Identifier: MIT
"""An elastic film bonded on an elastic half-space under a wave of traction, by a dense solve with many
digits.

Papkovich-Neuber potentials of each material (Barber, Elasticity, solutions A and B; s = k z, units of 1/k and
1/k^2):

    2 mu u = grad(phi + z psi) - 4 (1 - nu) psi e_z,   phi, psi = (a e^{-s} + b e^{s}) cos(k L),

so u_z, s_zz, s_LL, s_TT go with cos(k L), u_L and s_zL with sin(k L), the loads p (pressing) and q_L
likewise. Four constants in the film and two in the body follow from two conditions at z = 0 and four at z =
h, solved as one system. The antiplane part, u_T under q_T, has three constants. Sources: Burmister, J. Appl.
Phys. 16 (1945) 89.
"""

from __future__ import annotations

from itertools import product

import mpmath as mp

from verification.reference.checks import poisson, positive

STATE = ("u_L", "u_z", "zz", "LL", "TT", "zL")
DIGITS = 60


def wave(potential: str, sign: int, s, shift, *, nu) -> list:
    """STATE (displacement times 2 mu, k = 1) of phi or psi = e^{sign (s - shift)} at the depth s."""
    f = mp.exp(sign * (s - shift))
    if potential == "phi":  # u = grad phi
        return [-f, sign * f, f, -f, 0, -sign * f]
    slope, curve = sign * f, f  # psi', psi''; d^2/dL^2 = -1, d/dL of cos = -sin
    along = -s * f
    zz = s * curve - 2 * (1 - nu) * slope
    across, shear = -2 * nu * slope, -s * slope + (1 - 2 * nu) * f
    return [along, s * slope - (3 - 4 * nu) * f, zz, along + across, across, shear]


class ManyDigits:
    """Film and body at kh, wave number times thickness; young_ratio = E_1/E_2, Poisson's ratios nu1 (film),
    nu2 (body).

    Unit of stress: the traction; of displacement: traction/(mu_1 k); of length: 1/k. A depth is given as s =
    k z.
    """

    def __init__(self, kh: float, young_ratio: float, nu1: float, nu2: float, *, digits: int = DIGITS):
        self.digits = digits
        with mp.workdps(digits):
            self.kh = mp.mpf(positive("kh", kh))
            self.nu = mp.mpf(poisson("nu1", nu1)), mp.mpf(poisson("nu2", nu2))
            # mu_1/mu_2 with all digits: no rounding of the caller's
            self.r = mp.mpf(positive("young_ratio", young_ratio)) * (1 + self.nu[1]) / (1 + self.nu[0])
            self.in_plane, self.antiplane = self._solve_in_plane(), self._solve_antiplane()

    def _film_waves(self, s) -> list[list]:
        """The four waves of the film at depth s; growing ones are referred to the interface."""
        return [
            wave(f, sign, s, 0 if sign < 0 else self.kh, nu=self.nu[0])
            for f, sign in product(("phi", "psi"), (-1, 1))
        ]

    def _body_waves(self, s) -> list[list]:
        """The two waves of the body at depth s, referred to the interface."""
        return [wave(f, -1, s - self.kh, 0, nu=self.nu[1]) for f in ("phi", "psi")]

    def _solve_in_plane(self):
        matrix, loads = mp.zeros(6, 6), mp.zeros(6, 2)
        for j, top in enumerate(self._film_waves(mp.mpf(0))):
            matrix[0, j], matrix[1, j] = -top[2], -top[5]  # p = -s_zz, q_L = -s_zL
        loads[0, 0] = loads[1, 1] = 1
        for row, index in enumerate((0, 1, 2, 5), start=2):
            for j, film in enumerate(self._film_waves(self.kh)):
                matrix[row, j] = film[index]
            for j, body in enumerate(self._body_waves(self.kh), start=4):
                matrix[row, j] = -body[index] * (self.r if index < 2 else 1)  # u ~ 1/mu
        factors, order = mp.mp.LU_decomp(matrix)
        return [mp.mp.U_solve(factors, mp.mp.L_solve(factors, loads[:, j], order)) for j in range(2)]

    def _solve_antiplane(self):
        """u_T mu_1 k = a e^{-s} + b e^{s - kh} in the film, r c e^{-(s - kh)} below; s_zT = mu du_T/dz."""
        e = mp.exp(-self.kh)
        matrix = mp.matrix([[1, -e, 0], [e, 1, -self.r], [-e, 1, 1]])
        return mp.lu_solve(matrix, mp.matrix([1, 0, 0]))

    def state(self, s, load: int, body: bool) -> list:
        """STATE under p (load 0) or q_L (1) at depth s, of film or body; displacement times mu_1 k."""
        with mp.workdps(self.digits):
            s, constants = mp.mpf(s), self.in_plane[load]
            waves = self._body_waves(s) if body else self._film_waves(s)
            used = [constants[4 + j] for j in range(2)] if body else [constants[j] for j in range(4)]
            total = [mp.fsum(c * w[i] for c, w in zip(used, waves, strict=True)) for i in range(len(STATE))]
            half = (self.r if body else 1) / mp.mpf(2)
            return [total[0] * half, total[1] * half, *total[2:]]

    def surface(self) -> list:
        """mu_1 k times (c_zz, c_zL, c_LL, c_TT)."""
        with mp.workdps(self.digits):
            under_p, under_q = self.state(0, 0, False), self.state(0, 1, False)
            a, b, _ = self.antiplane
            return [under_p[1], under_p[0], under_q[0], a + b * mp.exp(-self.kh)]

    def antiplane_stress(self, s, body: bool) -> list:
        """s_zT and s_LT under q_T, factors before cos(k L) and -sin(k L)."""
        with mp.workdps(self.digits):
            a, b, c = self.antiplane
            s = mp.mpf(s)
            if body:
                value = c * mp.exp(self.kh - s)
                return [-value, value]
            down, up = a * mp.exp(-s), b * mp.exp(s - self.kh)
            return [up - down, up + down]
