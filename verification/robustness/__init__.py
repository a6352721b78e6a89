# SPDX-License-Identifier: MIT
"""Input that is bad or extreme on purpose, runs that are killed, and mutants of the numerical core."""
