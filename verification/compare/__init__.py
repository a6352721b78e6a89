# SPDX-License-Identifier: MIT
"""One result against another, quantity by quantity and field by field, each with a tolerance and its reason.

The command `compare`, the figures and the cases use this room; it uses `runs`, `reference` and `text`, and
knows no solver.
"""
