# SPDX-License-Identifier: MIT
"""The command `samfem`. Exit codes: 0 converged or every gate held, 1 not so, 2 wrong input, 130 interrupted.

Only the standard library and the names of the models are loaded here; a command loads what it needs when it
runs.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Sequence
from contextlib import ExitStack, redirect_stderr, redirect_stdout
from importlib import import_module
from importlib.metadata import version
from pathlib import Path
from typing import Any

from samfem.clash import foreign_package

try:
    from verification import need
    from verification.runs.models import MODELS, SAM
    from verification.text.console import Cleaned, print_anything, unknown
except ImportError:
    if words := foreign_package():
        sys.exit(f"samfem: error: {words}")
    raise

NOT_MET, WRONG_INPUT, INTERRUPTED = 1, 2, 130
NO_MEMORY = ("failed to map segment", "annot allocate memory", "can't start new thread")
"""In the errors of libraries and threads that are started without memory for them."""
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
    "solve": "samfem.solving",
    "plan": "samfem.solving",
    "compare": "samfem.comparing",
    "verify": "samfem.publishing",
    "report": "samfem.publishing",
    "publish": "samfem.publishing",
    "pages": "samfem.publishing",
    "export": "samfem.viewing",
    "store": "samfem.housekeeping",
    "sweep": "samfem.sweeping",
    "fit": "samfem.fitting",
    "view": "samfem.viewing",
    "new": "samfem.starting",
    "examples": "samfem.starting",
    "schema": "samfem.starting",
    "completion": "samfem.starting",
}
"""Command -> module that runs it, by a function of its name with the options as keywords."""
OF_REPORT = ("samfem.publishing", "samfem.viewing", "samfem.fitting")
"""Those of the modules that need the extra of that name, as do these options of the others:"""
DRAWN = ("figures", "report", "junit")


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
        full = error.errno in import_module("verification.runs.files").FULL
        return _fail(f"{error}{'; free some space there, or give another --out' * full}", NOT_MET)
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
    command = words.pop("command")
    refusals = import_module("samfem.refusals").REFUSALS
    try:
        if COMMANDS[command] in OF_REPORT:
            need(f"samfem {command}")
        for option in DRAWN:
            if words.get(option):
                need(f"--{option}")
        code: int = getattr(import_module(COMMANDS[command]), command)(**words)
    except refusals as error:
        return _fail(str(error), WRONG_INPUT)
    return code


def _fail(message: str, code: int) -> int:
    print(f"samfem: error: {message}", file=sys.stderr)
    return code


def _options(arguments: Sequence[str]) -> argparse.Namespace:
    """The parsed command line; SystemExit for a wrong one, with the names that look alike."""
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

    def command(name: str, text: str) -> argparse.ArgumentParser:
        words = text[0].upper() + text[1:] + "."
        parser: argparse.ArgumentParser = commands.add_parser(
            name, help=text, description=words, allow_abbrev=False
        )
        parser.set_defaults(command=name)
        return parser

    _of_scenes(command)
    _of_the_suite(command)
    _of_runs(command).set_defaults(parser=made)
    return made


Command = Callable[[str, str], argparse.ArgumentParser]
"""Adds a command, with what it does, and returns its parser."""
SCENE: dict[str, Any] = {"metavar": "SCENE", "type": Path, "help": "scene file (TOML)"}
FOLDER: dict[str, Any] = {"metavar": "DIR", "type": Path}
FILE: dict[str, Any] = {"metavar": "FILE", "type": Path}
RUN: dict[str, Any] = {"metavar": "RUN", "type": Path, "help": "folder that samfem solve wrote"}
ON: dict[str, Any] = {"action": "store_true"}
REPLACED = "new or of an older one, which is replaced; default:"
ANYWAY = "also begin what is predicted to take more than a day of processor time"
NO_STORE = "compute everything: neither take results from the store nor keep them there"
SINGLE = "also write report.html, one page with everything and its figures inside"


def _of_scenes(command: Command) -> None:
    add = command("solve", "solve a scene with one model").add_argument
    add("path", **SCENE)
    add("--model", choices=tuple(MODELS), default=SAM, help=f"default: {SAM}")
    add("--out", **FOLDER, help=f"folder of the result, {REPLACED} ./<name of SCENE>-MODEL")
    add("--figures", **ON, help="also draw figures into DIR/figures")
    again = "continue an interrupted solve from the checkpoint in DIR, to the same result"
    add("--resume", **ON, help=again)
    bars = "also solve on coarser grids and with other load steps, and give each quantity its uncertainty"
    add("--uncertainty", **ON, help=bars)
    add("--anyway", **ON, help=ANYWAY)

    add = command("compare", "solve scenes with SAM and FEM and compare the results").add_argument
    add("paths", **SCENE, nargs="+")
    cheapest = "default: the cheapest that can represent the scene"
    add("--model", choices=[model for model in MODELS if model != SAM], help=cheapest)
    own = "own data beside both models: a CSV file, a folder of them, or the mapping (TOML) of a mesh"
    add("--with", dest="data", metavar="DATA", action="append", default=[], type=Path, help=own)
    limit = 'of a row, in place of its own and of that of the scene: p_max_Pa=0.02 or "p_max_Pa=2 %%"'
    many: dict[str, Any] = {"metavar": "NAME=VALUE", "action": "append", "default": [], "type": _tolerance}
    add("--tolerance", dest="tolerances", **many, help=limit)
    claim = "also judge a claim about the scene by the exit code, as [compare] claim of the scene does"
    add("--claim", choices=CLAIMS, help=claim)
    add("--report", **FOLDER, help="also write a page (HTML) with figures into DIR")
    add("--junit", **FILE, help="also write the rows as a JUnit file, for continuous integration")
    add("--no-store", dest="use_store", action="store_false", help=NO_STORE)
    add("--out", **FOLDER, help=f"folder of the result, {REPLACED} ./<name of SCENE>-compare")
    add("--figures", **ON, help="also draw figures into DIR/figures")
    add("--anyway", **ON, help=ANYWAY)

    nothing = "say what will be computed and what is left out; solves nothing"
    made = command("plan", nothing)
    made.add_argument("path", **SCENE)
    add = made.add_mutually_exclusive_group().add_argument
    every = "also every stage of every model with its reason, and how fine a grid an error takes"
    add("--verbose", **ON, help=every)
    add("--json", dest="as_json", **ON, help="all of it as JSON")

    sweep = command("sweep", "solve the scenes of a study and write one table of them")
    add = sweep.add_argument
    add("path", metavar="STUDY", type=Path, help="study file (TOML)")
    add("--out", **FOLDER, help=f"folder of the table, {REPLACED} ./<name of STUDY>-sweep")
    where = sweep.add_mutually_exclusive_group().add_argument
    where("--workers", metavar="N", type=_workers, help="processes on this machine; default: one a core")
    where("--scheduler", metavar="ADDRESS", help="solve on the Dask cluster whose scheduler is there")
    table = "write the table only, no folder for each scene"
    add("--no-runs", dest="runs", action="store_false", help=table)
    fresh = "solve every scene, and keep none in the store"
    add("--no-store", dest="use_store", action="store_false", help=fresh)
    add("--anyway", **ON, help=ANYWAY)

    add = command("fit", "find parameters of a body from measured dents").add_argument
    add("path", metavar="FIT", type=Path, help="fit file (TOML)")
    add("--out", **FOLDER, help=f"folder of the parameters, {REPLACED} ./<name of FIT>-fit")
    add("--no-store", dest="use_store", action="store_false", help=fresh)


def _tolerance(text: str) -> tuple[str, float | str]:
    """Name and value; a value that is no number is refused with the names of the scene."""
    name, equals, value = (part.strip() for part in text.rpartition("="))
    if not (name and equals and value):
        raise argparse.ArgumentTypeError(f"{text[:40]!r} is not NAME=VALUE")
    try:
        return name, float(value)
    except ValueError:
        return name, value


def _of_the_suite(command: Command) -> None:
    verify = command("verify", "run verification cases, judge their gates and write the report")
    add = verify.add_argument
    which = "names, or files of own cases (.toml); default: all cases of the level"
    add("case", metavar="CASE", nargs="*", help=which)
    add("--level", choices=("quick", "full"), default="quick", help="default: quick")
    place = Path("reports/latest")
    add("--out", **FOLDER, default=place, help=f"default: {place}")
    add("--no-store", dest="use_store", action="store_false", help=NO_STORE)
    shown = verify.add_mutually_exclusive_group().add_argument
    cases = "list the cases (or those named), one a line, and stop"
    shown("--list", dest="show", action="store_const", const="cases", help=cases)
    gates = "list what the cases (or those named) must reach, with tolerances and reasons, and stop"
    shown("--gates", dest="show", action="store_const", const="gates", help=gates)

    add = command("report", "rebuild the pages of a finished report without solving").add_argument
    add("folder", **FOLDER, help="folder that samfem verify wrote")
    add("--single-file", **ON, help=SINGLE)
    drawn = "instead draw the figures of DIR, a report or a run, as PDF; what the store lacks is solved again"
    add("--pdf", **ON, help=drawn)
    older = (
        "instead list the gates whose values differ from those of an older report; exit code 1 if any does"
    )
    add("--against", metavar="OLDER", type=Path, help=older)
    stands = "with --against: a table (csv) of each older gate and what it is now; exit code 1 if one is lost"
    add("--map", dest="table", **FILE, help=stands)

    words = "run the cases that are missing in a store, and write the report of all"
    add = command("publish", words).add_argument
    every = "default: all cases of the level, and those that else run only when named"
    add("case", metavar="CASE", nargs="*", help=every)
    add("--level", choices=("quick", "full"), default="full", help="default: full")
    place, kept = Path("reports"), Path("reports/latest-publish")
    add("--out", **FOLDER, default=place, help=f"default: {place}")
    text = f"folder that keeps each case as it ends, so that a killed run goes on; default: {kept}"
    add("--store", **FOLDER, default=kept, help=text)
    many = "cases at once; those that measure times run alone; default: 2"
    add("--workers", metavar="N", type=_workers, default=2, help=many)

    add = command("pages", "write the pages of a published report again").add_argument
    made = f"folder that samfem publish wrote; default: {place}"
    add("folder", **FOLDER, nargs="?", default=place, help=made)
    stale = "instead list the cases that are older than the code, or not there; exit code 1 if any is"
    add("--stale", dest="list_stale", **ON, help=stale)
    add("--single-file", **ON, help=SINGLE)


def _of_runs(command: Command) -> argparse.ArgumentParser:
    """And of scenes to begin with. The parser of completion is returned: it prints what completes the whole
    command line.
    """
    add = command("export", "write a mesh of a run for other programs").add_argument
    add("folder", **RUN)
    what = "of Abaqus and CalculiX (the mesh alone), of Gmsh, or XDMF"
    add("--format", dest="file_format", choices=FORMATS, required=True, help=what)
    add("--part", choices=("fields", "surface", "body"), default="fields", help="default: fields")
    add("--state", choices=("peak", "unloaded"), default="peak", help="default: peak")
    add("--out", **FILE, help="default: ./<its name>.<format>")

    view = command("view", "draw pictures in space of a finished run; needs no display")
    view.add_argument("folder", **RUN)
    one = "default: the first of these that the run has; without --out and --html: all of them"
    view.add_argument("--picture", dest="name", choices=PICTURES, help=one)
    where = view.add_mutually_exclusive_group().add_argument
    where("--out", metavar="FILE.png", type=Path, help="default: RUN/figures/NAME-3d.png")
    turned = "one picture as a page that turns in a browser (pip install 'samfem[html]')"
    where("--html", dest="page", metavar="FILE.html", type=Path, help=turned)

    add = command("store", "list the results that are kept for reuse, or prune them").add_argument
    what = "remove what is stale, damaged or left over; all: everything"
    add("--prune", nargs="?", const="unusable", choices=("unusable", "all"), help=what)
    add("--older-than", metavar="DAYS", type=_days, help="with --prune: also remove what is older")

    add = command("new", "write a commented scene that runs").add_argument
    kinds = f"{', '.join(STARTS)}; default: {STARTS[0]}"
    add("kind", metavar="KIND", nargs="?", choices=STARTS, default=STARTS[0], help=kinds)
    add("--out", **FILE, help="default: ./<its name>.toml")

    add = command("examples", "list the scenes of the verification cases, or copy one").add_argument
    add("name", metavar="NAME", nargs="?", help="copy this one, with the files that it names")
    add("--out", **FILE, help="default: ./<its name>.toml")

    add = command("schema", "print the JSON schema of a scene, for editors").add_argument
    add("--study", **ON, help="that of a study for samfem sweep")

    completion = command("completion", "print the completion of this command line for a shell")
    completion.add_argument("shell", choices=SHELLS)
    return completion


def _days(text: str) -> float:
    days = float(text)
    if not 0 <= days < float("inf"):
        raise ValueError(text)
    return days


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
