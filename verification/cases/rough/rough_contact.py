# SPDX-License-Identifier: MIT
"""Three asperities that yield under a rigid plane, with and without friction: SAM against finite elements in
three dimensions.

Both solve the same heights on the same cells; what they share is no more than the scene.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sam.scene import CounterSurface, Friction, Grid, Result, Scene
from verification.cases.case import (
    FEM_3D,
    SAM,
    Case,
    Context,
    Measured,
    Plot,
    SmallTable,
    elastic_text,
    mesh_text,
    number,
    off_text,
    quantity_rows,
    with_keys,
    with_loading,
)
from verification.cases.plastic.plastic_layer import LINEAR, with_layer
from verification.cases.recipes import initial_yield
from verification.compare.rough_measures import (
    Depths,
    PatchPressure,
    Spot,
    compared_depths,
    residual_line,
    spots,
)
from verification.figures.rough_contact import Below, below_spots, pressures, residual
from verification.scenes.asperities import HIGH, LOW, SIDE, friction_map, height_map

SCENE = "rough-asperities"
CELLS = {"quick": 32, "full": 48}
COARSER, FINER = (32, 40), (64, 96)  # FEM and SAM; SAM alone
LAYER = 0.5  # of a cell: thickness of the layers of SAM
DEEP, SHOWN, REACH = 3.6e-6, 2.0e-6, 3.2e-6  # m: layers of SAM down to; depth and width of the figures
MAP = "map"
MODELS = ((SAM, "sam"), (FEM_3D, "fem"))
THICK = 0.9e-6  # m: of a layer with a law of its own; the strain of each spot is largest in it


@dataclass(frozen=True)
class Setting:
    """friction: a coefficient, or MAP; steps, cells: None takes those of the scene and of the level; trend:
    solved on other grids as well; opposite: the asperities are on the counter-body, and the body is smooth;
    layer: the body has a layer with a law of its own.
    """

    name: str
    friction: float | str
    level: str = "full"
    steps: int | None = None
    trend: bool = False
    opposite: bool = False
    layer: bool = False
    cells: int | None = None


@dataclass(frozen=True)
class SolvedAsperities:
    """The results of one scene on the same cells. jump: depth in m at which the hardening law changes."""

    sam: Result
    fem: Result
    jump: float = 0.0

    @cached_property
    def patches(self) -> tuple[PatchPressure, PatchPressure]:
        """Surfaces of SAM and FEM at peak load."""
        return PatchPressure.of(self.sam.tables), PatchPressure.of(self.fem.tables)

    @cached_property
    def spots(self) -> list[Spot]:
        """The contact spots."""
        return spots(*self.patches)

    @cached_property
    def depths(self) -> tuple[Depths, Depths]:
        """Plastic strains of SAM and FEM in y = 0."""
        return Depths.of(self.sam.tables, self.jump), Depths.of(self.fem.tables, self.jump)

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
        """SAM off FEM: area, loads (the largest of the spots), pressure and residual line (L2), strain (the
        largest, L2).
        """
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
    surfaces = {"surface": base.surface.model_copy(update={"path": height_map(cells)})}
    if setting.opposite:
        asperities = CounterSurface(kind="file", path=height_map(cells))
        counterbody = base.counterbody.model_copy(update={"surface": asperities})
        surfaces = {"surface": None, "counterbody": counterbody}
    scene = with_loading(base, steps=setting.steps or base.loading.steps)
    if setting.layer:
        scene = with_layer(with_keys(scene, "body.plasticity", layer_thickness=THICK), LINEAR)
    scene = scene.model_copy(update={**surfaces, "grid": layers_of(LAYER * SIDE / cells, setting.layer)})
    if setting.friction == MAP:
        return scene.model_copy(update={"friction": Friction(law="map", path=friction_map(cells))})
    constant = Friction(coefficient=setting.friction) if setting.friction else None
    return scene.model_copy(update={"friction": constant})


def layers_of(thickness: float, jumps: bool) -> Grid:
    """Even layers of SAM of about this thickness in m; jumps: with a face where the hardening law changes."""
    if not jumps:
        return Grid(layers=round(DEEP / thickness), depth=DEEP)
    above, under = (round(part / thickness) for part in (THICK, DEEP - THICK))
    faces = *np.linspace(0.0, THICK, above + 1), *np.linspace(THICK, DEEP, under + 1)[1:]
    return Grid(depths=tuple(map(float, faces)))


def solved(context: Context, base: Scene, setting: Setting, cells: int) -> SolvedAsperities:
    """Both models on these cells."""
    scene = at(base, setting, cells)
    sam, fem = (context.solve(model, scene, f"{name}-{cells}") for model, name in MODELS)
    return SolvedAsperities(sam, fem, THICK if setting.layer else 0.0)


@dataclass(frozen=True)
class Frictions:
    """One friction on the grid of its level, and on others for the trend. coarser: both models; finer: SAM
    alone.
    """

    base: Scene
    cells: int
    solved: SolvedAsperities
    coarser: Mapping[int, SolvedAsperities]
    finer: Mapping[int, Result]


@dataclass(frozen=True)
class RoughContact(Case):
    """Both models on the same cells, with the friction of its setting."""

    setting: Setting | None = None

    def solve(self, context: Context) -> Frictions:
        base, cells = context.scene(SCENE), self.setting.cells or CELLS[self.setting.level]
        coarser, finer = (COARSER, FINER) if self.setting.trend else ((), ())
        return Frictions(
            base,
            cells,
            solved(context, base, self.setting, cells),
            {n: solved(context, base, self.setting, n) for n in coarser},
            {n: context.solve(SAM, at(base, self.setting, n), f"sam-{n}") for n in finer},
        )

    def measure(self, found: Frictions) -> dict[str, Measured | float]:
        values = compared(found.solved)
        if self.setting.friction == MAP:
            results = found.solved.sam, found.solved.fem
            values["friction"] = Measured(*(each.quantities["friction_coefficient"] for each in results))
        if found.coarser:
            first, last = found.coarser[COARSER[0]].differences(), found.solved.differences()
            shrinks = ("pressure", "strain", "residual")
            values |= {f"shrinks-{name}": Measured(last[name] / first[name]) for name in shrinks}
        return values

    def setup(self, found: Frictions) -> list[tuple[str, str]]:
        scene, sam, fem = at(found.base, self.setting, found.cells), found.solved.sam, found.solved.fem
        of_map, cells = f"{LOW:g}, in the middle {HIGH:g}", "{} × {}".format(*sam.discretisation["cells"])
        friction = of_map if self.setting.friction == MAP else f"{self.setting.friction:g} everywhere"
        return [
            ("Half-space", f"{elastic_text(scene.body)}; Swift, as in {SCENE}"),
            ("Initial yield stress", f"{initial_yield(scene) / 1e6:.1f} MPa"),
            (
                "Surface",
                f"three Gaussian asperities on {SIDE * 1e6:g} × {SIDE * 1e6:g} µm {_pressed(self.setting)}",
            ),
            ("Friction", f"μ = {friction}; q = μp along +x on the body, in every step"),
            (
                "Force",
                f"{scene.loading.force * 1e3:g} mN in {scene.loading.steps} equal steps, then unloaded",
            ),
            ("SAM", f"{cells} cells, {sam.discretisation['depths']} layers of half a cell"),
            (
                "FEM",
                f"{mesh_text(fem)}, a surface node in the centre of each cell, box {scene.fem.box:g} half "
                "sides",
            ),
        ]

    def tables(self, found: Frictions) -> Iterator[SmallTable]:
        yield spots_table(found.solved)
        yield numbers(found.solved)
        if found.coarser:
            grids = dict(found.coarser) | {found.cells: found.solved}
            yield trend_table(grids)
            yield quantities_table(grids, found.finer)

    def figures(self, found: Frictions) -> Iterator[Plot]:
        own, fem = found.solved.patches
        yield Plot(
            pressures(own.x, own.y, own.p, fem.p, reach=REACH),
            "pressure",
            "Pressure of the three spots",
            "Maps of the pressure by SAM and FEM and their difference: three spots, which differ in the "
            "cells at their edges.",
            "At peak load.",
        )
        yield Plot(
            below_spots([below(found.solved, k) for k in range(len(found.solved.spots))]),
            "strain",
            "Plastic strain below the spots",
            "Plastic strain over depth below each of the three spots: SAM as a line through the points of "
            "FEM.",
            "In y = 0 at peak load, below the centre of each spot. Grey: too near the surface to be "
            "compared.",
        )
        x, line, _ = found.solved.lines()
        nodes, uz = residual_line(found.solved.fem.tables)
        near = np.abs(nodes) <= SIDE / 2
        yield Plot(
            residual((x, line), (nodes[near], uz[near])),
            "residual",
            "Residual heights",
            "Change of the heights along y = 0 after unloading: a dent on each asperity, with a low rim, by "
            "SAM and FEM.",
            "Along y = 0 after unloading.",
        )


def below(found: SolvedAsperities, k: int) -> Below:
    """Plastic strain below a spot: SAM as a line, FEM at its points."""
    spot, (own, fem) = found.spots[k], found.depths
    depths = np.linspace(own.z[0], SHOWN, 100), fem.z[fem.z <= SHOWN]
    curves = ((z, each.below(spot.x, z)) for z, each in zip(depths, (own, fem), strict=True))
    return Below(f"spot {k + 1}, x = {spot.x * 1e6:.2f} µm", *curves, found.profiles(spot)[0][0])


def compared(found: SolvedAsperities) -> dict[str, Measured]:
    """SAM against FEM: area, pressure, the load of each spot and the strain below it, what is left after
    unloading.
    """
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


def spots_table(found: SolvedAsperities) -> SmallTable:
    """What each spot bears, and the largest strain compared below it."""
    rows = []
    for k, spot in enumerate(found.spots, start=1):
        _, own, fem = found.profiles(spot)
        rows.append(
            (
                f"{k}",
                f"{spot.x * 1e6:.2f}, {spot.y * 1e6:.2f}",
                *(f"{load * 1e3:.3f}" for load in (spot.sam, spot.fem)),
                off_text(spot.sam, spot.fem),
                f"{spot.radius * 1e6:.2f}",
                *(f"{1e2 * strain.max():.3f}" for strain in (own, fem)),
                f"{1e2 * relative_l2(own, fem):.2f} %",
            )
        )
    return SmallTable(
        "The contact spots",
        (
            *("spot", "x, y [µm]", "load, SAM [mN]", "FEM", "difference", "radius [µm]"),
            *("largest strain at z ≥ 0.3 radii, SAM [%]", "FEM", "strain over depth, L2"),
        ),
        rows,
    )


SHOWN_QUANTITIES = {
    "contact_area_m2": ("contact area [µm²]", 1e12),
    "approach_m": ("approach [nm]", 1e9),
    "p_max_Pa": ("largest pressure [GPa]", 1e-9),
    "peeq_max": ("largest plastic strain [%]", 1e2),
    "friction_coefficient": ("coefficient of friction, whole", 1.0),
    "pressure_centroid_x_m": ("centre of pressure, x [µm]", 1e6),
}


def numbers(found: SolvedAsperities) -> SmallTable:
    """Scalar results side by side, and the cost."""
    rows = quantity_rows(SHOWN_QUANTITIES, found.sam, found.fem)
    times = (number(result.cost["solve_s"], 3) for result in (found.sam, found.fem))
    rows.append(("solution [s]", *times, ""))
    return SmallTable("SAM and FEM", ("quantity", "SAM", "FEM", "difference"), rows)


def trend_table(found: Mapping[int, SolvedAsperities]) -> SmallTable:
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
    return SmallTable(
        "Refinement: SAM off FEM on the same cells",
        (
            *("cells", "size [µm]", "area", "load of a spot, largest", "pressure, L2"),
            *("strain over depth, largest L2", "residual heights, L2"),
        ),
        rows,
    )


def quantities_table(found: Mapping[int, SolvedAsperities], finer: Mapping[int, Result]) -> SmallTable:
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
    return SmallTable(
        "Refinement of each model",
        (
            "model",
            "cells",
            *(SHOWN_QUANTITIES[name][0] for name in names),
            "largest residual depth [nm]",
        ),
        rows,
    )


SETTINGS = (
    Setting("rough-contact-quick", 0.0, "quick", steps=1),
    Setting("rough-contact", 0.0, trend=True),
    Setting("rough-counterbody-quick", 0.0, "quick", steps=1, opposite=True),
    Setting("rough-counterbody", 0.0, opposite=True),
    Setting("rough-layer", 0.0, "full", steps=1, layer=True, cells=40),
    Setting("rough-contact-0-2", 0.2),
    Setting("rough-contact-0-4", 0.4),
    Setting("rough-contact-map", MAP),
)


def _pressed(setting: Setting) -> str:
    """What the asperities are on."""
    if setting.layer:
        return f"under a rigid plane, in a layer of {THICK * 1e6:g} µm that hardens by a law of its own"
    if not setting.opposite:
        return "under a rigid plane"
    return "of a rigid plane, pressed on a smooth body"


def title(setting: Setting) -> str:
    """Of the case."""
    if setting.opposite:
        return "Three asperities on the counter-body, Swift" + ", one step" * (setting.steps == 1)
    if setting.layer:
        return "Three asperities, a linear layer on Swift, one step"
    words = "a map of friction" if setting.friction == MAP else f"μ = {setting.friction:g}"
    return f"Three asperities, Swift, {words}" + ", one step" * (setting.steps == 1)


CASES = tuple(RoughContact(setting.name, setting=setting) for setting in SETTINGS)
