# SPDX-License-Identifier: MIT
"""Mutants: one number, comparison or condition changed at a time, and what the fast tests say to it."""
