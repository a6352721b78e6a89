# SPDX-License-Identifier: MIT
"""The pressure below a rigid sphere: SAM, finite elements and Hertz in one picture."""

import matplotlib.pyplot as plt
import numpy as np

import samfem

scene = samfem.Scene(
    title="Rigid sphere on steel",
    body={"young": "210 GPa", "poisson": 0.3},
    counterbody={"shape": "sphere", "radius": "105 um"},
    loading={"force": "0.65 N"},
)

figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
for model, look in (("sam", "o"), ("fem-axisymmetric", "-")):
    run = samfem.solve(scene, model)
    line = run.tables["line"].query("state == 'peak' and 0 <= x_m <= 9e-6")
    axes.plot(1e6 * line["x_m"], 1e-9 * line["p_Pa"], look, label=model, markersize=3)

force, radius, modulus = 0.65, 105e-6, 210e9 / (1 - 0.3**2)
a = (3 * force * radius / (4 * modulus)) ** (1 / 3)
p0 = 3 * force / (2 * np.pi * a**2)
r = np.linspace(0, a, 200)
axes.plot(1e6 * r, 1e-9 * p0 * np.sqrt(1 - (r / a) ** 2), "k:", label="Hertz")
axes.set(xlabel="distance from the axis [µm]", ylabel="pressure [GPa]", title=scene.title)
axes.legend()
figure.savefig("pressure_of_both_models.png", dpi=120)
