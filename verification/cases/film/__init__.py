# SPDX-License-Identifier: MIT
"""The tribofilm and its law."""
