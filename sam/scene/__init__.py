# SPDX-License-Identifier: MIT
"""What every model shares: the scene, its file format and the result record. No kernel, no solver, no
physics.

Checkpoints and their codec are loaded when one of their names is asked for, so that to read a scene does not
load cattrs.
"""

from importlib import import_module
from typing import Any

from sam.scene.body import LAWS, SHAPES, Body, Coating, CounterBody, Friction, Hardening, Plasticity
from sam.scene.inputs import InputError, Inputs, below, open_file, read_apart, read_limited
from sam.scene.numerics import Compare, Fem, Grid, Loading, Pass, Path, Solver, Strokes, Wear
from sam.scene.remedies import either, finer_cells, finer_mesh
from sam.scene.result import (
    COLUMNS,
    COST,
    COUNTER_HEIGHT,
    EXTRA_COLUMNS,
    NO_FORCE,
    PATH_QUANTITIES,
    PEAK,
    PLASTIC_STRAINS,
    QUANTITIES,
    UNLOADED,
    Attempt,
    FieldMesh,
    GridFields,
    LeftOut,
    Progress,
    Result,
    Stage,
    Status,
    Table,
)
from sam.scene.schema import (
    Scene,
    check_kind,
    load_scene,
    parse_scene,
    parse_toml,
    read_scene,
    resolved,
    scene_of,
    solved_part,
)
from sam.scene.section import (
    Conflict,
    Problem,
    SceneError,
    Section,
    printable,
    problems,
    spelling,
    tables_of,
    unit_of_key,
    with_units,
)
from sam.scene.surface import CounterSurface, FrictionMap, HeightMap, Surface
from sam.scene.units import Number, in_unit, number_and_unit
from sam.scene.yield_curve import YieldCurve, plastic_work, step_energies, stored_energy

__all__ = [
    "COLUMNS",
    "COST",
    "COUNTER_HEIGHT",
    "EXTRA_COLUMNS",
    "LAWS",
    "NO_FORCE",
    "PATH_QUANTITIES",
    "PEAK",
    "PLASTIC_STRAINS",
    "QUANTITIES",
    "SHAPES",
    "UNLOADED",
    "Attempt",
    "Body",
    "Checkpoint",
    "Coating",
    "CodecError",
    "Compare",
    "Conflict",
    "CounterBody",
    "CounterSurface",
    "Fem",
    "FieldMesh",
    "Friction",
    "FrictionMap",
    "Grid",
    "GridFields",
    "Hardening",
    "HeightMap",
    "InputError",
    "Inputs",
    "Keep",
    "LeftOut",
    "Loading",
    "Number",
    "Pass",
    "Path",
    "Plasticity",
    "Problem",
    "Progress",
    "Result",
    "Scene",
    "SceneError",
    "Section",
    "Solver",
    "Stage",
    "Status",
    "Strokes",
    "Surface",
    "Table",
    "Wear",
    "YieldCurve",
    "below",
    "check_kind",
    "decode",
    "either",
    "encode",
    "finer_cells",
    "finer_mesh",
    "in_unit",
    "load_scene",
    "number_and_unit",
    "open_file",
    "parse_scene",
    "parse_toml",
    "plastic_work",
    "printable",
    "problems",
    "read_apart",
    "read_limited",
    "read_scene",
    "resolved",
    "scene_of",
    "solved_part",
    "spelling",
    "step_energies",
    "stored_energy",
    "tables_of",
    "unit_of_key",
    "with_units",
]


def __getattr__(name: str) -> Any:
    if name in ("Checkpoint", "CodecError", "Keep", "decode", "encode"):
        return getattr(import_module("sam.scene.checkpoint"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
