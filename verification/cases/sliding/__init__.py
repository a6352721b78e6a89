# SPDX-License-Identifier: MIT
"""Full slip along x, elastic and elasto-plastic."""
