# SPDX-License-Identifier: MIT
"""The pages that people read: made of stored results and figures, without solving anything."""

from verification.suite.pages.site import INDEX, ONE_FILE, remove_pages, write_report

__all__ = ["INDEX", "ONE_FILE", "remove_pages", "write_report"]
