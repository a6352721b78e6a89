# SPDX-License-Identifier: MIT
"""Symbolic derivations of the tables of influence coefficients in sam/kernels. They need sympy and are not
installed.
"""
