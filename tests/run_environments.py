# SPDX-License-Identifier: MIT
"""The suite in one environment after another.

    python tests/run_environments.py [NAME ...] [--out FILE] [-- ARGUMENT OF PYTEST ...]

Prints a row for each as it ends, and the whole output of pytest where a test failed. Exit code 1 if one
failed anywhere, 2 for a wrong name. What an environment is, and when this machine cannot give it:
environments.py.
"""

import argparse
import json
import os
import platform
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from xml.etree import ElementTree

from environments import PROBE, Environment, NotHereError, Place, environments

ROOT = Path(__file__).resolve().parent.parent
NOT_COPIED = (
    ".git",
    ".venv*",
    "latest*",
    "__pycache__",
    ".pytest_cache",
    ".hypothesis",
    ".ruff_cache",
    "*.egg-info",
)
LIMIT_S, PROBE_LIMIT_S = 3600.0, 120.0
NO_TESTS = 5
COLUMNS = (
    "environment",
    "change",
    "BLAS of numpy, scipy (threads)",
    "passed",
    "failed",
    "skipped",
    "seconds",
    "outcome",
)


@dataclass(frozen=True)
class Row:
    """What came out of one environment. kernels: of numpy and scipy; failed: names of tests; trouble: why the
    suite was not run or did not end by itself, else "".
    """

    environment: Environment
    kernels: str = ""
    was_run: bool = False
    passed: int = 0
    failed: tuple[str, ...] = ()
    skipped: int = 0
    seconds: float = 0.0
    trouble: str = ""

    @property
    def is_bad(self) -> bool:
        return self.was_run and bool(self.failed or self.trouble)

    @property
    def outcome(self) -> str:
        if not self.was_run:
            return f"not run: {self.trouble}"
        return f"FAILED: {self.trouble or 'see below'}" if self.is_bad else "passed"

    def cells(self) -> list[str]:
        counts = (self.passed, len(self.failed), self.skipped, f"{self.seconds:.0f}")
        shown = map(str, counts if self.was_run else ("",) * len(counts))
        return [self.environment.name, self.environment.says, self.kernels, *shown, self.outcome]


class Session:
    """A process group that is ended whole when it takes too long or this process is interrupted."""

    def __init__(self, words: Sequence[str], limit_s: float, **how):
        self.process = subprocess.Popen(words, stdin=subprocess.DEVNULL, start_new_session=True, **how)
        self.limit_s = limit_s

    def code(self) -> int | None:
        """The exit code, None after the limit."""
        try:
            return self.process.wait(self.limit_s)
        except subprocess.TimeoutExpired:
            return None
        finally:
            if self.process.poll() is None:
                os.killpg(self.process.pid, signal.SIGKILL)
                self.process.wait()


def probe(environment: Environment, place: Place, before: Sequence[str]) -> dict:
    """What numpy, scipy and Python find there. Raises NotHereError."""
    words = [*before, sys.executable, "-c", PROBE]
    with tempfile.TemporaryFile() as told:
        variables = environment.variables_in(place.scratch)
        how = {"cwd": place.checkout, "env": variables, "stdout": told, "stderr": subprocess.STDOUT}
        code = Session(words, PROBE_LIMIT_S, **how).code()
        told.seek(0)
        lines = told.read().decode(errors="replace").strip().splitlines() or [""]
    if code is None:
        raise NotHereError(f"no answer within {PROBE_LIMIT_S:.0f} s")
    if code < 0:
        raise NotHereError(
            f"numpy or scipy ends by {signal.Signals(-code).name}: this processor cannot run the kernel"
        )
    if code:
        raise NotHereError(lines[-1])
    return json.loads(lines[-1])


def run(environment: Environment, plain: dict, arguments: Sequence[str], base: Path) -> Row:
    """The suite in one environment. plain: the probe without a change; base: an empty folder."""
    try:
        place = _place(environment, base)
        before = environment.around(place)
        found = probe(environment, place, before)
    except NotHereError as reason:
        return Row(environment, trouble=str(reason))
    kernels = f"{_names(found['numpy'])}, {_names(found['scipy'])} ({'/'.join(map(str, found['threads']))})"
    if not environment.holds(found, plain):
        return Row(environment, kernels, trouble=environment.otherwise)
    return _tested(
        environment, kernels, place, [*before, sys.executable, *_pytest(environment, place, arguments)]
    )


def _names(kernels: Sequence[str | None]) -> str:
    return "/".join(name or "unknown" for name in kernels) or "none known"


def _pytest(environment: Environment, place: Place, arguments: Sequence[str]) -> list[str]:
    report = f"--junit-xml={place.scratch / 'report.xml'}"
    return ["-m", "pytest", "-p", "no:cacheprovider", report, *environment.options, *arguments]


def _place(environment: Environment, base: Path) -> Place:
    """The checkout, or a copy of it that belongs to the environment's user."""
    checkout, scratch = ROOT, base / "scratch"
    scratch.mkdir()
    if environment.owner is not None:
        if os.geteuid() != 0:
            raise NotHereError("only root can become another user")
        checkout = base / "checkout"
        shutil.copytree(ROOT, checkout, ignore=shutil.ignore_patterns(*NOT_COPIED))
        environment.variables_in(scratch)
        base.chmod(0o755)
        for path in (checkout, *checkout.rglob("*"), scratch, *scratch.rglob("*")):
            os.chown(path, environment.owner, environment.owner, follow_symlinks=False)
    return Place(checkout, scratch)


def _tested(environment: Environment, kernels: str, place: Place, words: Sequence[str]) -> Row:
    copied = {"PYTHONPATH": str(place.checkout)} if place.checkout != ROOT else {}
    variables = environment.variables_in(place.scratch) | copied
    log, began = place.scratch / "log.txt", time.monotonic()
    with log.open("wb") as stream:
        how = {"cwd": place.checkout, "env": variables, "stdout": stream, "stderr": subprocess.STDOUT}
        code = Session(words, LIMIT_S, **how).code()
    seconds = time.monotonic() - began
    passed, failed, skipped = counts(place.scratch / "report.xml")
    row = Row(environment, kernels, True, passed, failed, skipped, seconds, _trouble(code, bool(failed)))
    if row.is_bad:
        print(log.read_text(encoding="utf-8", errors="replace"), flush=True)
    return row


def _trouble(code: int | None, tests_failed: bool) -> str:
    if code is None:
        return f"did not end within {LIMIT_S / 60:.0f} min"
    if code == NO_TESTS:
        return "no tests"
    return "" if code == int(tests_failed) else f"pytest ended with {code}"


def counts(report: Path) -> tuple[int, tuple[str, ...], int]:
    """(passed, names of those that failed, skipped) of a JUnit file of pytest; none if it was not written."""
    if not report.exists():
        return 0, (), 0
    kinds = {"passed": 0, "skipped": 0}
    failed = []
    for test in ElementTree.parse(report).iter("testcase"):
        ends = {part.tag for part in test}
        if ends & {"failure", "error"}:
            failed.append(f"{test.get('classname')}::{test.get('name')}")
        else:
            kinds["skipped" if "skipped" in ends else "passed"] += 1
    return kinds["passed"], tuple(failed), kinds["skipped"]


def table(rows: Sequence[Row]) -> str:
    """The outcome as a table in Markdown, and the tests that failed in each environment."""
    versions = ", ".join(f"{name} {metadata.version(name)}" for name in ("numpy", "scipy", "pytest"))
    cells = [COLUMNS, ["---"] * len(COLUMNS), *(row.cells() for row in rows)]
    failed = [f"- {row.environment.name}: {', '.join(row.failed)}" for row in rows if row.failed]
    lines = ["| " + " | ".join(text.replace("|", "/") for text in line) + " |" for line in cells]
    return (
        "\n".join([f"Python {platform.python_version()}, {versions}", "", *lines, "", *failed]).rstrip()
        + "\n"
    )


def main(arguments: Sequence[str] | None = None) -> int:
    known = {environment.name: environment for environment in environments()}
    parser = argparse.ArgumentParser(description="Run the suite in environments that other machines give.")
    parser.add_argument("name", nargs="*", metavar="NAME", help=f"default: all of {', '.join(known)}")
    parser.add_argument("--out", type=Path, metavar="FILE", help="also write the table there")
    given = list(sys.argv[1:] if arguments is None else arguments)
    split = given.index("--") if "--" in given else len(given)
    options = parser.parse_args(given[:split])
    if wrong := sorted(set(options.name) - set(known)):
        parser.error(f"no such environment: {', '.join(wrong)}; there are {', '.join(known)}")
    chosen = [known[name] for name in known if name in (options.name or known)]
    rows = _rows(chosen, known["plain"], given[split + 1 :], options.out)
    print(table(rows), end="")
    return int(any(row.is_bad for row in rows))


def _rows(
    chosen: Sequence[Environment], plain: Environment, arguments: Sequence[str], out: Path | None
) -> list[Row]:
    """The rows one by one; the file is written after each: an interrupted run keeps what was found."""
    rows: list[Row] = []
    with tempfile.TemporaryDirectory(prefix="samfem-") as name:
        first = Place(ROOT, Path(name, "probe"))
        first.scratch.mkdir()
        found = probe(plain, first, [])
        for environment in chosen:
            base = Path(name, environment.name)
            base.mkdir()
            Path(name).chmod(0o755)
            rows.append(run(environment, found, arguments, base))
            print("  ".join(filter(None, rows[-1].cells())), flush=True)
            if out:
                out.write_text(table(rows), encoding="utf-8")
            shutil.rmtree(base, ignore_errors=True)
    return rows


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # ended from outside, what was started ends too
    sys.exit(main())
