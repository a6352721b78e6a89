# SPDX-License-Identifier: MIT
"""Scenes with known answers, solved on triplets of grids: how often an uncertainty covers the error."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from math import inf

import numpy as np

from sam.scene import CounterBody, Result, Scene
from verification.reference.elliptic import EllipticContact
from verification.reference.hamilton import largest_von_mises
from verification.reference.hertz import CircularContact
from verification.runs.store import solve_or_reuse
from verification.suite.cases.case import FEM, SAM, Context, with_grid, with_keys, with_loading
from verification.suite.cases.coated_sphere import answer_of
from verification.suite.cases.misfit_sphere import closed_form
from verification.suite.cases.plastic import at_ratio
from verification.uncertainty import (
    FACTOR,
    ORDERS,
    STEP_FACTOR,
    STEP_ORDER,
    Family,
    Member,
    bound,
    cells_to_edge,
    family,
    of_edge,
    order_seen,
)

KNOWN = 3.0  # times better than the uncertainty is a reference that counts
MESHES = (24, 32)  # elements in the radius of the finite-element references
QUICK_MESHES = (16, 24)
STEPS, MANY_STEPS = (5, 6, 8, 10, 15, 20), (40, 80)
CELLS_OF_STEPS = 55  # of the finest grid; load steps are varied on 25 cells
REFERENCE_BOX = 20.0  # radii: 10 leave 0.02 % of the approach, 20 a quarter of that
FRICTION = 0.2
OF_PLASTIC = ("peeq_max", "approach_m", "p_max_Pa", "residual_uz_center_m")
Truth = Mapping[str, tuple[float, float]]
"""Quantity -> its value, and the uncertainty of that."""


@dataclass(frozen=True)
class Subject:
    """A scene with a known answer. finest: cells of the finest grid of each triplet; chose: whether the rule
    was chosen with it, else it was kept apart.
    """

    name: str
    scene: Scene
    truth: Callable[[Context, Scene], Truth]
    finest: Sequence[int]
    chose: bool = False


@dataclass(frozen=True)
class Row:
    """A quantity on a triplet. values, sizes: fine to coarse; truth, doubt: the reference and its own; edge:
    cells in the contact radius of the finest, infinite where no edge falls between cells; factor: of the
    rule.
    """

    subject: str
    chose: bool
    quantity: str
    cells: tuple[float, ...]
    values: tuple[float, ...]
    sizes: tuple[float, ...]
    truth: float
    doubt: float
    order: float
    edge: float = inf
    factor: float = FACTOR

    @cached_property
    def error(self) -> float:
        """Of the finest value."""
        return abs(self.values[0] - self.truth)

    @property
    def known(self) -> bool:
        """Whether the reference is good enough to say anything."""
        return self.doubt <= of_program(self) / KNOWN


def of_program(row: Row) -> float:
    """The rule of the program."""
    edge = of_edge(row.values[0], row.edge) if row.order == ORDERS["approach_m"] else 0.0
    return max(bound(row.values, row.sizes, row.order, row.factor), edge)


def of_textbook(row: Row) -> float:
    """With the observed order and the factor 1.25 (Roache 1998); where none is seen, the formal one and 3."""
    seen = order_seen(row.values, row.sizes)
    order, factor = (row.order, 3.0) if seen is None else (seen, 1.25)
    return bound(row.values[:2], row.sizes[:2], order, factor)


def covered(rows: Sequence[Row], rule: Callable[[Row], float]) -> float:
    """Share of the rows whose error is no larger than the uncertainty."""
    return float(np.mean([row.error <= rule(row) for row in rows]))


def over_error(rows: Sequence[Row], rule: Callable[[Row], float]) -> float:
    """Median of the uncertainty over the error."""
    return float(np.median([rule(row) / max(row.error, 1e-12 * abs(row.truth)) for row in rows]))


def rows_of(context: Context, subject: Subject) -> Iterator[Row]:
    """Every quantity of a scene on each of its triplets."""
    truth = subject.truth(context, subject.scene)
    for count in subject.finest:
        members = family(with_grid(subject.scene, cells=(count, count)), SAM).cells
        yield from _rows(context, subject, members, truth)


def step_rows(context: Context) -> Iterator[Row]:
    """Every quantity of spheres beyond yield on triplets of load steps; their limits on the same cells are
    known by far more steps.
    """
    for name, ratio in (("plastic-swift-rigid", 3.0), ("plastic-swift-rigid", 4.0), ("plastic-perfect", 3.0)):
        scene = with_grid(plastic(context, name, ratio), cells=(CELLS_OF_STEPS, CELLS_OF_STEPS))
        many, most = (
            solved(context, with_loading(family(scene, SAM).cells[-1].scene, steps=steps), SAM).quantities
            for steps in MANY_STEPS
        )
        truth = {key: (2 * most[key] - many[key], abs(most[key] - many[key]) / 2) for key in OF_PLASTIC}
        subject = Subject(f"{scene.title}, {ratio:g}", scene, of_finite_elements, ())
        for steps in STEPS:
            members = family(with_loading(scene, steps=steps), SAM).steps
            yield from _rows(context, subject, members, truth, order=STEP_ORDER)


def _rows(
    context: Context, subject: Subject, members: Sequence[Member], truth: Truth, *, order: float | None = None
) -> Iterator[Row]:
    context.progress(f"uncertainty: {subject.name}, {members[0].label}", 0, 1)
    results = [solved(context, member.scene, SAM) for member in members]
    numbers, sizes = tuple(each.number for each in members), tuple(each.size for each in members)
    edge = inf if order else cells_to_edge(subject.scene, results[0], Family(tuple(members)))
    for name, (value, doubt) in truth.items():
        values, own = tuple(result.quantities[name] for result in results), order or ORDERS[name]
        factor = STEP_FACTOR if order else FACTOR
        yield Row(subject.name, subject.chose, name, numbers, values, sizes, value, doubt, own, edge, factor)


def solved(context: Context, scene: Scene, model: str) -> Result:
    """A converged result, from the store if it is there; no run folder is written for hundreds of them."""
    result, _ = solve_or_reuse(context.store, scene, model)
    if not result.converged:
        raise RuntimeError(f"{scene.title}, {scene.grid}: {result.status}")
    return result


def of_finite_elements(context: Context, scene: Scene, meshes: tuple[int, int] = MESHES) -> Truth:
    """From the axisymmetric model on two meshes, in the same load steps; doubt: what the last one changed."""
    before, fine = (
        solved(context, with_keys(scene, "fem", cells_per_radius=count, box=REFERENCE_BOX), FEM).quantities
        for count in meshes
    )
    return {name: (fine[name], abs(fine[name] - before[name])) for name in OF_PLASTIC}


def of_hertz(_: Context, scene: Scene) -> Truth:
    """A sphere, sliding or at rest without coupling."""
    exact = CircularContact(scene.loading.force, scene.counterbody.radius, _modulus(scene))
    found = {"p_max_Pa": exact.peak_pressure, "approach_m": exact.approach}
    radius, mu = exact.contact_radius, scene.coefficient
    found["contact_radius_m"] = radius
    found["mises_max_Pa"] = largest_von_mises(exact.peak_pressure, radius, scene.body.poisson, mu)[0][0]
    return {name: (value, 0.0) for name, value in found.items()}


def of_ellipse(_: Context, scene: Scene) -> Truth:
    """An ellipsoid."""
    exact = EllipticContact(scene.loading.force, *scene.counterbody.radii, _modulus(scene))
    a, b = exact.semi_axes
    found = {"p_max_Pa": exact.peak_pressure, "approach_m": exact.approach, "contact_area_m2": np.pi * a * b}
    return {name: (value, 0.0) for name, value in found.items()}


def of_film(_: Context, scene: Scene) -> Truth:
    """A sphere on a coated body, by integral transforms."""
    answer = answer_of(scene)
    found = {
        "p_center_Pa": answer.contact.central_pressure,
        "approach_m": answer.contact.approach,
        "contact_radius_m": answer.contact.contact_radius,
        "mises_max_substrate_Pa": answer.mises_body,
    }
    return {name: (value, 0.0) for name, value in found.items()}


def of_misfit(_: Context, scene: Scene) -> Truth:
    """A misfit sphere held in an infinite body: its largest strain by the closed form."""
    radius = scene.loading.radius * np.linspace(0.5, 1.0, 4001)
    return {"peeq_max": (float(closed_form(scene).fields(radius).peeq.max()), 0.0)}


def _modulus(scene: Scene) -> float:
    """E* of a scene."""
    other, body = scene.counterbody, scene.body
    compliance = (1 - body.poisson**2) / body.young
    return 1 / (compliance + ((1 - other.poisson**2) / other.young if other.elastic else 0.0))


def plastic(context: Context, name: str, ratio: float, steps: int = 5) -> Scene:
    """A sphere beyond yield, p0 = ratio times the yield stress, pressed and unloaded."""
    scene = at_ratio(context.scene(name), ratio)
    return with_loading(scene, steps=steps, unload=True).model_copy(update={"grid": None})


def sliding(scene: Scene) -> Scene:
    """The sphere of the same material, so that traction does not move the gap, sliding."""
    body = scene.body
    other = CounterBody(
        shape="sphere", radius=scene.counterbody.radius, young=body.young, poisson=body.poisson
    )
    return Scene(body=body, counterbody=other, loading=scene.loading, friction={"coefficient": FRICTION})


def subjects(context: Context, *, study: bool) -> list[Subject]:
    """The scenes of the study, or a few."""
    swift, perfect = "plastic-swift-rigid", "plastic-perfect"
    hertz, pairs = context.scene("hertz-sphere"), range(41, 86, 2)
    if not study:
        rough = partial(of_finite_elements, meshes=QUICK_MESHES)
        return [
            Subject("Hertz, sphere", hertz, of_hertz, (41, 61), chose=True),
            Subject("Swift, p0 = 3 yield stresses", plastic(context, swift, 3.0), rough, (43,), chose=True),
        ]
    some, fem = range(41, 62, 2), of_finite_elements
    return [
        Subject("Swift, p0 = 3 yield stresses", plastic(context, swift, 3.0), fem, some, chose=True),
        Subject("Swift, 4", plastic(context, swift, 4.0), fem, some, chose=True),
        Subject("perfect, 3", plastic(context, perfect, 3.0), fem, some, chose=True),
        Subject("Swift, 6", plastic(context, swift, 6.0), fem, some),
        Subject("Swift, steel on steel, 4.5", plastic(context, "plastic-swift-steel", 4.5), fem, some),
        Subject("linear, 5", plastic(context, "plastic-linear", 5.0, 10), fem, some),
        Subject("Hertz, sphere", hertz, of_hertz, pairs, chose=True),
        Subject("Hertz, ellipse 3 : 1", context.scene("hertz-ellipse"), of_ellipse, pairs),
        Subject("sliding sphere", sliding(hertz), of_hertz, pairs, chose=True),
        Subject("coated sphere", context.scene("coated-sphere"), of_film, range(41, 64, 2), chose=True),
        Subject("misfit sphere", context.scene("misfit-sphere"), of_misfit, range(31, 40, 2)),
    ]
