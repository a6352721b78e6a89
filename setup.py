# SPDX-License-Identifier: MIT
"""The description of the package: README without its links to files, which end nowhere on a package index."""

import re
from pathlib import Path

from setuptools import setup

README = Path(__file__).with_name("README.md").read_text(encoding="utf-8")
TO_FILE = re.compile(r"!?\[([^][]*)\]\((?!https?:)[^()]*\)")

setup(
    long_description=TO_FILE.sub(lambda link: "" if link[0].startswith("!") else link[1], README),
    long_description_content_type="text/markdown",
)
