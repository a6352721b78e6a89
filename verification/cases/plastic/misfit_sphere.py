# SPDX-License-Identifier: MIT
"""A sphere that grows inside a yielding body: plastic strain of both models in closed form."""

from collections.abc import Callable
from functools import cache

import numpy as np

from sam.scene import Plasticity, Result, Scene
from verification.cases.case import DataFrame, with_body, with_loading
from verification.cases.plastic.misfit_images import NAMES, Images, cell_means, images
from verification.judging import Measured, relative_l2
from verification.quantities import Reference
from verification.reference.misfit_sphere import GrowingSphere
from verification.references import growing_sphere
from verification.runs.sampling import peak

__all__ = [
    "image_raised",
    "image_xx",
    "image_xy",
    "image_xz",
    "image_zz",
    "infinite_body",
    "l2_at_points",
    "ray",
    "removed_mises",
    "removed_total",
    "sam_on_fem",
    "total_at_points",
    "uplift",
]


LAWS = {
    "linear": (0.02, {"law": "linear", "yield_stress": 1e9, "modulus": 10e9}),
    "swift": (0.03, {"law": "swift", "B": 945e6, "C": 20.0, "n": 0.121}),
    "perfect": (0.04, {"law": "perfect", "yield_stress": 1e9}),
}
"""Misfit strain at the centre and hardening law."""
REMOVED = (1.0, 0.0)  # shares of the misfit: loaded, and taken back


def law(scene: Scene, name: str) -> Scene:
    """The scene with one of LAWS and its misfit strain."""
    misfit, keys = LAWS[name]
    return with_loading(with_body(scene, plasticity=Plasticity(**keys)), misfit=misfit)


def infinite_body(scene: Scene) -> Reference:
    """The unit of length; fields are those of `growing_sphere`."""
    return Reference({}, {"a": scene.loading.radius})


def in_cells(result: Result, state: str) -> tuple[np.ndarray, np.ndarray]:
    """Plastic strain of SAM in its box, and the volumes of the cells."""
    box = result.grids[state]["body"]
    volume = np.einsum("i,j,k->ijk", *(np.diff(edges) for edges in (box.x, box.y, box.z)))
    return box.cell_data["peeq"], volume


def means_of_cells(scene: Scene, result: Result) -> np.ndarray:
    """Plastic strain of the closed form over the cells of SAM."""
    exact, box = growing_sphere(scene), result.grids["peak"]["body"]
    edges = box.x, box.y, box.z - scene.loading.depth
    return cell_means(lambda x, y, z: exact.fields(np.sqrt(x**2 + y**2 + z**2)).peeq, edges)


def at_points(scene: Scene, result: Result) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Plastic strain of FEM and of the closed form at its Gauss points, and the volumes around them."""
    x, z, peeq = (each.reshape(-1, 4) for each in peak(result.tables["plane"], "x_m", "z_m", "peeq"))
    corners = result.fields.points[result.fields.cells["quad"]]
    area = np.ptp(corners[..., 0], axis=1) * np.ptp(corners[..., 2], axis=1)
    here = growing_sphere(scene).fields(np.hypot(x, z - scene.loading.depth)).peeq
    return peeq, here, 2 * np.pi * x * area[:, None] / 4


def l2(scene: Scene, result: Result, _: Reference) -> float:
    """L2 error of the plastic strain."""
    peeq, volume = in_cells(result, "peak")
    return relative_l2(peeq, means_of_cells(scene, result), volume)


def total(scene: Scene, result: Result, _: Reference) -> float:
    """Error of the total plastic strain."""
    peeq, volume = in_cells(result, "peak")
    return float((volume * peeq).sum() / growing_sphere(scene).total() - 1)


def removed_total(scene: Scene, result: Result, _: Reference) -> float:
    """Error of the total plastic strain after removal."""
    peeq, volume = in_cells(result, "unloaded")
    return float((volume * peeq).sum() / growing_sphere(scene, REMOVED).total() - 1)


def removed_mises(scene: Scene, result: Result, _: Reference) -> float:
    """Error of the largest von Mises stress after removal."""
    exact = growing_sphere(scene, REMOVED)
    deviator = np.abs(exact.fields(exact.radius * np.linspace(0.01, 2.0, 2000)).deviator).max()
    return float(result.quantities["residual_mises_max_Pa"] / deviator - 1)


def raised(scene: Scene, result: Result, _: Reference) -> float:
    """Displacement of the surface by the plastic strain over the radius."""
    return abs(result.quantities["residual_uz_center_m"]) / scene.loading.radius


def l2_at_points(scene: Scene, result: Result, _: Reference) -> float:
    """L2 error of the plastic strain at the Gauss points."""
    return relative_l2(*at_points(scene, result))


def total_at_points(scene: Scene, result: Result, _: Reference) -> float:
    """Error of the total plastic strain, against the closed form at the same points, as a kink between them
    is worth more than the error of the elements.
    """
    peeq, here, volume = at_points(scene, result)
    return float((volume * peeq).sum() / (volume * here).sum() - 1)


def iterations(scene: Scene, result: Result, _: Reference) -> float:
    """Most iterations of a load step."""
    return float(max(result.tables["history"]["iterations"]))


def uplift(scene: Scene, result: Result, _: Reference) -> float:
    """Displacement of the surface on the axis in m."""
    x, u = peak(result.tables["line"], "x_m", "uz_m")
    return float(u[np.abs(x).argmin()])


@cache
def zone(exact: GrowingSphere) -> Images:
    """The images of its plastic zone."""
    return images(exact)


def _image(place: int, words: str) -> Callable[..., float]:
    def of(scene: Scene, result: Result, _: Reference) -> float:
        return float(zone(growing_sphere(scene)).left()[place])

    of.__doc__ = words
    return of


image_xx, image_zz, image_xz, image_xy = (
    _image(NAMES.index(name), f"Stress {name} that the surface adds to that of the plastic zone.")
    for name in ("xx", "zz", "xz", "xy")
)
image_raised = _image(len(NAMES), "Displacement of the surface by the plastic zone.")


def second_order(rows: DataFrame, column: str) -> float:
    """The largest error times the square of the cells in the radius, as its sign may change."""
    return float((rows[column].abs() * rows["sphere-cells"] ** 2).max())


def order_of_half(rows: DataFrame, column: str) -> float:
    """The order of errors of two sizes, one half of the other."""
    first, last = rows[column]
    return float(np.log2(first / last))


def sam_on_fem(rows: DataFrame, column: str) -> Measured:
    """SAM against FEM."""
    return Measured(*rows[column])


def ray(scene: Scene, result: Result, _: Reference) -> Measured:
    """Plastic strain on the axis below the centre."""
    z, peeq = peak(result.tables["axis"], "z_m", "peeq")
    r = z - scene.loading.depth
    return Measured(peeq[r > 0.0], growing_sphere(scene).fields(r[r > 0.0]).peeq)


def radii(scene: Scene, result: Result, _: Reference) -> np.ndarray:
    """Distance from the centre over the radius."""
    r = peak(result.tables["axis"], "z_m")[0] - scene.loading.depth
    return r[r > 0.0] / scene.loading.radius
