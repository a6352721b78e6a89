# SPDX-License-Identifier: MIT
"""The scenes that are shipped, and the recipes by which the heights of two of them were made."""

from typing import Any

from pydantic import BaseModel

from sam.scene import Grid


def with_keys(scene: BaseModel, section: str, **keys) -> Any:
    """The scene with other keys in one of its sections, which may be one in another: body.coating. Raises
    KeyError for a key that a section does not have.
    """
    name, _, inner = section.partition(".")
    old = getattr(scene, name) or Grid()  # which alone a scene may lack
    if not inner and (unknown := {*keys} - {*type(old).model_fields}):
        raise KeyError(*unknown)
    new = with_keys(old, inner, **keys) if inner else old.model_copy(update=keys)
    return scene.model_copy(update={name: new})
