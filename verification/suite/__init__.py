# SPDX-License-Identifier: MIT
"""The verification suite: it runs cases, judges what they measure, and writes the report.

`verify`: the command, which runs the cases and writes the report.
`forecast`: what a report will take.
`outcomes`: what a case found, kept so that it need not run again.
`freshness`: what of a report is older than the code.
`changes`: what differs between two reports.
`records`: verdicts as results.json, gates.csv, junit.xml and lines on the terminal.
`pages`: what people read; `readme`: the numbers of README.md and of the guide.
"""
