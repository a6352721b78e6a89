# SPDX-License-Identifier: MIT
"""What the axisymmetric and the three-dimensional model share: contact, load steps, plasticity and linear
solves.
"""
