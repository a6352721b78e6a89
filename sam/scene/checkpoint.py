# SPDX-License-Identifier: MIT
"""A solve in progress: what a solver hands out after a committed load step, and begins from instead of the
first step.

A solver keeps its progress in a dataclass. `Checkpoint.of` takes it apart into arrays and plain values, which
a file can hold without any pickle, and `Checkpoint.record` builds it again (see `sam.scene.codec`). Floats
keep every bit, and arrays that were one object are one again.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np

from sam.scene.codec import build, encode, unpacked

T = TypeVar("T")


@dataclass(frozen=True)
class Checkpoint:
    """A solve in progress.

    Parameters
    ----------
    model
        Name of the model that made it.
    arrays
        By name, of numbers or bool, in C order (another order of the memory would sum in another order).
    values
        What JSON holds: `done` and `total` load steps, `cost` so far (names of `sam.scene.COST`), and the
        tree of the record.
    """

    model: str
    arrays: Mapping[str, np.ndarray[Any, Any]]
    values: Mapping[str, Any]

    @classmethod
    def of(
        cls, model: str, record: object, *, done: int, total: int, cost: Mapping[str, float | int]
    ) -> Checkpoint:
        """The checkpoint of a record that `sam.scene.codec.encode` can take apart."""
        tree, arrays = encode(record)
        return cls(model, arrays, {"done": done, "total": total, "cost": dict(cost), "tree": tree})

    def record(self, kind: type[T]) -> T:
        """The record, a `kind`. Raises CodecError if it is of another type."""
        return build(self.tree(), kind)

    def tree(self) -> dict[str, Any]:
        """The record for a reader that does not know its type: tables with the names of its fields, arrays
        and values.
        """
        tree: dict[str, Any] = unpacked(self.values["tree"], self.arrays)
        return tree

    def with_cost(self, more: Mapping[str, float | int]) -> Checkpoint:
        """The same with more counters or times."""
        return replace(self, values={**self.values, "cost": {**self.cost, **more}})

    @property
    def cost(self) -> Mapping[str, float | int]:
        """Counters and times so far."""
        cost: Mapping[str, float | int] = self.values["cost"]
        return cost

    @property
    def done(self) -> int:
        """Committed load steps."""
        return int(self.values["done"])

    @property
    def total(self) -> int:
        """Load steps of the whole scene."""
        return int(self.values["total"])


Keep = Callable[[Checkpoint], None]
"""Called by a solver after each committed load step. It decides itself which checkpoints it writes, and
where.
"""


def check_model(start: Checkpoint | None, model: str) -> None:
    """Raise ValueError for the checkpoint of another model."""
    if start is not None and start.model != model:
        raise ValueError(f"start: a checkpoint of model {start.model}, needed is one of {model}")
