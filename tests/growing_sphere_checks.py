# SPDX-License-Identifier: MIT
"""Elastic constants of the body in which a sphere grows, and its hardening laws."""

YOUNG, NU = 210e9, 0.3
LAWS = {
    "linear": (0.02, lambda peeq: 1e9 + 10e9 * peeq),
    "perfect": (0.04, lambda peeq: 1e9 + 0 * peeq),
}
"""Misfit strains at the centre with their hardening laws, yield stress in Pa."""
