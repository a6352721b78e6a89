# SPDX-License-Identifier: MIT
"""What a repeated load does: cycles of a bar with back-stresses, and shakedown limits below a contact."""

import matplotlib.pyplot as plt
import numpy as np

from verification.reference import shakedown

YOUNG, YIELD = 210e9, 300e6
MODULI, RECOVERY = np.array([60e9, 3e9]), np.array([300.0, 10.0])


def bar(stresses):
    """Strain of a bar in tension and compression, perfectly plastic but for its back-stresses."""
    back, plastic, strains = np.zeros(2), 0.0, []
    for stress in stresses:
        while abs(over := stress - back.sum()) > YIELD * (1 + 1e-9):
            sign = np.sign(over)
            slope = (MODULI - RECOVERY * back * sign).sum()
            step = min((abs(over) - YIELD) / slope, 1e-5)
            back += (MODULI * sign - RECOVERY * back) * step
            plastic += sign * step
        strains.append(stress / YOUNG + plastic)
    return np.array(strains)


figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.8), layout="constrained")
phase = np.linspace(0, 6 * 2 * np.pi, 1200)
for mean, swing, name in (
    (150e6, 250e6, "shakedown"),
    (0.0, 420e6, "alternating"),
    (120e6, 380e6, "ratchetting"),
):
    stress = mean + swing * np.sin(phase)
    left.plot(100 * bar(stress), stress / 1e6, label=name, linewidth=1)
left.set(xlabel="strain of a bar [%]", ylabel="stress [MPa]")
left.legend()

friction = np.linspace(0, 0.3, 7)
right.plot(
    friction,
    [shakedown.travelling_limit(mu)[0] for mu in friction],
    "o-",
    label="load that travels, below the surface",
)
right.plot(
    friction[:6],
    [shakedown.in_place_limit(mu)[0] for mu in friction[:6]],
    "s-",
    label="load in one place, below the surface",
)
right.plot(
    friction,
    [shakedown.upper_bound(mu) for mu in friction],
    "k:",
    label="load that travels: upper bound at the surface",
)
right.set(xlabel="coefficient of friction", ylabel="p$_0$ / k at the shakedown limit", ylim=(0, None))
right.legend(fontsize="small", loc="lower left")
