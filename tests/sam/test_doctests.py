# SPDX-License-Identifier: MIT
"""The examples in the texts of the packages give what they say."""

import doctest
import pkgutil
from importlib import import_module

PACKAGES = ("sam.scene", "sam.kernels", "sam.layered", "sam.contact", "sam.tribofilm", "sam.wear")


def examples(package: str) -> tuple[int, int]:
    """(failed, tried) of all modules of a package; a module that is a script is left out."""
    root = import_module(package)
    names = [
        package,
        *(each.name for each in pkgutil.walk_packages(getattr(root, "__path__", ()), f"{package}.")),
    ]
    found = [doctest.testmod(import_module(name)) for name in names if not name.endswith("_child")]
    return sum(each.failed for each in found), sum(each.attempted for each in found)


def test_there_are_examples_and_they_give_what_they_say():
    failed, tried = zip(*map(examples, PACKAGES), strict=True)
    assert sum(failed) == 0 and sum(tried) >= 9
