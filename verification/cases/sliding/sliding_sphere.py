# SPDX-License-Identifier: MIT
"""Stresses under given Hertz pressure and full-slip traction, summed over patches, against Hamilton's closed
form.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from sam.contact import stresses, von_mises
from sam.grid import Window
from verification.cases.case import Case, Context, Measured, Plot, SmallTable
from verification.figures.profiles import Profile, profiles
from verification.reference.convergence import fit_order
from verification.reference.hamilton import largest_von_mises, sliding_stress

NU = 0.3
FRICTION = (0.0, 0.1, 0.2, 0.25, 0.3, 0.4, 0.5)
ACROSS = {"quick": (18, 36, 72), "full": (18, 36, 72, 144)}  # cells across the contact
CROSSING = {
    "quick": (36, 72, 144),
    "full": (36, 72, 144, 288),
}  # the same, to find where the edge overtakes the interior
INTERIOR = np.linspace(0.1, 0.8, 57)  # depths at which the largest stress of the interior is looked for
DEPTHS = np.array([0.1, 0.2, 0.3, 0.48, 0.7, 1.0, 1.5])  # contact radii; interior points
COMPONENTS = ("sxx", "syy", "szz", "syz", "sxz", "sxy")
PARTS = 8  # of a cell each way, for the mean traction of a cell


def grid_of(across: int) -> tuple[np.ndarray, float]:
    """Odd number of cells over three contact radii, `across` of them in the contact: centres and size, in
    radii.
    """
    h = 2.0 / across
    n = int(1.5 * across) // 2 * 2 + 1
    return (np.arange(n) - (n - 1) / 2) * h, h


def mean_traction(x: np.ndarray, h: float) -> np.ndarray:
    """Mean of sqrt(1 - r^2) over each cell: the load of a cell that the edge cuts is right."""
    part = ((np.arange(PARTS) + 0.5) / PARTS - 0.5) * h
    fine = (x[:, None] + part).ravel()
    p = np.sqrt(np.maximum(1.0 - fine[:, None] ** 2 - fine[None, :] ** 2, 0.0))
    return p.reshape(x.size, PARTS, x.size, PARTS).mean(axis=(1, 3))


def interior_errors(across: int, friction: float) -> np.ndarray:
    """Largest error of each component over all cells and interior depths, in units of p0: (6,)."""
    x, h = grid_of(across)
    p = mean_traction(x, h)
    found = stresses({1: friction * p, 3: p}, (h, h), DEPTHS, Window(0, 0, x.size, x.size), nu=NU)
    exact = sliding_stress(
        x[None, :, None],
        x[None, None, :],
        DEPTHS[:, None, None],
        1.0,
        contact_radius=1.0,
        nu=NU,
        friction=friction,
    )
    return np.abs(found - np.moveaxis(exact, -1, 0)).max(axis=(1, 2, 3))


def plane_maximum(across: int, friction: float) -> tuple[float, float]:
    """Largest von Mises stress in the plane y = 0 and its depth, in p0 and radii, surface included."""
    x, h = grid_of(across)
    p = mean_traction(x, h)
    depths = np.linspace(0.0, 1.0, 81)
    row = Window(0, x.size // 2, x.size, 1)
    mises = von_mises(stresses({1: friction * p, 3: p}, (h, h), depths, row, nu=NU))[:, :, 0]
    k = np.unravel_index(mises.argmax(), mises.shape)[0]
    return float(mises.max()), float(depths[k])


def row_stresses(across: int, depths: np.ndarray, reach: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """x of the cells in |x| < reach on y = 0, and their stresses under p and under q = p, (6, nz, nx)
    each.
    """
    x, h = grid_of(across)
    x = x[np.abs(x) < reach]
    p = mean_traction(x, h)
    row = Window(0, x.size // 2, x.size, 1)
    under_p, under_q = (stresses({load: p}, (h, h), depths, row, nu=NU)[..., 0] for load in (3, 1))
    return x, under_p, under_q


def crossing(across: int) -> float:
    """The friction coefficient at which the von Mises stress of the cell on the trailing edge becomes the
    largest of all.
    """
    (x, *edge), (_, *interior) = row_stresses(across, np.zeros(1), 1.1), row_stresses(72, INTERIOR, 1.1)
    cell = np.abs(x + 1.0).argmin()

    def lead(friction: float) -> float:
        at_edge, inside = (von_mises(p + friction * q) for p, q in (edge, interior))
        return at_edge[0, cell] - inside.max()

    return brentq(lead, 0.2, 0.5, xtol=1e-6)


def limit_of_root(h: np.ndarray, values: np.ndarray) -> float:
    """Value at h = 0 of the parabola in sqrt(h) through the three finest: the traction has a vertical tangent
    at r = a.
    """
    return float(np.polynomial.Polynomial.fit(np.sqrt(h[-3:]), values[-3:], 2)(0.0))


def overtaking() -> float:
    """The friction coefficient at which the largest von Mises stress moves to the edge, in the closed
    form.
    """

    def lead(friction: float) -> float:
        interior, edge = largest_von_mises(1.0, 1.0, NU, friction)
        return edge[0] - interior[0]

    return brentq(lead, 0.2, 0.5, xtol=1e-6)


@dataclass(frozen=True)
class Stresses:
    """interior: largest errors (n, 6) of each grid at mu = 0.4; plane: SAM's largest von Mises stress and its
    depth for each of FRICTION; crossings: friction coefficient at which the edge overtakes, of each grid of
    `crossing_sizes`.
    """

    sizes: Sequence[int]
    interior: np.ndarray
    plane: np.ndarray
    crossing_sizes: np.ndarray
    crossings: np.ndarray

    @property
    def limit(self) -> float:
        """Of the crossings on ever finer cells."""
        return limit_of_root(1.0 / self.crossing_sizes, self.crossings)


class SlidingSphere(Case):
    """Six components at interior points, and where the largest von Mises stress lies as friction grows."""

    def solve(self, context: Context) -> Stresses:
        sizes, crossing_sizes = ACROSS[context.level], np.array(CROSSING[context.level])
        interior = np.array([interior_errors(n, 0.4) for n in sizes])
        plane = np.array([plane_maximum(72, friction) for friction in FRICTION])
        return Stresses(
            sizes, interior, plane, crossing_sizes, np.array([crossing(n) for n in crossing_sizes])
        )

    def measure(self, found: Stresses) -> dict[str, Measured | float]:
        interior, _ = largest_von_mises(1.0, 1.0, NU, FRICTION[0])
        values = dict(zip(COMPONENTS, found.interior[found.sizes.index(72)], strict=True))
        return values | {
            "interior-maximum": Measured(found.plane[0, 0], interior[0], unit="p₀"),
            "crossing": Measured(found.limit, overtaking()),
        }

    def setup(self, found: Stresses) -> list[tuple[str, str]]:
        return [
            ("Tractions", "p = p₀ √(1 − r²/a²), q = μp along +x, given; no contact is solved"),
            ("Half-space", f"ν = {NU:g}"),
            ("Cells across the contact", ", ".join(map(str, found.sizes))),
            ("Interior points", "every cell over 3a x 3a, z/a = " + ", ".join(f"{z:g}" for z in DEPTHS)),
        ]

    def tables(self, found: Stresses) -> list[SmallTable]:
        return [interior_table(found), plane_table(found), crossing_table(found)]

    def figures(self, found: Stresses) -> Iterator[Plot]:
        yield Plot(
            profiles(list(depth_panels()), "Hamilton (1983)"),
            "depth",
            "Von Mises stress under a sliding sphere, μ = 0.4",
            "Von Mises stress over depth at three places in the plane of sliding for SAM and Hamilton's "
            "closed form, which coincide, with the error underneath.",
            "72 cells across the contact; underneath, SAM minus closed form in % of p₀. At the surface the "
            "patches err to first order in the cell.",
        )


def interior_table(found: Stresses) -> SmallTable:
    """The largest error of each component on each grid."""
    order = fit_order(1.0 / np.array(found.sizes), found.interior.max(axis=1))
    return SmallTable(
        (f"Largest error at μ = 0.4 in % of p₀; observed order of the largest {order.order:.2f}"),
        ("cells across", *COMPONENTS),
        [
            (f"{n}", *(f"{100 * e:.4f}" for e in error))
            for n, error in zip(found.sizes, found.interior, strict=True)
        ],
    )


def plane_table(found: Stresses) -> SmallTable:
    """The largest von Mises stress over friction, by SAM and in closed form inside and at the edge."""
    caption = (
        "Largest von Mises stress in the plane y = 0 (72 cells across); in the closed form the edge "
        f"overtakes the interior at μ = {overtaking():.4f}"
    )
    rows = [
        (
            f"{mu:g}",
            f"{value:.4f}",
            f"{depth:.3f}",
            *(f"{place[0]:.4f}" for place in largest_von_mises(1.0, 1.0, NU, mu)),
        )
        for mu, (value, depth) in zip(FRICTION, found.plane, strict=True)
    ]
    return SmallTable(
        caption, ("μ", "SAM, p₀", "depth, a", "closed form: interior, p₀", "closed form: edge, p₀"), rows
    )


def crossing_table(found: Stresses) -> SmallTable:
    """Where the edge overtakes the interior, on ever finer cells and in the limit."""
    exact, sizes, crossings = overtaking(), found.crossing_sizes, found.crossings
    order = fit_order(1.0 / sizes, crossings - exact)
    values = [*((f"{n}", mu) for n, mu in zip(sizes, crossings, strict=True)), ("limit", found.limit)]
    return SmallTable(
        (
            "Friction coefficient at which the cell on the trailing edge overtakes the interior as the "
            f"place of the largest von Mises stress; observed order {order.order:.2f}; limit: parabola in "
            "the root of the cell size"
        ),
        ("cells across", "μ", "off"),
        [
            *[(name, f"{mu:.4f}", f"{mu - exact:+.4f}") for name, mu in values],
            ("closed form", f"{exact:.4f}", ""),
        ],
    )


def depth_panels() -> Iterator[Profile]:
    """Von Mises stress over depth below the centre and on both sides of it, mu = 0.4."""
    depths = np.linspace(0.0, 1.5, 76)
    x, under_p, under_q = row_stresses(72, depths, np.inf)
    for title, offset in (("x = 0", 0.0), ("x = -0.5 a", -0.5), ("x = 0.5 a", 0.5)):
        k = int(np.abs(x - offset).argmin())
        series = {"SAM": (depths, von_mises((under_p + 0.4 * under_q)[:, :, k]))}

        def exact(z: np.ndarray, at: float = x[k]) -> np.ndarray:
            return von_mises(
                np.moveaxis(sliding_stress(at, 0.0, z, 1.0, contact_radius=1.0, nu=NU, friction=0.4), -1, 0)
            )

        yield Profile(title, "$z/a$", r"$\sigma_\mathrm{vM}/p_0$", exact, series, 1.0, "$p_0$", (0.0, 1.5))


CASES = (SlidingSphere(name="sliding-sphere"),)
