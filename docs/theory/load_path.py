# SPDX-License-Identifier: MIT
"""Loading and unloading of a sphere on steel that yields: force over approach, and plastic strain."""

import matplotlib.pyplot as plt
import numpy as np

import samfem

scene = samfem.Scene(
    body={
        "young": "210 GPa",
        "poisson": 0.3,
        "plasticity": {"law": "swift", "B": "945 MPa", "C": 20, "n": 0.121},
    },
    counterbody={"shape": "sphere", "radius": "105 um"},
    loading={"force": "0.17 N", "steps": 8, "unload": True},
    grid={"cells": (33, 33), "extent": ("14 um", "14 um")},
)
run = samfem.solve(scene)
history, plane = run.tables["history"], run.tables["plane"].query("state == 'peak'")

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
force = np.linspace(0, 0.17, 100)
hertz = (3 * force / (4 * 210e9 / (1 - 0.3**2) * np.sqrt(105e-6))) ** (2 / 3)
peak = int(history["force_N"].to_numpy().argmax())
left.plot(1e6 * hertz, force, "k:", label="elastic (Hertz)")
loading, unloading = history.iloc[: peak + 1], history.iloc[peak:]
left.plot(1e6 * loading["approach_m"], loading["force_N"], "o-", label="loading, 8 steps")
left.plot(
    1e6 * unloading["approach_m"],
    unloading["force_N"],
    "s--",
    label="unloading, elastic: in one step",
    markersize=4,
)
left.set(xlabel="approach [µm]", ylabel="force [N]")
left.legend()

strain = plane.pivot(index="z_m", columns="x_m", values="peeq")
found = right.contourf(1e6 * strain.columns, 1e6 * strain.index, 100 * strain, levels=8, cmap="viridis")
right.contour(1e6 * strain.columns, 1e6 * strain.index, strain, levels=[1e-6], colors="tab:red")
figure.colorbar(found, label="plastic strain [%]")
right.set(xlabel="x [µm]", ylabel="z [µm]", xlim=(-6, 6), ylim=(7, 0), title="at the peak; red: plastic zone")
