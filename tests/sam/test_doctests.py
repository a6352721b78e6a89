# SPDX-License-Identifier: MIT
"""The examples in the texts of SAM give what they say."""

import doctest
import pkgutil
from importlib import import_module

import sam


def test_there_are_examples_and_they_give_what_they_say():
    """In all modules but those that are scripts."""
    names = ["sam", *(each.name for each in pkgutil.walk_packages(sam.__path__, "sam."))]
    examples = [doctest.testmod(import_module(name)) for name in names if not name.endswith("_child")]
    assert sum(each.failed for each in examples) == 0 and sum(each.attempted for each in examples) >= 9
