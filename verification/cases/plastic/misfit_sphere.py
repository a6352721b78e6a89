# SPDX-License-Identifier: MIT
"""A sphere that grows inside a yielding body: plastic strain of both models against a closed form, without
any contact, and against each other below a free surface.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from math import ceil

import numpy as np

from sam.scene import Grid, Plasticity, Result, Scene
from verification.cases.case import (
    FEM,
    SAM,
    Case,
    Context,
    Measured,
    Plot,
    SmallTable,
    off_text,
    with_body,
    with_loading,
    with_mesh,
)
from verification.cases.plastic.misfit_images import Images, images, seen
from verification.figures.growing_sphere import rays
from verification.reference.convergence import fit_order
from verification.reference.misfit_sphere import GrowingSphere

LAWS = {
    "linear": (0.02, {"law": "linear", "yield_stress": 1e9, "modulus": 10e9}),
    "swift": (0.03, {"law": "swift", "B": 945e6, "C": 20.0, "n": 0.121}),
    "perfect": (0.04, {"law": "perfect", "yield_stress": 1e9}),
}
"""Misfit strain at the centre and hardening law."""
SIZES = {"quick": (6, 8, 12), "full": (6, 8, 12, 16)}
SOLVED = ("linear", "perfect")  # by SAM; with Swift's law in a case of its own
ELEMENTS = (6, 12)
AT = 12  # cells in the radius where a single size is judged
DEPTHS = (1.3, 4.0)  # radii: shallow and deep
FREE = (1.3, 1.5)
STEPS = 5
TOLERANCE = 1e-4  # of the plastic iteration: a tenth of the errors that are judged, in single precision
POINTS = 4  # Gauss points of a cell each way, for means of the closed form


@dataclass(frozen=True)
class Errors:
    """Of a result against the closed form: L2 of the plastic strain over that of the closed form, total
    plastic strain over the exact one less 1, the largest deviator over the exact one less 1.
    """

    l2: float
    total: float
    mises: float


@dataclass(frozen=True)
class Cells:
    """SAM against the closed form by its cells in the radius. loaded, removed: at the peak and after removal;
    raised: of the surface by plastic strain over the radius; scene, result: of AT cells.
    """

    loaded: Mapping[int, Errors]
    removed: Mapping[int, Errors]
    raised: Mapping[int, float]
    scene: Scene
    result: Result

    def values(self, law: str) -> dict[str, Measured | float]:
        """Orders and errors."""
        return {
            f"sam-l2-order-{law}": order(self.loaded, "l2"),
            f"sam-total-{law}": of_second_order(self.loaded),
            f"sam-removed-total-{law}": of_second_order(self.removed),
        }


@dataclass(frozen=True)
class Spheres:
    """Results against the closed form. cells: SAM by law; fem: law -> elements in the radius -> errors at the
    peak; depths: L2 of SAM by depth; steps: L2 of SAM of one step and of several; newton: most iterations of
    FEM; free: depth -> results of SAM and FEM; images: of the zone of linear hardening.
    """

    scene: Scene
    cells: Mapping[str, Cells]
    fem: Mapping[str, Mapping[int, Errors]]
    depths: Mapping[float, float]
    steps: tuple[float, float]
    newton: int
    free: Mapping[float, tuple[Result, Result]]
    images: Images


def with_law(scene: Scene, name: str) -> Scene:
    """The scene with one of LAWS and its misfit strain."""
    misfit, law = LAWS[name]
    return with_loading(with_body(scene, plasticity=Plasticity(**law)), misfit=misfit)


def closed_form(scene: Scene, shares: tuple[float, ...] = (1.0,)) -> GrowingSphere:
    """The closed form of a held scene, with at most one back-stress."""
    body, loading, back = scene.body, scene.loading, scene.body.plasticity.kinematic
    law, constants = body.plasticity.curve().stress, (back.modulus[0], back.recovery[0]) if back else ()
    sphere = loading.misfit, loading.radius, loading.profile
    return GrowingSphere(body.young, body.poisson, law, *sphere, shares, *constants)


def on_grid(scene: Scene, size: int) -> Scene:
    """The scene on cubes of radius/size about the plastic zone, one of them at the centre; above, where
    nothing yields, a layer more.
    """
    cell, depth = scene.loading.radius / size, scene.loading.depth
    half = ceil(closed_form(scene).zone()[1] / cell) + 2
    faces = depth + cell * (np.arange(-half, half + 1) + 0.5)
    faces = np.append(faces[0] - cell, faces)
    faces = (0.0, *(float(z) for z in faces if z > cell / 2))
    cells = 2 * half + 3
    grid = Grid(cells=(cells, cells), extent=(cells * cell,) * 2, depths=faces)
    solver = scene.solver.model_copy(update={"tolerance": TOLERANCE})
    return scene.model_copy(update={"grid": grid, "solver": solver})


def cell_errors(scene: Scene, result: Result, shares: tuple[float, ...] = (1.0,)) -> Errors:
    """Of SAM, whose cells hold means, over its box; the largest deviator at the centres of the cells."""
    exact, box = closed_form(scene, shares), result.grids["peak" if len(shares) == 1 else "unloaded"]["body"]
    t, w = np.polynomial.legendre.leggauss(POINTS)
    edges = box.x, box.y, box.z - scene.loading.depth
    x, y, z = ((e[1:] + e[:-1])[:, None] / 2 + np.diff(e)[:, None] / 2 * t for e in edges)
    mean = np.zeros((len(x), len(y), len(z)))
    for k, p in enumerate(w):
        r = np.sqrt(x[:, :, None, None, None] ** 2 + y[:, :, None] ** 2 + z[:, k] ** 2)
        mean += p / 8 * np.einsum("iajbk,a,b->ijk", exact.fields(r).peeq, w, w)
    volume = np.einsum("i,j,k->ijk", *(np.diff(e) for e in edges))
    return _errors(exact, result.quantities, peeq=box.cell_data["peeq"], here=mean, volume=volume)


def point_errors(scene: Scene, result: Result) -> Errors:
    """Of FEM at its Gauss points; the total against the closed form at the same points, as a kink between
    them is worth more than the error of the elements.
    """
    exact, plane = closed_form(scene), result.tables["plane"]
    rows = np.array(plane["state"]) == "peak"
    x, z, peeq = (np.asarray(plane[name])[rows].reshape(-1, 4) for name in ("x_m", "z_m", "peeq"))
    corners = result.fields.points[result.fields.cells["quad"]]
    area = np.ptp(corners[..., 0], axis=1) * np.ptp(corners[..., 2], axis=1)
    here = exact.fields(np.hypot(x, z - scene.loading.depth)).peeq
    volume = 2 * np.pi * x * area[:, None] / 4
    found = _errors(exact, result.quantities, peeq=peeq, here=here, volume=volume)
    return replace(found, total=float((volume * peeq).sum() / (volume * here).sum() - 1))


def _errors(
    exact: GrowingSphere,
    quantities: Mapping[str, float],
    *,
    peeq: np.ndarray,
    here: np.ndarray,
    volume: np.ndarray,
) -> Errors:
    """peeq: found; here: of the closed form at the same places, which stand for volumes in m^3."""
    deviator = np.abs(exact.fields(exact.radius * np.linspace(0.01, 2.0, 2000)).deviator).max()
    largest = quantities["mises_max_Pa" if len(exact.shares) == 1 else "residual_mises_max_Pa"]
    return Errors(
        float(np.sqrt((volume * (peeq - here) ** 2).sum() / (volume * here**2).sum())),
        float((volume * peeq).sum() / exact.total() - 1),
        float(largest / deviator - 1),
    )


def in_sizes(context: Context, scene: Scene, law: str) -> Cells:
    """SAM on cells of all sizes, loaded and removed."""
    loaded, removed, raised, shown = {}, {}, {}, {}
    for size in SIZES[context.level]:
        at = on_grid(scene, size)
        shown[size] = at, context.solve(SAM, at, f"sam-{law}-{size}")
        loaded[size] = cell_errors(*shown[size])
        removed[size] = cell_errors(*shown[size], (1.0, 0.0))
        raised[size] = abs(shown[size][1].quantities["residual_uz_center_m"]) / scene.loading.radius
    return Cells(loaded, removed, raised, *shown[AT])


COLUMNS = ("law", "cell", "L2 of plastic strain in %", "total in %", "largest stress in %")


def sam_table(cells: Mapping[str, Cells]) -> SmallTable:
    """Errors of SAM by law and size."""
    rows = [
        (law, f"a/{size}", *(f"{1e2 * value:+.2f}" for value in (each.l2, each.total, each.mises)))
        for law, found in cells.items()
        for size, each in found.loaded.items()
    ]
    return SmallTable("SAM against the closed form", COLUMNS, rows)


def ray_plot(law: str, cells: Cells) -> Plot:
    """SAM on AT cells along the axis below the centre."""
    return Plot(
        rays({"SAM": cells.result}, closed_form(cells.scene), cells.scene.loading.depth),
        f"ray-{law}",
        f"Along a ray through the centre, {law}",
        "Plastic strain, deviator and radial stress over the distance from the centre",
        f"Cells of SAM (a/{AT}) along the axis, and the closed form.",
    )


class SwiftSphere(Case):
    """SAM with Swift's law against the closed form."""

    def solve(self, context: Context) -> Cells:
        return in_sizes(context, with_law(context.scene("misfit-sphere"), "swift"), "swift")

    def measure(self, found: Cells) -> dict[str, Measured | float]:
        return found.values("swift")

    def tables(self, found: Cells) -> Iterator[SmallTable]:
        yield sam_table({"swift": found})

    def figures(self, found: Cells) -> Iterator[Plot]:
        yield ray_plot("swift", found)


class MisfitSphere(Case):
    """Both models against the closed form, and below a free surface against each other."""

    def solve(self, context: Context) -> Spheres:
        base = context.scene("misfit-sphere")
        scenes = {law: with_law(base, law) for law in LAWS}
        cells = {law: in_sizes(context, scenes[law], law) for law in SOLVED}
        fem, newton = self._elements(context, scenes)
        return Spheres(
            base,
            cells,
            fem,
            {depth: self._at_depth(context, scenes["linear"], depth) for depth in DEPTHS},
            self._in_steps(context, scenes["perfect"]),
            newton,
            {depth: self._free(context, scenes["linear"], depth) for depth in FREE},
            images(closed_form(scenes["linear"])),
        )

    def _elements(
        self, context: Context, scenes: Mapping[str, Scene]
    ) -> tuple[dict[str, dict[int, Errors]], int]:
        """FEM by law and elements in the radius, and the most iterations of a step."""
        found: dict[str, dict[int, Errors]] = {law: {} for law in scenes}
        newton = 0
        for law, scene in scenes.items():
            once = with_loading(scene, unload=False)
            for elements in ELEMENTS:
                result = context.solve(FEM, with_mesh(once, elements), f"fem-{law}-{elements}")
                found[law][elements] = point_errors(once, result)
                newton = max(newton, *result.tables["history"]["iterations"])
        return found, newton

    def _at_depth(self, context: Context, scene: Scene, depth: float) -> float:
        """L2 of SAM with the centre at a depth in radii, on the middle size."""
        deep = with_loading(scene, depth=depth * scene.loading.radius, unload=False)
        at = on_grid(deep, SIZES["quick"][1])
        return cell_errors(at, context.solve(SAM, at, f"sam-depth-{depth:g}")).l2

    def _in_steps(self, context: Context, scene: Scene) -> tuple[float, float]:
        """L2 of SAM of one step and of several, on the middle size."""
        one, several = (
            on_grid(with_loading(scene, unload=False, steps=steps), SIZES["quick"][1]) for steps in (1, STEPS)
        )
        found = (context.solve(SAM, each, f"sam-steps-{each.loading.steps}") for each in (one, several))
        first, second = (cell_errors(one, each).l2 for each in found)
        return first, second

    def _free(self, context: Context, scene: Scene, depth: float) -> tuple[Result, Result]:
        """Both models with the centre at a depth in radii below a free surface."""
        free = with_loading(scene, depth=depth * scene.loading.radius, surface="free")
        at = with_mesh(on_grid(free, AT), AT)
        return tuple(context.solve(model, at, f"{name}-free-{depth:g}") for model, name in MODELS.items())

    def measure(self, found: Spheres) -> dict[str, Measured | float]:
        values: dict[str, Measured | float] = {}
        for law, cells in found.cells.items():
            values |= cells.values(law)
        for law, by_size in found.fem.items():
            first, last = (by_size[each] for each in ELEMENTS)
            values |= {
                f"fem-l2-{law}": last.l2,
                f"fem-order-{law}": float(np.log2(first.l2 / last.l2)),
                f"fem-total-{law}": last.total,
            }
        raised = found.cells["linear"].raised
        shallow, deep = (found.depths[depth] for depth in DEPTHS)
        values |= {
            "sam-depth": Measured(shallow, deep),
            "sam-steps": Measured(found.steps[1], found.steps[0]),
            "sam-raised": raised[max(raised)],
            "sam-raised-falls": raised[min(raised)] / raised[max(raised)],
            "sam-removed-mises": found.cells["linear"].removed[AT].mises,
            "fem-newton": float(found.newton),
        }
        for depth, (sam, fem) in found.free.items():
            for gate, name in FREE_QUANTITIES.items():
                own, other = sam.quantities[name], fem.quantities[name]
                values[f"{gate}-free-{depth:g}"] = Measured(own, other)
            values[f"uplift-free-{depth:g}"] = Measured(uplift(sam), uplift(fem), unit="m")
        return values | found.images.values()

    def setup(self, found: Spheres) -> list[tuple[str, str]]:
        loading = found.scene.loading
        return [
            (
                "Sphere",
                f"e = e₀ (1 − r²/a²)² inside a = {loading.radius * 1e6:g} µm, centre at "
                f"{loading.depth / loading.radius:g} a",
            ),
            ("Held", "the surface carries the tractions of the infinite body"),
            *((law, f"e₀ = {misfit:g}, {keys}") for law, (misfit, keys) in LAWS.items()),
        ]

    def tables(self, found: Spheres) -> Iterator[SmallTable]:
        yield sam_table(found.cells)
        rows = [
            (law, f"a/{size}", f"{1e2 * each.l2:.3f}", f"{1e2 * each.total:+.4f}")
            for law, by_size in found.fem.items()
            for size, each in by_size.items()
        ]
        yield SmallTable("FEM against the closed form", ("law", "element", *COLUMNS[2:4]), rows)
        rows = [
            (
                f"{depth:g} a",
                gate,
                f"{sam.quantities[name]:.5g}",
                f"{fem.quantities[name]:.5g}",
                off_text(sam.quantities[name], fem.quantities[name]),
            )
            for depth, (sam, fem) in found.free.items()
            for gate, name in FREE_QUANTITIES.items()
        ]
        yield SmallTable("Below a free surface", ("depth", "quantity", "SAM", "FEM", "SAM off FEM"), rows)
        yield found.images.table()

    def notes(self, found: Spheres) -> Iterator[str]:
        raised = found.cells["linear"].raised
        yield (
            "What yields makes no stress outside of its zone, so none at the surface either: the images of "
            f"all cells cancel. The surface moves by {raised[max(raised)]:.1e} a, at depths of "
            f"{DEPTHS[0]:g} a and {DEPTHS[1]:g} a the error is {1e2 * found.depths[DEPTHS[0]]:.2f} % and "
            f"{1e2 * found.depths[DEPTHS[1]]:.2f} %."
        )
        yield seen(found.images)

    def figures(self, found: Spheres) -> Iterator[Plot]:
        for law, cells in found.cells.items():
            yield ray_plot(law, cells)


MODELS = {SAM: "sam", FEM: "fem"}
FREE_QUANTITIES = {"peeq": "peeq_max", "residual-uz": "residual_uz_center_m", "mises": "mises_max_Pa"}


def order(by_size: Mapping[int, Errors], name: str) -> float:
    """Order in the size of a cell of an error, by least squares."""
    errors = [abs(getattr(each, name)) for each in by_size.values()]
    return fit_order([1 / size for size in by_size], errors).order


def of_second_order(by_size: Mapping[int, Errors]) -> float:
    """The largest error of the total plastic strain times the square of the cells in the radius: its own sign
    may change between two sizes, which leaves no order to fit.
    """
    return max(abs(each.total) * size**2 for size, each in by_size.items())


def uplift(result: Result) -> float:
    """u_z of the surface on the axis at the peak in m."""
    line = result.tables["line"]
    rows = np.array(line["state"]) == "peak"
    at = np.abs(np.asarray(line["x_m"])[rows]).argmin()
    return float(np.asarray(line["uz_m"])[rows][at])


CASES = (
    MisfitSphere("misfit-sphere"),
    SwiftSphere("misfit-sphere-swift"),
)
