# SPDX-License-Identifier: MIT
"""A bonded, perfectly plastic film (von Mises) under any strain in its plane and any pressure and traction:
two solvers.

Mixed control: given are the strains in the plane (xx, yy, xy) and the stresses szz = -p, sxz, syz = 0 (Bosman
& Schipper 2011, Eqs. 12-14, read as in `bonded_film`). Neither solver uses this structure: both take the
elasto-plastic law in six components, given all six strains, and find the three strains off the plane that
meet the three stresses. Tensors have six components xx, yy, zz, yz, xz, xy, shear strains are those of the
tensor.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import isclose

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import root

from .checks import Checked
from .stress import deviator, von_mises

PLANE, OFF = [0, 1, 5], [2, 3, 4]
SHEAR = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])  # each shear component stands for two entries of the tensor
RESIDUAL = 1e-10  # of the yield stress
SOLVER_DIGITS = 1e-14  # of the strains off the plane
RATE_DIGITS = 1e-12  # of the yield stress and strain


@dataclass(frozen=True)
class FlowPoint:
    """Strains xx, yy, xy (3,) in the film's plane, pressure and sxz in Pa. Points add and scale."""

    strain: np.ndarray
    pressure: float
    shear: float

    @property
    def off_plane(self) -> np.ndarray:
        """szz, syz, sxz in Pa."""
        return np.array([-self.pressure, 0.0, self.shear])

    def __sub__(self, other: FlowPoint) -> FlowPoint:
        return FlowPoint(self.strain - other.strain, self.pressure - other.pressure, self.shear - other.shear)

    def towards(self, other: FlowPoint, share: float) -> FlowPoint:
        pairs = zip(vars(self).values(), vars(other - self).values(), strict=True)
        return FlowPoint(*(one + share * step for one, step in pairs))


@dataclass(frozen=True)
class Film(Checked):
    """young and yield_stress in Pa."""

    young: float
    poisson: float
    yield_stress: float

    @property
    def stiffness(self) -> np.ndarray:
        """Stress (6,) from the six components of a strain tensor, (6, 6) in Pa."""
        twice_shear = self.young / (1.0 + self.poisson)
        matrix = twice_shear * np.eye(6)
        matrix[:3, :3] += twice_shear * self.poisson / (1.0 - 2.0 * self.poisson)
        return matrix

    def implicit_step(self, plastic: np.ndarray, point: FlowPoint) -> np.ndarray:
        """Plastic strain (6,) after a backward-Euler step to a point: radial return in six components inside
        a root search. ArithmeticError if no strains off the plane meet the stresses there.
        """
        scale = self.yield_stress / self.young

        def misfit(unknown: np.ndarray) -> np.ndarray:
            stress, _ = self._radial_return(plastic, _joined(point.strain, scale * unknown))
            return (stress[OFF] - point.off_plane) / self.yield_stress

        found = root(misfit, np.zeros(3), method="hybr", options={"xtol": SOLVER_DIGITS, "maxfev": 5000})
        if np.abs(found.fun).max() > RESIDUAL:
            raise ArithmeticError(f"no strains off the plane meet szz, syz, sxz = {point.off_plane} Pa")
        return self._radial_return(plastic, _joined(point.strain, scale * found.x))[1]

    def _radial_return(self, plastic: np.ndarray, strain: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Stress and plastic strain at a given total strain (Simo & Hughes 1998, box 3.1)."""
        trial = self.stiffness @ (strain - plastic)
        s = deviator(trial)
        q = von_mises(trial)
        share = max(0.0, 1.0 - self.yield_stress / q) if q > 0 else 0.0
        return trial - share * s, plastic + share * s * (1.0 + self.poisson) / self.young

    def along(self, path: Sequence[FlowPoint]) -> np.ndarray:
        """Plastic strain (6,) after the straight lines from point to point, the first one free of plastic
        strain. The rate equations (Prandtl-Reuss), integrated by an explicit method of order 8 between the
        moments at which flow begins and ends.
        """
        stress, plastic = self._mixed(self.stiffness, path[0])[0], np.zeros(6)
        if von_mises(stress) > self.yield_stress:
            raise ValueError("path: the film must not yield at its first point")
        for start, end in pairwise(path):
            stress, plastic = self._segment(end - start, stress, plastic)
        return plastic

    def _segment(
        self, step: FlowPoint, stress: np.ndarray, plastic: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Stress and plastic strain after a straight line, elastic and plastic parts in turn."""
        time = 0.0
        on_surface = isclose(von_mises(stress), self.yield_stress, rel_tol=RESIDUAL)
        flows = on_surface and self._rate(step, stress)[2] > 0.0
        while time < 1.0:
            time, stress, plastic = self._part(step, time, stress, plastic, flows=flows)
            flows = not flows
        return stress, plastic

    def _part(self, step: FlowPoint, time: float, stress: np.ndarray, plastic: np.ndarray, *, flows: bool):
        """Time, stress and plastic strain where the film begins or ceases to flow, or at time = 1."""
        Y, elastic = self.yield_stress, self._mixed(self.stiffness, step)[0]

        def rates(_: float, state: np.ndarray) -> np.ndarray:
            if not flows:
                return np.concatenate([elastic / Y, np.zeros(6)])
            stress_rate, plastic_rate, _ = self._rate(step, Y * state[:6])
            return np.concatenate([stress_rate / Y, plastic_rate])

        def switch(_: float, state: np.ndarray) -> float:
            return self._rate(step, Y * state[:6])[2] if flows else float(von_mises(state[:6])) - 1.0

        vars(switch).update(terminal=True, direction=-1.0 if flows else 1.0)
        state = np.concatenate([stress / Y, plastic])
        digits = {"rtol": RATE_DIGITS, "atol": RATE_DIGITS, "max_step": 0.1}
        found = solve_ivp(rates, (time, 1.0), state, "DOP853", events=switch, **digits)
        if not found.success:
            raise ArithmeticError(f"rate equations of the film: {found.message}")
        return found.t[-1], Y * found.y[:6, -1], found.y[6:, -1]

    def _rate(self, step: FlowPoint, stress: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
        """Rates of stress (6,) and plastic strain (6,) while it flows, d eps_p = factor s, and the factor."""
        C, s = self.stiffness, deviator(stress)
        into = C @ s
        tangent = C - np.outer(into, into * SHEAR) / ((s * SHEAR) @ into)
        stress_rate, strain_rate = self._mixed(tangent, step)
        factor = float((s * SHEAR) @ C @ strain_rate / ((s * SHEAR) @ into))
        return stress_rate, factor * s, factor

    def _mixed(self, matrix: np.ndarray, step: FlowPoint) -> tuple[np.ndarray, np.ndarray]:
        """Stress and strain, (6,) each, = matrix strain, from strains in the plane and stresses off it."""
        right = step.off_plane - matrix[np.ix_(OFF, PLANE)] @ step.strain
        strain = _joined(step.strain, np.linalg.solve(matrix[np.ix_(OFF, OFF)], right))
        return matrix @ strain, strain


def _joined(in_plane: np.ndarray, off_plane: np.ndarray) -> np.ndarray:
    """Six components from xx, yy, xy and zz, yz, xz."""
    tensor = np.zeros(6)
    tensor[PLANE], tensor[OFF] = in_plane, off_plane
    return tensor
