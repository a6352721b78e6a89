# SPDX-License-Identifier: MIT
"""Three-dimensional elements: patch test, zero modes, locking, mesh, far field, prescribed forces, linear
solver.
"""

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve
from skfem import Basis, ElementHex1, ElementVector, MeshHex
from skfem.models.elasticity import lame_parameters, linear_elasticity

from fem_reference.axisymmetric.model import hertz_forces as ring_forces
from fem_reference.common.bodies import Elastic
from fem_reference.common.elasticity import mises, stiffness_tensor
from fem_reference.common.far_field import cerruti, slanted
from fem_reference.common.plasticity import J2, CurveInUnits, History
from fem_reference.spatial.hexahedra import HexSolid, block
from fem_reference.spatial.lines import Lines, two_sided
from fem_reference.spatial.multigrid import Preconditioner, rigid_modes
from fem_reference.spatial.surface import hertz_forces
from sam.scene.yield_curve import Linear, Swift

YOUNG, POISSON = 210.0, 0.3


def patch(n=2, twist=0.08, poisson=POISSON, **options):
    """n^3 elements of the unit cube, the inner nodes moved."""
    x = np.linspace(0.0, 1.0, n + 1)
    mesh = MeshHex.init_tensor(x, x, x)
    bump = twist * np.prod(np.sin(np.pi * mesh.p), axis=0)
    return HexSolid(
        MeshHex(mesh.p + bump * np.array([[1.0], [-0.7], [0.4]]), mesh.t), Elastic(YOUNG, poisson), **options
    )


def test_patch_test():
    """Linear displacements on the boundary of distorted elements: linear inside, the stress D e everywhere
    (rounding).
    """
    solid = patch(3)
    gradient = np.array([[1.0, 0.3, -0.2], [0.1, -0.5, 0.4], [0.25, 0.6, 0.8]])
    exact = np.zeros(solid.size)
    exact[solid.basis.nodal_dofs] = gradient @ solid.basis.mesh.p
    fixed = solid.basis.get_dofs().all()
    free = np.setdiff1d(np.arange(solid.size), fixed)
    u = np.where(np.isin(np.arange(solid.size), fixed), exact, 0.0)
    K = solid.stiffness.tocsc()
    u[free] = spsolve(K[free][:, free], -K[free][:, fixed] @ u[fixed])
    assert np.abs(u - exact).max() < 1e-13
    e = 0.5 * (gradient + gradient.T)
    strain = np.array([e[0, 0], e[1, 1], e[2, 2], 2 * e[1, 2], 2 * e[0, 2], 2 * e[0, 1]])
    expected = stiffness_tensor(YOUNG, POISSON, 3) @ strain
    assert np.abs(solid.stress(u) - expected[:, None, None]).max() < 1e-11 * np.abs(expected).max()
    assert np.abs(solid.internal_force(solid.stress(u)) - solid.stiffness @ u).max() < 1e-11


def test_free_patch_has_six_zero_modes():
    """The rigid motions and nothing else: rounding is 1e-15 of the largest eigenvalue, the softest
    deformation 1e-3.
    """
    solid = patch(2)
    eigenvalues = np.linalg.eigvalsh(solid.stiffness.toarray())
    assert np.sum(np.abs(eigenvalues) < 1e-10 * eigenvalues[-1]) == 6
    assert np.abs(solid.stiffness @ rigid_modes(solid.basis.mesh.p)).max() < 1e-12 * eigenvalues[-1]


def test_plain_element_is_that_of_scikit_fem():
    """Without mean dilatation the fast assembly gives the bilinear form, entry by entry."""
    solid = patch(2, mean_dilatation=False)
    form = linear_elasticity(*lame_parameters(YOUNG, POISSON))
    expected = form.assemble(Basis(solid.basis.mesh, ElementVector(ElementHex1()), intorder=3))
    assert abs(solid.stiffness - expected).max() < 1e-12 * abs(expected).max()


def test_mean_dilatation_does_not_lock():
    """Bending of a nearly incompressible cantilever of square section: within 12 % of the beam, the plain
    element loses half.

    2 elements over the depth in pure bending of the two-point rule: the shear of the hexahedron costs about
    10 %.
    """
    found = []
    for mean in (True, False):
        mesh = MeshHex.init_tensor(np.linspace(0, 8, 17), np.linspace(0, 1, 3), np.linspace(0, 1, 5))
        solid = HexSolid(mesh, Elastic(YOUNG, 0.4999), mean_dilatation=mean)
        p = mesh.p
        # clamped so that the section may contract: u_x = 0, and rigid motions held at the corner
        held = [
            *solid.basis.nodal_dofs[0, p[0] == 0],
            *solid.basis.nodal_dofs[2, (p[0] == 0) & (p[2] == 0.5)],
        ]
        held += [*solid.basis.nodal_dofs[1, (p[0] == 0) & (p[1] == 0)]]
        free = np.setdiff1d(np.arange(solid.size), held)
        end = np.flatnonzero(p[0] == 8)
        force = np.zeros(solid.size)
        z, weight = p[2, end], np.where((p[1, end] == 0.5), 0.5, 0.25)
        moment = weight * (z - 0.5) * np.where(np.abs(z - 0.5) == 0.5, 0.5, 1.0)
        force[solid.basis.nodal_dofs[0, end]] = moment
        u = np.zeros(solid.size)
        u[free] = spsolve(solid.stiffness[free][:, free].tocsc(), force[free])
        total = float(moment @ (z - 0.5))
        bent = abs(u[solid.basis.nodal_dofs[2, end]].mean()) / (total * 64.0 / (2 * YOUNG / 12))
        found.append(bent)
    assert found[0] == pytest.approx(1.0, abs=0.12) and found[1] < 0.7


def test_mean_stress_is_even_in_flow_that_keeps_volume():
    """Yielding under a strain without mean dilatation: no spread of the mean stress in an element; in plain
    ones it rules.
    """
    spread = []
    for mean in (True, False):
        solid = patch(2, twist=0.0, mean_dilatation=mean)
        material = J2(Elastic(YOUNG, POISSON), Linear(0.1), np.ones(solid.points.shape[1:]), shears=3)
        x, y, z = solid.basis.mesh.p
        u = np.zeros(solid.size)
        dofs = solid.basis.nodal_dofs
        u[dofs[0]], u[dofs[1]], u[dofs[2]] = 0.01 * x * z, 0.01 * y * z, -0.01 * z**2
        stress = material.update(solid.strain(u), History.virgin(solid.points.shape[1:], 6)).stress
        spread.append(np.ptp(stress[:3].mean(axis=0), axis=1).max() / np.abs(stress[3:]).max())
    assert spread[0] < 1e-12 and spread[1] > 1.0


def test_cerruti_solves_the_half_space():
    """Equilibrium inside by differences of the stress, no traction on the surface, resultant on a hemisphere:
    -1.
    """
    nu, step = 0.3, 1e-3
    D = stiffness_tensor(1.0, nu, 3)

    def stress(p):
        gradient = np.zeros((3, 3))
        for j in range(3):
            forward, back = (p + sign * step * np.eye(3)[j] for sign in (1, -1))
            forward, back = (cerruti(1.0, Elastic(1.0, nu), q[:, None])[:, 0] for q in (forward, back))
            gradient[:, j] = (forward - back) / (2 * step)
        e = gradient + gradient.T
        s = D @ [e[0, 0] / 2, e[1, 1] / 2, e[2, 2] / 2, e[1, 2], e[0, 2], e[0, 1]]
        return np.array([[s[0], s[5], s[4]], [s[5], s[1], s[3]], [s[4], s[3], s[2]]])

    surface = stress(np.array([0.7, -0.4, 2 * step]))
    assert np.abs(surface[2]).max() < 0.01 * np.abs(surface).max()  # the stress falls to zero with z
    inner, weights = np.polynomial.legendre.leggauss(8)
    total = np.zeros(3)
    for c, w in zip(0.5 * (inner + 1), 0.5 * weights, strict=True):  # cosine of the polar angle
        for angle in (np.arange(12) + 0.5) * np.pi / 6:
            n = np.array([np.sqrt(1 - c**2) * np.cos(angle), np.sqrt(1 - c**2) * np.sin(angle), c])
            total += stress(n + np.array([0, 0, 1e-9])) @ n * w * np.pi / 6
    # differences of 1e-3 of the radius: 1e-5
    assert total == pytest.approx([-1.0, 0.0, 0.0], abs=1e-4)


def test_slanted_is_the_sum_of_both():
    """Below the load Boussinesq is u_z alone; a force along x is odd in x there."""
    points = np.array([[0.0, 0.5, -0.5], [0.0, 0.2, 0.2], [1.0, 0.3, 0.3]])
    normal, both = (slanted(load, Elastic(1.0, 0.3), points) for load in ((1.0, 0.0), (1.0, 0.7)))
    assert normal[:2, 0] == pytest.approx([0.0, 0.0], abs=1e-15)
    tangential = both - normal
    assert tangential[2, 1] == pytest.approx(-tangential[2, 2], rel=1e-12)
    assert tangential[0, 1] == pytest.approx(tangential[0, 2], rel=1e-12)


@pytest.mark.parametrize("centre", [(0.0, 0.0), (0.37, 0.0)])
def test_prescribed_forces_are_those_of_hertz(centre):
    """Force, moment about the centre and second moment of the pressure (1, 0, 1/5); order 3/2 at the edge:
    1e-4.
    """
    x = two_sided(-1.2, 1.7, 0.2, 6.0)
    forces = hertz_forces(x, x, centre)
    assert (forces.sum(), forces.sum(axis=1) @ x) == pytest.approx((1.0, centre[0]), abs=5e-5)
    # the second moment of hat functions exceeds that of the pressure by h^2/6, as x^2 by its interpolation
    assert 0.0 < (forces.sum(axis=1) @ (x - centre[0]) ** 2 - 0.2) < 0.25 * 0.2**2
    half = hertz_forces(x, x[x >= 0], centre)
    assert half.sum() == pytest.approx(0.5, abs=5e-5)
    assert half[:, 1:] == pytest.approx(forces[:, x > 0], abs=1e-15)


def test_ring_forces_are_those_of_hertz():
    """Axisymmetric: total 1, and exact for the quadratics 1 and r^2 of the elements (rounding)."""
    r = np.concatenate([np.linspace(0, 1, 17), [1.1, 1.2]])
    forces = ring_forces(r)
    assert forces.sum() == pytest.approx(1.0, rel=1e-13)
    assert forces @ r**2 == pytest.approx(0.4, rel=1e-13)  # integral of r^2 p: 2/5
    assert np.all(forces[-2:] == 0.0)


def test_multigrid_is_deterministic_and_good():
    """The approximate inverse contracts (condition below 30), is symmetric, and twice the same to the last
    digit.
    """
    line = two_sided(-1.0, 1.0, 0.25, 5.0)
    solid = HexSolid(block(Lines(line, line[line >= 0], line[line >= 0], True)), Elastic(1.0, 0.3))
    mesh = solid.basis.mesh
    far = np.zeros(mesh.p.shape[1], dtype=bool)
    far[np.unique(mesh.facets[:, mesh.boundaries["far"]])] = True
    free = ~np.repeat(far, 3)
    free[solid.boundary_dofs("symmetry", 1)] = False
    np.random.seed(1)
    inverse = Preconditioner(solid.stiffness, mesh.p, far)(solid.stiffness, free)
    np.random.seed(2)
    second = Preconditioner(solid.stiffness, mesh.p, far)(solid.stiffness, free)
    a, b = np.random.default_rng(3).standard_normal((2, solid.size))
    assert np.array_equal(inverse(a), second(a))

    def first(r: np.ndarray) -> np.ndarray:
        return np.where(free, inverse(np.where(free, r, 0.0)), 0.0)

    assert b @ first(a) == pytest.approx(a @ first(b), rel=1e-10)
    rayleigh = []
    for vector in (a * free, first(a), first(first(a))):
        image = np.where(free, solid.stiffness @ vector, 0.0)
        rayleigh.append((first(image) @ image) / (vector @ image))
    assert max(rayleigh) / min(rayleigh) < 30.0


def test_six_components_yield_as_four():
    """A stress path in the plane y = 0 in three dimensions is the axisymmetric one: same history to
    rounding.
    """
    curve = CurveInUnits(Swift(945e6, 20, 0.121), 1.0, 1e9)
    small, large = (J2(Elastic(YOUNG, POISSON), curve, np.ones((1, 1)), shears=shears) for shears in (1, 3))
    e = np.array([0.004, -0.001, -0.02, 0.015])
    four = small.update(e[:, None, None], History.virgin((1, 1)))
    six = large.update(np.array([*e[:3], 0.0, e[3], 0.0])[:, None, None], History.virgin((1, 1), 6))
    keep = [0, 1, 2, 4]
    assert six.history.peeq == pytest.approx(four.history.peeq, rel=1e-14)
    assert six.stress[keep] == pytest.approx(four.stress, rel=1e-13)
    assert six.loss[0, 0][np.ix_(keep, keep)] == pytest.approx(four.loss[0, 0], rel=1e-12, abs=1e-9)
    rotated = large.update(
        np.array([*e[[1, 0, 2]], e[3], 0.0, 0.0])[:, None, None], History.virgin((1, 1), 6)
    )
    assert mises(rotated.stress) == pytest.approx(mises(six.stress), rel=1e-14)


def test_consistent_tangent_in_three_dimensions():
    """Stiffness minus loss is the derivative of the stress (differences of 1e-7: 1e-6)."""
    curve = CurveInUnits(Swift(945e6, 20, 0.121), 1.0, 1e9)
    material = J2(Elastic(YOUNG, POISSON), curve, np.ones((1, 1)), shears=3)
    e = np.array([0.01, -0.004, -0.03, 0.012, 0.02, -0.015])
    start = material.update(0.5 * e[[1, 0, 2, 4, 3, 5], None, None], History.virgin((1, 1), 6)).history
    tangent = material.stiffness - material.update(e[:, None, None], start).loss[0, 0]
    step = 1e-7
    for j in range(6):
        high, low = (
            material.update((e + s * step * np.eye(6)[j])[:, None, None], start).stress[:, 0, 0]
            for s in (1, -1)
        )
        assert (high - low) / (2 * step) == pytest.approx(tangent[:, j], abs=1e-5 * YOUNG)
