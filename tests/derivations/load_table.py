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

nu, s, k, z, n1, n2 = sp.symbols("nu s k z n1 n2")


def wave_response(f: sp.Matrix) -> tuple[sp.Matrix, sp.Matrix]:
    """Displacement times mu k and stress (3 x 3), both times e^{kz}, in the frame (n, t, z).

    f: the traction (F_n, F_t, F_z). Both are polynomials in s = k z. Unit wave number, so that s = z; unit
    mu.
    """
    consts = sp.symbols("A B C D G")
    A, B, C, D, G = consts
    decay = sp.exp(-s)
    u = sp.Matrix([(A + B * s) * decay, G * decay, (C + D * s) * decay])

    def grad(w):
        """(d_n, d_t, d_z) of a scalar field that varies as exp(i x_n)."""
        return sp.Matrix([sp.I * w, 0, sp.diff(w, s)])

    div = grad(u[0])[0] + grad(u[2])[2]
    navier = ((1 - 2 * nu) * (u.diff(s, 2) - u) + grad(div)) / decay
    equations = [c for e in navier for c in sp.Poly(sp.expand(sp.simplify(e)), s).coeffs()]
    jac = sp.Matrix.hstack(*(grad(u[j]) for j in range(3)))  # jac[i, j] = d_i u_j
    sigma = jac + jac.T + 2 * nu / (1 - 2 * nu) * div * sp.eye(3)
    at_surface = sigma.subs(s, 0)
    equations += [at_surface[i, 2] + f[i] for i in range(3)]
    solution = sp.solve(equations, consts, dict=True)[0]

    def clean(m):
        return (m.subs(solution) / decay).applyfunc(lambda e: sp.expand(sp.simplify(e)))

    return clean(u), clean(sigma)


def rows(expr: sp.Expr, order: int) -> list[list]:
    """Table rows of a polynomial in (s, n1, n2) times k^order e^{-kz}; order: 0 for stress, -1 for
    displacement.
    """
    expr = sp.rem(sp.expand(expr), n1**2 + n2**2 - 1, n2)  # n2^2 = 1 - n1^2: one canonical form, b <= 1
    out = []
    for (p, a, b), coef in sp.Poly(sp.expand(expr), s, n1, n2).terms():
        c = p + order + 1 - a - b
        value = sp.expand(sp.simplify(coef / (sp.I ** (a + b) * sp.Integer(-1) ** c)))
        if value != 0:
            powers = [str(q) for q in reversed(sp.Poly(value, nu).all_coeffs())]
            out.append([int(p), int(a), int(b), int(c), powers])
    return sorted(out, key=lambda row: row[:4])


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


def main() -> None:
    TABLE.write_text(as_text(derive()), encoding="utf-8")


if __name__ == "__main__":
    main()
