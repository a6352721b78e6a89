# SPDX-License-Identifier: MIT
"""Derive the table of eigenstrain coefficients; ``PYTHONPATH=tests python -m derivations.eigenstrain_table``
writes it as JSON.

A half-space z >= 0 carries an eigenstrain e exp(i k x_n) delta(z - z') (frame n, t, z as in load_table).

1. Full space: above and below the sheet decaying solutions of Navier's equation stand, u = a polynomial of
   degree 1 in s - s' times e^{-|s - s'|}, s = k z, s' = k z'. At the sheet sigma_zz holds no delta and the
   displacement jumps by

       [u_n] = 2 e_nz,   [u_t] = 2 e_tz,   [u_z] = (lam tr e + 2 mu e_zz)/(lam + 2 mu);

   the in-plane stress of the sheet, sigma_nn = lam ([u_z] - tr e) - 2 mu e_nn and sigma_nt = -2 mu e_nt, is
   balanced by jumps of the traction, [sigma_nz] = -i sigma_nn, [sigma_tz] = -i sigma_nt, [sigma_zz] = 0.
2. Image: the response of the half-space to the opposite of the traction that this field has at z = 0
   (`wave_response`).

Rotated to (x, y), each component of the image stress is a sum of monomials (k z)^p (k z')^q n1^a n2^b, p, q
<= 1, and each of these the transform of a derivative of 1/R, R^2 = x^2 + y^2 + (z + z')^2, as said in
load_table. A row [p, q, a, b, c, [c0, c1, ...]] stands for (c0 + c1 nu + ...) z^p z'^q d_x^a d_y^b d_z^c
(1/R), per unit of eigenstrain times volume, with the prefactor mu/(8 pi (1 - nu)) for the image stress and
1/(2 pi) for the displacement of the surface (image and full space together, z = 0). The columns J = 23, 13,
12 are for the tensor components e_ab = e_ba = 1.
"""

from pathlib import Path

import sympy as sp

from derivations.load_table import LAM, STRESS, as_text, n1, n2, navier, nu, rows, s, stress, wave_response

TABLE = Path(__file__).parents[2] / "sam" / "kernels" / "eigenstrain_table.json"

s_source = sp.Symbol("s_source")  # s' = k z'
# eigenstrain in the frame (n, t, z)
E = sp.Matrix(3, 3, lambda i, j: sp.Symbol(f"e{min(i, j) + 1}{max(i, j) + 1}"))


def full_space_above() -> sp.Matrix:
    """Displacement above the sheet (s < s') that the eigenstrain E in the full space causes; mu = k = 1."""
    depth = s - s_source
    above, below = sp.symbols("A1 B1 C1 D1 G1"), sp.symbols("A2 B2 C2 D2 G2")
    fields, equations = [], []
    for (A, B, C, D, G), decay in ((above, sp.exp(depth)), (below, sp.exp(-depth))):
        u = sp.Matrix([A + B * depth, G, C + D * depth]) * decay
        fields.append(u)
        equations += navier(u, decay)
    jump = (fields[1] - fields[0]).subs(s, s_source)
    traction = (stress(fields[1]) - stress(fields[0])).subs(s, s_source)[:, 2]
    trace = E.trace()
    jump_z = (LAM * trace + 2 * E[2, 2]) / (LAM + 2)
    sheet_nn, sheet_nt = LAM * (jump_z - trace) - 2 * E[0, 0], -2 * E[0, 1]
    equations += list(jump - sp.Matrix([2 * E[0, 2], 2 * E[1, 2], jump_z]))
    equations += list(traction + sp.I * sp.Matrix([sheet_nn, sheet_nt, 0]))
    return fields[0].subs(sp.solve(equations, above + below, dict=True)[0])


def half_space_response() -> tuple[sp.Matrix, sp.Matrix]:
    """Surface displacement times e^{s'} and image stress (3 x 3) times e^{s + s'}, polynomials in s, s',
    linear in E.
    """
    full = full_space_above()
    decay = sp.exp(-s_source)
    traction = (stress(full).subs(s, 0)[:, 2] / decay).applyfunc(sp.simplify)
    surface = (full.subs(s, 0) / decay).applyfunc(sp.simplify)
    image = sp.zeros(3, 3)
    for i in range(3):  # the load F_i = +sigma_iz of the full space makes the stress -sigma_iz at z = 0
        u, sigma = wave_response(sp.eye(3)[:, i])
        image += traction[i] * sigma
        surface += traction[i] * u.subs(s, 0)
    return surface, image


def derive() -> dict[str, dict[str, list]]:
    """The whole table: {"stress": {"11,11": rows, ...}, "displacement": {"1,11": rows, ...}}."""
    # axes of (n, t, z) in (x, y, z): n = (n1, n2), t = (-n2, n1)
    rot = sp.Matrix([[n1, -n2, 0], [n2, n1, 0], [0, 0, 1]])
    surface, image = half_space_response()
    image = (image * 4 * (1 - nu)).applyfunc(sp.cancel)
    surface, image = rot * surface.applyfunc(sp.cancel), rot * image * rot.T
    table: dict[str, dict[str, list]] = {"stress": {}, "displacement": {}}
    for column in STRESS:
        i, j = int(column[0]) - 1, int(column[1]) - 1
        unit = sp.zeros(3, 3)
        unit[i, j] = unit[j, i] = 1
        in_wave_frame = dict(zip(E, rot.T * unit * rot, strict=True))
        for name in STRESS:
            component = image[int(name[0]) - 1, int(name[1]) - 1].subs(in_wave_frame)
            table["stress"][f"{name},{column}"] = rows(component, 1, (s, s_source))
        for k in range(3):
            table["displacement"][f"{k + 1},{column}"] = rows(
                surface[k].subs(in_wave_frame), 0, (s, s_source)
            )
    return table


if __name__ == "__main__":
    TABLE.write_text(as_text(derive()), encoding="utf-8")
