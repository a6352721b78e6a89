# SPDX-License-Identifier: MIT
"""A rigid sphere that moves over a body: Hertz at every place; the groove of Swift steel, its symmetry, its
energy, and what it shows at the start.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from sam.scene import Friction, Result, Scene
from verification.cases.case import SAM, Case, Context, Measured, Plot, SmallTable, with_body
from verification.cases.moving.moving_sphere_scenes import LENGTH, RATIO, Setting, modulus, radius
from verification.energy.of_sam import balance_of
from verification.figures.moving import grooves

ELASTIC_CELLS, ELASTIC_STEPS, ELASTIC_STEP = 8, 9, 2.25  # cells in a; steps, and how many cells they are
SHEAR_DEPTH, AHEAD = 0.44, 0.5  # radii: where the shear strain of the start is looked at
FINE = Setting(cells=6, per_radius=8.0)
COARSE = Setting(cells=4, per_radius=2.0)  # what is the same on any grid
MU = 0.2  # of the sphere whose friction does work
SHIFTS = {"whole": 5.0, "half": 0.5}  # of the start, in cells
TURNED = {"groove": ("track", "uz_m"), "peeq": ("track", "peeq_max"), "force": ("history", "fx_N")}
"""What a turn of the direction must not change: table and column."""


@dataclass(frozen=True)
class Hertz:
    """Largest errors over the places, elastic: of the pressure, of the approach; spread: of the pressure over
    the places that are whole cells apart, over p0; drive: largest F_x/F over a/R.
    """

    pressure: float
    approach: float
    spread: float
    drive: float


@dataclass(frozen=True)
class Start:
    """What the start of the track shows. Lengths over the radius: place of the deepest groove, transient
    length; shoulders: lower and higher one of start and end, over the groove; shear: plastic strain xz ahead
    of the start over minus that of the steady part.
    """

    deepest: float
    transient: float
    shoulders: tuple[float, float]
    shear: float


@dataclass(frozen=True)
class Moving:
    """What was found. turned: change of groove, plastic strain and force by a turn of the direction, over
    their size; shifted: relative change of the steady depth by a start elsewhere; spread: of the steady
    groove over its mean; energy, rolling: what does not close, over the work, of all steps and of the last
    third; with_friction: of all steps of a sphere that slides.
    """

    scene: Scene
    base: Result
    hertz: Hertz
    turned: dict[str, float]
    shifted: dict[str, float]
    spread: float
    energy: float
    rolling: float
    start: Start
    with_friction: float


def elastic(context: Context, scene: Scene) -> Hertz:
    """The sphere over an elastic body, a quarter of a cell further in each step."""
    length = ELASTIC_STEPS * ELASTIC_STEP / ELASTIC_CELLS
    setting = Setting(ELASTIC_CELLS, length, ELASTIC_CELLS / ELASTIC_STEP)
    smooth = with_body(setting.of(scene), plasticity=None)
    smooth = smooth.model_copy(update={"grid": smooth.grid.model_copy(update={"depths": None})})
    history = context.solve(SAM, smooth, "elastic").tables["history"]
    full = np.array(history["force_N"]) == smooth.loading.force
    a, other = radius(scene), scene.counterbody
    p0 = 2 * a * modulus(scene) / (np.pi * other.radius)
    p_max, approach, drive = (np.array(history[n])[full] for n in ("p_max_Pa", "approach_m", "fx_N"))
    return Hertz(
        float(np.abs(p_max / p0 - 1).max()),
        float(np.abs(approach / (a**2 / other.radius) - 1).max()),
        float(np.ptp(p_max[::4]) / p0),  # four steps are nine cells
        float(np.abs(drive).max() / smooth.loading.force / (a / other.radius)),
    )


def turned(one: Result, other: Result) -> dict[str, float]:
    """What a turn of the direction changes."""
    out = {}
    for name, (table, column) in TURNED.items():
        first, second = (np.asarray(each.tables[table][column], dtype=float) for each in (one, other))
        second = second[::-1] if table == "track" else second
        out[name] = float(np.abs(first - second).max() / np.abs(first).max())
    return out


def groove_of(scene: Scene, result: Result) -> tuple[np.ndarray, np.ndarray]:
    """Distance from the start in radii, and depth of the groove over the radius."""
    a, track = radius(scene), result.tables["track"]
    way = (np.asarray(track["x_m"]) - scene.loading.path.start[0]) / a
    return way, np.asarray(track["uz_m"]) / a


def energy(scene: Scene, result: Result) -> tuple[float, float]:
    """What does not close of the energy, over the work: of all steps, and of the last third of the way."""
    found, history = balance_of(scene), result.tables["history"]
    s, drive = (np.concatenate([[0.0], history[name]]) for name in ("s_m", "fx_N"))
    first = int(np.flatnonzero(s >= 2 / 3 * s.max())[0])
    last = int(np.flatnonzero(found.force == found.force.max())[-1])
    part = slice(first, last + 1)
    work = np.trapezoid(drive[part], s[part]) + np.trapezoid(found.force[part], found.approach[part])
    held = found.elastic + found.dissipated
    return float(np.abs(found.error_of_cells).max()), float((held[last] - held[first]) / work - 1)


def start_of(scene: Scene, result: Result) -> Start:
    """What the start of the track shows."""
    a, found = radius(scene), result.quantities
    ends = sorted((found["shoulder_start_m"], found["shoulder_end_m"]))
    depth = found["groove_depth_m"]
    box = result.grids["unloaded"]["body"]
    x, y, z = ((faces[1:] + faces[:-1]) / 2 for faces in (box.x, box.y, box.z))
    shear = box.cell_data["plastic_strain"][4][:, np.abs(y).argmin(), np.abs(z / a - SHEAR_DEPTH).argmin()]
    way = (x - scene.loading.path.start[0]) / a
    before, steady = (float(np.interp(at, way, shear)) for at in (-AHEAD, LENGTH / 2 + 1))
    return Start(
        (found["groove_deepest_x_m"] - scene.loading.path.start[0]) / a,
        found["transient_length_m"] / a,
        (ends[0] / depth, ends[1] / depth),
        -before / steady,
    )


class MovingSphere(Case):
    """SAM over a track of six radii against Hertz, itself and the first law."""

    def solve(self, context: Context) -> Moving:
        scene = context.scene("moving-sphere")
        base = FINE.of(scene)
        found = context.solve(SAM, base, "steel")
        steady = groove_of(base, found)[1][np.asarray(found.tables["track"]["steady"]) == 1]
        coarse = COARSE.of(scene)
        first = context.solve(SAM, coarse, "coarse")
        back = context.solve(SAM, replace(COARSE, back=True).of(scene), "coarse-back")
        shifted = {}
        for name, cells in SHIFTS.items():
            result = context.solve(SAM, replace(COARSE, shift=cells).of(scene), f"coarse-{name}")
            depth = result.quantities["groove_depth_m"]
            shifted[name] = abs(depth / first.quantities["groove_depth_m"] - 1)
        closes, sliding = (
            energy(base, found),
            coarse.model_copy(update={"friction": Friction(coefficient=MU)}),
        )
        return Moving(
            base,
            found,
            elastic(context, scene),
            turned(first, back),
            shifted,
            float(np.abs(steady / steady.mean() - 1).max()),
            *closes,
            start_of(base, found),
            float(np.abs(balance_of(sliding).error_of_cells).max()),
        )

    def measure(self, found: Moving) -> dict[str, Measured | float]:
        hertz, start = found.hertz, found.start
        return {
            "elastic-pressure": hertz.pressure,
            "elastic-approach": hertz.approach,
            "elastic-whole-cells": hertz.spread,
            "elastic-force": hertz.drive,
            **{f"turned-{name}": value for name, value in found.turned.items()},
            **{f"shifted-{name}": value for name, value in found.shifted.items()},
            "steady": found.spread,
            "energy": found.energy,
            "rolling-energy": found.rolling,
            "friction-energy": found.with_friction,
            "deepest-at-start": start.deepest,
            "shoulders": start.shoulders[0],
            "transient": start.transient,
            "shear-changes-sign": start.shear,
        }

    def setup(self, found: Moving) -> Iterator[tuple[str, str]]:
        yield "p₀/σ_y0", f"{RATIO:g}, a = {1e6 * radius(found.scene):.3f} µm"
        yield "Track", f"{LENGTH:g} a in {found.scene.strokes.count} steps, cells of a/{FINE.cells}"

    def tables(self, found: Moving) -> Iterator[SmallTable]:
        a, values = radius(found.scene), found.base.quantities
        lengths = (
            "groove_deepest_m",
            "groove_depth_m",
            "shoulder_start_m",
            "shoulder_end_m",
            "shoulder_side_m",
        )
        rows = [(name, f"{1e3 * values[name] / a:.3f}") for name in lengths]
        rows.append(("transient_length_m", f"{1e3 * values['transient_length_m'] / a:.0f}"))
        yield SmallTable("Track, in thousandths of the contact radius", ("quantity", "1e-3 a"), rows)

    def figures(self, found: Moving) -> Iterator[Plot]:
        yield Plot(
            grooves({"Swift steel": groove_of(found.scene, found.base)}, LENGTH),
            "groove",
            "Groove along the path",
            "Depth of the groove over the distance from the start",
            "Displacement of the surface by plastic strain after the pass; the sphere was pressed on at 0.",
        )


CASES = (MovingSphere("moving-sphere"),)
