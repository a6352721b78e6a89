# SPDX-License-Identifier: MIT
"""Formulas and limits that others published."""
