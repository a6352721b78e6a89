# SPDX-License-Identifier: MIT
"""What a solve costs: its stages, memory and time predicted and measured, and advice on the method for an
error.

The predictions count the sizes of the solvers' plans. The commands `plan`, `solve` and `sweep`, the figures
and the cases on growth and work-precision use this room; it uses `runs`, `reference` and `text`.
"""
