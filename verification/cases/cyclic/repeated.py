# SPDX-License-Identifier: MIT
"""What is looked at where a Hertz pressure comes and goes in place on a body with back-stresses."""

from collections.abc import Callable

import numpy as np
from scipy.interpolate import CubicSpline

from sam.scene import Plasticity, Result, Scene
from verification.cases.case import DataFrame, with_body, with_keys, with_loading
from verification.judging import Measured
from verification.quantities import Reference, of_cycles, refined
from verification.reference.hertz import subsurface_stress
from verification.reference.stress import von_mises
from verification.runs.sampling import rows_of

__all__ = [
    "flow_depth",
    "flow_elsewhere",
    "last_strain",
    "later_strain",
    "other_classes",
    "splines_apart",
    "strain_on_axis",
]

LAWS = {
    "prager": (3.4e9, {"modulus": (210e9 / 19,), "recovery": (0.0,)}),
    "chaboche": (4e9, {"modulus": (400e9, 60e9, 6e9), "recovery": (2000.0, 300.0, 0.0)}),
}
"""Name -> largest pressure in Pa, back-stresses."""
LOW, HIGH = {"limits": 0.2, "splines": 0.3}, 1.2
"""Depths in a: from below the first coarse cell to where elements are even."""
Profile = tuple[np.ndarray, np.ndarray]
"""Depths in a and values there."""


def law(scene: Scene, name: str) -> Scene:
    """The scene with one of LAWS and its load."""
    p0, back = LAWS[name]
    stress = scene.body.plasticity.yield_stress
    return with_loading(
        with_body(scene, plasticity=Plasticity(law="perfect", yield_stress=stress, kinematic=back)), p0=p0
    )


def floor(scene: Scene, factor: float) -> Scene:
    """The strain below which a cycle counts as without, over a thousandth of the yield strain."""
    steps = scene.loading.steps
    return with_keys(scene, "solver", tolerance=1e-3 / (4 * 2 * 6) * factor * 6 / steps)


def later_strain(scene: Scene, result: Result, _: Reference | None) -> float:
    """Largest plastic strain that a cycle after the first adds."""
    return float(of_cycles(result, "peeq_step_max")[1:].max())


def last_strain(scene: Scene, result: Result, _: Reference | None) -> float:
    """Plastic strain that the last cycle adds."""
    return float(of_cycles(result, "peeq_step_max")[-1])


def closes(scene: Scene, result: Result, _: Reference | None) -> float:
    """Strain that the last cycle leaves over that of the second."""
    left = of_cycles(result, "strain_step_max")
    return float(left[-1] / left[1])


def decided(scene: Scene, result: Result, _: Reference | None) -> float:
    """Cycle since which the verdict is the same."""
    return result.verdict["decided_at_cycle"]


def classes(scene: Scene, result: Result, _: Reference | None) -> list[str]:
    """Verdicts after the cycle from which they stay: later with more back-stresses."""
    return result.tables["cycles"]["verdict"][5 if len(scene.body.plasticity.kinematic.modulus) == 1 else 7 :]


def flow_depth(scene: Scene, result: Result, _: Reference | None) -> Measured:
    """Mean depth of what the last unloading strains on the axis in a, against that of the largest stress."""
    (z, flow), (depth, mises) = _reverse_flow(scene, result), _elastic(scene)
    return Measured(float((z * flow).sum() / flow.sum()), float(depth[mises.argmax()]))


def flow_elsewhere(scene: Scene, result: Result, _: Reference | None) -> float:
    """What the last unloading strains farther than a cell from where the elastic stress exceeds twice the
    yield stress.
    """
    (z, flow), (depth, mises) = _reverse_flow(scene, result), _elastic(scene)
    beyond, h = depth[mises > 2 * scene.body.plasticity.yield_stress], np.diff(z).max()
    return float(np.abs(flow[(z < beyond[0] - h) | (z > beyond[-1] + h)]).max())


def _reverse_flow(scene: Scene, result: Result) -> Profile:
    """The accumulated strain of the last unloading on the axis."""
    z, peak = rows_of(result.tables["axis"], "peak", "z_m", "peeq")
    return z / scene.loading.radius, rows_of(result.tables["axis"], "unloaded", "peeq")[0] - peak


def _elastic(scene: Scene) -> Profile:
    """The elastic von Mises stress on the axis."""
    z = np.linspace(0.0, 2.0, 4001)
    return z, von_mises(
        subsurface_stress(0.0, 0.0, z, scene.loading.p0, contact_radius=1.0, nu=scene.body.poisson)
    )


def on_axis(scene: Scene, result: Result, name: str) -> Profile:
    """A field at last, unloaded: at nodes of SAM on the axis, means around it, of classes the highest."""
    fields, radius = result.fields, scene.loading.radius
    if "peeq" in fields.point_data:
        points, values = fields.points, fields.point_data[name]
    else:
        (corners,) = (fields.cells[kind] for kind in ("quad", "hexahedron") if kind in fields.cells)
        points, values = fields.points[corners].mean(axis=1), fields.cell_data[name]
    values = np.asarray(values, dtype=float)
    known = np.isfinite(values if values.ndim == 1 else values[:, 0])
    r = np.where(known, np.hypot(points[:, 0], points[:, 1]), np.inf)
    use = r <= r.min() + 1e-3 * radius
    depths, values = np.round(points[use, 2] / radius, 6), values[use]
    z, mean = np.unique(depths), np.max if name == "class" else np.mean
    return z, np.array([mean(values[depths == each], axis=0) for each in z])


def _column(words: str, name: str, part: int | None = None) -> Callable[..., np.ndarray]:
    """A column: depths in a and a field there, (2, n)."""

    def of(scene: Scene, result: Result, _: Reference | None) -> np.ndarray:
        z, values = on_axis(scene, result, name)
        return np.stack([z, values if part is None else values[:, part]])

    of.__doc__ = words
    return of


peeq = _column("Accumulated plastic strain on the axis.", "peeq")
along_x, along_z, shear = (
    _column(f"Plastic strain {name} on the axis.", "plastic_strain", part)
    for name, part in (("xx", 0), ("zz", 2), ("xz", 4))
)
cells = _column("Classes of the cells on the axis.", "class")


def depths(scene: Scene, result: Result, _: Reference | None) -> np.ndarray:
    """Depth in contact radii."""
    return on_axis(scene, result, "peeq")[0]


def strain_on_axis(scene: Scene, result: Result, _: Reference | None) -> np.ndarray:
    """Accumulated plastic strain on the axis after the last cycle."""
    return on_axis(scene, result, "peeq")[1]


def same(rows: DataFrame, column: str) -> Measured:
    """Whether all runs have one value."""
    return Measured(float(rows[column].nunique() == 1), 1.0)


def kinds(rows: DataFrame, column: str) -> Measured:
    """How many values there are in all runs."""
    return Measured(float(len({each for own in rows[column] for each in own})), 1.0)


def limits(rows: DataFrame, column: str) -> tuple[np.ndarray, list[np.ndarray]]:
    """Depths, and of SAM and FEM the means over the depth of a coarse cell, extrapolated in two sizes."""
    found = []
    for model in ("sam", "fem"):
        own = rows[rows["model"] == model]
        n, m = sizes = [int(size) for size in own["size"]]
        means = [
            profile[:, : int(HIGH * n) * (size // n)].reshape(2, -1, size // n).mean(axis=2)
            for size, profile in zip(sizes, own[column], strict=True)
        ]
        (z, coarse), (_, fine) = means
        found.append(refined({n: coarse, m: fine}, np.asarray)[z > LOW["limits"]])
    return z[z > LOW["limits"]], found


def apart(rows: DataFrame, column: str) -> float:
    """Largest difference of both models over the largest value, extrapolated in two numbers of steps."""
    by_steps = [limits(own, column)[1] for _, own in rows.groupby("loading.steps")]
    sam, fem = by_steps[0] if len(by_steps) == 1 else (2 * b - a for a, b in zip(*by_steps, strict=True))
    return float(np.abs(sam - fem).max() / np.abs(fem).max())


def splines(rows: DataFrame, column: str) -> tuple[np.ndarray, list[np.ndarray]]:
    """Centres of coarse elements, and of SAM and FEM the strain there, extrapolated in two sizes."""
    sam, fem = (rows[rows["model"] == model] for model in ("sam", "fem-3d"))
    z = fem[column].iloc[0][0]
    z = z[(z >= LOW["splines"]) & (z <= HIGH)]
    return z, [
        refined(dict(zip(own["size"].map(int), own[column], strict=True)), lambda each: CubicSpline(*each)(z))
        for own in (sam, fem)
    ]


def splines_apart(rows: DataFrame, column: str) -> float:
    """Largest difference of both models over the largest accumulated strain."""
    sam, fem = splines(rows, column)[1]
    return float(np.abs(sam - fem).max() / np.abs(splines(rows, "peeq")[1][1]).max())


def other_classes(rows: DataFrame, column: str) -> Measured:
    """Cells on the axis of which FEM has another class, but beside one where the class changes."""
    (z, sam), (fem_z, fem) = rows[column]
    beside = 1.5 / int(rows["size"].iloc[0])
    about = [
        [set(found[np.abs(depths - at) < beside]) for depths, found in ((z, sam), (fem_z, fem))]
        for at in z[(z > z[0]) & (z <= HIGH)]
    ]
    return Measured(float(sum(one != other for one, other in about if len(one) == len(other) == 1)), 0.0)
