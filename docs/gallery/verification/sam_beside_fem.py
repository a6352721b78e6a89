# SPDX-License-Identifier: MIT
"""
SAM beside finite elements
==========================
Both models solve the same scene and share nothing else. Each row of the comparison has its tolerance, and the
uncertainty of both models together.
"""

import matplotlib.pyplot as plt

import samfem

steel = {"law": "linear", "yield_stress": "1.2 GPa", "modulus": "10 GPa"}
scene = samfem.Scene(
    title="rigid sphere on steel that yields",
    body={"young": "210 GPa", "poisson": 0.3, "plasticity": steel},
    counterbody={"shape": "sphere", "radius": "105 um"},
    loading={"force": "0.1 N", "steps": 5},
    grid={"cells": (41, 41), "extent": ("11 um", "11 um"), "layers": 18, "depth": "6 um"},
    fem={"cells_per_radius": 12},
    solver={"uncertainty": True},
)
comparison = samfem.compare(scene)
print(comparison.sam)
print(comparison.fem)
print(comparison.line)
print(comparison.frame[["quantity", "sam", "fem", "difference", "tolerance", "u_num"]].to_string())

figure, (left, right) = plt.subplots(1, 2, figsize=(7, 3.2), layout="constrained")
for run, look, label in ((comparison.fem, "k-", "finite elements"), (comparison.sam, "C1o", "SAM")):
    line = run.tables["line"].query("0 <= x_m <= 5e-6")
    axis = run.tables["axis"].query("z_m <= 5e-6")
    left.plot(1e6 * line["x_m"], 1e-9 * line["p_Pa"], look, label=label, markersize=4)
    right.plot(1e6 * axis["z_m"], 100 * axis["peeq"], look, label=label, markersize=4)
left.set(xlabel="distance from the axis [µm]", ylabel="contact pressure [GPa]")
right.set(xlabel="depth below the contact [µm]", ylabel="plastic strain [%]")
left.legend()
plt.show()
