# SPDX-License-Identifier: MIT
"""The return map in the plane of deviatoric stresses, and the yield surface that hardens and moves."""

import matplotlib.pyplot as plt
import numpy as np

angle = np.linspace(0, 2 * np.pi, 200)
circle = np.array([np.cos(angle), np.sin(angle)])
begin = np.array([0.35, 0.75])  # deviators in yield stresses
step = np.array([0.95, 0.55])  # 2 mu times the strain increment
trial = begin + step
isotropic, kinematic = 0.15, 0.3  # yield stress and back-stress that this step adds

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4.2), layout="constrained")
for axes, back, radius, title in (
    (left, np.zeros(2), 1 + isotropic, "isotropic hardening: the surface grows"),
    (right, kinematic * trial / np.linalg.norm(trial), 1.0, "kinematic hardening: the surface moves"),
):
    normal = (trial - back) / np.linalg.norm(trial - back)
    final = back + radius * normal
    axes.plot(*circle, color="0.6", label="yield surface before the step")
    axes.plot(*(back[:, None] + radius * circle), color="tab:blue", label="after it")
    for start, end, color in (
        (begin, trial, "tab:orange"),
        (trial, final, "tab:red"),
        (np.zeros(2), back, "tab:green"),
    ):
        if np.linalg.norm(end - start) > 0:
            axes.annotate("", end, start, arrowprops={"arrowstyle": "->", "color": color, "linewidth": 1.5})
    axes.text(trial[0] + 0.04, trial[1] + 0.02, "trial stress\ns + 2μ Δe", color="tab:orange")
    axes.text(final[0] - 0.05, final[1] - 0.3, "returned\nalong the normal", color="tab:red")
    if back.any():
        axes.text(back[0] - 0.45, back[1] - 0.22, "back-stress X", color="tab:green")
    axes.plot(*begin, "o", color="black", markersize=4)
    axes.text(begin[0] - 0.2, begin[1] - 0.02, "s")
    axes.set(title=title, xlim=(-1.3, 1.9), ylim=(-1.3, 1.7), aspect="equal", xticks=[], yticks=[])
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, 0.02), ncols=2, frameon=False, fontsize="small")
    axes.spines[:].set_visible(False)
