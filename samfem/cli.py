# SPDX-License-Identifier: MIT
"""The command `samfem`. Exit codes: 0 converged or every gate held, 1 not so, 2 wrong input, 130 interrupted.

Only the standard library and the names of the models are loaded here; a command loads what it needs when it
runs.
"""

from __future__ import annotations

import argparse
import errno
import os
import sys
from collections.abc import Sequence
from contextlib import ExitStack, redirect_stderr, redirect_stdout
from importlib import import_module
from importlib.metadata import version
from pathlib import Path
from typing import Any

from verification import foreign_package
from verification.runs.models import MODELS, SAM
from verification.text.console import Cleaned, print_anything, unknown

NOT_MET, WRONG_INPUT, INTERRUPTED = 1, 2, 130
FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
NO_MEMORY = ("failed to map segment", "annot allocate memory", "can't start new thread")
"""In the errors of libraries that are loaded or threads that are started without memory for them."""
DEBUG = "SAMFEM_DEBUG"
MOST_WORKERS = 1000  # more than any machine has; a mistyped number is refused
STARTS = ("sphere", "plastic", "indentation", "sliding", "coated", "rough", "measured", "running-in")
"""Kinds of scene that `samfem new` writes."""
FORMATS = ("inp", "msh", "xdmf")
"""Kinds of mesh that `samfem export` writes."""
PICTURES = ("worn", "plastic-zone", "contact", "mises", "imprint", "surface")
"""Those that `samfem view` draws; of a run that has several the first says most."""
SHELLS = ("bash", "zsh", "tcsh")
CLAIMS = ("negligible-film",)
"""Those of [compare] in a scene."""
COMMANDS = {
    "solve": ("samfem.solving", "solve"),
    "plan": ("samfem.planning", "plan"),
    "compare": ("samfem.comparing", "compare"),
    "verify": ("samfem.verifying", "verify"),
    "report": ("samfem.verifying", "report"),
    "publish": ("samfem.publishing", "publish"),
    "pages": ("samfem.verifying", "pages"),
    "export": ("samfem.exporting", "export"),
    "store": ("samfem.housekeeping", "store"),
    "sweep": ("samfem.sweeping", "sweep"),
    "view": ("samfem.viewing", "view"),
    "new": ("samfem.starting", "new"),
    "examples": ("samfem.starting", "examples"),
    "schema": ("samfem.starting", "schema"),
    "completion": ("samfem.starting", "completion"),
}
"""Command -> module and function that run it; its options are the keywords of the function."""
REFUSALS = "samfem.refusals"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code; wrong input ends in a message, never in a traceback."""
    with ExitStack() as streams:
        if sys.stderr is None:
            streams.enter_context(redirect_stderr(streams.enter_context(open(os.devnull, "w"))))
        if sys.stdout is None:  # the next file that is opened would take its place
            return _fail("standard output is closed: give it a place, such as > /dev/null", NOT_MET)
        print_anything(sys.stdout)
        streams.enter_context(redirect_stdout(Cleaned(sys.stdout)))
        streams.enter_context(redirect_stderr(Cleaned(sys.stderr)))
        return _ended(sys.argv[1:] if arguments is None else arguments)


def _ended(arguments: Sequence[str]) -> int:
    """The exit code of one command."""
    try:
        code = _run(_options(arguments))
        sys.stdout.flush()
        return code
    except SystemExit as stop:  # argparse: 0 after --help, 2 for a wrong command line
        return stop.code if isinstance(stop.code, int) else NOT_MET
    except KeyboardInterrupt as stop:
        return _fail(str(stop) or "interrupted: nothing unfinished counts as a result", INTERRUPTED)
    except BrokenPipeError:  # the reader of stdout is gone
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return NOT_MET
    except OSError as error:
        full = "; free some space there, or give another --out" if error.errno in FULL else ""
        return _fail(f"{error}{full}", NOT_MET)
    except Exception as error:
        if isinstance(error, MemoryError) or any(words in str(error) for words in NO_MEMORY):
            lower = "lower grid.cells, grid.layers or fem.cells_per_radius, or raise the limit (ulimit -v)"
            return _fail(f"out of memory: {lower}; samfem plan estimates the need", NOT_MET)
        if os.environ.get(DEBUG):  # a defect of the program, not of the input
            raise
        if words := foreign_package():
            return _fail(words, NOT_MET)
        what = f"{type(error).__name__}: {error}"
        return _fail(f"internal error, please report it: {what} ({DEBUG}=1 shows where)", NOT_MET)


def _run(options: argparse.Namespace) -> int:
    words = vars(options)
    module, function = COMMANDS[words.pop("command")]
    refusals = import_module(REFUSALS).REFUSALS
    try:
        code: int = getattr(import_module(module), function)(**words)
    except refusals as error:
        return _fail(str(error), WRONG_INPUT)
    return code


def _fail(message: str, code: int) -> int:
    print(f"samfem: error: {message}", file=sys.stderr)
    return code


def _options(arguments: Sequence[str]) -> argparse.Namespace:
    """The parsed command line; a wrong one ends in SystemExit, an unknown name with those that look alike."""
    made = _parser()
    commands = tuple(COMMANDS)
    named = next((word for word in arguments if not word.startswith("-")), None)
    if named is not None and named not in commands:
        made.error(unknown("command", [named], commands, f"the commands are {', '.join(commands)}"))
    return made.parse_args(arguments)


def _parser() -> argparse.ArgumentParser:
    """The parser of the command line."""
    made = argparse.ArgumentParser(
        prog="samfem",
        description="Contact of half-spaces by a semi-analytical method (SAM), "
        "verified against finite elements (FEM).",
        epilog="Exit code 0: converged, or every gate held; 1: not so, with what to change; "
        "2: the input is wrong.",
        allow_abbrev=False,
    )
    what: dict[str, Any] = {"dest": argparse.SUPPRESS, "default": argparse.SUPPRESS, "nargs": 0}
    made.add_argument("--version", action=_Version, help="show the version and stop", **what)
    commands = made.add_subparsers(title="commands", metavar="COMMAND", required=True)
    _add_scene_commands(commands)
    _add_export_command(commands)
    _add_verification_commands(commands)
    _add_store_command(commands)
    _add_sweep_command(commands)
    _add_view_command(commands)
    _add_starting_commands(commands, made)
    return made


def _add(commands: Any, name: str, text: str) -> argparse.ArgumentParser:
    parser: argparse.ArgumentParser = commands.add_parser(
        name, help=text, description=text[0].upper() + text[1:] + ".", allow_abbrev=False
    )
    parser.set_defaults(command=name)
    return parser


def _add_scene_commands(commands: Any) -> None:
    solve = _add(commands, "solve", "solve a scene with one model")
    compare = _add(commands, "compare", "solve scenes with SAM and FEM and compare the results")
    plan = _add(commands, "plan", "say what will be computed and what is left out; solves nothing")
    for parser in (solve, plan):
        parser.add_argument("path", metavar="SCENE", type=Path, help="scene file (TOML)")
    every = tuple(MODELS)
    solve.add_argument("--model", choices=every, default=SAM, help=f"default: {SAM}")
    _add_options_of_compare(compare, [model for model in every if model != SAM])
    of_scene = "./<name of SCENE>"
    for parser, end in ((solve, "MODEL"), (compare, "compare")):
        place = f"folder of the result, new or of an older one, which is replaced; default: {of_scene}-{end}"
        parser.add_argument("--out", metavar="DIR", type=Path, help=place)
        parser.add_argument("--figures", action="store_true", help="also draw figures into DIR/figures")
    again = "continue an interrupted solve from the checkpoint in DIR, to the same result"
    solve.add_argument("--resume", action="store_true", help=again)
    bars = "also solve on coarser grids and with other load steps, and give each quantity its uncertainty"
    solve.add_argument("--uncertainty", action="store_true", help=bars)
    for parser in (solve, compare):
        _add_anyway(parser)
    plan.add_argument("--json", dest="as_json", action="store_true", help="as JSON")


def _add_options_of_compare(compare: argparse.ArgumentParser, references: Sequence[str]) -> None:
    compare.add_argument("paths", metavar="SCENE", nargs="+", type=Path, help="scene file (TOML)")
    compare.add_argument(
        "--model", choices=references, help="default: the cheapest that can represent the scene"
    )
    own = "own data beside both models: a CSV file, a folder of them, or the mapping (TOML) of a mesh"
    compare.add_argument(
        "--with", dest="data", metavar="DATA", action="append", default=[], type=Path, help=own
    )
    limit = 'of a row, in place of its own and of that of the scene: p_max_Pa=0.02 or "p_max_Pa=2 %%"'
    compare.add_argument(
        "--tolerance",
        dest="tolerances",
        metavar="NAME=VALUE",
        action="append",
        default=[],
        type=_tolerance,
        help=limit,
    )
    claim = "also judge a claim about the scene by the exit code, as [compare] claim of the scene does"
    compare.add_argument("--claim", choices=CLAIMS, help=claim)
    page = "also write a page (HTML) with figures into DIR"
    compare.add_argument("--report", metavar="DIR", type=Path, help=page)
    junit = "also write the rows as a JUnit file, for continuous integration"
    compare.add_argument("--junit", metavar="FILE", type=Path, help=junit)
    _add_no_store(compare)


def _tolerance(text: str) -> tuple[str, float | str]:
    """Name and value; a value that is no number is refused with the names of the scene."""
    name, equals, value = (part.strip() for part in text.rpartition("="))
    if not (name and equals and value):
        raise argparse.ArgumentTypeError(f"{text[:40]!r} is not NAME=VALUE")
    try:
        return name, float(value)
    except ValueError:
        return name, value


def _add_export_command(commands: Any) -> None:
    export = _add(commands, "export", "write a mesh of a run for other programs")
    export.add_argument("folder", metavar="RUN", type=Path, help="folder that samfem solve wrote")
    what = "of Abaqus and CalculiX (the mesh alone), of Gmsh, or XDMF"
    export.add_argument("--format", dest="file_format", choices=FORMATS, required=True, help=what)
    export.add_argument(
        "--part", choices=("fields", "surface", "body"), default="fields", help="default: fields"
    )
    export.add_argument("--state", choices=("peak", "unloaded"), default="peak", help="default: peak")
    export.add_argument("--out", metavar="FILE", type=Path, help="default: ./<its name>.<format>")


def _add_verification_commands(commands: Any) -> None:
    verify = _add(commands, "verify", "run verification cases, judge their gates and write the report")
    which = "names, or files of own cases (.toml); default: all cases of the level"
    verify.add_argument("case", metavar="CASE", nargs="*", help=which)
    verify.add_argument("--level", choices=("quick", "full"), default="quick", help="default: quick")
    place = Path("reports/latest")
    verify.add_argument("--out", metavar="DIR", type=Path, default=place, help=f"default: {place}")
    _add_no_store(verify)
    shown = verify.add_mutually_exclusive_group()
    cases = "list the cases (or those named), one a line, and stop"
    shown.add_argument("--list", dest="show", action="store_const", const="cases", help=cases)
    gates = "list what the cases (or those named) must reach, with tolerances and reasons, and stop"
    shown.add_argument("--gates", dest="show", action="store_const", const="gates", help=gates)
    report = _add(commands, "report", "rebuild the pages of a finished report without solving")
    whole = "also write report.html, one page with everything and its figures inside"
    report.add_argument("--single-file", action="store_true", help=whole)
    report.add_argument("folder", metavar="DIR", type=Path, help="folder that samfem verify wrote")
    drawn = "instead draw the figures of DIR, a report or a run, as PDF; what the store lacks is solved again"
    report.add_argument("--pdf", action="store_true", help=drawn)
    _add_publish_command(commands)
    older = (
        "instead list the gates whose values differ from those of an older report; exit code 1 if any does"
    )
    report.add_argument("--against", metavar="OLDER", type=Path, help=older)
    stands = "with --against: a table (csv) of each older gate and what it is now; exit code 1 if one is lost"
    report.add_argument("--map", dest="table", metavar="FILE", type=Path, help=stands)


def _add_publish_command(commands: Any) -> None:
    publish = _add(
        commands, "publish", "run the cases that are missing in a store, and write the report of all"
    )
    which = "default: all cases of the level, and those that else run only when named"
    publish.add_argument("case", metavar="CASE", nargs="*", help=which)
    publish.add_argument("--level", choices=("quick", "full"), default="full", help="default: full")
    place, kept = Path("reports"), Path("reports/latest-publish")
    publish.add_argument("--out", metavar="DIR", type=Path, default=place, help=f"default: {place}")
    text = f"folder that keeps each case as it ends, so that a killed run goes on; default: {kept}"
    publish.add_argument("--store", metavar="DIR", type=Path, default=kept, help=text)
    pages = _add(commands, "pages", "write the pages of a published report again")
    made = f"folder that samfem publish wrote; default: {place}"
    pages.add_argument("folder", metavar="DIR", nargs="?", type=Path, default=place, help=made)
    older = "instead list the cases that are older than the code, or not there; exit code 1 if any is"
    pages.add_argument("--stale", dest="list_stale", action="store_true", help=older)
    whole = "also write report.html, one page with everything and its figures inside"
    pages.add_argument("--single-file", action="store_true", help=whole)
    many = "cases at once; those that measure times run alone; default: 2"
    publish.add_argument("--workers", metavar="N", type=_workers, default=2, help=many)


def _add_store_command(commands: Any) -> None:
    store = _add(commands, "store", "list the results that are kept for reuse, or prune them")
    what = "remove what is stale, damaged or left over; all: everything"
    store.add_argument("--prune", nargs="?", const="unusable", choices=("unusable", "all"), help=what)
    old = "with --prune: also remove what is older"
    store.add_argument("--older-than", metavar="DAYS", type=_days, help=old)


def _add_no_store(parser: argparse.ArgumentParser) -> None:
    text = "compute everything: neither take results from the store nor keep them there"
    parser.add_argument("--no-store", dest="use_store", action="store_false", help=text)


def _add_anyway(parser: argparse.ArgumentParser) -> None:
    text = "also begin what is predicted to take more than a day of processor time"
    parser.add_argument("--anyway", action="store_true", help=text)


def _days(text: str) -> float:
    days = float(text)
    if not 0 <= days < float("inf"):
        raise ValueError(text)
    return days


def _add_sweep_command(commands: Any) -> None:
    sweep = _add(commands, "sweep", "solve the scenes of a study and write one table of them")
    sweep.add_argument("path", metavar="STUDY", type=Path, help="study file (TOML)")
    place = "folder of the table, new or of an older one, which is replaced; default: ./<name of STUDY>-sweep"
    sweep.add_argument("--out", metavar="DIR", type=Path, help=place)
    where = sweep.add_mutually_exclusive_group()
    where.add_argument(
        "--workers", metavar="N", type=_workers, help="processes on this machine; default: one a core"
    )
    where.add_argument(
        "--scheduler", metavar="ADDRESS", help="solve on the Dask cluster whose scheduler is there"
    )
    runs = "write the table only, no folder for each scene"
    sweep.add_argument("--no-runs", dest="runs", action="store_false", help=runs)
    store = "solve every scene, and keep none in the store"
    sweep.add_argument("--no-store", dest="use_store", action="store_false", help=store)
    _add_anyway(sweep)


def _add_view_command(commands: Any) -> None:
    view = _add(commands, "view", "draw pictures in space of a finished run; needs no display")
    view.add_argument("folder", metavar="RUN", type=Path, help="folder that samfem solve wrote")
    one = "default: the first of these that the run has; without --out and --html: all of them"
    view.add_argument("--picture", dest="name", choices=PICTURES, help=one)
    where = view.add_mutually_exclusive_group()
    where.add_argument("--out", metavar="FILE.png", type=Path, help="default: RUN/figures/NAME-3d.png")
    turned = "one picture as a page that turns in a browser (pip install 'samfem[html]')"
    where.add_argument("--html", dest="page", metavar="FILE.html", type=Path, help=turned)


def _add_starting_commands(commands: Any, whole: argparse.ArgumentParser) -> None:
    new = _add(commands, "new", "write a commented scene that runs")
    new.add_argument(
        "kind",
        metavar="KIND",
        nargs="?",
        choices=STARTS,
        default=STARTS[0],
        help=f"{', '.join(STARTS)}; default: {STARTS[0]}",
    )
    examples = _add(commands, "examples", "list the scenes of the verification cases, or copy one")
    examples.add_argument(
        "name", metavar="NAME", nargs="?", help="copy this one, with the files that it names"
    )
    for parser in (new, examples):
        parser.add_argument("--out", metavar="FILE", type=Path, help="default: ./<its name>.toml")
    schema = _add(commands, "schema", "print the JSON schema of a scene, for editors")
    schema.add_argument("--study", action="store_true", help="that of a study for samfem sweep")
    completion = _add(commands, "completion", "print the completion of this command line for a shell")
    completion.add_argument("shell", choices=SHELLS)
    completion.set_defaults(parser=whole)


def _workers(text: str) -> int:
    if not (text.isascii() and text.isdigit() and 1 <= int(text[:9]) <= MOST_WORKERS):
        raise argparse.ArgumentTypeError(f"{text[:20]!r} is no whole number from 1 to {MOST_WORKERS}")
    return int(text)


class _Version(argparse.Action):
    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        print(f"samfem {version('samfem')}")
        parser.exit()


if __name__ == "__main__":
    sys.exit(main())
