# SPDX-License-Identifier: MIT
"""Packages of other distributions that have the names of ours."""

from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

OURS = {"sam": "solve", "fem_reference": "solve", "verification": "need"}
"""Package -> a name of its `__all__`."""


def foreign_package() -> str:
    """What to do about a package of another distribution where one of ours should be: before it on the path,
    or written over it, as `pip install sam` does. Empty if there is none.
    """
    for name, known in OURS.items():
        place = find_spec(name)
        file = None if place is None else place.origin
        try:
            public = import_module(name).__all__
        except Exception:  # whatever the other one raises
            public = ()
        beside = file is not None and Path(file).resolve().parents[1] == Path(__file__).resolve().parents[1]
        if not beside or known not in public:
            return (
                f"samfem needs its own package {name}, and Python finds that of another distribution, "
                f"{file or 'a folder'}: uninstall both and install samfem again, in an environment of its own"
            )
    return ""
