# SPDX-License-Identifier: MIT
"""Bad input, killed runs, extremes, and mutants of the numerical core, which are no part of the wheel."""
