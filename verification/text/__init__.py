# SPDX-License-Identifier: MIT
"""Text for a person: tables and progress on a terminal, numbers with prefixes and units. Uses no other
room.
"""
