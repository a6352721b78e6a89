# SPDX-License-Identifier: MIT
"""The questions of the first page, and what answers each: the one table that says which gates belong to
which.

The numbers are computed of the results; a question whose cases did not run is answered by that.
"""

from __future__ import annotations

from verification.suite.pages.agreement import AGREEMENT
from verification.suite.pages.findings import Cell, Held, Largest, PaperStatements, TimeTo, Value
from verification.suite.pages.headline import QUESTION
from verification.suite.pages.question import Question

# (case, begin of the caption) of the tables that answers look into
FASTER, TIMES = (
    ("work-precision", "How many times the time of SAM"),
    ("times", "with the reference off by its uncertainty", "error"),
)
STRAIN_OFF = "model-limits-plastic", "a/R at which"
STEP = "peers", "Step: references"
LOOP, PAPER_LOOP = ("paper-loop", "perfect: what each loop leaves"), "paper, stop on stress"
FILM = "rough-film", "What the film changes"

QUESTIONS = (
    *AGREEMENT,
    Question(
        "What does an error of 1 % cost?",
        "cost",
        (
            TimeTo(),
            Cell(
                "time of three-dimensional FEM over that of SAM in full slip, at the smallest error both "
                "reach and the reference resolves; in brackets with the reference off by its uncertainty",
                *FASTER,
                ("Rigid sphere on Swift steel in full slip, μ = 0.2, p₀/σ_y0 = 4, 5 load steps", "FEM, 3D"),
                TIMES,
                "{} ({}) times at an error of {}",
                "work-precision.friction-0-2-faster",
            ),
            Cell(
                "the same of axisymmetric FEM, sphere at rest, p₀/σ_y0 = 6.2: below 1 FEM is the faster one",
                *FASTER,
                ("Rigid sphere on Swift steel, p₀/σ_y0 = 6.2, 5 load steps", "FEM, axisymmetric"),
                TIMES,
                "{} ({}) times at an error of {}",
            ),
            Held("on ratios of such times and on their references", ("work-precision.*",)),
        ),
        "A sphere at rest is a problem of two dimensions for finite "
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
                "Swift steel: largest plastic strain 5 % off; the range: two standard errors of a fit",
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
        "Of Bosman & Schipper (2011): what their text says of their five runs.",
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
            Value(
                "pressure off FEM, averaged over 0.2 a, μ = 0.4, solved as if friction did not act on it, "
                "over that with friction acting on it, as SAM solves it",
                "figure-8-4.mu-0-4-decoupled-hats",
                "{} times",
            ),
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
        "thicker under pressure; here it thins. The runs of running-in take backward Euler and a film that "
        "thins; between like bodies, steel on steel, friction does not act on the pressure.",
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
