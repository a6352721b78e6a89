# SPDX-License-Identifier: MIT
"""A counter-body that moves over the surface."""
