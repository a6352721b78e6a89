# SPDX-License-Identifier: MIT
"""Which quantities have an uncertainty: the formal order of their error in the cells, or why they have
none.
"""

from __future__ import annotations

from sam.scene import Scene

OF_EDGE = (
    "p_max_Pa",
    "mises_max_Pa",
    "p_max_bare_Pa",
    "mises_max_bare_Pa",
    "p_max_change",
    "mises_max_change",
    "mises_max_substrate_Pa",
    "mises_max_film_Pa",
    "peeq_max",
)
"""Of the edge of a punch, where it is singular."""
BALANCED = ("force_N", "approach_m", "contact_area_m2", "contact_radius_m", "friction_coefficient")
"""What the balance of forces over many spots decides; a maximum below a rough body is that of one spot."""
RESIDUAL = ("residual_uz_center_m", "residual_ux_center_m", "plastic_shear_center_m")
GROOVE = ("groove_depth_m", "groove_deepest_m")
OTHERS = ("p_center_Pa", "peeq_p95", "tangential_displacement_center_m")
ORDERS = dict.fromkeys((*OF_EDGE, *BALANCED, *RESIDUAL, *GROOVE, *OTHERS), 2.0) | {"wear_volume_m3": 1.0}
"""Quantity -> order in the cells; that in the load steps is 1, of backward Euler, for all."""
EDGES = {"contact_area_m2": 0.3, "contact_radius_m": 0.15}
OUTLINE_FACTOR = 2.0
"""Of a contact of SAM with one outline, by quantity: EDGE of the rule, and the factor in place of FACTOR. The
area errs to either side, more so on the coarser grids, and differences of grids are already larger than the
error of the finest. Of 293 triplets of Hertz's contact, 4 to 33 cells in the radius, the apex at the centre
of a cell or between four, 99.7 % are covered, U/error 4.6 in the median; with a factor of 3 as many, 6.2.
"""
STEP_ORDER = 1.0
BOX_ORDERS = dict.fromkeys(RESIDUAL, 1.0)
"""The same in the size of the finite-element box; 2 of all others. From 5 to 34 radii the approach and the
largest pressure and strain of Hertz's and of a yielding contact were seen to settle with 2.2 to 3.2, a
residual displacement with 1.2.
"""

OF_ELEMENTS = ("approach_m", "force_N")
"""What alone the edge of a contact in an element changes by more than the rest of the rule knows: coarser
meshes have a node at Hertz's radius too, and agree by chance. Of 35 values of five spheres beyond yield (9 to
20 elements) 24 of the approach are covered without it and all with it; of p_max all, of peeq_max 34 without.
"""
WHY_NOT = {
    "mises_max_depth_m": "the place of a maximum moves by whole points",
    "peeq_max_depth_m": "the place of a maximum moves by whole cells",
    "residual_mises_max_Pa": "its maximum moves to another place as the cells become smaller",
    "pressure_centroid_x_m": "it is zero, or a small difference of large numbers",
}
SINGULAR = "the stress is singular at the edge of the punch"
WHOLE_RINGS = "the cells have the area of the punch as closely as whole rings allow"
ONE_SPOT = "a maximum below a rough body is that of a single spot"
UNKNOWN = "none was measured for it"


def is_given(name: str, scene: Scene) -> bool:
    """Whether the scene gives a quantity, so that it has no error."""
    loading = scene.loading
    if name == "friction_coefficient":
        return scene.constant_friction
    if name == "wear_volume_m3":
        return scene.wear is None
    if loading.prescribed is not None and name in ("p_max_Pa", "p_center_Pa", "contact_area_m2"):
        return True
    given = "approach_m" if loading.approach is not None else "force_N"
    return name == given or (loading.prescribed is not None and name == "contact_radius_m")


def why_not(name: str, scene: Scene) -> str:
    """Why a quantity of a scene has no uncertainty; empty if it has one."""
    other = scene.counterbody
    if other is not None and other.shape == "punch" and name in (*OF_EDGE, *EDGES):
        return SINGULAR if name in OF_EDGE else WHOLE_RINGS
    if scene.patch_surface is not None and name not in (*BALANCED, "wear_volume_m3"):
        return ONE_SPOT
    return WHY_NOT.get(name, "" if name in ORDERS else UNKNOWN)
