# SPDX-License-Identifier: MIT
"""
A rough patch that repeats: elastic or yielding
===============================================
A patch that repeats has no border and stands for a large surface. Elastic, its spots grow in proportion to
the mean pressure; where the steel yields they are larger.
"""

import matplotlib.pyplot as plt
import numpy as np

import samfem

steel = {"young": "210 GPa", "poisson": 0.3}
yields = {"law": "linear", "yield_stress": "0.8 GPa", "modulus": "5 GPa"}
waves = {"kind": "self-affine", "sq": "0.08 um", "cutoff_long": "32 um", "cutoff_short": "12 um"}
tables = {
    "counterbody": {"shape": "flat"},
    "surface": {**waves, "hurst": 0.8, "seed": 1},
    "loading": {"mean_pressure": "100 MPa", "steps": 4},
    "grid": {"cells": (64, 64), "extent": ("64 um", "64 um"), "periodic": "xy"},
    "solver": {"tolerance": 1e-4, "uncertainty": True},
}
bodies = {"elastic": steel, "yielding": {**steel, "plasticity": yields}}
runs = {name: samfem.solve(samfem.Scene(body=body, **tables)) for name, body in bodies.items()}
print(runs["yielding"])

figure, panels = plt.subplots(1, 3, figsize=(9, 3), layout="constrained")
for panel, (name, run) in zip(panels, runs.items(), strict=False):
    pressure = run.tables["surface"].pivot(index="y_m", columns="x_m", values="p_Pa")
    spots = np.tile(1e-9 * pressure.replace(0, np.nan).to_numpy(), (2, 2))
    image = panel.imshow(spots, origin="lower", extent=(0, 128, 0, 128), vmin=0, vmax=4)
    panel.set(xlabel="x [µm]", title=f"{name}, two periods")
    mean, area = (run.tables["history"][key] / 64e-6**2 for key in ("force_N", "contact_area_m2"))
    panels[2].plot(1e-6 * mean, 100 * area, "o-", label=name)
figure.colorbar(image, ax=panels[:2], label="contact pressure [GPa]", shrink=0.8)
panels[2].set(xlabel="mean pressure [MPa]", ylabel="area in contact [%]", xlim=(0, None), ylim=(0, None))
panels[2].legend()
plt.show()
