# SPDX-License-Identifier: MIT
"""Smooth elastic contacts, the kernels below them, and what must not change them."""
