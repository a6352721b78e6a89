# SPDX-License-Identifier: MIT
"""What every model shares: the scene, its file format and the result record. No kernel, no solver, no
physics.
"""

from sam.scene.body import Body, Coating, Plasticity
from sam.scene.compare import Compare
from sam.scene.counterbody import CounterBody
from sam.scene.errors import Problem, SceneError
from sam.scene.friction import Friction
from sam.scene.grid import Grid
from sam.scene.load import load_scene, parse_scene, read_scene
from sam.scene.loading import Loading, Path
from sam.scene.numerics import Fem, Solver
from sam.scene.result import FieldMesh, LeftOut, Result, Stage, Status
from sam.scene.schema import Scene, resolved, solved_part
from sam.scene.surface import FrictionMap, HeightMap, Surface
from sam.scene.wear import Wear

__all__ = [
    "Body",
    "Coating",
    "Compare",
    "CounterBody",
    "Fem",
    "FieldMesh",
    "Friction",
    "FrictionMap",
    "Grid",
    "HeightMap",
    "LeftOut",
    "Loading",
    "Path",
    "Plasticity",
    "Problem",
    "Result",
    "Scene",
    "SceneError",
    "Solver",
    "Stage",
    "Status",
    "Surface",
    "Wear",
    "load_scene",
    "parse_scene",
    "read_scene",
    "resolved",
    "solved_part",
]
