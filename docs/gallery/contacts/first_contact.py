# SPDX-License-Identifier: MIT
"""
First contact: a sphere on an elastic body
==========================================
A rigid sphere is pressed on steel that is taken as elastic, so that Hertz gives the exact pressure and shows
at once how good the numbers are. A real steel would yield far earlier.
"""

import matplotlib.pyplot as plt
import numpy as np

import samfem

radius, force, young, poisson = 105e-6, 0.65, 210e9, 0.3
scene = samfem.Scene(
    body={"young": young, "poisson": poisson},
    counterbody={"shape": "sphere", "radius": radius},
    loading={"force": force},
    solver={"uncertainty": True},
)
run = samfem.solve(scene)
print(run)

# %%
# Hertz: contact radius and largest pressure, then the profile.
modulus = young / (1 - poisson**2)
a = (3 * force * radius / (4 * modulus)) ** (1 / 3)
p0 = 3 * force / (2 * np.pi * a**2)
r = np.linspace(-a, a, 400)
line = run.tables["line"].query("p_Pa > 0")

figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
axes.plot(1e6 * r, 1e-9 * p0 * np.sqrt(1 - (r / a) ** 2), "k-", label="Hertz")
axes.plot(1e6 * line["x_m"], 1e-9 * line["p_Pa"], "o", color="C1", markersize=4, label="SAM")
axes.set(xlabel="distance from the axis [µm]", ylabel="contact pressure [GPa]", ylim=(0, 9.5))
axes.set_title(f"largest pressure {1e-9 * run.quantities['p_max_Pa']:.3f} GPa, Hertz {1e-9 * p0:.3f} GPa")
axes.legend(loc="lower center")
plt.show()
