# SPDX-License-Identifier: MIT
"""Three asperities that yield under a rigid plane, with and without friction: SAM against finite elements in three dimensions.

Both solve the same heights on the same cells; what they share is no more than the scene.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from sam.scene import Friction, Grid, Result, Scene
from verification.compare.rough_measures import (
    Depths,
    PatchPressure,
    Spot,
    compared_depths,
    residual_line,
    spots,
)
from verification.figures.rough_contact import Below, below_spots, pressures, residual
from verification.runs.models import FEM_3D, SAM
from verification.scenes.asperities import HIGH, LOW, SIDE, friction_map, height_map
from verification.suite.cases.case import Case, Context, Outcome, SmallTable, mesh_text, with_loading
from verification.suite.cases.plastic import EQUATIONS, initial_yield
from verification.suite.gates import Measured
from verification.text.console import number

SCENE = "rough-asperities"
CELLS = {"quick": 32, "full": 48}
COARSER, FINER = (32, 40), (64, 96)  # FEM and SAM; SAM alone
LAYER = 0.5  # of a cell: thickness of the layers of SAM
DEEP, SHOWN, REACH = 3.6e-6, 2.0e-6, 3.2e-6  # m: layers of SAM down to; depth and width of the figures
MAP = "map"


@dataclass(frozen=True)
class Setting:
    """friction: a coefficient, or MAP; steps: None takes those of the scene; trend: solved on other grids as well."""

    name: str
    friction: float | str
    level: str = "full"
    steps: int | None = None
    trend: bool = False


@dataclass(frozen=True)
class Solved:
    """The results of one scene on the same cells."""

    sam: Result
    fem: Result

    @cached_property
    def patches(self) -> tuple[PatchPressure, PatchPressure]:
        """Surfaces of SAM and FEM at peak load."""
        return PatchPressure.of(self.sam.tables), PatchPressure.of(self.fem.tables)

    @cached_property
    def spots(self) -> list[Spot]:
        return spots(*self.patches)

    @cached_property
    def depths(self) -> tuple[Depths, Depths]:
        """Plastic strains of SAM and FEM in y = 0."""
        return Depths.of(self.sam.tables), Depths.of(self.fem.tables)

    def profiles(self, spot: Spot) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Depths in m, and the strains of SAM and FEM there, below the centre of a spot."""
        own, fem = self.depths
        z = compared_depths(fem, spot.x, spot.radius)
        return z, own.below(spot.x, z), fem.below(spot.x, z)

    def lines(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """x of the cells in m, and the residual displacements of SAM and FEM along y = 0."""
        (x, own), (nodes, fem) = residual_line(self.sam.tables), residual_line(self.fem.tables)
        return x, own, np.interp(x, nodes, fem)

    def differences(self) -> dict[str, float]:
        """SAM off FEM: area, loads (the largest of the spots), pressure and residual line (L2), strain (the largest, L2)."""
        own, fem = self.patches
        _, line, reference = self.lines()
        strains = [relative_l2(*self.profiles(spot)[1:]) for spot in self.spots]
        return {
            "area": abs(
                self.sam.quantities["contact_area_m2"] / self.fem.quantities["contact_area_m2"] - 1.0
            ),
            "load": max(abs(spot.sam / spot.fem - 1.0) for spot in self.spots),
            "pressure": relative_l2(own.p, fem.p),
            "strain": max(strains),
            "residual": relative_l2(line, reference),
        }


def relative_l2(value: np.ndarray, reference: np.ndarray) -> float:
    """|value - reference|/|reference|."""
    return float(np.linalg.norm(value - reference) / np.linalg.norm(reference))


def at(base: Scene, setting: Setting, cells: int) -> Scene:
    """The scene on cells x cells cells, with the friction of the setting."""
    surface = base.surface.model_copy(update={"path": height_map(cells)})
    layers = round(DEEP / (LAYER * SIDE / cells))
    scene = with_loading(base, steps=setting.steps or base.loading.steps)
    scene = scene.model_copy(update={"surface": surface, "grid": Grid(layers=layers, depth=DEEP)})
    if setting.friction == MAP:
        return scene.model_copy(update={"friction": Friction(law="map", path=friction_map(cells))})
    return scene.model_copy(
        update={"friction": Friction(coefficient=setting.friction) if setting.friction else None}
    )


def solved(context: Context, base: Scene, setting: Setting, cells: int) -> Solved:
    """Both models on these cells."""
    scene = at(base, setting, cells)
    return Solved(context.solve(SAM, scene, f"sam-{cells}"), context.solve(FEM_3D, scene, f"fem-{cells}"))


def run(context: Context, setting: Setting) -> Outcome:
    """Solve, compare and draw one friction."""
    base, cells = context.scene(SCENE), CELLS[setting.level]
    found = solved(context, base, setting, cells)
    outcome = Outcome(setup=setup(at(base, setting, cells), setting, found))
    outcome.values = {f"{context.case}.{name}": value for name, value in compared(found).items()}
    if setting.friction == MAP:
        overall = (result.quantities["friction_coefficient"] for result in (found.sam, found.fem))
        outcome.values[f"{context.case}.friction"] = Measured(*overall)
    outcome.tables += [spots_table(found), numbers(found)]
    if setting.trend:
        coarser = {n: solved(context, base, setting, n) for n in COARSER} | {cells: found}
        finer = {n: context.solve(SAM, at(base, setting, n), f"sam-{n}") for n in FINER}
        outcome.tables += [trend_table(coarser), quantities_table(coarser, finer)]
        first, last = (coarser[n].differences() for n in (COARSER[0], cells))
        for name in ("pressure", "strain", "residual"):
            outcome.values[f"{context.case}.shrinks-{name}"] = Measured(last[name] / first[name])
    draw(context, outcome, found)
    return outcome


def compared(found: Solved) -> dict[str, Measured]:
    """SAM against FEM: area, pressure, the load of each spot and the strain below it, what is left after unloading."""
    own, fem = found.patches
    areas = (result.quantities["contact_area_m2"] for result in (found.sam, found.fem))
    values = {
        "spots": Measured(len(found.spots), 3),
        "area": Measured(*areas, unit="m²"),
        "pressure": Measured(own.p, fem.p),
        "residual": Measured(*found.lines()[1:], unit="m"),
    }
    for k, spot in enumerate(found.spots, start=1):
        values[f"load-{k}"] = Measured(spot.sam, spot.fem, unit="N")
        values[f"strain-{k}"] = Measured(*found.profiles(spot)[1:])
    return values


def setup(scene: Scene, setting: Setting, found: Solved) -> list[tuple[str, str]]:
    """The numbers of the case for the reader."""
    nx, ny = found.sam.discretisation["cells"]
    friction = (
        f"{LOW:g}, in the middle {HIGH:g}" if setting.friction == MAP else f"{setting.friction:g} everywhere"
    )
    return [
        (
            "Half-space",
            f"E = {scene.body.young / 1e9:g} GPa, ν = {scene.body.poisson:g}; Swift, as in {SCENE}",
        ),
        ("Initial yield stress", f"{initial_yield(scene) / 1e6:.1f} MPa"),
        ("Surface", f"three Gaussian asperities on {SIDE * 1e6:g} × {SIDE * 1e6:g} µm under a rigid plane"),
        ("Friction", f"μ = {friction}; q = μp along +x on the body, in every step"),
        ("Force", f"{scene.loading.force * 1e3:g} mN in {scene.loading.steps} equal steps, then lifted"),
        ("SAM", f"{nx} × {ny} cells, {found.sam.discretisation['depths']} layers of half a cell"),
        (
            "FEM",
            f"{mesh_text(found.fem)}, a surface node in the centre of each cell, box {scene.fem.box:g} half sides",
        ),
    ]


def spots_table(found: Solved) -> SmallTable:
    """What each spot bears, and the largest strain compared below it."""
    rows = []
    for k, spot in enumerate(found.spots, start=1):
        _, own, fem = found.profiles(spot)
        rows.append(
            (
                f"{k}",
                f"{spot.x * 1e6:.2f}, {spot.y * 1e6:.2f}",
                *(f"{load * 1e3:.3f}" for load in (spot.sam, spot.fem)),
                f"{1e2 * (spot.sam / spot.fem - 1.0):+.2f} %",
                f"{spot.radius * 1e6:.2f}",
                *(f"{1e2 * strain.max():.3f}" for strain in (own, fem)),
                f"{1e2 * relative_l2(own, fem):.2f} %",
            )
        )
    columns = (
        *("spot", "x, y [µm]", "load, SAM [mN]", "FEM", "difference", "radius [µm]"),
        *("largest strain at z ≥ 0.3 radii, SAM [%]", "FEM", "strain over depth, L2"),
    )
    return SmallTable("The contact spots", columns, rows)


SHOWN_QUANTITIES = {
    "contact_area_m2": ("contact area [µm²]", 1e12),
    "approach_m": ("approach [nm]", 1e9),
    "p_max_Pa": ("largest pressure [GPa]", 1e-9),
    "peeq_max": ("largest plastic strain [%]", 1e2),
    "friction_coefficient": ("coefficient of friction, whole", 1.0),
    "pressure_centroid_x_m": ("centre of pressure, x [µm]", 1e6),
}


def numbers(found: Solved) -> SmallTable:
    """Scalar results side by side, and the cost."""
    rows = []
    for name, (words, unit) in SHOWN_QUANTITIES.items():
        a, b = (result.quantities[name] for result in (found.sam, found.fem))
        off = f"{1e2 * (a / b - 1.0):+.2f} %" if b else ""
        rows.append((words, number(a * unit, 5), number(b * unit, 5), off))
    rows.append(
        ("solution [s]", *(number(result.cost["solve_s"], 3) for result in (found.sam, found.fem)), "")
    )
    return SmallTable("SAM and FEM", ("quantity", "SAM", "FEM", "difference"), rows)


def trend_table(found: Mapping[int, Solved]) -> SmallTable:
    """The differences between the models on coarse and fine grids."""
    rows = []
    for cells, each in found.items():
        off = each.differences()
        rows.append(
            (
                f"{cells} × {cells}",
                f"{SIDE / cells * 1e6:.3f}",
                *(f"{1e2 * value:.2f} %" for value in off.values()),
            )
        )
    columns = (
        *("cells", "size [µm]", "area", "load of a spot, largest", "pressure, L2"),
        *("strain over depth, largest L2", "residual heights, L2"),
    )
    return SmallTable("Refinement: SAM off FEM on the same cells", columns, rows)


def quantities_table(found: Mapping[int, Solved], finer: Mapping[int, Result]) -> SmallTable:
    """Where each model is heading."""
    results = [("FEM", n, each.fem) for n, each in found.items()] + [
        ("SAM", n, each.sam) for n, each in found.items()
    ]
    results += [("SAM", n, result) for n, result in finer.items()]
    names = ("contact_area_m2", "approach_m", "p_max_Pa", "peeq_max")
    rows = []
    for model, cells, result in results:
        uz = residual_line(result.tables)[1]
        values = (number(result.quantities[name] * SHOWN_QUANTITIES[name][1], 5) for name in names)
        rows.append((model, f"{cells} × {cells}", *values, number(uz.max() * 1e9, 4)))
    columns = (
        "model",
        "cells",
        *(SHOWN_QUANTITIES[name][0] for name in names),
        "largest residual depth [nm]",
    )
    return SmallTable("Refinement of each model", columns, rows)


def draw(context: Context, outcome: Outcome, found: Solved) -> None:
    """Pressure maps, plastic strain below the spots, residual heights."""
    own, fem = found.patches
    drawing = pressures(own.x, own.y, own.p, fem.p, REACH)
    words = "Maps of the pressure by SAM and FEM and their difference: three spots, which differ in the cells at their edges."
    outcome.figures.append(
        context.save(drawing, "pressure", "Pressure of the three spots", words, "At peak load.")
    )
    panels = []
    for k, spot in enumerate(found.spots, start=1):
        curves = []
        for depths in found.depths:
            z = (
                np.linspace(depths.z[0], SHOWN, 100)
                if depths is found.depths[0]
                else depths.z[depths.z <= SHOWN]
            )
            curves.append((z, depths.below(spot.x, z)))
        panels.append(Below(f"spot {k}, x = {spot.x * 1e6:.2f} µm", *curves, found.profiles(spot)[0][0]))
    words = (
        "Plastic strain over depth below each of the three spots: SAM as a line through the points of FEM."
    )
    caption = (
        "In y = 0 at peak load, below the centre of each spot. Grey: too near the surface to be compared."
    )
    outcome.figures.append(
        context.save(below_spots(panels), "strain", "Plastic strain below the spots", words, caption)
    )
    x, line, _ = found.lines()
    nodes, uz = residual_line(found.fem.tables)
    near = np.abs(nodes) <= SIDE / 2
    words = "Change of the heights along y = 0 after unloading: a dent on each asperity, with a low rim, by SAM and FEM."
    drawing = residual((x, line), (nodes[near], uz[near]))
    outcome.figures.append(
        context.save(drawing, "residual", "Residual heights", words, "Along y = 0 after unloading.")
    )


SETTINGS = (
    Setting("rough-contact-quick", 0.0, "quick", steps=1),
    Setting("rough-contact", 0.0, trend=True),
    Setting("rough-contact-0-2", 0.2),
    Setting("rough-contact-0-4", 0.4),
    Setting("rough-contact-map", MAP),
)


def _cases() -> Iterator[Case]:
    sources = (
        *EQUATIONS[:2],
        (
            "Gap",
            "g = −h + u_z − δ ≥ 0,  p ≥ 0,  g p = 0 in the centre of every cell",
            "Johnson (1985), Sec. 4.1",
        ),
        (
            "Full slip",
            "q = μp along +x on the body, μ that of the cell, in every step",
            "Bosman & Schipper (2011), section 3",
        ),
    )
    for setting in SETTINGS:
        words = "a map of friction" if setting.friction == MAP else f"μ = {setting.friction:g}"
        yield Case(
            setting.name,
            f"Three asperities, Swift, {words}" + ", one step" * (setting.steps == 1),
            "Do SAM and FEM give the same spots, loads, pressure, plastic strain and residual heights of a rough contact?",
            partial(run, setting=setting),
            sources,
            (setting.level,),
        )


CASES = tuple(_cases())
