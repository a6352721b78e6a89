# SPDX-License-Identifier: MIT
"""Two grids, one with twice the cells of the other, and what they say together: Richardson's extrapolation.

The errors of maxima, depths and displacements fall with the square of the cell once it is small: not smoothly
where the edge of a contact or of a plastic zone falls between cells. Of two values q_c (coarse) and q_f
(fine, r times as many cells) the extrapolated one is q_f + (q_f - q_c)/(r^2 - 1) (Richardson 1911). The
coarse solution costs a tenth to a half of the fine one. Their difference, recorded with each quantity, tells
how good the fine value is by itself.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from sam.scene import LeftOut, Result, Status

SECOND_ORDER = (
    "approach_m",
    "p_max_Pa",
    "p_center_Pa",
    "mises_max_Pa",
    "mises_max_depth_m",
    "peeq_max",
    "peeq_max_depth_m",
    "residual_uz_center_m",
    "residual_mises_max_Pa",
    "p_max_bare_Pa",
    "mises_max_substrate_Pa",
    "mises_max_bare_Pa",
    "mises_max_film_Pa",
    "peeq_p95",
)
"""Quantities whose error is of second order; those not named are left as the finer grid gives them."""


def with_extrapolation(before: Result, fine: Result, *, finds_force: bool) -> Result:
    """The result on the finer grid, its quantities extrapolated from that on the coarser one.

    finds_force: the approach is given, and the force is one of the quantities.

    Where the coarser grid does not converge or does not resolve the contact, the result says so and is not
    extrapolated.
    """
    cost = {name: (value or 0) + (before.cost[name] or 0) for name, value in fine.cost.items()}
    cells = before.discretisation["cells"]
    if before.status is not Status.CONVERGED or not fine.converged:
        reason = f"{cells} cells: {before.status}"
        return replace(fine, cost=cost, left_out=[*fine.left_out, LeftOut("extrapolation", reason)])
    ratio = fine.discretisation["cells"][0] / cells[0]
    names = (*SECOND_ORDER, "force_N") if finds_force else SECOND_ORDER
    found = extrapolated(before.quantities, fine.quantities, ratio, names)
    changes = {name: found[name] / value - 1 for name in found if (value := fine.quantities[name])}
    extra = {"extrapolated_from_cells": cells, "extrapolation_change": changes}
    return replace(
        fine,
        quantities={**fine.quantities, **found},
        discretisation={**fine.discretisation, **extra},
        cost=cost,
    )


def extrapolated(
    before: Mapping[str, float | None],
    fine: Mapping[str, float | None],
    ratio: float,
    names: Sequence[str] = SECOND_ORDER,
) -> dict[str, float]:
    """Those of the named quantities that both have."""
    found = {}
    for name in names:
        coarse, value = before.get(name), fine.get(name)
        if coarse is not None and value is not None:
            found[name] = value + (value - coarse) / (ratio**2 - 1)
    return found
