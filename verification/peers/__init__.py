# SPDX-License-Identifier: MIT
"""Other programs for the same contact, measured beside SAM in the same run: Tamaas, ContactMechanics and
aspher.

They live in an environment of their own (`make peers`), are started as child processes by its interpreter and
are never imported here. What both environments import is `problems`, `worker`, `programs` and
`verification.runs.models`: standard library and numpy.
"""
