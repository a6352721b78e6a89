# SPDX-License-Identifier: MIT
"""
A roller: line contact
======================
Away from the ends of a roller all is the same along its axis, and a section in plane strain says everything.
Below a cylinder steel yields first 0.7 half-widths deep; SAM and finite elements find the same zone.
"""

import matplotlib.pyplot as plt

import samfem

steel = {"law": "swift", "B": "945 MPa", "C": 20, "n": 0.121}
scene = samfem.Scene(
    title="rigid roller on steel that yields",
    body={"young": "210 GPa", "poisson": 0.3, "plasticity": steel},
    counterbody={"shape": "cylinder", "radius": "10 mm", "length": "10 mm"},
    loading={"force": "25 kN", "steps": 5},
    grid={"cells": (65, 1), "extent": ("1.6 mm", "10 mm"), "layers": 24, "depth": "1.2 mm"},
    fem={"cells_per_radius": 12},
    solver={"tolerance": 1e-4, "uncertainty": True},
)
comparison = samfem.compare(scene)
print(comparison.sam)
print(comparison.line)
a = 1e6 * comparison.sam.quantities["contact_half_width_m"]

figure, (left, right) = plt.subplots(1, 2, figsize=(7, 3.2), layout="constrained")
for run, look, label in ((comparison.fem, "k-", "plane-strain FEM"), (comparison.sam, "C1o", "SAM")):
    line, axis = run.tables["line"].query("abs(x_m) <= 5e-4"), run.tables["axis"].query("z_m <= 1e-3")
    left.plot(1e6 * line["x_m"], 1e-9 * line["p_Pa"], look, label=label, markersize=3)
    right.plot(1e6 * axis["z_m"], 100 * axis["peeq"], look, label=label, markersize=3)
left.set(xlabel="distance from the axis [µm]", ylabel="contact pressure [GPa]")
left.set_title(f"half-width {a:.0f} µm")
right.set(xlabel="depth below the contact [µm]", ylabel="plastic strain [%]")
left.legend()
plt.show()
