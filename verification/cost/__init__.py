# SPDX-License-Identifier: MIT
"""What a solve costs: stages, memory and time predicted and measured, and advice on the method for an error.

Uses `runs`, `reference` and `text`.
"""
