# SPDX-License-Identifier: MIT
"""What a scene will compute, what is left out and why, and an estimate of memory and time. Solves nothing.

Estimates count the work from the numbers of cells, with rates measured on one core of a 2020s server processor; they
are orders of magnitude, for deciding whether to start a run.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from math import ceil, log2
from typing import TYPE_CHECKING

from sam.scene import Scene
from sam.scene.errors import printable
from verification import models
from verification.provenance import memory_bytes

if TYPE_CHECKING:
    from sam.grid import CellGrid

PYTHON_BYTES = 120e6  # interpreter with numpy, scipy and (FEM) scikit-fem loaded
FFT_S = 1e-9  # seconds per n log2 n of a transform of n values
KERNEL_S = 1e-7  # seconds per influence coefficient of a stress
LAYERED_TABLE_S, LAYERED_S = 1e-2, 2e-7  # seconds per table of a coated body (load, depth) and per coefficient from it
ITERATIONS = 30  # contact iterations of a load step, coarser grids included
DEPTHS_AT_ONCE = 16  # depths whose spectra are held together
CELL_BYTES, DEPTH_BYTES = 480.0, 240.0  # per cell: surface fields and transforms, and six stresses of one depth
ROUGH_DEPTH_BYTES = 1300.0  # the latter on the whole grid: coefficients, their transform and the stresses
FACTOR_S, FACTOR_BYTES = 4e-7, 60.0  # per unknown^1.2 of a sparse factorisation in the plane; bytes per unknown^1.2
FEM_ITERATIONS = 4  # active-set iterations of a load step
PLASTIC_REACH = 1.5  # Hertz radii from the axis to the border of the plastic box
PLASTIC_ITERATIONS = 6  # of a load step, in both models
FILM_ITERATIONS = 20  # of one with a chemical film: high friction strains a thin layer at the surface
EIGENSTRAIN_S = 1.3e-7  # seconds per eigenstrain coefficient and its transform
OPERATOR_S = 2.5e-9  # seconds per coefficient of one application of the residual-stress operator
SPATIAL_S = 5e-5  # seconds per unknown and iteration of the three-dimensional model: multigrid, tangent, return mapping
SPATIAL_BYTES = 1.4e4  # per unknown of that model
RETURN_MAP_S = 2e-6  # seconds per Gauss point of a return mapping and its tangent
NOTE = "memory and time are estimates from the numbers of cells, not measurements"


@dataclass(frozen=True)
class Stage:
    """A stage of a model: whether it runs, why or why not, and its size."""

    stage: str
    runs: bool
    reason: str
    size: dict = field(default_factory=dict)


def plan(scene: Scene) -> dict:
    """The plan of every model as a mapping that JSON can hold: stages, estimate, or why the model cannot be used."""
    return {"title": scene.title, "note": NOTE, "models": [_model(scene, name) for name in models.MODELS]}


def _model(scene: Scene, model: str) -> dict:
    try:
        models.check(scene, model)
    except models.ModelError as reason:
        return {"model": model, "available": False, "reason": str(reason), "stages": [], "estimate": None}
    stages, memory, seconds = {models.SAM: _sam, models.FEM: _fem, models.FEM_3D: _spatial}[model](scene)
    stages += [Stage(entry.stage, False, entry.reason) for entry in models.left_out(scene, model)]
    estimate = {"memory_bytes": round(PYTHON_BYTES + memory), "time_s": float(f"{seconds:.2g}")}
    return {
        "model": model,
        "available": True,
        "reason": "",
        "stages": [asdict(stage) for stage in stages],
        "estimate": estimate,
    }


def _sam(scene: Scene) -> tuple[list[Stage], float, float]:
    """Stages, bytes and seconds of the semi-analytical model, for a contact half as wide as the grid.

    Contact iterations then transform nx x ny cells (twice the width of the contact), stresses in the plane y = 0
    3/4 as many: contact plus observed width, 3/2 nx by 1/2 ny. Those below a rough patch are four times as many.
    """
    from sam.grid import choose_grid

    grid = choose_grid(scene)
    steps, depths, cells = _steps(scene), len(grid.depths), grid.nx * grid.ny
    rough = scene.surface is not None
    coefficients = 6 * depths * (cells if rough else round(0.75 * grid.nx * 0.25 * grid.ny))
    stages = [
        Stage("grid", True, _grid_reason(scene), {"cells": [grid.nx, grid.ny], "cell_m": [grid.hx, grid.hy]}),
        Stage("surface coefficients", steps > 0, "normal displacement under pressure", {"coefficients": cells}),
        Stage("contact", steps > 0, _load_reason(scene), {"steps": steps}),
        Stage(
            "stresses at the output depths",
            steps > 0,
            "below the whole patch at peak load" if rough else "in the plane y = 0 at peak load",
            {"depths": depths, "largest_depth_m": float(grid.depths[-1]), "coefficients": coefficients},
        ),
    ]
    if scene.coefficient:
        reason = "stresses and displacements of the traction" + _coupling(scene)
        stages.append(Stage("tangential kernels", steps > 0, reason, {"coefficients": coefficients}))
    transform = FFT_S * cells * log2(cells)
    contact = 2 * ITERATIONS * transform
    loads = 1 + (scene.coefficient > 0)  # pressure and traction
    transforms = 4.0 if rough else 0.75  # of nx x ny cells, for a field on all of them or in the plane
    stress = loads * (KERNEL_S * coefficients + 2 * 6 * depths * transforms * transform)
    memory = cells * (CELL_BYTES + _depth_bytes(scene, grid))
    seconds = steps * contact + stress if steps else 0.0
    if scene.body.coating is not None:
        of_coating, more = _coating(scene, steps, loads, depths, cells, coefficients)
        return stages + of_coating, memory, seconds + more + (contact + stress if steps else 0.0)
    if scene.body.plasticity is None:
        return stages, memory, seconds
    plastic, box_memory, box_seconds = _plastic_box(scene, grid)
    contact_again = steps * PLASTIC_ITERATIONS * contact  # the contact is solved inside the plastic loop
    return stages + plastic, memory + box_memory, seconds + contact_again + box_seconds


def _depth_bytes(scene: Scene, grid: CellGrid) -> float:
    """Bytes per cell of the stresses of the depths that are held together."""
    if scene.surface is None:
        return DEPTH_BYTES * min(len(grid.depths), DEPTHS_AT_ONCE)
    from sam.rough import depths_at_once

    return ROUGH_DEPTH_BYTES * min(len(grid.depths), depths_at_once(grid))


def _coating(
    scene: Scene, steps: int, loads: int, depths: int, cells: int, coefficients: int
) -> tuple[list[Stage], float]:
    """Stages that a coating adds, and the seconds of the layered coefficients, of its surface and at the depths."""
    reason = f"film of {scene.body.coating.thickness:g} m in the contact and at the output depths"
    size = {"coefficients": loads * (cells + coefficients), "tables": loads * (1 + depths)}
    comparison = "the same contact and stresses without film, from the coated pressure on"
    stages = [
        Stage("layered coefficients", steps > 0, reason, size),
        *([Stage("bare comparison", True, comparison, {"steps": 1})] if steps else []),
    ]
    seconds = LAYERED_TABLE_S * size["tables"] + LAYERED_S * size["coefficients"]
    return stages, seconds if steps else 0.0


def _coupling(scene: Scene) -> str:
    from sam.grid import coupling_of

    coupled = scene.counterbody is not None and coupling_of(scene, scene.coefficient)
    return ", coupled with the contact" if coupled else ""


def _plastic_box(scene: Scene, grid: CellGrid) -> tuple[list[Stage], float, float]:
    """Stages, bytes and seconds that plasticity adds to the semi-analytical model, for a box around the plastic zone.

    Its operator holds, for every wave number, the 6 x 6 components between every two layers: 36 nz^2 (nx + 1)(ny + 1)
    real numbers of 8 bytes for a box of nx x ny x nz cells.
    """
    from sam.grid import hertz_semi_axes
    from sam.plastic.spectra import SINGLE

    faces = getattr(grid, "faces", None)
    faces = grid.depths if faces is None else faces
    layers = max(len(faces) - 1, 1)
    sizes = zip(hertz_semi_axes(scene), (grid.nx, grid.ny), (grid.hx, grid.hy), strict=True)
    box = [min(n, ceil(2 * PLASTIC_REACH * axis / h)) for axis, n, h in sizes]
    if scene.surface is not None:
        box = [grid.nx, grid.ny]  # islands lie anywhere
    width = 4 if scene.solver.tolerance >= SINGLE else 8
    coefficients = 36 * layers**2 * (box[0] + 1) * (box[1] + 1)
    steps = _steps(scene)
    loop = {"steps": steps} | ({"unload_steps": _unload_steps(scene)} if scene.loading.unload else {})
    stages = [
        Stage(
            "volume grid",
            True,
            "layers of [grid]" if _own_layers(scene) else "layers chosen from the Hertz radius",
            {"layers": layers, "largest_depth_m": float(faces[-1])},
        ),
        Stage(
            "eigenstrain kernels",
            steps > 0,
            "residual stress and displacement of the plastic strain, in a box that grows",
            {"box_cells": [*box, layers], "coefficients": coefficients, "bytes": width * coefficients},
        ),
        Stage(
            "plastic loop", steps > 0, f"method {scene.solver.method}, the contact inside it{_unloading(scene)}", loop
        ),
    ]
    stages += _running_in(scene, steps)
    film = scene.friction is not None and scene.friction.film
    applications = (FILM_ITERATIONS if film else PLASTIC_ITERATIONS) * steps * scene.loading.cycles
    seconds = coefficients * (EIGENSTRAIN_S + OPERATOR_S * width / 8 * applications) if steps else 0.0
    return stages, float(width) * coefficients if steps else 0.0, seconds


def _running_in(scene: Scene, steps: int) -> list[Stage]:
    """Chemical film and wear, of the scenes that have them."""
    out, cycles = [], {"cycles": scene.loading.cycles}
    if scene.friction is not None and scene.friction.film:
        reason = f"fails where it thins by more than {scene.friction.thinning_limit:.4g}, settled with the contact in each step"
        out.append(Stage("chemical film", steps > 0, reason, cycles))
    if scene.wear is not None and scene.wear.tears:
        words = "removal, smoothing, remap and equilibrium after each cycle"
        out.append(Stage("worn geometry", steps > 0, words, cycles))
    return out


def _unload_steps(scene: Scene) -> int:
    return (scene.loading.unload_steps or scene.loading.steps) if _loaded(scene) else 0


def _unloading(scene: Scene) -> str:
    return "; unloading in one step if it is elastic" if scene.loading.unload else ""


def _own_layers(scene: Scene) -> bool:
    return scene.grid is not None and bool(scene.grid.depths or scene.grid.layers)


def _loaded(scene: Scene) -> bool:
    """Whether there is any load: a given pressure, or a force above zero."""
    return scene.loading.prescribed is not None or bool(scene.loading.force)


def _steps(scene: Scene) -> int:
    """Load steps of a cycle, those along the path included."""
    path = scene.loading.path
    return (scene.loading.steps + (path.steps if path else 0)) * _loaded(scene)


def _grid_reason(scene: Scene) -> str:
    given = scene.grid
    named = [name for name in ("cells", "extent") if given is not None and getattr(given, name) is not None]
    chosen = [name for name in ("cells", "extent") if name not in named]
    parts = [f"{' and '.join(named)} from [grid]"] if named else []
    if scene.surface is not None and scene.surface.kind == "file":
        return "that of surface.path" + (", resampled" if scene.surface.resample and "cells" in named else "")
    radius = "Hertz radius" if scene.body.coating is None else "estimated contact radius"
    return ", ".join(parts + ([f"{' and '.join(chosen)} chosen from the {radius}"] if chosen else []))


def _load_reason(scene: Scene) -> str:
    if scene.loading.prescribed:
        return "the pressure is given" + (", and travels" if scene.loading.path else "")
    return "load steps to the peak" if scene.loading.force else "loading.force is zero: no contact"


def _fem(scene: Scene) -> tuple[list[Stage], float, float]:
    """Stages, bytes and seconds of the axisymmetric model, from the mesh that it would use."""
    from fem_reference.model import choose_lines

    columns, rows = (len(line) - 1 for line in choose_lines(scene))
    bodies = 1 + (scene.counterbody is not None and scene.counterbody.elastic)
    unknowns = 2 * bodies * ((columns + 1) * (rows + 1) + columns * (rows + 1) + rows * (columns + 1))
    steps = _steps(scene)
    stages = [
        Stage(
            "mesh",
            True,
            f"{scene.fem.cells_per_radius} cells in the contact radius, box of {scene.fem.box:g} radii",
            {"elements": bodies * columns * rows, "bodies": bodies, "unknowns": unknowns},
        ),
        Stage("contact", steps > 0, _load_reason(scene), {"steps": steps}),
        Stage("stresses at the Gauss points", True, "at peak load", {"points": 4 * columns * rows}),
    ]
    factor = FACTOR_S * unknowns**1.2
    memory, seconds = FACTOR_BYTES * 8 * unknowns**1.2, factor * (1 + steps * FEM_ITERATIONS)
    if _flows(scene):
        points = 4 * columns * rows
        reason = f"backward Euler, in the iterations of the contact{_unloading(scene)}"
        stages.append(Stage("return mapping and plastic history", steps > 0, reason, {"points": points}))
        seconds += steps * scene.loading.cycles * PLASTIC_ITERATIONS * (factor + RETURN_MAP_S * points)
    return stages + _bare_again(scene, steps), memory, seconds * (1 + (scene.body.coating is not None))


def _flows(scene: Scene) -> bool:
    """Whether the body or its film yields."""
    coating = scene.body.coating
    return scene.body.plasticity is not None or (coating is not None and coating.yield_stress is not None)


def _bare_again(scene: Scene, steps: int) -> list[Stage]:
    """What a coated scene has besides in the finite-element models, if it is one."""
    coating = scene.body.coating
    if coating is None:
        return []
    kind = "elastic" if coating.yield_stress is None else "perfectly plastic"
    return [
        Stage("film elements", True, f"{kind}, two elements or more through its thickness", {"thickness_m": coating.thickness}),
        Stage("bare body", steps > 0, "the same contact without the film, for comparison", {"steps": steps}),
    ]


def _spatial(scene: Scene) -> tuple[list[Stage], float, float]:
    """Stages, bytes and seconds of the three-dimensional model, from the mesh that it would use."""
    from fem_reference.spatial.model import mesh_lines

    lines = mesh_lines(scene)
    nx, ny, nz = lines.shape
    unknowns, loading = 3 * (nx + 1) * (ny + 1) * (nz + 1), scene.loading
    steps = _steps(scene)
    half = "half of the body, y >= 0" if lines.half else "the whole body: the scene is not symmetric to y = 0"
    stages = [
        Stage("mesh", True, half, {"elements": nx * ny * nz, "unknowns": unknowns}),
        Stage("contact", steps > 0, _load_reason(scene), {"steps": steps}),
        Stage("stresses in the elements", True, "at peak load", {"points": 8 * nx * ny * nz}),
    ]
    iterations = FEM_ITERATIONS
    if _flows(scene):
        reason = f"backward Euler, in the iterations of the contact{_unloading(scene)}"
        stages.append(Stage("return mapping and plastic history", steps > 0, reason, {"points": 8 * nx * ny * nz}))
        iterations *= loading.cycles
    stages += _bare_again(scene, steps)
    iterations *= 1 + (scene.body.coating is not None)
    return stages, SPATIAL_BYTES * unknowns, SPATIAL_S * unknowns * steps * iterations


def check_memory(scene: Scene, model: str, available: float | None = None) -> None:
    """Raise ModelError if `model` would need more memory than there is: `available` bytes, by default this machine's."""
    available = memory_bytes() if available is None else available
    estimate = _model(scene, model)["estimate"]
    if available and estimate and estimate["memory_bytes"] > available:
        needed, there = (f"{number / 1e9:.3g} GB" for number in (estimate["memory_bytes"], available))
        raise models.ModelError(f"model {model}: about {needed} of memory needed, {there} available: {_smaller(scene, model)}")


def _smaller(scene: Scene, model: str) -> str:
    """What to change, with the value that it has."""
    if model != models.SAM and scene.surface is not None:
        return f"lower grid.cells or fem.box = {scene.fem.box:g}"
    if model != models.SAM:
        return f"lower fem.cells_per_radius = {scene.fem.cells_per_radius} or fem.box = {scene.fem.box:g}"
    from sam.grid import choose_grid

    grid = choose_grid(scene)
    layers = f" or the number of layers, {len(grid.depths)}" if scene.body.plasticity else ""
    return f"lower grid.cells = [{grid.nx}, {grid.ny}]{layers}"


def plan_lines(content: dict) -> list[str]:
    """A plan as lines for the reader."""
    title = printable(content["title"])
    lines = [title] if title else []
    for entry in content["models"]:
        if not entry["available"]:
            lines += ["", f"{entry['model']}: cannot be used: {entry['reason']}"]
            continue
        estimate = entry["estimate"]
        lines += ["", f"{entry['model']}: about {estimate['memory_bytes'] / 1e6:.0f} MB and {estimate['time_s']:g} s"]
        for stage in sorted(entry["stages"], key=lambda stage: not stage["runs"]):
            size = ", ".join(f"{name} {_shown(value)}" for name, value in stage["size"].items())
            mark = "computed" if stage["runs"] else "left out"
            lines.append(f"  {mark}  {stage['stage']}: {stage['reason']}" + (f" ({size})" if size else ""))
    return [*lines, "", content["note"]]


def _shown(value: object) -> str:
    if isinstance(value, list):
        return " x ".join(map(_shown, value))
    return f"{value:.4g}" if isinstance(value, float) else str(value)
