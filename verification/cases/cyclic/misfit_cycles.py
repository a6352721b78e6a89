# SPDX-License-Identifier: MIT
"""A sphere that grows and shrinks inside a body with a back-stress, a little above the limit below which it
settles: both models against the exact solution, which alternates. With Armstrong and Frederick's law the
strain of a period falls to nothing, by a few per cent a period or less: nothing ratchets.
"""

import numpy as np

from sam.scene import Plasticity, Result, Scene
from verification.cases.case import with_body, with_keys, with_loading, with_mesh
from verification.cases.recipes import sphere_cells
from verification.judging import Measured
from verification.quantities import Reference, of_cycles
from verification.reference.misfit_sphere import PROFILES
from verification.references import growing_sphere

__all__ = ["even_sphere"]

YIELD, MODULUS = 1e9, 160e9
REACHES = np.linspace(0.3, 3.0, 2701)  # radii at which the exact solution is looked at
TOLERANCE = 1e-7
"""It sets the noise of the verdict: at 1e-6 the periods until it is decided are three times as many."""
TOLD = 30  # the period after which the number of further periods is read


def above_limit(scene: Scene, of: tuple[float, float]) -> Scene:
    """Share of the misfit above that below which a period stays elastic in the end, and the recovery."""
    (share, recovery), body = of, scene.body
    excess = float(PROFILES["gauss"](REACHES)[1].max())
    limit = 2 * YIELD * (1 - body.poisson) / (body.young * excess)
    back = {"modulus": (MODULUS,), "recovery": (recovery,)}
    law = Plasticity(law="perfect", yield_stress=YIELD, kinematic=back)
    return with_loading(with_body(scene, plasticity=law), misfit=limit * (1 + share))


def even_sphere(scene: Scene, size: int) -> Scene:
    """On cells and elements of a/size, at the tolerance of a verdict."""
    return with_keys(with_mesh(sphere_cells(scene, size), size), "solver", tolerance=TOLERANCE)


def cycled_sphere(scene: Scene) -> Reference:
    """Largest dp and de of each period after the first."""
    radius = scene.loading.radius
    ends = list(growing_sphere(scene, (1.0, 0.0) * scene.loading.cycles).history(REACHES * radius))[1::2]
    both = np.array([(0 * REACHES, 0 * REACHES), *((each.peeq, 2 * each.plastic) for each in ends)])
    peeq, strain = np.abs(np.diff(both, axis=0)).max(axis=2).T
    return Reference({"peeq": peeq[1:], "strain": strain[1:]}, {"a": radius})


def peeq(scene: Scene, result: Result, exact: Reference) -> Measured:
    """Accumulated strain of each period after the first."""
    return Measured(of_cycles(result, "peeq_step_max")[1:], exact.values["peeq"])


def strain(scene: Scene, result: Result, exact: Reference) -> Measured:
    """Strain that each period after the first leaves: none with Prager's law."""
    return Measured(of_cycles(result, "strain_step_max")[1:], exact.values["strain"])


def decided(scene: Scene, result: Result, _: Reference | None) -> float:
    """Period since which the verdict is alternating."""
    said = list(result.tables["cycles"]["verdict"])
    others = [number for number, each in enumerate(said, start=1) if each != "alternating"]
    return 1.0 + max(others, default=0) if not others or others[-1] < len(said) else float("inf")


def told(scene: Scene, result: Result, _: Reference | None) -> float:
    """The same over the number of periods told after thirty."""
    further = result.tables["cycles"]["periods_to_decide"]
    return (
        decided(scene, result, None) / (TOLD + (further[TOLD - 1] or 0)) if len(further) >= TOLD else np.nan
    )


def ratchets(scene: Scene, result: Result, _: Reference | None) -> float:
    """Periods after which it is said to ratchet."""
    return float(list(result.tables["cycles"]["verdict"]).count("ratchetting"))


def period(scene: Scene, result: Result, _: Reference | None) -> np.ndarray:
    """Number of the period after the first."""
    return np.arange(2, scene.loading.cycles + 1)
