# SPDX-License-Identifier: MIT
"""A Hertz pressure with traction that comes and goes on bodies with back-stresses: SAM against
three-dimensional finite elements, the strain on the axis with all its components, and the verdict.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from sam.scene import Body, Friction, Grid, Loading, Plasticity, Result, Scene, Solver
from verification.cases.case import FEM_3D, SAM, Case, Context, Measured, Plot, SmallTable
from verification.cases.cyclic.repeated_loading import (
    LAWS,
    POISSON,
    RADIUS,
    TITLES,
    YIELD,
    YOUNG,
    constants_text,
    extrapolated,
    steps_of,
)
from verification.figures.friction import Curve, curves

P0, FRICTION, CYCLES, STEPS = 3.8e9, 0.2, 4, 4
CELLS, ELEMENTS = (6, 12), (4, 12)
"""In the contact radius, for the extrapolation; centres of coarse elements are centres of fine ones."""
FINE = ELEMENTS[1]
REACH, DEEP, BOX = 2.4, 3.0, 4.0  # contact radii: half a side and depth of the grid; of the mesh
COMPARED = 0.3, 1.2
"""Depths in a: from below the first coarse cell to where elements are even."""
COMPONENTS = {"xx": 0, "zz": 2, "xz": 4}


def slid(law: str, size: int) -> Scene:
    """The scene with cells and elements of a/size."""
    h, across = RADIUS / size, 2 * round(REACH * size) + 1
    return Scene(
        title=f"Repeated sliding, {law}",
        body=Body(
            young=YOUNG,
            poisson=POISSON,
            plasticity=Plasticity(law="perfect", yield_stress=YIELD, kinematic=LAWS[law]),
        ),
        loading=Loading(prescribed="hertz", p0=P0, radius=RADIUS, steps=STEPS, unload=True, cycles=CYCLES),
        friction=Friction(coefficient=FRICTION),
        grid=Grid(
            cells=(across, across),
            extent=(across * h, across * h),
            depths=tuple(h * np.arange(round(DEEP * size) + 1)),
        ),
        fem={"cells_per_radius": size, "box": BOX},
        solver=Solver(tolerance=1e-5),
    )


def on_axis(result: Result) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """z/a, and unloaded peeq, class and plastic strain (n, 6): of cells on the axis or elements around it."""
    fields = result.fields
    if "peeq" in fields.point_data:
        points, data = fields.points, fields.point_data
    else:
        points, data = fields.points[fields.cells["hexahedron"]].mean(axis=1), fields.cell_data
    known = np.isfinite(np.asarray(data["peeq"], dtype=float))
    r = np.where(known, np.hypot(points[:, 0], points[:, 1]), np.inf)
    use = r <= r.min() + 1e-3 * RADIUS
    depths = np.round(points[use, 2] / RADIUS, 6)
    z = np.unique(depths)
    found = {}
    for name in ("peeq", "plastic_strain", "class"):
        values = np.asarray(data[name], dtype=float)[use]
        mean = np.max if name == "class" else np.mean
        found[name] = np.array([mean(values[depths == each], axis=0) for each in z])
    return z, found


@dataclass(frozen=True)
class Both:
    """One law: results of both models by their size."""

    sam: Mapping[int, Result]
    fem: Mapping[int, Result]

    def profiles(self) -> tuple[np.ndarray, dict[str, tuple[np.ndarray, np.ndarray]]]:
        """z/a of the centres of coarse elements that are compared, and by quantity SAM and FEM, both
        extrapolated with the square of the width.
        """
        z, coarse = on_axis(self.fem[ELEMENTS[0]])
        use = (z >= COMPARED[0]) & (z <= COMPARED[1])
        found = {}
        for model, runs, sizes in (("sam", self.sam, CELLS), ("fem", self.fem, ELEMENTS)):
            profiles = (on_axis(runs[size]) for size in sizes)
            both = [{name: CubicSpline(at, v)(z[use]) for name, v in each.items()} for at, each in profiles]
            found[model] = {name: extrapolated(both[0][name], both[1][name], *sizes) for name in coarse}
        z = z[use]
        values = {"peeq": (found["sam"]["peeq"], found["fem"]["peeq"])}
        for name, part in COMPONENTS.items():
            values[name] = tuple(found[model]["plastic_strain"][:, part] for model in ("sam", "fem"))
        return z, values

    def other_classes(self) -> int:
        """Fine cells on the axis of which FEM has another class, but beside a cell where it changes."""
        (z, sam), (fem_z, fem) = (on_axis(runs[FINE]) for runs in (self.sam, self.fem))
        inside = z[(z > z[0]) & (z <= COMPARED[1])]
        classes = [
            {float(each) for each in found["class"][np.abs(depths - at) < 1.5 / FINE]}
            for at in inside
            for depths, found in ((z, sam), (fem_z, fem))
        ]
        pairs = zip(classes[::2], classes[1::2], strict=True)
        return sum(one != other for one, other in pairs if len(one) == 1 and len(other) == 1)


class RepeatedSliding(Case):
    """Prager's law and three back-stresses, pressed and sheared in place, four cycles."""

    def solve(self, context: Context) -> dict[str, Both]:
        return {
            law: Both(
                *(
                    {size: context.solve(model, slid(law, size), f"{name}-{law}-{size}") for size in sizes}
                    for name, model, sizes in (("sam", SAM, CELLS), ("fem", FEM_3D, ELEMENTS))
                )
            )
            for law in LAWS
        }

    def measure(self, found: dict[str, Both]) -> dict[str, Measured | float]:
        values: dict[str, Measured | float] = {}
        for law, both in found.items():
            profiles = both.profiles()[1]
            largest = np.abs(profiles["peeq"][1]).max()
            for name, (sam, fem) in profiles.items():
                values[f"{law}-{name}"] = float(np.abs(sam - fem).max() / largest)
            same = both.sam[FINE].verdict["class"] == both.fem[FINE].verdict["class"]
            values[f"{law}-class"] = Measured(float(same), 1.0)
            values[f"{law}-cells"] = Measured(float(both.other_classes()), 0.0)
        return values

    def setup(self, found: dict[str, Both]) -> list[tuple[str, str]]:
        return [
            ("Body", f"E = {YOUNG / 1e9:g} GPa, ν = {POISSON:g}, σ_y = {YIELD / 1e9:g} GPa"),
            *((law, constants_text(law)) for law in found),
            ("Load", f"p = p₀ √(1 − r²/a²), p₀ = {P0 / 1e9:g} GPa, q = {FRICTION:g} p, given"),
            ("Cycles", f"{CYCLES} of {STEPS} steps up and {STEPS} down"),
            ("Cells", f"a/{CELLS[0]} and a/{CELLS[1]}, extrapolated with the square of the width"),
            ("Elements", f"a/{ELEMENTS[0]} and a/{ELEMENTS[1]}, likewise; box {BOX:g} a"),
        ]

    def tables(self, found: dict[str, Both]) -> Iterator[SmallTable]:
        rows = [
            (law, f"{name}, a/{size}", *(f"{1e2 * each:.4f}" for each in steps_of(run)), run.verdict["class"])
            for law, both in found.items()
            for name, runs in (("SAM", both.sam), ("FEM", both.fem))
            for size, run in runs.items()
        ]
        cycles = (f"cycle {k}" for k in range(1, CYCLES + 1))
        yield SmallTable("Largest strain that a cycle adds in %", ("law", "model", *cycles, "verdict"), rows)

    def figures(self, found: dict[str, Both]) -> Iterator[Plot]:
        panels = {}
        for law, both in found.items():
            z, profiles = both.profiles()
            sam, fem = profiles["peeq"]
            panels[TITLES[law]] = {"FEM": Curve(z, 1e2 * fem), "SAM": Curve(z, 1e2 * sam)}
        yield Plot(
            curves(panels, "$z/a$", "accumulated plastic strain [%]"),
            "depth",
            "Plastic strain over depth after the last cycle",
            "Accumulated plastic strain on the axis over depth for two laws: SAM lies on FEM.",
            "Both extrapolated in their cells and elements.",
        )


CASES = (RepeatedSliding("repeated-sliding"),)
