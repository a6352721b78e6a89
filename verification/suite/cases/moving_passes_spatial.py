# SPDX-License-Identifier: MIT
"""Four passes of a sphere over steels with and without back-stress, SAM against the three-dimensional finite
elements, both on two grids and refined: the energy and the strain of each pass, and what becomes of the body.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from sam.scene import Plasticity, Result, Scene
from verification.figures.moving import new_strains
from verification.suite.cases.case import (
    FEM_3D,
    SAM,
    Case,
    Context,
    Measured,
    Plot,
    SmallTable,
    with_body,
    with_keys,
)
from verification.suite.cases.moving_sphere_scenes import Setting
from verification.suite.cases.repeated_loading import extrapolated

CELLS = (8, 12)  # in the radius
ELEMENTS = {"swift": (4, 6), "prager": (4,)}  # those of a/6 would take another twenty minutes
LENGTH = 5.0  # of the track in radii: one of four has no steady part
PASSES, BOX = 4, 12.0  # box of the finite elements in radii
PRAGER = Plasticity(law="perfect", yield_stress=1e9, kinematic={"modulus": (20e9,), "recovery": (0.0,)})
LAWS = {"swift": (None, 4.0), "prager": (PRAGER, 3.0)}
"""What takes the place of the steel of the scene, and p0 over the yield stress. At 4 the kinematic steel has
not decided after four passes: FEM on a/4 says it settles, SAM on a/6 that it alternates.
"""
EQUATIONS = (
    (
        "Energy of a pass",
        "D = ∫∫ (σ − α) : dε_p dV: of all that flows, in place of the strain of one cell",
        "first law",
    ),
    (
        "Counted",
        "passes that strain some cell by more than the floor of the verdict, below which strain is none",
        "definition of the verdict",
    ),
)


@dataclass(frozen=True)
class Passed:
    """What the passes of one run did. energy: in J of each; strain: largest new one of the steady part;
    floor: strain that counts as none; verdict: on the body after the last.
    """

    energy: tuple[float, ...]
    strain: tuple[float, ...]
    floor: float
    verdict: str

    @classmethod
    def of(cls, result: Result) -> Passed:
        """From the tables of a result."""
        energy, strain = result.tables["cycles"]["dissipated_J"], result.tables["passes"]["new_strain_max"]
        found = result.verdict
        return cls(
            tuple(map(float, energy)), tuple(map(float, strain)), float(found["floor"]), str(found["class"])
        )


@dataclass(frozen=True)
class Both:
    """Of one law: runs of both models by cells and elements in the radius."""

    sam: Mapping[int, Passed]
    fem: Mapping[int, Passed]

    def refined(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """Limits of both models by errors of second order, of each pass; of a single run its own values."""
        limits = []
        for runs in (self.sam, self.fem):
            values = [np.array(getattr(run, name)) for run in runs.values()]
            limits.append(extrapolated(*values, *runs) if len(values) == 2 else values[0])
        return limits[0], limits[1]

    @property
    def counted(self) -> np.ndarray:
        """Which passes strain more than the floor, in both models."""
        runs = (*self.sam.values(), *self.fem.values())
        return np.all([np.array(run.strain) > run.floor for run in runs], axis=0)

    def off(self, name: str) -> float:
        """Largest difference of the limits of a pass, over what the first one does: a later pass strains
        little, and has the error of the strain that has accumulated.
        """
        sam, fem = self.refined(name)
        return float(np.abs(sam - fem).max() / fem[0])

    def off_itself(self, name: str) -> float:
        """The same of a pass that counts, over what itself does."""
        sam, fem = (values[self.counted] for values in self.refined(name))
        return float(np.abs(sam / fem - 1.0).max())

    @property
    def verdicts(self) -> set[str]:
        """Of all runs."""
        return {run.verdict for run in (*self.sam.values(), *self.fem.values())}


def scene_of(scene: Scene, law: str, size: int) -> Scene:
    """Four passes on cells and elements of a/size, with a verdict."""
    plasticity, ratio = LAWS[law]
    scene = scene if plasticity is None else with_body(scene, plasticity=plasticity)
    made = Setting(cells=size, length=LENGTH, cycles=PASSES, ratio=ratio).of(scene)
    made = made.model_copy(update={"solver": made.solver.model_copy(update={"verdict": True})})
    return with_keys(made, "fem", cells_per_radius=size, box=BOX)


class MovingPassesSpatial(Case):
    """One way, without friction, in steps of a quarter of the radius."""

    def solve(self, context: Context) -> dict[str, Both]:
        scene, found = context.scene("moving-sphere"), {}
        for law in LAWS:
            runs = (
                {
                    size: Passed.of(context.solve(model, scene_of(scene, law, size), f"{name}-{law}-{size}"))
                    for size in sizes
                }
                for name, model, sizes in (("sam", SAM, CELLS), ("spatial", FEM_3D, ELEMENTS[law]))
            )
            found[law] = Both(*runs)
        return found

    def measure(self, found: dict[str, Both]) -> dict[str, Measured | float]:
        values: dict[str, Measured | float] = {}
        for law, both in found.items():
            values[f"{law}-verdict"] = Measured(float(len(both.verdicts)), 1.0)
        swift = found["swift"]
        values["swift-counted"] = float(swift.counted.sum())
        for name in ("energy", "strain"):
            values[f"swift-{name}"] = swift.off(name)
            values[f"swift-own-{name}"] = swift.off_itself(name)
        return values

    def setup(self, found: dict[str, Both]) -> list[tuple[str, str]]:
        return [
            ("Track", f"{LENGTH:g} a in steps of a/4, {PASSES} passes one way"),
            *((f"p₀, {law}", f"{ratio:g} yield stresses") for law, (_, ratio) in LAWS.items()),
            ("Kinematic steel", "σ_y = 1 GPa, Prager's law with a modulus of 20 GPa"),
            ("SAM", " and ".join(map(str, CELLS)) + " cells in a"),
            *(
                (f"Finite elements, {law}", " and ".join(map(str, sizes)) + f" elements in a, box {BOX:g} a")
                for law, sizes in ELEMENTS.items()
            ),
        ]

    def tables(self, found: dict[str, Both]) -> Iterator[SmallTable]:
        columns = ("model", "in a", *(f"pass {k + 1}" for k in range(PASSES)), "verdict")
        for law, both in found.items():
            for name, words, scale in (
                ("energy", "Energy that a pass dissipates [nJ]", 1e9),
                ("strain", "Largest strain that a pass adds [1e-3]", 1e3),
            ):
                rows = [
                    (model, str(size), *(f"{scale * v:.4g}" for v in getattr(run, name)), run.verdict)
                    for model, runs in (("SAM", both.sam), ("finite elements", both.fem))
                    for size, run in runs.items()
                ]
                yield SmallTable(f"{words}, {law}", columns, rows)

    def notes(self, found: dict[str, Both]) -> Iterator[str]:
        for law, both in found.items():
            energy, strain = (100 * both.off(name) for name in ("energy", "strain"))
            words = "refined" if len(both.fem) > 1 else "finite elements on one mesh, too coarse for a gate"
            yield (
                f"{law}: over the first pass the models differ by {energy:.1f} % in the energy and "
                f"{strain:.1f} % in the largest strain of some pass ({words})."
            )

    def figures(self, found: dict[str, Both]) -> Iterator[Plot]:
        runs = {
            f"{law}, {model}": list(each.strain)
            for law, both in found.items()
            for model, each in (
                ("SAM", both.sam[max(both.sam)]),
                ("finite elements", both.fem[max(both.fem)]),
            )
        }
        yield Plot(
            new_strains(runs),
            "new-strain",
            "What each pass adds in both models",
            "Largest new plastic strain over the number of the pass, both models",
            "Largest plastic strain that a pass adds to a cell or element of the steady part of the track.",
        )


CASES = (
    MovingPassesSpatial(
        "moving-passes-spatial",
        "Passes of a sphere, SAM against three-dimensional finite elements",
        "Do both models strain the body alike in each pass, and say the same of what becomes of it?",
        EQUATIONS,
        ("full",),
    ),
)
