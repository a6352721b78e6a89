# SPDX-License-Identifier: MIT
"""The yield stress of the a-posteriori checks, written once more from the formula of each law, is that of the
scene.
"""

import numpy as np
import pytest
from builders import scene as small_scene

from sam.scene import Body, Scene
from verification.checks.material import yield_stress

LAWS = {
    "swift in strain": {"law": "swift", "B": 945e6, "C": 0.002, "n": 0.121, "alpha": 1.0},
    "perfect": {"law": "perfect", "yield_stress": 1e9},
    "table": {"law": "table", "file": ((0.0, 1e9), (1e-3, 1.4e9), (5e-3, 1.5e9), (0.02, 1.5e9))},
    "one row": {"law": "table", "file": ((0.0, 1e9),)},
}


def scene(law: str) -> Scene:
    return small_scene(body={"plasticity": LAWS[law] | {"profile": ((0.0, 2.0), (1e-6, 1.0))}})


@pytest.mark.parametrize("law", LAWS)
def test_the_formula_of_each_law_is_that_of_the_scene(law):
    peeq, z = np.meshgrid([0.0, 5e-4, 1e-3, 3e-3, 5e-3, 0.03], [0.0, 4e-7, 2e-6])
    plasticity = scene(law).body.plasticity
    expected = plasticity.depth_profile()(z) * plasticity.curve().stress(peeq)
    # fewer than ten roundings, of terms no larger than three times the result
    assert yield_stress(scene(law), peeq, z) == pytest.approx(expected, rel=1e-14, abs=0.0)


def test_a_body_without_a_law_never_yields():
    elastic = scene("perfect").model_copy(update={"body": Body(young=210e9, poisson=0.3)})
    assert np.isinf(yield_stress(elastic, np.zeros(3), np.zeros(3))).all()
