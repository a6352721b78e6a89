# SPDX-License-Identifier: MIT
"""What is perturbed, and the tests that are asked. Equivalent mutants, with the same answer, are in
`equivalent`.
"""

from __future__ import annotations

GROUPS: dict[str, tuple[str, ...]] = {
    "influence functions": (
        "sam.kernels.primitives",
        "sam.kernels.patches",
        "sam.kernels.eigenstrain",
        "sam.kernels.layer_stress",
        "sam.plasticity.spectra",
        "sam.plasticity.measure",
        "sam.elastic.stress",
        "fem_reference.common.layered_force",
        "sam.layered.response",
        "sam.layered.patches",
    ),
    "return maps": (
        "sam.plasticity.flow",
        "sam.plasticity.load_step",
        "sam.plasticity.state",
        "sam.plasticity.measure",
        "sam.plasticity.paper",
        "sam.plasticity.points",
        "sam.scene.yield_curve",
        "fem_reference.common.plasticity",
        "fem_reference.common.back_stress",
        "fem_reference.common.elasticity",
        "fem_reference.common.recovery",
        "fem_reference.axisymmetric.elements",
        "fem_reference.axisymmetric.recovery",
    ),
    "contact": (
        "sam.contact.normal",
        "sam.contact.box",
        "sam.contact.operators",
        "sam.contact.convolution",
        "sam.contact.stress",
        "sam.elastic.problem",
        "sam.elastic.stress",
        "fem_reference.common.contact",
        "fem_reference.common.hertz",
        "fem_reference.axisymmetric.problem",
        "fem_reference.spatial.problem",
        "fem_reference.spatial.hexahedra",
        "fem_reference.spatial.lines",
    ),
    "film law and wear": (
        "sam.tribofilm.state",
        "sam.tribofilm.law",
        "sam.wear",
        "sam.contact.stress",
    ),
    "hardening laws, layers and counter-bodies": (
        "sam.scene.body",
        "sam.scene.yield_curve",
        "sam.scene.surface.counter",
        "sam.grid.gap",
        "sam.schedule",
        "sam.scene.surface.strip",
        "sam.moving",
    ),
    "misfit strain, verdicts and uncertainty": (
        "sam.elastic.misfit",
        "sam.grid.smooth",
        "fem_reference.axisymmetric.misfit",
        "sam.scene.verdict",
        "verification.uncertainty.rule",
    ),
}
TABLES = {("sam.kernels.patches", "load_table"), ("sam.kernels.eigenstrain", "eigenstrain_table")}

FILES = (
    *("test_patches.py", "test_eigenstrain.py", "test_layered_response.py", "test_layered_patches.py"),
    *("test_convolution.py", "test_transforms.py", "test_real_transforms.py"),
    *("test_contact.py", "test_friction_contact.py", "test_elastic.py"),
    *(
        "test_plastic_operator.py",
        "test_plastic_solution.py",
        "test_friction_plastic.py",
        "test_coated_sam.py",
    ),
    *("test_film_law.py", "test_wear.py", "test_wear_remap.py", "test_running_in_sam.py"),
    *("test_fem_elasticity.py", "test_fem_plasticity.py", "test_fem_contact.py", "test_fem_hertz.py"),
    *(
        "test_fem_plastic_contact.py",
        "test_fem_load_steps.py",
        "test_fem_coating.py",
        "test_fem_result.py",
        "test_fem3d_elasticity.py",
    ),
    *(
        "test_core_film.py",
        "test_core_hertz.py",
        "test_core_yield.py",
        "test_core_contact.py",
        "test_core_kernels.py",
    ),
    *("test_pointwise.py", "test_preconditioner.py"),
    *("test_back_stress.py", "test_dissipation.py"),
    *("test_yield_curve.py", "test_layer.py", "test_counter_surface.py", "test_plastic_scene.py"),
    "test_refused.py",
    "test_rounded_punch.py",
    *("test_moving.py", "test_moving_film.py", "test_moving_rough.py"),
    *("test_fem3d_contact.py", "test_fem3d_coating.py"),
    *("test_misfit_scene.py", "test_fem_misfit.py", "test_fem_back_stress.py"),
    *("test_misfit_numbers.py", "test_verdict.py", "test_verdict_limits.py", "test_uncertainty.py"),
    "test_points.py",
)
QUICK_FILES = ("test_film_law.py", "test_core_film.py")
QUICK_MODULES = ("sam.tribofilm.law", "sam.tribofilm.law", "sam.tribofilm.law")
QUICK_COUNT, SEED = 20, 417

EXPLAINED: dict[tuple[str, str, str], str] = {
    ("sam.wear", "worn_depth", "2"): "any depth between two nodes has the same limit",
    (
        "sam.plasticity.spectra",
        "",
        "NEAR = 4",
    ): "where means by Gauss points end: beyond, second differences are as good to 6e-4",
    (
        "sam.plasticity.spectra",
        "_with_lag_before",
        "1.0",
    ): "of a lag whose mean is replaced by that of Gauss points",
    (
        "fem_reference.common.layered_force",
        "",
        "POWER = 4",
    ): "how the force is spread: 3e-8 of displacements far away",
    (
        "fem_reference.common.layered_force",
        "_wave_numbers",
        "1.0",
    ): "of the panels of a quadrature that has converged",
    (
        "fem_reference.common.layered_force",
        "_wave_numbers",
        "0.5",
    ): "of the panels of a quadrature that has converged",
    (
        "fem_reference.common.layered_force",
        "_wave_numbers",
        "-1.0",
    ): "of the panels of a quadrature that has converged",
    (
        "fem_reference.common.hertz",
        "plastic_radius",
        "1.0",
    ): "an end of the formula that no body that yields comes to",
    (
        "fem_reference.spatial.lines",
        "",
        "GROWTH = 1.7",
    ): "of the mesh beside the contact, where its error is that of the box",
    ("sam.tribofilm.law", "multiplier", "1.0"): "stands for the slope of cells whose step is 0",
    (
        "fem_reference.common.plasticity",
        "plastic_increment",
        "3.0",
    ): "of Newton's step, whose end does not depend on it, or of rounding",
    ("fem_reference.common.hertz", "", "DECAY = 1.7"): "of an estimate that sets a mesh, to 0.07",
    ("fem_reference.common.hertz", "scales", "1.0"): "of the unit of residuals of a misfit sphere",
    (
        "sam.plasticity.load_step",
        "",
        "STIFFNESS = 0.5",
    ): "of the surroundings of a part of a cell, 0.52 by Eshelby: no answer needs it to a tenth of a percent",
    (
        "sam.plasticity.paper",
        "PaperProblem.step",
        "2",
    ): "of a residual that is reported, and judged by its power of ten",
    ("sam.tribofilm.state", "", "BINS = 40"): "how far down a histogram goes",
    ("sam.scene.verdict", "", "4.0"): "of a floor: ten times higher and lower the verdict is the same",
    ("sam.scene.verdict", "", "0.0001"): "of a floor: ten times higher and lower the verdict is the same",
    ("sam.moving", "", "ROUNDING = 1e-06"): "of rounding",
    ("sam.moving", "Track", "carries = 1.0"): "of a pressure that an iteration starts from",
    ("sam.moving", "Track.touched", "1"): "a thousandth of a cell more",
    ("sam.moving", "Track.middle_column", "2"): "of the nearest column of cells",
    ("sam.scene.surface.strip", "", "WHOLE = 1e-06"): "of rounding",
    ("sam.tribofilm.state", "", "ROUNDING = 1e-09"): "of rounding",
    ("sam.tribofilm.state", "VisitLaw.after", "1"): "of rounding, in a histogram",
    (
        "fem_reference.common.back_stress",
        "KinematicJ2._increment",
        "3.0",
    ): "of Newton's step, whose end does not depend on it, or of rounding",
    ("fem_reference.axisymmetric.misfit", "_gauss", "88.0"): "of a term of a series, below rounding",
    ("fem_reference.axisymmetric.misfit", "MisfitSphere.zone", "1.0"): "how far the zone is looked for",
    ("fem_reference.axisymmetric.misfit", "MisfitSphere.zone", "2.0"): "how far the zone is looked for",
    ("sam.elastic.misfit", "", "ZONE_POINTS = 4001"): "of a search whose last point is the answer",
    ("sam.elastic.misfit", "<lambda>", "1.0"): "of a value that is not taken",
    ("sam.scene.verdict", "", "1.0"): "the largest share there is: nothing else is nearer to more than that",
}
"""Survivors, as far as it is understood why no fast test fails."""
