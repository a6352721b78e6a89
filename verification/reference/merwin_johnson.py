# SPDX-License-Identifier: MIT
"""A cylinder that rolls over a perfectly plastic body again and again, by Merwin & Johnson, Proc. Instn Mech.
Engrs 177 (1963) 676: their assumptions, integrated here.

The strains of a pass are those of the elastic contact (Hertz, plane strain), at each depth by itself. The
stresses follow along them by Prandtl and Reuss. On a long track equilibrium leaves sxx and syy alone, which
depend on the depth: what remains of szz and sxz after a pass is released, elastically, without strain along x
and y. Bhargava, Hahn & Rubin, J. Appl. Mech. 52 (1985) 75, whose finite elements lack these assumptions,
found five times the plastic shear.
"""

import numpy as np

from .checks import positive
from .hertz_line import LineContact
from .stress import deviator

FAR, STEPS = 12.0, 1200  # half-widths before and behind the load, and steps in between, dense below it
XZ = 4  # its place in the record of the stress


def plastic_shear(over_shear: float, depth, *, nu: float, passes: int) -> tuple[np.ndarray, np.ndarray]:
    """Of each pass of a load that moves along +x, over k/G, (passes, n): the plastic shear strain it adds,
    positive where the surface is carried backwards, against the motion of the load; and sqrt(3) times the
    accumulated plastic strain that it adds, which of shear alone is the way of that shear to and fro.

    over_shear: p0 over the shear yield stress k; depth: (n,) in half-widths; nu: Poisson's ratio.
    """
    line = LineContact(1.0, 1.0, 1.0, 1.0)
    a = line.contact_radius
    x = np.sinh(np.linspace(1.0, -1.0, STEPS + 1) * np.arcsinh(FAR))[:, None]
    elastic = line.stress(x * a, np.asarray(depth) * a, nu) / line.peak_pressure
    elastic = positive("over_shear", over_shear) * np.pad(elastic, ((1, 1), (0, 0), (0, 0)))
    stress, added, ways = np.zeros_like(elastic[0]), [], []
    for _ in range(passes):
        strain, way = np.zeros_like(stress), np.zeros(len(stress))
        for step in np.diff(elastic, axis=0):
            flow = _beyond(stress := stress + step)
            stress, strain, way = stress - flow, strain + flow, way + _shear_of(flow)
        free = np.zeros_like(stress)
        free[:, [2, XZ]] = -stress[:, [2, XZ]]
        free[:, :2] = nu / (1.0 - nu) * free[:, 2:3]
        stress = stress + free
        added.append(strain[:, XZ])
        ways.append(way)
    return np.array(added), np.array(ways)


def _shear_of(deviators: np.ndarray) -> np.ndarray:
    """sqrt(s:s/2): k on the yield surface; of 2 G times a plastic strain sqrt(3) G times its equivalent."""
    return np.sqrt((deviators[..., :3] ** 2).sum(-1) / 2.0 + (deviators[..., 3:] ** 2).sum(-1))


def _beyond(stress: np.ndarray) -> np.ndarray:
    """By how much the deviators lie outside of the yield surface k = 1, radially: 2 G times the plastic
    strain of the step.
    """
    s = deviator(stress)
    return s * (1.0 - 1.0 / np.maximum(_shear_of(s), 1.0))[..., None]
