# SPDX-License-Identifier: MIT
"""A ladder of scenes, from an elastic sphere to full running-in, and what a solve of each does.

`climb` solves rungs, each in a fork of a process that has loaded the solvers and solved nothing, and tells
what ran: kinds of work with their calls and sizes, and transforms by the work that they belong to. Nothing in
the solvers counts for it: functions are wrapped where they are defined, once their module is loaded.
"""

import functools
import inspect
import multiprocessing
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from importlib import import_module
from importlib.machinery import ModuleSpec, PathFinder
from pkgutil import walk_packages

from builders import CHEMICAL_FILM, SPHERE, STEEL, SWIFT

from sam.scene import Scene
from verification.runs.models import MODELS

KINDS = ("rfft", "irfft", "fft", "ifft", "dct", "idct", "dst", "idst")
TRANSFORMS = [f"{kind}{axes}" for kind in KINDS for axes in ("", "2", "n")]
HARD = {"law": "perfect", "yield_stress": 50e9}
FILM = {"thickness": 0.4e-6, "young": 80e9, "poisson": 0.3}
SURFACE = {"kind": "self-affine", "ra": 0.1e-6, "cutoff_long": 16e-6, "cutoff_short": 8e-6}
SURFACE |= {"hurst": 0.8, "seed": 1}
DEPTHS = (0.0, 0.3e-6, 0.8e-6, 2e-6, 4e-6, 8e-6)


def sphere(plasticity=None, *, coating=None, counterbody=None, friction=None, solver=None, **loading) -> dict:
    """A rigid sphere on a smooth body: 33 x 33 cells elastic, 17 x 17 plastic; the fewest elements."""
    plastic = plasticity is not None
    volume = {"cells": (17, 17), "extent": (12e-6, 12e-6), "layers": 8, "depth": 7e-6}
    body = STEEL | {"plasticity": plasticity, "coating": coating}
    return {
        "body": {name: value for name, value in body.items() if value is not None},
        "counterbody": SPHERE | (counterbody or {}),
        "loading": {"force": 0.05, "steps": 2} | loading,
        "grid": volume if plastic else {"cells": (33, 33)},
        "fem": {"cells_per_radius": 2, "box": 3.0},
        "solver": {"tolerance": 1e-4 if plastic else 1e-6} | (solver or {}),
    } | ({"friction": friction} if friction else {})


def given(plasticity=None, friction=None, **loading) -> dict:
    """A pressure that the scene gives, in place of force and sphere."""
    out = sphere(plasticity, friction=friction)
    del out["counterbody"]
    return out | {"loading": {"prescribed": "hertz", "p0": 3.5e9, "radius": 2.5e-6, "steps": 1} | loading}


def misfit(plasticity=None, **loading) -> dict:
    """A sphere that grows inside the body, which nothing touches."""
    out = sphere(plasticity)
    del out["counterbody"], out["grid"]
    given = {"prescribed": "misfit-sphere", "depth": 6e-6, "radius": 3e-6, "misfit": 0.02, "steps": 2}
    return out | {"loading": given | loading}


def rough(plasticity=None, friction=None, wear=None, **loading) -> dict:
    """A plane on a rough patch of 24 x 24 cells."""
    sections = {"friction": friction, "wear": wear}
    return {
        "body": STEEL | ({"plasticity": plasticity} if plasticity else {}),
        "counterbody": {"shape": "flat"},
        "surface": SURFACE,
        "loading": {"force": 0.02, "steps": 2} | loading,
        "grid": {"cells": (12, 12), "extent": (16e-6, 16e-6), "depths": DEPTHS, "border": "relief"},
        "fem": {"box": 3.0},
        "solver": {"tolerance": 1e-4},
    } | {name: value for name, value in sections.items() if value}


def opposite(plasticity=None, renew=False, **loading) -> dict:
    """A rough counter-body on a smooth body."""
    found = rough(plasticity, **loading)
    return found | {"counterbody": {"shape": "flat", "surface": found.pop("surface") | {"renew": renew}}}


DECOUPLED = {"coefficient": 0.2, "coupling": False}
COUPLED = {"coefficient": 0.2}
RUNNING_IN = {"unload": True, "cycles": 2}
EDGE = {"shape": "rounded-punch", "flat_radius": 1e-6}
MOVED = {"force": None, "approach": 60e-9}
PATH = {"start": (-1e-6, 0.0), "end": (1e-6, 0.0), "steps": 2}
LONG_PATH = {"start": (-2e-6, 0.0), "end": (2e-6, 0.0), "steps": 2}
ON_PATCH = {"start": (0.0, 0.0), "end": (16e-6 / 12, 0.0), "steps": 1}
SCENES = {
    "elastic sphere": sphere(),
    "unloaded": sphere(unload=True),
    "cycles": sphere(unload=True, cycles=3),
    "decoupled": sphere(friction=DECOUPLED),
    "coupled": sphere(friction=COUPLED),
    "like bodies": sphere(friction=COUPLED, counterbody=STEEL),
    "elastic counter-body": sphere(counterbody=STEEL),
    "rounded edge": sphere(counterbody=EDGE),
    "no friction after all": sphere(friction={"coefficient": 0.0}),
    "no force": sphere(force=0.0),
    "given load, travelling": given(friction=COUPLED, path=LONG_PATH),
    "coated": sphere(coating=FILM),
    "coated, sliding": sphere(coating=FILM, friction=COUPLED),
    "given load": given(),
    "given load, sliding": given(friction=COUPLED),
    "strong": sphere(HARD, unload=True),
    "plastic": sphere(SWIFT),
    "plastic, layered": sphere(SWIFT | {"layer_thickness": 1e-6, "layer": SWIFT | {"alpha": 1e3}}),
    "back-stresses": sphere(SWIFT | {"kinematic": {"modulus": (11e9,)}}, unload=True, cycles=4, steps=1),
    "plastic, unloaded": sphere(SWIFT, unload=True),
    "plastic, decoupled": sphere(SWIFT, friction=DECOUPLED),
    "plastic, coupled": sphere(SWIFT, friction=COUPLED),
    "plastic, the paper's loop": sphere(SWIFT, solver={"method": "paper", "tolerance": 1e-4}),
    "elastic, alternating": sphere(friction=COUPLED | {"direction": "alternating"}, unload=True, cycles=2),
    "plastic cycles": sphere(SWIFT, unload=True, cycles=2),
    "alternating": sphere(SWIFT, friction=COUPLED | {"direction": "alternating"}, unload=True, cycles=2),
    "plastic, given load": given(SWIFT),
    "moving": sphere(path=PATH, steps=1),
    "moving, plastic": sphere(SWIFT, path=PATH, unload=True),
    "moving, rough": opposite(path=ON_PATCH, steps=1),
    "moving, film and wear": rough(SWIFT, friction=CHEMICAL_FILM, wear={"strain_limit": 0.002}, **RUNNING_IN)
    | {"counterbody": opposite()["counterbody"], "loading": {"force": 0.02, "path": ON_PATCH, **RUNNING_IN}},
    "misfit": misfit(),
    "misfit, plastic": misfit(SWIFT, unload=True),
    "rough elastic": rough(),
    "rough elastic, sliding": rough(friction=DECOUPLED),
    "rough plastic": rough(SWIFT),
    "rough counter-body": opposite(),
    "rough counter-body, renewed": opposite(SWIFT, renew=True, **RUNNING_IN),
    "chemical film, elastic": rough(friction=CHEMICAL_FILM, **RUNNING_IN),
    "chemical film": rough(SWIFT, friction=CHEMICAL_FILM, **RUNNING_IN),
    "wear": rough(SWIFT, wear={"strain_limit": 0.002}, **RUNNING_IN),
    "wear out of reach": rough(SWIFT, wear={"strain_limit": float("inf")}, **RUNNING_IN),
    "moved": sphere(**MOVED),
    "moved, coated": sphere(coating=FILM, **MOVED),
    "moved, plastic": sphere(SWIFT, unload=True, **MOVED),
    "moved, rough": rough(**MOVED),
    "running-in": rough(SWIFT, friction=CHEMICAL_FILM, wear={"strain_limit": 0.002}, **RUNNING_IN),
}


def scene(name: str) -> Scene:
    """The scene of a rung."""
    return Scene(**SCENES[name], title=name)


def _load(a: dict) -> str:
    return f"{a['component']} under F{a['load']}" if "component" in a else f"under F{a['load']}"


def _components(a: dict) -> str:
    """Of a stress; what is odd in y is zero in y = 0 if all loads are even in it."""
    return f"under F{a['load']}" + (", shear across y" if {"23", "12"} & set(a["names"]) else "")


def _search(a: dict) -> str:
    """Of a box; whether its grid, or itself, knows a traction that moves the gap."""
    traction = a["operators"].coupling if "operators" in a else a["self"].tangential
    return "contact search" if traction is None else "contact search, its traction"


Namer = Callable[[dict], str] | str
PROBES: dict[str, dict[str, Namer]] = {
    "sam": {
        "patches.displacement_coefficients": lambda a: f"u{_load(a)}",
        "patches.stress_coefficients": lambda a: f"stress {_components(a)}",
        "residual_stress_coefficients": "residual stress",
        "surface_displacement_coefficients": lambda a: f"u{a['component']} of plastic strain",
        "LayeredPatches.__init__": "layered body",
        "LayeredPatches.displacement": lambda a: f"layered u{_load(a)}",
        "LayeredPatches.stress": lambda a: f"layered stress {_components(a)}",
        "CellGrid.__init__": lambda a: "grid" if a["faces"] is None else "volume grid",
        "RoundedPunch.gap": "gap of a rounded edge",
        "RoughPatch.heights": "heights",
        "RoughPatch.counter_heights": "counter heights",
        "GivenHertz.pressure": "given pressure",
        "MisfitSphere.moved_surface": "displacement by a misfit strain",
        "MisfitSphere.stress": "stress of a misfit strain",
        "Track.moved": "motion of the counter-body",
        "BoxContact.__init__": _search,
        "BoxContact.solve": _search,
        "BoxContact.displacement": "surface displacement",
        "SurfaceOperators.displacement": "surface displacement",
        # two rows may touch y = 0
        "stresses": lambda a: "stress outside y = 0" if a["observed"].ny > 2 else "stress in y = 0",
        "moved_rows": lambda a: "u{} under F{} in y = 0".format(*a["moved_by"]),
        "bare_body": "bare comparison",
        "problem.yields": "yield stress",
        "BoxOperator.__init__": "plastic box",
        "mean_stress_of_load": lambda a: "sliding plastic box" if a["load"] == 1 else "plastic box",
        "Problem.step": "plastic step",
        "PaperProblem.step": "plastic step, loops of the paper",
        "KinematicFlow.returned": "return map with back-stresses",
        "Problem.residual": "plastic step",
        "measure.residual_stress": "stress beside the box",
        "measure._moved_grid": "u3 beside the box",
        "surface_displacement": lambda a: f"u{a['component']} beside the box",
        "FilmLaw.step": "film law",
        "WearLaw.removed": "removal",
        "remapped": "remap",
        "verdict.verdict_on": "verdict",
    },
    "fem_reference": {
        "tensor_mesh": "plane mesh",
        "rounded_lines": "lines of a rounded edge",
        "hexahedra.block": lambda a: "half block" if a["lines"].half else "whole block",
        "Solid.__init__": lambda a: "coated solid" if a["coating"] else "solid",
        "ContactProblem.__init__": lambda a: "two bodies" if len(a["solids"]) > 1 else "one body",
        "J2.update": "return map",
        "KinematicJ2.returned": "return map with back-stresses",
        "History.virgin": "plastic history",
        "contact.equilibrium": "contact search",
        "without_contact": lambda a: "given pressure" if a["load"].force else "unloading by Newton",
        "far_field.cerruti": "tangential far field",
        "layered_force.normal": "layered far field",
        "layered_force.tangential": "layered tangential far field",
        "model.hertz_forces": "forces of a given pressure",
        "MisfitSphere.strain": "misfit strain",
        "surface.hertz_forces": "forces of a given pressure",
        "recovery.stresses": "stresses",
        "SlidingProblem.newton_step": lambda a: "slipping step" if a["load"].ratio else "step without slip",
        "track.Track.driven": "motion of the counter-body",
        "rough.heights_of": "heights",
        "rough.counter_heights_of": "counter heights",
    },
}
"""Of each package: ends of full names of functions, and what kinds of work they are, the first one
that of their transforms.
"""


class Recorder:
    """Wraps what PROBES name while it records, and the transforms of scipy and numpy.

    work: kind -> [calls, numbers that it made], in the order in which they began; transforms: kind
    of work, or "" -> [calls, values]; wrapped: the ends of names that were found.
    """

    def __init__(self):
        self.work: dict[str, list[int]] = {}
        self.transforms: dict[str, list[int]] = {}
        self.stack: list[str] = [""]
        self.wrapped: set[str] = set()

    def counted(self, function: Callable, begin: Callable, end: Callable = lambda: None) -> Callable:
        """The function, whose calls and values are added to the counts that `begin(arguments)` returns."""

        @functools.wraps(function)
        def recorded(*args, **keys):
            counts = begin(args, keys)
            try:
                out = function(*args, **keys)
            finally:
                end()
            for count in counts:
                count[0] += 1
                count[1] += int(getattr(out, "size", 0))
            return out

        return recorded

    def probed(self, function: Callable, namer: Namer) -> Callable:
        """The function, which also records what it does and that the transforms inside are its own."""
        signature = inspect.signature(function)

        def begin(args, keys) -> list[list[int]]:
            bound = signature.bind(*args, **keys)
            bound.apply_defaults()
            kinds = (namer if isinstance(namer, str) else namer(bound.arguments)).split(", ")
            self.stack.append(kinds[0])
            return [self.work.setdefault(kind, [0, 0]) for kind in kinds]

        return self.counted(function, begin, self.stack.pop)

    def install(self) -> None:
        """Wrap the transforms, and what PROBES name as soon as it is defined."""

        def begin(args, keys) -> list[list[int]]:
            return [self.transforms.setdefault(self.stack[-1], [0, 0])]

        for package in map(import_module, ("scipy.fft", "numpy.fft")):
            for name in TRANSFORMS:
                if hasattr(package, name):
                    setattr(package, name, self.counted(getattr(package, name), begin))
        sys.meta_path.insert(0, self)

    def find_spec(self, name: str, path=None, target=None) -> ModuleSpec | None:
        """As usual, but that functions with probes are wrapped once their module is run."""
        probes = PROBES.get(name.split(".")[0])
        spec = PathFinder.find_spec(name, path, target) if probes else None
        if spec is None or spec.loader is None:
            return spec
        run = spec.loader.exec_module

        def exec_module(module) -> None:
            run(module)
            for holder, attribute, full in defined(module):
                for end in (end for end in probes if full.endswith(f".{end}")):
                    self.wrapped.add(end)
                    found = inspect.getattr_static(holder, attribute)
                    wrapped = self.probed(getattr(found, "__func__", found), probes[end])
                    of_class = isinstance(found, classmethod)
                    setattr(holder, attribute, classmethod(wrapped) if of_class else wrapped)

        spec.loader.exec_module = exec_module
        return spec


def defined(module) -> list[tuple[object, str, str]]:
    """Functions and methods that a module defines: where they are kept, by which name, and their full one."""
    found = []
    for name, each in vars(module).items():
        if getattr(each, "__module__", None) != module.__name__:
            continue
        if inspect.isfunction(each):
            found.append((module, name, f"{module.__name__}.{name}"))
        elif inspect.isclass(each):
            found += [(each, own, f"{module.__name__}.{name}.{own}") for own in vars(each)]
    return found


RECORDER = Recorder()


def ran(model: str, rung: str) -> dict:
    """Solve a rung in this process: what it did, and parts of the result."""
    result = import_module(MODELS[model]).solve(scene(rung))
    history = result.tables["history"]
    return {
        "work": RECORDER.work,
        "transforms": RECORDER.transforms,
        "wrapped": RECORDER.wrapped,
        "left_out": [(entry.stage, entry.reason) for entry in result.left_out],
        "ffts": result.cost["ffts"],
        "depths": result.discretisation.get("depths"),
        "states": sorted(set(result.tables["line"]["state"])),
        "notes": [str(note) for note in history["note"]],
        "cycles": [int(cycle) for cycle in history["cycle"]],
    }


def climb(rungs: Sequence[tuple[str, str]]) -> dict[tuple[str, str], dict]:
    """What ran in each (model, rung), two at once."""
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as apart:
        return dict(zip(rungs, apart.submit(_climbed, rungs).result(), strict=True))


def _climbed(rungs: Sequence[tuple[str, str]]) -> list[dict]:
    """In a process of its own, whose solvers are wrapped as they are loaded."""
    RECORDER.install()
    for package in map(import_module, PROBES):
        for module in walk_packages(package.__path__, f"{package.__name__}."):
            import_module(module.name)
    with multiprocessing.get_context("fork").Pool(2, maxtasksperchild=1) as pool:
        return pool.starmap(ran, rungs, chunksize=1)
