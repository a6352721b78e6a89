# SPDX-License-Identifier: MIT
"""What the scenes of the ladder need, and why: the tables that tests/system/test_leave_out.py holds against
what ran.

PARTS say what a part of a scene needs; RUNGS of which parts a scene consists; STAGES by which work a stage of
the plan is known.
"""

from dataclasses import dataclass

from verification.runs.models import FEM, FEM_3D, SAM


@dataclass(frozen=True)
class Part:
    """What a part of a scene needs: kinds of work (see ladder.PROBES), modules and libraries beyond those of
    every scene.

    modules: with .* those of a package that no part names; may: kinds that it may take, where the program is
    free to do without.
    """

    reason: str
    work: frozenset[str] = frozenset()
    modules: frozenset[str] = frozenset()
    may: frozenset[str] = frozenset()
    libraries: frozenset[str] = frozenset()


# pyamg loads scipy.io, which registers with threadpoolctl where it is installed
CODEC = "attr attrs cattrs"  # of checkpoints
PLANE = f"scipy skfem {CODEC}"
BLOCKS = f"{PLANE} pyamg threadpoolctl"


def part(reason: str, work: str = "", modules: str = "", may: str = "", libraries: str = "") -> Part:
    """Kinds are separated by commas, modules and libraries by blanks."""
    kinds = (frozenset(filter(None, map(str.strip, each.split(",")))) for each in (work, may))
    return Part(reason, next(kinds), frozenset(modules.split()), next(kinds), frozenset(libraries.split()))


PARTS = {
    # the semi-analytical model
    "cells": part("every scene has a grid", "grid", libraries=CODEC),
    "layers": part("what may yield has layers of cells", "volume grid", libraries=CODEC),
    "force": part(
        "a force: the pressure is looked for, on a box of cells, and checked on all of them",
        "u3 under F3, contact search, surface displacement",
    ),
    "given": part(
        "the pressure is given: no search, one displacement",
        "u3 under F3, given pressure",
        may="surface displacement",
    ),
    "plane": part("smooth: the largest stress lies in y = 0", "stress in y = 0, stress under F3"),
    "travels": part("the load ends beside the origin: the plane through it is kept"),
    "zero": part("no force: a plane without stress", may="stress in y = 0"),
    "patch": part(
        "rough: heights; the largest stress lies anywhere",
        "heights, stress outside y = 0, stress under F3",
        "sam.grid.rough sam.results.rough",
        may="stress in y = 0, shear across y",
        libraries="scipy _ni_label",
    ),
    "traction": part(
        "friction: stresses of the traction, displacements along x in y = 0",
        "stress under F1, u1 under F3 in y = 0, u1 under F1 in y = 0, u1 under F3, u1 under F1",
    ),
    "coupling": part("unlike bodies: the traction moves the gap", "u3 under F1, its traction"),
    "uz": part(
        "the traction moves no gap, but it moves the body: u_z in y = 0",
        "u3 under F1",
        may="u3 under F1 in y = 0",
    ),
    "film": part(
        "a coating: layered coefficients; the bare body for comparison",
        "layered u3 under F3, layered stress under F3, bare comparison",
        "sam.grid.coated sam.elastic.coated sam.layered.*",
    ),
    "film traction": part(
        "friction on a coating",
        "layered u3 under F1, layered stress under F1, layered u1 under F3, layered u1 under F1",
    ),
    "yield": part("a yield stress: is it exceeded at the peak?", "yield stress"),
    "flow": part(
        "plastic flow: eigenstrains on a box of cells",
        "plastic step, residual stress, u3 of plastic strain, plastic box, stress beside the box",
        "sam.kernels.eigenstrain sam.kernels.layer_stress sam.plasticity.* sam.planner.yielding",
        may="u3 beside the box, shear across y",
    ),
    "sliding flow": part(
        "plastic flow with friction: the box knows tractions, the strain moves the surface along x",
        "plastic step, residual stress, u3 of plastic strain, sliding plastic box, stress beside the box, "
        "u1 beside the box, u1 of plastic strain",
        "sam.kernels.eigenstrain sam.kernels.layer_stress sam.plasticity.* sam.planner.yielding",
        may="u3 beside the box, shear across y",
    ),
    "paper": part('solver.method = "paper": its loops', modules="sam.plasticity.paper"),
    "tribofilm": part(
        "a chemical film decides on friction",
        "film law",
        "sam.tribofilm.state sam.tribofilm sam.tribofilm.law sam.tribofilm.material sam.tribofilm.return_map",
    ),
    "wear": part(
        "material is removed above a strain limit",
        "removal, remap",
        "sam.wear.*",
    ),
    # the finite-element models
    "mesh": part("axisymmetric", "plane mesh, solid, one body, stresses", libraries=PLANE),
    "counter-body": part(
        "an elastic one is meshed too", "plane mesh, solid, two bodies, stresses", libraries=PLANE
    ),
    "search": part("nodes in contact are looked for", "contact search"),
    "given pressure": part(
        "the pressure is given: nodal forces, no search", "given pressure, forces of a given pressure"
    ),
    "elements of a film": part(
        "a coating has its own material, far away the layered half-space moves; the bare body for comparison",
        "coated solid, layered far field",
        "fem_reference.common.layered_force",
    ),
    "return map": part("a yield stress: plastic history and return mapping", "return map, plastic history"),
    "plastic unloading": part("unloading a body that has yielded", "unloading by Newton"),
    "half": part("three dimensions, symmetric to y = 0", "half block, solid, stresses", libraries=BLOCKS),
    "whole": part(
        "a rough body has no symmetry",
        "whole block, solid, heights, stresses",
        "fem_reference.spatial.rough fem_reference.spatial.area",
        libraries=f"{BLOCKS} _ni_label",
    ),
    "at rest": part("no friction: symmetric systems, no tangential forces", "step without slip"),
    "slip": part(
        "friction: tangential forces in every iteration and far away", "slipping step, tangential far field"
    ),
}
NAMED = {name for each in PARTS.values() for name in each.modules}
ELASTIC, SLIDING = "cells force plane", "cells force plane traction"
YIELDING = "layers force plane yield flow"
ROUGH = "layers force patch yield"
RUNGS: dict[str, dict[str, str]] = {
    SAM: {
        "elastic sphere": ELASTIC,
        "unloaded": ELASTIC,
        "cycles": ELASTIC,
        "elastic, alternating": f"{SLIDING} coupling",
        "elastic counter-body": ELASTIC,
        "no friction after all": ELASTIC,
        "no force": "cells zero",
        "decoupled": SLIDING,
        "like bodies": f"{SLIDING} uz",
        "coupled": f"{SLIDING} coupling",
        "coated": f"{ELASTIC} film",
        "coated, sliding": f"{SLIDING} coupling film film-traction",
        "given load": "cells given plane",
        "given load, sliding": "cells given plane traction uz",
        "given load, travelling": "cells given plane traction uz travels",
        "strong": "layers force plane yield",
        "plastic": YIELDING,
        "plastic, unloaded": YIELDING,
        "plastic cycles": YIELDING,
        "plastic, the paper's loop": f"{YIELDING} paper",
        "plastic, decoupled": "layers force plane yield traction sliding-flow",
        "plastic, coupled": "layers force plane yield traction sliding-flow coupling",
        "alternating": "layers force plane yield traction sliding-flow coupling",
        "plastic, given load": "layers given plane yield flow",
        "rough elastic": "cells force patch",
        "rough elastic, sliding": "cells force patch traction",
        "rough plastic": f"{ROUGH} flow",
        "chemical film, elastic": "cells force patch traction coupling tribofilm",
        "chemical film": f"{ROUGH} traction sliding-flow coupling tribofilm",
        "wear": f"{ROUGH} flow wear",
        "wear out of reach": f"{ROUGH} flow",
        "running-in": f"{ROUGH} traction sliding-flow coupling tribofilm wear",
    },
    FEM: {
        "elastic sphere": "mesh search",
        "unloaded": "mesh search",
        "cycles": "mesh search",
        "elastic counter-body": "counter-body search",
        "no friction after all": "mesh search",
        "no force": "mesh",
        "coated": "mesh search elements-of-a-film",
        "given load": "mesh given-pressure",
        "plastic": "mesh search return-map",
        "plastic, unloaded": "mesh search return-map plastic-unloading",
        "plastic cycles": "mesh search return-map plastic-unloading",
        "plastic, given load": "mesh given-pressure return-map",
    },
    FEM_3D: {
        "elastic sphere": "half search at-rest",
        "decoupled": "half search slip",
        "elastic, alternating": "half search slip",
        "coated": "half search at-rest elements-of-a-film",
        "given load, sliding": "half given-pressure slip",
        "plastic": "half search at-rest return-map",
        "rough elastic": "whole search at-rest",
    },
}
"""Of each model: the parts of a scene, with hyphens for blanks."""
LADDER: list[tuple[str, str]] = [(model, rung) for model, rungs in RUNGS.items() for rung in rungs]
OPTIONAL = tuple(
    "sam.tribofilm sam.tribofilm.state sam.wear sam.plasticity sam.layered sam.grid.rough "
    "sam.results.rough sam.kernels.eigenstrain sam.planner.yielding "
    "sam.kernels.layer_stress sam.elastic.coated sam.grid.coated fem_reference.common.layered_force "
    "fem_reference.spatial.rough fem_reference.spatial.area".split()
)
"""Modules and packages of a model that not every scene needs; the other model, and verification, no scene
needs.
"""
TRANSFORMING = (
    "contact search",
    "surface displacement",
    "stress",
    "u1",
    "u3",
    "layered",
    "plastic",
    "sliding plastic",
)
"""Beginnings of the kinds of work that transform; the finite-element models do not."""

STAGES: dict[str, dict[str, str]] = {
    SAM: {
        "grid": "grid, volume grid",
        "volume grid": "volume grid",
        "surface heights": "heights",
        "surface coefficients": "u3 under F3, layered u3 under F3",
        "layered coefficients": "layered u3 under F3, layered stress under F3, layered u3 under F1, layered stress under F1, "
        "layered u1 under F3, layered u1 under F1",
        "coupling": "its traction",
        "contact search": "contact search",
        "given pressure": "given pressure",
        "elastic peak": "yield stress",
        "eigenstrain kernels": "residual stress, plastic box, sliding plastic box",
        "plastic loop": "plastic step",
        "chemical film": "film law",
        "worn geometry": "removal",
        "stresses at the output depths": "stress under F3, layered stress under F3",
        "stress outside the plane y = 0": "stress outside y = 0",
        "tangential kernels": "stress under F1, layered stress under F1, u1 under F1",
        "bare comparison": "bare comparison",
    },
    FEM: {
        "mesh": "plane mesh",
        "mesh of the counter-body": "two bodies",
        "film elements": "coated solid",
        "contact search": "contact search",
        "given pressure": "given pressure",
        "return mapping and plastic history": "return map",
        "stresses at the Gauss points": "stresses",
    },
    FEM_3D: {
        "mesh": "half block, whole block",
        "surface heights": "heights",
        "film elements": "coated solid",
        "contact search": "contact search",
        "given pressure": "given pressure",
        "tangential traction": "slipping step",
        "return mapping and plastic history": "return map",
        "stresses in the elements": "stresses",
    },
}
"""Of each model: kinds of work, any of which is a stage at work."""
TOLD = {
    SAM: "surface heights, volume grid, layered coefficients, eigenstrain kernels, plastic loop, chemical film, worn geometry, "
    "stress outside the plane y = 0, tangential kernels, unloading",
    FEM: "film elements, return mapping and plastic history, tangential traction, worn geometry, unloading",
    FEM_3D: "film elements, return mapping and plastic history, tangential traction, worn geometry, unloading",
}
"""Stages of each model that a user is told of in any case: run, or left out and why."""
