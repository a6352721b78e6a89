# SPDX-License-Identifier: MIT
"""The verification suite: cases, the table of gates that they must reach, and the report.

Uses every room but `app`.
"""
