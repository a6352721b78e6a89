# SPDX-License-Identifier: MIT
"""Everything around the two solvers: the command `samfem`, comparison, reference solutions, cases, report."""

from importlib.util import find_spec

__all__ = ["EXTRAS", "ExtraError", "need"]

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
