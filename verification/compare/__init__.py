# SPDX-License-Identifier: MIT
"""One result against another, quantity by quantity and field by field, each with a tolerance and its reason.

Used by the command `compare` and by verification cases.
"""
