# SPDX-License-Identifier: MIT
"""The coefficients of a loaded cell beside a point force, and the order of the sum over cells by FFT."""

import matplotlib.pyplot as plt
import numpy as np

import samfem
from sam.kernels import Lags, displacement_coefficients

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")

n, nu = 12, 0.3
lag = np.arange(n)
cell = displacement_coefficients(Lags(n, 1, 1.0, 1.0), nu)[:, 0]
left.plot(lag, cell, "o", label="uniform pressure on a cell (Love)")
far = np.linspace(0.3, n - 1, 200)
left.plot(far, (1 - nu) / (2 * np.pi * far), "k:", label="point force (Boussinesq)")
left.set(xlabel="distance in cells", ylabel="u$_z$ μ / (p h)", ylim=(0, 0.45))
left.legend()

p0 = (6 * 0.65 * (210e9 / (1 - nu**2)) ** 2 / (np.pi**3 * 105e-6**2)) ** (1 / 3)
cells = np.array([9, 17, 33, 65, 129])  # in a patch of 2.4 contact radii
errors = []
for number in cells:
    scene = samfem.Scene(
        body={"young": "210 GPa", "poisson": 0.3},
        counterbody={"shape": "sphere", "radius": "105 um"},
        loading={"force": "0.65 N"},
        grid={"cells": (int(number), int(number)), "extent": ("14.53 um", "14.53 um")},
    )
    errors.append(abs(samfem.solve(scene).quantities["p_max_Pa"] / p0 - 1))
right.loglog(cells / 2.4, errors, "o-", label="largest pressure of SAM against Hertz")
right.loglog(cells / 2.4, errors[0] * (cells[0] / cells) ** 2, "k:", label="second order")
right.set(
    xlabel="cells in the contact radius",
    ylabel="relative error",
    xticks=[5, 10, 20, 50],
    xticklabels=[5, 10, 20, 50],
)
right.minorticks_off()
right.legend()
