# SPDX-License-Identifier: MIT
"""What the elastic-plastic step tends to in a periodic box: Tamaas on grids too slow for every run, kept in
tamaas-step.json.

Made by SAMFEM_PEERS=.venv-peers/bin/python python -m verification.peers.reference (half an hour).
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.integrate import trapezoid

from verification.peers import problems
from verification.peers.running import TAMAAS, Job, Measurement, interpreter, run

PLACE = Path(__file__).with_name("tamaas-step.json")
GRIDS = ((32, 16), (64, 32), (96, 48))  # cells a side, layers
SETTINGS = {"tolerance": 1e-5, "contact_tolerance": 1e-8, "relaxation": 0.3}


@dataclass(frozen=True)
class StoredReference:
    """Largest accumulated plastic strain and its profile below the apex, in sigma_y/E and a; uncertainty:
    relative, of the largest; profile_uncertainty: relative L2 of the profile.
    """

    peeq_max: float
    z: np.ndarray
    peeq: np.ndarray
    uncertainty: float
    profile_uncertainty: float
    text: str


def largest(z: np.ndarray, values: np.ndarray) -> float:
    """The largest of the values below the apex, by the parabola through it and its neighbours, equally spaced
    or not.
    """
    k = int(np.argmax(values))
    if not 0 < k < len(values) - 1:
        return float(values[k])
    c = np.polyfit(z[k - 1 : k + 2] - z[k], values[k - 1 : k + 2], 2)
    return float(c[2] - c[1] ** 2 / (4 * c[0]))


def profile_error(z: np.ndarray, values: np.ndarray, reference_z: np.ndarray, reference: np.ndarray) -> float:
    """sqrt(int (v - r)^2 dz / int r^2 dz), v linear between its points; over the depths of the reference."""
    difference = np.interp(reference_z, z, values) - reference
    return float(np.sqrt(trapezoid(difference**2, reference_z) / trapezoid(reference**2, reference_z)))


def between(
    finer: tuple[np.ndarray, np.ndarray], coarser: tuple[np.ndarray, np.ndarray], text: str
) -> StoredReference:
    """The finer of two profiles (z, peeq), which differs from the limit by no more than from the coarser."""
    best, next_best = largest(*finer), largest(*coarser)
    return StoredReference(best, *finer, abs(next_best / best - 1), profile_error(*coarser, *finer), text)


def periodic() -> StoredReference:
    """The stored one of Tamaas."""
    stored = json.loads(PLACE.read_text(encoding="utf-8"))
    coarser, finer = ((np.array(grid["z"]), np.array(grid["peeq"])) for grid in stored["grids"][-2:])
    n, layers = stored["grids"][-1]["cells"]
    text = f"Tamaas {stored['versions']['tamaas']} on {layers} × {n} × {n} cells, stored ({PLACE.name})"
    return between(finer, coarser, text)


def main() -> None:
    """Solve with Tamaas on finer and finer grids, and store the profiles below the apex."""
    grids = []
    for cells in GRIDS:
        measurement = Measurement(Job(problems.STEP, cells, SETTINGS))
        run(TAMAAS, [measurement], interpreter(), allowance=7200)
        if not measurement.solved:
            raise SystemExit(f"{cells}: {measurement.failure or 'not converged'}")
        fields = {
            name: [float(f"{value:.7g}") for value in values] for name, values in measurement.fields.items()
        }
        grids.append({"cells": cells, "seconds": round(measurement.seconds, 1), **fields})
        print(cells, measurement.seconds, measurement.record, flush=True)
    content = {"settings": SETTINGS, "versions": measurement.record["versions"], "grids": grids}
    PLACE.write_text(json.dumps(content, indent=1) + "\n")


if __name__ == "__main__":
    main()
