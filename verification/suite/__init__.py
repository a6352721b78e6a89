# SPDX-License-Identifier: MIT
"""The verification suite: it runs cases, judges what they measure, and writes the report."""
