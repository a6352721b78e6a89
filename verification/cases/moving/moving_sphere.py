# SPDX-License-Identifier: MIT
"""A rigid sphere that moves over a body: Hertz at every place; the groove of Swift steel, its symmetry, its
energy, and what it shows at the start.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from sam.scene import Friction, Result, Scene
from verification.cases.case import SAM, Case, Context, Plot, SmallTable, with_body, with_grid
from verification.cases.recipes import TRACK, on_track, radius_at
from verification.energy.balance import Balance
from verification.energy.of_sam import balance_of
from verification.figures.lines import grooves
from verification.references import hertz_sphere

ELASTIC = {"cells": 8, "length": 9 * 2.25 / 8, "per_radius": 8 / 2.25}  # 9 steps of 2 1/4 cells
FINE = {"cells": 6, "per_radius": 8.0}
COARSE = {"cells": 4, "per_radius": 2.0}  # what is the same on any grid
OTHERS = {"back": {"back": True}, "whole": {"shift": 5.0}, "half": {"shift": 0.5}}
"""Coarse tracks from the other end, or from a start that is so many cells off."""
TURNED = {"groove": ("track", "uz_m"), "peeq": ("track", "peeq_max"), "force": ("history", "fx_N")}
"""What a turn of the direction must not change: table and column."""
SHEAR_DEPTH, AHEAD = 0.44, 0.5  # radii: where the shear strain of the start is looked at
LENGTHS = ("groove_deepest_m", "groove_depth_m", "shoulder_start_m", "shoulder_end_m", "shoulder_side_m")


def against_hertz(scene: Scene, result: Result) -> dict[str, float]:
    """Largest errors of an elastic body over all places within a cell."""
    history, force = result.tables["history"], scene.loading.force
    full = np.array(history["force_N"]) == force
    p_max, approach, drive = (np.array(history[n])[full] for n in ("p_max_Pa", "approach_m", "fx_N"))
    exact = hertz_sphere(scene)
    a, p0, sphere = exact.units["a"], exact.units["p0"], scene.counterbody.radius
    return {
        "elastic-pressure": np.abs(p_max / p0 - 1).max(),
        "elastic-approach": np.abs(approach / exact.units["approach"] - 1).max(),
        "elastic-whole-cells": np.ptp(p_max[::4]) / p0,  # four steps are nine cells
        "elastic-force": np.abs(drive).max() / force / (a / sphere),
    }


def groove_of(scene: Scene, result: Result) -> tuple[np.ndarray, np.ndarray]:
    """Distance from the start, and depth of the groove, both in radii."""
    a, track = radius_at(scene), result.tables["track"]
    return (np.asarray(track["x_m"]) - scene.loading.path.start[0]) / a, np.asarray(track["uz_m"]) / a


def changed_by_turn(one: Result, other: Result) -> dict[str, float]:
    """What a turn of the direction changes, over the largest value."""
    out = {}
    for name, (table, column) in TURNED.items():
        first, second = (np.asarray(each.tables[table][column], dtype=float) for each in (one, other))
        second = second[::-1] if table == "track" else second
        out[f"turned-{name}"] = np.abs(first - second).max() / np.abs(first).max()
    return out


def rolling_energy(found: Balance, result: Result) -> float:
    """What does not close of the energy over the last third of the way, over the work."""
    history = result.tables["history"]
    s, drive = (np.concatenate([[0.0], history[name]]) for name in ("s_m", "fx_N"))
    first = int(np.flatnonzero(s >= 2 / 3 * s.max())[0])
    last = int(np.flatnonzero(found.force == found.force.max())[-1])
    part = slice(first, last + 1)
    work = np.trapezoid(drive[part], s[part]) + np.trapezoid(found.force[part], found.approach[part])
    held = found.elastic + found.dissipated
    return float((held[last] - held[first]) / work - 1)


def shear_ahead(scene: Scene, result: Result) -> float:
    """Plastic strain xz ahead of the start over minus that of the steady part."""
    a, box = radius_at(scene), result.grids["unloaded"]["body"]
    x, y, z = ((faces[1:] + faces[:-1]) / 2 for faces in (box.x, box.y, box.z))
    shear = box.cell_data["plastic_strain"][4][:, np.abs(y).argmin(), np.abs(z / a - SHEAR_DEPTH).argmin()]
    way = (x - scene.loading.path.start[0]) / a
    before, steady = np.interp((-AHEAD, TRACK / 2 + 1), way, shear)
    return float(-before / steady)


class MovingSphere(Case):
    """SAM over a track of six radii against Hertz, itself and the first law."""

    def solve(self, context: Context) -> dict[str, Any]:
        base = context.scene("moving-sphere")
        steel, coarse = on_track(base, FINE), on_track(base, COARSE)
        elastic = with_grid(with_body(on_track(base, ELASTIC), plasticity=None), depths=None)
        scenes = {"elastic": elastic, "steel": steel, "coarse": coarse}
        scenes |= {f"coarse-{name}": on_track(base, COARSE | keys) for name, keys in OTHERS.items()}
        results = {name: context.solve(SAM, scene, name) for name, scene in scenes.items()}
        sliding = coarse.model_copy(update={"friction": Friction(coefficient=0.2)})
        return {"scenes": scenes, "energy": balance_of(steel), "friction": balance_of(sliding)} | results

    def measure(self, found: Mapping[str, Any]) -> dict[str, float]:
        scene, steel, coarse = found["scenes"]["steel"], found["steel"], found["coarse"]
        depth, track = coarse.quantities["groove_depth_m"], steel.quantities
        steady = groove_of(scene, steel)[1][np.asarray(steel.tables["track"]["steady"]) == 1]
        a, start = radius_at(scene), scene.loading.path.start[0]
        shoulder = min(track["shoulder_start_m"], track["shoulder_end_m"])
        values = against_hertz(found["scenes"]["elastic"], found["elastic"])
        values |= changed_by_turn(coarse, found["coarse-back"])
        for name in ("whole", "half"):
            values[f"shifted-{name}"] = abs(found[f"coarse-{name}"].quantities["groove_depth_m"] / depth - 1)
        return values | {
            "steady": np.abs(steady / steady.mean() - 1).max(),
            "energy": np.abs(found["energy"].error_of_cells).max(),
            "rolling-energy": rolling_energy(found["energy"], steel),
            "friction-energy": np.abs(found["friction"].error_of_cells).max(),
            "deepest-at-start": (track["groove_deepest_x_m"] - start) / a,
            "shoulders": shoulder / track["groove_depth_m"],
            "transient": track["transient_length_m"] / a,
            "shear-changes-sign": shear_ahead(scene, steel),
        }

    def setup(self, found: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
        scene = found["scenes"]["steel"]
        yield "p₀/σ_y0", f"4, a = {1e6 * radius_at(scene):.3f} µm"
        yield "Track", f"{TRACK:g} a in {scene.strokes.count} steps, cells of a/{FINE['cells']}"

    def tables(self, found: Mapping[str, Any]) -> Iterator[SmallTable]:
        a, values = radius_at(found["scenes"]["steel"]), found["steel"].quantities
        rows = [(name, f"{1e3 * values[name] / a:.3f}") for name in (*LENGTHS, "transient_length_m")]
        yield SmallTable("Track, in thousandths of the contact radius", ("quantity", "1e-3 a"), rows)

    def figures(self, found: Mapping[str, Any]) -> Iterator[Plot]:
        lines = {"Swift steel": groove_of(found["scenes"]["steel"], found["steel"])}
        words = (
            "Displacement of the surface by plastic strain over the distance from the start, after the pass; "
            "the sphere was pressed on at 0."
        )
        yield Plot(grooves(lines, TRACK), "groove", "Groove along the path", words, words)


CASES = (MovingSphere("moving-sphere"),)
