# SPDX-License-Identifier: MIT
"""
Rough contact and its spots
===========================
An elastic plane touches a rough surface in a few spots only. Their common area grows nearly in proportion to
the force. The five with the largest forces are numbered.
"""

import matplotlib.pyplot as plt
import numpy as np

import samfem

steel = {"young": "210 GPa", "poisson": 0.3}
rough = {"kind": "self-affine", "sq": "0.1 um", "cutoff_long": "32 um", "cutoff_short": "8 um", "hurst": 0.8}
scene = samfem.Scene(
    title="steel plane on a rough steel surface",
    body=steel,
    counterbody={"shape": "flat", **steel},
    surface={**rough, "seed": 1},
    loading={"force": "0.6 N", "steps": 6},
    grid={"cells": (160, 160), "extent": ("64 um", "64 um"), "border": "relief"},
    solver={"uncertainty": True},
)
run = samfem.solve(scene)
print(run)
pressure = run.tables["surface"].pivot(index="y_m", columns="x_m", values="p_Pa")
history, spots = run.tables["history"], run.tables["spots"]
print(spots.head())

figure, (left, right) = plt.subplots(1, 2, figsize=(7, 3.2), layout="constrained")
image = left.imshow(1e-9 * pressure.replace(0, np.nan), origin="lower", extent=(-32, 32, -32, 32))
left.set(xlabel="x [µm]", ylabel="y [µm]", title=f"{len(spots)} contact spots")
for spot in spots.head().itertuples():
    left.text(1e6 * (spot.x_m + 0.6 * spot.area_m2**0.5), 1e6 * spot.y_m, f"{spot.spot:.0f}", va="top")
figure.colorbar(image, label="contact pressure [GPa]")
right.plot(history["force_N"], 100 * history["contact_area_m2"] / 64e-6**2, "o-")
right.set(xlabel="force [N]", ylabel="area in contact [%]", xlim=(0, None), ylim=(0, None))
plt.show()
