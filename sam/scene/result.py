# SPDX-License-Identifier: MIT
"""The result record that both solvers return, the residual histories of their load steps among it.

Nothing here knows how a result is computed. Arrays are SI, tension positive, p > 0 compressive, z into the
body; a table is a mapping from column name to a one-dimensional sequence, all of one length, in file order.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

import numpy as np

Table = Mapping[str, Sequence[Any]]
Progress = Callable[[str, int, int], None]
"""Called by a solver as ``progress(stage, done, total)``; a solver itself prints nothing."""


def _names(text: str) -> tuple[str, ...]:
    return tuple(text.split())


class Status(StrEnum):
    """How a solve ended. Only CONVERGED is a result that may be used without reading on."""

    CONVERGED = "converged"
    NOT_CONVERGED = "not-converged"
    CONTACT_AT_GRID_EDGE = "contact-at-grid-edge"
    UNDER_RESOLVED = "under-resolved"
    PLASTIC_ZONE_AT_GRID_EDGE = "plastic-zone-at-grid-edge"
    STEP_CUT_LIMIT = "step-cut-limit"
    OUTSIDE_OF_MODEL = "outside-of-model"

    @property
    def advice(self) -> str:
        """What the user should change, where no model says it by the keys of the scene."""
        return _BEYOND if self is Status.OUTSIDE_OF_MODEL else ""


_BEYOND = (
    "the contact is too large for small strains of a flat half-space: lower loading.force (or "
    "loading.approach), or give [solver] beyond_model = true"
)

QUANTITIES = _names(
    "force_N approach_m contact_area_m2 contact_radius_m p_max_Pa p_center_Pa mises_max_Pa "
    "mises_max_depth_m peeq_max peeq_max_depth_m residual_uz_center_m residual_mises_max_Pa p_max_bare_Pa "
    "mises_max_substrate_Pa mises_max_bare_Pa mises_max_film_Pa p_max_change mises_max_change "
    "friction_coefficient pressure_centroid_x_m tangential_displacement_center_m residual_ux_center_m "
    "plastic_shear_center_m wear_volume_m3 peeq_p95 contact_spots contact_share mean_gap_m "
    "contact_half_width_m"
)
"""Names of the scalar results, unit in the name; a quantity that does not apply to a scene is None."""
STRAINED = 0.01
"""Of peeq_max: the plastic volume is where the accumulated plastic strain is above this."""
EXCEEDING = 0.05
"""Share of the plastic volume that has more than peeq_p95; peeq_max is of one row of cells."""
PATH_QUANTITIES = _names(
    "groove_depth_m groove_deepest_m groove_deepest_x_m shoulder_start_m shoulder_end_m shoulder_side_m "
    "transient_length_m rolling_coefficient passes_to_steady"
)
"""Further ones of a scene whose counter-body moves."""

PEAK, UNLOADED, LAST = "peak", "unloaded", "last"
"""States of the tables; LAST in place of both: the last load that was reached, where the peak was not."""

HISTORY = _names(
    "cycle step force_N approach_m contact_area_m2 p_max_Pa peeq_max friction_coefficient iterations "
    "residual note"
)
PATH_HISTORY = ("s_m", "fx_N", "pressure_offset_m")
"""Last columns of the table history of a scene whose counter-body moves."""
STRESSES = ("sxx_Pa", "syy_Pa", "szz_Pa", "syz_Pa", "sxz_Pa", "sxy_Pa")
AXIS = ("state", "z_m", "peeq", "mises_Pa", *STRESSES)
LINE = ("state", "x_m", "p_Pa", "qx_Pa", "gap_m", "uz_m", "ux_m", "plastic_shear_m")
PLANE = ("state", "x_m", "z_m", "peeq", "mises_Pa")
CUT = ("state", "x_m", "y_m", "z_m", "peeq", "mises_Pa", *STRESSES)
"""The plane y = const through the largest pressure, of contacts that may lie beside the origin."""
COUNTER_HEIGHT = "counterbody_height_m"  # last column of the table surface under a rough counter-body
SURFACE = ("state", "x_m", "y_m", "height_m", "p_Pa", "worn_m", "friction")
PLASTIC_STRAINS = ("epxx", "epyy", "epzz", "epyz", "epxz", "epxy")
LOOPS = ("point", "x_m", "y_m", "z_m", "cycle", "step", "peeq", *STRESSES, *PLASTIC_STRAINS)
"""Stress and plastic strain of three points over the last period of a scene that is judged."""
CYCLES = _names(
    "cycle wear_volume_m3 friction_coefficient sa_m sq_m ssk protected_fraction peeq_max p_max_Pa "
    "operator_applications new_strain_max yielding_cells margin_to_limit wear_of_cycle_m3"
)
PERIODS_TO_DECIDE = "periods_to_decide"
VERDICT_COLUMNS = (
    *_names("period peeq_step_max strain_step_max peeq_step_ratio closure flowing_volume_m3"),
    *("ratchetting_volume_m3", "verdict", PERIODS_TO_DECIDE),
)
"""Last columns of the table cycles of a scene that is judged, see `sam.scene.verdict`."""
BACK_STRESS = "back_stress_Pa"
"""A field of the meshes where there are back-stresses, with six components."""
FRICTION_SIGN = "friction_sign"
"""Of the table cycles, where the traction points along -x in some cycle: 1 or -1."""
DISSIPATED = "dissipated_J"
"""Of the table cycles, where there are back-stresses or repeated loading is judged."""
ROOFED = "roofed_volume_m3"
"""Of the table cycles of a scene with [wear]: beyond the strain limit below sound material, which keeps it or
falls with it."""
WEAR_PARTS = {"raw_volume_m3": "raw", "roof_volume_m3": "roof", "filled_volume_m3": "filled"}
"""Of the table cycles where a roof falls or the filter fills, of each cycle: removed before smoothing, the
sound material among that, what smoothing leaves or raises -> of `CycleEnd`."""
OF_WEAR = (ROOFED, *WEAR_PARTS)
LEFT = ("yield_excess", "flow_residual")
"""Of the table cycles of the paper's loops: the largest that a load step of the cycle leaves."""
TRACK = (
    "x_m",
    "uz_m",
    "peeq_max",
    "steady",
    *(f"{place}_{name}" for place in ("top", "deep") for name in ("z_m", "sxx_Pa", "syy_Pa", "sxz_Pa")),
)
CROSS = ("y_m", "z_m", "uz_m", "peeq", "mises_Pa", *STRESSES)
PASSES = _names(
    "pass direction groove_m shoulder_start_m shoulder_end_m shoulder_side_m new_strain_max fx_mean_N rolling"
)
OF_PASSES = _names("work_J friction_mean protected_mean wear_of_pass_m3 wear_per_length_m2")
"""Last columns of the table passes of a scene with [wear] or a chemical film."""
TRACK_WORN = "worn_m"
"""Last column of the table track of a scene with [wear]."""
VISITS = ("way_m", "time_s", "thinning_limit", "visits")
"""Visits of a counter-body that moves to the cells of a body with a film, by the way between two of them."""
RESIDUALS = ("cycle", "step", "attempt", "accepted", "iteration", "residual", "goal")
UNCERTAIN = _names("quantity value u_num relative u_cells u_steps u_box order_seen flag")
"""Columns of the quantities with their numerical uncertainty, which no solver returns by itself."""
COLUMNS = {
    "history": HISTORY,
    "axis": AXIS,
    "line": LINE,
    "plane": PLANE,
    "cut": CUT,
    "surface": SURFACE,
    "cycles": CYCLES,
    "loops": LOOPS,
    "residuals": RESIDUALS,
    "quantities": UNCERTAIN,
    "track": TRACK,
    "cross": CROSS,
    "passes": PASSES,
    "visits": VISITS,
}
"""Columns of each table, in file order."""
EXTRA_COLUMNS = {
    "history": PATH_HISTORY,
    "surface": (COUNTER_HEIGHT,),
    "passes": OF_PASSES,
    "track": (TRACK_WORN,),
    "cycles": (*VERDICT_COLUMNS[:-1], DISSIPATED, FRICTION_SIGN, PERIODS_TO_DECIDE, *OF_WEAR, *LEFT),
}
"""Last columns of a table that only some scenes have."""

COST = _names(
    "setup_s solve_s cpu_s peak_memory_bytes contact_iterations plastic_iterations operator_applications "
    "displacement_applications ffts newton_iterations step_cuts"
)
"""Names of the counters and times. A solver fills those it has; the others are None."""


@dataclass(frozen=True)
class LeftOut:
    """A stage that the scene does not need, and why."""

    stage: str
    reason: str


@dataclass(frozen=True)
class Stage:
    """A stage of a model as its plan has it: its name, whether it runs, why or why not, and its size.

    size: numbers by name ("cells": [33, 33], "steps": 10); a name that ends in _m is a length in m, "bytes"
    are bytes; empty for a stage that does not run.
    """

    stage: str
    runs: bool
    reason: str
    size: Mapping[str, Any] = field(default_factory=dict)


NO_FORCE = "loading.force is zero: no contact"
"""Reason of a stage that the scene has, and that its load leaves nothing to do."""


def left_out_of(stages: Iterable[Stage]) -> list[LeftOut]:
    """The stages that the scene does not need; those without force are needed, and idle."""
    idle = [stage for stage in stages if not stage.runs]
    return [LeftOut(stage.stage, stage.reason) for stage in idle if stage.reason != NO_FORCE]


@dataclass(frozen=True)
class FieldMesh:
    """Fields on a mesh, for ParaView and pyvista.

    points: (n, 3) in m; cells: meshio cell type -> (m, k) node numbers, in the order in which the cell data
    are stored; point_data, cell_data: name -> (n,), (n, 3) or (n, 6), and (sum of m,) or (sum of m, 6).
    Order of stress and plastic strain: 11 22 33 23 13 12, strain as tensor components (not twice the shear);
    the writer of files turns it into VTK's.
    """

    points: np.ndarray
    cells: Mapping[str, np.ndarray]
    point_data: Mapping[str, np.ndarray] = field(default_factory=dict)
    cell_data: Mapping[str, np.ndarray] = field(default_factory=dict)


@dataclass(frozen=True)
class GridFields:
    """Fields on a rectilinear grid, for ParaView and pyvista.

    x (nx,), y (ny,), z (nz,): its planes in m, ascending; one alone where it is flat. point_data: name ->
    (nx, ny, nz), of a vector (3, nx, ny, nz), of a tensor (6, nx, ny, nz) in the order of `FieldMesh`;
    cell_data: the same with one entry less along each side that is not flat.
    """

    x: np.ndarray
    y: np.ndarray
    z: np.ndarray
    point_data: Mapping[str, np.ndarray] = field(default_factory=dict)
    cell_data: Mapping[str, np.ndarray] = field(default_factory=dict)


@dataclass(frozen=True)
class Result:
    """What a solver returns for a scene.

    quantities: every name of QUANTITIES -> float or None, at the peak load and after it; all None where it
    was not reached: then last_fitting has those of the last load that was; tables: name of COLUMNS -> Table;
    fields: of the first state of the tables; bodies: state -> finite-element mesh with its fields; grids:
    state, or "cycle-1" for what the first cycle left -> part of the body ("surface", "plane", "body") ->
    fields on its grid; verdict: on repeated loading, see `sam.scene.verdict`, None where nothing is judged;
    uncertainty: of the quantities, None where it is not asked for; model_range: by how much the model is off,
    None where nothing is known; no solver says either of them;
    discretisation: what was chosen (grid or mesh, in SI); certificate: residuals measured on the returned
    fields (dimensionless, meaning in the solver); message: empty when converged, else what to change.
    """

    model: str
    status: Status
    quantities: Mapping[str, float | None]
    tables: Mapping[str, Table]
    fields: FieldMesh | None = None
    left_out: Sequence[LeftOut] = ()
    discretisation: Mapping[str, Any] = field(default_factory=dict)
    certificate: Mapping[str, float] = field(default_factory=dict)
    cost: Mapping[str, float | int | None] = field(default_factory=dict)
    message: str = ""
    warnings: Sequence[str] = ()
    last_fitting: Mapping[str, float | None] = field(default_factory=dict)
    bodies: Mapping[str, FieldMesh] = field(default_factory=dict)
    grids: Mapping[str, Mapping[str, GridFields]] = field(default_factory=dict)
    verdict: Mapping[str, Any] | None = None
    uncertainty: Mapping[str, Any] | None = None
    model_range: Mapping[str, Any] | None = None

    @property
    def converged(self) -> bool:
        """Whether the status is CONVERGED."""
        return self.status is Status.CONVERGED


def of_load(state: str, quantities: Mapping[str, float | None]) -> dict[str, Mapping[str, float | None]]:
    """The fields quantities and last_fitting of a Result, of the first state of its tables."""
    if state == PEAK:
        return {"quantities": quantities}
    return {"quantities": dict.fromkeys(quantities), "last_fitting": quantities}


RECENT = 10  # iterations that are asked whether the residual still falls
FALLS = 0.5  # it does if they bring its smallest value below this share of that before them


@dataclass(frozen=True)
class Attempt:
    """An attempt at a load: accepted, not discarded; residuals by iteration, that may stop at goal."""

    accepted: bool
    residuals: tuple[float, ...]
    goal: float


def residual_table(steps: Iterable[tuple[int, int, Sequence[Attempt]]]) -> dict[str, list[Any]]:
    """A row for each iteration. steps: (cycle, step, its attempts in their order)."""
    rows = [
        (cycle, step, k, int(attempt.accepted), n, residual, attempt.goal)
        for cycle, step, attempts in steps
        for k, attempt in enumerate(attempts, start=1)
        for n, residual in enumerate(attempt.residuals, start=1)
    ]
    return {name: [row[k] for row in rows] for k, name in enumerate(RESIDUALS)}


def stagnates(residuals: Sequence[float]) -> bool:
    """Whether the last iterations hardly lowered the smallest residual before them."""
    before, recent = residuals[:-RECENT], residuals[-RECENT:]
    return bool(before) and not min(recent) < FALLS * min(before)


def unfinished(what: str, residuals: Sequence[float], goal: float, stalled: bool | None = None) -> str:
    """Why an iteration ended above its goal; stalled: no residual fell, None: judged here."""
    finite = [value for value in residuals if np.isfinite(value)]
    if not finite or len(finite) < len(residuals) or finite[-1] > max(10.0 * finite[0], 1.0):
        return f"{what} diverged"
    best = min(finite)
    if stagnates(finite) if stalled is None else stalled:
        return f"{what} stagnated: its residual no longer falls below {best:.1e}, and {goal:.1e} is wanted"
    left = f"{best:.1e} is left, {goal:.1e} is wanted"
    return f"{what} ran out of iterations, {len(finite)}, while its residual still fell: {left}"
