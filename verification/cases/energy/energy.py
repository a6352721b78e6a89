# SPDX-License-Identifier: MIT
"""The work of the surface tractions is what is stored and dissipated, in both models, over loading and
unloading.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial

from sam.scene import Friction, Scene
from verification.cases.case import (
    FEM,
    FEM_3D,
    Case,
    Context,
    Measured,
    Plot,
    SmallTable,
    number,
    with_body,
    with_loading,
    with_mesh,
)
from verification.cases.energy.energy_measures import (
    Ladder,
    compared_gates,
    cycle_gates,
    fem_gates,
    of_cells,
    of_steps,
    of_stress_within,
    sam_gates,
)
from verification.cases.recipes import Resolution, at_ratio, resolved_at
from verification.energy import of_fem, of_sam
from verification.energy.balance import Balance
from verification.figures.energy import over_path
from verification.references import contact_of

RATIO, FRICTION = 4.0, 0.2
STEPS = (6, 12, 24)  # of the loading; the first for all grids, the coarsest grid for all of them
CELLS = {"quick": (5, 7, 10), "full": (6, 10, 14)}
ELEMENTS = {FEM: 16, FEM_3D: 6}
# Of a pressure in place, over the yield stress: 1.5 times Melan's limit for Prager's back-stress. Its modulus
# in Pa: with a tenth of it the mean strain settles for longer.
ALTERNATING, MODULUS, YIELD = 4.84, 150e9, 1e9
IN_RADIUS = {"SAM": 5, FEM: 3}  # cells or elements in the radius of that pressure
COLUMNS = (
    "contact",
    "model",
    "resolution",
    "steps",
    "work [nJ]",
    "stored",
    "locked",
    "dissipated",
    "error of cells",
    "of steps",
    "within cells",
)


@dataclass(frozen=True)
class YieldingContact:
    """A sphere that yields. scene: its file."""

    title: str
    scene: str
    friction: float = 0.0


CONTACTS = {
    "perfect": YieldingContact("perfectly plastic", "plastic-perfect"),
    "steel": YieldingContact("Swift steel", "plastic-swift-rigid"),
    "sliding": YieldingContact(f"Swift steel, μ = {FRICTION:g}", "plastic-swift-rigid", FRICTION),
}


@dataclass
class BalanceSolver:
    """Solves contacts of a case, each balance once, and keeps the rows of the table. a: the elastic contact
    radius.
    """

    context: Context
    rows: list[tuple[str, ...]] = field(default_factory=list)

    @property
    def cells(self) -> tuple[int, ...]:
        """SAM's in a."""
        return CELLS[self.context.level]

    def sam(self, name: str, cells: int, steps: int = STEPS[0]) -> Balance:
        """The balance of SAM on cells of a/cells."""
        return self._solved(name, "SAM", cells, steps, balance=of_sam.balance_of)

    def fem(self, name: str, steps: int = STEPS[0], model: str = FEM) -> Balance:
        """The balance of a finite-element model."""
        return self._solved(
            name, model, ELEMENTS[model], steps, balance=partial(of_fem.balance_of, model=model)
        )

    def sam_ladders(self, name: str) -> tuple[Ladder, Ladder]:
        """By cells with the fewest steps, and by steps on the coarsest grid."""
        by_cells = {n: self.sam(name, n) for n in self.cells}
        first = self.cells[0]
        return by_cells, {STEPS[0]: by_cells[first]} | {n: self.sam(name, first, n) for n in STEPS[1:]}

    def fem_ladder(self, name: str) -> Ladder:
        """By steps."""
        return {n: self.fem(name, n) for n in STEPS}

    def cycles(self, model: str) -> Ladder:
        """By steps, of a body that alternates."""
        out, size = {}, IN_RADIUS[model]
        for steps in STEPS:
            self.context.progress(f"{self.context.case}, alternating: {model}, {steps} steps", 1, 1)
            scene = alternating(steps, size)
            out[steps] = of_sam.balance_of(scene) if model == "SAM" else of_fem.balance_of(scene, model)
            self.rows.append(row("alternating, Prager", model, size, out[steps]))
        return out

    def solved(self, values: dict[str, Measured], panels: dict) -> EnergyBalances:
        """What the parts of a case look at."""
        return EnergyBalances(values, self.rows, panels, self.cells)

    def _solved(
        self, name: str, model: str, size: int, steps: int, *, balance: Callable[[Scene], Balance]
    ) -> Balance:
        self.context.progress(f"{self.context.case}, {name}: {model}, a/{size}, {steps} steps", 1, 1)
        found = balance(scene_of(self.context, CONTACTS[name], steps, size))
        self.rows.append(row(CONTACTS[name].title, model, size, found))
        return found


def scene_of(context: Context, contact: YieldingContact, steps: int, size: int) -> Scene:
    """Loaded to RATIO times the yield stress in `steps`, and unloaded; cells or elements of a/size."""
    scene = with_loading(at_ratio(context.scene(contact.scene), RATIO), steps=steps, unload=True)
    scene = resolved_at(scene, Resolution(size, size))
    friction = Friction(coefficient=contact.friction) if contact.friction else scene.friction
    return scene.model_copy(update={"friction": friction})


def alternating(steps: int, size: int, radius: float = 10e-6) -> Scene:
    """A given pressure that comes and goes three times, on cells or elements of radius/size; perfect
    plasticity with Prager's back-stress.
    """
    plasticity = {"law": "perfect", "yield_stress": YIELD, "kinematic": {"modulus": (MODULUS,)}}
    pressure = {"prescribed": "hertz", "p0": ALTERNATING * YIELD, "radius": radius}
    side, count = 5 * radius, 5 * size
    return Scene(
        body={"young": 210e9, "poisson": 0.3, "plasticity": plasticity},
        loading={**pressure, "steps": steps, "unload": True, "cycles": 3},
        grid={"cells": (count, count), "extent": (side, side), "layers": 4 * size, "depth": 3.4 * radius},
        fem={"cells_per_radius": size, "box": 6.0},
        solver={"tolerance": 1e-4},
    )


@dataclass(frozen=True)
class EnergyBalances:
    """values: of the gates; rows: of the table; panels: title -> balances of SAM and FEM; cells: SAM's in
    a.
    """

    values: dict[str, Measured]
    rows: list[tuple[str, ...]]
    panels: dict[str, tuple[Balance, Balance | None]]
    cells: tuple[int, ...]


class Energy(Case):
    """Elastic contacts to rounding; yielding ones on ladders of cells and steps, one of them also by FEM."""

    def solve(self, context: Context) -> EnergyBalances:
        solver = BalanceSolver(context)
        values = _elastic(context, solver.rows)
        perfect, sliding = solver.sam_ladders("perfect"), solver.sam_ladders("sliding")
        finest, fem = perfect[0][max(solver.cells)], solver.fem("perfect")
        values |= _named("perfect", sam_gates(*perfect, 0.0) | compared_gates(finest, fem))
        values |= _named("sliding", sam_gates(*sliding, FRICTION))
        panels = {"perfect": (finest, fem), "sliding": (sliding[0][max(solver.cells)], None)}
        return solver.solved(values, panels)

    def measure(self, found: EnergyBalances) -> dict[str, Measured]:
        return found.values

    def setup(self, found: EnergyBalances) -> list[tuple[str, str]]:
        return [
            (
                "Contacts",
                f"rigid sphere, p₀ = {RATIO:g} σ_y0 of the elastic contact, loaded in equal steps and "
                "unloaded",
            ),
            ("SAM", f"{', '.join(map(str, found.cells))} cells in the elastic contact radius a"),
            ("FEM", f"{ELEMENTS[FEM]} elements in a; {ELEMENTS[FEM_3D]} in space"),
            ("Steps", f"{', '.join(map(str, STEPS))} to the peak"),
        ]

    def tables(self, found: EnergyBalances) -> Iterator[SmallTable]:
        yield SmallTable(
            (
                "Shares of the work at the peak (locked: stored as cold work, and dissipated, after "
                "unloading); largest errors over the path"
            ),
            COLUMNS,
            found.rows,
        )

    def notes(self, found: EnergyBalances) -> Iterator[str]:
        yield (
            "The error of the cells is W − E − D with both integrals over the path summed by the trapezoidal "
            "rule. It closes at any number of steps where the discrete operators are reciprocal, as finite "
            "elements are by construction; in SAM it is the distance of the displacement at a cell's centre "
            "from the mean over the cell. The error of the steps is what that D lacks of the work of the "
            "yield stress, which depends on the plastic strain reached alone. Within cells is the plastic "
            "work of stresses that vary over a cell of SAM, whose law is fulfilled at four points; the "
            "tractions do not do it, as the operators take the strain of a cell as uniform. Back-stresses "
            "store a part of the plastic work, and give it back."
        )

    def figures(self, found: EnergyBalances) -> Iterator[Plot]:
        yield Plot(
            over_path({CONTACTS[name].title: pair for name, pair in found.panels.items()}),
            "path",
            "Energy over the load path",
            "Stacked areas of dissipated, stored and recoverable energy, and the work of the tractions on "
            "top of them.",
            "Work of the tractions (line) and where it is (areas), SAM on its finest grid; crosses: FEM. "
            "After unloading the work that was not given back is dissipated or stored by residual stress.",
        )


class EnergyFem(Energy):
    """The finite-element models on the ladder of steps, and against SAM on steel, at rest and sliding; in
    both a cycle of a body with back-stresses.
    """

    def solve(self, context: Context) -> EnergyBalances:
        solver = BalanceSolver(context)
        values = _named("perfect", fem_gates(solver.fem_ladder("perfect")))
        steel, fem = solver.sam_ladders("steel"), solver.fem_ladder("steel")
        finest, same = steel[0][max(solver.cells)], fem[STEPS[0]]
        values |= _named("steel", sam_gates(*steel, 0.0) | fem_gates(fem) | compared_gates(finest, same))
        sliding, spatial = solver.sam("sliding", max(solver.cells)), solver.fem("sliding", model=FEM_3D)
        values |= _named("sliding", compared_gates(sliding, spatial))
        for name, model in (("sam", "SAM"), ("fem", FEM)):
            values |= _named(f"alternating-{name}", cycle_gates(solver.cycles(model)))
        return solver.solved(values, {"steel": (finest, same), "sliding": (sliding, spatial)})


def _named(contact: str, values: dict[str, Measured]) -> dict[str, Measured]:
    """The gates of a contact, led by its name."""
    return {f"{contact}-{gate}": value for gate, value in values.items()}


def _elastic(context: Context, rows: list) -> dict[str, Measured]:
    """Nothing is dissipated: at rest the work is 2/5 F delta of Hertz, sliding the couplings have to be
    reciprocal.
    """
    cells = max(CELLS[context.level])
    at_rest, sliding = (
        with_body(scene_of(context, CONTACTS[name], STEPS[0], cells), plasticity=None)
        for name in ("perfect", "sliding")
    )
    found = {
        "rest": of_sam.balance_of(at_rest),
        "sliding": of_sam.balance_of(sliding),
        "fem": of_fem.balance_of(with_mesh(at_rest, ELEMENTS[FEM]), FEM),
    }
    values = {f"elastic-{name}": Measured(of_cells(one)) for name, one in found.items()}
    exact = contact_of(at_rest)
    hertz = 2 / 5 * exact.force * exact.approach
    for name, one in (("sam", found["rest"]), ("fem", found["fem"])):
        values[f"elastic-{name}-work"] = Measured(one.work[one.peak], hertz, unit="J")
    rows += [
        row(f"elastic, μ = {FRICTION * (name == 'sliding'):g}", "SAM", cells, found[name])
        for name in ("rest", "sliding")
    ]
    rows.append(row("elastic, μ = 0", FEM, ELEMENTS[FEM], found["fem"]))
    return values


def row(contact: str, model: str, size: int, one: Balance) -> tuple[str, ...]:
    """Of the table."""
    k = one.peak
    shares = (one.elastic[k] + one.beyond[k], one.elastic[-1], one.dissipated[-1])
    percent = (f"{1e2 * each / one.work[k]:.2f} %" for each in shares)
    errors = (number(each(one), 2) for each in (of_cells, of_steps, of_stress_within))
    return contact, model, f"a/{size}", f"{k}", f"{one.work[k] * 1e9:.5g}", *percent, *errors


CASES = (
    Energy("energy"),
    EnergyFem("energy-fem"),
)
