# SPDX-License-Identifier: MIT
"""Closed-form solutions of contact mechanics: for tests, verification cases and users.

Modules: hertz (circular), elliptic (Hertz, elliptic), hamilton (sliding sphere), westergaard (one-dimensional
wave), flat_punch, indentation (elastic-perfectly plastic sphere, fits), mindlin_cheng (eigenstrain sphere),
point_loads (Boussinesq, Cerruti), stress (von Mises); film on a half-space: coated_sphere, coated_changes
(where the film matters), burmister (pavement), bonded_film (plastic), film_flow (any path), regime (film and
metal), layered, layered_axisymmetric (responses).

Conventions: half-space z >= 0, z into the body, tension positive, pressure p > 0 compressive, u_z > 0 into
the body, tangential traction on the body along +x. SI units. Coordinates are scalars or arrays that
broadcast; a stress has a last axis of length 6 in the order xx, yy, zz, yz, xz, xy. Bad input raises
ValueError naming the argument.
"""
