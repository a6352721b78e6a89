# SPDX-License-Identifier: MIT
"""From solved states to the result record: history, states, tables, scalar quantities, mesh and warnings."""
