# SPDX-License-Identifier: MIT
"""What goes wrong on purpose, for the cases on bad input, faults, extremes and mutation.

`fuzz`: bad input; `hostile`: what it is made of.
`kills`: commands that are killed, and what they leave.
`matrix`: extremes of the input.
`mutants`: changes of the numerical core; they ask the tests, and are no part of the wheel.
"""
