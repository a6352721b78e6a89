# SPDX-License-Identifier: MIT
"""Derive the table of surface-load coefficients; ``PYTHONPATH=tests python -m derivations.load_table`` writes
it as JSON.

A half-space z >= 0 carries a surface traction F exp(i k x_n) (n: direction of the wave vector, t: across, z:
into the body). The decaying solution of Navier's equation, (1 - 2 nu) lap u + grad div u = 0, is

    u_n = (A + B z) e^{-kz},   u_z = (C + D z) e^{-kz},   u_t = G e^{-kz},

and sigma_zz = -F_z, sigma_nz = -F_n, sigma_tz = -F_t at z = 0 fix its constants. Rotated to (x, y) each
component becomes a sum of monomials (k z)^p n1^a n2^b with n1^2 + n2^2 = 1, and each monomial is the in-plane
transform of a derivative of 1/R, whose transform is (Love 1929; Sneddon 1951)

    d_x^a d_y^b d_z^c (1/R)  <->  (i n1)^a (i n2)^b (-1)^c k^(a+b+c) 2 pi e^{-kz}/k.

A row [p, a, b, c, [c0, c1, ...]] of the table stands for (c0 + c1 nu + ...) z^p d_x^a d_y^b d_z^c (1/R), with
the prefactor 1/(2 pi) for stresses and 1/(2 pi mu) for displacements, per unit point load.
"""

import json
from pathlib import Path

import sympy as sp

TABLE = Path(__file__).parents[2] / "sam" / "kernels" / "load_table.json"
STRESS = ("11", "22", "33", "23", "13", "12")
LOADS = ("F1", "F2", "F3")

nu, s, n1, n2 = sp.symbols("nu s n1 n2")
LAM = 2 * nu / (1 - 2 * nu)  # mu = 1


def grad(w: sp.Expr) -> sp.Matrix:
    """(d_n, d_t, d_z) of a scalar field that varies as exp(i x_n); k = 1, so that s = z."""
    return sp.Matrix([sp.I * w, 0, sp.diff(w, s)])


def stress(u: sp.Matrix) -> sp.Matrix:
    """Hooke's law, mu = 1."""
    jac = sp.Matrix.hstack(*(grad(u[j]) for j in range(3)))  # jac[i, j] = d_i u_j
    return jac + jac.T + LAM * jac.trace() * sp.eye(3)


def navier(u: sp.Matrix, decay: sp.Expr) -> list[sp.Expr]:
    """Coefficients of (1 - 2 nu) lap u + grad div u, which vanish; u: polynomials in s times decay."""
    residual = ((1 - 2 * nu) * (u.diff(s, 2) - u) + grad(grad(u[0])[0] + grad(u[2])[2])) / decay
    return [c for e in residual for c in sp.Poly(sp.expand(sp.simplify(e)), s).coeffs()]


def wave_response(f: sp.Matrix) -> tuple[sp.Matrix, sp.Matrix]:
    """Displacement times mu k and stress (3 x 3), both times e^{kz}, in the frame (n, t, z): polynomials in
    s = k z, under the traction f = (F_n, F_t, F_z).
    """
    A, B, C, D, G = consts = sp.symbols("A B C D G")
    decay = sp.exp(-s)
    u = sp.Matrix([(A + B * s) * decay, G * decay, (C + D * s) * decay])
    sigma = stress(u)
    equations = navier(u, decay) + list(sigma.subs(s, 0)[:, 2] + f)
    solution = sp.solve(equations, consts, dict=True)[0]

    def clean(m):
        return (m.subs(solution) / decay).applyfunc(lambda e: sp.expand(sp.simplify(e)))

    return clean(u), clean(sigma)


def rows(expr: sp.Expr, order: int, depths: tuple[sp.Symbol, ...] = (s,)) -> list[list]:
    """Table rows of a polynomial in depths times k, n1 and n2, times k^order and the decay; order: 0 for the
    stress of a load, -1 for a displacement, and one more per unit of eigenstrain times volume.
    """
    expr = sp.rem(sp.expand(expr), n1**2 + n2**2 - 1, n2)  # n2^2 = 1 - n1^2: one canonical form, b <= 1
    out = []
    for (*powers, a, b), coef in sp.Poly(sp.expand(expr), *depths, n1, n2).terms():
        c = sum(powers) + order + 1 - a - b
        value = sp.expand(sp.simplify(coef / (sp.I ** (a + b) * sp.Integer(-1) ** c)))
        if value != 0:
            of_nu = [str(q) for q in reversed(sp.Poly(value, nu).all_coeffs())]
            out.append([*map(int, (*powers, a, b, c)), of_nu])
    return sorted(out, key=lambda row: row[:-1])


def derive() -> dict[str, dict[str, list]]:
    """The whole table: {"stress": {"11,F1": rows, ...}, "displacement": {"1,F1": rows, ...}}."""
    # axes of (n, t, z) in (x, y, z): n = (n1, n2), t = (-n2, n1)
    rot = sp.Matrix([[n1, -n2, 0], [n2, n1, 0], [0, 0, 1]])
    table: dict[str, dict[str, list]] = {"stress": {}, "displacement": {}}
    for j, load in enumerate(LOADS):
        u, sigma = wave_response(rot.T[:, j])
        u, sigma = rot * u, rot * sigma * rot.T
        for name in STRESS:
            table["stress"][f"{name},{load}"] = rows(sigma[int(name[0]) - 1, int(name[1]) - 1], 0)
        for i in range(3):
            table["displacement"][f"{i + 1},{load}"] = rows(u[i], -1)
    return table


def as_text(table: dict[str, dict[str, list]]) -> str:
    """The table as JSON, one row a line."""
    blocks = []
    for kind, entries in table.items():
        lines = []
        for name, its_rows in entries.items():
            body = ",\n".join(f"   {json.dumps(row)}" for row in its_rows)
            lines.append(f'  "{name}": [\n{body}\n  ]')
        blocks.append(f' "{kind}": {{\n' + ",\n".join(lines) + "\n }")
    return "{\n" + ",\n".join(blocks) + "\n}\n"


if __name__ == "__main__":
    TABLE.write_text(as_text(derive()), encoding="utf-8")
