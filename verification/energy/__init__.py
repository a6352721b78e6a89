# SPDX-License-Identifier: MIT
"""Where the work of the surface tractions goes: elastic and stored energy, and plastic dissipation over a
history.

The case on energy and its figures use this room; it uses the solvers.
"""
