# SPDX-License-Identifier: MIT
"""A module for each program, named like it. Each is imported in the environment of its program only, and
gives:

load(): imports the program. versions(): name -> version. setup(problem, cells, settings): a function that
sets the problem up and returns one that solves it. read(answer): ({"iterations", "converged", ...}, fields).
Elastic fields: "pressure", (n, n) in units of E*. Elastic-plastic: "z" and "peeq" below the apex in units of
a and sigma_y/E.
"""
