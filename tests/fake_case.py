"""A verification case that a function runs, for tests of what stands around the cases."""

from collections.abc import Callable
from dataclasses import dataclass

from verification.cases.case import Case, Context, Outcome
from verification.judging import Row


@dataclass(frozen=True)
class FakeCase(Case):
    """Runs `does` in place of the parts."""

    does: Callable[[Context], Outcome] | None = None

    def run(self, context):
        return self.does(context)


def row(name: str, case: str = "", **changed) -> Row:
    """A row that holds a value to a tenth of another, or with what is changed of it."""
    said = {"quantity": name, "metric": "relative", "tolerance": 0.1, "reason": "because", "kind": "exact"}
    return Row(id=name, case=case or name.partition(".")[0], **said | changed)
