# SPDX-License-Identifier: MIT
"""The scenes of the leave-out tests, from one that needs next to nothing to one that needs everything."""

STEEL = {"young": 210e9, "poisson": 0.3}
SWIFT = {"law": "swift", "B": 945e6, "C": 20.0, "n": 0.121}
HARD = {"law": "perfect", "yield_stress": 50e9}
FILM = {"thickness": 0.4e-6, "young": 80e9, "poisson": 0.3}
SURFACE = {
    "kind": "self-affine",
    "ra": 0.1e-6,
    "cutoff_long": 16e-6,
    "cutoff_short": 8e-6,
    "hurst": 0.8,
    "seed": 1,
}
DEPTHS = (0.0, 0.3e-6, 0.8e-6, 2e-6, 4e-6, 8e-6)
CHEMICAL = {
    "law": "chemical-film",
    "low": 0.1,
    "high": 0.4,
    "film_thickness": 100e-9,
    "film_young": 80e9,
    "film_poisson": 0.3,
    "film_yield": 2e9 / 3,
    "strain_limit": 0.0204,
}


def sphere(plasticity=None, *, coating=None, counterbody=None, friction=None, solver=None, **loading) -> dict:
    """A rigid sphere on a smooth body: 33 x 33 cells elastic, 17 x 17 plastic; FEM with the fewest elements
    that are allowed.
    """
    plastic = plasticity is not None
    grid = (
        {"cells": (17, 17), "extent": (12e-6, 12e-6), "layers": 8, "depth": 7e-6}
        if plastic
        else {"cells": (33, 33)}
    )
    body = STEEL | {"plasticity": plasticity, "coating": coating}
    return {
        "body": {name: value for name, value in body.items() if value is not None},
        "counterbody": {"shape": "sphere", "radius": 105e-6} | (counterbody or {}),
        "loading": {"force": 0.05, "steps": 2} | loading,
        "grid": grid,
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
    "given load, travelling": given(
        friction=COUPLED, path={"start": (-2e-6, 0.0), "end": (2e-6, 0.0), "steps": 2}
    ),
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
    "moving, film and wear": rough(SWIFT, friction=CHEMICAL, wear={"strain_limit": 0.002}, **RUNNING_IN)
    | {"counterbody": opposite()["counterbody"], "loading": {"force": 0.02, "path": ON_PATCH, **RUNNING_IN}},
    "misfit": misfit(),
    "misfit, plastic": misfit(SWIFT, unload=True),
    "rough elastic": rough(),
    "rough elastic, sliding": rough(friction=DECOUPLED),
    "rough plastic": rough(SWIFT),
    "rough counter-body": opposite(),
    "rough counter-body, renewed": opposite(SWIFT, renew=True, **RUNNING_IN),
    "chemical film, elastic": rough(friction=CHEMICAL, **RUNNING_IN),
    "chemical film": rough(SWIFT, friction=CHEMICAL, **RUNNING_IN),
    "wear": rough(SWIFT, wear={"strain_limit": 0.002}, **RUNNING_IN),
    "wear out of reach": rough(SWIFT, wear={"strain_limit": float("inf")}, **RUNNING_IN),
    "moved": sphere(**MOVED),
    "moved, coated": sphere(coating=FILM, **MOVED),
    "moved, plastic": sphere(SWIFT, unload=True, **MOVED),
    "moved, rough": rough(**MOVED),
    "running-in": rough(SWIFT, friction=CHEMICAL, wear={"strain_limit": 0.002}, **RUNNING_IN),
}
