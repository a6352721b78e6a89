# SPDX-License-Identifier: MIT
"""The half-space, its axes, and a sphere that is pressed on: the solution of Hertz."""

import matplotlib.pyplot as plt
import numpy as np

x = np.linspace(-2.4, 2.4, 401)  # in contact radii a; displacements in a^2/R, pressures in p0
r = np.abs(x)
inside = np.minimum(r, 1.0)
outside = np.maximum(r, 1.0)
u = np.where(
    r <= 1,
    1 - r**2 / 2,
    ((2 - outside**2) * np.arcsin(1 / outside) + np.sqrt(outside**2 - 1)) / np.pi,
)  # Johnson (1985), Eq. 3.42
pressure = np.sqrt(1 - inside**2)
gap0 = r**2 / 2

figure, axes = plt.subplots(figsize=(8, 4), layout="constrained")
axes.fill_between(x, u, 3.2, color="0.87")
axes.plot(x, u, color="0.35", label="surface of the body, moved by u")
axes.axhline(0, color="0.6", linestyle=":", linewidth=1)
axes.plot(x, 1 - gap0, color="tab:blue", label="counter-body: gap0 less the approach delta")
axes.fill_between(x, -1.25 * pressure - 0.6, -0.6, where=r < 1, color="tab:orange", alpha=0.4)
axes.plot(x[r <= 1], -1.25 * pressure[r <= 1] - 0.6, color="tab:orange", label="pressure p")
for place in np.linspace(-0.8, 0.8, 5):
    top = -1.25 * np.sqrt(1 - place**2) - 0.6
    axes.annotate("", (place, -0.62), (place, top), arrowprops={"arrowstyle": "->", "color": "tab:orange"})
axes.annotate("", (2.1, 0), (1.3, 0), arrowprops={"arrowstyle": "->"})
axes.text(2.15, -0.08, "x, sliding")
axes.annotate("", (0, 2.6), (0, 1.2), arrowprops={"arrowstyle": "->"})
axes.text(0.06, 2.6, "z, into the body")
axes.annotate("", (-1, 1.6), (0, 1.6), arrowprops={"arrowstyle": "<->"})
axes.text(-0.55, 1.95, "a")
axes.set(xlim=(-2.4, 2.9), ylim=(3.0, -2.2), xticks=[], yticks=[])
figure.legend(loc="outside lower center", ncols=3, frameon=False, fontsize="small")
axes.spines[:].set_visible(False)
