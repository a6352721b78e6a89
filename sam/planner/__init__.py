# SPDX-License-Identifier: MIT
"""From a scene to all that its solution needs. What is below the planner takes no scene, but the parts that
it needs.
"""
