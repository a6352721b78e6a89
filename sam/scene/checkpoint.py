# SPDX-License-Identifier: MIT
"""A solve in progress: what a solver hands out after a committed load step, and begins from instead of the first step.

A solver keeps its progress in dataclasses. `Checkpoint.of` takes such a record apart into arrays and plain values, which a
file can hold without any pickle, and `Checkpoint.tree` gives it back with mappings in place of the dataclasses. Floats keep
every bit, and arrays that were one object are one again.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, is_dataclass, replace

import numpy as np

JSON = None | bool | int | float | str | list["JSON"] | dict[str, "JSON"]
_ARRAY = "array"  # the one key of a mapping that stands for an array


@dataclass(frozen=True)
class Checkpoint:
    """A solve in progress.

    arrays: by name, of numbers or bool, in C order (another order of the memory would sum in another order); values: what
    JSON holds: `done` and `total` load steps, `cost` so far (names of sam.scene.result.COST), and the tree of the record.
    """

    model: str
    arrays: Mapping[str, np.ndarray]
    values: Mapping[str, JSON]

    @classmethod
    def of(
        cls, model: str, record: object, done: int, total: int, cost: Mapping[str, float | int]
    ) -> Checkpoint:
        """The checkpoint of a dataclass (of dataclasses, mappings with texts as keys, sequences, arrays and values)."""
        arrays: dict[str, np.ndarray] = {}
        tree = _taken_apart(record, "", arrays, {})
        return cls(model, arrays, {"done": done, "total": total, "cost": dict(cost), "tree": tree})

    def tree(self) -> dict:
        """The record: mappings with the names of its fields, lists, arrays and values."""
        return _put_together(self.values["tree"], self.arrays)

    def with_cost(self, more: Mapping[str, float | int]) -> Checkpoint:
        """The same with more counters or times."""
        return replace(self, values={**self.values, "cost": {**self.cost, **more}})

    @property
    def cost(self) -> Mapping[str, float | int]:
        return self.values["cost"]

    @property
    def done(self) -> int:
        return self.values["done"]

    @property
    def total(self) -> int:
        return self.values["total"]


Keep = Callable[[Checkpoint], None]
"""Called by a solver after each committed load step. It decides itself which checkpoints it writes, and where."""


def check_model(start: Checkpoint | None, model: str) -> None:
    """Raise ValueError for the checkpoint of another model."""
    if start is not None and start.model != model:
        raise ValueError(f"start: a checkpoint of model {start.model}, needed is one of {model}")


def _taken_apart(value: object, path: str, arrays: dict[str, np.ndarray], names: dict[int, str]) -> JSON:
    """The value as JSON; its arrays go into `arrays`, each once, by the path where it was met first. names: by id."""

    def inner(key: str, part: object) -> JSON:
        return _taken_apart(part, f"{path}.{key}".removeprefix("."), arrays, names)

    if isinstance(value, np.generic):
        value = value.item()
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, np.ndarray):
        name = names.setdefault(id(value), path)
        arrays[name] = value
        return {_ARRAY: name}
    if is_dataclass(value):
        return {each.name: inner(each.name, getattr(value, each.name)) for each in fields(value)}
    if isinstance(value, Mapping):
        return {key: inner(key, part) for key, part in value.items()}
    return [inner(str(k), part) for k, part in enumerate(value)]


def _put_together(value: JSON, arrays: Mapping[str, np.ndarray]) -> object:
    if isinstance(value, dict):
        if set(value) == {_ARRAY}:
            return arrays[value[_ARRAY]]
        return {key: _put_together(part, arrays) for key, part in value.items()}
    return [_put_together(part, arrays) for part in value] if isinstance(value, list) else value
