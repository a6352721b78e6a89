# SPDX-License-Identifier: MIT
"""
Does a thin film matter?
========================
A thin film that is softer or stiffer than the steel below it changes pressure and stress. Where both change
by less than 5 %, the film may be left out of the calculation.
"""

import matplotlib.pyplot as plt

import samfem

thicknesses = (0.1, 0.4, 0.8)  # in µm
figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
for young, colour in (("80 GPa", "C0"), ("400 GPa", "C1")):
    pressure, stress = [], []
    for thickness in thicknesses:
        film = {"thickness": f"{thickness} um", "young": young, "poisson": 0.3}
        scene = samfem.Scene(
            title=f"film of {thickness} µm, {young}, on steel",
            body={"young": "210 GPa", "poisson": 0.3, "coating": film},
            counterbody={"shape": "sphere", "radius": "105 um"},
            loading={"force": "0.65 N"},
            grid={"cells": (49, 49), "extent": ("19 um", "19 um")},
            solver={"uncertainty": True},
        )
        run = samfem.solve(scene)
        print(f"\n{scene.title}:\n{run}")
        pressure.append(100 * run.quantities["p_max_change"])
        stress.append(100 * run.quantities["mises_max_change"])
    axes.plot(thicknesses, pressure, "o-", color=colour, label=f"{young}: pressure")
    axes.plot(thicknesses, stress, "s--", color=colour, label=f"{young}: von Mises stress in the steel")
axes.axhspan(-5, 5, color="0.9", label="negligible")
axes.set(xlabel="film thickness [µm]", ylabel="change of the largest value [%]", ylim=(-22, 9))
axes.legend(title="Young's modulus of the film", loc="lower left")
plt.show()
