# SPDX-License-Identifier: MIT
"""What each finite-element model refuses: by key, value and what is allowed, all at once, solved or asked."""

import numpy as np
import pytest
from builders import CHEMICAL_FILM, PERFECT, SHAPES, SPHERE, STEEL, SWIFT, scene

import fem_reference
from fem_reference import plane_strain, spatial
from sam.scene import HeightMap
from verification.runs.models import FEM_LINE, cheapest_reference

FILM = {"thickness": 6e-6, "young": 80e9, "poisson": 0.3}
PUNCH, CYLINDER = {"shape": "punch", "radius": 5e-6}, {"counterbody": SHAPES["cylinder"]}
INCOMPRESSIBLE = {"young": 1e9, "poisson": 0.5}
SOFT = {"plasticity": PERFECT | {"yield_stress": 0.2e9}}
GROWING = {"prescribed": "misfit-sphere", "depth": 15e-6, "radius": 10e-6, "misfit": 0.02, "surface": "held"}
HEIGHTS = {"kind": "file", "path": HeightMap(1e-8 * np.eye(16), (12e-6, 12e-6))}
ROUGH = {"surface": HEIGHTS, "counterbody": {"shape": "flat"}}
WEAR = {"wear": {"strain_limit": 0.05}, "loading": {"unload": True}}
EACH = fem_reference, spatial
# models, tables of the scene, what is said
REFUSED = [
    (
        EACH[:1],
        {"body": {"coating": FILM | {"poisson": 0.5, "thickness": 60e-6}}},
        r'coating\.poisson = 0\.5: .*coating\.thickness = "60 um": from',
    ),
    (
        EACH[:1],
        {"body": {"coating": FILM | {"young": 210e6}}, "fem": {"box": 4.0}},
        r"fem\.box = 4\.0: more than .* this coated contact",
    ),
    # a million layers of elements otherwise
    (
        EACH,
        {"body": {"coating": FILM | {"young": 2.1e24}}},
        r'coating\.young = "2\.1E\+15 GPa": less: the contact would have .* 0\.01',
    ),
    (EACH[:1], {"counterbody": SHAPES["ellipsoid"]}, r'shape = "ellipsoid".*"sphere" or "punch"'),
    (EACH[:1], {"body": INCOMPRESSIBLE}, r"body\.poisson = 0\.5.*poisson < 0\.5"),
    (
        EACH[:1],
        {"body": INCOMPRESSIBLE, "counterbody": SHAPES["ellipsoid"] | INCOMPRESSIBLE},
        r"counterbody\.shape.*; body\.poisson.*;",
    ),
    (EACH, CYLINDER, r'counterbody\.shape = "cylinder"'),
    (EACH[:1], {"loading": GROWING, "body": SOFT}, r'loading.depth = "15.*held'),
    (EACH[1:], {"loading": GROWING}, r'loading.prescribed = "misfit-sphere"'),
    (EACH[1:], {"counterbody": PUNCH}, r'shape = "punch".*"sphere" or "ellipsoid"'),
    (EACH[1:], {"counterbody": SPHERE | STEEL}, r'young = "210 GPa": .*rigid'),
    (EACH[1:], {"body": SOFT, "fem": {"box": 3.0}}, r"fem\.box = 3"),
    (EACH[1:], {"body": {"coating": FILM | {"poisson": 0.5}}}, r"coating\.poisson = 0\.5: .*poisson < 0\.5"),
    (EACH[1:], ROUGH | {"friction": CHEMICAL_FILM, "body": {"plasticity": SWIFT}}, r"friction\.law"),
    (EACH[1:], ROUGH | WEAR | {"body": {"plasticity": SWIFT}}, r"wear\.strain_limit"),
    (EACH[1:], ROUGH | {"counterbody": {"shape": "flat", **STEEL}}, r"counterbody\.young"),
    (EACH[1:], ROUGH | {"counterbody": PUNCH}, r"counterbody\.shape"),
    (EACH[1:], ROUGH | {"body": {"coating": FILM}}, r"body\.coating"),
    ([plane_strain], {}, "counterbody.shape = .sphere.: .*cylinder"),
    ([plane_strain], CYLINDER | {"grid": {"periodic": "y"}}, "grid.periodic = .y."),
    ([plane_strain], CYLINDER | {"body": INCOMPRESSIBLE}, "body.poisson = 0.5"),
]


@pytest.mark.parametrize("models, tables, words", REFUSED)
def test_what_a_model_cannot_represent_is_refused_by_name(models, tables, words):
    for model in models:
        for asked in (model.check, model.solve):
            with pytest.raises(model.UnsupportedScene, match=words):
                asked(scene(**tables))
        assert issubclass(model.UnsupportedScene, ValueError)


def test_what_is_close_to_it_is_taken():
    fem_reference.check(scene(body={"poisson": 0.4999}))
    assert fem_reference.plan(scene(loading=GROWING | {"surface": "free"}, body=SOFT)).misfit is not None
    line, sliding = scene(**CYLINDER), scene(**CYLINDER, friction=0.1)
    assert cheapest_reference(line) == FEM_LINE
    assert plane_strain.plan(line).half and not plane_strain.plan(sliding).half
