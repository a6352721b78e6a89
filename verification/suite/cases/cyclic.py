# SPDX-License-Identifier: MIT
"""Repeated sliding: traction of one sign and of alternating sign, and a load that travels to and fro over the shakedown limit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sam.scene import Body, Friction, Grid, Loading, Path, Plasticity, Result, Scene, Solver
from verification.figures.friction import CYCLES, Curve, curves
from verification.reference.hamilton import sliding_stress
from verification.runs.models import FEM_3D, SAM
from verification.suite.cases.case import Case, Context, Outcome, SmallTable, grid_text, with_loading
from verification.suite.cases.friction import BOX, SCENE, sliding_scene
from verification.suite.cases.hertz import contact_of
from verification.suite.cases.resolution import Resolution
from verification.suite.gates import Measured
from verification.text.console import number

RATIO, FRICTION, TIMES = 4.0, 0.3, 3
AT = Resolution(10, 6)
DIRECTIONS = ("constant", "alternating")


def run_cyclic(context: Context) -> Outcome:
    """Press, slide and lift several times, the traction always along +x or changing its sign."""
    base = context.scene(SCENE)
    outcome, rows, series = Outcome(), [], {}
    for direction in DIRECTIONS:
        scene = with_loading(sliding_scene(base, RATIO, FRICTION, AT), unload=True, cycles=TIMES)
        rubbed = Friction(coefficient=FRICTION, direction=direction)
        scene = scene.model_copy(update={"friction": rubbed})
        found = {
            model: context.solve(model, scene, f"{key}-{direction}")
            for key, model in (("sam", SAM), ("fem", FEM_3D))
        }
        strains = {model: strain_of_cycles(result) for model, result in found.items()}
        outcome.values |= gates(context.case, direction, strains, found)
        for model, name in ((SAM, "SAM"), (FEM_3D, "FEM")):
            series[f"{name}, {direction}"] = Curve(np.arange(1, TIMES + 1), 1e2 * strains[model])
            moved = found[model].quantities["residual_ux_center_m"]
            rows.append(
                (direction, name, *(f"{1e2 * e:.4f}" for e in strains[model]), f"{1e9 * moved:+.2f} nm")
            )
    outcome.setup = [
        ("Scene", f"rigid sphere on Swift steel, p₀/σ_y0 = {RATIO:g}, μ = {FRICTION:g}"),
        (
            "History",
            f"{TIMES} cycles of {scene.loading.steps} steps and unloading; the traction lasts through unloading",
        ),
        ("SAM", grid_text(found[SAM], contact_of(scene).contact_radius)),
        ("FEM", f"{AT.fem} elements in a, box {BOX:g} a"),
    ]
    columns = (
        "direction",
        "model",
        *(f"cycle {k}" for k in range(1, TIMES + 1)),
        "residual displacement along x",
    )
    outcome.tables.append(SmallTable("Largest plastic strain in %, at the peak of each cycle", columns, rows))
    drawing = curves(
        {"Repeated sliding": series}, "cycle", "largest plastic strain [%]", looks=in_order(series)
    )
    words = "Largest plastic strain over the cycle: level where the traction keeps its sign, rising where it alternates."
    caption = (
        "At the surface, where the value depends on the mesh: SAM and FEM are compared by what a cycle adds."
    )
    outcome.figures.append(context.save(drawing, "strain", "Plastic strain over the cycles", words, caption))
    return outcome


def strain_of_cycles(result: Result) -> np.ndarray:
    """Largest plastic strain at the peak of each cycle."""
    return np.asarray(result.tables["cycles"]["peeq_max"], dtype=float)


def gates(
    case: str, direction: str, strains: dict[str, np.ndarray], found: dict[str, Result]
) -> dict[str, Measured]:
    """What later cycles add, over the strain of the first, in both models; how far the surface was moved along x."""
    values = {}
    for short, model in (("sam", SAM), ("fem", FEM_3D)):
        first, *_, last = strains[model]
        values[f"{case}.{direction}-{short}-adds"] = Measured(float(last / first - 1.0))
    moved = [found[model].quantities["residual_ux_center_m"] for model in (SAM, FEM_3D)]
    return values | {f"{case}.{direction}-moved": Measured(*moved, unit="m")}


@dataclass(frozen=True)
class Travel:
    """A load that travels, perfect plasticity. ratio: p0 over the yield stress; shakes: below the shakedown limit."""

    name: str
    ratio: float
    friction: float
    shakes: bool


TRAVELS = (
    Travel("below", 2.55, 0.0, True),
    Travel("above", 3.0, 0.0, False),
    Travel("below-sliding", 1.95, 0.2, True),
    Travel("above-sliding", 2.9, 0.2, False),
)
PASSES, STEPS, HALF_WAY, RADIUS = 8, 12, 1.5, 1e-5
YOUNG, POISSON, YIELD_STRESS = 210e9, 0.3, 1e9
CELLS = 6  # in the contact radius
BESIDE = (2.0, 1.8, 2.0)  # grid beyond the way of the centre along x, to its sides and in depth, in radii


def run_travel(context: Context) -> Outcome:
    """Hertz pressure with and without traction along a way, over and over; strain that still grows after many passes."""
    outcome, rows, series = Outcome(), [], {}
    for travel in TRAVELS:
        scene = travelling(travel)
        result = context.solve(SAM, scene, travel.name)
        strain = strain_of_cycles(result)
        added = np.diff(strain)
        limit = shear_limit(travel.friction)
        outcome.values[f"{context.case}.{travel.name}-adds"] = Measured(float(added[-1] / strain[0]))
        if not travel.shakes:
            outcome.values[f"{context.case}.{travel.name}-keeps"] = Measured(
                float(added[-1] / added[len(added) // 2])
            )
        over = travel.ratio * np.sqrt(3.0)
        cells = (
            f"{travel.friction:g}",
            f"{travel.ratio:g}",
            f"{over:.2f}",
            f"{limit:.2f}",
            f"{over / limit:.2f}",
        )
        rows.append(
            (*cells, *(number(1e2 * strain[k], 4) for k in (0, 1, 3, -1)), f"{added[-1] / strain[0]:.1e}")
        )
        title = f"μ = {travel.friction:g}, p₀ = {over / limit:.2f} of the limit"
        series[title] = Curve(np.arange(1, PASSES + 1), strain / strain[0])
    outcome.setup = [
        (
            "Body",
            f"E = {YOUNG / 1e9:g} GPa, ν = {POISSON:g}, perfectly plastic, σ_y = k √3 = {YIELD_STRESS / 1e9:g} GPa",
        ),
        ("Load", f"p = p₀ √(1 − r²/a²), q = μp along +x, a = {RADIUS * 1e6:g} µm, given"),
        (
            "Way",
            f"from −{HALF_WAY:g} a to {HALF_WAY:g} a in {STEPS} steps, lifted at the end, {PASSES} passes",
        ),
        ("SAM", grid_text(result, RADIUS)),
    ]
    columns = (
        *("μ", "p₀/σ_y", "p₀/k", "limit of p₀/k", "share"),
        *("strain [%], pass 1", "pass 2", "pass 4", f"pass {PASSES}", "added by the last, of the first"),
    )
    outcome.tables.append(SmallTable("Largest plastic strain after each pass", columns, rows))
    drawing = curves({"SAM": series}, "pass", "plastic strain over that of pass 1", looks=in_order(series))
    words = "Largest plastic strain over the passes: it settles below the shakedown limit and grows above it."
    outcome.figures.append(
        context.save(drawing, "passes", "Plastic strain over the passes", words, "Largest in the body.")
    )
    return outcome


def in_order(series: dict[str, Curve]) -> dict[str, dict]:
    """Looks of the series, in their order."""
    return dict(zip(series, CYCLES, strict=True))


def travelling(travel: Travel) -> Scene:
    """The scene of a load that travels along x."""
    h, (ahead, beside, below) = RADIUS / CELLS, BESIDE
    nx, ny = (2 * round(half * CELLS) + 1 for half in (HALF_WAY + ahead, beside))
    path = Path(start=(-HALF_WAY * RADIUS, 0.0), end=(HALF_WAY * RADIUS, 0.0), steps=STEPS)
    pressure = {"prescribed": "hertz", "p0": travel.ratio * YIELD_STRESS, "radius": RADIUS}
    return Scene(
        title=f"Travelling load, {travel.name}",
        body=Body(
            young=YOUNG, poisson=POISSON, plasticity=Plasticity(law="perfect", yield_stress=YIELD_STRESS)
        ),
        loading=Loading(**pressure, path=path, steps=2, unload=True, cycles=PASSES),
        friction=Friction(coefficient=travel.friction) if travel.friction else None,
        grid=Grid(
            cells=(nx, ny), extent=(nx * h, ny * h), depths=tuple(h * np.arange(round(below * CELLS) + 1))
        ),
        solver=Solver(tolerance=1e-4),
    )


def shear_limit(friction: float) -> float:
    """p0/k at which the largest |s_xz| is the shear yield stress k.

    Residual stress that a travelling load leaves is the same along x, and equilibrium then allows it no s_xz: beyond this
    limit nothing shakes down. Without friction 4.68, the limit of Ponter, Hearle and Johnson, J. Mech. Phys. Solids 33
    (1985) 339-362, from the Hertz stresses here.
    """
    x, z = np.meshgrid(np.linspace(-1.5, 1.5, 301), np.linspace(0.0, 1.5, 151), indexing="ij")
    return 1.0 / float(np.abs(sliding_stress(x, 0.0, z, 1.0, 1.0, POISSON, friction)[..., 4]).max())


CASES = (
    Case(
        "cyclic-sliding",
        "Repeated sliding contact",
        "What do further cycles add, where the traction keeps its sign and where it alternates?",
        run_cyclic,
        (
            (
                "Shakedown",
                "hardening and residual stress keep later cycles elastic",
                "Johnson (1985), section 9.2",
            ),
        ),
        ("full",),
    ),
    Case(
        "travelling-load",
        "A load that travels over a perfectly plastic body",
        "Does the strain settle below the shakedown limit, and grow with every pass above it?",
        run_travel,
        (
            (
                "Shakedown limit",
                "p₀/k = 1/max|σ_xz/p₀|; 4.68 without friction, k = σ_y/√3",
                "Ponter, Hearle & Johnson, J. Mech. Phys. Solids 33 (1985) 339-362; Johnson (1985), section 9.1",
            ),
        ),
        ("full",),
    ),
)
