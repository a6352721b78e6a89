# SPDX-License-Identifier: MIT
"""Input that is bad or extreme on purpose, runs that are killed, and mutants of the numerical core.

The cases on bad input, faults, extremes (the robustness matrix) and mutation use this room; it uses `runs`
and `compare`. The mutants ask the tests, and are therefore no part of the wheel.
"""
