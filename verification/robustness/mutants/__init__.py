# SPDX-License-Identifier: MIT
"""Mutants of the numerical core: one number perturbed at a time, and what the fast tests say to it."""
