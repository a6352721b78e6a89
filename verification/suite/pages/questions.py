# SPDX-License-Identifier: MIT
"""The questions of the first page, and what answers each: the one table that says which gates belong to
which.

The numbers are computed of the results; a question whose cases did not run is answered by that.
"""

from __future__ import annotations

from dataclasses import dataclass

from verification.suite.pages.findings import Cell, Held, Largest, PaperStatements, Part, TimeTo, Value
from verification.suite.pages.headline import QUESTION


@dataclass(frozen=True)
class Question:
    """A row of the index. page: with the evidence; note: what the numbers need to be understood."""

    words: str
    page: str
    parts: tuple[Part, ...] = ()
    note: str = ""


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

# (case, begin of the caption) of the tables that answers look into
PASSES = "moving-passes-spatial", "Largest strain that a pass adds [1e-3], kinematic"
FASTER, TIMES = (
    ("work-precision", "How many times the time of SAM"),
    ("times", "with the reference off by its uncertainty"),
)
STRAIN_OFF = "model-limits-plastic", "a/R at which"
STEP = "peers", "Step: references"
LOOP, PAPER_LOOP = ("paper-loop", "perfect: what each loop leaves"), "paper, stop on stress"
SLID = "figure-8-4", "Pressure and the largest strain"
FILM = "rough-film", "What the film changes"

QUESTIONS = (
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
        "In later passes over kinematic steel single elements of FEM flow on, the less the smaller they are.",
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
                "the same under alternating traction: strain that later cycles add, over the first, SAM",
                "cyclic-sliding.alternating-sam-adds",
                percent=True,
            ),
            Value("the same, FEM", "cyclic-sliding.alternating-fem-adds", percent=True),
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
    Question(
        "What does an error of 1 % cost?",
        "cost",
        (
            TimeTo(),
            Cell(
                "time of three-dimensional FEM over that of SAM, full slip, at the smallest error of both "
                "that the reference decides; in brackets with the reference off by its uncertainty",
                *FASTER,
                ("Rigid sphere on Swift steel in full slip, μ = 0.2, p₀/σ_y0 = 4, 5 load steps", "FEM, 3D"),
                TIMES,
                "{} ({}) times",
                "work-precision.friction-0-2-faster",
            ),
            Cell(
                "the same of axisymmetric FEM, sphere at rest, p₀/σ_y0 = 6.2: below 1 FEM is the faster one",
                *FASTER,
                ("Rigid sphere on Swift steel, p₀/σ_y0 = 6.2, 5 load steps", "FEM, axisymmetric"),
                TIMES,
                "{} ({}) times",
            ),
            Held("on ratios of such times and on their references", ("work-precision.*",)),
        ),
        "The table below has each contact. A sphere at rest is a problem of two dimensions for finite "
        "elements, which are axisymmetric there; for SAM every contact has three.",
    ),
    Question(
        "How uncertain is a number, and is that said?",
        "cost",
        (
            Value(
                "share of the stated uncertainties that cover the error",
                "uncertainty-study.covered",
                percent=True,
            ),
            Value("the median uncertainty over the error", "uncertainty-study.over-error", "{} times"),
            Value("share of runs that reach the accuracy asked for", "accuracy.reached", percent=True),
        ),
    ),
    Question(
        "Where does the flat model of small strains stop being right?",
        "limits",
        (
            Value("elastic: mean pressure 5 % off", "model-limits.pressure-limit", "from a/R = {}"),
            Value("elastic: contact radius 5 % off", "model-limits.radius-limit", "from a/R = {}"),
            Cell(
                "Swift steel: largest plastic strain 5 % off; in brackets by two standard errors of a fit",
                *STRAIN_OFF,
                ("Swift steel",),
                ("largest plastic strain",),
                "from a/R = {}",
                "model-limits-plastic.strain-limit",
            ),
            Cell(
                "perfectly plastic: largest plastic strain 5 % off",
                *STRAIN_OFF,
                ("perfectly plastic, yield strain 1/300",),
                ("largest plastic strain",),
                "from a/R = {}",
            ),
            Value(
                "perfectly plastic: mean pressure 5 % off",
                "model-limits-plastic.perfect-limit",
                "from a/R = {}",
            ),
        ),
        "SAM and FEM share a flat surface and small strains, which are held here against finite strain and "
        "the true sphere. A rigid sphere on the Swift steel of these pages has a/R = 0.04 at p₀ = 4 σ_y0 and "
        "0.06 at 6.2 σ_y0.",
    ),
    Question(
        "Which published numbers are reproduced?",
        "published",
        (
            Value(
                "Fox (1948), series: stress in a two-layer pavement",
                "pavement.fox",
                "{} units of the last printed digit",
            ),
            Largest(
                "Jackson & Green (2005), fit to finite elements: load and area of indentation",
                ("indentation.sam-*-jackson",),
            ),
            Largest(
                "Kogut & Etsion (2002), fit to finite elements: load and area of indentation",
                ("indentation.sam-*-kogut",),
            ),
            Largest(
                "Etsion et al. (2005), fit to finite elements: unloading from 5 to 20 times the approach at "
                "first yield",
                ("unloading-fit.*",),
            ),
            Largest("Ghaednia et al. (2019), fit to finite elements: linear hardening", ("hardening-fit.*",)),
            Largest("first yield below a sliding contact, closed form", ("first-yield.*",)),
            Largest(
                "hardness of 3 yield stresses of a perfectly plastic body, by our FEM of finite strain",
                ("model-limits-plastic.hardness",),
            ),
            Largest(
                "Hamilton (1983), closed form: largest stress of a sphere at rest",
                ("sliding-sphere.interior-maximum",),
            ),
            Held("on shakedown limits of travelling loads (Ponter 1985; Johnson)", ("travelling-load.*",)),
        ),
    ),
    Question(
        "Which other programs were compared?",
        "peers",
        (
            Value(
                "pressure, Tamaas, ContactMechanics and aspher against SAM (L2)",
                "peers.same-solution",
                percent=True,
            ),
            Value(
                "processor time of Tamaas over that of SAM, elastic sphere, same error",
                "peers.hertz-tamaas",
                "{} times",
            ),
            Value(
                "the same of ContactMechanics, elastic sphere", "peers.hertz-contact-mechanics", "{} times"
            ),
            Value(
                "the same of ContactMechanics, rough elastic patch of 1024² cells",
                "peers.rough-contact-mechanics",
                "{} times",
            ),
            Value("the same of Tamaas, elasto-plastic step, 16 × 32 × 32 cells", "peers.step-16", "{} times"),
            Value("the same of Tamaas, elasto-plastic step, 32 × 64 × 64 cells", "peers.step-32", "{} times"),
            Cell(
                "the same of aspher (C++), elastic sphere: below 1 aspher is the faster one",
                "peers",
                "Hertz: time",
                ("aspher",),
                ("over SAM's",),
                "{} times",
            ),
            Cell(
                "the same of aspher, rough elastic patch of 1024² cells",
                "peers",
                "Rough: each",
                ("1024²", "aspher"),
                ("over SAM's",),
                "{} times",
            ),
            Cell(
                "largest plastic strain to which Tamaas converges in that step, in a periodic box",
                *STEP,
                ("Tamaas",),
                ("largest strain [σ_y/E]",),
                "{} σ_y/E",
            ),
            Cell(
                "the same on a half-space, by axisymmetric FEM: SAM's limit",
                *STEP,
                ("SAM",),
                ("largest strain [σ_y/E]",),
                "{} σ_y/E",
            ),
        ),
        "Times of the step are each to its own limit: the box of Tamaas is periodic, the body of SAM is not.",
    ),
    Question(
        QUESTION,
        "running-in",
        (PaperStatements(),),
        "The table below has each statement. Of Bosman & Schipper (2011): what their text says of their five "
        "runs.",
    ),
    Question(
        "What does the method of the paper do as it is printed?",
        "plastic",
        (
            Cell(
                "too much largest plastic strain by their plastic loop, perfect plasticity, in one load step",
                *LOOP,
                (PAPER_LOOP, "1"),
                ("off, same steps",),
            ),
            Cell("the same in 20 load steps", *LOOP, (PAPER_LOOP, "20"), ("off, same steps",)),
            Cell(
                "pressure off FEM, averaged over 0.2 a, where friction does not act on the pressure, μ = 0.4",
                *SLID,
                ("0.4", "SAM, decoupled"),
                ("over hats of 0.2 a",),
            ),
            Cell("the same where it does", *SLID, ("0.4", "SAM"), ("over hats of 0.2 a",)),
            Cell(
                "change of the largest pressure by the film on a smooth patch against steel: less than 5 %, "
                "as they say",
                *FILM,
                ("smooth, steel", "512 × 512"),
                ("change",),
            ),
            Cell(
                "the same on a rough patch against a rigid plane: not less than 5 %",
                *FILM,
                ("rough, rigid", "256 × 256"),
                ("change",),
            ),
        ),
        "Their loop stops on stress before the flow rule holds. As printed (Eqs. 12 and 13) the film grows "
        "thicker under pressure; here it thins.",
    ),
    Question(
        "Do the results satisfy the equations?",
        "conditions",
        (
            Held(
                "on equilibrium, contact, friction, yield and flow, evaluated by formulas of their own",
                ("certificates.*",),
            ),
            Held("on the energy balance", ("energy.*", "energy-fem.*")),
        ),
    ),
    Question(
        "What does extreme or wrong input do?",
        "robustness",
        (
            Held(
                "on extreme input: right, or the error that was expected, which says what to change",
                ("stability.*",),
            ),
            Held("on wrong input and killed runs", ("bad-input.*", "faults.*")),
        ),
    ),
    Question(
        "Would the tests notice a wrong number?",
        "robustness",
        (
            Value(
                "of the numbers of the numerical core, changed one at a time, are noticed by a test",
                "mutation.killed",
                percent=True,
            ),
            Value("of the others have no written reason why no test can notice", "mutation.unexplained"),
        ),
    ),
    Question(
        "What was compared with measurement?",
        "running-in",
        note="Nothing yet: every reference is a calculation, a closed form or a correlation. It would take "
        "friction, roughness and wear particles before and after running-in, on surfaces whose heights and "
        "hardness over depth are known. Akchurin, Bosman & Lugt (2017) measured friction and particle sizes.",
    ),
)
