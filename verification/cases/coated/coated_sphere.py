# SPDX-License-Identifier: MIT
"""A sphere on a coated half-space: SAM and FEM against a spectral solution of the contact."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from sam.scene import Result, Scene
from verification.cases.case import FEM, SAM, Case, Context, Plot, SmallTable
from verification.cases.hertz.hertz import stress_panels
from verification.cases.recipes import COUNTERBODIES, coated_scene, resolved_grid
from verification.figures.coated import Pressures, film_planes, film_pressures
from verification.figures.profiles import Profile, profiles
from verification.reference.coated_changes import largest_bare_mises, largest_mises, pressure_change
from verification.reference.coated_sphere import CoatedContact
from verification.references import coated_contact, contact_of
from verification.runs.sampling import peak, pressure_map

MODELS = ("SAM", "FEM")
RATIOS = (80 / 210, 2.0)
THICKNESSES = (0.1, 0.5, 1.0, 2.0)
"""Over the contact radius without film."""
QUICK = ((80 / 210, 0.1, "rigid"), (2.0, 0.5, "steel"))
"""(E1/E2, thickness, counter-body) of the quick level, which are drawn at both."""
CELLS_IN_RADIUS = 48
QUANTITIES = {
    "center": "p(0)",
    "approach": "approach",
    "radius": "radius",
    "pressure": "pressure, L2",
    "mises-body": "σvM body",
    "mises-film": "σvM film",
    "p-change": "change of p",
    "mises-change": "change of σvM",
}
CHANGES = ("p-change", "mises-change")
"""Differences of two shares; all others are relative errors."""


@dataclass(frozen=True)
class Answer:
    """The spectral solution and what follows from it; von Mises stresses in Pa, in the body at z >=
    thickness.
    """

    contact: CoatedContact

    @cached_property
    def mises_body(self) -> float:
        """The largest von Mises stress of the body in Pa."""
        return largest_mises(self.contact).value

    @cached_property
    def mises_film(self) -> float:
        """The largest von Mises stress of the film in Pa."""
        return largest_mises(self.contact, film=True).value

    @cached_property
    def changes(self) -> tuple[float, float]:
        """Of the largest pressure and of the largest von Mises stress in the body."""
        return pressure_change(self.contact), self.mises_body / largest_bare_mises(self.contact).value - 1.0


def answer_of(scene: Scene) -> Answer:
    """The independent answer of a scene with a sphere and a coating."""
    return Answer(coated_contact(scene))


def errors(result: Result, answer: Answer) -> dict[str, float]:
    """Of one model against the answer, by the names of QUANTITIES."""
    found, contact = result.quantities, answer.contact
    pairs = {
        "center": (found["p_center_Pa"], contact.central_pressure),
        "approach": (found["approach_m"], contact.approach),
        "radius": (found["contact_radius_m"], contact.contact_radius),
        "mises-body": (found["mises_max_substrate_Pa"], answer.mises_body),
        "mises-film": (found["mises_max_film_Pa"], answer.mises_film),
    }
    relative = {name: abs(value / exact - 1.0) for name, (value, exact) in pairs.items()}
    own = found["p_max_change"], found["mises_max_change"]
    differences = {name: abs(a - b) for name, a, b in zip(CHANGES, own, answer.changes, strict=True)}
    return {**relative, "pressure": pressure_error(result, contact), **differences}


def pressure_error(result: Result, contact: CoatedContact) -> float:
    """Relative L2 over the cells of SAM, or over the surface nodes of FEM with the area 2 pi r dr of each."""
    if result.model == SAM:
        x, y, p = pressure_map(result)
        exact, weight = contact.pressure(np.hypot(x[:, None], y[None, :])), 1.0
    else:
        r, p = peak(result.tables["line"], "x_m", "p_Pa")
        exact, weight = contact.pressure(r), r * np.gradient(r)
    return float(np.sqrt(np.sum(weight * (p - exact) ** 2) / np.sum(weight * exact**2)))


@dataclass(frozen=True)
class SolvedSphere:
    """One film, in contact radii without it, by both models and in the spectral solution."""

    ratio: float
    thickness: float
    counterbody: str
    scene: Scene
    answer: Answer
    models: dict[str, Result] = field(default_factory=dict)

    @property
    def words(self) -> str:
        """The film and the counter-body for the reader."""
        return f"E₁/E₂ = {self.ratio:.3g}, h/a₀ = {self.thickness:g}, {self.counterbody}"

    @property
    def label(self) -> str:
        """For names of files."""
        return f"{self.ratio:.3g}-{self.thickness:g}-{self.counterbody}".replace(".", "-")

    @cached_property
    def errors(self) -> dict[str, dict[str, float]]:
        """Model -> quantity -> error."""
        return {name: errors(result, self.answer) for name, result in self.models.items()}


def films(level: str) -> list[tuple[float, float, str]]:
    """(E1/E2, thickness, counter-body) of a level."""
    if level == "quick":
        return list(QUICK)
    return [(ratio, h, other) for ratio in RATIOS for other in COUNTERBODIES for h in THICKNESSES]


@dataclass(frozen=True)
class SphereFilms:
    """base: the scene that is varied; solved: its films; shown: those whose stresses are drawn."""

    base: Scene
    solved: list[SolvedSphere]
    shown: Sequence[tuple[float, float, str]]


class CoatedSphere(Case):
    """Every film in both models against the spectral solution."""

    def solve(self, context: Context) -> SphereFilms:
        base, solved = context.scene("coated-sphere"), []
        for film in films(context.level):
            scene = coated_scene(base, *film)
            one = SolvedSphere(*film, scene, answer_of(scene))
            one.models["SAM"] = context.solve(
                SAM, resolved_grid(scene, one.answer.contact), f"sam-{one.label}"
            )
            one.models["FEM"] = context.solve(FEM, scene, f"fem-{one.label}")
            solved.append(one)
        return SphereFilms(base, solved, QUICK[:1] if context.level == "quick" else QUICK)

    def measure(self, found: SphereFilms) -> dict[str, float]:
        worst = {
            f"{model.lower()}-{name}": max(each.errors[model][name] for each in found.solved)
            for model in MODELS
            for name in QUANTITIES
        }
        return worst | {"reference": max(each.answer.contact.residual() for each in found.solved)}

    def setup(self, found: SphereFilms) -> list[tuple[str, str]]:
        base, body = found.base, found.base.body
        radius = f"{contact_of(base).contact_radius * 1e6:.4f} µm"
        cells = "{} × {}".format(*found.solved[0].models["SAM"].discretisation["cells"])
        return [
            (
                "Half-space",
                f"E₂ = {body.young / 1e9:g} GPa, ν = {body.poisson:g}; film ν = {body.coating.poisson:g}",
            ),
            (
                "Sphere",
                f"R = {base.counterbody.radius * 1e6:g} µm, rigid or as the half-space; "
                f"{base.loading.force:g} N",
            ),
            ("Contact radius a₀ without film", f"{radius} under the rigid sphere"),
            ("SAM", f"{CELLS_IN_RADIUS} cells in the contact radius, {cells} and more; default depths"),
            ("FEM", f"{base.fem.cells_per_radius} elements in the contact radius, box {base.fem.box:g} a₀"),
        ]

    def tables(self, found: SphereFilms) -> list[SmallTable]:
        return [answer_table(found.solved), *(error_table(model, found.solved) for model in MODELS)]

    def figures(self, found: SphereFilms) -> Iterator[Plot]:
        panels: dict[str, list] = {}
        for each in found.solved:
            panels.setdefault(f"$E_1/E_2$ = {each.ratio:.3g}, {each.counterbody}", []).append(pressures(each))
        yield Plot(
            film_pressures(panels),
            "pressure",
            "Contact pressure with and without film",
            "Curves of the pressure over the radius for each film thickness, with the points of SAM and FEM "
            "on them: a soft film lowers and widens the pressure, a stiff one raises and narrows it.",
            "Lines: spectral solution. Every fourth cell of SAM along y = 0 and every fourth node of FEM.",
        )
        for each in found.solved:
            if (each.ratio, each.thickness, each.counterbody) in found.shown:
                yield axis_plot(each)
                yield plane_plot(each)


def answer_table(solved: Sequence[SolvedSphere]) -> SmallTable:
    """What the film changes in the spectral solution."""
    rows = []
    for each in solved:
        contact, bare = each.answer.contact, each.answer.contact.bare
        ratios = (
            contact.central_pressure / bare.peak_pressure,
            contact.largest_pressure()[0] / bare.peak_pressure,
            contact.contact_radius / bare.contact_radius,
            contact.approach / bare.approach,
        )
        changes = (f"{100 * c:+.2f} %" for c in each.answer.changes)
        rows.append((each.words, *(f"{ratio:.5f}" for ratio in ratios), *changes))
    return SmallTable(
        ("The spectral solution, over the contact without film at the same force"),
        (
            "film and counter-body",
            *("p(0)/p₀", "p_max/p₀", "a/a₀", "δ/δ₀", "change of p_max", "change of σvM, body"),
        ),
        rows,
    )


def error_table(model: str, solved: Sequence[SolvedSphere]) -> SmallTable:
    """The errors of a model under every film."""
    return SmallTable(
        (f"Errors of {model} against the spectral solution in %, of changes in percentage points"),
        ("film and counter-body", *QUANTITIES.values()),
        [(each.words, *(f"{100 * each.errors[model][name]:.3f}" for name in QUANTITIES)) for each in solved],
    )


def axis_plot(each: SolvedSphere) -> Plot:
    """Stresses on the axis, with a line where the film ends."""
    interface = each.scene.body.coating.thickness / each.answer.contact.bare.contact_radius
    return Plot(
        profiles(axis_panels(each), "spectral solution", interface=interface),
        f"axis-{each.label}",
        f"Stresses under the centre, {each.words}",
        "Curves of the normal, lateral and von Mises stress over depth for SAM, FEM and the spectral "
        "solution, which coincide; the lateral and the von Mises stress jump at the interface.",
        "On the axis r = 0, the dashed grey line where the film ends.",
    )


def plane_plot(each: SolvedSphere) -> Plot:
    """Von Mises stress in the plane y = 0 of both models."""
    bare, film = each.answer.contact.bare, each.scene.body.coating.thickness
    element = bare.contact_radius / each.scene.fem.cells_per_radius
    units = bare.contact_radius, bare.peak_pressure
    return Plot(
        film_planes(each.models["SAM"], each.models["FEM"], units, film=film, element=element),
        f"plane-{each.label}",
        f"Von Mises stress in the plane y = 0, {each.words}",
        "Three maps of the von Mises stress over x/a0 and z/a0: SAM, FEM and their difference.",
        "a₀ and p₀ are those of the contact without film. Dashed: the interface, where the stress jumps; "
        "next to it FEM has no Gauss point and nothing is compared.",
        embedded=each.thickness == QUICK[0][1],
    )


def pressures(each: SolvedSphere) -> Pressures:
    """The pressure of one film for the figure."""
    contact, bare = each.answer.contact, each.answer.contact.bare
    a0, p0 = bare.contact_radius, bare.peak_pressure
    r = contact.contact_radius * np.sin(np.linspace(0.0, math.pi / 2, 201))
    points = {}
    for name, result in each.models.items():
        x, p = peak(result.tables["line"], "x_m", "p_Pa")
        use = np.flatnonzero((x >= 0.0) & (p > 0.0))[::4]
        points[name] = x[use] / a0, p[use] / p0
    return Pressures(f"$h/a_0$ = {each.thickness:g}", (r / a0, contact.pressure(r) / p0), points)


def axis_panels(each: SolvedSphere) -> list[Profile]:
    """Stresses on the axis against the spectral solution, each set of depths evaluated once for all
    panels.
    """
    contact, bare = each.answer.contact, each.answer.contact.bare
    a0, p0 = bare.contact_radius, bare.peak_pressure
    known: dict[bytes, np.ndarray] = {}

    def stress(zeta: np.ndarray) -> np.ndarray:
        if zeta.tobytes() not in known:
            known[zeta.tobytes()] = contact.stress(0.0, zeta * a0)[0] / p0
        return known[zeta.tobytes()]

    return stress_panels(each.models, (a0, p0), stress, "$z/a_0$")


CASES = (CoatedSphere("coated-sphere"),)
