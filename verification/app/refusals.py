# SPDX-License-Identifier: MIT
"""The errors that say what is wrong with the input of a command, which ends in exit code 2."""

from sam.scene import SceneError
from verification.runs.files import FolderError
from verification.runs.models import ModelError

REFUSALS = (SceneError, FolderError, ModelError)
