# SPDX-License-Identifier: MIT
"""Closed-form solutions of contact mechanics: for tests, verification cases and users.

The first line of each module says which problem it solves.

Conventions: half-space z >= 0, z into the body, tension positive, pressure p > 0 compressive, u_z > 0 into
the body, tangential traction on the body along +x. SI units. Coordinates are scalars or arrays that
broadcast; a stress has a last axis of length 6 in the order xx, yy, zz, yz, xz, xy. Bad input raises
ValueError naming the argument.
"""
