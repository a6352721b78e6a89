# SPDX-License-Identifier: MIT
"""Spheres that yield the body, loaded and unloaded."""
