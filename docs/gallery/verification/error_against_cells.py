# SPDX-License-Identifier: MIT
"""
The error against the number of cells
=====================================
Hertz's solution is exact, so the error of every grid is known: it is of second order in the cells, and the
uncertainty that samfem states from its three grids covers it.
"""

import matplotlib.pyplot as plt
import numpy as np

import samfem

radius, force, modulus = 105e-6, 0.65, 210e9 / (1 - 0.3**2)
a = (3 * force * radius / (4 * modulus)) ** (1 / 3)
p0 = 3 * force / (2 * np.pi * a**2)
cells, error, stated = np.array([25, 35, 49, 69, 97, 137]), [], []
for n in cells:
    scene = samfem.Scene(
        body={"young": "210 GPa", "poisson": 0.3},
        counterbody={"shape": "sphere", "radius": radius},
        loading={"force": force},
        grid={"cells": (n, n), "extent": (2.6 * a, 2.6 * a)},
        solver={"uncertainty": True},
    )
    run = samfem.solve(scene)
    error.append(100 * abs(run.quantities["p_max_Pa"] / p0 - 1))
    stated.append(100 * run.uncertainty["p_max_Pa"]["relative"])
print(run)
order = -np.polyfit(np.log(cells), np.log(error), 1)[0]

figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
axes.loglog(cells / 2.6, stated, "C1s--", label="stated uncertainty")
axes.loglog(cells / 2.6, error, "C0o-", label=f"error against Hertz, order {order:.1f}")
axes.set(xlabel="cells in the contact radius", ylabel="relative to the largest pressure [%]")
axes.set_xticks((10, 20, 40), ("10", "20", "40"))
axes.set_xticks((), minor=True)
axes.legend()
plt.show()
