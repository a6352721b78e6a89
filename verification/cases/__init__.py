# SPDX-License-Identifier: MIT
"""The verification cases: a file for each, or for several that differ in little, in the folder of its
family.

`<family>/<name>.toml` says the title, the question, the equations and what is claimed
(`verification.rows`). Where it names a scene and models, or sweeps, it needs nothing else but functions of
the module of the same name beside it that it names; else that module measures: a subclass of `Case` and a
tuple `CASES` of its instances.

Used by the harness of the suite, by the lists of the command line and by tests.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from importlib import import_module
from typing import Any

from verification.cases.case import Case
from verification.cases.compared import Compared
from verification.rows import LEVELS, CaseFile, case_files


@cache
def all_cases() -> dict[str, Case]:
    """Name -> case, in the order of the report."""
    return {name: case_of(file) for name, file in case_files().items()}


def case_of(file: CaseFile) -> Case:
    """What runs the case of a file."""
    said: dict[str, Any] = {key: getattr(file, key) for key in ("title", "question", "equations", "levels")}
    if file.scene or file.frame:
        return Compared(file.name, **said, alone=file.own, file=file)
    module = import_module(f"{__name__}.{file.path.parent.name}.{file.path.stem}")
    (case,) = (case for case in module.CASES if case.name == file.name)
    return replace(case, **said, file=file)


__all__ = ["LEVELS", "Case", "all_cases", "case_of"]
