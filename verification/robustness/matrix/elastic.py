# SPDX-License-Identifier: MIT
"""Extremes of elastic contacts: material, load, shape, grid and tolerance; films; motion; friction; what is
said of uncertainties.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from sam.scene import HeightMap, Status
from verification.quantities import contact_of
from verification.reference.coated_sphere import thin_layer
from verification.reference.hertz import CircularContact, effective_modulus
from verification.references import coated_contact, layers_of
from verification.robustness.matrix import checks
from verification.robustness.matrix.checks import against, as_other_model, balanced, hertz, relative, same_as
from verification.robustness.matrix.row import (
    BEYOND,
    CELLS,
    FORCE,
    HERTZ,
    POISSON,
    RADIUS,
    YOUNG,
    Absent,
    Check,
    Deviation,
    Expectation,
    Refused,
    Right,
    Row,
    Trial,
    both,
    every,
)
from verification.runs.models import FEM, FEM_3D, SAM

ORDINARY = "elastic contact is well posed"
SCALED = "no length but the radius: the same contact, scaled"
OWN_MESH = Absent(
    "grid.cells and grid.extent are of the semi-analytical model: the finite elements choose their own"
)
NO_ELLIPSE = Refused("no symmetry of rotation", ["counterbody.shape"])
NO_PUNCH = Refused("its nodes do not follow a circle", ["counterbody.shape", '"sphere" or "ellipsoid"'])
RIGID = Refused("it has no mesh of a second body", ["counterbody.young", "rigid"])
UNTOUCHED = Right("nothing touches", [checks.nothing_touches])
INCOMPRESSIBLE = Refused("displacement elements divide by 1 - 2 nu", ["poisson", "< 0.5"])
RATIOS = (1e-6, 1e-2, 1e2, 1e6)
THICKNESSES = (1e-4, 1e-2, 1.0, 1e2, 1e4)  # in contact radii of the bare body
LINEAR = "elastic and linear in the pressure: closed forms in the wave number"
FILM_CELLS = "6 to 9 cells in the radius of SAM, 8 elements of FEM"
NO_PATH = Refused("no symmetry of rotation", ["loading.path", "axis of symmetry"])
SIDE, PATCH = 16e-6, 16  # of a rough plane that moves, in m and cells
WAVE = {"kind": "sinusoid", "amplitude": 5e-8, "wavelength_x": SIDE / 2, "wavelength_y": SIDE / 2}
SMOOTH = "p_max_Pa", "approach_m"
NO_FRICTION = Refused("friction leaves no symmetry of rotation", ["friction.coefficient"])
NEAR_3D = {"approach_m": 0.015, "p_max_Pa": 0.02}  # of hexahedra of a/4 in a box of 5 a
MESH_3D = {"fem.cells_per_radius": 4, "fem.box": 5.0}
SHEARED = "no traction beyond yield_stress/sqrt(3)"


def rows() -> Iterator[Row]:
    """All of them."""
    right = Right(ORDINARY, [hertz()])
    for nu in (0.0, 0.4999):
        yield Row(f"poisson-{nu:g}", "poisson", f"ν = {nu:g}", {"body.poisson": nu}, both(right), quick=True)
    half = both(right, INCOMPRESSIBLE, INCOMPRESSIBLE)
    yield Row("poisson-0.5", "poisson", "ν = 0.5", {"body.poisson": 0.5}, half, quick=True)
    right = Right(SCALED, [hertz(), balanced])
    for force in (1e-15, 1e-9, 1e3, 1e6):
        name, what = f"force-{force:g}", f"{force:g} N; p0 goes with the cube root"
        changes = {"loading.force": force} | (BEYOND if force > 1.0 else {})
        yield Row(name, "force", what, changes, both(right), quick=force in (1e-15, 1e6))
    yield Row("force-0", "force", "0 N", {"loading.force": 0.0}, every(UNTOUCHED), quick=True)
    right = Right(SCALED, [checks.force_of_hertz])
    for approach in (1e-18, 1e-9, 1e-6):
        name, what = f"approach-{approach:g}", f"{approach:g} m; F goes with its power 3/2"
        changes = {"loading.force": None, "loading.approach": approach}
        yield Row(name, "approach", what, changes, both(right), quick=approach == 1e-18)
    yield from shapes()
    yield from rounded_edges()
    for ratio, what in ((1e-6, "1e+06 times softer"), (1e6, "1e+06 times stiffer")):
        changes = {"counterbody.young": ratio * YOUNG, "counterbody.poisson": POISSON}
        two = Right("E* of both", [hertz()])
        changes |= BEYOND if ratio < 1 else {}
        yield Row(
            f"counter-{ratio:g}", "counter-body", f"counter-body {what}", changes, both(two, two, RIGID)
        )
    yield from grids()
    yield from steps_and_tolerances()


def shapes() -> Iterator[Row]:
    """Extremes of the radii of an ellipsoid, and of a flat punch."""
    ellipsoid = {"counterbody.shape": "ellipsoid", "counterbody.radius": None, "counterbody.radius_x": RADIUS}
    for ratio in (354.0, 1e-4, 1e4):
        what = f"ellipsoid, Ry/Rx = {ratio:g}; cells as slender as the contact"
        changes = ellipsoid | {"counterbody.radius_y": ratio * RADIUS} | (BEYOND if ratio < 1.0 else {})
        expected = both(Right(ORDINARY, [checks.ellipse(), balanced]), NO_ELLIPSE)
        yield Row(f"radii-{ratio:g}", "aspect", what, changes, expected, quick=ratio == 354.0)
    slender = Refused("a line contact on every grid that is allowed", ["radius_y", "radius_x/radius_y"])
    changes = ellipsoid | {"counterbody.radius_y": 1e5 * RADIUS}
    yield Row("radii-1e5", "aspect", "ellipsoid, Ry/Rx = 1e5", changes, every(slender))
    flat = {"counterbody.shape": "punch", "counterbody.radius": 1e-5}
    why, what = "rigid in its own radius", "flat-ended cylinder: pressure singular at its edge"
    expected = both(Right(why, [checks.punch(0.02), balanced]), Right(why, [checks.punch(0.004)]), NO_PUNCH)
    yield Row("punch", "punch", what, flat, expected, quick=True)
    expected = both(UNTOUCHED, UNTOUCHED, NO_PUNCH)
    yield Row("punch-0", "punch", "the same, 0 N", flat | {"loading.force": 0.0}, expected)


def rounded_edges() -> Iterator[Row]:
    """Extremes of a punch with a rounded edge: nearly a sphere, nearly sharp, and what has too few cells."""
    topic, shape = "edge of a punch", {"counterbody.shape": "rounded-punch", "grid": None}
    right = Right("the gap is continuous", [checks.rounded_punch(), balanced])
    many = Refused("more cells than are chosen", ["counterbody.radius", "1025 x 1025", "raise it"])
    fem = Right("the mesh is graded to the flat end", [checks.rounded_punch()])
    for flat, edge, sam, what in (
        (1e-12, RADIUS, right, "a flat end of 1e-7 contact radii: a sphere"),
        (1e-5, RADIUS, right, "the contact ends 8 % beyond the flat end"),
        (1e-5, 1e-6, many, "the contact ends 0.4 % beyond the flat end"),
    ):
        changes = shape | {"counterbody.flat_radius": flat, "counterbody.radius": edge}
        yield Row(f"edge-{flat:g}-{edge:g}", topic, what, changes, both(sam, fem, NO_PUNCH), quick=True)
    coarse: dict[str, Any] = shape | {"grid": {"cells": (CELLS, CELLS)}}
    coarse |= {"counterbody.flat_radius": 1e-5, "counterbody.radius": 1e-5}
    few = Refused("2 cells or fewer in the edge", ["grid.cells = [33, 33]", "at least"])
    yield Row("edge-coarse", topic, "too few cells", coarse, both(few, OWN_MESH, NO_PUNCH))
    nothing = both(UNTOUCHED, UNTOUCHED, NO_PUNCH)
    yield Row("edge-0", topic, "the same, 0 N", coarse | {"loading.force": 0.0}, nothing)


def grids() -> Iterator[Row]:
    """Extremes of the grid."""

    def over(x: float, y: float, **more: Any) -> dict[str, Any]:
        """A grid of so many contact radii."""
        return {"grid.extent": (x * HERTZ, y * HERTZ)} | {f"grid.{key}": value for key, value in more.items()}

    off = "p0 is off by more than 1 %"
    few = Refused(off, ["too few cells", "grid.cells", "grid.extent"], Status.UNDER_RESOLVED)
    cut = Refused("the contact is cut off", ["grid.extent", "loading.force"], Status.CONTACT_AT_GRID_EDGE)
    fine = Right("7 cells in the radius one way, 188 the other", [hertz(0.006, 0.003), balanced])
    few, cut, fine = (both(expected, OWN_MESH) for expected in (few, cut, fine))
    mesh = Refused(off, ["fem.cells_per_radius"], Status.UNDER_RESOLVED)
    mesh = both(Absent("fem.cells_per_radius is of the finite elements"), mesh)
    none = every(Refused("no grid", ["grid.cells", "3 to 4097"]))
    for name, topic, what, changes, expected in (
        ("one-cell", "one cell", "one cell in contact", over(100, 100), few),
        ("coarse-grid", "too coarse", "2 cells in the radius", {"grid.cells": (9, 9)}, few),
        ("three-cells", "too coarse", "3 x 3 cells", {"grid.cells": (3, 3)}, few),
        ("two-cells", "too coarse", "2 x 2 cells", {"grid.cells": (2, 2)}, none),
        ("coarse-mesh", "too coarse", "2 elements in the radius", {"fem.cells_per_radius": 2}, mesh),
        ("edge", "edge", "contact up to the edge of the grid", over(2, 2), cut),
        ("edge-y", "edge", "contact beyond two edges of the grid", over(4, 1), cut),
        ("all-cells", "all cells", "sphere, all cells in contact", over(1, 1), cut),
        ("cells-1:54-x", "aspect", "cells 54 times as long as wide", over(4, 4.3, cells=(751, 15)), fine),
        ("cells-1:54-y", "aspect", "cells 54 times as long as wide", over(4.3, 4, cells=(15, 751)), fine),
    ):
        yield Row(name, topic, what, changes, expected, quick=name in ("one-cell", "coarse-mesh", "edge"))


def steps_and_tolerances() -> Iterator[Row]:
    """Extremes of the number of load steps and of the tolerance."""
    one = same_as({"loading.steps": 1}, 1e-6, "elastic: no path; each step within solver.tolerance")
    right = both(Right("elastic: the way to the peak does not matter", [one, hertz()]))
    yield Row("steps-200", "steps", "200 load steps, elastic", {"loading.steps": 200}, right)
    right = both(Right(ORDINARY, [hertz()]))
    yield Row("steps-1", "steps", "1 load step, elastic", {"loading.steps": 1}, right)
    many = Refused("a thousand is the most that is kept", ["loading.steps", "1 to 1000"])
    yield Row("steps-1001", "steps", "1001 load steps", {"loading.steps": 1001}, every(many))
    twin = same_as({"solver.tolerance": 1e-6}, 1e-6, "1e-4 of the coarser tolerance, or rounding")
    right = both(Right("a tolerance above rounding can be met", [twin, hertz()]))
    below = every(Refused("below rounding of a double", ["solver.tolerance", "1e-14 to 0.1"]))
    for tolerance in (1e-3, 1e-6, 1e-9, 1e-12, 1e-15):
        least = tolerance < 1e-12
        what = f"{'' if least else 'elastic, '}solver.tolerance = {tolerance:g}"
        expected, changes = below if least else right, {"solver.tolerance": tolerance}
        name = f"tolerance-{tolerance:g}"
        yield Row(name, "tolerance", what, changes, expected, quick=tolerance == 1e-12)


def coated() -> Check:
    """A sphere on a coated half-space, by dual integral equations: p0 and approach."""

    def expected(trial: Trial) -> dict[str, float]:
        exact = coated_contact(trial.scene)
        return {"p_center_Pa": float(exact.pressure(0.0)), "approach_m": exact.approach}

    return against("coated half-space", expected, {"p_center_Pa": 0.015, "approach_m": 0.004}, FILM_CELLS)


def squeezed() -> Check:
    """A thin soft film on a rigid body (Johnson 1985, 5.8): p0, and the approach a^2/(2 R), where a goes with
    the force to the power 1/4.
    """

    def expected(trial: Trial) -> dict[str, float]:
        layers = layers_of(trial.scene)
        _, unit = thin_layer(layers, RADIUS, HERTZ)
        a = HERTZ * (trial.scene.loading.force / unit) ** 0.25
        return {"p_center_Pa": thin_layer(layers, RADIUS, a)[0], "approach_m": a**2 / (2 * RADIUS)}

    reason = "film of 1e-3 contact radii on a body 1e6 times as stiff: rigid to 1/100"
    return against("thin film", expected, {"p_center_Pa": 0.02, "approach_m": 0.02}, reason)


def thick() -> Check:
    """The film alone, as a half-space: Hertz's p0."""

    def expected(trial: Trial) -> dict[str, float]:
        film, load = trial.scene.body.coating, trial.scene.loading.force
        exact = CircularContact(load, RADIUS, effective_modulus(film.young, film.poisson))
        return {"p_center_Pa": exact.peak_pressure}

    return against("limit of a thick film", expected, {"p_center_Pa": 0.015}, FILM_CELLS)


def one_material() -> Check:
    """A film that is none, or next to none: Hertz for the body."""
    exact = CircularContact(FORCE, RADIUS, effective_modulus(YOUNG, POISSON))
    values = {"p_center_Pa": exact.peak_pressure, "approach_m": exact.approach}
    return against("Hertz", lambda trial: values, {"p_center_Pa": 0.01, "approach_m": 0.004}, FILM_CELLS)


def films() -> Iterator[Row]:
    """Films of every stiffness and thickness."""
    for ratio in RATIOS:
        for thickness in THICKNESSES:
            yield _film(ratio, thickness)
    right = Right("the same material: no film", [one_material()])
    for thickness in (1e-4, 1.0, 1e4):
        yield _row(1.0, thickness, both(right, _in_fem(1.0, thickness) or right))
    name, what, changes = "film-force-0", "0 N on a film", coating(1e-2, 1.0) | {"loading.force": 0.0}
    yield Row(name, "film", what, changes, both(UNTOUCHED))
    half = {"body.coating": coating(1e-2, 1.0)["body.coating"] | {"poisson": 0.5}, "body.poisson": 0.5}
    right = Right("closed forms hold for an incompressible film", [coated()])
    what = "film and body with ν = 0.5"
    yield Row("film-poisson-0.5", "film", what, half, both(right, INCOMPRESSIBLE), quick=True)


def coating(ratio: float, thickness: float) -> dict:
    """A film of so many times the body's modulus and contact radii."""
    return {"body.coating": {"thickness": thickness * HERTZ, "young": ratio * YOUNG, "poisson": POISSON}}


def _film(ratio: float, thickness: float) -> Row:
    checks = [coated()] if thickness >= 1e-2 else []
    if (ratio, thickness) == (1e-6, 1e-2):
        checks = [squeezed()]
    if ratio == 1e6 and thickness < 1.0:  # a stiff plate: the contact is no disc, and there is no closed form
        checks = [same_as({"grid.cells": (65, 65)}, 0.01, "half the cell", ("approach_m",))]
    if (ratio, thickness) == (1e2, 1e-4):  # 1e-4 radii, 100 times as stiff: the bare body to 1 %
        checks = [one_material()]
    checks += [thick()] if thickness >= 1e4 else []
    fem = _in_fem(ratio, thickness)
    if fem is None and not checks:
        near, reason = {"approach_m": 0.005, "p_center_Pa": 0.01}, "8 cells or elements in the radius"
        sam, fem = (Right(LINEAR, [as_other_model(twin, near, reason)]) for twin in (FEM, SAM))
        return _row(ratio, thickness, both(sam, fem))
    sam = Right(LINEAR, [*checks, balanced])
    if ratio == 1e6 and thickness >= 1.0:
        reason = (
            f"the contact with the film is {ratio ** (-1 / 3):.2g} of that without, and both are on one grid"
        )
        sam = Refused(reason, ["too few cells", "grid.cells"], Status.UNDER_RESOLVED)
    return _row(ratio, thickness, both(sam, fem or Right(LINEAR, checks)))


def _in_fem(ratio: float, thickness: float) -> Expectation | None:
    """The error that FEM must end in, None if it must be right."""
    if thickness > 5.0:
        return Refused("no body below the film in the box of 10 radii", ["body.coating.thickness", "fem.box"])
    if ratio == 1e-6 and thickness >= 1e-2:
        return Refused("a contact as large as the box: so soft a film is pressed flat", ["fem.box"])
    if ratio == 1e6 or (ratio == 1e2 and thickness == 1e-4):
        reason = (
            "forces of the stiff film are small differences: they do not balance to 1e-9 in double precision"
        )
        return Refused(reason, ["body.coating.thickness", "body.coating.young"], Status.NOT_CONVERGED)
    return None


def _row(ratio: float, thickness: float, expected: dict[str, Expectation]) -> Row:
    cells = {"grid.cells": (129, 129)} if ratio == 1e2 and thickness >= 1.0 else {}
    wide = BEYOND if ratio == 1e-6 and thickness >= 1.0 else {}  # pressed nearly through
    name, what = f"film-{ratio:g}-{thickness:g}a", f"film of {ratio:g} E, {thickness:g} contact radii thick"
    changes, quick = coating(ratio, thickness) | cells | wide, (ratio, thickness) == (1e-2, 1.0)
    return Row(name, "film", what, changes, expected, quick)


def way(cells: float, cell: float = SIDE / PATCH, steps: int = 1) -> dict[str, Any]:
    """A path along x about the origin."""
    return {"start": (-cells * cell / 2, 0.0), "end": (cells * cell / 2, 0.0), "steps": steps}


def over_patch(path: dict, surface: dict | None = WAVE) -> dict[str, Any]:
    """A plane with waves, or a smooth one, that slides over a smooth patch."""
    return {
        "counterbody": {"shape": "flat"} | ({"surface": surface} if surface else {}),
        "loading": {"force": 0.5, "path": path},
        "grid": {"cells": (PATCH, PATCH), "extent": (SIDE, SIDE), "border": "relief"},
    }


def paths() -> Iterator[Row]:
    """A counter-body that moves: hardly at all, by its own wave, too far, in broken cells."""
    still, cell = {"loading.path": None}, 4 * HERTZ / 33
    reason = "the same contact elsewhere on the cells; each within solver.tolerance"
    as_in_place = Right("as in place", [same_as(still, 1e-6, reason, SMOOTH)])
    spatial = Right("as in place", [same_as(still, 1e-6, "the same mesh", SMOOTH)])
    sides = {"grid.extent": (33 * cell, 33 * cell)}
    expected, changes = both(as_in_place, NO_PATH, spatial), {"loading.path": way(1e-9, HERTZ)} | sides
    yield Row("path-1e-9", "path", "a path of 1e-9 contact radii", changes | MESH_3D, expected, quick=True)
    expected, changes = both(as_in_place, NO_PATH), {"loading.path": way(2.0, cell, 2)} | sides
    yield Row("path-cells", "path", "a path of two whole cells", changes, expected, quick=True)
    contact, back = (*SMOOTH, "contact_area_m2"), {"loading.path": way(-1.0, HERTZ)}
    mirrored = same_as(back, 1e-6, "the mirror image: each within EQUILIBRIUM of the force", contact)
    mirrored = Right("as backwards", [mirrored])
    changes = MESH_3D | {"loading.path": way(1.0, HERTZ), "friction.coefficient": 0.3}
    what = "a way of a radius with friction, forth and back"
    yield Row("path-mirror", "path", what, changes, both(mirrored, NO_PATH, mirrored), quick=True)
    elsewhere = Right("as in place", [same_as(still, 2e-3, "another box about each place", contact)])
    expected = both(Absent("its cells are asked in path-cells"), NO_PATH, elsewhere)
    changes, what = (
        MESH_3D | {"loading.path": way(4.0, HERTZ, 8)},
        "a way of four radii in whole elements, elastic",
    )
    yield Row("path-elements", "path", what, changes, expected)
    half = {"loading.path": {"start": (-SIDE, 0.0), "end": (0.0, 0.0), "steps": 8}}
    # only the middle of the way says what is opposite
    own = Right("as half the way before", [same_as(half, 1e-6, reason, SMOOTH)])
    changes, what = over_patch(way(PATCH, steps=8)), "a rough plane that slides by its own wave"
    yield Row("path-wave", "path", what, changes, both(own, NO_PATH), quick=True)
    yield from no_paths()


def no_paths() -> Iterator[Row]:
    """What does not go together, named before anything is solved."""
    short = {"kind": "file", "path": HeightMap(np.zeros((PATCH, PATCH)), (SIDE, SIDE))}
    film = {"friction": {"law": "chemical-film", "low": 0.1, "high": 0.4}}
    rolls = {"counterbody.slip": 0.0, "friction.coefficient": 0.2}
    coated = {"body.coating": {"thickness": 1e-6, "young": 1e11, "poisson": 0.3}}
    one, long_step = {"loading.path": way(1.0)}, {"loading.path": way(3.0, HERTZ)}
    two, broken = way(2.0, steps=2), over_patch(way(3.0, steps=2))
    for name, what, changes, words in (
        ("none", "a path without length", {"loading.path": way(0.0)}, ["loading.path.end"]),
        ("long-step", "a step of three contact radii", long_step, ["steps", "3 or more"]),
        ("no-force", "a path without force", one | {"loading.force": 0.0}, ["loading.force"]),
        ("rolls", "rolling with friction", one | rolls, ["counterbody.slip", "stick-slip"]),
        ("broken-cells", "steps of 1.5 cells", broken, ["loading.path.steps", "divisor"]),
        ("broken-way", "a way of 2.5 cells", over_patch(way(2.5)), ["loading.path.end", "2.5"]),
        ("short-map", "a map as long as the patch", over_patch(two, short), ["at least", "it has"]),
        ("still-plane", "a smooth plane", over_patch(way(2.0), None), ["loading.path", "nothing moves"]),
        ("coated", "a coated body", one | coated, ["body.coating"]),
        ("film", "a film without its limit", one | film, ["friction.film_thickness"]),
    ):
        expected = every(Refused("no such motion", words))
        yield Row(f"path-{name}", "path", what, changes, expected, quick=True)


def carries(trial: Trial) -> Iterator[Deviation]:
    """Sum of q over sum of p is the coefficient."""
    found, expected = trial.quantities["friction_coefficient"], trial.scene.friction.coefficient
    yield relative("sum of q over sum of p", found, expected, 1e-9, reason="q = mu p in each cell: rounding")


def frictionless(trial: Trial) -> Iterator[Deviation]:
    """Without friction there is no tangential traction."""
    found = abs(trial.quantities["friction_coefficient"])
    yield Deviation("sum of q over sum of p", found, 1e-300, "there is no q")


def holds_yield(trial: Trial) -> Iterator[Deviation]:
    """No stress beyond yield where it was measured."""
    yield from checks.within_tolerance(trial, "yield_excess")


def friction() -> Iterator[Row]:
    """Friction: none to all, incompressible, and more than a perfectly plastic surface carries."""
    why = "a contraction: each pass leaves b/sqrt(1 + b^2) of the error, b = beta mu"
    compared = as_other_model(FEM_3D, NEAR_3D, "4 elements in the radius, a box of 5 radii")
    sam = Right(why, [carries, balanced, compared])
    twin = as_other_model(SAM, NEAR_3D, "the same comparison")
    coupled = both(sam, NO_FRICTION, Right("one linear problem for each set of nodes", [twin]))
    apart = both(Right("q moves nothing normally: Hertz", [hertz(mises=None), carries]), NO_FRICTION)
    for mu in (0.1, 0.5, 1.0):
        name, what, changes = f"friction-{mu:g}", f"μ = {mu:g}", {"friction.coefficient": mu}
        yield Row(name, "friction", f"{what} against a rigid sphere", changes | MESH_3D, coupled)
        changes |= {"friction.coupling": False}
        what = f"{what}, without coupling"
        yield Row(f"{name}-uncoupled", "friction", what, changes, apart, quick=mu == 1.0)
    none = both(Right("as without [friction]", [hertz(), frictionless]))
    yield Row("friction-0", "friction", "μ = 0", {"friction.coefficient": 0.0}, none, quick=True)
    right = Right("(1 - 2 nu)/mu = 0: q moves the surface along x only", [hertz(mises=None), carries])
    reason = "q moves the surface three times as far as p does: said, with what to change"
    endless = Refused(reason, ["friction.coefficient, 10"], Status.NOT_CONVERGED)
    beyond = Refused("nothing slides so", ["friction.coefficient", "0 to 10"])
    half = {"body.poisson": 0.5} | MESH_3D
    for name, what, mu, changes, expected in (
        ("friction-1-poisson-0.5", "μ = 1, ν = 0.5", 1.0, half, both(right, NO_FRICTION, INCOMPRESSIBLE)),
        ("friction-10", "μ = 10", 10.0, {}, both(endless, NO_FRICTION)),
        ("friction-10.5", "μ = 10.5", 10.5, {}, both(beyond)),
    ):
        yield Row(name, "friction", what, {"friction.coefficient": mu} | changes, expected)
    yield from sheared()


def sheared() -> Iterator[Row]:
    """Tractions near and beyond the shear strength of a perfectly plastic body."""
    strength = 1e9
    given = {
        "body.plasticity": {"law": "perfect", "yield_stress": strength},
        "friction.coefficient": 1.0,
        "counterbody": None,
    }
    loads = {"prescribed": "hertz", "radius": 4e-6, "steps": 4}
    within = Right("within yield_stress/sqrt(3): elastic but for the edge", [carries, holds_yield])
    no_end = Refused(f"{SHEARED}: no equilibrium", ["loading.p0", "friction.coefficient"])
    spreads = f"{SHEARED}: the contact must spread to p <= 0.58 of it, and is sheared without end"
    flows = Refused(spreads, ["grid.extent", "loading.force"], Status.PLASTIC_ZONE_AT_GRID_EDGE)
    contact = {"body.plasticity": {"law": "perfect", "yield_stress": 1.8687e9}, "friction.coefficient": 1.0}
    half, twice = (given | {"loading": loads | {"p0": share * strength}} for share in (0.5, 2.0))
    for name, what, changes, expected in (
        ("0.5", "q up to half of the yield stress, p given", half, both(within, NO_FRICTION)),
        ("2", "q up to twice the yield stress, p given", twice, every(no_end)),
        ("contact", "μ = 1, perfectly plastic, p0/σy = 3", contact, both(flows, NO_FRICTION)),
    ):
        yield Row(f"shear-{name}", "friction", what, changes, expected)


def uncertainties() -> Iterator[Row]:
    """Uncertainties: too coarse a grid, no load, singular stresses, accuracies of any size."""
    few = "fewer than four cells in the radius of the coarsest"
    coarse = Right(few, [without("p_max_Pa", "under-")])
    idle = Right("no contact has no cells in it", [without("approach_m", "under-")])
    zeros = Right("every value is zero", [zero])
    other = Refused("its own change is none", ["solver.uncertainty = true", "extrapolate"])
    found = both(Right("from coarse grids upwards, confirmed", [covers, reached]))
    given = Refused("the cells are given", ["solver.accuracy = 0.01", "[grid]"])
    singular = Right("it grows with every refinement", [without("p_max_Pa", "singular")])
    small = {"grid.cells": (17, 17), "fem.cells_per_radius": 6}
    cells = {"grid.cells": (41, 41), "fem.cells_per_radius": 12, "fem.box": 30.0}
    idle_load = {"fem.cells_per_radius": 9, "loading.force": 0.0}
    punch = {"counterbody.shape": "punch", "fem.cells_per_radius": 9}
    half, mille = ({"grid": None, "solver.accuracy": accuracy} for accuracy in (0.5, 1e-3))
    for name, what, changes, expected in (
        ("coarse", "17 cells, 6 elements in the radius", small, both(coarse)),
        ("hertz", "a closed form", cells, both(Right("it covers the error", [covers]))),
        ("0", "no load", idle_load, both(idle, zeros)),
        ("punch", "a stress that is singular", punch, both(singular)),
        ("twice", "with extrapolation", {"solver.extrapolate": True}, both(other)),
        ("far", "an accuracy of a half", half, found),
        ("near", "an accuracy of 0.1 %", mille, found),
        ("given", "an accuracy on given cells", {"solver.accuracy": 0.01}, both(given)),
    ):
        asked, quick = {"solver.uncertainty": True} | changes, name in ("coarse", "hertz")
        yield Row(f"uncertainty-{name}", "uncertainty", what, asked, expected, quick)


def without(name: str, words: str) -> Check:
    """A quantity has no uncertainty, and the reason has these words."""

    def check(trial: Trial) -> Iterator[Deviation]:
        entry = trial.result.uncertainty[name]
        right = entry["u_num"] is None and words in entry["flag"]
        said = "0: it is as expected, 1: it is not"
        yield Deviation(f"no uncertainty of {name}", float(not right), 0.5, said)

    return check


def covers(trial: Trial) -> Iterator[Deviation]:
    """The error of Hertz's pressure and approach is no larger than the uncertainty."""
    exact = contact_of(trial.scene)
    for name, value in (("p_max_Pa", exact.peak_pressure), ("approach_m", exact.approach)):
        share = abs(trial.quantities[name] - value) / trial.result.uncertainty[name]["u_num"]
        yield Deviation(f"error of {name} over its uncertainty", share, 1.0, "what an uncertainty is")


def zero(trial: Trial) -> Iterator[Deviation]:
    """Nothing is uncertain where nothing happens."""
    entries = trial.result.uncertainty.values()
    yield Deviation("uncertainty", max(entry["u_num"] or 0.0 for entry in entries), 1e-30, "no load")


def reached(trial: Trial) -> Iterator[Deviation]:
    """The accuracy that was asked for."""
    found = trial.result.discretisation["accuracy"]
    yield Deviation("uncertainty over accuracy", found["relative"] / found["asked"], 1.0, "as asked")
