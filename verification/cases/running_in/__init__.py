# SPDX-License-Identifier: MIT
"""Wear over cycles, and what the paper says of its runs."""
