# SPDX-License-Identifier: MIT
"""A ladder of scenes, from an elastic sphere to full running-in, and what a solve of each does, counted from
outside.

As a program (`python tests/ladder.py MODEL:RUNG ...`) it solves rungs, each in a process of its own with
empty caches, and prints as JSON what ran: kinds of work with their calls and sizes, transforms by the work
that they belong to, and the modules that were loaded. Nothing in the solvers counts for it: functions are
wrapped where they are defined, once their module is loaded.
"""

import functools
import inspect
import json
import os
import sys
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from importlib.machinery import ModuleSpec, PathFinder
from pathlib import Path

from ladder_scenes import SCENES

ROOT = Path(__file__).resolve().parent.parent
OURS = ("samfem", "sam", "fem_reference", "verification")
TRANSFORMS = [
    f"{kind}{axes}"
    for kind in ("rfft", "irfft", "fft", "ifft", "dct", "idct", "dst", "idst")
    for axes in ("", "2", "n")
]


def scene(name: str):
    """The scene of a rung."""
    from sam.scene import Scene

    return Scene(**SCENES[name], title=name)


# what is recorded


@dataclass
class Ran:
    """What a solve did, all in the order in which it began.

    work: kind -> [calls, numbers that it made]; transforms: kind of work, or "" -> [calls, values]; modules:
    of this program; others: the rest, by their first name; summary: parts of the result.
    """

    work: dict[str, list[int]] = field(default_factory=dict)
    transforms: dict[str, list[int]] = field(default_factory=dict)
    modules: list[str] = field(default_factory=list)
    others: list[str] = field(default_factory=list)
    summary: dict = field(default_factory=dict)


def _load(a: dict) -> str:
    return f"{a['component']} under F{a['load']}" if "component" in a else f"under F{a['load']}"


def _components(a: dict) -> str:
    """Of a stress; what is odd in y is zero in y = 0 if all loads are even in it."""
    return f"under F{a['load']}" + (", shear across y" if {"23", "12"} & set(a["names"]) else "")


def _more_rows(a: dict) -> str:
    """A window beyond the two rows that may touch y = 0."""
    return "stress outside y = 0" if a["observed"].ny > 2 else "stress in y = 0"


def _slips(a: dict) -> str:
    return "slipping step" if a["load"].ratio else "step without slip"


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
        "stresses": _more_rows,
        "moved_rows": lambda a: "u{} under F{} in y = 0".format(*a["moved_by"]),
        "bare_body": "bare comparison",
        "stress.yields": "yield stress",
        "BoxOperator.__init__": lambda a: "sliding plastic box" if a["sliding"] else "plastic box",
        "Problem.step": "plastic step",
        "PaperProblem.step": "plastic step, loops of the paper",
        "KinematicFlow.returned": "return map with back-stresses",
        "Problem.residual": "plastic step",
        "measure.residual_stress": "stress beside the box",
        "surface_displacement": lambda a: f"u{a['component']} beside the box",
        "FilmLaw.step": "film law",
        "WearLaw.removed": "removal",
        "remapped": "remap",
        "verdict.verdict_on": "verdict",
    },
    "fem_reference": {
        "half_plane": "plane mesh",
        "rounded_lines": "lines of a rounded edge",
        "hexahedra.block": lambda a: "half block" if a["lines"].half else "whole block",
        "Solid.__init__": lambda a: "coated solid" if a["coating"] else "solid",
        "ContactProblem.__init__": lambda a: "two bodies" if len(a["blocks"]) > 1 else "one body",
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
        "SlidingProblem.newton_step": _slips,
        "track.Track.driven": "motion of the counter-body",
        "rough.heights_of": "heights",
        "rough.counter_heights_of": "counter heights",
    },
}
"""Of each package: ends of full names of functions, and what kinds of work they are, the first one that of
their transforms.
"""


# recording


class Recorder:
    """Wraps what PROBES name while it records, and the transforms of scipy and numpy.

    spoilt: name in SPOILERS of what is made wrong, for a test of the tests.
    """

    def __init__(self, spoilt: str = ""):
        self.ran, self.stack = Ran(), []
        self.spoiled, self.spoil = SPOILERS[spoilt] if spoilt else ("", None)

    def probed(self, function: Callable, namer: Namer) -> Callable:
        """The function, which also records what it does and that the transforms inside are its own."""
        signature = inspect.signature(function)

        @functools.wraps(function)
        def recorded(*args, **keys):
            bound = signature.bind(*args, **keys)
            bound.apply_defaults()
            kinds = (namer if isinstance(namer, str) else namer(bound.arguments)).split(", ")
            counts = [self.ran.work.setdefault(kind, [0, 0]) for kind in kinds]
            self.stack.append(kinds[0])
            try:
                out = function(*args, **keys)
            finally:
                self.stack.pop()
            for count in counts:
                count[0] += 1
                count[1] += int(getattr(out, "size", 0))
            return out

        return recorded

    def counted(self, transform: Callable) -> Callable:
        """The transform, which also counts itself and the values that it makes for the work that it is part
        of.
        """

        @functools.wraps(transform)
        def recorded(*args, **keys):
            out = transform(*args, **keys)
            count = self.ran.transforms.setdefault(self.stack[-1] if self.stack else "", [0, 0])
            count[0] += 1
            count[1] += int(out.size)
            return out

        return recorded

    def install(self) -> None:
        """Wrap the transforms, and what PROBES name as soon as it is defined."""
        import numpy
        import scipy.fft

        for package in (scipy.fft, numpy.fft):
            for name in TRANSFORMS:
                if hasattr(package, name):
                    setattr(package, name, self.counted(getattr(package, name)))
        sys.meta_path.insert(0, self)

    def find_spec(self, name: str, path=None, target=None) -> ModuleSpec | None:
        """For modules of this program: as usual, but that functions with probes are wrapped once they are
        defined.
        """
        probes = PROBES.get(name.split(".")[0])
        if probes is None:
            return None
        spec = PathFinder.find_spec(name, path, target)
        if spec is None or spec.loader is None:
            return spec
        run = spec.loader.exec_module

        def exec_module(module) -> None:
            run(module)
            if name == self.spoiled:
                self.spoil(module)
            for holder, attribute, namer in places(module, probes):
                found = inspect.getattr_static(holder, attribute)
                if isinstance(found, classmethod):
                    setattr(holder, attribute, classmethod(self.probed(found.__func__, namer)))
                else:
                    setattr(holder, attribute, self.probed(found, namer))

        spec.loader.exec_module = exec_module
        return spec


def places(module, probes: dict[str, Namer]) -> list[tuple[object, str, Namer]]:
    """Functions and methods that a module defines and that have a probe: where they are kept, by which name,
    and their kind.
    """
    own = {
        name: each
        for name, each in vars(module).items()
        if getattr(each, "__module__", None) == module.__name__
    }
    found = [
        (module, name, f"{module.__name__}.{name}") for name, each in own.items() if inspect.isfunction(each)
    ]
    for name, each in own.items():
        if inspect.isclass(each):
            found += [(each, method, f"{module.__name__}.{name}.{method}") for method in vars(each)]
    return [
        (holder, name, probes[end])
        for holder, name, full in found
        for end in probes
        if full.endswith(f".{end}")
    ]


# what a solver must not do, done to it


def _with_traction(module) -> None:
    """Stresses of a traction that the scene has not."""
    stresses = module.stresses

    def spoilt(tractions, *args, **keys):
        return stresses({1: 0.0 * tractions[3] + 1.0, **tractions}, *args, **keys)

    module.stresses = functools.wraps(stresses)(spoilt)


def _with_transform(module) -> None:
    """A transform that belongs to no work."""
    import numpy
    import scipy.fft

    tables = module.state_tables
    module.state_tables = lambda *args: (scipy.fft.rfft2(numpy.ones((4, 4))), tables(*args))[1]


def _with_pictures(_module) -> None:
    import matplotlib  # noqa: F401


def _with_history(module) -> None:
    """A plastic history of an elastic body."""
    from fem_reference.common.plasticity import J2, CurveInUnits
    from sam.scene.yield_curve import Linear

    module.material = lambda bodies, units, solid: J2(
        bodies.elastic[0],
        CurveInUnits(Linear(float("inf")), 1.0, 1.0),
        1.0 + 0.0 * solid.weights,
        shears=len(solid.stiffness_tensor) - 3,
    )


SPOILERS: dict[str, tuple[str, Callable]] = {
    "traction": ("sam.contact.stress", _with_traction),
    "transform": ("sam.results.tables", _with_transform),
    "pictures": ("sam.results.tables", _with_pictures),
    "history": ("fem_reference.axisymmetric.model", _with_history),
}
"""What is spoilt, in which module, and how, once the module is loaded."""


# one process for each rung


def solve(rung: str, model: str, recorder: Recorder) -> Ran:
    """Solve a rung with this process's recorder."""
    from importlib import import_module

    from verification.runs.models import MODELS

    known = set(sys.modules)
    package = import_module(MODELS[model])
    result = package.solve(scene(rung))
    ran = recorder.ran
    new = set(sys.modules) - known
    ran.modules = sorted(name for name in new if name.split(".")[0] in OURS)
    ran.others = sorted({name.split(".")[0] for name in new} - {*OURS, *sys.stdlib_module_names})
    ran.summary = {
        "status": result.status.value,
        "left_out": [[entry.stage, entry.reason] for entry in result.left_out],
        "cost": {name: value for name, value in result.cost.items() if value is not None},
        "discretisation": dict(result.discretisation),
        "states": sorted(set(result.tables["line"]["state"])),
        "notes": [str(note) for note in result.tables["history"]["note"]],
        "cycles": [int(cycle) for cycle in result.tables["history"]["cycle"]],
    }
    return ran


def in_child(rung: str, model: str, spoilt: str = "") -> dict:
    """What a solve does in a copy of this process, which has loaded no solver yet."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        code = 1
        try:
            recorder = Recorder(spoilt)
            recorder.install()
            content = asdict(solve(rung, model, recorder))
            with os.fdopen(writing, "w") as pipe:
                json.dump(content, pipe, default=float)
            code = 0
        except BaseException:
            import traceback

            traceback.print_exc()
        finally:
            sys.stderr.flush()
            os._exit(code)
    os.close(writing)
    with os.fdopen(reading) as pipe:
        text = pipe.read()
    if os.waitpid(child, 0)[1] != 0:
        raise RuntimeError(f"{rung}, {model}: the solve failed")
    return json.loads(text)


def main(arguments: Sequence[str]) -> int:
    """Rungs as MODEL:RUNG or MODEL:RUNG:SPOILER; what every solve loads of other libraries is loaded once,
    before.
    """
    sys.path.insert(0, str(ROOT))
    import numpy  # noqa: F401
    import pydantic  # noqa: F401
    import scipy.fft  # noqa: F401
    import scipy.optimize  # noqa: F401
    import scipy.special  # noqa: F401

    import sam.scene  # noqa: F401
    import verification.runs.models  # noqa: F401

    found = {}
    for argument in arguments:
        model, rung, *spoilt = argument.split(":")
        found[argument] = in_child(rung, model, *spoilt)
    json.dump(found, sys.stdout)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
