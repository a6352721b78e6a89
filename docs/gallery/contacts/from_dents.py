# SPDX-License-Identifier: MIT
"""
A modulus from force over depth
===============================
From depths under a ball (closed form of Hertz, noise, 180 GPa) come the modulus and the zero of the depth,
with their confidence. The page "From dents to a yield curve" of the guide fits plasticity.
"""

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

import samfem

force = np.linspace(0.02, 1.0, 30)
modulus = 1 / ((1 - 0.3**2) / 180e9)
depth = (9 * force**2 / (16 * modulus**2 * 1e-3)) ** (1 / 3) + 20e-9
depth += np.random.default_rng(1).normal(0, 1e-9, force.size)
found = samfem.fit(
    {
        "scene": {
            "body": {"young": "210 GPa", "poisson": 0.3},
            "counterbody": {"shape": "sphere", "radius": "1 mm"},
            "solver": {"uncertainty": True},
        },
        "tests": [{"data": pd.DataFrame({"force_N": force, "depth_m": depth}), "noise": "1 nm"}],
        "unknown": {"body.young": ["100 GPa", "400 GPa"], "zero": ["-100 nm", "100 nm"]},
    }
)
print("E in GPa, 90 %:", np.round(np.divide(found.intervals["body.young"], 1e9), 1))
print(samfem.solve(found.scene()))

figure, (left, right) = plt.subplots(1, 2, figsize=(7, 3.2), layout="constrained")
left.plot(1e9 * depth, force, ".", label="measured")
left.plot(1e9 * (depth + found.sigma[0] * found.residuals[0]), force, label="fit")
left.set(xlabel="depth [nm]", ylabel="force [N]")
left.legend()
right.plot(force, found.residuals[0], ".")
right.set(xlabel="force [N]", ylabel="residual over noise")
plt.show()
