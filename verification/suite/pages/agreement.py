# SPDX-License-Identifier: MIT
"""The questions of the first page on whether both models agree: which gates and tables belong to which."""

from __future__ import annotations

from verification.suite.pages.findings import Cell, Held, Largest, Value
from verification.suite.pages.question import Question

BEYOND = (
    (
        "rough-*",
        "largest plastic strain",
        "under friction it lies in the surface, where it depends on cells and elements",
    ),
    (
        "figure-8-*",
        "largest plastic strain (μ = 0.4",
        "at this friction it lies in the surface, where it depends on cells and elements",
    ),
    (
        "plastic-*",
        "largest residual von Mises",
        "FEM has it at the edge of the contact within an element of the surface, where it grows as the "
        "elements become smaller; SAM, on layers of cells, has it on the axis",
    ),
)
"""(cases, begin of the quantity, why) of numbers without a gate that differ by much between both models."""

PASSES = (
    "moving-passes-spatial",
    "Largest strain that a pass adds [1e-3], kinematic",
)  # case, and begin of the caption

AGREEMENT = (
    Question(
        "Do both models give the same pressure?",
        "plastic",
        (
            Largest("elastic: largest pressure of SAM against Hertz", ("hertz-*.sam-p-max",)),
            Largest("elastic: pressure field, SAM against FEM (L2)", ("hertz-*.pressure",)),
            Largest(
                "elasto-plastic: largest pressure, SAM against FEM", rows=(("plastic-*", "largest pressure"),)
            ),
            Largest(
                "elasto-plastic: pressure field, SAM against FEM (L2)",
                ("plastic-*.pressure", "plastic-*.pressure-rings"),
            ),
        ),
    ),
    Question(
        "Do both models give the same plastic strain?",
        "plastic",
        (
            Largest("largest plastic strain", rows=(("plastic-*", "largest plastic strain"),)),
            Largest("field of plastic strain in the plane y = 0 (L2)", ("plastic-*.peeq-plane",)),
            Largest(
                "largest plastic strain, both models extrapolated over grids and load steps",
                ("plastic-convergence*.*limit",),
            ),
            Largest("displacement of the centre after unloading", ("plastic-*.residual-centre",)),
            Largest("largest residual von Mises stress", rows=(("plastic-*", "largest residual von Mises"),)),
        ),
        "The residual von Mises stress has no gate.",
    ),
    Question(
        "Do both models agree in sliding with friction?",
        "sliding",
        (
            Largest("largest pressure", rows=(("figure-8-*", "largest pressure"),)),
            Largest("plastic strain at depths of 0.3 a and more", ("figure-8-*-axis", "figure-8-*-column")),
            Largest("largest plastic strain anywhere", rows=(("figure-8-*", "largest plastic strain"),)),
            Largest(
                "given pressure and traction: plastic strain at depths of 0.3 a and more, extrapolated to "
                "infinitely many cells and load steps",
                ("sliding-given.*-limit-*",),
            ),
        ),
        "At a coefficient of friction of 0.4 the largest plastic strain lies in the surface, where it "
        "depends on the mesh, and has no gate.",
    ),
    Question(
        "Do both models agree where the counter-body moves?",
        "sliding",
        (
            Largest("groove and largest plastic strain, both models refined", ("moving-spatial.*-refined",)),
            Largest(
                "four passes: energy that a pass dissipates, difference over the first pass",
                ("moving-passes-spatial.swift-energy", "moving-passes-spatial.prager-energy"),
            ),
            Largest(
                "four passes over Swift steel: largest strain that a pass adds, where it adds any",
                ("moving-passes-spatial.swift-own-strain",),
            ),
            Held("on the verdict of both models after four passes", ("moving-passes-spatial.*-verdict",)),
            Cell(
                "kinematic steel: largest strain that the first and the fourth pass add, SAM",
                *PASSES,
                ("SAM", "12"),
                ("pass 1", "pass 4"),
                "{} ‰, {} ‰",
            ),
            Cell(
                "the same, FEM",
                *PASSES,
                ("finite elements", "6"),
                ("pass 1", "pass 4"),
                "{} ‰, {} ‰",
            ),
        ),
        "In later passes over kinematic steel single elements of FEM flow on, the less the smaller they are, "
        "so that the largest strains disagree while the energies do not.",
    ),
    Question(
        "Do both models agree on repeated loading, shakedown and ratchetting?",
        "cyclic",
        (
            Largest(
                "in place, 12 cycles: plastic strain at depths of 0.2 a and more, extrapolated to infinitely "
                "many cells and steps",
                ("repeated-loading-kept.*-limit",),
            ),
            Largest(
                "sliding, 4 cycles: plastic strain on the axis, each component",
                ("repeated-sliding.*-peeq", "repeated-sliding.*-[xz][xz]"),
            ),
            Held(
                "on the class (elastic, shakedown, alternating, ratchetting) of each cell and of the body",
                ("repeated-*.*-class*", "repeated-*.*-cells"),
            ),
            Held("on shakedown limits, from 3 % below to 3 % above", ("shakedown-limits*.*",)),
        ),
    ),
    Question(
        "Do both models agree on coated bodies?",
        "coated",
        (
            Largest("pressure in the centre, SAM against integral transforms", ("coated-sphere.sam-center",)),
            Largest("pressure (L2), SAM against integral transforms", ("coated-sphere.sam-pressure",)),
            Largest(
                "largest stress of body and film, SAM against integral transforms",
                ("coated-sphere.sam-mises-*",),
            ),
            Largest(
                "sliding: largest pressure, SAM against FEM", rows=(("coated-sliding", "largest pressure"),)
            ),
            Largest(
                "sliding: stress field of the body, SAM against FEM (L2)", ("coated-sliding.*-mises-plane",)
            ),
        ),
        "A film that yields is solved by FEM alone.",
    ),
    Question(
        "Do both models agree on rough bodies?",
        "rough",
        (
            Largest("load of a contact spot", ("rough-*.load-*",)),
            Largest("largest pressure", rows=(("rough-c*", "largest pressure"),)),
            Largest("contact area", ("rough-*.area",)),
            Largest("pressure, cell by cell (L2)", ("rough-*.pressure",)),
            Largest("displacement after unloading (L2)", ("rough-*.residual",)),
            Largest(
                "plastic strain below the spots, at depths of 0.3 spot radii and more (L2)",
                ("rough-*.strain-*",),
            ),
            Largest("largest plastic strain anywhere", rows=(("rough-c*", "largest plastic strain"),)),
        ),
        "They agree in load and area, less in fields on single cells. The largest plastic strain anywhere "
        "lies near the surface under friction, and has no gate.",
    ),
    Question(
        "Do both models agree over several cycles?",
        "sliding",
        (
            Largest("sliding, 3 cycles: largest plastic strain of a cycle", rows=(("cyclic-*", "cycle "),)),
            Largest("the same: residual displacement along x", ("cyclic-sliding.*-moved",)),
            Value(
                "the same under alternating traction: what later cycles add over the first, in SAM",
                "cyclic-sliding.alternating-sam-adds",
                percent=True,
            ),
            Value("the same in FEM", "cyclic-sliding.alternating-fem-adds", percent=True),
            Largest("rough body that wears, 3 cycles: worn volume", ("running-in-fem.own-volume",)),
            Largest(
                "the same: pressure of the third cycle, averaged over squares of 0.75 µm (L2)",
                ("running-in-fem.own-squares",),
            ),
            Largest(
                "the same, cell by cell: rims of scars, steps of nanometres, decide it",
                ("running-in-fem.own-pressure",),
            ),
            Held("on running-in over 25 cycles, by SAM alone", ("running-in.*",)),
        ),
        "Finite elements ran beside SAM for 12 cycles at most, in place (see repeated loading); beyond that, "
        "and in running-in with its film, there is SAM alone.",
    ),
)
