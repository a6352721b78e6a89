# SPDX-License-Identifier: MIT
"""The appendix of Bosman & Schipper (2011) as printed, each misprint named and shown to be one.

The forms are those of the paper with its misprints corrected. `printed` names misprints to be left in:
without any the forms have to meet an answer that is independent of them, with any one they must not.
`docs/equations.md` lists them. The answers are Mindlin's point force (`nuclei`), derivatives that sympy
takes, or the coefficients that the solver uses, which other tests hold against quadrature.
"""

from functools import cache
from itertools import permutations, product

import mpmath as mp
import numpy as np
import pytest
import sympy as sp

from sam.kernels.eigenstrain import surface_displacement_coefficients
from sam.kernels.patches import STRESS, Cuboids, Lags, displacement_coefficients, stress_coefficients
from verification.reference.nuclei import PAIRS, point_nucleus

HX, HY, NU = 1.0, 0.7, 0.3
# of the largest value: sums of ten terms of either sign, differenced over four or eight corners
ROUNDING = 1e-11
WRONG = 1e-3  # of it: what any of the misprints changes, by far


# --- D_33, D_31, Eq. 20 and 21: a loaded rectangle ---


def over_corners(form, i: int, j: int, *z: float) -> np.ndarray:
    """A form summed with signs over the corners of a cell i, j cells away, and over two depths if given."""
    total = 0.0
    for (sx, sy), depth in product(product((-1, 1), repeat=2), range(len(z))):
        sign = sx * sy * (1 if depth == len(z) - 1 else -1)
        total = total + sign * np.array(form((i + sx / 2) * HX, (j + sy / 2) * HY, z[depth]))
    return total


def printed_d33(x: float, y: float, a: float, b: float) -> float:
    """The bracket of D_33."""
    pp, pm, mp, mm = (np.hypot(y + s * b, x + t * a) for s, t in ((1, 1), (1, -1), (-1, 1), (-1, -1)))
    return (
        (x + a) * np.log((y + b + pp) / (y - b + mp))
        + (y + b) * np.log((x + a + pp) / (x - a + pm))
        + (x - a) * np.log((y - b + mm) / (y + b + pm))
        + (y - b) * np.log((x - a + mm) / (x + a + mp))
    )


def printed_d31(x: float, y: float, a: float, b: float) -> float:
    """The bracket of D_31."""
    xp, xm, yp, ym = x + a, x - a, y + b, y - b
    return (
        yp * np.log(np.hypot(xp, yp) / np.hypot(xm, yp))
        + ym * np.log(np.hypot(xm, ym) / np.hypot(xp, ym))
        + xp * (np.arctan(yp / xp) - np.arctan(ym / xp))
        + xm * (np.arctan(ym / xm) - np.arctan(yp / xm))
    )


@pytest.mark.parametrize("lag", [(1, 1), (3, 2), (0, 4)])
def test_brackets_of_d33_and_d31(lag):
    """mu (1 - nu^2)/(pi E) is (1 - nu)/(2 pi); D_33 as printed, with 1/(pi E), is larger by 1/(1 - nu^2)."""
    x, y = lag[0] * HX, lag[1] * HY
    n = lag[0] + 1, lag[1] + 1
    normal, tangential = (
        displacement_coefficients(Lags(*n, HX, HY), NU, component=3, load=load)[-1, -1] for load in (3, 1)
    )
    bracket = printed_d33(x, y, HX / 2, HY / 2)
    assert (1 - NU) / (2 * np.pi) * bracket == pytest.approx(normal, rel=ROUNDING)
    as_printed = bracket / (np.pi * 2 * (1 + NU))  # mu/(pi E)
    assert as_printed == pytest.approx(normal / (1 - NU**2), rel=ROUNDING)
    bracket = printed_d31(x, y, HX / 2, HY / 2)
    assert (1 - 2 * NU) / (4 * np.pi) * bracket == pytest.approx(tangential, rel=ROUNDING, abs=1e-15)


def normal_load(x: float, y: float, z: float, printed=frozenset()) -> list[float]:
    """S_ij3 of Eq. 20 without a factor, in the order of STRESS."""
    r, m = np.sqrt(x * x + y * y + z * z), 1 - NU if "1 - nu" in printed else 1 - 2 * NU
    angle, saddle = np.arctan((z * z + y * y - r * y) / (z * x)), x * y * z / r
    return [
        2 * NU * angle + 2 * m * np.arctan((r - y + z) / x) + saddle / (x * x + z * z),
        2 * NU * angle + 2 * m * np.arctan((r - x + z) / y) + saddle / (y * y + z * z),
        angle - saddle * (1 / (x * x + z * z) + 1 / (y * y + z * z)),
        z * z * x / (r * (y * y + z * z)),
        z * z * y / (r * (x * x + z * z)),
        -z / r - (1 - 2 * NU) * np.log(r + z),
    ]


def tangential_load(x: float, y: float, z: float, printed=frozenset()) -> list[float]:
    """S_ij1 of Eq. 21 without a factor, in the order of STRESS."""
    r = np.sqrt(x * x + y * y + z * z)
    across = x * x + (y * y if "131" in printed else z * z)
    s331 = x * y * y * r if "331" in printed else z * z * y
    return [
        -z / r * (1 + (y * z - x * x) / ((r + z) * (r - y))) + 2 * NU * y / (r + z) - 2 * np.log(r - y),
        -y * z / (r * (r + z)) - 2 * NU * (y / (r + z) + np.log(r - y)),
        s331 / (r * (x * x + z * z)),
        -z / r,
        x * y * z / (r * across) + np.arctan((z * z + y * y - y * r) / (x * z)),
        -z * x / (r * (r + z)) - 2 * NU * x / (r + z) - np.log(r - x),
    ]


@pytest.mark.parametrize(("i", "j", "z"), [(3, 2, 0.5), (1, 1, 0.2)])
@pytest.mark.parametrize(
    ("form", "load", "misprints"),
    [(normal_load, 3, {"1 - nu": ["11", "22"]}), (tangential_load, 1, {"331": ["33"], "131": ["13"]})],
)
def test_stress_under_a_patch(form, load, misprints, i, j, z):
    """With the factor 1/(2 pi), which is not printed; each misprint is seen in its components."""
    answer = stress_coefficients(Lags(i + 1, j + 1, HX, HY), z, NU, load=load)[:, 0, i, j]
    scale = np.abs(answer).max()
    assert np.abs((over_corners(form, i, j, z) / (2 * np.pi)) - answer).max() < ROUNDING * scale
    for name, components in misprints.items():
        wrong = over_corners(lambda *at, name=name: form(*at, {name}), i, j, z) / (2 * np.pi)
        seen = [STRESS[k] for k in np.flatnonzero(np.abs(wrong - answer) > WRONG * scale)]
        assert seen == components


# --- Eq. 26 to 30: derivatives of phi, R and psi ---

ZETA = sp.symbols("zeta1:4")
RADIUS = sp.sqrt(sum(each**2 for each in ZETA))
PSI_OF_ZETA = sp.log(RADIUS + ZETA[2])
SIMPLE = {"phi": 1 / RADIUS, "R": RADIUS, "psi": PSI_OF_ZETA, "z psi": ZETA[2] * PSI_OF_ZETA}
AT = 0.7, -0.4, 1.3


class Corner:
    """U, V, W and X of Eq. 27 to 30 at a point; z: its three coordinates, numbers of mpmath."""

    def __init__(self, z: tuple):
        self.z, self.r = z, mp.sqrt(sum(each**2 for each in z))

    def U(self, k: int):
        n, j = (m for m in range(3) if m != k)
        return mp.atan(self.z[n] * self.z[j] / (self.z[k] * self.r))

    def V(self, k: int):
        return 1 / (self.r * (self.r + self.z[k]))

    def W(self, k: int):
        return (2 * self.r + self.z[k]) / (self.r**3 * (self.r + self.z[k]) ** 2)

    def X(self, k: int):
        """Its index j, which is not said, is the third axis: k and l are 1 and 2."""
        return mp.atan(self.z[k] / (self.r + self.z[1 - k] + self.z[2]))


def any_axis(at: Corner, axes: tuple[int, int, int], printed: str) -> dict:
    """(function, indices of its derivative) -> (factor of the left side, printed integral); axes: k, l, j."""
    (k, n, j), r, U, V, W = axes, at.r, at.U, at.V, at.W
    a, b, c = (at.z[axis] for axis in axes)
    ln_n, ln_j = mp.log(r + b), mp.log(r + c)
    return {
        ("phi", (k,)): (1, c * ln_n + b * ln_j - a * U(k)),
        ("phi", (k, n)): (1, ln_j),
        ("phi", (k, k)): (1, -U(k)),
        ("phi", (k, k, k)): (1, -c * V(n) - b * V(j)),
        ("phi", (k, k, n)): (1, a * V(k if printed == "phi_,kkl" else j)),
        ("phi", (0, 1, 2, k)): (1, -a / r**3),
        ("phi", (k, k, n, n)): (1, -a * b * W(j)),
        ("phi", (k, k, k, k)): (1, b * a * W(j) + a * c * W(n)),
        ("phi", (k, k, k, n)): (1, V(j) - a**2 * W(j)),
        ("R", (k, k, n)): (1, a * ln_j),
        ("R", (k, k, k)): (1, c * ln_n + b * ln_j - 2 * a * U(k)),
        ("R", (0, 1, 2, k)): (1, a / r),
        ("R", (k, k, k, n)): (1, ln_j + a**2 * V(j)),
        ("R", (k, k, n, n)): (1, a * b * V(j)),
        ("R", (k, k, k, k)): (1, -c * a * V(n) - b * a * V(j) - 2 * U(k)),
        ("R", (0, 1, 2, k, n)): (1, -a * b / r**3),
    }


def in_plane(at: Corner, axes: tuple[int, int], printed: str) -> dict:
    """The same for psi and zeta_3 psi; axes: k and l, which are 1 and 2."""
    (k, n), z, r, U, V, W = axes, at.z[2], at.r, at.U, at.V, at.W
    a, b = (at.z[axis] for axis in axes)
    ln_n, ln_z, square = mp.log(r + b), mp.log(r + z), a**2 + z**2
    angle = U(k) if printed == "U for 2 X" else 2 * at.X(k)
    power = b if printed == "4 (zeta_3 psi)_,kkkl" else b**2
    kkk = 2 * b * ln_z - z * square * V(n) - z * b * (z - r) * V(2) - 4 * a * U(k)
    bracket = b * (z - r) * W(2) - 6 * V(n) + square * W(n)
    kkkl = 2 * ln_z + (3 * a**2 - 2 * z**2) * V(2) + z * power * (z - r) * W(2)
    return {
        ("psi", (k, k)): (1, -a * ln_n - z * angle),
        ("psi", (0, 1)): (1, z * ln_z - r),
        ("psi", (k, k, k)): (
            1 if printed == "psi_,kkk" else 2,
            -2 * ln_n - square * V(n) - (z - r) * b * V(2),
        ),
        ("psi", (k, k, n)): (1, -a / (r + z)),
        ("z psi", (k, k, k)): (4, kkk),
        ("z psi", (k, k, n)): (2, a * ln_z - a * z / (r + z)),
        ("z psi", (k, k, n, n)): (2, a * b * V(2) + a * b * z / ((r + z) ** 2 * r)),
        ("z psi", (k, k, k, k)): (4, V(2) * b * a * (z / r - 2) + z * a * bracket - 4 * U(k)),
        ("z psi", (k, k, k, n)): (4, kkkl + (b**2 * r + square * z) / r**3),
    }


@cache
def derivative(function: str, indices: tuple[int, ...]) -> float:
    """Of one of the simple functions at a point."""
    expression = sp.diff(SIMPLE[function], *(ZETA[m] for m in indices))
    return float(expression.subs(dict(zip(ZETA, AT, strict=True))))


def misses(rows, axes: tuple[int, ...], printed: str = "") -> list[tuple]:
    """The rows whose d_1 d_2 d_3 is not the derivative that they are the triple integral of."""

    def off(name) -> float:
        def integral(*z):
            factor, printed_integral = rows(Corner(z), axes, printed)[name]
            return printed_integral / factor

        return float(mp.diff(integral, AT, (1, 1, 1))) - derivative(name[0], tuple(sorted(name[1])))

    with mp.workdps(30):
        return [name for name in rows(Corner(AT), axes, printed) if abs(off(name)) > 1e-10]


def test_integrals_of_phi_and_r():
    for axes in permutations(range(3)):
        k, n, _ = axes
        assert misses(any_axis, axes) == [] and misses(any_axis, axes, "phi_,kkl") == [("phi", (k, k, n))]


def test_integrals_of_psi():
    """The last line names no misprint: the angle of Eq. 30 is needed, that of Eq. 27 does not do."""
    for axes in ((0, 1), (1, 0)):
        k, n = axes
        assert misses(in_plane, axes) == [] and misses(in_plane, axes, "psi_,kkk") == [("psi", (k, k, k))]
        assert misses(in_plane, axes, "4 (zeta_3 psi)_,kkkl") == [("z psi", (k, k, k, n))]
        assert misses(in_plane, axes, "U for 2 X") == [("psi", (k, k))]


# --- Eq. 19: the surface over a cuboid ---


def surface_forms(x: float, y: float, z: float, printed=frozenset()) -> list[float]:
    """The bracket of Eq. 19 at a corner for six unit eigenstrains, with the integrals of Eq. 26, 27, 30."""
    r, d = np.sqrt(x * x + y * y + z * z), 1 - 2 * NU
    lx, ly, lz = np.log(r + x), np.log(r + y), np.log(r + z)
    ux, uy, uz = np.arctan(y * z / (x * r)), np.arctan(x * z / (y * r)), np.arctan(x * y / (z * r))
    phi_1, phi_2, phi_3 = y * lz + z * ly - x * ux, x * lz + z * lx - y * uy, x * ly + y * lx - z * uz
    psi_11 = -x * ly - 2 * z * np.arctan(x / (r + y + z))
    psi_22 = -y * lx - 2 * z * np.arctan(y / (r + x + z))
    factor = 2 - 3 if "2 - 3" in printed else 2 * NU - 3
    return [
        d * psi_11 + x * ly - 2 * NU * phi_3,
        d * psi_22 + y * lx - 2 * NU * phi_3,
        factor * phi_3 + (phi_3 - z * uz) - 2 * NU * phi_3,
        -2 * (z * lx - phi_2),
        -2 * (z * ly - phi_1),
        2 * (d * (z * lz - r) + r),
    ]


@pytest.mark.parametrize(("i", "j", "faces"), [(1, 2, (0.3, 0.9)), (4, 1, (2.0, 2.5))])
def test_surface_over_a_cuboid(i, j, faces):
    """As printed, with 1/pi for 1/(2 pi), it is twice too large; eps_33 has (2 - 3) for (2 nu - 3)."""
    answer = surface_displacement_coefficients(Cuboids(Lags(i + 1, j + 1, HX, HY), tuple(faces), NU))[
        :, 0, i, j
    ]
    scale = np.abs(answer).max()
    found = -over_corners(surface_forms, i, j, *faces) / (2 * np.pi)
    assert np.abs(found - answer).max() < 10 * ROUNDING * scale
    assert np.abs(-over_corners(surface_forms, i, j, *faces) / np.pi / answer - 2).max() < 1e-8
    wrong = -over_corners(lambda *at: surface_forms(*at, {"2 - 3"}), i, j, *faces) / (2 * np.pi)
    assert np.flatnonzero(np.abs(wrong - answer) > WRONG * scale).tolist() == [2]


# --- Eq. 22 to 25: stress and displacement of a nucleus of eigenstrain ---

x, y, z = POINT = sp.symbols("x y z")
SOURCE, PLACE = 1.1, (0.7, -0.4, 0.6)
D = 1 - 2 * NU
R_IMAGE, R_FULL = (sp.sqrt(x**2 + y**2 + (z + s * SOURCE) ** 2) for s in (1, -1))
PHI, PHI_FULL, PSI = 1 / R_IMAGE, 1 / R_FULL, sp.log(R_IMAGE + z + SOURCE)


def d(expression: sp.Expr, indices: str) -> sp.Expr:
    return sp.diff(expression, *(POINT[int(k) - 1] for k in indices))


def eq22(e: dict, i: int) -> sp.Expr:
    """f_i,jj/C for i = 1, 2."""
    plus = sum(2 * e[k, i] * (d(PHI_FULL, str(k)) + d(PHI, str(k))) for k in (1, 2))
    return plus + 2 * e[3, i] * (d(PHI_FULL, "3") - d(PHI, "3"))


def eq23(e: dict, printed: str = "") -> sp.Expr:
    """f_3,jj/C."""
    trace = 1 if printed == "23 trace" else e[1, 1] + e[2, 2] + e[3, 3]
    phi_13 = 1 if printed == "23 eps_13" else d(PHI, "13")
    in_11 = d(PHI, "22" if printed == "23 eps_11" else "11")
    return (
        2 * e[1, 3] * (d(PHI_FULL, "1") + 4 * z * phi_13 - 4 * d(R_IMAGE, "133") + 3 * d(PHI, "1"))
        + 2 * e[2, 3] * (d(PHI_FULL, "2") + 4 * z * d(PHI, "23") - 4 * d(R_IMAGE, "233") + 3 * d(PHI, "2"))
        + 8 * e[1, 2] * (-z * d(PHI, "12") + d(R_IMAGE, "123") + D * d(PSI, "12"))
        + 4 * e[1, 1] * (-z * in_11 + d(R_IMAGE, "113") + D * d(PSI, "11"))
        + 4 * e[2, 2] * (-z * d(PHI, "22") + d(R_IMAGE, "223") + D * d(PSI, "22"))
        + 2 * e[3, 3] * (d(PHI_FULL, "3") - 2 * z * d(PHI, "33") + 2 * d(R_IMAGE, "333"))
        - 2 * e[3, 3] * (5 - 4 * NU) * d(PHI, "3")
        - 8 * NU * trace * d(PHI, "3")
    )


def eq24(e: dict, printed: str = "") -> sp.Expr:
    """f_m,jjm/C."""
    total = -8 * NU * (e[1, 1] + e[2, 2] + e[3, 3]) * d(PHI, "33")
    for k in ("1", "2"):
        factor = 1 if printed == "24 eps_23" and k == "2" else 3
        part = d(PHI_FULL, k + "3") - 2 * d(R_IMAGE, k + "333") + 2 * z * d(PHI, k + "33")
        total += 4 * e[int(k), 3] * (part + factor * d(PHI, k + "3"))
    for k, factor in (("12", 4 * e[1, 2]), ("11", 2 * e[1, 1]), ("22", 2 * e[2, 2])):
        part = d(PHI_FULL, k) + 2 * d(R_IMAGE, k + "33") - 2 * z * d(PHI, k + "3")
        total += factor * (part + (1 - 4 * NU) * d(PHI, k))
    part = d(PHI_FULL, "33") + 2 * d(R_IMAGE, "3333") - 2 * z * d(PHI, "333") - (7 - 4 * NU) * d(PHI, "33")
    return total + 2 * e[3, 3] * part


def eq25(e: dict, printed: str = "") -> sp.Expr:
    """f_j,j/C."""
    m, trace = 1 - NU, e[1, 1] + e[2, 2] + e[3, 3]
    total = -2 * NU * trace * (PHI_FULL + (3 - 4 * NU) * PHI + 2 * z * d(PHI, "3"))
    for k in ("1", "2"):
        part = d(R_FULL, k + "3") - (3 - 4 * NU) * d(R_IMAGE, k + "3") + 4 * m * z * d(PHI, k)
        total += 2 * e[int(k), 3] * (part - 2 * z * d(R_IMAGE, k + "33") + 2 * z**2 * d(PHI, k + "3"))
    for k, factor in (("12", 2 * e[1, 2]), ("11", e[1, 1]), ("22", e[2, 2])):
        sign = -1 if printed == "25 eps_12" and k == "12" else 1
        third = d(R_IMAGE, "2213" if printed == "25 eps_22" and k == "22" else k + "3")
        part = d(R_FULL, k) + sign * (1 - 2 * D**2) * d(R_IMAGE, k)
        part += 4 * m * D * (z + SOURCE) * d(PSI, k)
        total += factor * (part + 2 * z * third - 2 * z**2 * d(PHI, k))
    sign = 1 if printed == "25 eps_33" else -1
    part = d(R_FULL, "33") + (3 - 4 * NU) * d(R_IMAGE, "33") + sign * 8 * m * z * d(PHI, "3")
    part += -4 * m * D * PHI + 2 * z * d(R_IMAGE, "333") - 2 * z**2 * d(PHI, "33")
    return total + e[3, 3] * part


def unit(column: int) -> dict:
    e = {(i, j): 0 for i in (1, 2, 3) for j in (1, 2, 3)}
    i, j = PAIRS[column]
    e[i + 1, j + 1] = e[j + 1, i + 1] = 1
    return e


def numbers(*expressions) -> np.ndarray:
    return np.array(sp.lambdify(POINT, expressions, cse=True)(*PLACE))


def displacement(e: dict, printed: str = "") -> np.ndarray:
    """2 mu u_i = 2 (1 - nu) f_i,jj - f_j,ji with C = -mu/(4 pi (1 - nu)), which is not printed; times mu."""
    laplacian, divergence = [eq22(e, 1), eq22(e, 2), eq23(e, printed)], eq25(e, printed)
    parts = [(1 - NU) * each - d(divergence, str(k)) / 2 for k, each in enumerate(laplacian, 1)]
    return numbers(*parts) * -1 / (4 * np.pi * (1 - NU))


MISPRINTS = {
    "23 eps_13": [4],
    "23 eps_11": [0],
    "23 trace": [3, 4, 5],
    "25 eps_12": [5],
    "25 eps_22": [1],
    "25 eps_33": [2],
}
"""Misprints of Eq. 23 and 25, and the columns of STRESS (eigenstrains) that they spoil."""


def test_displacement_of_a_nucleus():
    """Eq. 22, 23 and 25 against Mindlin's point force, and what each misprint spoils."""
    answer = point_nucleus(PLACE, SOURCE, NU)[6:]
    for column in range(6):
        e, scale = unit(column), np.abs(answer[:, column]).max()
        assert np.abs(displacement(e) - answer[:, column]).max() < ROUNDING * scale
        for name, spoiled in MISPRINTS.items():
            if column in spoiled:
                assert np.abs(displacement(e, name) - answer[:, column]).max() > WRONG * scale, name


@pytest.mark.parametrize("column", range(6))
def test_derivatives_of_f_agree(column):
    """d_m of Eq. 22 and 23 is Eq. 24, and so is the Laplacian of Eq. 25; eps_23 of Eq. 24 is misprinted."""
    e = unit(column)
    by_parts = d(eq22(e, 1), "1") + d(eq22(e, 2), "2") + d(eq23(e), "3")
    divergence = eq25(e)
    laplacian = sum(d(divergence, k) for k in ("11", "22", "33"))
    first, second, right, wrong = numbers(by_parts, laplacian, eq24(e), eq24(e, "24 eps_23"))
    assert (first, second) == pytest.approx((right, right), rel=ROUNDING, abs=ROUNDING)
    assert (abs(wrong - right) > WRONG) == (STRESS[column] == "23")


@pytest.mark.parametrize("column", [2, 4])
def test_stress_of_a_nucleus(column):
    """nu f_k,kmm delta_ij - f_k,kij + (1 - nu)(f_i,kkj + f_j,kki) outside, with the indices put right."""
    e = unit(column)
    laplacian, divergence = [eq22(e, 1), eq22(e, 2), eq23(e)], eq25(e)
    parts = []
    for i, j in PAIRS:
        part = (1 - NU) * (d(laplacian[i], str(j + 1)) + d(laplacian[j], str(i + 1)))
        parts.append(part - d(divergence, f"{i + 1}{j + 1}") + (NU * eq24(e) if i == j else 0))
    answer = point_nucleus(PLACE, SOURCE, NU)[:6, column]
    found = numbers(*parts) * -1 / (4 * np.pi * (1 - NU))
    assert np.abs(found - answer).max() < ROUNDING * np.abs(answer).max()


# --- Eq. 10 ---


@pytest.mark.parametrize("sign", [1, -1])
def test_signs_of_the_conjugate_gradients(sign):
    """With d_k where it is missing; with the printed d = -r + beta d (sign -1) the directions are not
    conjugate, and eight steps do not solve eight equations.
    """
    root = np.random.default_rng(2).standard_normal((8, 8))
    matrix, right = root @ root.T + 8 * np.eye(8), np.ones(8)
    p, r = np.zeros(8), -right  # r = matrix p - right, the gap
    direction = sign * r
    for _ in range(8):
        alpha = (r @ r) / (direction @ matrix @ direction)
        p, last, r = p - alpha * direction, r, r - alpha * matrix @ direction
        direction = sign * r + (r @ r) / (last @ last) * direction
    error = np.abs(matrix @ p - right).max()
    assert error < 1e-10 if sign == 1 else error > 1e-2
