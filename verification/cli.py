# SPDX-License-Identifier: MIT
"""The command `samfem`. Exit codes: 0 converged or every gate held, 1 not so, 2 wrong input, 130 interrupted.

Only the standard library and the names of the models are loaded here; each command loads what it needs when it runs.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from verification.models import FEM, LATER, MODELS, SAM

NOT_MET, WRONG_INPUT, INTERRUPTED = 1, 2, 130
DEBUG = "SAMFEM_DEBUG"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code. Never raises for wrong input, and never shows a traceback for it."""
    try:
        options = _parser().parse_args(arguments)
        code = _run(options)
        sys.stdout.flush()
        return code
    except SystemExit as stop:  # argparse: 0 after --help, 2 for a wrong command line
        return stop.code
    except KeyboardInterrupt:
        return _fail("interrupted: nothing unfinished counts as a result", INTERRUPTED)
    except BrokenPipeError:  # the reader of stdout is gone
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return NOT_MET
    except MemoryError:
        lower = "lower grid.cells, grid.layers or fem.cells_per_radius"
        return _fail(f"out of memory: {lower}; samfem plan estimates the need", NOT_MET)
    except OSError as error:
        return _fail(str(error), NOT_MET)
    except Exception as error:  # a defect of the program, not of the input
        if os.environ.get(DEBUG):
            raise
        what = f"{type(error).__name__}: {error}"
        return _fail(f"internal error, please report it: {what} ({DEBUG}=1 shows where)", NOT_MET)


def _run(options: argparse.Namespace) -> int:
    from sam.scene.errors import SceneError
    from verification.files import FolderError
    from verification.models import ModelError

    try:
        return options.command(options)
    except (SceneError, FolderError, ModelError) as error:
        return _fail(str(error), WRONG_INPUT)


def _fail(message: str, code: int) -> int:
    print(f"samfem: error: {message}", file=sys.stderr)
    return code


def _solve(options: argparse.Namespace) -> int:
    from verification.commands import solve

    return solve(options.scene, options.model, options.out, options.figures)


def _plan(options: argparse.Namespace) -> int:
    from verification.commands import plan

    return plan(options.scene, options.json)


def _compare(options: argparse.Namespace) -> int:
    from verification.commands import compare

    return compare(options.scene, options.model, options.out)


def _verify(options: argparse.Namespace) -> int:
    from verification.console import Progress
    from verification.verify import main as verify

    with Progress() as progress:
        return verify(options.case, options.level, options.out, options.list, progress)


def _report(options: argparse.Namespace) -> int:
    from verification.verify import rebuild

    return rebuild(options.dir)


def _later(options: argparse.Namespace) -> int:
    return _fail(f"{options.later}: not available in this version", WRONG_INPUT)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="samfem",
        description="Contact of half-spaces by a semi-analytical method (SAM), verified against finite elements (FEM).",
        epilog="Exit code 0: converged, or every gate held; 1: not so, with what to change; 2: the input is wrong.",
        allow_abbrev=False,
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="show the version and stop")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)
    _add_scene_commands(commands)
    _add_verification_commands(commands)
    sweep = _add(commands, "sweep", _later, "a study over a range of scenes (in a later version)")
    sweep.add_argument("rest", nargs=argparse.REMAINDER, metavar="...")
    sweep.set_defaults(later="samfem sweep")
    return parser


def _add(commands, name: str, command, text: str) -> argparse.ArgumentParser:
    parser = commands.add_parser(name, help=text, description=text[0].upper() + text[1:] + ".", allow_abbrev=False)
    parser.set_defaults(command=command)
    return parser


def _add_scene_commands(commands) -> None:
    solve = _add(commands, "solve", _solve, "solve a scene with one model")
    compare = _add(commands, "compare", _compare, "solve a scene with SAM and FEM and compare the results")
    plan = _add(commands, "plan", _plan, "say what will be computed and what is left out; solves nothing")
    for parser in (solve, compare, plan):
        parser.add_argument("scene", metavar="SCENE", type=Path, help="scene file (TOML)")
    every = (*MODELS, *LATER)
    references = [model for model in every if model != SAM]
    solve.add_argument("--model", choices=every, default=SAM, help=f"default: {SAM}")
    compare.add_argument("--model", choices=references, default=FEM, help=f"default: {FEM}")
    for parser, end in ((solve, "MODEL"), (compare, "compare")):
        place = f"folder of the result, new or of an older one, which is replaced; default: ./<name of SCENE>-{end}"
        parser.add_argument("--out", metavar="DIR", type=Path, help=place)
    solve.add_argument("--figures", action="store_true", help="also draw figures into DIR/figures")
    solve.add_argument("--resume", action=_Resume, nargs=0, help="in a later version")
    plan.add_argument("--json", action="store_true", help="as JSON")


def _add_verification_commands(commands) -> None:
    verify = _add(commands, "verify", _verify, "run verification cases, judge their gates and write the report")
    verify.add_argument("case", metavar="CASE", nargs="*", help="default: all cases of the level")
    verify.add_argument("--level", choices=("quick", "full"), default="quick", help="default: quick")
    place = Path("reports/latest")
    verify.add_argument("--out", metavar="DIR", type=Path, default=place, help=f"default: {place}")
    verify.add_argument("--list", action="store_true", help="list the cases and stop")
    report = _add(commands, "report", _report, "rebuild the page of a finished report without solving")
    report.add_argument("dir", metavar="DIR", type=Path, help="folder that samfem verify wrote")


class _Version(argparse.Action):
    def __call__(self, parser, *_):
        from importlib.metadata import version

        print(f"samfem {version('samfem')}")
        parser.exit()


class _Resume(argparse.Action):
    def __call__(self, parser, *_):
        parser.error("--resume: not available in this version")


if __name__ == "__main__":
    sys.exit(main())
