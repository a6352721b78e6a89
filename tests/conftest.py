# SPDX-License-Identifier: MIT
"""What holds for every test: no store of the user (tests of the store name their own); one thread of BLAS for
each process unless the user asks for another number, as `make test` shares the tests among processes; what
Python has compiled is kept, as processes that tests start would each compile all libraries anew.
"""

import os
from pathlib import Path

import pytest

THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")

os.environ["SAMFEM_STORE"] = ""
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
for name in THREADS:  # BLAS reads them when numpy is loaded, here and in the processes that are started
    os.environ.setdefault(name, "1")

import stored  # noqa: E402 - these load numpy
from builders import COARSE, scene_text  # noqa: E402
from hypothesis import settings  # noqa: E402
from hypothesis.internal.conjecture import providers  # noqa: E402

from samfem.cli import main  # noqa: E402
from verification.runs import meshes, models  # noqa: E402
from verification.runs.store import Store  # noqa: E402

# the same examples in every run, on a machine of any speed: none of the numbers in the sources of the modules
# that happen to be loaded, which takes seconds; nothing is written
providers._get_local_constants = lambda: providers._local_constants
settings.register_profile("fixed", derandomize=True, deadline=None)
settings.load_profile("fixed")


def pytest_xdist_auto_num_workers() -> int:
    """Processes for `pytest -n auto`: the cores that this process may use, maybe fewer than there are."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@pytest.fixture(scope="session", autouse=True)
def meshes_once():
    """Each mesh of a run is read by a process of its own once: that takes half a second."""
    found, read = {}, meshes.read_apart

    def once(reader, path, *more, **how):
        key = path[-4:], Path(path).read_bytes()
        if path[-4:] not in (".vtr", ".vtu"):
            return read(reader, path, *more, **how)
        if key not in found:
            found[key] = read(reader, path, *more, **how)
        return found[key]

    meshes.read_apart = once
    yield
    meshes.read_apart = read


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty folder, which is the current one."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def samfem(capsys):
    """Runs the command with these words, asserts its exit code, and returns what it prints."""

    def run(*words, code=0):
        capsys.readouterr()
        found = main([str(word) for word in words])
        said = capsys.readouterr()
        assert found == code, said.err
        return said

    return run


@pytest.fixture
def sphere_folder(folder):
    """The current folder, with the scene files sphere.toml (defaults) and coarse.toml."""
    (folder / "sphere.toml").write_text(scene_text())
    (folder / "coarse.toml").write_text(scene_text(add="unload = true\n" + COARSE))
    return folder


@pytest.fixture
def refused(folder, samfem):
    """Runs a command that is refused, leaves no traceback and changes no file here; returns its message."""

    def run(*words):
        before = sorted(folder.rglob("*"))
        said = samfem(*words, code=2).err
        assert sorted(folder.rglob("*")) == before and "Traceback" not in said
        return said

    return run


@pytest.fixture(scope="session")
def coarse_results():
    return {model: models.solve(stored.COARSE, model) for model in stored.BOTH}


@pytest.fixture
def kept(tmp_path, coarse_results):
    """A store with the results of both models."""
    kept = Store(tmp_path / "store")
    for model, result in coarse_results.items():
        kept.keep(stored.COARSE, model, result)
    return kept


@pytest.fixture
def counted(monkeypatch, coarse_results):
    """The models that were asked to solve; they answer at once."""
    calls = []

    def solve(scene, model, progress=None, **how):
        calls.append(model)
        return coarse_results[model]

    monkeypatch.setattr(models, "solve", solve)
    return calls
