# SPDX-License-Identifier: MIT
"""A counter-body that moves over the body: where it is, what drives it, and the track that it leaves. Only
scenes with a path load it.
"""
