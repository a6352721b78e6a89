# SPDX-License-Identifier: MIT
"""What a user writes, in 30 lines: `make lint` holds its types, and it runs as it is, also in a notebook."""

from pathlib import Path
from typing import TYPE_CHECKING, assert_type

import samfem

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pyvista import DataSet

sphere = samfem.Scene(
    title="Sphere on steel that yields",
    body={
        "young": "210 GPa",
        "poisson": 0.3,
        "plasticity": {"law": "linear", "yield_stress": 1e9, "modulus": 10e9},
    },
    counterbody={"shape": "sphere", "radius": "105 um"},
    loading={"force": 0.1, "steps": 5},
    grid={"cells": (33, 33), "layers": 20, "depth": "12 um"},
)
Path("sphere.toml").write_text(sphere.to_toml())

scene = samfem.load("sphere.toml")
print(samfem.plan(scene))

run = samfem.solve(scene)
print(run)

p_max = run.quantities["p_max_Pa"]
assert run.converged and p_max is not None
print(f"{p_max / 1e9:.3g} GPa", run.tables["history"].shape)

print(run.mesh().n_cells, run.mesh("surface").array_names)
run.plot("pressure").savefig("pressure.png")

comparison = samfem.compare(scene)
print(comparison.passed, comparison.frame.shape)
comparison.plot().savefig("compared.png")

swept = samfem.sweep({"scene": scene, "vary": {"loading.force": [0.05, 0.1]}}, out="sweep")
print(swept.frame["peeq_max"].max(), swept.run(0).quantities["force_N"])
swept.plot().savefig("sweep.png")

if TYPE_CHECKING:  # nothing that a user gets is of any type, but tables: pandas has no types of its own
    assert_type(samfem.plan(scene), samfem.Plan)
    assert_type(run.quantities["p_max_Pa"], float | None)
    assert_type(run.warnings, list[str])
    assert_type((run.mesh(), run.plot()), tuple[DataSet, Figure])
    assert_type(samfem.plot(run), dict[str, Figure])
    assert_type((comparison, comparison.passed), tuple[samfem.Comparison, bool])
    assert_type(swept.run(0), samfem.Run)
