# SPDX-License-Identifier: MIT
"""The environments in which the suite has to hold: each changes one thing that a machine decides, and no
other.

`run_environments.py` runs the suite in them. PROBE is run in each one first; `holds` reads its answer, so
that a change which had no effect on this machine is not counted as a test of anything.
"""

import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy

from verification.runs.threads import EVERY_LIBRARY as THREADS

KERNELS = ("Prescott", "Nehalem", "Haswell", "Zen", "SkylakeX")
SEEDS = (1, 2, 3)
NOBODY, STRANGER = 65534, 54321
"""Numbers of an ordinary user, and of one that the machine does not know, as containers use them."""
HOMES = ("HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME", "USER", "LOGNAME")
LANGUAGE = ("LC_ALL", "LC_CTYPE", "LANG", "PYTHONUTF8", "PYTHONCOERCECLOCALE", "PYTHONIOENCODING")
SCREEN = ("TERM", "COLUMNS", "LINES", "NO_COLOR", "FORCE_COLOR")
DECIDED = (
    "OPENBLAS_CORETYPE",
    "NPY_DISABLE_CPU_FEATURES",
    "TZ",
    "LC_ALL",
    "PYTHONUTF8",
    "PYTHONCOERCECLOCALE",
    *THREADS,
)
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
"""Prints, as one line of JSON, what numpy, scipy and Python found, with the threads that the tests have. Both
BLAS compute something, so that a kernel which the processor cannot run ends the process.
"""


class NotHereError(Exception):
    """The machine cannot give the environment; the message says why."""


@dataclass(frozen=True)
class Place:
    """Where the suite runs: the folder of the checkout, and one for what the environment needs besides."""

    checkout: Path
    scratch: Path


@dataclass(frozen=True)
class Environment:
    """One change of what a machine decides.

    variables: None takes one away; options: of pytest; around: the words before a command, raises
    NotHereError; owner: number of the user whom a copy of the checkout is given to; holds: whether a probe
    shows the change, given the probe without it; otherwise: what it means if it does not.
    """

    name: str
    says: str
    variables: Mapping[str, str | None] = field(default_factory=dict)
    options: tuple[str, ...] = ()
    around: Callable[[Place], list[str]] = lambda place: []
    owner: int | None = None
    holds: Callable[[dict, dict], bool] = lambda probe, plain: True
    otherwise: str = "the change has no effect on this machine"

    def variables_in(self, scratch: Path) -> dict[str, str]:
        """All variables of a process in it. The folders that they name are made in `scratch`."""
        changed = {"TMPDIR": "tmp", **self.variables}
        for name in FOLDERS:
            if changed.get(name):
                changed[name] = str(scratch / changed[name])
                Path(changed[name]).mkdir(exist_ok=True)
        kept = {name: value for name, value in os.environ.items() if name not in (*DECIDED, *changed)}
        return kept | {name: value for name, value in changed.items() if value is not None}


def _tool(name: str) -> str:
    found = shutil.which(name)
    if not found:
        raise NotHereError(f"there is no command {name}")
    return found


def _python(code: str) -> list[str]:
    return [sys.executable, "-c", code]


def on_one_core(place: Place) -> list[str]:
    """All processes on the first core that this one may use."""
    if not hasattr(os, "sched_setaffinity"):
        raise NotHereError("this system binds no process to a core")
    only = "os.sched_setaffinity(0, [min(os.sched_getaffinity(0))])"
    return _python(f"import os, sys; {only}; os.execvp(sys.argv[1], sys.argv[1:])")


def on_a_terminal(place: Place) -> list[str]:
    """A terminal of its own."""
    ended = "os.waitstatus_to_exitcode(pty.spawn(sys.argv[1:]))"
    return _python(f"import os, pty, sys; code = {ended}; sys.exit(code if code >= 0 else 128 - code)")


def _with_mounts(*lines: str) -> list[str]:
    """A view of the file system of its own, prepared by lines of shell."""
    if os.geteuid() != 0:
        raise NotHereError("only root can do that")
    before = [_tool("unshare"), "--mount", "sh", "-c", "\n".join(["set -e", *lines, 'exec "$@"']), "sh"]
    tried = subprocess.run([*before, "true"], capture_output=True, text=True, check=False)
    if tried.returncode:
        raise NotHereError(f"nothing can be mounted here: {tried.stderr.strip()}")
    return before


def without_proc(place: Place) -> list[str]:
    """An empty /proc."""
    return _with_mounts("mount -t tmpfs -o mode=555 none /proc")


def read_only(place: Place) -> list[str]:
    """The checkout on a file system that nobody can write to."""
    here = f"'{place.checkout}'"
    return _with_mounts(f"mount --bind {here} {here}", f"mount -o remount,bind,ro {here}", f"cd {here}")


def as_user(number: int) -> Callable[[Place], list[str]]:
    """As another user, who is shown the interpreter where it lies in a folder that is closed to others."""

    def around(place: Place) -> list[str]:
        lines = []
        for k, prefix in enumerate(sorted({sys.prefix, sys.base_prefix})):
            closed = [folder for folder in Path(prefix).parents if folder.stat().st_mode & 0o005 != 0o005]
            if closed:
                kept = place.scratch / f"interpreter-{k}"
                kept.mkdir(exist_ok=True)
                lines += [
                    f"mount --bind '{prefix}' '{kept}'",
                    f"mount -t tmpfs -o mode=755 none '{closed[-1]}'",
                ]
                lines += [f"mkdir -p '{prefix}'", f"mount --bind '{kept}' '{prefix}'"]
        drop = [_tool("setpriv"), f"--reuid={number}", f"--regid={number}", "--clear-groups"]
        return [*_with_mounts(*lines), *drop]

    return around


def _of_kernel(name: str) -> Environment:
    """Kernels of OpenBLAS for a processor. They may go by an older name (Prescott's are called Katmai), but
    those that are taken anyway, or that another of KERNELS asks for, are not its own.
    """

    def holds(probe: dict, plain: dict) -> bool:
        taken = {*probe["numpy"], *probe["scipy"]}
        return taken == {name} or not taken & {*plain["numpy"], *plain["scipy"], *KERNELS, None}

    return Environment(
        f"openblas-{name.lower()}",
        f"OPENBLAS_CORETYPE={name}",
        {"OPENBLAS_CORETYPE": name},
        holds=holds,
        otherwise="another row runs the kernels that were taken; libraries or processor have no others",
    )


def _with_threads(count: int) -> Environment:
    variables = dict.fromkeys(THREADS, str(count))
    return Environment(
        f"threads-{count}",
        f"OPENBLAS_NUM_THREADS={count}, and those of other libraries",
        variables,
        holds=lambda probe, plain: probe["threads"] == [count],
    )


def _in_random_order(seed: int) -> Environment:
    """Files and the tests of each in random order; also the examples of properties are drawn anew."""
    options = ("--random-order", f"--random-order-seed={seed}")
    drawn = ("--hypothesis-profile=default", f"--hypothesis-seed={seed}")
    return Environment(f"random-{seed}", f"tests in random order, seed {seed}", options=(*options, *drawn))


def _features() -> str:
    """The features of this processor, above the baseline, for which numpy has code of its own."""
    return " ".join(numpy.show_config(mode="dicts").get("SIMD Extensions", {}).get("found", []))


def _of_processors() -> list[Environment]:
    return [
        *map(_of_kernel, KERNELS),
        Environment(
            "numpy-baseline",
            "NPY_DISABLE_CPU_FEATURES: all above the baseline",
            {"NPY_DISABLE_CPU_FEATURES": _features()},
            holds=lambda probe, plain: bool(plain["features"]) and not probe["features"],
        ),
        *map(_with_threads, (1, 2)),
        Environment(
            "one-core",
            "one core",
            around=on_one_core,
            holds=lambda probe, plain: probe["cores"] == 1 < plain["cores"],
        ),
    ]


def _of_languages() -> list[Environment]:
    plain_c = {**dict.fromkeys(LANGUAGE), "LC_ALL": "C"}
    return [
        Environment(
            "time-zone",
            "TZ=Asia/Kathmandu",
            {"TZ": "Asia/Kathmandu"},
            holds=lambda probe, plain: probe["offset_s"] % 3600 != 0,
        ),
        Environment("c-locale", "LC_ALL=C", plain_c),
        Environment(
            "ascii",
            "LC_ALL=C, kept as ASCII by PYTHONUTF8=0",
            {**plain_c, "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
            holds=lambda probe, plain: probe["encoding"] not in ("utf-8", "utf8"),
        ),
    ]


def _of_users() -> list[Environment]:
    nobody = dict.fromkeys(HOMES)
    return [
        Environment("no-home", "HOME is not set", nobody),
        Environment(
            "no-user",
            "a user without name and home, as in a container",
            nobody,
            around=as_user(STRANGER),
            owner=STRANGER,
            holds=lambda probe, plain: probe["user"] == STRANGER and probe["home"] == "~",
        ),
        Environment(
            "user",
            "an ordinary user instead of root",
            {**nobody, "HOME": "home"},
            around=as_user(NOBODY),
            owner=NOBODY,
            holds=lambda probe, plain: probe["user"] == NOBODY,
        ),
    ]


def _of_systems() -> list[Environment]:
    return [
        Environment(
            "read-only",
            "the checkout cannot be written",
            around=read_only,
            holds=lambda probe, plain: not probe["writable"],
        ),
        Environment(
            "no-proc", "/proc is empty", around=without_proc, holds=lambda probe, plain: not probe["proc"]
        ),
        Environment(
            "terminal",
            "a terminal, 60 columns wide, in colour",
            {**dict.fromkeys(SCREEN), "TERM": "xterm-256color", "COLUMNS": "60", "FORCE_COLOR": "1"},
            around=on_a_terminal,
            holds=lambda probe, plain: probe["terminal"],
        ),
        Environment(
            "dumb",
            "TERM=dumb and NO_COLOR=1",
            {**dict.fromkeys(SCREEN), "TERM": "dumb", "NO_COLOR": "1"},
        ),
        Environment("folder", "a temporary folder named 'tmp \u00fc'", {"TMPDIR": "tmp \u00fc"}),
    ]


def environments() -> list[Environment]:
    """Every environment, the one without a change first."""
    plain = Environment("plain", "nothing changed; no terminal")
    return [
        plain,
        *_of_processors(),
        *_of_languages(),
        *_of_users(),
        *_of_systems(),
        *map(_in_random_order, SEEDS),
    ]
