# SPDX-License-Identifier: MIT
"""The scenes of running-in, verification/scenes/running-in-*.toml with the printed inputs, and what cases
change in them: size, surface, layer, hardening, counter-surface and depths.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from sam.scene import CounterSurface, Hardening, Plasticity, Result, Scene, Status
from verification.cases.case import Context, with_grid, with_keys, with_loading

BULK, A, B, DUCTILE, HARDENING = "bulk", "curve-a", "curve-b", "curve-b-ductile", "hardening"
NAMES = dict(
    zip(
        (BULK, A, B, DUCTILE, HARDENING),
        "bulk|curve A|curve B|curve B, 5 %|hardening only".split("|"),
        strict=True,
    )
)
"""The five materials, as scenes are named -> as the reader knows them."""
LAST = 25  # cycles of the paper's figures
LITERATURE_B = 1280e6  # Pa: of the steel with the paper's C and n in the literature; the paper takes 1780 MPa
DEEPER = ((14.2e-6, 19.4e-6), (26.5e-6, 36.2e-6))  # m: further faces of layers, each 1.366 times as deep
LAYER_ALPHA = 1e3  # of Swift's law in the layer: 2.4 GPa at a strain of 2 %, where 1e6 gives 4.6 GPa
ROUGHNESS = {"sq": 10e-9, "cutoff_long": 32e-6, "cutoff_short": 12e-6, "hurst": 0.8}
MODULI = (35648.8e9, 13721.5e9, 1895.4e9, 227.18e9, 37.371e9)
RECOVERY = (3e5, 3e4, 3e3, 300.0, 30.0)
"""Back-stresses that fit Swift's law with B = 1780 MPa, C = 4, n = 0.095 less its start, within 0.5 % from
1e-6 to 0.03."""
SHARES = {"isotropic": 0.0, "half and half": 0.5, "kinematic": 1.0}
"""Ways to harden -> share of the hardening that back-stresses have. Assumed: no cyclic curve is known."""
LARGEST, POINTS = 0.2, 60  # of the plastic strain in the table of a yield stress, and its rows


class Reading(StrEnum):
    """How the paper is read. PRINTED: with its numbers, by our plastic loop; RENEWED: see `renewed`."""

    PRINTED = "with the printed inputs"
    RENEWED = "weakly hardening layer, renewed counter-surface"

    @property
    def short(self) -> str:
        """For columns of tables and names of files."""
        return "printed inputs" if self is Reading.PRINTED else "renewed"


@dataclass(frozen=True)
class Effort:
    """How much is run: cycles, load steps each way, cells of 1 um a side, names of scenes, seeds."""

    cycles: int
    steps: int
    cells: int
    cases: tuple[str, ...] = tuple(NAMES)
    seeds: tuple[int, ...] = ()


def printed_scenes(context: Context, effort: Effort) -> dict[str, Scene]:
    """Material -> its scene with the printed inputs at an effort."""
    return {case: reduced(context.scene(f"running-in-{case}"), effort) for case in effort.cases}


def reduced(scene: Scene, effort: Effort) -> Scene:
    """The scene on a patch of so many cells, at its nominal pressure, for so many cycles and steps."""
    if effort.cells != scene.grid.cells[0]:
        share = effort.cells / scene.grid.cells[0]
        extent = tuple(share * side for side in scene.grid.extent)
        scene = with_grid(scene, cells=(effort.cells,) * 2, extent=extent)
        scene = with_loading(scene, force=share**2 * scene.loading.force)
    return with_loading(scene, cycles=effort.cycles, steps=effort.steps, unload_steps=effort.steps)


def with_seed(scene: Scene, seed: int) -> Scene:
    """Another surface of the same statistics."""
    return with_keys(scene, "surface", seed=seed)


def with_plasticity(scene: Scene, **keys) -> Scene:
    """With other keys in [body.plasticity]."""
    return with_keys(scene, "body.plasticity", **keys)


def with_constant(scene: Scene, B: float) -> Scene:
    """With another constant B, in Pa, in the body and in a layer with a law of its own."""
    layer = scene.body.plasticity.layer
    return with_plasticity(scene, B=B, layer=layer and layer.model_copy(update={"B": B}))


def with_layer_alpha(scene: Scene, alpha: float) -> Scene:
    """The layer, if there is one, with Swift's law of its own: hardening by alpha times the strain."""
    plasticity = scene.body.plasticity
    if plasticity.layer_thickness is None:
        return scene
    own = plasticity.model_dump(include={"law", "B", "C", "n"})
    return with_plasticity(scene, layer=Hardening(**own, alpha=alpha))


def with_deviation(scene: Scene, scale: float) -> Scene:
    """With so much of the layer's deviation from the bulk; scaling the factors would change the bulk below it
    too.
    """
    if (profile := scene.body.plasticity.profile) is None:
        return scene
    return with_plasticity(scene, profile=tuple((z, 1.0 + scale * (f - 1.0)) for z, f in profile))


def with_counter(scene: Scene, sq: float, *, renew: bool = True) -> Scene:
    """A rough counter-surface of so many m rms, another one in each cycle if it is renewed. Its seeds, one
    for each cycle, are neither those of the surfaces nor those of another surface's counter-surface.
    """
    keys = {**ROUGHNESS, "sq": sq, "seed": 1000 * scene.surface.seed + 1, "renew": renew}
    return with_keys(scene, "counterbody", surface=CounterSurface(kind="self-affine", **keys))


def renewed(scene: Scene) -> Scene:
    """The second reading: the layer hardens little; the counter-surface is rough and another one in each
    cycle; layers of cells reach deeper.
    """
    scene = deeper(with_counter(with_layer_alpha(scene, LAYER_ALPHA), ROUGHNESS["sq"]))
    return scene.model_copy(update={"title": f"{scene.title}, {Reading.RENEWED}"})


def deeper(scene: Scene) -> Scene:
    """With the next faces of DEEPER: softer steel, and the summits of some surfaces, let the body yield below
    the layers of the printed scenes.
    """
    depths = scene.grid.depths
    return with_grid(scene, depths=(*depths, *next(faces for faces in DEEPER if faces[0] > depths[-1])))


def deeper_after(scene: Scene, result: Result) -> Scene | None:
    """The scene with deeper layers where its plastic zone reached the last one and there are deeper ones."""
    at_edge = result.status is Status.PLASTIC_ZONE_AT_GRID_EDGE
    return deeper(scene) if at_edge and scene.grid.depths[-1] < DEEPER[-1][0] else None


def swift(law: Plasticity, peeq: np.ndarray) -> np.ndarray:
    """Yield stress of the isotropic law in Pa."""
    return law.B * (law.C + law.alpha * peeq) ** law.n


def hardened(scene: Scene, share: float) -> Scene:
    """The body with so much of its hardening by back-stresses, and the rest as a table that ends flat."""
    law, peeq = scene.body.plasticity, np.append(0.0, np.geomspace(1e-7, LARGEST, POINTS))
    first = float(swift(law, np.zeros(1))[0])
    stress = first + (1 - share) * (swift(law, peeq) - first)
    table = {"law": "table", "file": tuple(zip(peeq.tolist(), stress.tolist(), strict=True))}
    isotropic = {"law": "perfect", "yield_stress": first} if share == 1 else table
    back = {"modulus": tuple(share * modulus for modulus in MODULI), "recovery": RECOVERY}
    place = law.model_dump(include={"profile", "layer_thickness"}, exclude_none=True)
    plasticity = Plasticity(**isotropic, **({"kinematic": back} if share else {}), **place)
    return with_keys(scene, "body", plasticity=plasticity)
