# SPDX-License-Identifier: MIT
"""Other machines: the same solves with one thread and with two, in a process for each number, have the same
results; the command that runs the suite in other environments: what it calls failed or not run; it goes on.
"""

import os

import numpy as np
import pytest
import worker_functions
from builders import PERFECT, hertz_force, running_in, scene
from run_environments import environments, main

from sam.scene import Status
from verification.cases.recipes import Resolution, resolved_at
from verification.cost.measured import alone
from verification.runs.models import FEM, SAM

CORES = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
two_cores = pytest.mark.skipif(CORES < 2, reason="a second thread on the same core is none to numpy")
COUNTERS = ("contact_iterations", "plastic_iterations", "newton_iterations", "step_cuts")


def sphere(mu=None):
    """A load step beyond yield, with a coefficient of friction or without."""
    made = scene(
        body={"plasticity": PERFECT},
        loading={"force": hertz_force(2.5e9), "steps": 1},
        friction=mu and {"coefficient": mu},
    )
    return resolved_at(made, Resolution(8, 8))


SPHERES = (sphere(), SAM), (sphere(0.2), SAM), (sphere(), FEM)
ASKED = (*SPHERES, (running_in(steps=1), SAM))


@pytest.fixture(scope="module")
def pairs():
    """Of each that is asked: both results, which end alike, and the relative difference that is allowed: of
    rounding, or of the tolerance where an iteration more or less was taken.
    """
    found = []
    each = [alone(worker_functions.solved, ASKED, threads=threads) for threads in (1, 2)]
    for (of, _), one, two in zip(ASKED, *each, strict=True):
        assert one.status is two.status and one.status in (Status.CONVERGED, Status.UNDER_RESOLVED)
        same = all(one.cost.get(name) == two.cost.get(name) for name in COUNTERS)
        found.append((one, two, 1e-10 if same else of.solver.tolerance))
    return found


@two_cores
@pytest.mark.parametrize("k", range(len(SPHERES)), ids=["SAM", "SAM, friction", "FEM"])
def test_every_number_of_a_load_step_is_that_of_one_thread(pairs, k):
    one, two, allowed = pairs[k]
    largest = {"Pa": one.quantities["p_max_Pa"], "m": one.quantities["approach_m"]}
    parts = [(one.tables[name], two.tables[name]) for name in ("axis", "line", "plane")]
    parts += [(getattr(one.fields, kind), getattr(two.fields, kind)) for kind in ("point_data", "cell_data")]
    for first, second in [*parts, (one.quantities, two.quantities)]:
        for key, values in first.items():
            if key != "state" and values is not None:
                a, b = np.asarray(values, dtype=float), np.asarray(second[key], dtype=float)
                zero = 1e-9 * largest.get(key.rpartition("_")[2], 0.0)  # less everywhere is rounding
                size = max(np.nanmax(np.abs(a), initial=0.0), zero / allowed)
                np.testing.assert_allclose(b, a, rtol=0.0, atol=allowed * size, err_msg=key)


@two_cores
def test_the_same_cells_are_worn_and_lose_their_film(pairs):
    """Load steps may differ by the tolerance: cycles at random add up to five times that."""
    one, two, _ = pairs[-1]
    (worn, other), (mu, other_mu) = (
        [np.asarray(each.tables["surface"][name], dtype=float) for each in (one, two)]
        for name in ("worn_m", "friction")
    )
    assert np.array_equal(worn > 0.0, other > 0.0) and worn.max() > 0.0
    assert np.array_equal(np.isnan(mu), np.isnan(other_mu)) and np.array_equal(mu > 0.25, other_mu > 0.25)
    np.testing.assert_allclose(other, worn, rtol=0.0, atol=5e-4 * worn.max())


PLAIN = {"numpy": ["Haswell"], "scipy": ["Haswell"], "threads": [1], "features": ["AVX2"], "cores": 2}
SUITE = """import os, pytest
def test_language(): assert os.environ.get("LC_ALL") != "C"
def test_other(): pass
@pytest.mark.skip
def test_skipped(): pass
"""


def test_a_failure_in_one_environment_is_told_and_does_not_stop_the_next(tmp_path, capsys):
    (path := tmp_path / "test_small.py").write_text(SUITE, encoding="utf-8")
    words = ["--", str(path), "-p", "no:randomly", f"--rootdir={tmp_path}", f"--confcutdir={tmp_path}"]
    file = tmp_path / "table.md"
    assert main(["c-locale", "dumb", "--out", str(file), *words]) == 1
    failed, passed = file.read_text(encoding="utf-8").splitlines()[2:]
    assert failed.startswith("| c-locale |") and "FAILED, exit code 1: 1 failed, 1 passed, 1 skipp" in failed
    assert passed.startswith("| dumb |") and "| 2 passed, 1 skipped in " in passed
    assert "def test_language" in capsys.readouterr().out  # with the output of pytest
    assert main(["dumb", *words, "-k", "nonesuch"]) == 1  # no tests


@pytest.mark.parametrize(
    ("taken", "runs"),
    [
        (["Prescott", "Prescott"], True),
        (["Katmai", "Katmai"], True),  # Prescott's kernel by an older name
        (["Haswell", "Haswell"], False),  # that of this machine
        (["Prescott", "Haswell"], False),
        (["Nehalem", "Nehalem"], False),  # another environment's
        ([None, None], False),
    ],
)
def test_a_kernel_counts_if_both_libraries_took_one_of_its_own(taken, runs):
    found = PLAIN | {"numpy": taken[:1], "scipy": taken[1:]}
    assert environments()["openblas-prescott"].holds(found, PLAIN) is runs
