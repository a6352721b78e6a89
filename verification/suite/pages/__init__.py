# SPDX-License-Identifier: MIT
"""The pages that people read: made of stored results and figures, without solving anything.

`questions` says which question of a reader is answered by which gates, `groups` which cases stand
on which page; everything else is computed. Used by the harness after a run, and by `samfem report`.
"""

from verification.suite.pages.site import INDEX, ONE_FILE, remove_pages, write_report

__all__ = ["INDEX", "ONE_FILE", "remove_pages", "write_report"]
