# SPDX-License-Identifier: MIT
"""A model solved by name, and where its result is kept: the folder of a run, its checkpoint, the store.

Every room that solves a scene or reads a result uses this one. It uses `text` and the solvers by what their
packages export; records are taken apart and built by the codec of `sam.scene`.
"""
