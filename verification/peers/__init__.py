# SPDX-License-Identifier: MIT
"""Other programs for the same contact, measured beside SAM in the same run: Tamaas, ContactMechanics and
aspher.

They live in an environment of their own (`make peers`), are started as child processes by its interpreter and
are never imported here. What both environments import is `problems`, `worker` and `programs`: standard
library and numpy.
"""
