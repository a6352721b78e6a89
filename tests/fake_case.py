"""A verification case that a function runs, for tests of what stands around the cases."""

from collections.abc import Callable
from dataclasses import dataclass

from verification.cases.case import Case, Context, Outcome


@dataclass(frozen=True)
class FakeCase(Case):
    """Runs `does` in place of the parts."""

    does: Callable[[Context], Outcome] | None = None

    def run(self, context):
        return self.does(context)
