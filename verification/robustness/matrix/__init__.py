# SPDX-License-Identifier: MIT
"""The robustness matrix: extremes of the input, what must become of each in each model, and why."""
