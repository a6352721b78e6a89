# SPDX-License-Identifier: MIT
"""Patches that repeat: wavy and rough surfaces."""
