# SPDX-License-Identifier: MIT
"""
Load cycles and the verdict
===========================
A contact is loaded and unloaded again and again. Below a limit the body shakes down: after few cycles it is
elastic. Above it, plastic strain goes to and fro in every cycle.
"""

import matplotlib.pyplot as plt

import samfem

steel = {"law": "perfect", "yield_stress": "1 GPa", "kinematic": {"modulus": ("11 GPa",)}}
figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
for pressure, look in (("2.8 GPa", "o-"), ("3.6 GPa", "s-")):
    scene = samfem.Scene(
        title=f"repeated pressure of Hertz, {pressure}",
        body={"young": "210 GPa", "poisson": 0.3, "plasticity": steel},
        loading={
            "prescribed": "hertz",
            "p0": pressure,
            "radius": "10 um",
            "steps": 5,
            "unload": True,
            "cycles": 6,
        },
        grid={"cells": (33, 33), "extent": ("34 um", "34 um"), "layers": 12, "depth": "24 um"},
        solver={"uncertainty": True, "tolerance": 1e-4},
    )
    run = samfem.solve(scene)
    print(f"\n{scene.title}: {run.verdict['class']}, decided in cycle {run.verdict['decided_at_cycle']}")
    print(run)
    cycles, found = run.tables["cycles"], run.verdict["class"]
    axes.plot(cycles["cycle"], 100 * cycles["peeq_max"], look, label=f"{pressure}: {found}")
axes.set(xlabel="load cycle", ylabel="largest accumulated plastic strain [%]", ylim=(0, None))
axes.legend(title="largest pressure: verdict")
plt.show()
