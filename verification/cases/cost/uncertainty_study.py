# SPDX-License-Identifier: MIT
"""Problems that differ, drawn from a seed, with known answers: whether an uncertainty covers the error.

Dimensionless numbers make a problem: two elastic spheres are one, whatever their loads. So an elastic sphere
is drawn once, and of the others shape, film, law, friction and load over yield stress differ.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from sam.scene import Result, Scene, Status
from verification.cases.case import FEM, SAM, Context, with_grid, with_keys, with_loading
from verification.cases.plastic.misfit_sphere import closed_form
from verification.cases.recipes import at_ratio
from verification.reference.coated_changes import largest_mises
from verification.reference.elliptic import EllipticContact
from verification.reference.hamilton import largest_von_mises
from verification.reference.rounded_punch import RoundedPunch
from verification.references import coated_contact, contact_of
from verification.runs.store import solve_or_reuse
from verification.uncertainty import asked_of, bound, order_seen, solve

SEED = 20261125
DRAWS = 5  # of a problem, until its plastic zone fits the grid
KNOWN = 3.0  # times better than uncertainty or error is a reference that counts
MESHES, BOX = (
    (16, 24),
    20.0,
)  # elements in the radius of a reference by finite elements; 20 radii: 0.005 % off
FINER = 1.75  # times as many cells, of a reference by SAM
MORE_STEPS = (2, 4)  # times as many load steps, of a reference
FRICTION = 0.2
OF_PLASTIC = ("peeq_max", "approach_m", "p_max_Pa", "residual_uz_center_m", "contact_area_m2")
OF_SLIDING = (*OF_PLASTIC, "p_center_Pa", "mises_max_Pa", "tangential_displacement_center_m")
OF_SLIDING += ("residual_ux_center_m", "plastic_shear_center_m")
OF_FEW = ("Hertz, sphere", "ellipsoid", "film", "misfit sphere", "yielding sphere")  # at the quick level
Truth = Mapping[str, tuple[float, float]]
"""Quantity -> its value, and the uncertainty of that."""
Draw = np.random.Generator


@dataclass(frozen=True)
class Subject:
    """A problem: its kind, and its scene by the number of the draw, which is asked for its uncertainty."""

    kind: str
    drawn: Callable[[int], Scene]
    truth: Callable[[Context, Scene], Truth]


@dataclass(frozen=True)
class Row:
    """A quantity of a problem. entry: what the program says of it; truth: the reference, doubt: of that."""

    subject: str
    quantity: str
    entry: Mapping[str, Any]
    truth: float
    doubt: float

    @property
    def error(self) -> float:
        """Of the value."""
        return abs(self.entry["values"][0] - self.truth)

    @property
    def known(self) -> bool:
        """Whether the reference is good enough to say anything: that it is covered, or that it is not."""
        return self.doubt <= max(of_program(self), self.error) / KNOWN


def of_program(row: Row) -> float:
    """The uncertainty that the program states."""
    return row.entry["u_num"]


def of_textbook(row: Row) -> float:
    """By the cells with the observed order and the factor 1.25 (Roache 1998), where none is seen with the
    second and 3; by load steps and box as the program.
    """
    values, sizes = row.entry["values"], [1.0 / count for count in row.entry["cells"]]
    seen = order_seen(values, sizes)
    order, factor = (2.0, 3.0) if seen is None else (seen, 1.25)
    return bound(values[:2], sizes[:2], order, factor) + row.entry["u_steps"] + row.entry["u_box"]


def covered(rows: Sequence[Row], rule: Callable[[Row], float]) -> float:
    """Share of the rows whose error is no larger than the uncertainty."""
    return float(np.mean([row.error <= rule(row) for row in rows]))


def over_error(rows: Sequence[Row], rule: Callable[[Row], float]) -> float:
    """Median of the uncertainty over the error."""
    return float(np.median([rule(row) / max(row.error, 1e-12 * abs(row.truth)) for row in rows]))


def rows_of(context: Context, subject: Subject) -> Iterator[Row]:
    """Every quantity of a problem that has an uncertainty and a reference. A scene whose plastic zone leaves
    its grid has neither, and is drawn again.
    """
    for number in range(DRAWS):
        scene = subject.drawn(number)
        try:
            found = solve(asked_of(scene, subject.kind), SAM, lambda each, _: solved(context, each, SAM))
            truth = subject.truth(context, scene)
            break
        except AtEdgeError:
            if number == DRAWS - 1:
                raise
    for name, (value, doubt) in truth.items():
        entry = found.uncertainty.get(name, {})
        if entry.get("u_num") is not None:
            yield Row(subject.kind, name, entry, value, doubt)


class AtEdgeError(RuntimeError):
    """A plastic zone at the edge of the grid."""


def solved(context: Context, scene: Scene, model: str) -> Result:
    """A converged result, from the store if it is there; no run folder is written for hundreds of them."""
    result, _ = solve_or_reuse(context.store, scene, model)
    if not result.converged:
        at_edge = result.status is Status.PLASTIC_ZONE_AT_GRID_EDGE
        raise (AtEdgeError if at_edge else RuntimeError)(f"{scene.title}, {scene.grid}: {result.status}")
    return result


def finer(context: Context, scene: Scene, model: str, names: Sequence[str]) -> Truth:
    """From finer cells or elements, and more load steps, extrapolated in both by their formal orders. doubt:
    the extrapolation, of load steps a half; names: of the quantities.
    """
    few, many = (with_loading(scene, steps=scene.loading.steps * times) for times in MORE_STEPS)

    def of(other: Scene, rank: int) -> Mapping[str, Any]:
        if model == FEM:
            other = with_keys(other, "fem", cells_per_radius=MESHES[rank], box=BOX)
        else:
            factor = FINER if rank else FINER / 1.5
            other = with_grid(other, cells=tuple(2 * round(factor * n / 2) + 1 for n in scene.grid.cells))
        return solved(context, other, model).quantities

    few_coarse, many_coarse, best = of(few, 0), of(many, 0), of(many, 1)
    truth = {}
    for name in names:
        values = [each.get(name) for each in (few_coarse, many_coarse, best)]
        if None not in values:
            steps, cells = values[1] - values[0], (values[2] - values[1]) / (1.5**2 - 1)
            truth[name] = values[2] + steps + cells, abs(cells) + abs(steps) / 2
    return truth


def of_hertz(_: Context, scene: Scene) -> Truth:
    """A sphere, sliding or at rest without coupling."""
    exact, mu = contact_of(scene), scene.coefficient
    stress = largest_von_mises(exact.peak_pressure, exact.contact_radius, scene.body.poisson, mu)[0][0]
    found = {"p_max_Pa": exact.peak_pressure, "approach_m": exact.approach, "mises_max_Pa": stress}
    return _exact(found | {"contact_area_m2": np.pi * exact.contact_radius**2})


def _exact(found: Mapping[str, float]) -> Truth:
    return {name: (value, 0.0) for name, value in found.items()}


def of_ellipse(_: Context, scene: Scene) -> Truth:
    """A rigid ellipsoid."""
    exact = EllipticContact(scene.loading.force, *scene.counterbody.radii, _modulus(scene))
    a, b = exact.semi_axes
    found = {"p_max_Pa": exact.peak_pressure, "approach_m": exact.approach, "contact_area_m2": np.pi * a * b}
    return _exact(found)


def of_rounded(_: Context, scene: Scene) -> Truth:
    """A rigid punch with a rounded edge."""
    other = scene.counterbody
    exact = RoundedPunch(scene.loading.force, other.flat_radius, other.radius, _modulus(scene))
    found = {"approach_m": exact.approach, "contact_area_m2": np.pi * exact.contact_radius**2}
    return _exact(found | {"p_center_Pa": float(exact.pressure(0.0))})


def of_film(_: Context, scene: Scene) -> Truth:
    """A sphere on a coated body, by integral transforms."""
    contact = coated_contact(scene)
    found = {
        "p_center_Pa": contact.central_pressure,
        "approach_m": contact.approach,
        "contact_area_m2": np.pi * contact.contact_radius**2,
        "mises_max_substrate_Pa": largest_mises(contact).value,
    }
    return _exact(found)


def of_misfit(_: Context, scene: Scene) -> Truth:
    """A misfit sphere held in an infinite body: its largest strain by the closed form."""
    radius = scene.loading.radius * np.linspace(0.5, 1.0, 4001)
    return _exact({"peeq_max": float(closed_form(scene).fields(radius).peeq.max())})


def _modulus(scene: Scene) -> float:
    """E* below a rigid counter-body."""
    return scene.body.young / (1 - scene.body.poisson**2)


def plastic(context: Context, name: str, ratio: float, steps: int = 5) -> Scene:
    """A sphere beyond yield, p0 = ratio times the yield stress, pressed and unloaded."""
    scene = at_ratio(context.scene(name), ratio)
    return with_loading(scene, steps=steps, unload=True).model_copy(update={"grid": None})


def sliding(scene: Scene, friction: float = FRICTION) -> Scene:
    """The sphere of the same material, so that traction does not move the gap, sliding."""
    body = {"young": scene.body.young, "poisson": scene.body.poisson}
    other = scene.counterbody.model_copy(update=body)
    return Scene(body=body, counterbody=other, loading=scene.loading, friction={"coefficient": friction})


def _elastic(draw: Draw) -> dict[str, float]:
    return {"young": draw.uniform(60e9, 400e9), "poisson": draw.uniform(0.2, 0.4)}


def _pressed(draw: Draw, other: Mapping[str, Any], **body: Any) -> Scene:
    """An elastic body below a rigid one, of a force that makes a contact of some per cent of its radius."""
    body = _elastic(draw) | body
    loading = {"force": draw.uniform(1e-5, 1e-4) * body["young"] * 1e-6}
    return Scene(body=body, counterbody=other, loading=loading)


def _sphere(draw: Draw) -> Scene:
    return _pressed(draw, {"shape": "sphere", "radius": 1e-3})


def _ellipsoid(draw: Draw) -> Scene:
    return _pressed(draw, {"shape": "ellipsoid", "radius_x": 1e-3, "radius_y": draw.uniform(1.5, 8.0) * 1e-3})


def _rounded(draw: Draw) -> Scene:
    other = {"shape": "rounded-punch", "flat_radius": draw.uniform(5e-6, 3e-5), "radius": 1e-3}
    return _pressed(draw, other)


def _film(draw: Draw) -> Scene:
    sphere = _sphere(draw)
    film = {"young": sphere.body.young * 10 ** draw.uniform(-0.6, 0.6), "poisson": draw.uniform(0.2, 0.4)}
    film["thickness"] = contact_of(sphere).contact_radius * draw.uniform(0.15, 1.0)
    return Scene(
        body=sphere.body.model_dump(exclude_none=True) | {"coating": film},
        counterbody=sphere.counterbody,
        loading=sphere.loading,
    )


def _law(draw: Draw, young: float, kind: str) -> dict[str, Any]:
    """A hardening law whose yield stress is 0.3 to 1 % of Young's modulus."""
    stress = young * draw.uniform(0.003, 0.01)
    if kind == "swift":
        n = draw.uniform(0.05, 0.2)
        return {"law": kind, "B": stress / 20**n, "C": 20.0, "n": n}
    if kind == "table":
        at, rise = (
            np.array([0.0, 0.005, 0.02, 0.1]),
            np.array([1.0, *(1 + draw.uniform(0.05, 0.3, 3).cumsum())]),
        )
        return {"law": kind, "file": tuple(zip(at.tolist(), (stress * rise).tolist(), strict=True))}
    own = {"modulus": young * draw.uniform(0.01, 0.1)} if kind == "linear" else {}
    return {"law": kind, "yield_stress": stress} | own


LAWS = ("swift", "linear", "perfect", "table")


def _yielding(draw: Draw, rank: int, *, friction: float = 0.0, slender: float = 1.0) -> Scene:
    """A sphere, or an ellipsoid, beyond yield; one in seven on an elastic counter-body."""
    elastic, kind = _elastic(draw), LAWS[rank % len(LAWS)]
    other = {"shape": "sphere", "radius": 1e-3} | (_elastic(draw) if rank % 7 == 1 else {})
    body = elastic | {"plasticity": _law(draw, elastic["young"], kind)}
    loading = {"force": 1.0, "steps": int(draw.integers(4, 7)), "unload": True}
    scene = Scene(body=body, counterbody=other, loading=loading, solver={"tolerance": 1e-5})
    scene = at_ratio(scene, draw.uniform(2.5, 4.0 if kind == "perfect" else 5.5))
    if slender > 1.0:
        shape = {"shape": "ellipsoid", "radius_x": 1e-3 / slender, "radius_y": 1e-3 * slender}
        content = scene.model_dump(exclude_none=True) | {"counterbody": shape}
        return Scene(**content)
    return (
        Scene(**scene.model_dump(exclude_none=True) | {"friction": {"coefficient": friction}})
        if friction
        else scene
    )


def _given(draw: Draw, rank: int) -> Scene:
    scene = _yielding(draw, 2 * rank)
    stress = float(scene.body.plasticity.curve().stress(0.0))
    steps = {"steps": scene.loading.steps, "unload": True}
    loading = {"prescribed": "hertz", "p0": stress * draw.uniform(2.0, 2.6), "radius": 1e-5} | steps
    return Scene(body=scene.body, loading=loading, solver=scene.solver)


def _misfit(draw: Draw, rank: int) -> Scene:
    elastic = _elastic(draw)
    body = elastic | {"plasticity": _law(draw, elastic["young"], LAWS[rank])}
    loading = {"prescribed": "misfit-sphere", "depth": draw.uniform(1.3, 2.0) * 1e-5, "radius": 1e-5}
    loading |= {"misfit": draw.uniform(0.03, 0.06), "profile": "smooth", "surface": "held", "steps": 1}
    return Scene(body=body, loading=loading)


def subjects(*, study: bool) -> list[Subject]:
    """The forty problems, or one of some kinds."""
    of_elements, of_cells = (
        partial(finer, model=FEM, names=OF_PLASTIC),
        partial(finer, model=SAM, names=OF_SLIDING),
    )
    kinds: Sequence[tuple[str, int, Callable[[Draw, int], Scene], Callable[[Context, Scene], Truth]]] = (
        ("Hertz, sphere", 1, lambda draw, _: _sphere(draw), of_hertz),
        ("ellipsoid", 4, lambda draw, _: _ellipsoid(draw), of_ellipse),
        ("rounded punch", 3, lambda draw, _: _rounded(draw), of_rounded),
        ("sliding sphere", 2, lambda draw, _: sliding(_sphere(draw), draw.uniform(0.1, 0.4)), of_hertz),
        ("film", 6, lambda draw, _: _film(draw), of_film),
        ("misfit sphere", 3, _misfit, of_misfit),
        ("given pressure", 3, _given, of_elements),
        ("yielding sphere", 14, _yielding, of_elements),
        (
            "yielding, sliding",
            2,
            lambda draw, rank: _yielding(draw, rank, friction=draw.uniform(0.05, 0.2)),
            of_cells,
        ),
        (
            "yielding, ellipsoid",
            2,
            lambda draw, rank: _yielding(draw, rank, slender=draw.uniform(1.2, 1.6)),
            of_cells,
        ),
    )
    found = []
    for place, (kind, count, make, truth) in enumerate(kinds):
        for rank in range(count):
            if study or (rank == 0 and kind in OF_FEW):
                name = f"{kind} {rank + 1}" if count > 1 else kind
                found.append(Subject(name, partial(_drawn, make, (SEED, place, rank)), truth))
    return found


def _drawn(make: Callable[[Draw, int], Scene], seed: tuple[int, ...], number: int) -> Scene:
    """A scene on a number of cells that is drawn too."""
    draw = np.random.default_rng((*seed, number) if number else seed)
    scene = make(draw, seed[-1])
    cells = int(draw.integers(40, 50 if scene.body.plasticity else 100))
    return with_grid(scene, cells=(cells, cells))
