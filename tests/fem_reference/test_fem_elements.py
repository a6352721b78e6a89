# SPDX-License-Identifier: MIT
"""Elements: patch tests, assembly by scikit-fem, mesh lines, nodal forces and areas, far fields."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.sparse.linalg import spsolve
from skfem import Basis, BilinearForm, ElementHex1, ElementVector, MeshHex, MeshQuad
from skfem.helpers import ddot, sym_grad
from skfem.models.elasticity import lame_parameters, linear_elasticity

from fem_reference.axisymmetric.model import hertz_forces as ring_forces
from fem_reference.axisymmetric.planner import Core, punch_lines, smooth_lines
from fem_reference.common.bodies import Elastic
from fem_reference.common.elasticity import stiffness_tensor
from fem_reference.common.far_field import slanted
from fem_reference.common.mesh_lines import Sizes, coated_depths, grow, two_sided
from fem_reference.common.plasticity import J2, History
from fem_reference.common.quadrilaterals import AxisymmetricSolid, PlaneSolid, surface_weights, tensor_mesh
from fem_reference.common.recovery import continued
from fem_reference.spatial import area as areas
from fem_reference.spatial.hexahedra import HexSolid
from fem_reference.spatial.surface import hertz_forces
from sam.scene.yield_curve import Linear
from verification.reference.point_loads import boussinesq_displacement, cerruti_displacement

YOUNG, POISSON = 2.5, 0.3
SHEAR = YOUNG / (2 * (1 + POISSON))
LAME = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))


def ring(n=3, twist=0.05, poisson=POISSON):
    """n x n elements of [0, 1] x [0, 1]; twist moves the inner nodes."""
    x = np.linspace(0.0, 1.0, n + 1)
    mesh = MeshQuad.init_tensor(x, x)
    bump = twist * np.prod(np.sin(np.pi * mesh.p), axis=0)
    mesh = MeshQuad(mesh.p + bump * np.array([[1.0], [-0.7]]), mesh.t)
    return AxisymmetricSolid(mesh, Elastic(YOUNG, poisson))


def cube(n=2, twist=0.08, **options):
    """n^3 elements of the unit cube, the inner nodes moved."""
    x = np.linspace(0.0, 1.0, n + 1)
    mesh = MeshHex.init_tensor(x, x, x)
    bump = twist * np.prod(np.sin(np.pi * mesh.p), axis=0)
    mesh = MeshHex(mesh.p + bump * np.array([[1.0], [-0.7], [0.4]]), mesh.t)
    return HexSolid(mesh, Elastic(YOUNG, POISSON), **options)


def solved_from_boundary(solid, exact):
    """Displacements with the exact values (n_dofs,) on the whole boundary."""
    fixed = solid.basis.get_dofs().all()
    free, K = np.setdiff1d(np.arange(solid.size), fixed), solid.stiffness.tocsc()
    u = np.where(np.isin(np.arange(solid.size), fixed), exact, 0.0)
    u[free] = spsolve(K[free][:, free], -K[free][:, fixed] @ u[fixed])
    return u


@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.49])
def test_patch_of_rings_is_exact_under_uniform_strain(poisson):
    """e_rr = e_tt = a, e_zz = b on distorted elements, up to rounding, which grows with 1/(1 - 2 nu)."""
    a, b, shift = 0.2, -0.5, 0.1
    solid = ring(4, poisson=poisson)
    r, z = solid.basis.doflocs
    radial = np.isin(np.arange(solid.size), solid.basis.get_dofs(elements=True).all("u^1"))
    exact = np.where(radial, a * r, b * z + shift)
    u = solved_from_boundary(solid, exact)
    assert np.abs(u - exact).max() < 1e-12
    shear, lame = YOUNG / (2 * (1 + poisson)), YOUNG * poisson / ((1 + poisson) * (1 - 2 * poisson))
    radial, axial = 2 * shear * a + lame * (2 * a + b), 2 * shear * b + lame * (2 * a + b)
    expected = np.array([radial, radial, axial, 0.0])[:, None, None]
    assert np.abs(solid.stress(u) - expected).max() < 1e-11
    force = solid.internal_force(solid.stress(u))
    assert np.abs(force - solid.stiffness @ u).max() < 1e-13 * np.abs(force).max()


SECTION = PlaneSolid(ring(4).basis.mesh, Elastic(YOUNG, POISSON))


@pytest.mark.parametrize("solid", [cube(3), SECTION], ids=["hexahedra", "plane strain"])
def test_patch_is_exact_under_uniform_strain(solid):
    gradient = np.array([[1.0, 0.3, -0.2], [0.1, -0.5, 0.4], [0.25, 0.6, 0.8]])
    axes = (0, 2) if solid is SECTION else (0, 1, 2)
    exact, places = np.zeros(solid.size), solid.basis.doflocs
    for k, row in enumerate(axes):
        dofs = solid.basis.get_dofs(elements=True).all(f"u^{k + 1}")
        exact[dofs] = gradient[row, axes] @ places[:, dofs]
    u = solved_from_boundary(solid, exact)
    assert np.abs(u - exact).max() < 1e-13
    e = gradient + gradient.T
    strain = np.array([*np.diag(e) / 2, e[1, 2], e[0, 2], e[0, 1]])
    strain = strain[[0, 1, 2, 4]] * [1, 0, 1, 1] if solid is SECTION else strain
    expected = stiffness_tensor(YOUNG, POISSON, len(strain) - 3) @ strain
    assert np.abs(solid.stress(u) - expected[:, None, None]).max() < 1e-11 * np.abs(expected).max()
    assert np.abs(solid.internal_force(solid.stress(u)) - solid.stiffness @ u).max() < 1e-12


def test_stiffness_equals_the_weak_form_of_scikit_fem():
    """The same integrals by skfem's own assembly; both sum a few hundred products, hence 1e-13 and 1e-12."""

    @BilinearForm
    def weak_form(u, v, w):
        r = w.x[0]
        e, d = sym_grad(u), sym_grad(v)
        traces = (e[0, 0] + e[1, 1] + u[0] / r) * (d[0, 0] + d[1, 1] + v[0] / r)
        return 2 * np.pi * r * (2 * SHEAR * (ddot(e, d) + u[0] * v[0] / r**2) + LAME * traces)

    solid = ring(3)
    reference = weak_form.assemble(solid.basis)
    assert abs(solid.stiffness - reference).max() < 1e-13 * abs(reference).max()
    plain = cube(2, mean_dilatation=False)
    form = linear_elasticity(*lame_parameters(YOUNG, POISSON))
    reference = form.assemble(Basis(plain.basis.mesh, ElementVector(ElementHex1()), intorder=3))
    assert abs(plain.stiffness - reference).max() < 1e-12 * abs(reference).max()


def test_mean_stress_is_even_in_flow_that_keeps_volume():
    """Yielding without mean dilatation: no spread of the mean stress in an element; plain ones have it."""
    spread = []
    for mean in (True, False):
        solid = cube(2, twist=0.0, mean_dilatation=mean)
        material = J2(Elastic(YOUNG, POISSON), Linear(1e-3), np.ones(solid.points.shape[1:]), shears=3)
        x, y, z = solid.basis.mesh.p
        u = np.zeros(solid.size)
        dofs = solid.basis.nodal_dofs
        u[dofs[0]], u[dofs[1]], u[dofs[2]] = 0.01 * x * z, 0.01 * y * z, -0.01 * z**2
        stress = material.update(solid.strain(u), History.virgin(solid.points.shape[1:], 6)).stress
        spread.append(np.ptp(stress[:3].mean(axis=0), axis=1).max() / np.abs(stress[3:]).max())
    assert spread[0] < 1e-12 and spread[1] > 1.0


def test_a_polynomial_is_continued_exactly():
    z = np.array([0.1, 0.3, 0.7])
    assert continued(z, 2.0 - z + 3.0 * z**2, -0.2) == pytest.approx(2.32, rel=1e-13)
    assert continued(z[:2], 2.0 - z[:2], 0.0) == pytest.approx(2.0, rel=1e-14)
    assert continued(z[:1], z[:1], 0.0) == 0.1


# --- mesh lines ---


def test_mesh_lines_at_marks():
    """At depths inside the core, equal intervals between; none for a mark nearer than an eighth."""
    z = smooth_lines(8, 10.0, Core(1.3, 0.8), (0.0, 0.3, 0.301, 0.45, 0.47, 5.0))[1]
    assert z[:9] == pytest.approx([0.0, 0.1, 0.2, 0.3, 0.375, 0.45, 0.47, 0.595, 0.72])
    assert np.diff(z).max() > 0.2 and z[-1] == pytest.approx(10.0)


@pytest.mark.parametrize("growth", [1.1, 1.25, 2.2])
def test_no_interval_more_than_reaches(growth):
    """Where k of them end at the border but for rounding, they are k; a millionth further, one more."""
    for k in range(1, 40):
        length = sum(growth**j for j in range(k))
        assert [grow(0.0, length * more, 1.0, growth).size for more in (1.0, 1.0 + 1e-6)] == [k, k + 1]


@pytest.mark.parametrize("lines", [smooth_lines, punch_lines])
@pytest.mark.parametrize(("cells", "box"), [(2, 3.0), (32, 25.0)])
def test_mesh_lines(lines, cells, box):
    """Ascending from 0 to the box, a line at the contact radius, no sudden change of size outside of it."""
    r, z = lines(cells, box)
    for x in (r, z):
        assert x[0] == 0.0 and x[-1] == pytest.approx(box, rel=1e-14)
        h = np.diff(x)
        assert (h > 0.0).all() and (h[1:] / h[:-1])[x[2:] > 1.0 + 1e-9].max() < 2.0
    assert np.abs(r - 1.0).min() < 1e-14
    mesh = tensor_mesh(r, z, half=True)
    sizes = {name: facets.size for name, facets in mesh.boundaries.items()}
    assert sizes == {"axis": z.size - 1, "surface": r.size - 1, "far": r.size + z.size - 2}


def test_depths_of_a_coated_body():
    """Two elements or more in the coating, its lower face a line to the last digit, growth as allowed."""
    for h in (1e-3, 0.05, 0.3, 3.0, *np.random.default_rng(0).uniform(0.01, 1.0, 50)):
        z = coated_depths(h, 10.0, Sizes(1 / 16, 1 / 16, (0.8, 0.8)))
        assert z[np.searchsorted(z, h)] == h and z[-1] == 10.0
        assert np.count_nonzero(z < h) >= 2
        steps = np.diff(z)
        assert (steps[1:] / steps[:-1]).max() < 1.6 and (steps[1:] / steps[:-1]).min() > 0.6
        # the last ones may have been beyond before the scaling to the box
        assert steps[z[1:] < 0.8].max() <= 1.25 / 16


# --- nodal forces and areas ---


def test_surface_weights_are_integrals_of_the_shape_functions():
    """Against adaptive quadrature of each shape function on an uneven line."""
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
    assert surface_weights(r) == pytest.approx(expected, abs=1e-13)  # quadratures good to 1e-14
    assert surface_weights(r)[0] == 0.0
    assert surface_weights(r).sum() == pytest.approx(np.pi * 1.1**2, rel=1e-14)


@pytest.mark.parametrize("centre", [(0.0, 0.0), (0.37, 0.0)])
def test_prescribed_forces_are_those_of_hertz(centre):
    """Force, moment and second moment of the pressure (1, 0, 1/5); order 3/2 at the edge: 1e-4."""
    x = two_sided(-1.2, 1.7, 0.2, 6.0)
    forces = hertz_forces(x, x, centre)
    assert (forces.sum(), forces.sum(axis=1) @ x) == pytest.approx((1.0, centre[0]), abs=5e-5)
    # the second moment of hat functions exceeds that of the pressure by h^2/6, as x^2 by its interpolation
    assert 0.0 < (forces.sum(axis=1) @ (x - centre[0]) ** 2 - 0.2) < 0.25 * 0.2**2
    half = hertz_forces(x, x[x >= 0], centre)
    assert half.sum() == pytest.approx(0.5, abs=5e-5)
    assert half[:, 1:] == pytest.approx(forces[:, x > 0], abs=1e-15)


def test_ring_forces_are_those_of_hertz():
    """Total 1, and exact for the quadratics 1 and r^2 of the elements (rounding)."""
    forces = ring_forces(r := np.concatenate([np.linspace(0, 1, 17), [1.1, 1.2]]))
    assert forces.sum() == pytest.approx(1.0, rel=1e-13)
    assert forces @ r**2 == pytest.approx(0.4, rel=1e-13)  # integral of r^2 p: 2/5
    assert np.all(forces[-2:] == 0.0)


def test_area_behind_a_straight_edge_is_exact():
    """Pressure and gap of a smooth contact, sqrt and 3/2 power of the distance from its edge, meet there."""
    x, y, edge = np.linspace(-1.0, 1.0, 9), np.linspace(0.0, 2.0, 5), 0.3
    distance = (edge - x)[:, None] * np.ones(y.size)
    fields = np.sqrt(np.clip(distance, 0, None)), 4 / 3 * np.clip(-distance, 0, None) ** 1.5
    for fields_of, lines in ((fields, (x, y)), ([field.T for field in fields], (y, x))):
        assert areas.area_of_spots(*lines, *fields_of, clamped=0.0) == pytest.approx(2.6, rel=1e-12)
        strip = 0.5 * 2.0 * np.sqrt(0.25 * 0.5)
        assert areas.area_of_spots(*lines, *fields_of, clamped=0.5) == pytest.approx(2.6 - strip, rel=1e-12)
    assert areas.area_of_spots(x, y, 0.0 * distance, np.ones_like(distance)) == 0.0


# --- far fields ---


def test_far_fields_are_those_of_point_forces():
    """As the references, whose stresses balance the force; a slanted force is the sum of both."""
    points, body = np.array([[0.7, 0.0, -0.5], [-0.4, 0.0, 0.2], [0.3, 1.0, 0.3]]), Elastic(2.5, POISSON)
    normal, along = (
        of(*points, 1.0, young=2.5, nu=POISSON).T for of in (boussinesq_displacement, cerruti_displacement)
    )
    assert slanted((1.0, 0.0), body, points) == pytest.approx(normal, rel=1e-13, abs=1e-15)
    assert slanted((1.0, 0.7), body, points) == pytest.approx(normal + 0.7 * along, rel=1e-13, abs=1e-15)
