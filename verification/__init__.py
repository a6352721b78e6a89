# SPDX-License-Identifier: MIT
"""Everything around the two solvers: the command `samfem`, comparison, reference solutions, cases, report."""
