# SPDX-License-Identifier: MIT
"""Heights in an array, as a profilometer gives them, pressed by a plane: contact spots and their pressure."""

import matplotlib.pyplot as plt
import numpy as np

import samfem

n, side = 64, 64e-6
x = (np.arange(n) - (n - 1) / 2) * side / n
heights = 0.2e-6 * np.cos(2 * np.pi * x[:, None] / 32e-6) * np.cos(2 * np.pi * x / 21.33e-6)
heights += 0.5e-6 * x[:, None] / side  # the sample is tilted

steel = {"young": "210 GPa", "poisson": 0.3}
scene = samfem.Scene(
    body=steel,
    counterbody={"shape": "flat", **steel},
    surface={"kind": "file", "path": samfem.HeightMap(heights, (side, side)), "form": "tilt"},
    loading={"force": "0.4 N"},
    grid={"border": "relief"},
)
run = samfem.solve(scene)
pressure = run.tables["surface"].query("state == 'peak'").pivot(index="y_m", columns="x_m", values="p_Pa")

figure, axes = plt.subplots(figsize=(5.4, 4.4), layout="constrained")
edges = [-32, 32, -32, 32]
image = axes.imshow(1e-9 * pressure.where(pressure > 0), origin="lower", extent=edges, cmap="viridis")
figure.colorbar(image, label="pressure [GPa]")
axes.set(xlabel="x [µm]", ylabel="y [µm]", title=f"{int((pressure > 0).to_numpy().sum())} cells in contact")
figure.savefig("measured_heights.png", dpi=120)
