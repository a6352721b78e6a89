# SPDX-License-Identifier: MIT
"""A small running-in scene: a rough patch with a chemical film that fails in some cells, and wear, in a
second or two.
"""

from sam.scene import Body, CounterBody, Friction, Grid, Loading, Plasticity, Scene, Solver, Surface, Wear

FILM = {
    "law": "chemical-film",
    "low": 0.1,
    "high": 0.4,
    "film_thickness": 100e-9,
    "film_young": 80e9,
    "film_poisson": 0.3,
    "film_yield": 2e9 / 3,
    "strain_limit": 0.0204,
}
SWIFT = {"law": "swift", "B": 1780e6, "C": 4.0, "n": 0.095}
SURFACE = dict(kind="self-affine", ra=0.1e-6, cutoff_long=16e-6, cutoff_short=8e-6, hurst=0.8, seed=1)
DEPTHS = (0.0, 0.1e-6, 0.2e-6, 0.4e-6, 0.7e-6, 1.2e-6, 2e-6, 3.5e-6, 6e-6)


def running_in(cycles=2, steps=3, film=FILM, wear=0.002, plasticity=SWIFT, counterbody=None, **keys) -> Scene:
    """24 x 24 cells over 16 um. wear: limit, keys of [wear], or None; counterbody: (young, poisson), rigid if
    not given.
    """
    wear = {"strain_limit": wear} if isinstance(wear, float) else wear
    young, poisson = counterbody or (None, None)
    loading = {"force": 0.06, "steps": steps, "unload": True, "cycles": cycles} | keys.pop("loading", {})
    return Scene(
        body=Body(young=210e9, poisson=0.3, plasticity=Plasticity(**plasticity) if plasticity else None),
        counterbody=CounterBody(shape="flat", young=young, poisson=poisson),
        surface=Surface(**SURFACE | keys.pop("surface", {})),
        loading=Loading(**loading),
        friction=Friction(**film) if film else None,
        wear=Wear(**wear) if wear else None,
        grid=Grid(cells=(24, 24), extent=(16e-6, 16e-6), depths=DEPTHS, border="relief"),
        solver=Solver(tolerance=1e-4),
        **keys,
    )
