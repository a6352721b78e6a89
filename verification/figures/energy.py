# SPDX-License-Identifier: MIT
"""Energies over a load path."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from verification.energy.balance import Balance
from verification.figures.style import BLACK, BLUE, GREEN, ORANGE, Columns, Drawing, sheet

PARTS = (
    ("dissipated", "dissipated", ORANGE),
    ("locked", "stored by residual stress", GREEN),
    ("recoverable", "recovered on unloading", BLUE),
)


def over_path(panels: Mapping[str, tuple[Balance, Balance | None]]) -> Drawing:
    """Shares of the largest work over the load steps; panels: title -> (SAM, FEM or None). Areas and line:
    SAM; crosses: FEM.
    """
    rows = Columns("panel", "model", "state", "force_N", "work", "stored", "dissipated")
    with sheet(4.2 * len(panels), 3.4, len(panels), sharey=True) as (figure, axes):
        for axis, (title, (sam, fem)) in zip(axes, panels.items(), strict=True):
            scale, states = sam.work.max(), np.arange(sam.work.size)
            shares = {
                "dissipated": sam.dissipated,
                "locked": sam.stored,
                "recoverable": sam.elastic - sam.stored,
            }
            axis.stackplot(
                states,
                [shares[name] / scale for name, *_ in PARTS],
                colors=[colour for *_, colour in PARTS],
                alpha=0.6,
                labels=[label for _, label, _ in PARTS],
            )
            axis.plot(states, sam.work / scale, color=BLACK, linewidth=1.6, label="work of the tractions")
            if fem is not None:
                axis.plot(fem.work / scale, "x", color=BLACK, label="FEM: work")
                axis.plot(fem.dissipated / scale, "+", color=BLACK, label="FEM: dissipated")
            axis.set(title=title, xlabel="load step, then unloaded", xlim=(0, states[-1]), ylim=(0.0, 1.1))
            axis.legend(loc="upper left")
            for model, one in (("SAM", sam), ("FEM", fem)):
                if one is not None:
                    n, stored = one.work.size, one.elastic + one.beyond
                    shares = ((each / scale) for each in (one.work, stored, one.dissipated))
                    rows.add(title, model, range(n), one.force, *shares)
        axes[0].set_ylabel("share of the work at the peak")
    return Drawing(figure, rows)
