# SPDX-License-Identifier: MIT
"""Whether the uncertainty that samfem gives covers the error, on problems whose answer is known. They are
drawn from a seed; as dimensionless numbers make a problem, an elastic sphere is drawn once, and of the others
shape, film, law, friction and load over yield stress differ.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from sam.scene import Result, Scene, Status
from verification.cases.case import Context, DataFrame, SmallTable, with_grid, with_keys, with_loading
from verification.cases.recipes import at_ratio
from verification.quantities import QUANTITIES
from verification.reference.coated_changes import largest_mises
from verification.reference.hamilton import largest_von_mises
from verification.references import REFERENCES, coated_contact, contact_of, growing_sphere
from verification.runs.models import FEM, SAM
from verification.runs.store import solve_or_reuse
from verification.uncertainty.rule import bound, order_seen
from verification.uncertainty.solving import asked_of, solve

SEED = 20261125
DRAWS = 5  # of a problem, until its plastic zone fits the grid
KNOWN = 3.0  # times better than uncertainty or error is a reference that counts
MESHES, BOX = ((16, 24), 20.0)  # elements in the radius of a finite-element reference; 20 radii: 0.005 % off
FINER = 1.75  # times as many cells, of a reference by SAM
MORE_STEPS = (2, 4)  # times as many load steps, of a reference
FRICTION, AREA = 0.2, "contact_area_m2"
OF_PLASTIC = ("peeq_max", "approach_m", "p_max_Pa", "residual_uz_center_m", AREA)
OF_SLIDING = (*OF_PLASTIC, "p_center_Pa", "mises_max_Pa", "tangential_displacement_center_m")
OF_SLIDING += ("residual_ux_center_m", "plastic_shear_center_m")
OF_FEW = ("Hertz, sphere", "ellipsoid", "film", "misfit sphere", "yielding sphere")  # at the quick level
Truth = Mapping[str, tuple[float, float]]
"""Quantity -> its value, and the uncertainty of that."""
Draw = np.random.Generator


def textbook(entry: Mapping[str, Any]) -> float:
    """The uncertainty with, for the cells, the observed order and the factor 1.25 (Roache 1998), or order 2
    and the factor 3 where none is observed; load steps and box count as in the program.
    """
    values, sizes = entry["values"], [1.0 / count for count in entry["cells"]]
    seen = order_seen(values, sizes)
    order, factor = (2.0, 3.0) if seen is None else (seen, 1.25)
    return bound(values[:2], sizes[:2], order, factor) + entry["u_steps"] + entry["u_box"]


def rows_of(
    context: Context, problem: str, drawn: Callable[[int], Scene], truth_of: Callable[[Context, Scene], Truth]
) -> Iterator[dict[str, Any]]:
    """Every quantity with an uncertainty and a reference. A zone that leaves its grid is drawn again."""
    for number in range(DRAWS):
        scene = drawn(number)
        try:
            found = solve(asked_of(scene, problem), SAM, lambda each, _: solved(context, each, SAM))
            truth = truth_of(context, scene)
            break
        except AtEdgeError:
            if number == DRAWS - 1:
                raise
    for name, (value, doubt) in truth.items():
        entry = found.uncertainty.get(name, {})
        if entry.get("u_num") is not None:
            row = {"sweep": "", "model": "sam", "problem": problem, "quantity": name}
            yield row | judged(entry, value, doubt=doubt)


def judged(entry: Mapping[str, Any], truth: float, *, doubt: float) -> dict[str, float]:
    """Error and uncertainties over the truth, and whether it is covered; nothing of a value that does not
    count. doubt: uncertainty of the truth.
    """
    own, error = entry["u_num"], abs(entry["values"][0] - truth)
    if doubt > max(own, error) / KNOWN:
        return {}
    rules = {"uncertainty": own, "textbook": textbook(entry)}
    # they are drawn on logarithmic axes
    drawn = {name: max(value / abs(truth), 1e-9) for name, value in ({"error": error} | rules).items()}
    row = drawn | {f"covered-by-{name}": float(error <= value) for name, value in rules.items()}
    row |= {f"{name} expected": drawn["error"] for name in rules}
    return row | {"over-error": own / max(error, 1e-12 * abs(truth))}


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
    """The quantities from finer cells or elements and more load steps, extrapolated in both by their formal
    orders, and their doubt: what the extrapolation adds, of load steps a half.
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


def of_sphere(_: Context, scene: Scene) -> Truth:
    """A sphere, sliding or at rest without coupling."""
    exact, nu = contact_of(scene), scene.body.poisson
    stress = largest_von_mises(exact.peak_pressure, exact.contact_radius, nu, scene.coefficient)[0][0]
    found = of_reference(_, scene, reference="hertz-sphere", names=("p-max", "approach"))
    return {**found, "mises_max_Pa": (stress, 0.0)}


def of_reference(_: Context, scene: Scene, *, reference: str, names: Sequence[str]) -> Truth:
    """The contact area and some quantities of the vocabulary, by a reference of it."""
    answer = REFERENCES[reference](scene)
    a = answer.units["a"]
    found = {QUANTITIES[name].row: (answer.values[name], 0.0) for name in names}
    return {**found, AREA: (np.pi * a * answer.units.get("b", a), 0.0)}


def of_film(_: Context, scene: Scene) -> Truth:
    """A sphere on a coated body, by integral transforms."""
    found = of_reference(_, scene, reference="coated-sphere", names=("p-center", "approach"))
    return {**found, "mises_max_substrate_Pa": (largest_mises(coated_contact(scene)).value, 0.0)}


def of_misfit(_: Context, scene: Scene) -> Truth:
    """A misfit sphere held in an infinite body: its largest strain by the closed form."""
    radius = scene.loading.radius * np.linspace(0.5, 1.0, 4001)
    return {"peeq_max": (float(growing_sphere(scene).fields(radius).peeq.max()), 0.0)}


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
    body = sphere.body.model_dump(exclude_none=True) | {"coating": film}
    return Scene(body=body, counterbody=sphere.counterbody, loading=sphere.loading)


def _law(draw: Draw, young: float, kind: str) -> dict[str, Any]:
    """A hardening law whose yield stress is 0.3 to 1 % of Young's modulus."""
    stress = young * draw.uniform(0.003, 0.01)
    if kind == "swift":
        n = draw.uniform(0.05, 0.2)
        return {"law": kind, "B": stress / 20**n, "C": 20.0, "n": n}
    if kind == "table":
        rise = stress * np.array([1.0, *(1 + draw.uniform(0.05, 0.3, 3).cumsum())])
        return {"law": kind, "file": tuple(zip((0.0, 0.005, 0.02, 0.1), rise.tolist(), strict=True))}
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
        return Scene(**scene.model_dump(exclude_none=True) | {"counterbody": shape})
    more = {"friction": {"coefficient": friction}} if friction else {}
    return Scene(**scene.model_dump(exclude_none=True) | more) if more else scene


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


OF_ELEMENTS = partial(finer, model=FEM, names=OF_PLASTIC)
OF_CELLS = partial(finer, model=SAM, names=OF_SLIDING)
KINDS: Sequence[tuple[str, int, Callable[[Draw, int], Scene], Callable[[Context, Scene], Truth]]] = (
    ("Hertz, sphere", 1, lambda draw, _: _sphere(draw), of_sphere),
    (
        *("ellipsoid", 4, lambda draw, _: _ellipsoid(draw)),
        partial(of_reference, reference="hertz-ellipse", names=("p-max", "approach")),
    ),
    (
        *("rounded punch", 3, lambda draw, _: _rounded(draw)),
        partial(of_reference, reference="rounded-punch", names=("approach", "p-center")),
    ),
    ("sliding sphere", 2, lambda draw, _: sliding(_sphere(draw), draw.uniform(0.1, 0.4)), of_sphere),
    ("film", 6, lambda draw, _: _film(draw), of_film),
    ("misfit sphere", 3, _misfit, of_misfit),
    ("given pressure", 3, _given, OF_ELEMENTS),
    ("yielding sphere", 14, _yielding, OF_ELEMENTS),
    ("yielding, sliding", 2, lambda draw, k: _yielding(draw, k, friction=draw.uniform(0.05, 0.2)), OF_CELLS),
    ("yielding, ellipsoid", 2, lambda draw, k: _yielding(draw, k, slender=draw.uniform(1.2, 1.6)), OF_CELLS),
)
"""Kind, how many of it, how one is drawn, and its answer."""


def subjects(*, study: bool) -> Iterator[tuple[str, Callable[[int], Scene], Callable]]:
    """The forty problems, or one of some kinds: name, scene by the number of the draw, truth."""
    for place, (kind, count, make, truth) in enumerate(KINDS):
        for rank in range(count):
            if study or (rank == 0 and kind in OF_FEW):
                name = f"{kind} {rank + 1}" if count > 1 else kind
                yield name, partial(_drawn, make, (SEED, place, rank)), truth


def _drawn(make: Callable[[Draw, int], Scene], seed: tuple[int, ...], number: int) -> Scene:
    """A scene on a number of cells that is drawn too."""
    draw = np.random.default_rng((*seed, number) if number else seed)
    scene = make(draw, seed[-1])
    cells = int(draw.integers(40, 50 if scene.body.plasticity else 100))
    return with_grid(scene, cells=(cells, cells))


def both_rules(rows: DataFrame) -> SmallTable:
    """Of each kind of problem and each quantity: how many values each rule covers, and how wide it is."""
    lines, known = [], rows.dropna(subset=["over-error"])
    words = {each.row: each.words for each in QUANTITIES.values()}
    for of in (known["problem"].str.rstrip(" 0123456789"), known["quantity"].replace(words)):
        for name, own in known.groupby(of, sort=False):
            cells = [name, str(own["problem"].nunique()), str(len(own))]
            for rule in ("uncertainty", "textbook"):
                ratio = (own[rule] / own["error"]).median()
                cells += [f"{1e2 * own[f'covered-by-{rule}'].mean():.0f}", f"{ratio:.2g}"]
            lines.append(cells)
    columns = "kind of problem, or quantity|problems|values that count|covered [%]|median U/error"
    columns += "|textbook rule: covered [%]|median U/error"
    return SmallTable("Both rules, by kind of problem and by quantity", columns.split("|"), lines)


LEAST = 3  # values of a quantity with a median of its own


def frame(context: Context) -> Iterator[dict[str, Any]]:
    """Each problem is solved as with --uncertainty, and set against a closed form or finer solves."""
    for subject in subjects(study=context.case == "uncertainty-study"):
        yield from rows_of(context, *subject)


def medians(rows: DataFrame, column: str) -> Sequence[float]:
    """Of the quantities that have enough values."""
    groups = rows[column].groupby(rows["quantity"])
    return groups.median()[groups.count() >= LEAST]


def smallest_median(rows: DataFrame, column: str) -> float:
    """Of the medians of the quantities."""
    return min(medians(rows, column))


def largest_median(rows: DataFrame, column: str) -> float:
    """Of those of the quantities other than the contact area."""
    return max(medians(rows[rows["quantity"] != AREA], column))


def problems(rows: DataFrame, column: str) -> float:
    """Those that have a value that counts."""
    return float(rows[rows[column].notna()]["problem"].nunique())
