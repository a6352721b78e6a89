# SPDX-License-Identifier: MIT
"""Which names are those of an instrument's files: endings of names, and the formats of SurfaceTopography that
they stand for.
"""

from __future__ import annotations

ENDINGS = {
    "al3d": "al3d", "asc": "asc dat txt", "bcr": "bcr bcrf", "datx": "datx",
    "di": "001 002 003 004 005 spm", "ezd": "ezd nid", "frt": "frt", "gwy": "gwy", "ibw": "ibw",
    "jpk": "jpk", "lext": "lext", "mdt": "mdt", "metropro": "dat", "mi": "mi", "mitutoyo": "xlsx",
    "mnt": "mnt", "nc": "nc", "nmm": "zip", "nms": "nms", "oir": "oir", "opd": "opd", "opdx": "opdx",
    "os3d": "os3d", "plu": "apx plu", "plux": "plux", "poir": "poir", "ps": "tif tiff", "qep": "qep",
    "sdf": "sdf", "sur": "sur", "tmd": "tmd", "vk": "vk3 vk4 vk6 vk7", "wsxm": "cur stp tom top",
    "x3p": "x3p", "xyz": "hfm xyz", "zmg": "zmg", "zon": "zon",
}  # fmt: skip
"""Format, as the library calls it -> endings of names."""


def formats_of(name: str) -> tuple[str, ...]:
    """The formats that the ending of a name stands for; none for what is no instrument's file."""
    ending = name.rpartition(".")[2].lower()
    return tuple(found for found, endings in ENDINGS.items() if ending in endings.split())
