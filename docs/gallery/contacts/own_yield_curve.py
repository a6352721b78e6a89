# SPDX-License-Identifier: MIT
"""
Your own yield curve
====================
The yield stress over the plastic strain comes from a table, as a compression test gives it. It decides how
deep the sphere is pressed in, and how much of that remains after unloading.
"""

import matplotlib.pyplot as plt
import numpy as np

import samfem

strain = [0, 0.001, 0.003, 0.01, 0.03, 0.1]
stress = [1.20e9, 1.36e9, 1.48e9, 1.62e9, 1.80e9, 2.05e9]
law = {"law": "table", "file": list(zip(strain, stress, strict=True))}
scene = samfem.Scene(
    title="rigid sphere on steel with a measured yield curve",
    body={"young": "210 GPa", "poisson": 0.3, "plasticity": law},
    counterbody={"shape": "sphere", "radius": "105 um"},
    loading={"force": "0.17 N", "steps": 6, "unload": True},
    grid={"cells": (31, 31), "extent": ("14 um", "14 um"), "layers": 12, "depth": "8 um"},
    solver={"uncertainty": True},
)
run = samfem.solve(scene)
print(run)
loading, last = run.tables["history"].query("step <= 6"), run.tables["history"].tail(2)
force = np.linspace(0, 0.17, 100)
hertz = (3 * force / (4 * 210e9 / (1 - 0.3**2) * np.sqrt(105e-6))) ** (2 / 3)

figure, (left, right) = plt.subplots(1, 2, figsize=(7, 3.4), layout="constrained")
left.plot(100 * np.array(strain), 1e-9 * np.array(stress), "o-")
left.set(xlabel="plastic strain [%]", ylabel="yield stress [GPa]", ylim=(0, 2.2))
right.plot(1e6 * hertz, force, "k:", label="elastic (Hertz)")
right.plot(1e6 * loading["approach_m"], loading["force_N"], "o-", label="loading")
right.plot(1e6 * last["approach_m"], last["force_N"], "s--", label="unloaded in one step")
right.set(xlabel="approach [µm]", ylabel="force [N]")
right.legend()
plt.show()
