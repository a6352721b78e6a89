# SPDX-License-Identifier: MIT
"""The verification suite: it runs cases, holds what they measure against their rows, and writes the report.

`verify` runs cases, judges them and writes a report, a folder with the verdicts of one run, the figures and
every solve; `forecast` says what that takes; `outcomes` keeps what a case found, so that it need not run
again; `freshness` says what of a report is older than the code; `records` writes verdicts as gates.csv,
junit.xml and lines on the terminal, `changes` lists what differs between two reports; `pages` writes what
people read.
"""
