# SPDX-License-Identifier: MIT
"""Inside of a plastic box: operators against direct sums, return map at points, largest values."""

import os
from dataclasses import replace

import numpy as np
import pytest

from sam.contact.convolution import Counters, Transforms
from sam.grid.cells import Window
from sam.kernels.eigenstrain import displacement_parity, surface_displacement_coefficients
from sam.kernels.layer_stress import LayerStress, residual_stress_coefficients
from sam.kernels.patches import ODD_X, ODD_Y, STRESS, Cuboids, Lags, parity
from sam.kernels.store import CoefficientStore, kept, using
from sam.plasticity.cell_means import CellMeans, gauss_depths, mean_stress_of_load
from sam.plasticity.flow import Material, contraction, deviator, equivalent_strain, mises
from sam.plasticity.load_step import PARTS, ROOT, preconditioned, stiffness_of_parts
from sam.plasticity.measure import Strained, at_centres, largest, residual_stress, surface_displacement
from sam.plasticity.points import POINTS, CellFlow, Linear, stress_at_points, whole
from sam.plasticity.spectra import SINGLE, BoxOperator, BoxSpectra
from sam.plasticity.state import CellFields, MaterialFields, filled
from sam.scene.yield_curve import Layered, Linear as LinearLaw, Swift

NX, NY, ASPECT, NU, MU = 7, 6, 0.8, 0.3, 2.5
FACES = np.array([0.0, 0.4, 1.0, 1.7, 3.0])  # uneven layers
LAYERS = len(FACES) - 1


def cuboids(nx=NX, ny=NY, faces=FACES, aspect=ASPECT) -> Cuboids:
    return Cuboids(Lags(nx, ny, 1.0, aspect), tuple(faces), NU)


def mean_stress(nx, ny, faces):
    """Of each layer in turn, the mean over its cells: (6, 6, n_layers, nx, ny)."""
    layers = LayerStress(CellMeans(Lags(nx, ny, 1.0, ASPECT)), gauss_depths(faces), faces, NU)
    for layer in range(len(faces) - 1):
        out = np.empty((36, len(faces) - 1, nx, ny))
        layers.of(layer, out)
        yield out.reshape(6, 6, *out.shape[1:])


def product(one, other) -> tuple[int, int]:
    return one[0] * other[0], one[1] * other[1]


def direct_sum(kernel, sign, field):
    lx, ly = (np.arange(n)[:, None] - np.arange(n) for n in (NX, NY))
    signs = np.where(lx < 0, sign[0], 1)[:, :, None, None] * np.where(ly < 0, sign[1], 1)
    return np.einsum("ikjm,km->ij", kernel[np.abs(lx)[:, :, None, None], np.abs(ly)] * signs, field)


def test_equals_direct_summation_on_uneven_layers():
    """Stress of strain, pressure and traction, and the surface: 1e-12 of the largest (measured 5e-16)."""
    rng = np.random.default_rng(0)
    strain, pressure = rng.standard_normal((6, LAYERS, NX, NY)), rng.standard_normal((NX, NY))
    traction = rng.standard_normal((NX, NY))
    operator = BoxOperator(cuboids(), MU, Counters())
    transformed = operator.transformed(strain)
    found = operator.stress(pressure, operator.response(transformed), traction)
    expected = np.zeros_like(strain)
    for load, field in ((3, pressure), (1, traction)):
        kernel = mean_stress_of_load(cuboids(), load)
        for i, k in np.ndindex(6, LAYERS):
            expected[i, k] += direct_sum(kernel[i, k], parity(STRESS[i], load), field)
    for layer, kernel in enumerate(mean_stress(NX, NY, FACES)):
        for i, j, source in np.ndindex(6, 6, LAYERS):
            sign = product(parity(STRESS[i], 3), parity(STRESS[j], 3))
            expected[i, layer] += MU * direct_sum(kernel[i, j, source], sign, strain[j, source])
    assert np.abs(found - expected).max() <= 1e-12 * np.abs(expected).max()
    single = BoxOperator(cuboids(), MU, Counters(), tolerance=SINGLE)  # a tenth of the tolerance
    found = single.stress(pressure, single.response(single.transformed(strain)), traction)
    assert 0 < np.abs(found - expected).max() <= 0.1 * SINGLE * np.abs(expected).max()
    kernel = surface_displacement_coefficients(cuboids())
    residual = sum(
        direct_sum(kernel[j, k], parity(STRESS[j], 3), strain[j, k]) for j, k in np.ndindex(6, LAYERS)
    )
    assert np.abs(operator.displacement(transformed) - residual).max() <= 1e-12 * np.abs(residual).max()


def test_cell_means_are_means():
    """Against 6 x 6 x 6 Gauss points. Next to the source its edges make the field logarithmic: two points a
    direction leave 5 % there (less than 1e-4 of the largest plastic strain of a contact), beyond it 1e-3.
    """
    t, w = (each / 2 for each in np.polynomial.legendre.leggauss(6))
    mean = 0.0
    for (i, j), weight in np.ndenumerate(np.outer(w, w)):
        at = residual_stress_coefficients(cuboids(9, 8), 0.7 + 0.6 * t, off=(t[i], ASPECT * t[j]))
        mean = mean + weight * np.tensordot(at, w, axes=(2, 0))
    off = np.abs(list(mean_stress(9, 8, FACES))[1] - mean)
    assert off.max() < 0.05 * np.abs(mean[..., 0, 0]).max()
    assert off[..., 5:, 5:].max() < 1e-3 * np.abs(mean[..., 5:, 5:]).max()


def test_equal_layers_share_what_each_pair_alone_gives():
    """Six equal layers below two thin ones: 1e-13 of the largest value, from a third of the sums."""
    faces = np.concatenate([[0.0, 0.3], 0.7 + np.arange(7.0)])
    shared = np.array(list(mean_stress(5, 4, faces)))
    alone = np.empty_like(shared)
    for i, point in enumerate(gauss_depths(faces)):
        for j in range(len(faces) - 1):
            pair = LayerStress(CellMeans(Lags(5, 4, 1.0, ASPECT)), point[None], faces[j : j + 2], NU)
            pair.of(0, alone[i, :, :, j].reshape(36, 1, 5, 4))
    assert np.abs(shared - alone).max() < 1e-13 * np.abs(alone).max()
    layers = LayerStress(CellMeans(Lags(5, 4, 1.0, ASPECT)), gauss_depths(faces), faces, NU)
    assert len(layers.image.first) == 2 * 6 - 1 + 8 * 8 - 6 * 6
    assert len(layers.full.first) == 6 + 8 * 8 - 6 * 6


def of_box(exchange=False):
    return BoxSpectra(cuboids(5, 5, aspect=1.0), single=False, exchange=exchange)


def test_coefficients_are_taken_from_files_that_are_whole(tmp_path, monkeypatch):
    """Bit by bit as they were made; what is cut, changed or of something else is made again."""
    made, few = of_box().layers, of_box(exchange=True).layers
    monkeypatch.setattr(BoxSpectra, "_dense", lambda *_: pytest.fail("made again"))
    with pytest.raises(pytest.fail.Exception):
        of_box()
    store = CoefficientStore(tmp_path / "new", 3 * made.nbytes, "1")

    def found(content=made, exchange=False, version="1"):
        """With whether it had to be made."""
        again = []
        monkeypatch.setattr(BoxSpectra, "_dense", lambda *_: again.append(1) or content)
        with using(replace(store, version=version)):
            values = of_box(exchange).layers
        assert np.array_equal(values, content)
        return bool(again)

    assert found() and not found() and found(few, exchange=True) and not found(few, exchange=True)
    assert found(version="2") and not found()
    first, second = sorted(store.path.iterdir(), key=lambda path: path.stat().st_size)[:2]
    whole = second.read_bytes()
    flipped = bytearray(whole)
    flipped[len(whole) // 2] ^= 1
    other = next(path for path in store.path.iterdir() if path not in (first, second))
    for damaged in (whole[:-8], whole[:100], b"", whole + b"\0", bytes(flipped), other.read_bytes()):
        second.write_bytes(damaged)
        assert sorted([found(), found(version="2")]) == [False, True]
        assert second.read_bytes() == whole


def test_a_store_of_coefficients_is_bounded(tmp_path):
    """The one used longest ago goes; one that is larger than all is not kept; nor is what nobody finished."""
    array, store = np.arange(1000.0), CoefficientStore(tmp_path, 3e4, "1")

    def found(name, size=1000):
        again = []
        with using(store):
            kept(name, (size,), float, lambda: again.append(1) or np.resize(array, size))
        return bool(again)

    for path in (tmp_path / "a.part", tmp_path / "b.part"):
        path.touch()
    os.utime(tmp_path / "a.part", (0, 0))
    assert [found(name) for name in "ab"] == [True, True]
    for path in tmp_path.glob("*.coefficients"):
        os.utime(path, (1000, 1000))
    assert not found("a") and found("c")  # a is the newer one now
    assert not found("a") and not found("c") and found("b")
    assert found("large", 4000) and found("large", 4000)
    assert not (tmp_path / "a.part").exists() and (tmp_path / "b.part").exists()


def test_fields_outside_the_box_continue_those_inside():
    """Stress at cell centres and surface of the general routine: direct sums of the same coefficients."""
    strain = np.random.default_rng(2).standard_normal((6, LAYERS, NX, NY))
    row, depths = Window(0, 5, 15, 1), np.array([0.2, 2.0, 4.5])
    source = Strained(strain, Window(4, 3, NX, NY), cuboids())
    stress = residual_stress(source, depths, row, mu=MU)
    moved = {c: surface_displacement(source, row, counters=Counters(), component=c) for c in (1, 3)}
    kernel = residual_stress_coefficients(cuboids(15, 15), depths)
    surface = {c: surface_displacement_coefficients(cuboids(15, 15), component=c) for c in (1, 3)}

    def summed(x, coefficients, sign_of):
        """Of one row of coefficients (6, ..., layers, lags)."""
        total = 0.0
        for i, j, b in np.ndindex(NX, NY, 6):
            lx, ly = x - 4 - i, 5 - 3 - j
            sx, sy = sign_of(b)
            sign = (sx if lx < 0 else 1) * (sy if ly < 0 else 1)
            total = total + sign * coefficients[b, ..., abs(lx), abs(ly)] @ strain[b, :, i, j]
        return total

    for x in (0, 6, 14):
        for a in range(6):
            of_a = parity(STRESS[a], 3)
            expected = MU * summed(x, kernel[a], lambda b, of_a=of_a: product(of_a, parity(STRESS[b], 3)))
            assert np.abs(stress[a, :, x, 0] - expected).max() <= 1e-11 * np.abs(stress).max()
        for c, u in moved.items():
            expected = summed(x, surface[c], lambda b, c=c: displacement_parity(c, b))
            assert u[x, 0] == pytest.approx(expected, rel=1e-10)


def test_boxes_of_equal_cells_share_their_coefficients():
    """Cached by content: other units, the same spectra; another layer, others."""
    first, again, other = (
        BoxOperator(Cuboids(Lags(4, 4, cell, cell), tuple(cell * np.arange(faces)), NU), mu, Counters())
        for cell, faces, mu in ((1e-6, 4, 1e9), (3.7, 4, 1.0), (3.7, 5, 1.0))
    )
    assert first.spectra is again.spectra and other.spectra is not again.spectra


# the return map at the Gauss points of a cell

STEEL_MU, CELLS = 80e9, (7, 6)
WHOLE = Transforms(CELLS, (False, False), single=False, counters=Counters())


def every(shape) -> np.ndarray:
    return np.ones(shape, dtype=bool)


def smooth(cells=CELLS, layers=2) -> np.ndarray:
    """A tensor field (6, n_layers, nx, ny) with the parities of a mirrored scene, in Pa."""
    x, y = ((np.arange(n) - (n - 1) / 2) / 3 for n in cells)
    parts = [
        np.multiply.outer(np.sin(x) if odd_x else np.cos(x), np.sin(y) if odd_y else 1 - y**2)
        for odd_x, odd_y in zip(ODD_X, ODD_Y, strict=True)
    ]
    field = np.arange(1.0, 7.0)[:, None, None] / 6 * parts
    return 0.5e9 * np.stack([(k + 1) * field for k in range(layers)], axis=1)


def at_points(linear, field) -> np.ndarray:
    return linear.at_points(field, every(field.shape[1:])).reshape(6, POINTS, *field.shape[1:])


def test_a_linear_field_is_exact_at_the_points():
    """Of the Gauss rule with two points in x and in y; the mean over the points is that of the cell."""
    x, y = np.meshgrid(np.arange(5.0), np.arange(4.0), indexing="ij")
    field = np.broadcast_to(2 + 3 * x - 5 * y, (6, 1, 5, 4))
    found = at_points(Linear((5, 4)), field)
    at = 0.5 / np.sqrt(3)
    for point, (i, j) in enumerate(((-at, -at), (-at, at), (at, -at), (at, at))):
        assert found[:, point] == pytest.approx(field + 3 * i - 5 * j, rel=1e-14)
    assert found.mean(axis=1) == pytest.approx(field, rel=1e-14)


@pytest.mark.parametrize("mirror", [(False, True), (True, True)])
@pytest.mark.parametrize("cells", [CELLS, (6, 7), (1, 2), (2, 1)])
def test_a_mirrored_box_gives_what_the_whole_one_does(mirror, cells):
    """Components that are odd in x or in y change sign across the mirror, and the points their places."""
    field, transforms = smooth(cells), Transforms(cells, mirror, single=False, counters=Counters())
    full, some = at_points(Linear(cells), field), contraction(field, field) > 3e17
    kept = transforms.keep(some)
    half = Linear(cells, mirror).at_points(transforms.keep(field), kept)
    fields = MaterialFields(half, half[0], np.stack([half, 2 * half]))
    found = whole(transforms, CellFields(kept, fields))
    assert np.array_equal(found.cells, some) and some.any()
    assert found.points.strain == pytest.approx(full[..., some], abs=1e-5)
    assert found.points.peeq == pytest.approx(full[0][..., some], abs=1e-5)
    assert found.points.back[1] == pytest.approx(2 * full[..., some], abs=1e-5)
    assert np.array_equal(found.part(transforms.keep).points.strain, half)


@pytest.mark.parametrize("mirror", [(False, False), (True, True)])
def test_cells_that_are_left_out_cannot_yield(mirror):
    """The bound on von Mises at the points holds for any field, and is reached where the sign changes."""
    transforms = Transforms((8, 7), mirror, single=False, counters=Counters())
    field = deviator(np.random.default_rng(3).standard_normal((6, 3, *transforms.shape)))
    linear = Linear((8, 7), mirror)
    most = mises(at_points(linear, field)).max(axis=0)
    assert (most <= linear.farthest(mises(field)) * (1 + 1e-12)).all()
    field = np.zeros((6, 1, 2, 2))
    field[5] = 1e9 * np.array([[1.0, -2.0], [-3.0, 5.0]])
    most = mises(at_points(Linear((2, 2)), field)).max(axis=0)
    assert Linear((2, 2)).farthest(mises(field)) == pytest.approx(most, rel=1e-12)


LAYERED = Layered(Swift(945e6, 20.0, 0.121), LinearLaw(1e9, 50e9), np.array([True, False]).reshape(2, 1, 1))
MATERIALS = {
    "perfect": Material(STEEL_MU, LinearLaw(1e9), np.ones((2, 1, 1))),
    "layered": Material(STEEL_MU, LAYERED, np.array([1.0, 0.8]).reshape(2, 1, 1)),
}


@pytest.mark.parametrize("name", MATERIALS)
def test_two_steps_end_on_the_yield_surface_of_each_point(name):
    """Cells relax by 2 mu of their strain; the mean over the points is the strain of the cell."""
    material, load = MATERIALS[name], deviator(smooth())
    state = virgin(material)
    for size in (1.0, 1.5, 1.5):
        flow = CellFlow(material, state, WHOLE, STEEL_MU / 2)
        x = flow.nothing
        for _ in range(400):
            s = size * load - 2 * STEEL_MU * (state.strain + filled(x, flow.cells))
            found = flow.returned(x, s)
            if max(found.yield_excess, found.flow_residual) < 1e-12:
                break
            x = found.x + (found.image - found.x) / 2
        assert found.flow_residual < 1e-12
        increment = found.increment()
        assert increment.strain == pytest.approx(filled(found.x, flow.cells), abs=1e-17)
        before, state = state, state.plus(increment)
        everywhere = state.on(every((2, *CELLS))).each(lambda v: v.reshape(*v.shape[:-1], 2, *CELLS))
        stress = mises(stress_at_points(s, everywhere.strain, STEEL_MU / 2))
        assert (stress <= material.yield_stress(everywhere.peeq) * (1 + 1e-11)).all()
        stress, cells = stress[..., increment.cells], increment.cells
        limit, flows = material.yield_stress(everywhere.peeq)[..., cells], increment.points.peeq > 1e-9
        assert stress[flows] == pytest.approx(limit[flows], rel=1e-9)
    peeq = before.points.peeq
    some = (peeq.min(axis=0) < 1e-12)[peeq.max(axis=0) > 1e-9]
    assert peeq.max() > 1e-4 and some.any() and not before.cells.all()
    assert not flows.any() and equivalent_strain(x).max() < 1e-12


def virgin(material) -> CellFields:
    return CellFields(~every((2, *CELLS)), material.virgin((POINTS, 0)))


def test_a_step_is_accepted_only_if_flow_rule_and_yield_condition_both_hold():
    """Points beyond their yield stress are seen although the increment is the return map's."""
    material, load = MATERIALS["perfect"], deviator(smooth())
    flow = CellFlow(material, virgin(material), WHOLE, STEEL_MU / 2)
    assert flow.stays_elastic(0.1 * load, 1e-6) and not flow.stays_elastic(load, 1e-6)
    found = flow.returned(flow.nothing, load)
    assert found.image.any() and not found.increment().cells.any()
    size = np.sqrt((found.image[:3] ** 2).sum(axis=0) + 2 * (found.image[3:] ** 2).sum(axis=0)).max()
    assert found.flow_residual == pytest.approx(STEEL_MU * size / 1e9, rel=1e-12)
    right = replace(found, flow_residual=1e-4)
    beyond = replace(right, stress=1.2e9 / mises(right.stress).max() * right.stress)
    assert beyond.worst(1e-3) == beyond.yield_excess == pytest.approx(0.2, rel=1e-12)
    assert beyond.worst(1e-5) == 1e-4  # not accepted either way
    assert replace(right, stress=0.5 * beyond.stress).worst(1e-3) == 1e-4


# the preconditioner


def own_stress(on: BoxOperator):
    """Stress of a unit strain of each component in the middle cell of each layer, there."""
    found = np.empty((6, 6, 3))
    for j, layer in np.ndindex(6, 3):
        strain = np.zeros((6, 3, 5, 5))
        strain[j, layer, 2, 2] = 1.0
        found[:, j, layer] = on.stress(None, on.response(on.transformed(strain)))[:, layer, 2, 2]
    return found


def test_own_stress_is_the_answer_of_a_cell_to_its_own_strain():
    """On oblong cells every entry; where only half of the wave numbers are stored, what has no direction."""
    faces = (0.0, 0.1, 0.5, 1.5)
    on = BoxOperator(cuboids(5, 5, faces), MU, Counters())
    expected = own_stress(on)
    assert on.own_stress == pytest.approx(expected, abs=1e-13 * np.abs(expected).max())
    swept = BoxOperator(cuboids(5, 5, faces), MU, Counters(), swept=1e-5)
    assert swept.own_stress == pytest.approx(expected, abs=1e-12 * np.abs(expected).max())
    square = cuboids(5, 5, faces, aspect=1.0)
    mirrored = BoxOperator(square, MU, Counters(), mirror=(True, True), exchange=True)
    expected = stiffness_of_parts(own_stress(BoxOperator(square, MU, Counters())))
    assert stiffness_of_parts(mirrored.own_stress) == pytest.approx(expected, rel=1e-12)


def test_the_preconditioner_solves_a_cell_that_flows_by_itself():
    """Perfect plasticity, a stiffness for each part: an error across the flow is gone to second order."""
    m, limit, own = 1.0, np.full(1, 0.3), np.array([[1.6], [0.9], [0.1], [0.1], [1.6]])
    solution = np.array([0.0, 0, 0, 0, 2.0, 0]).reshape(6, 1)  # a shear 13

    def image(x):
        """Return map of the stress at x: that of the solution less what its own strain lowers it by."""
        off = PARTS @ (ROOT * (x - solution)[:, 0])
        lowered = (PARTS.T @ (own[:, 0] * off)) / ROOT
        at = solution * limit / (1.5 * equivalent_strain(solution))
        trial = at - lowered.reshape(x.shape) + 2 * m * x
        q = np.sqrt(1.5 * contraction(trial, trial))
        return 1.5 * (q - limit) / (3 * m) * trial / q

    assert image(solution) == pytest.approx(solution, abs=1e-15)
    assert preconditioned(solution, image(solution), limit, m=m, own=own) == pytest.approx(solution)
    error = 1e-6 * deviator(np.array([1.0, -2, 0.5, 3, 0, 1]).reshape(6, 1))
    x = solution + error
    better = preconditioned(x, image(x), limit, m=m, own=own)
    assert np.abs(better - solution).max() < 1e-5 * np.abs(error).max()
    assert np.abs(image(x) - solution).max() > 0.5 * np.abs(error).max()


# point values of the plastic strain from its means over cells

DEEP = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 5.5, 7.5])
MIDDLE = (DEEP[1:] + DEEP[:-1]) / 2
X, Y = np.arange(7)[:, None] - 3.0, np.arange(6) - 2.5


def bump(z, x, y):
    return 3.0 - 0.1 * (z - 3.3) ** 2 - 0.05 * (x - 0.2) ** 2 - 0.04 * (y + 0.1) ** 2


def means_of_bump():
    """Means over the cells of a quadratic: its values at the centres and a 24th of its second derivatives."""
    return bump(MIDDLE[:, None, None], X, Y) - (0.1 * np.diff(DEEP) ** 2)[:, None, None] / 12 - 0.09 / 12


def test_quadratic_fields_are_met_exactly_inside():
    values, exact = at_centres(means_of_bump(), DEEP), bump(MIDDLE[:, None, None], X, Y)
    inner = (slice(1, -1),) * 3
    assert values[inner] == pytest.approx(exact[inner], rel=1e-12)
    assert np.abs(values - exact).max() > 1e-3  # at the sides a direction is missing
    for turned in (exact, exact[:, ::-1, ::-1]):
        assert largest(turned, MIDDLE) == (pytest.approx(3.3), pytest.approx(3.0))


def test_nothing_is_taken_from_beyond_the_border_of_the_plastic_zone():
    mean = np.zeros((5, 5, 5))
    mean[2:, 2, 2] = (1.0, 2.0, 3.0)
    values = at_centres(mean, np.arange(6.0))
    assert (values[mean == 0] == 0).all() and values == pytest.approx(mean)
    spike = np.full((3, 3, 3), 100.0)
    spike[1, 1, 1] = 1e-3
    assert at_centres(spike, np.arange(4.0)).min() == 0.0  # never negative
    field = np.array([[[2.0, 1.0]]])  # on fewer than three cells it is left as it is
    assert at_centres(field, np.array([0.0, 1.0])) == pytest.approx(field)
    assert largest(field, np.array([0.5])) == (0.5, 2.0)


def test_no_parabola_across_a_kink_of_the_yield_stress():
    """A soft layer strains most at its lower face: exp((z - 3)/1.2) above it; the largest is 1."""
    above = 1.2 * np.diff(np.exp((DEEP - 3.0) / 1.2))
    mean = np.where(MIDDLE < 3.0, above, 0.01)[:, None, None] * np.ones((1, 3, 3))
    interval = (MIDDLE > 3.0).astype(int)
    depth, top = largest(at_centres(mean, DEEP, interval), MIDDLE, interval)
    assert depth == 2.5 and top == pytest.approx(above[2]) and above[1] < top < 1.0
    assert largest(at_centres(mean, DEEP), MIDDLE)[1] > 1.05 * top  # without knowing of the kink
    even = at_centres(means_of_bump(), DEEP, np.ones(6))
    assert (even == at_centres(means_of_bump(), DEEP)).all()
    assert largest(even, MIDDLE, np.ones(6)) == largest(even, MIDDLE)


@pytest.mark.parametrize("side", [-1, 1])
def test_the_largest_of_a_cubic_over_depth_is_met_exactly(side):
    """Its maximum lies at 3.3, and the neighbour on one side is the higher."""
    depths = np.arange(1.0, 7.0)
    away = side * (depths - 3.3)
    values = 3.0 - 0.1 * away**2 + 0.004 * away**3
    found = largest(values[:, None, None], depths)
    assert found == (pytest.approx(3.3, rel=1e-9), pytest.approx(3.0, rel=1e-12))
