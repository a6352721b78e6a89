# SPDX-License-Identifier: MIT
"""Where the work of the surface tractions goes: elastic energy and plastic dissipation over a load
history.
"""
