# SPDX-License-Identifier: MIT
"""
Your measured surface
=====================
Heights in an array, as a profilometer gives them, are pressed by an elastic plane. The tilt of the sample is
taken off first, and the cells of the calculation are finer than those of the measurement.
"""

import matplotlib.pyplot as plt
import numpy as np

import samfem

side, x, random = 64e-6, np.arange(64) / 64, np.random.default_rng(9)
heights = 0.5e-6 * np.add.outer(x, 0 * x)  # the tilt; your own array takes the place of these lines
for kx, ky, phase in zip(*random.integers(-4, 5, (2, 12)), random.uniform(0, 6.28, 12), strict=True):
    heights += 0.04e-6 * np.cos(2 * np.pi * np.add.outer(kx * x, ky * x) + phase)

steel = {"young": "210 GPa", "poisson": 0.3}
measured = {"kind": "file", "path": samfem.HeightMap(heights, (side, side))}
scene = samfem.Scene(
    title="steel plane on a measured surface",
    body=steel,
    counterbody={"shape": "flat", **steel},
    surface={**measured, "form": "tilt", "resample": "fourier"},
    loading={"force": "0.3 N"},
    grid={"cells": (160, 160), "extent": (side, side), "border": "relief"},
    solver={"uncertainty": True},
)
run = samfem.solve(scene)
print(run)
surface = run.tables["surface"].pivot(index="y_m", columns="x_m")
figure, (left, right) = plt.subplots(1, 2, figsize=(7, 3), sharey=True, layout="constrained")
view = {"origin": "lower", "extent": (-32, 32, -32, 32)}
figure.colorbar(left.imshow(1e6 * surface["height_m"], cmap="cividis", **view), label="height [µm]")
pressure = 1e-9 * surface["p_Pa"].replace(0, np.nan)
figure.colorbar(right.imshow(pressure, **view), label="contact pressure [GPa]")
left.set_ylabel("y [µm]")
figure.supxlabel("x [µm]")
plt.show()
