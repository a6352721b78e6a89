# SPDX-License-Identifier: MIT
"""The stages that each model runs for a scene, in the order in which they begin, with reasons and sizes.
Solves nothing.

What is not among them is left out, and the models say why (`models.left_out`); test_leave_out counts that
what is listed runs and nothing else does.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from sam.scene import Scene, Stage
from sam.scene.result import NO_FORCE
from verification.cost import estimates
from verification.cost.estimates import loaded, steps_of
from verification.runs import models

if TYPE_CHECKING:
    from sam.grid.cells import CellGrid


def of_sam(scene: Scene) -> list[Stage]:
    """Stages of the semi-analytical model."""
    from sam.planner.grids import choose_grid

    grid = choose_grid(scene)
    return [
        *_cells(scene, grid),
        *_needs_force(
            scene,
            [
                *_coarser(scene, grid),
                *_surface(scene, grid),
                *_load(scene),
                *(_plastic(scene, grid) if scene.body.plasticity is not None else []),
                *_unloading(scene, scene.body.plasticity is not None),
                *_output(scene, grid),
            ],
        ),
    ]


def _coarser(scene: Scene, grid: CellGrid) -> list[Stage]:
    """The solution on fewer cells that quantities are extrapolated from."""
    if not scene.solver.extrapolate:
        return []
    from sam.extrapolation import halved

    reason = "solver.extrapolate: all that follows on half as many cells first"
    return [Stage("coarser grid", True, reason, {"cells": [halved(grid.nx), halved(grid.ny)]})]


def _needs_force(scene: Scene, stages: list[Stage]) -> list[Stage]:
    """The stages, none of which runs without force."""
    return stages if loaded(scene) else [Stage(each.stage, False, NO_FORCE) for each in stages]


def _cells(scene: Scene, grid: CellGrid) -> list[Stage]:
    """Cells, heights and layers."""
    cells, faces, surface = [grid.nx, grid.ny], grid.faces, scene.surface
    stages = [Stage("grid", True, _grid_reason(scene), {"cells": cells, "cell_m": [grid.hx, grid.hy]})]
    if faces is not None:
        reason = "layers of [grid]" if _own_layers(scene) else f"layers chosen from the {_length(scene)}"
        size = {"layers": max(len(faces) - 1, 1), "largest_depth_m": float(faces[-1])}
        stages.append(Stage("volume grid", True, reason, size))
    if surface is not None:
        stages.append(
            Stage(
                "surface heights",
                True,
                f'[surface], kind "{surface.kind}", at the cell centres',
                {"cells": cells},
            )
        )
    return stages


def _surface(scene: Scene, grid: CellGrid) -> list[Stage]:
    """Influence coefficients of the surface."""
    loads, cells = 1 + (scene.coefficient > 0), grid.nx * grid.ny  # pressure and traction
    stages = [
        Stage("surface coefficients", True, "normal displacement under pressure", {"coefficients": cells})
    ]
    if scene.body.coating is not None:
        reason = f"film of {scene.body.coating.thickness:g} m in the contact and at the output depths"
        size = {
            "coefficients": loads * (cells + estimates.stress_coefficients(scene, grid)),
            "tables": loads * (1 + len(grid.depths)),
        }
        stages.append(Stage("layered coefficients", True, reason, size))
    if _coupled(scene):
        reason = "the traction moves the surfaces normally too: part of the gap"
        stages.append(Stage("coupling", True, reason, {"coefficients": cells}))
    return stages


def _load(scene: Scene) -> list[Stage]:
    """What puts the load on, in all three models."""
    if scene.loading.prescribed:
        reason = f'loading.prescribed = "{scene.loading.prescribed}"' + (
            ", and travels" if scene.loading.path else ""
        )
        return [Stage("given pressure", True, reason, {"steps": steps_of(scene)})]
    return [Stage("contact search", True, "load steps to the peak", {"steps": steps_of(scene)})]


def _plastic(scene: Scene, grid: CellGrid) -> list[Stage]:
    """What plasticity, a chemical film and wear add to the semi-analytical model."""
    box, loading = estimates.plastic_box(scene, grid), scene.loading
    first, growing = "whether and where the elastic stress exceeds the yield stress", "in a box that grows"
    if scene.friction is not None and scene.friction.film:
        first += ", with friction.high everywhere"
    kernels = {
        "box_cells": [box.nx, box.ny, box.layers],
        "coefficients": box.coefficients,
        "bytes": box.width * box.coefficients,
    }
    loop = {"steps": steps_of(scene)} | ({"unload_steps": _unload_steps(scene)} if loading.unload else {})
    where = "the given pressure" if loading.prescribed else "the contact"
    words = f"method {scene.solver.method}, {where} inside it"
    stages = [
        Stage("elastic peak", True, first, {"depths": len(grid.depths)}),
        Stage(
            "eigenstrain kernels",
            True,
            f"residual stress and displacement of the plastic strain, {growing}",
            kernels,
        ),
        Stage("plastic loop", True, words, loop),
    ]
    return stages + _cycles(scene) + _running_in(scene)


def _cycles(scene: Scene, reason: str = "each starts from the strain that the others left") -> list[Stage]:
    """Further cycles that are not equal to the first."""
    cycles = scene.loading.cycles
    return [Stage("cycles after the first", True, reason, {"cycles": cycles})] if cycles > 1 else []


def _running_in(scene: Scene) -> list[Stage]:
    """Chemical film and wear, of the scenes that have them."""
    out, cycles = [], {"cycles": scene.loading.cycles}
    if scene.friction is not None and scene.friction.film:
        reason = f"fails where it thins by more than {scene.friction.thinning_limit:.4g}, "
        reason += "settled with the contact in each step"
        out.append(Stage("chemical film", True, reason, cycles))
    if scene.wear is not None and scene.wear.tears:
        words = "removal, smoothing, remap and equilibrium after each cycle"
        out.append(Stage("worn geometry", True, words, cycles))
    return out


def _unloading(scene: Scene, flows: bool) -> list[Stage]:
    """The way back to no force, in all three models; flows: whether something may yield in it."""
    if not scene.loading.unload:
        return []
    if not flows:
        return [Stage("unloading", True, "elastic: in one step", {"steps": 1})]
    return [
        Stage(
            "unloading",
            True,
            "in one step if that strains nothing, else in equal ones",
            {"steps": _unload_steps(scene)},
        )
    ]


def _output(scene: Scene, grid: CellGrid) -> list[Stage]:
    """What is computed of the solved contact."""
    from sam.loading import leaves_axis

    depths, coefficients = len(grid.depths), estimates.stress_coefficients(scene, grid)
    states = "at peak load" + (
        " and unloaded" if scene.loading.unload and scene.body.plasticity is not None else ""
    )
    size = {"depths": depths, "largest_depth_m": float(grid.depths[-1]), "coefficients": coefficients}
    stages = [Stage("stresses at the output depths", True, f"in the plane y = 0 {states}", size)]
    if scene.surface is not None:
        reason = "rough: the largest von Mises stress lies anywhere below the patch"
        stages.append(
            Stage(
                "stress outside the plane y = 0",
                True,
                reason,
                {"cells": [grid.nx, grid.ny], "depths": depths},
            )
        )
    elif leaves_axis(scene):
        reason = "the load ends beside y = 0: the largest von Mises stress lies below it"
        stages.append(
            Stage("stress outside the plane y = 0", True, reason, {"cells": [grid.nx, 1], "depths": depths})
        )
    if scene.coefficient:
        reason = "stresses of the traction, displacements along x"
        stages.append(Stage("tangential kernels", True, reason, {"coefficients": coefficients}))
    if scene.body.coating is not None and loaded(scene):
        comparison = "the same contact and stresses without film, from the coated pressure on"
        stages.append(Stage("bare comparison", True, comparison, {"steps": 1}))
    return stages


def _coupled(scene: Scene) -> bool:
    """Whether the traction is part of the gap."""
    from sam.planner.grids import pair_of

    friction = scene.friction
    if scene.counterbody is None or friction is None or not (friction.coupling and scene.coefficient):
        return False
    return scene.body.coating is not None or pair_of(scene).tangential_mismatch != 0


def _unload_steps(scene: Scene) -> int:
    return (scene.loading.unload_steps or scene.loading.steps) if loaded(scene) else 0


def _own_layers(scene: Scene) -> bool:
    return scene.grid is not None and bool(scene.grid.depths or scene.grid.layers)


def _length(scene: Scene) -> str:
    """What grids are chosen from."""
    if scene.surface is not None:
        return "cells and the sides of the patch"
    return "Hertz radius" if scene.body.coating is None else "estimated contact radius"


def _grid_reason(scene: Scene) -> str:
    given = scene.grid
    named = [name for name in ("cells", "extent") if given is not None and getattr(given, name) is not None]
    chosen = [name for name in ("cells", "extent") if name not in named]
    parts = [f"{' and '.join(named)} from [grid]"] if named else []
    if scene.surface is not None and scene.surface.kind == "file":
        return "that of surface.path" + (", resampled" if scene.surface.resample and "cells" in named else "")
    source = _length(scene)
    if scene.body.plasticity is not None and scene.surface is None:
        source += " and the plastic zone, enlarged if that goes further"
    return ", ".join(parts + ([f"{' and '.join(chosen)} chosen from the {source}"] if chosen else []))


def of_fem(scene: Scene) -> list[Stage]:
    """Stages of the axisymmetric model that its plan has, without those that are left out."""
    return _needed(models.plan(scene, models.FEM).stages)


def of_fem_3d(scene: Scene) -> list[Stage]:
    """Stages of the three-dimensional model, as `of_fem`."""
    return _needed(models.plan(scene, models.FEM_3D).stages)


def _needed(stages: Iterable[Stage]) -> list[Stage]:
    return [stage for stage in stages if stage.runs or stage.reason == NO_FORCE]
