# SPDX-License-Identifier: MIT
"""
A sweep and its map
===================
Two keys of a scene are varied, and the table of all results becomes a map: at which load and friction does a
sliding contact begin to yield?
"""

import matplotlib.pyplot as plt
import numpy as np

import samfem

contact = {
    "title": "rigid sphere sliding on steel",
    "body": {"young": "210 GPa", "poisson": 0.3},
    "counterbody": {"shape": "sphere", "radius": "105 um"},
    "loading": {"force": "0.1 N"},
    "friction": {"coefficient": 0.5},
    "grid": {"cells": (41, 41)},
}
# The corner of the largest stress, with the uncertainty of its numbers
print(samfem.solve(samfem.Scene(**contact, solver={"uncertainty": True})))

# %%
# The sweep solves each scene once, on all cores.
vary = {"loading.force": np.linspace(0.01, 0.1, 4), "friction.coefficient": np.linspace(0, 0.5, 6)}
sweep = samfem.sweep({"scene": contact, "vary": vary})
stress = 1e-9 * sweep.frame.pivot(
    index="friction.coefficient", columns="loading.force", values="mises_max_Pa"
)
print(stress.round(2))

figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
image = axes.contourf(stress.columns, stress.index, stress, levels=12, cmap="viridis")
line = axes.contour(stress.columns, stress.index, stress, levels=[2], colors="w")
axes.clabel(line, fmt="yields at 2 GPa")
figure.colorbar(image, label="largest von Mises stress [GPa]")
axes.set(xlabel="force [N]", ylabel="coefficient of friction")
plt.show()
