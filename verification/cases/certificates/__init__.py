# SPDX-License-Identifier: MIT
"""Conditions of the problem, measured on what solvers return."""
