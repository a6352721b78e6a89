# SPDX-License-Identifier: MIT
"""Axisymmetric elements and point force: patch test, zero-energy modes, exact solutions, assembly by
scikit-fem.
"""

import numpy as np
import pytest
import sympy as sy
from scipy.integrate import quad
from skfem import BilinearForm, ElementQuad2, MeshQuad
from skfem.helpers import ddot, sym_grad

from fem_reference.axisymmetric.elements import AxisymmetricSolid, half_plane, surface_weights
from fem_reference.axisymmetric.planner import Core, punch_lines, smooth_lines
from fem_reference.common.bodies import Elastic
from fem_reference.common.elasticity import mises, stiffness_tensor
from fem_reference.common.far_field import boussinesq
from fem_reference.common.mesh_lines import grow

YOUNG, POISSON = 2.5, 0.3
SHEAR = YOUNG / (2 * (1 + POISSON))
LAME = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))


def patch(n=3, inner=0.0, twist=0.0, element=None, poisson=POISSON):
    """n x n elements of [inner, inner + 1] x [0, 1]; twist moves the inner nodes."""
    x = np.linspace(0.0, 1.0, n + 1)
    mesh = MeshQuad.init_tensor(inner + x, x)
    bump = twist * np.sin(np.pi * (mesh.p[0] - inner)) * np.sin(np.pi * mesh.p[1])
    return AxisymmetricSolid(
        MeshQuad(mesh.p + bump * np.array([[1.0], [-0.7]]), mesh.t), Elastic(YOUNG, poisson), element=element
    )


def solve_from_boundary(solid, exact):
    """Displacements with the exact values on the whole boundary. exact(r, z) -> (u_r, u_z)."""
    u = np.zeros(solid.size)
    r, z = solid.basis.doflocs
    component = np.zeros(solid.size, dtype=int)
    component[solid.basis.nodal_dofs[1]] = component[solid.basis.facet_dofs[1]] = 1
    values = np.where(component == 0, *exact(r, z))
    fixed = solid.basis.get_dofs().all()
    free = np.setdiff1d(np.arange(solid.size), fixed)
    u[fixed] = values[fixed]
    A = solid.stiffness.toarray()
    u[free] = np.linalg.solve(A[np.ix_(free, free)], -A[np.ix_(free, fixed)] @ u[fixed])
    return u, values


def zero_modes(solid):
    eigenvalues = np.linalg.eigvalsh(solid.stiffness.toarray())
    # rounding is about 1e-15 of the largest, the softest deformation about 1e-3 of it
    return int(np.sum(np.abs(eigenvalues) < 1e-10 * eigenvalues[-1]))


@pytest.mark.parametrize("inner", [0.0, 2.0])
@pytest.mark.parametrize("n", [2, 3])
def test_free_patch_has_one_zero_mode(n, inner):
    """Axisymmetric rigid motion is the translation along the axis and nothing else."""
    solid = patch(n, inner)
    assert zero_modes(solid) == 1
    translation = np.zeros(solid.size)
    translation[solid.basis.nodal_dofs[1]] = translation[solid.basis.facet_dofs[1]] = 1.0
    # exact up to the rounding of the assembly
    assert np.abs(solid.stiffness @ translation).max() < 1e-13 * abs(solid.stiffness).max()


def test_zero_mode_count_catches_the_nine_node_element():
    """ElementQuad2 with 2 x 2 points has three spurious modes more, so that the test above can fail."""
    assert zero_modes(patch(3, 2.0, element=ElementQuad2())) == 4


@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.49])
def test_patch_test_uniform_strain(poisson):
    """e_rr = e_tt = a, e_zz = b on distorted elements: exact up to rounding, which grows with 1/(1 - 2
    nu).
    """
    a, b, shift = 0.2, -0.5, 0.1
    solid = patch(4, 0.0, twist=0.05, poisson=poisson)
    u, exact = solve_from_boundary(solid, lambda r, z: (a * r, b * z + shift))
    assert np.abs(u - exact).max() < 1e-12
    shear, lame = YOUNG / (2 * (1 + poisson)), YOUNG * poisson / ((1 + poisson) * (1 - 2 * poisson))
    radial, axial = 2 * shear * a + lame * (2 * a + b), 2 * shear * b + lame * (2 * a + b)
    expected = np.array([radial, radial, axial, 0.0])[:, None, None]
    assert np.abs(solid.stress(u) - expected).max() < 1e-11


def refinement_order(exact, inner):
    errors = []
    for n in (2, 4, 8):
        u, values = solve_from_boundary(patch(n, inner, twist=0.05), exact)
        errors.append(np.abs(u - values).max())
    return np.log2(np.array(errors[:-1]) / errors[1:]), errors


@pytest.mark.parametrize(
    "exact",
    [
        lambda r, z: (0.3 * r + 0.7 / r, 0.0 * z),  # Lame's thick-walled tube
        lambda r, z: boussinesq(1.0, Elastic(YOUNG, POISSON), r, z + 0.5),  # point force above the patch
    ],
    ids=["lame", "boussinesq"],
)
def test_observed_order_against_exact_solutions(exact):
    """Quadratic elements: largest error of the displacements of order 3 (observed 2.99 and 2.98; errors 3e-6,
    2e-6).
    """
    orders, errors = refinement_order(exact, 1.0)
    assert orders[-1] > 2.8
    assert errors[-1] < 1e-5


def test_order_test_catches_a_wrong_far_field():
    """The same test with 1 - nu in the place of 1 - 2 nu is no elastic solution, and does not converge."""

    def wrong(r, z):
        R = np.hypot(r, z + 0.5)
        u_r, u_z = boussinesq(1.0, Elastic(YOUNG, POISSON), r, z + 0.5)
        return u_r + POISSON * (1 + POISSON) / (2 * np.pi * YOUNG) * -r / (R * (R + z + 0.5)), u_z

    orders, errors = refinement_order(wrong, 1.0)
    assert orders[-1] < 1.0
    assert errors[-1] > 1e-4


def test_stiffness_equals_the_weak_form_of_scikit_fem():
    """The same integrals by skfem's own assembly; both sum a few hundred products, hence 1e-13 of the largest
    entry.
    """
    solid = patch(3, 0.0, twist=0.05)

    @BilinearForm
    def weak_form(u, v, w):
        r = w.x[0]
        e, d = sym_grad(u), sym_grad(v)
        traces = (e[0, 0] + e[1, 1] + u[0] / r) * (d[0, 0] + d[1, 1] + v[0] / r)
        return 2 * np.pi * r * (2 * SHEAR * (ddot(e, d) + u[0] * v[0] / r**2) + LAME * traces)

    reference = weak_form.assemble(solid.basis)
    assert abs(solid.stiffness - reference).max() < 1e-13 * abs(reference).max()


def test_internal_force_is_stiffness_times_displacement():
    """Elastic: f_int(u) = K u, two orders of the same sums."""
    solid = patch(4, 0.0, twist=0.05)
    u = np.random.default_rng(7).standard_normal(solid.size)
    expected = solid.stiffness @ u
    assert np.abs(solid.internal_force(solid.stress(u)) - expected).max() < 1e-13 * np.abs(expected).max()


def test_mises_and_hooke():
    """Uniaxial: strain (-nu, -nu, 1, 0) s/E gives the stress s alone, of von Mises stress s; pure shear:
    sqrt(3) s.
    """
    stress = stiffness_tensor(YOUNG, POISSON) @ (np.array([-POISSON, -POISSON, 1.0, 0.0]) * 4.0 / YOUNG)
    assert stress == pytest.approx([0.0, 0.0, 4.0, 0.0], abs=1e-14)
    assert mises(stress) == pytest.approx(4.0, rel=1e-14)
    assert mises(np.array([0.0, 0.0, 0.0, 2.0])) == pytest.approx(2.0 * np.sqrt(3.0), rel=1e-14)


def test_surface_weights_are_integrals_of_the_shape_functions():
    """Against adaptive quadrature of each shape function on an uneven line; they sum to the area of the
    disc.
    """
    corners = np.array([0.0, 0.3, 0.5, 1.1])
    r = np.sort(np.concatenate([corners, 0.5 * (corners[:-1] + corners[1:])]))
    expected = np.zeros(r.size)
    for i in range(0, r.size - 1, 2):
        nodes = r[i : i + 3]
        for k in range(3):
            others = np.delete(nodes, k)
            shape = np.poly(others) / np.prod(nodes[k] - others)
            integrand = lambda x, s=shape: 2 * np.pi * x * np.polyval(s, x)  # noqa: E731
            expected[i + k] += quad(integrand, nodes[0], nodes[2], epsabs=1e-14)[0]
    # quadratures good to 1e-14
    assert surface_weights(r) == pytest.approx(expected, abs=1e-13)
    assert surface_weights(r)[0] == 0.0
    assert surface_weights(r).sum() == pytest.approx(np.pi * 1.1**2, rel=1e-14)


def boussinesq_symbols():
    """Stresses of the point-force displacements by differentiation, for F = 1; (r, z) -> (rr, tt, zz, rz)."""
    r, z, E, nu = sy.symbols("r z E nu", positive=True)
    R, G = sy.sqrt(r**2 + z**2), E / (2 * (1 + nu))
    ur = (r * z / R**3 - (1 - 2 * nu) * r / (R * (R + z))) / (4 * sy.pi * G)
    uz = (z**2 / R**3 + 2 * (1 - nu) / R) / (4 * sy.pi * G)
    lame = E * nu / ((1 + nu) * (1 - 2 * nu))
    e = (sy.diff(ur, r), ur / r, sy.diff(uz, z))
    normal = [2 * G * x + lame * sum(e) for x in e]
    return (r, z, E, nu), (ur, uz), (*normal, G * (sy.diff(ur, z) + sy.diff(uz, r)))


def test_point_force_is_in_equilibrium_with_its_force():
    """Balance in the body, no traction on the surface, resultant F on a plane; the code equals the
    symbols.
    """
    (r, z, E, nu), u, (rr, tt, zz, rz) = boussinesq_symbols()
    radial = sy.diff(rr, r) + sy.diff(rz, z) + (rr - tt) / r
    axial = sy.diff(rz, r) + sy.diff(zz, z) + rz / r
    at = {r: sy.Rational(7, 5), z: sy.Rational(3, 5), E: sy.Rational(5, 2), nu: sy.Rational(3, 10)}
    assert sy.simplify(radial.subs(at)) == 0 and sy.simplify(axial.subs(at)) == 0
    surface = {z: 0, E: at[E], nu: at[nu]}
    assert sy.simplify(zz.subs(surface)) == 0 and sy.simplify(rz.subs(surface)) == 0
    szz = sy.lambdify(r, (2 * sy.pi * r * zz).subs({z: at[z], E: at[E], nu: at[nu]}))
    # integrand decays as r^-4; quadrature good to 1e-10
    assert quad(szz, 0.0, np.inf, epsabs=1e-12)[0] == pytest.approx(-1.0, abs=1e-9)
    ours = boussinesq(1.0, Elastic(2.5, 0.3), np.array([1.4]), np.array([0.6]))[:, 0]
    assert ours == pytest.approx([float(x.subs(at)) for x in u], rel=1e-14)


def test_mesh_lines_at_marks():
    """At depths inside the core, equal intervals between; those nearer to one above than an eighth of an
    element are none.
    """
    z = smooth_lines(8, 10.0, Core(1.3, 0.8), (0.0, 0.3, 0.301, 0.45, 0.47, 5.0))[1]
    assert z[:9] == pytest.approx([0.0, 0.1, 0.2, 0.3, 0.375, 0.45, 0.47, 0.595, 0.72])
    assert np.diff(z).max() > 0.2 and z[-1] == pytest.approx(10.0)


@pytest.mark.parametrize("growth", [1.1, 1.2, 1.25, 1.3, 1.6, 2.2])
def test_no_interval_more_than_reaches(growth):
    """Where k of them end at the border but for rounding, they are k; a millionth further, one more."""
    for k in range(1, 40):
        length = sum(growth**j for j in range(k))
        assert [grow(0.0, length * more, 1.0, growth).size for more in (1.0, 1.0 + 1e-6)] == [k, k + 1]


@pytest.mark.parametrize("lines", [smooth_lines, punch_lines])
@pytest.mark.parametrize("cells, box", [(2, 3.0), (7, 10.0), (16, 10.0), (32, 25.0)])
def test_mesh_lines(lines, cells, box):
    """From 0 to the box, strictly ascending, a line at the contact radius, no sudden change of size outside
    it.
    """
    r, z = lines(cells, box)
    for x in (r, z):
        assert x[0] == 0.0 and x[-1] == pytest.approx(box, rel=1e-14)
        h = np.diff(x)
        assert (h > 0.0).all() and (h[1:] / h[:-1])[x[2:] > 1.0 + 1e-9].max() < 2.0
    assert np.abs(r - 1.0).min() < 1e-14
    mesh = half_plane(r, z)
    assert mesh.nelements == (r.size - 1) * (z.size - 1)
    assert {name: facets.size for name, facets in mesh.boundaries.items()} == {
        "axis": z.size - 1,
        "surface": r.size - 1,
        "far": r.size + z.size - 2,
    }
