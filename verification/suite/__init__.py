# SPDX-License-Identifier: MIT
"""The verification suite: cases, the gates that they must reach, and the report.

What it does
    A *case* asks one question about the solvers and answers it with numbers: it solves scenes, measures
    them against an independent answer, and says what it has to show. A *gate* holds one of these numbers
    against a tolerance that has its reason beside it. A *report* is a folder with the verdicts of one
    run, the figures and every solve.

Where it is
    `cases/`      the cases, a module each (or a few with their scenes and tables), and `case`, the harness
    `gates/`      the table of gates, a file for each family of cases
    `judging`     reads that table and holds measured values against it
    `verify`      runs cases, judges them and writes the report
    `outcomes`    keeps what a case found in the store, so that it need not run again
    `records`     verdicts as gates.csv, junit.xml and lines on the terminal
    `report`      the page, from `templates/`
    `changes`     the gates that differ between two reports

Who may use it
    The command line (`samfem`) and the tests. It stands on every other room of `verification`
    and asks the solvers only for what `verification.runs.models`, `sam` and `fem_reference`
    hand out.
"""
