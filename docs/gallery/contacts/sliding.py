# SPDX-License-Identifier: MIT
"""
Plastic strain below a sliding sphere
=====================================
Without friction steel yields most below the surface. With a coefficient of friction of 0.3 the plastic zone
leans forward and yields most at the surface, at the rear edge. No axisymmetric model can show it.
"""

import matplotlib.pyplot as plt

import samfem

depths = tuple(1e-6 * z for z in (0, 0.15, 0.3, 0.5, 0.75, 1, 1.3, 1.65, 2, 2.4, 2.9, 3.5, 4.2, 5, 6, 7))
levels = (0.02, 0.3, 0.6, 0.9, 1.2, 1.5, 1.8, 2.1, 2.4, 2.7)
figure, panels = plt.subplots(2, 1, figsize=(6, 5), sharex=True, layout="constrained")
for axes, coefficient in zip(panels, (0.0, 0.3), strict=True):
    scene = samfem.Scene(
        title=f"sliding sphere, coefficient of friction {coefficient:g}",
        body={
            "young": "210 GPa",
            "poisson": 0.3,
            "plasticity": {"law": "linear", "yield_stress": "1.2 GPa", "modulus": "10 GPa"},
        },
        counterbody={"shape": "sphere", "radius": "105 um"},
        loading={"force": "0.1 N", "steps": 4},
        friction={"coefficient": coefficient},
        grid={"cells": (33, 33), "extent": ("12 um", "12 um"), "depths": depths},
        solver={"uncertainty": True, "tolerance": 1e-4},
    )
    run = samfem.solve(scene)
    print(run)
    strain = 100 * run.tables["plane"].pivot(index="z_m", columns="x_m", values="peeq")
    image = axes.contourf(1e6 * strain.columns, 1e6 * strain.index, strain, levels, cmap="viridis")
    axes.set(xlim=(-6, 6), ylim=(5, 0), ylabel="depth [µm]")
    axes.set_title(
        f"coefficient of friction {coefficient:g}, largest strain {100 * run.quantities['peeq_max']:.1f} %"
    )
figure.colorbar(image, ax=panels, label="plastic strain [%]")
panels[1].set_xlabel("position along sliding [µm]")
plt.show()
