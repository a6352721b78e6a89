# SPDX-License-Identifier: MIT
"""A Hertz pressure that comes and goes on a body with back-stresses: Melan's limit, and SAM against finite
elements over many cycles, with the verdict of both.

Perfect plasticity with Prager's back-stress shakes down exactly where the elastic stress deviators of the
cycle lie in a ball of the yield stress (Melan). Pressed in place the path is a chord: the limit is twice the
load of first yield, 2 * 1.6128 yield stresses for nu = 0.3, wherever the body yields first.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np

from sam.scene import Body, Grid, Loading, Plasticity, Result, Scene, Solver
from verification.cases.case import FEM, SAM, Case, Context, Measured, Plot, SmallTable
from verification.figures.friction import Curve, curves
from verification.reference.hertz import subsurface_stress
from verification.reference.stress import von_mises
from verification.runs.sampling import rows_of

YOUNG, POISSON, YIELD, RADIUS = 210e9, 0.3, 1e9, 1e-5
REACH, DEEP, BOX = 1.6, 2.0, 8.0  # contact radii: half a side and depth of the grid; of the mesh
LAWS = {
    "prager": {"modulus": (YOUNG / 19,), "recovery": (0.0,)},
    "chaboche": {"modulus": (400e9, 60e9, 6e9), "recovery": (2000.0, 300.0, 0.0)},
}
TITLES = {"prager": "Prager's law", "chaboche": "three back-stresses"}
P0 = {"prager": 3.4e9, "chaboche": 4e9}
BELOW_YIELD, BELOW_MELAN = 1.6e9, 3.1e9
STEPS = 6  # of loading, and of unloading
FLOOR = 1e-3  # of the yield strain: strain below which a cycle counts as without
TOLERANCE = FLOOR / (4 * 2 * STEPS)
COMPARED = 0.2, 1.2  # depths in a: below the first coarse cell, and where elements are even
VARIED = {"floor-10": 10.0, "floor-0.1": 0.1}
AFTER = {"prager": 6, "chaboche": 8}  # cycles after which the class stays: with more back-stresses later


@dataclass(frozen=True)
class Sizes:
    """In the contact radius, cells of SAM and elements of FEM; cycles: how many."""

    cells: tuple[int, ...]
    elements: tuple[int, ...]
    cycles: int


SIZES = {"quick": Sizes((9,), (8,), 5), "full": Sizes((12,), (12,), 12)}
NESTED = Sizes((5, 15), (5, 15), 12)
"""A coarse cell or element holds three fine ones in depth: nothing is interpolated."""


def pressed(law: str, p0: float, size: int, cycles: int, *, steps: int = STEPS, floor: float = 1.0) -> Scene:
    """The scene with cells and elements of a/size; floor: factor of it."""
    h = RADIUS / size
    across = 2 * round(REACH * size) + 1
    return Scene(
        title=f"Repeated loading, {law}",
        body=Body(
            young=YOUNG,
            poisson=POISSON,
            plasticity=Plasticity(law="perfect", yield_stress=YIELD, kinematic=LAWS[law]),
        ),
        loading=Loading(prescribed="hertz", p0=p0, radius=RADIUS, steps=steps, unload=True, cycles=cycles),
        grid=Grid(
            cells=(across, across),
            extent=(across * h, across * h),
            depths=tuple(h * np.arange(round(DEEP * size) + 1)),
        ),
        fem={"cells_per_radius": size, "box": BOX},
        solver=Solver(tolerance=TOLERANCE * floor * STEPS / steps),
    )


@dataclass(frozen=True)
class Both:
    """One law and number of steps: SAM and FEM by their cells or elements in the contact radius."""

    sam: Mapping[int, Result]
    fem: Mapping[int, Result]

    @property
    def finest(self) -> tuple[Result, Result]:
        """SAM and FEM on their finest cells and elements."""
        return self.sam[max(self.sam)], self.fem[max(self.fem)]

    def profiles(self) -> tuple[np.ndarray, dict[str, tuple[np.ndarray, np.ndarray]]]:
        """Depths in a, centres of the coarse cells, and by quantity SAM and FEM, unloaded after the last
        cycle: means over the depth of a coarse cell, extrapolated in the cells.
        """
        found = {}
        for name, part in (("peeq", ()), ("plastic_strain", (2,))):
            (z, sam), (_, fem) = (limit_over_depth(runs, name, *part) for runs in (self.sam, self.fem))
            found[name] = sam, fem
        return z, found

    def other_classes(self) -> int:
        """Fine cells on the axis of which FEM has another class, not beside one where the class changes."""
        (z, sam), (_, fem) = (on_axis(run, "class") for run in self.finest)
        inside = np.flatnonzero((z >= COMPARED[0]) & (z <= COMPARED[1]))
        about = [[{*found[k - 1 : k + 2]} for found in (sam, fem)] for k in inside]
        return sum(one != other for one, other in about if len(one) == len(other) == 1)


def limit_over_depth(runs: Mapping[int, Result], name: str, *part: int) -> tuple[np.ndarray, np.ndarray]:
    """z/a of coarse cells, and means over their depth of a field, extrapolated from two sizes."""
    sizes, means = sorted(runs), []
    for size in sizes:
        z, values = on_axis(runs[size], name, *part)
        count, each = int(COMPARED[1] * sizes[0]), size // sizes[0]
        means.append([of[: count * each].reshape(-1, each).mean(axis=1) for of in (z, values)])
    (z, coarse), (_, fine) = means
    use = z > COMPARED[0]
    return z[use], extrapolated(coarse, fine, *sizes)[use]


def extrapolated(coarse: np.ndarray, fine: np.ndarray, n: int, m: int) -> np.ndarray:
    """The limit of values that err with the square of the cells a/n and a/m."""
    return fine + (fine - coarse) / ((m / n) ** 2 - 1)


def solve_both(context: Context, law: str, at: Sizes, steps: int = STEPS) -> Both:
    """A law by both models."""
    scene, name = partial(pressed, law, P0[law], cycles=at.cycles, steps=steps), f"{law}-{steps}"
    return Both(
        *(
            {size: context.solve(model, scene(size), f"{label}-{name}-{size}") for size in sizes}
            for label, model, sizes in (("sam", SAM, at.cells), ("fem", FEM, at.elements))
        )
    )


def on_axis(result: Result, name: str, *part: int) -> tuple[np.ndarray, np.ndarray]:
    """z/a and a field, unloaded after the last cycle: at nodes of SAM's mesh, in elements beside the axis."""
    fields = result.fields
    if name in fields.point_data:
        points, values = fields.points, np.asarray(fields.point_data[name], dtype=float)
    else:
        points = fields.points[fields.cells["quad"]].mean(axis=1)
        values = np.asarray(fields.cell_data[name], dtype=float)
    values = values[:, part[0]] if part else values
    r = np.where(np.isfinite(values), np.abs(points[:, 0]), np.inf)
    use = r <= r.min() + 1e-6 * RADIUS
    order = np.argsort(points[use, 2])
    return points[use, 2][order] / RADIUS, values[use][order]


def reverse_flow(result: Result) -> tuple[np.ndarray, np.ndarray]:
    """z/a and the accumulated strain of the last unloading on the axis."""
    z, peak = rows_of(result.tables["axis"], "peak", "z_m", "peeq")
    return z / RADIUS, rows_of(result.tables["axis"], "unloaded", "peeq")[0] - peak


def steps_of(result: Result, name: str = "peeq_step_max") -> np.ndarray:
    """A column of the table cycles."""
    return np.array(result.tables["cycles"][name], dtype=float)


@dataclass(frozen=True)
class Found:
    """below: largest strain below first yield; shaken: below Melan's limit; pairs: of each law."""

    below: Result
    shaken: Result
    pairs: Mapping[str, Both]


class RepeatedLoading(Case):
    """Prager's law on either side of Melan's limit; it and Chaboche's against finite elements."""

    def solve(self, context: Context) -> Found:
        at = SIZES[context.level]
        prager = {p0: pressed("prager", p0, at.cells[0], at.cycles) for p0 in (BELOW_YIELD, BELOW_MELAN)}
        return Found(
            context.solve(SAM, prager[BELOW_YIELD], "below-yield"),
            context.solve(SAM, prager[BELOW_MELAN], "below-melan"),
            {law: solve_both(context, law, at) for law in LAWS},
        )

    def measure(self, found: Found) -> dict[str, Measured | float]:
        values = {
            "below-yield": Measured(found.below.quantities["peeq_max"], 0.0),
            "below-melan": Measured(float(steps_of(found.shaken)[1:].max()), 0.0),
        }
        beyond, (top, ends) = found.pairs["prager"], where_beyond(P0["prager"])
        for model, result in zip(("sam", "fem"), beyond.finest, strict=True):
            z, flow = reverse_flow(result)
            h = np.diff(z).max()
            outside = (z < ends[0] - h) | (z > ends[1] + h)
            strain = steps_of(result, "strain_step_max")
            values |= {
                f"{model}-depth": Measured(float((z * flow).sum() / flow.sum()), top),
                f"{model}-elsewhere": Measured(float(np.abs(flow[outside]).max()), 0.0),
                f"{model}-closes": float(strain[-1] / strain[1]),
                f"{model}-alternates": Measured(float(result.verdict["class"] == "alternating"), 1.0),
            }
        for law, both in found.pairs.items():
            sam, fem = (run.verdict["class"] for run in both.finest)
            values[f"{law}-class"] = Measured(float(sam == fem), 1.0)
        return values

    def setup(self, found: Found) -> list[tuple[str, str]]:
        some = found.pairs["prager"]
        return [
            (
                "Body",
                f"E = {YOUNG / 1e9:g} GPa, ν = {POISSON:g}, σ_y = {YIELD / 1e9:g} GPa, no other hardening",
            ),
            *((law, f"{constants_text(law)}; p₀ = {P0[law] / 1e9:g} GPa") for law in LAWS),
            ("Load", f"p = p₀ √(1 − r²/a²), given, {STEPS} steps up and {STEPS} down"),
            ("Cycles", str(len(steps_of(some.finest[0])))),
            ("Cells", f"a/{max(some.sam)}"),
            ("Elements", f"a/{max(some.fem)}"),
        ]

    def tables(self, found: Found) -> Iterator[SmallTable]:
        rows = [
            (law, name, *(f"{1e2 * steps_of(each)[k]:.4f}" for k in (0, 1, 3, -1)), each.verdict["class"])
            for law, both in found.pairs.items()
            for name, each in zip(("SAM", "FEM"), both.finest, strict=True)
        ]
        cycles = "cycle 1", "cycle 2", "cycle 4", "last cycle"
        yield SmallTable(
            "Strain that a cycle adds in %, and the verdict", ("law", "model", *cycles, ""), rows
        )


def where_beyond(p0: float) -> tuple[float, tuple[float, float]]:
    """Depths in a on the axis: of the largest elastic stress, and between which it exceeds twice the yield
    stress.
    """
    z = np.linspace(0.0, DEEP, 4001)
    stress = subsurface_stress(0.0, 0.0, z, p0, contact_radius=1.0, nu=POISSON)
    mises = von_mises(stress)
    beyond = z[mises > 2 * YIELD]
    return float(z[mises.argmax()]), (float(beyond[0]), float(beyond[-1]))


def differences(*profiles: tuple[str, tuple[np.ndarray, np.ndarray]]) -> Iterator[tuple[str, float]]:
    """Quantity and its largest difference over the largest value."""
    for name, (sam, fem) in profiles:
        yield name, float(np.abs(sam - fem).max() / np.abs(fem).max())


def spelt(name: str) -> str:
    """A field in the id of a gate."""
    return name.replace("_", "-")


def constants_text(law: str) -> str:
    """Constants of a law for the reader."""
    pairs = zip(*LAWS[law].values(), strict=True)
    return "; ".join(f"C = {c / 1e9:.4g} GPa, g = {g:g}" for c, g in pairs)


@dataclass(frozen=True)
class Kept:
    """pairs: law -> by the number of steps; varied: law -> runs of SAM with another floor."""

    pairs: Mapping[str, Mapping[int, Both]]
    varied: Mapping[str, Mapping[str, Result]]


class KeptVerdict(Case):
    """The same with steps doubled, and with another tolerance, which sets the floor of the verdict."""

    def solve(self, context: Context) -> Kept:
        at = NESTED
        return Kept(
            {law: {n: solve_both(context, law, at, n) for n in (STEPS, 2 * STEPS)} for law in LAWS},
            {
                law: {
                    name: context.solve(
                        SAM, pressed(law, P0[law], at.cells[0], at.cycles, floor=factor), f"{law}-{name}"
                    )
                    for name, factor in VARIED.items()
                }
                for law in LAWS
            },
        )

    def measure(self, found: Kept) -> dict[str, Measured | float]:
        values: dict[str, Measured | float] = {}
        for law, by_steps in found.pairs.items():
            first, second = (by_steps[n].profiles()[1] for n in sorted(by_steps))
            values |= {f"{law}-{spelt(name)}": off for name, off in differences(*first.items())}
            limits = {
                name: tuple(2 * fine - coarse for coarse, fine in zip(first[name], second[name], strict=True))
                for name in first
            }
            values |= {f"{law}-{spelt(name)}-limit": off for name, off in differences(*limits.items())}
            values[f"{law}-cells"] = Measured(float(by_steps[STEPS].other_classes()), 0.0)
            runs = [run for both in by_steps.values() for run in (*both.sam.values(), *both.fem.values())]
            runs += found.varied[law].values()
            classes = {name for run in runs for name in run.tables["cycles"]["verdict"][AFTER[law] - 1 :]}
            values[f"{law}-classes"] = Measured(float(len(classes)), 1.0)
        return values

    def tables(self, found: Kept) -> Iterator[SmallTable]:
        rows = [
            (law, str(n), name, f"{1e2 * steps_of(run)[-1]:.4f}", run.verdict["class"], since(run))
            for law, by_steps in found.pairs.items()
            for n, both in by_steps.items()
            for name, run in zip(("SAM", "FEM"), both.finest, strict=True)
        ]
        rows += [
            (
                law,
                str(STEPS),
                f"SAM, {name}",
                f"{1e2 * steps_of(run)[-1]:.4f}",
                run.verdict["class"],
                since(run),
            )
            for law, runs in found.varied.items()
            for name, run in runs.items()
        ]
        columns = "law", "steps", "model", "strain of the last cycle [%]", "verdict", "since cycle"
        yield SmallTable("Steps, floor and verdict", columns, rows)

    def figures(self, found: Kept) -> Iterator[Plot]:
        panels = {}
        for law, by_steps in found.pairs.items():
            both = by_steps[STEPS]
            z, by_name = both.profiles()
            sam, fem = (Curve(z, 1e2 * each) for each in by_name["peeq"])
            panels[TITLES[law]] = {"FEM": fem, "SAM": sam}
        yield Plot(
            curves(panels, "$z/a$", "accumulated plastic strain [%]"),
            "depth",
            "Plastic strain over depth after the last cycle",
            "Accumulated plastic strain on the axis over depth for two laws: the marks of SAM lie on the "
            "curves of FEM.",
            f"Means over a/{NESTED.cells[0]} in depth, extrapolated in cells and in elements.",
        )


def since(run: Result) -> str:
    """The cycle since which the verdict is the same."""
    return str(run.verdict["decided_at_cycle"])


MELAN = (
    "Melan's limit",
    "shakedown where max |s(t) − s₀| ≤ √(2/3) σ_y for some s₀; in place p₀ = 3.2256 σ_y",
    "Melan, Ing.-Arch. 9 (1938) 116-126; Johnson (1985), section 9.1",
)
CHABOCHE = (
    "Back-stresses",
    "dX_k = 2/3 C_k dε_p − g_k X_k dp; g_k = 0: Prager",
    "Armstrong & Frederick, CEGB RD/B/N731 (1966); Chaboche, Int. J. Plast. 2 (1986) 149-188",
)

CASES = (
    RepeatedLoading("repeated-loading"),
    KeptVerdict("repeated-loading-kept"),
)
