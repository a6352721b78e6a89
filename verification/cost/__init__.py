# SPDX-License-Identifier: MIT
"""What a solve costs: predicted and measured stages, memory and time, and advice for an error."""
