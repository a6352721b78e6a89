# SPDX-License-Identifier: MIT
"""Asperities and rough patches."""
