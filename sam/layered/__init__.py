# SPDX-License-Identifier: MIT
"""Elastic film bonded on an elastic half-space: frequency response and influence coefficients."""
