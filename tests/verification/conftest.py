# SPDX-License-Identifier: MIT
"""A coarse scene with the results of both models, a store that holds them, and solvers that only count."""

import pytest
from stored import BOTH, COARSE

from verification.runs import models
from verification.runs.store import Store


@pytest.fixture(scope="session")
def coarse_results():
    return {model: models.solve(COARSE, model) for model in BOTH}


@pytest.fixture
def kept(tmp_path, coarse_results):
    """A store with the results of both models."""
    kept = Store(tmp_path / "store")
    for model, result in coarse_results.items():
        kept.keep(COARSE, model, result)
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
