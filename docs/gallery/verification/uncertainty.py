# SPDX-License-Identifier: MIT
"""
The uncertainty of each number
==============================
Three grids and three numbers of load steps say how well each number is known, and which of both to refine.
"""

import matplotlib.pyplot as plt

import samfem

steel = {"law": "linear", "yield_stress": "1.2 GPa", "modulus": "10 GPa"}
scene = samfem.Scene(
    title="rigid sphere on steel that yields",
    body={"young": "210 GPa", "poisson": 0.3, "plasticity": steel},
    counterbody={"shape": "sphere", "radius": "105 um"},
    loading={"force": "0.1 N", "steps": 6},
    grid={"cells": (33, 33), "extent": ("11 um", "11 um"), "layers": 12, "depth": "6 um"},
    solver={"uncertainty": True},
)
run = samfem.solve(scene)
print(run)
names = {
    "approach_m": "approach",
    "contact_radius_m": "contact radius",
    "mises_max_Pa": "largest von Mises stress",
    "peeq_max": "largest plastic strain",
    "p_max_Pa": "largest pressure",
}
known = run.tables["quantities"].set_index("quantity").loc[list(names)]
cells, steps = (100 * known[part] / known["value"] for part in ("u_cells", "u_steps"))

figure, axes = plt.subplots(figsize=(6, 3.2), layout="constrained")
axes.barh(list(names.values()), cells, label="by the cells")
axes.barh(list(names.values()), steps, left=cells, label="by the load steps")
axes.set(xlabel="uncertainty [% of the value]")
axes.legend()
plt.show()
