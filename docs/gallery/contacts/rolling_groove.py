# SPDX-License-Identifier: MIT
"""
A rolling pass and its groove
=============================
A hard ball rolls once over steel that yields. The groove that it leaves is deepest where it began, and steady
after two to three contact radii; material is pushed up beside it and at its ends. On this coarse grid its
depth and the plastic strain are known to about 20 %: more cells and shorter steps along the path narrow that.
"""

import matplotlib.pyplot as plt

import samfem

steel = {"law": "swift", "B": "945 MPa", "C": 20, "n": 0.121}
scene = samfem.Scene(
    title="rigid ball that rolls over steel",
    body={"young": "210 GPa", "poisson": 0.3, "plasticity": steel},
    counterbody={"shape": "sphere", "radius": "105 um", "slip": 0},
    loading={
        "force": "0.17 N",
        "steps": 3,
        "unload": True,
        "path": {"start": ("-12 um", "0 um"), "end": ("12 um", "0 um"), "step_per_radius": 3},
    },
    grid={"cells": (83, 41), "extent": ("36 um", "18 um"), "layers": 12, "depth": "8 um"},
    solver={"tolerance": 1e-3, "uncertainty": True},
)
run = samfem.solve(scene)
print(run)
track = run.tables["track"]  # along the path; cross: in the middle of the steady part
cross = run.tables["cross"].query("z_m == z_m.min()")

figure, (left, right) = plt.subplots(1, 2, figsize=(7, 3.4), sharey=True, layout="constrained")
left.axvspan(-12, 12, color="0.9", label="path of the ball")
left.plot(1e6 * track["x_m"], -1e9 * track["uz_m"], "o-", markersize=3)
left.set(xlabel="position along the path [µm]", ylabel="height after unloading [nm]")
left.legend()
right.plot(1e6 * cross["y_m"], -1e9 * cross["uz_m"], "o-", markersize=3)
right.set(xlabel="position across the path [µm]")
plt.show()
