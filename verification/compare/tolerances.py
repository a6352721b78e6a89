# SPDX-License-Identifier: MIT
"""Tolerances that a user gives in place of those of this room: by the scene, by an option, in Python."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from pydantic import ValidationError

from sam.scene import Compare, Problem, Scene, SceneError, problems, spelling
from verification.compare.comparison import names_of_rows
from verification.compare.verdicts import CLAIM
from verification.judging import RowStatus, Verdict
from verification.text.console import unknown

IN_SCENE, ASKED = "[compare] tolerances", "the option or argument tolerance"


@dataclass(frozen=True)
class Tolerances:
    """Those given. values: name of a row, of a spot without its place -> tolerance; sources: the same ->
    who gave it.
    """

    values: Mapping[str, float] = field(default_factory=dict)
    sources: Mapping[str, str] = field(default_factory=dict)

    def judged(self, rows: Sequence[Verdict]) -> list[Verdict]:
        """The rows with these tolerances, and who gave each at the head of its reason."""
        return [self._judged(row) for row in rows]

    def _judged(self, row: Verdict) -> Verdict:
        name = row.quantity.partition(" at ")[0]  # of a spot: without its place
        if name not in self.values or row.row.metric == CLAIM:
            return row
        given = self.values[name]
        reason = f"given by {self.sources[name]}; without it {row.row.tolerance:g}: {row.row.reason}"
        changed = row.row.model_copy(update={"tolerance": given, "reason": reason})
        return replace(row, row=changed, status=RowStatus.PASSED if row.error <= given else RowStatus.FAILED)


def tolerances_of(scene: Scene, given: Mapping[str, object], source: str) -> Tolerances:
    """Those of the scene, and `given` in their place where both have one.

    given: name -> a number, or a text such as "2 %". Raises SceneError with every name that no row of the
    scene has, and every value that is no tolerance; source names the scene in it.
    """
    known, faults = names_of_rows(scene), []
    of_scene = (scene.compare.tolerances if scene.compare else None) or {}
    for where, names in (("compare.tolerances", of_scene), ("tolerances", given)):
        for name in names:
            if name not in known:
                allowed = unknown("quantity", [name], known, f"this scene has {', '.join(known)}")
                faults.append(Problem(f"{where}.{name}", spelling(names[name]), allowed))
    values = dict(of_scene)
    try:
        values |= Compare(tolerances=dict(given)).tolerances
    except ValidationError as error:
        faults += problems(error)
    if faults:
        raise SceneError(faults, source)
    return Tolerances(values, dict.fromkeys(of_scene, IN_SCENE) | dict.fromkeys(given, ASKED))
