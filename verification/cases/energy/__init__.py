# SPDX-License-Identifier: MIT
"""Energy balances of both models."""
