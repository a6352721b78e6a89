# SPDX-License-Identifier: MIT
"""Four passes of a sphere over steels with and without back-stress, SAM against the three-dimensional finite
elements, both on two grids and refined: the energy and the strain of each pass, and what becomes of the body;
and eight passes in SAM.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from sam.scene import Plasticity, Result, Scene
from verification.cases.case import (
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
from verification.cases.cyclic.repeated_loading import extrapolated
from verification.cases.moving.moving_sphere_scenes import Setting
from verification.figures.moving import new_strains

CELLS = (8, 12)  # in the radius
ELEMENTS = 4, 6
REFINED = (
    "swift",
)  # elements of a/3, a/4, a/6 strain kinematic steel in later passes by less and less, in no order
LENGTH = 5.0  # of the track in radii: one of four has no steady part
PASSES, BOX = 4, 12.0  # box of the finite elements in radii
MANY, CELLS_OF_MANY = 8, 6  # passes of SAM alone over kinematic steel, and cells in the radius
PRAGER = Plasticity(law="perfect", yield_stress=1e9, kinematic={"modulus": (20e9,), "recovery": (0.0,)})
LAWS = {"swift": (None, 4.0), "prager": (PRAGER, 3.0)}
"""What takes the place of the steel of the scene, and p0 over the yield stress. At 4 the kinematic steel has
not decided after four passes: FEM on a/4 says it settles, SAM on a/6 that it alternates.
"""
STEELS = {"swift": "Swift steel", "prager": "kinematic steel"}
BECOMES = {3.0: "shakedown", 4.0: "alternating"}
"""Of kinematic steel after many passes, by p0 over the yield stress."""


@dataclass(frozen=True)
class Passed:
    """What the passes of one run did. energy: in J of each; strain: largest new one of the steady part;
    floor: strain that counts as none; verdict: on the body after the last; pressure: the largest of it in Pa.
    """

    energy: tuple[float, ...]
    strain: tuple[float, ...]
    floor: float
    verdict: str
    pressure: float

    @classmethod
    def of(cls, result: Result) -> Passed:
        """From the tables of a result."""
        energy, strain = result.tables["cycles"]["dissipated_J"], result.tables["passes"]["new_strain_max"]
        found = result.verdict
        return cls(
            tuple(map(float, energy)),
            tuple(map(float, strain)),
            float(found["floor"]),
            str(found["class"]),
            float(result.quantities["p_max_Pa"]),
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

    def apart(self, name: str) -> float:
        """The same of the finest runs as they are."""
        sam, fem = (np.array(getattr(runs[max(runs)], name)) for runs in (self.sam, self.fem))
        return float(np.abs(sam - fem).max() / fem[0])

    def off_itself(self, name: str) -> float:
        """The same of a pass that counts, over what itself does."""
        sam, fem = (values[self.counted] for values in self.refined(name))
        return float(np.abs(sam / fem - 1.0).max())

    @property
    def verdicts(self) -> set[str]:
        """Of all runs."""
        return {run.verdict for run in (*self.sam.values(), *self.fem.values())}


@dataclass(frozen=True)
class Found:
    """laws: both models by law; many: more passes of SAM, by p0 over the yield stress."""

    laws: Mapping[str, Both]
    many: Mapping[float, Result]


def scene_of(scene: Scene, law: str, size: int, *, passes: int = PASSES, ratio: float = 0.0) -> Scene:
    """Passes on cells and elements of a/size, with a verdict. ratio: p0 over the yield stress, if it is not
    that of LAWS.
    """
    plasticity, usual = LAWS[law]
    scene = scene if plasticity is None else with_body(scene, plasticity=plasticity)
    made = Setting(cells=size, length=LENGTH, cycles=passes, ratio=ratio or usual).of(scene)
    made = made.model_copy(update={"solver": made.solver.model_copy(update={"verdict": True})})
    return with_keys(made, "fem", cells_per_radius=size, box=BOX)


class MovingPassesSpatial(Case):
    """One way, without friction, in steps of a quarter of the radius."""

    def solve(self, context: Context) -> Found:
        scene, found = context.scene("moving-sphere"), {}
        for law in LAWS:
            runs = (
                {
                    size: Passed.of(context.solve(model, scene_of(scene, law, size), f"{name}-{law}-{size}"))
                    for size in sizes
                }
                for name, model, sizes in (("sam", SAM, CELLS), ("spatial", FEM_3D, ELEMENTS))
            )
            found[law] = Both(*runs)
        many = {
            ratio: context.solve(
                SAM,
                scene_of(scene, "prager", CELLS_OF_MANY, passes=MANY, ratio=ratio),
                f"sam-{MANY}-{ratio:g}",
            )
            for ratio in BECOMES
        }
        return Found(found, many)

    def measure(self, found: Found) -> dict[str, Measured | float]:
        values: dict[str, Measured | float] = {}
        for law, both in found.laws.items():
            values[f"{law}-verdict"] = Measured(float(len(both.verdicts)), 1.0)
        swift = found.laws["swift"]
        values["swift-counted"] = float(swift.counted.sum())
        for name in ("energy", "strain"):
            values[f"swift-{name}"] = swift.off(name)
            values[f"swift-own-{name}"] = swift.off_itself(name)
        values["prager-energy"] = found.laws["prager"].apart("energy")
        for ratio, run in found.many.items():
            values[f"many-{ratio:g}"] = Measured(float(run.verdict["class"] == BECOMES[ratio]), 1.0)
        return values

    def setup(self, found: Found) -> list[tuple[str, str]]:
        return [
            ("Track", f"{LENGTH:g} a in steps of a/4, {PASSES} passes one way"),
            *((f"p₀, {STEELS[law]}", f"{ratio:g} yield stresses") for law, (_, ratio) in LAWS.items()),
            ("Kinematic steel", "σ_y = 1 GPa, Prager's law with a modulus of 20 GPa"),
            ("SAM", " and ".join(map(str, CELLS)) + " cells in a"),
            ("Finite elements", " and ".join(map(str, ELEMENTS)) + f" elements in a, box {BOX:g} a"),
        ]

    def tables(self, found: Found) -> Iterator[SmallTable]:
        columns = ("model", "in a", *passes_to(PASSES), "verdict")
        for law, both in found.laws.items():
            for name, words, scale in (
                ("energy", "Energy that a pass dissipates [nJ]", 1e9),
                ("strain", "Largest strain that a pass adds [1e-3]", 1e3),
            ):
                rows = []
                for model, runs, limit in zip(
                    ("SAM", "finite elements"), (both.sam, both.fem), both.refined(name), strict=True
                ):
                    shown = [(str(size), getattr(run, name), run.verdict) for size, run in runs.items()]
                    shown += [("refined", limit, "")] * (law in REFINED)
                    rows += [
                        (model, size, *(f"{scale * v:.4g}" for v in values), verdict)
                        for size, values, verdict in shown
                    ]
                yield SmallTable(f"{words}, {STEELS[law]}", columns, rows)
        yield SmallTable(
            f"Largest strain that a pass adds [1e-3] and verdict, {STEELS['prager']}, SAM, a/{CELLS_OF_MANY}",
            ("p₀ over σ_y", "", *passes_to(MANY)),
            [row for ratio, run in found.many.items() for row in rows_of_many(ratio, run)],
        )

    def notes(self, found: Found) -> Iterator[str]:
        for law, both in found.laws.items():
            words, off = ("refined", both.off) if law in REFINED else ("on their finest grids", both.apart)
            energy, strain = (f"{100 * off(name):.1f} %" for name in ("energy", "strain"))
            yield (
                f"{STEELS[law].capitalize()}: over the first pass the models differ by {energy} "
                f"in the energy and by {strain} in the largest strain of some pass, both {words}."
            )
        pressure = found.laws["prager"].sam[max(CELLS)].pressure * np.sqrt(3) / PRAGER.yield_stress
        yield (
            "The yield stress of the kinematic steel is constant: what a pass dissipates is its plastic "
            "strain, summed over the body, times the yield stress. Its largest strain is not held by a gate: "
            "elements at depths from a/4 to a/2 flow on when all others have come to rest, the less the "
            f"smaller they are. The groove lowers the largest pressure to {pressure:.2f} k, k the shear "
            "strength: below the 4.68 k of a rolling Hertz pressure later passes should die out, as in SAM."
        )

    def figures(self, found: Found) -> Iterator[Plot]:
        runs = {
            f"{STEELS[law]}, {model} a/{max(runs)}": list(runs[max(runs)].strain)
            for law, both in found.laws.items()
            for model, runs in (("SAM", both.sam), ("finite elements", both.fem))
        }
        floors = sorted({run.floor for both in found.laws.values() for run in both.sam.values()})
        yield Plot(
            new_strains(runs, floors),
            "new-strain",
            "What each pass adds in both models",
            "Largest new plastic strain over the number of the pass, both models",
            "Largest plastic strain that a pass adds to a cell or element of the steady part of the track; "
            "below its floor the verdict counts none.",
        )


def passes_to(count: int) -> tuple[str, ...]:
    """Heads of columns."""
    return tuple(f"pass {k + 1}" for k in range(count))


def rows_of_many(ratio: float, run: Result) -> Iterator[tuple[str, ...]]:
    """Strains and verdicts of the passes of a run of SAM."""
    strains = run.tables["passes"]["new_strain_max"]
    yield f"{ratio:g}", "strain", *(f"{1e3 * v:.4g}" for v in strains)
    yield "", "verdict", *map(str, run.tables["cycles"]["verdict"])


CASES = (MovingPassesSpatial("moving-passes-spatial"),)
