# SPDX-License-Identifier: MIT
"""The approach of a sphere on steel that yields, over its force, beside Hertz: what plasticity changes."""

import matplotlib.pyplot as plt
import numpy as np

import samfem

body = {"young": "210 GPa", "poisson": 0.3}
steel = {"law": "linear", "yield_stress": "1.2 GPa", "modulus": "10 GPa"}
both = {
    "counterbody": {"shape": "sphere", "radius": "105 um"},
    "loading": {"force": "0.1 N", "steps": 6, "unload": True},
    "grid": {"cells": (33, 33), "extent": ("10.8 um", "10.8 um"), "layers": 12, "depth": "6 um"},
}
yielding = samfem.solve(samfem.Scene(body={**body, "plasticity": steel}, **both))
history = yielding.tables["history"]

force = np.linspace(0, 0.1, 100)
modulus, radius = 210e9 / (1 - 0.3**2), 105e-6
hertz = (3 * force / (4 * modulus * np.sqrt(radius))) ** (2 / 3)

figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
axes.plot(1e6 * hertz, force, "k:", label="elastic (Hertz)")
loading, last = history.query("step <= 6"), history.tail(2)  # the elastic unloading is one step
axes.plot(1e6 * loading["approach_m"], loading["force_N"], "o-", label="linear hardening, loaded")
axes.plot(1e6 * last["approach_m"], last["force_N"], "o--", label="and unloaded in one step")
strain = 100 * history["peeq_max"].max()
axes.set(xlabel="approach [µm]", ylabel="force [N]", title=f"Largest plastic strain {strain:.2g} %")
axes.legend()
figure.savefig("approach_over_force.png", dpi=120)
