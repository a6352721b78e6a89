# SPDX-License-Identifier: MIT
"""What the stages of a plan need: the tables by which tests/system/test_leave_out.py compares what ran with
the plan of a scene.

NEEDS says it of each stage, and of stages together; which of them a scene has is decided by its plan alone.
"""

from dataclasses import dataclass

from ladder_scenes import SCENES

from verification.runs.models import FEM, FEM_3D, SAM


@dataclass(frozen=True)
class Part:
    """What a stage needs: kinds of work (see ladder.PROBES), modules and libraries beyond those of every
    scene.

    first: the kind that a stage begins with; modules: with .* those of a package that no part names; may:
    kinds that it may take, where the program is free to do without.
    """

    first: str = ""
    work: frozenset[str] = frozenset()
    modules: frozenset[str] = frozenset()
    may: frozenset[str] = frozenset()
    libraries: frozenset[str] = frozenset()


# pyamg loads scipy.io, which registers with threadpoolctl where it is installed
CODEC = "attr attrs cattrs"  # of checkpoints
PLANE = f"scipy skfem {CODEC}"
BLOCKS = f"{PLANE} pyamg threadpoolctl"


def names(text: str) -> frozenset[str]:
    return frozenset(filter(None, map(str.strip, text.split(","))))


def part(work: str = "", modules: str = "", may: str = "", libraries: str = "") -> Part:
    """Kinds are separated by commas, modules and libraries by blanks."""
    return Part(
        work.split(",")[0], names(work), frozenset(modules.split()), names(may), frozenset(libraries.split())
    )


IN_BOX = "residual stress, u3 of plastic strain, stress beside the box"
OUTSIDE = "stress outside the plane y = 0"
RETURN_MAP = "return mapping and plastic history"
NEEDS: dict[str, dict[str, Part]] = {
    SAM: {
        "grid, not volume grid": part("grid"),
        "grid": part(libraries=CODEC),
        "grid, rounded edge": part("gap of a rounded edge"),
        "volume grid": part("volume grid"),
        "surface heights": part("heights", libraries="scipy _ni_label"),
        "counter-surface heights": part("counter heights", libraries="scipy _ni_label"),
        "surface coefficients": part("u3 under F3", may="layered u3 under F3"),
        "layered coefficients": part("layered u3 under F3, layered stress under F3, layered body"),
        "layered coefficients, tangential kernels": part(
            "layered u3 under F1, layered stress under F1, layered u1 under F3, layered u1 under F1"
        ),
        "coupling": part("u3 under F1, its traction"),
        "contact search": part("contact search, surface displacement"),
        "given pressure": part("given pressure", may="surface displacement"),
        "moving counter-body": part("motion of the counter-body"),
        "misfit strain": part("displacement by a misfit strain"),
        "misfit strain, stresses at the output depths": part("stress of a misfit strain"),
        "elastic peak": part("yield stress"),
        "eigenstrain kernels": part(IN_BOX, may="u3 beside the box, shear across y"),
        "eigenstrain kernels, not tangential kernels": part("plastic box"),
        "eigenstrain kernels, tangential kernels": part(
            "sliding plastic box, u1 beside the box, u1 of plastic strain"
        ),
        "plastic loop": part("plastic step"),
        "plastic loop, loops of the paper": part("loops of the paper"),
        "back-stresses": part("return map with back-stresses"),
        "verdict on repeated loading": part("verdict"),
        "chemical film": part(
            "film law",
        ),
        "worn geometry": part("removal, remap"),
        "stresses at the output depths, not misfit strain": part(
            "stress under F3", may="layered stress under F3"
        ),
        f"stresses at the output depths, not {OUTSIDE}": part("stress in y = 0"),
        "not stresses at the output depths": part(may="stress in y = 0"),
        OUTSIDE: part("stress outside y = 0", may="stress in y = 0, shear across y"),
        "tangential kernels": part(
            "stress under F1, u1 under F3 in y = 0, u1 under F1 in y = 0, u1 under F3, u1 under F1",
            may="layered stress under F1",
        ),
        # the traction moves no gap, but it moves the body: u_z in y = 0
        "not coupling, not coupling = false, tangential kernels": part(
            "u3 under F1", may="u3 under F1 in y = 0"
        ),
        "bare comparison": part("bare comparison"),
    },
    FEM: {
        "mesh": part("plane mesh", libraries=PLANE),
        "mesh, not mesh of the counter-body": part("one body"),
        "mesh of the counter-body": part("two bodies"),
        "mesh, rounded edge": part("lines of a rounded edge"),
        "film elements": part("coated solid, layered far field", "fem_reference.common.layered_force"),
        "not film elements": part("solid"),
        "bare body": part("solid"),
        "contact search": part("contact search"),
        "given pressure": part("given pressure, forces of a given pressure"),
        "misfit strain": part("misfit strain", may="given pressure"),
        RETURN_MAP: part("return map, plastic history"),
        "back-stresses": part("return map with back-stresses"),
        "verdict on repeated loading": part("verdict"),
        f"{RETURN_MAP}, unloading": part("unloading by Newton"),
        "stresses at the Gauss points": part("stresses"),
    },
    FEM_3D: {
        "mesh": part(libraries=BLOCKS),
        "mesh, not surface heights, not counter-surface heights": part("half block"),
        "mesh, surface heights": part("whole block"),
        "mesh, counter-surface heights": part("whole block"),
        "surface heights": part(
            "heights",
            "fem_reference.spatial.rough fem_reference.spatial.area",
            libraries="_ni_label",
        ),
        "counter-surface heights": part(
            "counter heights",
            "fem_reference.spatial.rough fem_reference.spatial.area",
            libraries="_ni_label",
        ),
        "film elements": part("coated solid, layered far field", "fem_reference.common.layered_force"),
        "not film elements": part("solid"),
        "bare body": part("solid"),
        "contact search": part("contact search"),
        "given pressure": part("given pressure, forces of a given pressure"),
        "tangential traction": part("slipping step, tangential far field"),
        "not tangential traction": part("step without slip"),
        "moving counter-body": part("motion of the counter-body", "fem_reference.spatial.track"),
        RETURN_MAP: part("return map, plastic history"),
        f"{RETURN_MAP}, unloading": part("unloading by Newton"),
        "stresses in the elements": part("stresses"),
    },
}
"""Of each model: stages of a plan, those that it must not have after "not", and what they need. What a stage
alone needs, or leads, is what it begins with.
"""
NAMED = {name for needs in NEEDS.values() for each in needs.values() for name in each.modules}
OF_FEM = """elastic sphere; unloaded; cycles; elastic counter-body; rounded edge; no friction after all; no force;
coated; given load; plastic; back-stresses; plastic, unloaded; plastic cycles; plastic, given load; moved;
moved, coated; moved, plastic; misfit, plastic"""
OF_FEM_3D = """elastic sphere; decoupled; elastic, alternating; coated; given load, sliding; plastic;
rough elastic; rough counter-body; moved; moved, rough; moving; moving, plastic; moving, rough"""
RUNGS: dict[str, list[str]] = {
    SAM: list(SCENES),
    FEM: OF_FEM.replace("\n", " ").split("; "),
    FEM_3D: OF_FEM_3D.replace("\n", " ").split("; "),
}
"""The scenes that each model solves."""
LADDER: list[tuple[str, str]] = [(model, rung) for model, rungs in RUNGS.items() for rung in rungs]
OPTIONAL = tuple(
    "fem_reference.common.layered_force fem_reference.spatial.rough fem_reference.spatial.area "
    "fem_reference.spatial.track".split()
)
"""Modules of the finite-element models that not every scene needs; the other model, and verification, no
scene needs. The semi-analytical one loads all that it has, in 50 ms.
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

TOLD = {
    SAM: "surface heights, volume grid, layered coefficients, eigenstrain kernels, plastic loop, chemical film, worn geometry, "
    "stress outside the plane y = 0, tangential kernels, unloading",
    FEM: "film elements, return mapping and plastic history, tangential traction, worn geometry, unloading",
    FEM_3D: "film elements, return mapping and plastic history, tangential traction, worn geometry, unloading",
}
"""Stages of each model that a user is told of in any case: run, or left out and why."""
