# SPDX-License-Identifier: MIT
"""The command `samfem`: each command from its file to a folder and an exit code.

`cli` parses the command line and names the module of each command in one table. This is the uppermost room:
it may use every other one, and none uses it.
"""
