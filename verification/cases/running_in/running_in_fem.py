# SPDX-License-Identifier: MIT
"""Three asperities that harden by back-stresses and wear between the cycles: SAM against finite elements.

Each model removes by its own plastic strain, with a rule and a transfer of the state of its own; beside it
the finite elements remove what SAM does, so that the transfer alone is compared.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import lcm

import numpy as np

from fem_reference.spatial import WornCycle, worn_cycles
from sam.scene import Plasticity, Result, Scene, Wear
from verification.cases.case import SAM, Case, Context, Measured, Plot, SmallTable, with_body, with_loading
from verification.cases.recipes import cells_of_asperities, rubbed
from verification.compare.rough_measures import Depths, PatchPressure, compared_depths, relative_l2, spots
from verification.figures.lines import residual
from verification.scenes.asperities import HIGH, LOW, SIDE

SCENE = "rough-asperities"
CELLS = (32, 48, 64)
SQUARES = 16  # along a side; the rim of a scar bears on single cells, of any size
CYCLES, STEPS = 3, 2
LIMIT, THICK = 0.012, 4e-9  # of the plastic strain, down to this depth in m below the surface of each cycle
LAW = Plasticity(
    law="linear",
    yield_stress=1.36e9,  # of rough-asperities.toml, before any strain
    modulus=10e9,
    layer_thickness=THICK,
    kinematic={"modulus": (100e9,), "recovery": (100.0,)},
)
OWN, GIVEN = "own strain", "depths of SAM"
MEASURES = {
    "pressure": "pressure, L2",
    "squares": f"pressure, L2 of means over squares of {SIDE / SQUARES * 1e6:g} µm",
    "strain": "strain over depth, largest L2",
    "residual": "lost height, L2",
    "moved": "displacement, L2",
    "volume": "worn volume",
}
PREFIXES = {"own": OWN, "given": GIVEN}
COMPARED = {
    OWN: ("pressure", "squares", "strain", "residual", "volume"),
    GIVEN: ("pressure", "squares", "strain", "moved"),
}
UNRESOLVED = {(OWN, "pressure"), (OWN, "volume")}
"""What cells on the rims of scars decide: it need not fall from grid to grid."""


@dataclass(frozen=True)
class Solved:
    """One grid. sam, first: over all cycles, and over one alone; fem: how it removes -> its cycles."""

    sam: Result
    first: Result
    fem: Mapping[str, Sequence[WornCycle]]

    @cached_property
    def worn(self) -> np.ndarray:
        """(cycles, nx, ny) depth in m that SAM has removed up to the end of each cycle."""
        states = (*(f"cycle-{cycle}" for cycle in range(1, CYCLES)), "unloaded")
        return np.array([_surface(self.sam, state, "worn_m") for state in states])

    @property
    def steps(self) -> np.ndarray:
        """The same in each cycle."""
        return np.diff(self.worn, axis=0, prepend=0.0 * self.worn[:1])

    @property
    def cycles(self) -> dict[str, list[tuple[float, ...]]]:
        """Model -> number of each cycle, volume in um3, largest depth in nm, pressure in GPa, strain in %."""
        area, own = (SIDE / self.worn.shape[1]) ** 2, self.sam.tables["cycles"]
        runs = {"SAM": list(zip(self.worn, own["p_max_Pa"], own["peeq_max"], strict=True))}
        for name, fem in self.fem.items():
            peaks = (PatchPressure.of(each.tables).p.max() for each in fem)
            runs[f"FEM, {name}"] = [(c.worn, p, c.peeq_max) for c, p in zip(fem, peaks, strict=True)]
        return {
            name: [
                (k, 1e18 * area * worn.sum(), 1e9 * worn.max(), 1e-9 * pressure, 100 * strain)
                for k, (worn, pressure, strain) in enumerate(cycles, start=1)
            ]
            for name, cycles in runs.items()
        }

    def differences(self, name: str, cycle: int = CYCLES) -> dict[str, float]:
        """SAM off FEM at the peak of the first or the last cycle and after it, see MEASURES.

        The strain is that below the spots of the first cycle, which a scar divides later.
        """
        sam, fem = self.first if cycle == 1 else self.sam, self.fem[name][cycle - 1]
        own, other = PatchPressure.of(sam.tables), PatchPressure.of(fem.tables)
        below = Depths.of(sam.tables), Depths.of(fem.tables)
        strains, before = [], self.fem[name][0].tables
        for spot in spots(*map(PatchPressure.of, (self.first.tables, before))):
            z = compared_depths(below[1], spot.x, spot.radius)
            strains.append(relative_l2(*(each.below(spot.x, z) for each in below)))
        worn, moved = (_surface(sam, "unloaded", column) for column in ("worn_m", "uz_m"))
        return {
            "pressure": relative_l2(own.p, other.p),
            "squares": relative_l2(over_squares(own.p), over_squares(other.p)),
            "strain": max(strains),
            "residual": relative_l2(worn + moved, fem.worn + fem.moved),
            "moved": relative_l2(moved, fem.moved),
            "volume": abs(worn.sum() / fem.worn.sum() - 1.0),
        }


def _surface(sam: Result, state: str, column: str) -> np.ndarray:
    """(nx, ny) of the cells of SAM."""
    found: np.ndarray = sam.grids[state]["surface"].cell_data[column][..., 0]
    return found


def over_squares(values: np.ndarray) -> np.ndarray:
    """(SQUARES, SQUARES) means of values on cells (n, n), each cell by its shares of the squares."""
    parts = lcm(SQUARES, n := values.shape[0])
    fine, along = values.repeat(parts // n, axis=0).repeat(parts // n, axis=1), parts // SQUARES
    means: np.ndarray = fine.reshape(SQUARES, along, SQUARES, along).mean(axis=(1, 3))
    return means


def scene_of(base: Scene, cells: int) -> Scene:
    """The asperities on cells x cells cells, with back-stresses, friction map and wear."""
    scene = cells_of_asperities(rubbed(base, "map"), cells)
    scene = with_loading(scene, steps=STEPS, cycles=CYCLES)
    wear = Wear(strain_limit=np.inf, strain_limit_layer=LIMIT, smoothing_window=0)
    return with_body(scene, plasticity=LAW).model_copy(update={"wear": wear})


def solved(context: Context, base: Scene, cells: int) -> Solved:
    """Both models, and FEM with the depths of SAM."""
    scene = scene_of(base, cells)
    alone = with_loading(scene, cycles=1)
    sam, first = context.solve(SAM, scene, f"sam-{cells}"), context.solve(SAM, alone, f"sam-{cells}-alone")
    found, fem = Solved(sam, first, {}), {}
    for name in (OWN, GIVEN):
        context.progress(f"{context.case}, {cells} cells, FEM, {name}", CELLS.index(cells), len(CELLS))
        fem[name] = worn_cycles(scene, list(found.steps) if name == GIVEN else None)
    return Solved(sam, first, fem)


class RunningInFem(Case):
    """Both models over the cycles on three grids."""

    def solve(self, context: Context) -> dict[int, Solved]:
        base = context.scene(SCENE)
        return {cells: solved(context, base, cells) for cells in CELLS}

    def measure(self, found: dict[int, Solved]) -> dict[str, Measured]:
        values = {"wears": Measured(min(step.max() for step in found[CELLS[-1]].steps), unit="m")}
        for prefix, name in PREFIXES.items():
            grids = [found[cells].differences(name) for cells in CELLS]
            for what in COMPARED[name]:
                values[f"{prefix}-{what}"] = Measured(grids[-1][what])
                if (name, what) not in UNRESOLVED:
                    ratios = [fine[what] / coarse[what] for coarse, fine in pairwise(grids)]
                    values[f"shrinks-{prefix}-{what}"] = Measured(max(ratios))
        return values

    def setup(self, found: dict[int, Solved]) -> Iterator[tuple[str, str]]:
        (modulus, *_), (recovery, *_) = LAW.kinematic.modulus, LAW.kinematic.recovery
        back = f"a back-stress with C = {modulus / 1e9:g} GPa, γ = {recovery:g}"
        yield "Half-space", f"σ_y = {LAW.yield_stress / 1e9:g} GPa + {LAW.modulus / 1e9:g} GPa p, {back}"
        side = f"{SIDE * 1e6:g} × {SIDE * 1e6:g} µm under a rigid plane"
        yield "Surface", f"three Gaussian asperities on {side}"
        yield "Friction", f"μ = {LOW:g}, in the middle {HIGH:g}; q = μp along +x on the body"
        removed = f"removed above a plastic strain of {LIMIT:.1%}"
        yield "Cycles", f"{CYCLES} of {STEPS} steps to the peak; {removed}"
        yield "Cells", ", ".join(f"{n} × {n}" for n in found)

    def tables(self, found: dict[int, Solved]) -> Iterator[SmallTable]:
        rows = [
            (f"{n} × {n}", str(cycle), name, *(f"{100 * value:.2f} %" for value in off.values()))
            for n, each in found.items()
            for cycle in (1, CYCLES)
            for name in (OWN, GIVEN)
            if (off := each.differences(name, cycle))
        ]
        words = "SAM off FEM: at the peak of a cycle, and unloaded after its removal"
        yield SmallTable(words, ("cells", "cycle", "FEM removes by", *MEASURES.values()), rows)
        rows = [
            (f"{n} × {n}", name, *(f"{value:.4g}" for value in values))
            for n, each in found.items()
            for name, cycles in each.cycles.items()
            for values in cycles
        ]
        columns = "cells|model|cycle|volume [µm³]|largest depth [nm]|p_max [GPa]|largest strain [%]"
        words = "Each cycle: worn so far, largest pressure and plastic strain at the peak"
        yield SmallTable(words, columns.split("|"), rows)

    def notes(self, found: dict[int, Solved]) -> Iterator[str]:
        grows = [
            f"{MEASURES[what]}, FEM by {name}"
            for name in PREFIXES.values()
            for what, value in found[CELLS[-1]].differences(name).items()
            if value > found[CELLS[0]].differences(name)[what]
        ]
        if grows:
            yield f"Larger on the finest grid after {CYCLES} cycles: {'; '.join(grows)}."
        yield (
            f"The rim of a scar is a step of {1e9 * THICK:g} nm from one cell to the next, on which single "
            "cells bear: there neither model is resolved. Where each model removes by itself, cells near the "
            "limit decide."
        )

    def figures(self, found: dict[int, Solved]) -> Iterator[Plot]:
        fine = found[CELLS[-1]]
        x, fem = PatchPressure.of(fine.sam.tables).x, fine.fem[OWN][-1]
        lost = fine.worn[-1] + _surface(fine.sam, "unloaded", "uz_m"), fem.worn + fem.moved
        middle = slice(x.size // 2 - 1, x.size // 2 + 1)
        yield Plot(
            residual(*((x, each[:, middle].mean(axis=1)) for each in lost)),
            "lowered",
            f"Surface after {CYCLES} cycles",
            "Change of the heights along y = 0 by wear and plastic strain, of SAM and FEM.",
            "Unloaded, after the last removal, each model by its own plastic strain.",
        )


CASES = (RunningInFem("running-in-fem"),)
