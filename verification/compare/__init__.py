# SPDX-License-Identifier: MIT
"""One result against another, quantity by quantity and field by field."""
