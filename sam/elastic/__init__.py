# SPDX-License-Identifier: MIT
"""Elastic contact under the loads of a schedule: the contact solve, stresses at the output depths,
displacements.

`sam.elastic.problem` has what stays the same over the load steps, and the state under one of them.
"""
