# SPDX-License-Identifier: MIT
"""Parameters of a body from measured dents: what was measured, the fit to it, and the helpers beside both."""

from verification.fit.definition import Definition, definition_of, read_definition
from verification.fit.fitting import Fitted, fit
from verification.fit.solves import FitError, Solves

__all__ = ["Definition", "FitError", "Fitted", "Solves", "definition_of", "fit", "read_definition"]
