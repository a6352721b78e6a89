# SPDX-License-Identifier: MIT
"""The axisymmetric finite-element model of a smooth contact without friction."""
