# SPDX-License-Identifier: MIT
"""A model solved by name, and where its result is kept: the folder of a run, its checkpoint, the store."""
