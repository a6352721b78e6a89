# SPDX-License-Identifier: MIT
"""Elastic and yielding films on a half-space."""
