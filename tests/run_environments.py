# SPDX-License-Identifier: MIT
"""The suite in one environment after another; each changes one thing that a machine decides, and no other.

python tests/run_environments.py [NAME ...] [--out FILE] [-- ARGUMENT OF PYTEST ...]

PROBE is run in each one first; `holds` reads its answer, so that a change which had no effect on this machine
is not counted as a test of anything. Prints a row for each as it ends, and the whole output of pytest where a
test failed. Exit code 1 if one failed anywhere, 2 for a wrong name.
"""

import argparse
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy

from verification.runs.threads import EVERY_LIBRARY as THREADS

ROOT = Path(__file__).resolve().parent.parent
LATEST = ".git|.venv*|latest*|__pycache__|.pytest_cache|.hypothesis|.ruff_cache|*.egg-info".split("|")
"""Not copied for another user."""
LIMIT_S, PROBE_LIMIT_S = 3600.0, 120.0
COLUMNS = ("environment", "change", "BLAS of numpy, scipy (threads)", "outcome")
KERNELS = ("Prescott", "Nehalem", "Haswell", "Zen", "SkylakeX")
STRANGER = 54321
"""Number of an ordinary user that the machine does not know, as containers use them."""
HOMES = ("HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME", "USER", "LOGNAME")
LANGUAGE = ("LC_ALL", "LC_CTYPE", "LANG", "PYTHONUTF8", "PYTHONCOERCECLOCALE", "PYTHONIOENCODING")
SCREEN = ("TERM", "COLUMNS", "LINES", "NO_COLOR", "FORCE_COLOR")
DECIDED = ("OPENBLAS_CORETYPE", "NPY_DISABLE_CPU_FEATURES", "TZ", "LC_ALL", *LANGUAGE[3:5], *THREADS)
"""Taken away everywhere: they would mix with what an environment changes."""
FOLDERS = ("HOME", "TMPDIR")
"""Variables whose value in an environment is the name of a folder to be made for it."""
PROBE = r"""
import json, locale, os, sys, time
sys.path.insert(0, "tests")
import conftest
import numpy, threadpoolctl
def blas(known=()):
    libraries = threadpoolctl.threadpool_info()
    return [library for library in libraries if library["user_api"] == "blas" and library not in known]
own = blas()
import scipy.linalg
others = blas(own) or own
matrix = numpy.eye(300) + 1 / (1 + numpy.add.outer(numpy.arange(300.0), numpy.arange(300.0)))
assert numpy.allclose(scipy.linalg.solve(matrix, matrix @ matrix), matrix)
print(json.dumps({
    "numpy": [library.get("architecture") for library in own],
    "scipy": [library.get("architecture") for library in others],
    "threads": sorted({library["num_threads"] for library in own + others}),
    "features": numpy.show_config(mode="dicts").get("SIMD Extensions", {}).get("found", []),
    "cores": len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count(),
    "offset_s": time.localtime(0).tm_gmtoff,
    "encoding": locale.getpreferredencoding(False).lower(),
    "user": os.geteuid(),
    "home": os.path.expanduser("~"),
    "proc": os.path.exists("/proc/self"),
    "writable": os.access(".", os.W_OK),
    "terminal": sys.stdout.isatty(),
}))
"""
"""Prints, as one line of JSON, what numpy, scipy and Python found, with the threads that the tests
have. Both BLAS compute something, so that a kernel which the processor cannot run ends the process.
"""


class NotHereError(Exception):
    """The machine cannot give the environment; the message says why."""


@dataclass(frozen=True)
class Environment:
    """One change of what a machine decides.

    variables: None takes one away; options: of pytest; around: (checkout, scratch folder) -> the words before
    a command, raises NotHereError; owner: number of the user whom a copy of the checkout is given to, and who
    runs it; holds: whether a probe shows the change, given the one without it.
    """

    says: str
    variables: Mapping[str, str | None] = field(default_factory=dict)
    options: tuple[str, ...] = ()
    around: Callable[[Path, Path], list[str]] = lambda checkout, scratch: []
    owner: int | None = None
    holds: Callable[[dict, dict], bool] = lambda probe, plain: True

    def variables_in(self, scratch: Path) -> dict[str, str]:
        """All variables of a process in it. The folders that they name are made in `scratch`."""
        changed = {"TMPDIR": "tmp", **self.variables}
        for name in FOLDERS:
            if changed.get(name):
                changed[name] = str(scratch / changed[name])
                Path(changed[name]).mkdir(exist_ok=True)
        kept = {name: value for name, value in os.environ.items() if name not in (*DECIDED, *changed)}
        return kept | {name: value for name, value in changed.items() if value is not None}


def on_one_core(checkout: Path, scratch: Path) -> list[str]:
    """All processes on the first core that this one may use."""
    if not hasattr(os, "sched_setaffinity"):
        raise NotHereError("this system binds no process to a core")
    only = "os.sched_setaffinity(0, [min(os.sched_getaffinity(0))])"
    return [sys.executable, "-c", f"import os, sys; {only}; os.execvp(sys.argv[1], sys.argv[1:])"]


def on_a_terminal(checkout: Path, scratch: Path) -> list[str]:
    """A terminal of its own."""
    ended = "code = os.waitstatus_to_exitcode(pty.spawn(sys.argv[1:]))"
    return [
        sys.executable,
        "-c",
        f"import os, pty, sys; {ended}; sys.exit(code if code >= 0 else 128 - code)",
    ]


def with_mounts(*lines: str) -> list[str]:
    """A view of the file system of its own, prepared by lines of shell."""
    if os.geteuid() != 0 or not (shutil.which("unshare") and shutil.which("setpriv")):
        raise NotHereError("only root can do that, with unshare and setpriv")
    before = ["unshare", "--mount", "sh", "-c", "\n".join(["set -e", *lines, 'exec "$@"']), "sh"]
    tried = subprocess.run([*before, "true"], capture_output=True, text=True, check=False)
    if tried.returncode:
        raise NotHereError(f"nothing can be mounted here: {tried.stderr.strip()}")
    return before


def read_only(checkout: Path, scratch: Path) -> list[str]:
    """The checkout on a file system that nobody can write to."""
    here = f"'{checkout}'"
    return with_mounts(f"mount --bind {here} {here}", f"mount -o remount,bind,ro {here}", f"cd {here}")


def as_user(number: int, scratch: Path) -> list[str]:
    """As another user, who is shown the interpreter where it lies in a folder that is closed to others."""
    lines = []
    for k, prefix in enumerate(sorted({sys.prefix, sys.base_prefix})):
        closed = [folder for folder in Path(prefix).parents if folder.stat().st_mode & 0o005 != 0o005]
        if closed:
            (kept := scratch / f"interpreter-{k}").mkdir(exist_ok=True)
            lines += [
                f"mount --bind '{prefix}' '{kept}'",
                f"mount -t tmpfs -o mode=755 none '{closed[-1]}'",
                f"mkdir -p '{prefix}'",
                f"mount --bind '{kept}' '{prefix}'",
            ]
    return [*with_mounts(*lines), "setpriv", f"--reuid={number}", f"--regid={number}", "--clear-groups"]


def of_kernel(name: str) -> Environment:
    """Kernels of OpenBLAS for a processor: by an older name too (Katmai), but not by that of another."""

    def holds(probe: dict, plain: dict) -> bool:
        taken = {*probe["numpy"], *probe["scipy"]}
        return taken == {name} or not taken & {*plain["numpy"], *plain["scipy"], *KERNELS, None}

    return Environment(f"OPENBLAS_CORETYPE={name}", {"OPENBLAS_CORETYPE": name}, holds=holds)


def environments() -> dict[str, Environment]:
    """Every environment by its name, the one without a change first."""
    features = numpy.show_config(mode="dicts").get("SIMD Extensions", {}).get("found", [])
    plain_c, nobody = {**dict.fromkeys(LANGUAGE), "LC_ALL": "C"}, dict.fromkeys(HOMES)
    screen = dict.fromkeys(SCREEN)
    found = {"plain": Environment("nothing changed; no terminal")}
    found |= {f"openblas-{name.lower()}": of_kernel(name) for name in KERNELS}
    found["numpy-baseline"] = Environment(
        "NPY_DISABLE_CPU_FEATURES: all above the baseline",
        {"NPY_DISABLE_CPU_FEATURES": " ".join(features)},
        holds=lambda probe, plain: bool(plain["features"]) and not probe["features"],
    )
    found |= {
        "threads-2": Environment(
            "OPENBLAS_NUM_THREADS=2, and those of other libraries",
            dict.fromkeys(THREADS, "2"),
            holds=lambda probe, plain: probe["threads"] == [2],
        ),
        "one-core": Environment(
            "one core", around=on_one_core, holds=lambda probe, plain: probe["cores"] == 1 < plain["cores"]
        ),
        "time-zone": Environment(
            "TZ=Asia/Kathmandu",
            {"TZ": "Asia/Kathmandu"},
            holds=lambda probe, plain: probe["offset_s"] % 3600 != 0,
        ),
        "c-locale": Environment("LC_ALL=C", plain_c),
        "ascii": Environment(
            "LC_ALL=C, kept as ASCII by PYTHONUTF8=0",
            {**plain_c, "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
            holds=lambda probe, plain: probe["encoding"] not in ("utf-8", "utf8"),
        ),
        "no-home": Environment("HOME is not set", nobody),
        "no-user": Environment(
            "a user without name and home, as in a container",
            nobody,
            owner=STRANGER,
            holds=lambda probe, plain: probe["user"] == STRANGER and probe["home"] == "~",
        ),
        "read-only": Environment(
            "the checkout cannot be written",
            around=read_only,
            holds=lambda probe, plain: not probe["writable"],
        ),
        "no-proc": Environment(
            "/proc is empty",
            around=lambda checkout, scratch: with_mounts("mount -t tmpfs -o mode=555 none /proc"),
            holds=lambda probe, plain: not probe["proc"],
        ),
        "terminal": Environment(
            "a terminal, 60 columns wide, in colour",
            screen | {"TERM": "xterm-256color", "COLUMNS": "60", "FORCE_COLOR": "1"},
            around=on_a_terminal,
            holds=lambda probe, plain: probe["terminal"],
        ),
        "dumb": Environment("TERM=dumb and NO_COLOR=1", {**screen, "TERM": "dumb", "NO_COLOR": "1"}),
        "folder": Environment("a temporary folder named 'tmp \u00fc'", {"TMPDIR": "tmp \u00fc"}),
    }
    for seed in (1, 2, 3):  # files and the tests of each, and the examples of properties anew
        options = ("--random-order", f"--random-order-seed={seed}")
        drawn = ("--hypothesis-profile=default", f"--hypothesis-seed={seed}")
        found[f"random-{seed}"] = Environment(f"tests in random order, seed {seed}", options=options + drawn)
    return found


def ended(words: Sequence[str], limit_s: float, **how) -> int | None:
    """The exit code of a command, None after the limit. Its process group ends with it in any case."""
    process = subprocess.Popen(words, stdin=subprocess.DEVNULL, start_new_session=True, **how)
    try:
        return process.wait(limit_s)
    except subprocess.TimeoutExpired:
        return None
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()


def probe(environment: Environment, checkout: Path, scratch: Path, before: Sequence[str] = ()) -> dict:
    """What numpy, scipy and Python find there. Raises NotHereError."""
    with tempfile.TemporaryFile() as told:
        how = {"cwd": checkout, "env": environment.variables_in(scratch), "stderr": subprocess.STDOUT}
        code = ended([*before, sys.executable, "-c", PROBE], PROBE_LIMIT_S, stdout=told, **how)
        told.seek(0)
        lines = told.read().decode(errors="replace").strip().splitlines() or [""]
    if code is None:
        raise NotHereError(f"no answer within {PROBE_LIMIT_S:.0f} s")
    if code < 0:
        name = signal.Signals(-code).name
        raise NotHereError(f"numpy or scipy ends by {name}: this processor cannot run the kernel")
    if code:
        raise NotHereError(lines[-1])
    return json.loads(lines[-1])


def run(
    name: str, environment: Environment, plain: dict, arguments: Sequence[str], base: Path
) -> tuple[list[str], bool]:
    """The suite in one environment: the row of COLUMNS, and whether something failed.

    plain: the probe without a change; base: an empty folder.
    """
    checkout, scratch = ROOT, base / "scratch"
    scratch.mkdir()
    try:
        if environment.owner is None:
            before = environment.around(checkout, scratch)
        else:  # a copy that belongs to that user
            before, checkout = as_user(environment.owner, scratch), base / "checkout"
            shutil.copytree(ROOT, checkout, ignore=shutil.ignore_patterns(*LATEST))
            environment.variables_in(scratch)
            base.chmod(0o755)
            for path in (checkout, *checkout.rglob("*"), scratch, *scratch.rglob("*")):
                os.chown(path, environment.owner, environment.owner, follow_symlinks=False)
        found = probe(environment, checkout, scratch, before)
    except NotHereError as reason:
        return [name, environment.says, "", f"not run: {reason}"], False
    taken = ("/".join(each or "unknown" for each in found[key]) or "none known" for key in ("numpy", "scipy"))
    row = [name, environment.says, f"{', '.join(taken)} ({'/'.join(map(str, found['threads']))})"]
    if not environment.holds(found, plain):
        return [*row, "not run: the change has no effect on this machine"], False
    words = [*before, sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "--color=no"]
    copied = {"PYTHONPATH": str(checkout)} if checkout != ROOT else {}
    variables, log = environment.variables_in(scratch) | copied, scratch / "log.txt"
    with log.open("wb") as stream:
        how = {"cwd": checkout, "env": variables, "stdout": stream, "stderr": subprocess.STDOUT}
        code = ended([*words, *environment.options, *arguments], LIMIT_S, **how)
    text = log.read_text(encoding="utf-8", errors="replace")
    said = (text.strip().splitlines() or [""])[-1].strip("= ")  # 8 passed, 1 skipped in 0.12s
    if code == 0:
        return [*row, said], False
    print(text, flush=True)
    why = f"exit code {code}: {said}" if code is not None else f"no end within {LIMIT_S / 60:.0f} min"
    return [*row, f"FAILED, {why}"], True


def main(arguments: Sequence[str] | None = None) -> int:
    known, bad = environments(), False
    parser = argparse.ArgumentParser(description="Run the suite in environments that other machines give.")
    parser.add_argument("name", nargs="*", metavar="NAME", help=f"default: all of {', '.join(known)}")
    parser.add_argument("--out", type=Path, metavar="FILE", help="also write the rows there, in Markdown")
    given = list(sys.argv[1:] if arguments is None else arguments)
    split = given.index("--") if "--" in given else len(given)
    options = parser.parse_args(given[:split])
    if wrong := sorted(set(options.name) - set(known)):
        parser.error(f"no such environment: {', '.join(wrong)}; there are {', '.join(known)}")
    rows = [list(COLUMNS), ["---"] * len(COLUMNS)]
    with tempfile.TemporaryDirectory(prefix="samfem-") as folder:
        (first := Path(folder, "probe")).mkdir()
        plain = probe(known["plain"], ROOT, first)
        for name in (name for name in known if name in (options.name or known)):
            (base := Path(folder, name)).mkdir()
            Path(folder).chmod(0o755)
            row, failed = run(name, known[name], plain, given[split + 1 :], base)
            rows.append(row)
            bad |= failed
            print(" | ".join(row), flush=True)
            if options.out:  # after each: an interrupted run keeps what was found
                lines = ("| " + " | ".join(cell.replace("|", "/") for cell in row) + " |" for row in rows)
                options.out.write_text("\n".join(lines) + "\n", encoding="utf-8")
            shutil.rmtree(base, ignore_errors=True)
    return int(bad)


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # ended from outside, what was started ends too
    sys.exit(main())
