# SPDX-License-Identifier: MIT
"""Eigenstrain in a half-space by integration of Mindlin's point-force solution: an answer independent of any
table.

Source: Mindlin, Force at a point in the interior of a semi-infinite solid, Physics 7 (1936) 195-202;
Mura, Micromechanics of Defects in Solids (1987): with G_ki the displacement along k by a unit force along i,
an eigenstrain e in a volume V with outward normal n causes

    u_k = integral over V of C_ijmn e_mn dG_ki/dx'_j = integral over the surface of V of G_ki C_ijmn e_mn n_j.

The first form is a volume of point nuclei (outside V), the second one a surface of point forces (inside and
outside; inside, C e is subtracted from the stress of u). Answers are for mu = 1: stress/mu, mu times
displacement per force. Stresses are in the order 11, 22, 33, 23, 13, 12; eigenstrains likewise, with the
tensor components e_ab = e_ba = 1.
"""

import numpy as np

from .quadrature import gauss, over_rectangle

PAIRS = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))


class Jet:
    """f + f_1 a + f_2 b + f_12 a b with a^2 = b^2 = 0: a number (or array) with two exact derivatives. Fike
    and Alonso, The development of hyper-dual numbers, AIAA 2011-886.
    """

    __array_ufunc__ = None  # array * Jet is Jet * array

    def __init__(self, f, f1=0.0, f2=0.0, f12=0.0):
        self.parts = (f, f1, f2, f12)

    def __add__(self, other):
        if not isinstance(other, Jet):
            other = Jet(other)
        return Jet(*(p + q for p, q in zip(self.parts, other.parts, strict=True)))

    def __mul__(self, other):
        if not isinstance(other, Jet):
            return Jet(*(p * other for p in self.parts))
        (f, f1, f2, f12), (g, g1, g2, g12) = self.parts, other.parts
        return Jet(f * g, f1 * g + f * g1, f2 * g + f * g2, f12 * g + f1 * g2 + f2 * g1 + f * g12)

    def __pow__(self, n):
        f, f1, f2, f12 = self.parts
        slope, bend = n * f ** (n - 1), n * (n - 1) * f ** (n - 2)
        return Jet(f**n, slope * f1, slope * f2, slope * f12 + bend * f1 * f2)

    def __neg__(self):
        return self * -1

    def __sub__(self, other):
        return self + other * -1

    def __rsub__(self, other):
        return -self + other

    def __truediv__(self, other):
        return self * other**-1.0

    def __rtruediv__(self, other):
        return self**-1.0 * other

    __radd__, __rmul__ = __add__, __mul__


def mindlin_displacement(place, c, nu: float) -> list[list]:
    """G[k][i]: mu times the displacement along k at `place` by a unit force along i at (0, 0, c), c >= 0.
    place: (x, y, z), z >= 0; these and c: floats, arrays or jets. Mindlin (1936), force normal and force
    parallel to the surface.
    """
    x, y, z = place
    m, height, depth = 1 - nu, z - c, z + c
    r1, r2 = (x * x + y * y + height * height) ** 0.5, (x * x + y * y + depth * depth) ** 0.5
    k = 3 - 4 * nu
    a, b = r1**-3.0, r2**-3.0
    saddle = 6 * c * z / r2**5.0
    pole = 4 * m * (1 - 2 * nu) / (r2 + depth)

    def in_plane(w):
        """Displacement along a force parallel to the surface; w: the coordinate along it."""
        direct = k / r1 + 1 / r2 + w * w * (a + k * b - saddle) + 2 * c * z * b
        return direct + pole * (1 - w * w / (r2 * (r2 + depth)))

    across = x * y * (a + k * b - saddle - pole / (r2 * (r2 + depth)))
    down = height * a + k * height * b - saddle * depth + pole / r2  # u_z by the force along x, over x
    radial = height * a + k * height * b + saddle * depth - pole / r2  # u_x by the normal force, over x
    normal = k / r1 + (8 * m * m - k) / r2 + height * height * a + (k * depth * depth - 2 * c * z) * b
    normal = normal + saddle * depth * depth
    along = [[in_plane(x), across, x * radial], [across, in_plane(y), y * radial]]
    return [[entry / (16 * np.pi * m) for entry in line] for line in (*along, [x * down, y * down, normal])]


def _derivatives(point, c, nu: float, *, along: int | None, source: int | None) -> np.ndarray:
    """(3, 3, ...): derivative of G[k][i] along axes of the observation and of the source, None: none."""
    seeds = [
        Jet(w, float(along == axis), -float(source == axis) * (axis < 2)) for axis, w in enumerate(point)
    ]
    green = mindlin_displacement(seeds, Jet(c, 0.0, float(source == 2)), nu)
    part = (along is not None) + 2 * (source is not None)
    parts = [(entry.parts[part], np.shape(entry.parts[0])) for line in green for entry in line]
    found = np.array([np.broadcast_to(values, shape) for values, shape in parts])
    return found.reshape(3, 3, *found.shape[1:])


def _elasticity(nu: float) -> np.ndarray:
    """C_ijmn for mu = 1, nu < 1/2."""
    delta = np.eye(3)
    shear = np.einsum("im,jn->ijmn", delta, delta)
    lam = 2 * nu / (1 - 2 * nu)
    return lam * np.einsum("ij,mn->ijmn", delta, delta) + shear + shear.swapaxes(2, 3)


def eigenstress(nu: float) -> np.ndarray:
    """C e of the six unit eigenstrains, (3, 3, 6), mu = 1."""
    e = np.zeros((3, 3, 6))
    for column, (i, j) in enumerate(PAIRS):
        e[i, j, column] = e[j, i, column] = 1
    return np.tensordot(_elasticity(nu), e, 2)


def _response(gradient: np.ndarray, shift: np.ndarray, nu: float) -> np.ndarray:
    """Stress (6) over displacement (3) from the displacement and its gradient [m, k, ...]."""
    stress = np.tensordot(_elasticity(nu), gradient, 2)
    return np.concatenate([np.stack([stress[pair] for pair in PAIRS]), shift])


def point_force(place, c, nu: float) -> np.ndarray:
    """Stress (6) and displacement (3) at `place` (x, y, z) by unit forces (3) at (0, 0, c): (9, 3, ...)."""
    gradient = np.stack([_derivatives(place, c, nu, along=along, source=None) for along in range(3)])
    return _response(gradient, _derivatives(place, c, nu, along=None, source=None), nu)


def point_nucleus(place, c, nu: float) -> np.ndarray:
    """Stress (6), displacement (3) at `place` by unit eigenstrains times volume at (0, 0, c): (9, 6, ...)."""
    strength = eigenstress(nu)

    def moment(along):
        """Sum over i, j of C_ijmn e_mn dG_ki/dx'_j: [k, eigenstrain, ...]."""
        each = (_derivatives(place, c, nu, along=along, source=j) for j in range(3))
        return sum(np.tensordot(green, strength[:, j], ([1], [0])) for j, green in enumerate(each))

    fields = [moment(along) for along in (0, 1, 2, None)]
    fields = [np.moveaxis(field, -1, 1) for field in fields]
    return _response(np.stack(fields[:3]), fields[3], nu)


def cuboid_by_nuclei(place, cuboid, nu: float, order: int = 16) -> np.ndarray:
    """Stress (6) and displacement (3) at `place` by unit eigenstrains (6) in a cuboid: (9, 6). place: (x, y,
    z); cuboid: (half_x, half_y, top, bottom), the points |x| < half_x, |y| < half_y, top < z < bottom. For
    points outside, half a cuboid away or more (order^3 Gauss points). The displacement is the volume integral
    of Eq. 2 of Bosman & Schipper (2011), at z = 0 that of their Eq. 1.
    """
    (x, y, z), (half_x, half_y, top, bottom) = place, cuboid
    t, w = gauss(order)
    t1, t2, t3 = np.meshgrid(t, t, t, indexing="ij")
    weight = w[:, None, None] * w[:, None] * w * (4 * half_x * half_y * (bottom - top))
    offsets = x - half_x * (2 * t1 - 1), y - half_y * (2 * t2 - 1)
    values = point_nucleus((*offsets, z), top + (bottom - top) * t3, nu)
    return np.sum(values * weight, axis=(-3, -2, -1))


def cuboid_by_faces(place, cuboid, nu: float, order: int = 40) -> np.ndarray:
    """The same from point forces on the six faces, inside and outside; not for points on a face's plane."""
    (x, y, z), (half_x, half_y, top, bottom) = place, cuboid
    point, strength = (x, y, z - (top + bottom) / 2), eigenstress(nu)
    half = (half_x, half_y, (bottom - top) / 2)
    total = np.zeros((9, 6))
    for axis in range(3):
        first, second = (a for a in range(3) if a != axis)
        for side in (-1, 1):
            distance = point[axis] - side * half[axis]

            def force(u, v, _, *, axis=axis, first=first, second=second, distance=distance):
                offset = {axis: distance + 0 * u, first: u + 0 * v, second: v + 0 * u}
                return point_force((offset[0], offset[1], z), z - offset[2], nu)

            lies = point[first], point[second], abs(distance)
            found = over_rectangle(force, lies, (half[first], half[second]), order)
            total += side * np.tensordot(found, strength[:, axis], 1)
    if all(abs(w) < h for w, h in zip(point, half, strict=True)):
        total[:6] -= np.stack([strength[pair] for pair in PAIRS])
    return total
