# SPDX-License-Identifier: MIT
"""
Running-in: friction falls, wear slows down
===========================================
A rough surface with a weak outer layer slides under a chemical film; where that breaks down, friction is high
and steel is worn off. So few cells tell no more than the order of the worn volume, as its uncertainty says.
"""

import matplotlib.pyplot as plt

import samfem

elastic = {"young": "210 GPa", "poisson": 0.3}
steel = {"law": "swift", "B": "1780 MPa", "C": 4, "n": 0.095, "profile": ((0, 0.6), (5e-7, 0.8), (1e-6, 1))}
film = {"film_thickness": "100 nm", "film_young": "80 GPa", "film_poisson": 0.3, "film_yield": "0.67 GPa"}
rough = {"kind": "self-affine", "ra": "0.15 um", "cutoff_long": 32e-6, "cutoff_short": 12e-6, "hurst": 0.8}
depths = [1e-6 * z for z in (0, 0.08, 0.17, 0.28, 0.42, 0.6, 0.85, 1.2, 1.7, 2.5, 3.7, 5.5, 8, 12)]
scene = samfem.Scene(
    body={**elastic, "plasticity": steel},
    counterbody={"shape": "flat", **elastic},
    surface={**rough, "seed": 11},
    loading={"force": "0.3 N", "steps": 3, "unload": True, "cycles": 4},
    friction={"law": "chemical-film", "low": 0.1, "high": 0.4, **film, "strain_limit": 0.02},
    wear={"strain_limit": 0.02, "smoothing_window": 5},
    grid={"cells": (45, 45), "extent": ("32 um", "32 um"), "border": "relief", "depths": depths},
    solver={"tolerance": 1e-3, "uncertainty": True},
)
run = samfem.solve(scene)
print(run)
surface, cycles = run.tables["surface"].query("state == 'unloaded'"), run.tables["cycles"]
worn = 1e9 * surface.pivot(index="y_m", columns="x_m", values="worn_m").replace(0, float("nan"))
figure, panels = plt.subplot_mosaic("AB;AC", figsize=(7, 4.2), layout="constrained")
image = panels["A"].imshow(worn, origin="lower", extent=(-16, 16, -16, 16))
figure.colorbar(image, label="worn depth after four load cycles [nm]", location="top")
panels["A"].set(xlabel="x [µm]", ylabel="y [µm]")
panels["B"].plot(cycles["cycle"], 1e18 * cycles["wear_volume_m3"], "o-")
panels["B"].set(ylabel="worn volume [µm³]", ylim=(0, None), xticks=(1, 2, 3, 4))
panels["C"].plot(cycles["cycle"], cycles["friction_coefficient"], "o-")
panels["C"].set(xlabel="load cycle", ylabel="coefficient of friction", ylim=(0, 0.4), xticks=(1, 2, 3, 4))
plt.show()
