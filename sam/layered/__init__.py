# SPDX-License-Identifier: MIT
"""Elastic coating bonded on an elastic half-space: frequency response and influence coefficients."""
