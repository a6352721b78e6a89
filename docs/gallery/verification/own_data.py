# SPDX-License-Identifier: MIT
"""
Your own data beside both models
================================
Points of your own calculation or measurement, in a CSV file, are held against SAM and finite elements.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib.pyplot as plt
import numpy as np

import samfem

scene = samfem.Scene(
    title="rigid sphere on elastic steel",
    body={"young": "210 GPa", "poisson": 0.3},
    counterbody={"shape": "sphere", "radius": "105 um"},
    loading={"force": "0.65 N"},
    solver={"uncertainty": True},
)
r = 1e-6 * np.array([0, 1, 2, 3, 4, 5, 6, 6.5])
pressure = 1e9 * np.array([8.52, 8.32, 7.98, 7.33, 6.38, 4.73, 1.1, 0])
with TemporaryDirectory() as folder:
    file = Path(folder) / "mine.csv"
    np.savetxt(file, np.transpose([r, pressure]), delimiter=",", header="x_m,p_Pa", comments="")
    comparison = samfem.compare(scene, data=[file], tolerances={"p_max_Pa": "2 %"})
print(comparison.sam, comparison.fem, comparison.line, sep="\n")
rows = comparison.frame.query("mine_passed != 'not compared'")
print(rows[["quantity", "sam", "fem", "mine", "mine_passed"]])

figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
for run, look, label in ((comparison.fem, "k-", "finite elements"), (comparison.sam, "C0--", "SAM")):
    line = run.tables["line"].query("0 <= x_m <= 7e-6")
    axes.plot(1e6 * line["x_m"], 1e-9 * line["p_Pa"], look, label=label)
axes.plot(1e6 * r, 1e-9 * pressure, "C1o", label="own data")
axes.set(xlabel="distance from the axis [µm]", ylabel="contact pressure [GPa]")
axes.legend()
plt.show()
