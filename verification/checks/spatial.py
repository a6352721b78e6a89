# SPDX-License-Identifier: MIT
"""Conditions of a solution of the three-dimensional FEM, from its displacements, its histories and what it
returned.

Shape functions of boxes, strains, stresses and nodal forces are formed anew here, with the mean dilatation of
the elements (Hughes, Int. J. Numer. Methods Engrg. 15 (1980) 1413); as in `verification.checks.conditions`.
One cycle, traction along +x.
"""

from collections.abc import Sequence

import numpy as np

from fem_reference.spatial import Model, Step, load_steps
from sam.scene import Checkpoint, Result, Scene
from verification.checks.axisymmetric import Formed
from verification.checks.conditions import (
    both_heights,
    coefficient_at,
    conditions,
    force_of,
    initial_gap,
    missed_approach,
    peak_rows,
)

PAIRS = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))
"""Components 11 22 33 23 13 12."""


class Spatial(Formed):
    """Of the three-dimensional model: (6, n_elements, 8); nodes (3, n), corners (8, n_elements), points (3,
    n_elements, 8) of Gauss; forces (3, n) on the nodes.
    """

    def __init__(self, scene: Scene, model: Model, step: Step):
        basis = model.body.basis
        self.nodes, self.corners = basis.mesh.p, basis.mesh.t
        self.points = np.asarray(basis.global_coordinates())
        super().__init__(scene, model, step, self.points[2])
        sides = self.nodes[:, self.corners]
        self.low, self.high = sides.min(axis=1), sides.max(axis=1)
        slopes = self._slopes(sides)
        grad = np.einsum("ine,jneq->ijeq", step.state.u[basis.nodal_dofs][:, self.corners], slopes)
        total = np.stack([0.5 * (grad[i, j] + grad[j, i]) for i, j in PAIRS])
        dilatation = total[:3].sum(axis=0)
        total[:3] += (dilatation.mean(axis=1, keepdims=True) - dilatation) / 3.0
        self.form(total, (1.0, 1.0, 1.0, 0.5, 0.5, 0.5))
        self.forces = self._forces(slopes)

    def _slopes(self, sides: np.ndarray) -> np.ndarray:
        """(3, 8, n_elements, 8) derivatives of the shape functions of the corners at the points."""
        length = (self.high - self.low)[:, None]
        upper = sides > 0.5 * (self.low + self.high)[:, None]
        share = ((self.points - self.low[..., None]) / length[:, 0, :, None])[:, None]
        shapes = np.where(upper[..., None], share, 1.0 - share)
        signs = np.where(upper, 1.0, -1.0) / length
        return np.stack([signs[a, ..., None] * shapes[(a + 1) % 3] * shapes[(a + 2) % 3] for a in range(3)])

    def _forces(self, slopes: np.ndarray) -> np.ndarray:
        """(3, n) of the stress: sums over eight points of an eighth of the volume each."""
        weight = np.prod(self.high - self.low, axis=0) / 8.0
        tensor = np.empty((3, 3, *self.stress.shape[1:]))
        for component, (i, j) in zip(self.stress, PAIRS, strict=True):
            tensor[i, j] = tensor[j, i] = component
        mean = self.stress[:3].mean(axis=0)  # its virtual work is with the mean dilatation
        for i in range(3):
            tensor[i, i] -= mean
        local = np.einsum("ijeq,jneq->ine", tensor, slopes) + np.einsum("eq,inep->ine", mean, slopes) / 8.0
        flat = (local * weight).reshape(3, -1)
        return np.stack([np.bincount(self.corners.ravel(), each, self.nodes.shape[1]) for each in flat])

    def equilibrium(self) -> dict[str, float]:
        """Largest unbalanced nodal force, |q - mu p| of a node in contact, sum of p less F; each over F."""
        model, scale = self.model, self.model.scales.peak_force
        in_contact = np.zeros(self.nodes.shape[1], dtype=bool)
        in_contact[model.surface.ravel()[model.candidates[self.state.active]]] = True
        ends = self.nodes.min(axis=1, keepdims=True), self.nodes.max(axis=1, keepdims=True)
        held = np.zeros_like(self.forces, dtype=bool)
        mirrored = np.isclose(ends[0][1], 0.0)[0]
        far = (np.isclose(self.nodes, ends[1])).any(axis=0) | np.isclose(self.nodes[0], ends[0][0])
        if mirrored:
            held[1] = self.nodes[1] == ends[0][1]
        else:
            far |= np.isclose(self.nodes[1], ends[0][1])
        held[:, far] = True
        held[2] |= in_contact
        force = self.forces.copy()
        coefficient = coefficient_at(self.scene, *self.nodes[:2] * model.scales.length)
        slip = np.where(in_contact, force[0] - coefficient * force[2], 0.0)
        force[0] -= np.where(in_contact, force[0], 0.0)
        share = 0.5 if mirrored else 1.0
        return {
            "equilibrium": float(np.abs(force[~held]).max()) / (share * scale),
            "friction": float(np.abs(slip).max()) / (share * scale),
            "load": abs(float(force[2, in_contact].sum()) / share - self.state.force) / scale,
        }


def steps_of(scene: Scene, records: Sequence[Checkpoint]) -> list[Spatial]:
    """The steps of a scene that were not halved, of the last record, taken again where there is none."""
    model, steps = load_steps(scene, records[-1] if records else None)
    return [Spatial(scene, model, step) for step in steps if not step.cuts]


def surface(scene: Scene, result: Result) -> dict[str, float]:
    """Of the returned nodes z = 0: sum of p over the load less 1, tension; p gap = 0, gap >= 0; q = mu p on
    the line y = 0. The gap is that of the shapes + uz - approach, of a rough body with the returned heights;
    without force that on y = 0 as returned. A node has a quarter of each face around it.
    """
    top = result.fields.points[:, 2] == 0.0
    x, y, _ = result.fields.points[top].T
    p, uz = (result.fields.point_data[name][top] for name in ("p_Pa", "uz_m"))
    area = np.ones(x.size)
    for at in (x, y):
        line, numbers = np.unique(at, return_inverse=True)
        area *= (0.5 * (np.diff(line, prepend=line[0]) + np.diff(line, append=line[-1])))[numbers]
    height = 0.0 if scene.patch_surface is None else heights_at(result, x, y)
    line = peak_rows(result, "line")
    force = (2 if y.min() == 0.0 else 1) * float(p @ area)
    opened = 0.0
    if scene.loading.unload:
        gap = float(np.nanmin(peak_rows(result, "line", "unloaded")["gap_m"]))
        opened = -gap / result.quantities["approach_m"]
    slip = line["qx_Pa"] - coefficient_at(scene, line["x_m"], np.zeros(line["x_m"].size)) * line["p_Pa"]
    return {
        "load": max(
            abs(force / force_of(scene, result) - 1.0),
            missed_approach(scene, result),
            -float(p.min() / p.max()),
        ),
        "complementarity": max(conditions(initial_gap(scene, x, y, height) + uz, p, result), opened),
        "friction": float(np.abs(slip).max() / line["p_Pa"].max()),
    }


def fields(steps: Sequence[Spatial], result: Result) -> float:
    """Fields of the returned elements at the peak less the means over their points, over the largest."""
    peak = max(steps, key=lambda each: each.state.force)
    own = {"stress_Pa": peak.stress * peak.model.scales.pressure}
    if "peeq" in result.fields.cell_data:
        own |= {"peeq": peak.peeq[None] * peak.unit, "plastic_strain": peak.plastic * peak.unit}
    worst = 0.0
    for name, field in own.items():
        returned = result.fields.cell_data[name].reshape(field.shape[1], -1).T
        worst = max(worst, float(np.abs(field.mean(axis=-1) - returned).max() / np.abs(returned).max()))
    return worst


def heights_at(result: Result, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Returned heights in m at the nodes x, y (n,) in m, minus infinity beside the patch."""
    table = peak_rows(result, "surface")
    patch = both_heights(table).reshape([np.unique(table[name]).size for name in ("x_m", "y_m")])
    out, inside, numbers = np.full(x.size, -np.inf), np.ones(x.size, dtype=bool), []
    for name, at in (("x_m", x), ("y_m", y)):
        line = np.unique(table[name])
        numbers.append(np.abs(line - at[:, None]).argmin(axis=1))
        inside &= np.abs(line[numbers[-1]] - at) < 1e-6 * (line[1] - line[0])
    out[inside] = patch[numbers[0][inside], numbers[1][inside]]
    return out
