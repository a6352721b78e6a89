# SPDX-License-Identifier: MIT
"""The command `samfem`: its commands from a scene file to a folder and an exit code.

The uppermost room: it may use every other one, and none of them uses it.
"""
