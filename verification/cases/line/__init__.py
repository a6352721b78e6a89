# SPDX-License-Identifier: MIT
"""Line contact: a cylinder on a half-space in plane strain, pressed, sliding and rolling."""
