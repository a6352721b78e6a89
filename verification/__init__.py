# SPDX-License-Identifier: MIT
"""Everything around the two solvers: the command `samfem`, comparison, reference solutions, cases, report."""

from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

EXTRAS = {
    "report": ("jinja2", "matplotlib", "meshio", "pyvista", "vtk"),
    "html": ("trame_pyvista", "nest_asyncio2"),
}
"""Extra of the distribution -> the packages that its commands load."""


class ExtraError(ImportError):
    """Packages of an extra are not installed; the message says what needs them and how to install them."""


def need(what: str, extra: str = "report") -> None:
    """Raise ExtraError where a package of the extra is not installed; what: a command or an option."""
    if missing := [name for name in EXTRAS[extra] if find_spec(name) is None]:
        raise ExtraError(f"{what} needs {', '.join(missing)}: pip install 'samfem[{extra}]'")


def foreign_package() -> str:
    """What to do about a package of another distribution where one of ours should be: before it on the path,
    or written over it, as `pip install sam` does. Empty if there is none.
    """
    for name in ("sam", "fem_reference"):
        place = find_spec(name)
        file = None if place is None else place.origin
        try:
            public = import_module(name).__all__
        except Exception:  # whatever the other one raises
            public = ()
        beside = file is not None and Path(file).resolve().parents[1] == Path(__file__).resolve().parents[1]
        if not beside or "solve" not in public:
            return (
                f"samfem needs its own package {name}, and Python finds that of another distribution, "
                f"{file or 'a folder'}: uninstall both and install samfem again, in an environment of its own"
            )
    return ""
