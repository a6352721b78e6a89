# SPDX-License-Identifier: MIT
"""The verification cases, each of the file `<family>/<name>.toml` (`verification.rows`), with functions of
the module of the same name beside it that it names; without scene and frame that module measures, by
subclasses of `Case` in a tuple `CASES`.
"""

from dataclasses import replace
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from sam.scene import Problem, Scene, SceneError, problems, spelling
from verification.cases.case import Case, Context
from verification.cases.compared import Compared
from verification.cases.recipes import beside
from verification.cases.sweep import MODELS
from verification.quantities import QUANTITIES
from verification.references import REFERENCES
from verification.rows import FOLDER, LEVELS, CaseFile, case_files


@cache
def all_cases() -> dict[str, Case]:
    """Name -> case, in the order of the report."""
    return {name: case_of(file) for name, file in case_files().items()}


def case_of(file: CaseFile) -> Case:
    """What runs the case of a file."""
    said: dict[str, Any] = {key: getattr(file, key) for key in ("title", "question", "equations", "levels")}
    if file.own:
        _check(file)
    if file.cannot:
        said["needs"] = lambda: beside(file, file.cannot, {})()
    if file.scene or file.frame:
        case = Compared(file.name, **said, alone=file.own or file.alone, file=file)
        if file.own:
            _check_scenes(case)
        return case
    module = import_module(f"{__name__}.{file.path.parent.name}.{file.path.stem}")
    (case,) = (case for case in module.CASES if case.name == file.name)
    return replace(case, **said, file=file)


def _check(file: CaseFile) -> None:
    """Raises SceneError with every name in a file of a user that stands for nothing."""
    from verification.cases.kinds import KINDS, SWEPT  # noqa: PLC0415 - loads matplotlib

    own = file.scene.endswith(".toml")
    there = (file.path.parent / file.scene if own else FOLDER.parent / f"scenes/{file.scene}.toml").is_file()
    scenes = [path.name for path in sorted(file.path.parent.glob("*.toml"))]
    named = [] if there else [("scene", file.scene, scenes)]
    named += [("reference", file.reference, [*REFERENCES])] if file.reference else []
    named += [("figures", kind.partition(" ")[0], [*KINDS, *SWEPT]) for kind in file.figures]
    runs = [(f"runs.{name}.model", run.get("model", "")) for name, run in file.runs.items()]
    named += [(key, model, [*MODELS]) for key, model in runs]
    claims = [claim for claim in file.claims if not claim.take]
    named += [(claim.table, claim.quantity, [*QUANTITIES]) for claim in claims]
    faults = [
        Problem(key, spelling(name), f"one of {', '.join(known)}")
        for key, name, known in named
        if name not in known
    ]
    missing = {"sam", "fem"} - {model.partition("-")[0] for model in file.models}
    faults += [
        Problem(claim.table, ", ".join(gone), "models names it")
        for claim in claims
        if (gone := missing & {claim.model, claim.against})
    ]
    if faults:
        raise SceneError(faults, str(file.path))


def _check_scenes(case: Compared) -> None:
    """Raises SceneError of a file of a user whose keys, recipes or sweeps make no scene."""
    for level in case.levels:
        try:
            for scene in case.scenes(Context(case.name, Path(), level, lambda *_: None)):
                Scene.model_validate(scene.model_dump(exclude_none=True))
        except ValidationError as error:
            raise SceneError(problems(error), str(case.file.path)) from error


__all__ = ["LEVELS", "Case", "all_cases", "case_of"]
