# SPDX-License-Identifier: MIT
"""A rigid sphere that moves over a body: Hertz at every place; the groove, its symmetry and energy."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from sam.scene import Friction, Result, Scene
from verification.cases.case import SAM, Context, with_body, with_grid
from verification.cases.recipes import TRACK, on_track, radius_at
from verification.energy import Balance, balance_of_sam
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


def runs(context: Context) -> Iterator[dict[str, Any]]:
    """SAM over a track of six radii against Hertz, itself and the first law."""
    base = context.scene("moving-sphere")
    steel, coarse = on_track(base, FINE), on_track(base, COARSE)
    elastic = with_grid(with_body(on_track(base, ELASTIC), plasticity=None), depths=None)
    scenes = {"elastic": elastic, "steel": steel, "coarse": coarse}
    scenes |= {f"coarse-{name}": on_track(base, COARSE | keys) for name, keys in OTHERS.items()}
    results = {name: context.solve(SAM, scene, name) for name, scene in scenes.items()}
    sliding = balance_of_sam(coarse.model_copy(update={"friction": Friction(coefficient=0.2)}))
    yield {"sweep": "elastic"} | against_hertz(elastic, results["elastic"])
    depth = results["coarse"].quantities["groove_depth_m"]
    for name in ("whole", "half"):
        shifted = results[f"coarse-{name}"].quantities["groove_depth_m"]
        yield {"sweep": f"coarse-{name}", "shifted": abs(shifted / depth - 1)}
    turned = changed_by_turn(results["coarse"], results["coarse-back"])
    yield {"sweep": "coarse", "friction-energy": sliding.error_of_cells} | turned
    track, found, a = results["steel"].quantities, balance_of_sam(steel), radius_at(steel)
    way, groove = groove_of(steel, results["steel"])
    steady = groove[np.asarray(results["steel"].tables["track"]["steady"]) == 1]
    yield {
        "sweep": "steel",
        "steady": np.abs(steady / steady.mean() - 1).max(),
        "energy": found.error_of_cells,
        "rolling-energy": rolling_energy(found, results["steel"]),
        "deepest-at-start": (track["groove_deepest_x_m"] - steel.loading.path.start[0]) / a,
        "shoulders": min(track["shoulder_start_m"], track["shoulder_end_m"]) / track["groove_depth_m"],
        "transient": track["transient_length_m"] / a,
        "shear-changes-sign": shear_ahead(steel, results["steel"]),
        **{f"{name}, 1e-3 a": 1e3 * track[name] / a for name in LENGTHS},
        "way": way,
        "groove": groove,
    }
