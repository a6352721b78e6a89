# SPDX-License-Identifier: MIT
"""What a person sees while a command runs and after it: progress on stderr, tables on stdout."""

import codecs
import difflib
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from contextlib import AbstractContextManager, nullcontext
from html import escape as in_html
from typing import Any, Self, TextIO

from verification.text.readable import with_time

QUIET_S = 1.0
"""A command that is done by then shows no progress."""
LINE_EVERY_S = 5.0
"""Time between plain lines of one stage."""
NOTEBOOK_EVERY_S = 0.2
"""Time between two states of the bar in a notebook."""


def print_anything(stream: TextIO) -> None:
    """Let a stream take every text, see `_bytes_or_marks`. In the C locale µ would be an error."""
    if hasattr(stream, "reconfigure") and stream.errors in ("strict", "surrogateescape"):
        stream.reconfigure(errors=_ANYTHING)


def _bytes_or_marks(error: UnicodeEncodeError) -> tuple[bytes, int]:
    """For what an encoding lacks: the bytes of a file's name as they are, else question marks."""
    text = error.object[error.start : error.end]
    if all("\udc80" <= letter <= "\udcff" for letter in text):
        return text.encode("ascii", "surrogateescape"), error.end
    return b"?" * len(text), error.end


_ANYTHING = "samfem.bytes-or-marks"
codecs.register_error(_ANYTHING, _bytes_or_marks)


class Cleaned:
    """A text stream without what acts on a terminal, as question marks. rich draws to `uncleaned`."""

    def __init__(self, stream: TextIO) -> None:
        self.uncleaned = stream

    def write(self, text: str) -> int:
        """Write a text; line ends, tabs and bytes of names that are no control characters stay."""
        shown = (c if c.isprintable() or c in "\n\t" or "\udca0" <= c <= "\udcff" else "?" for c in text)
        return self.uncleaned.write(text if text.isprintable() else "".join(shown))

    def __getattr__(self, name: str) -> Any:
        return getattr(self.uncleaned, name)


def _console(stream: TextIO, **how: bool) -> Any:
    from rich.console import Console

    return Console(file=getattr(stream, "uncleaned", stream), **how)


def followed(
    progress: Callable[[str, int, int], None] | bool | None,
) -> AbstractContextManager[Callable[[str, int, int], None]]:
    """What solvers tell their progress: the callable itself; None: a bar for whoever is at a terminal or in a
    notebook; True: also plain lines elsewhere; False: nothing.
    """
    if callable(progress):
        return nullcontext(progress)
    if progress or (progress is None and (sys.stderr.isatty() or in_notebook())):
        return Progress(remaining=True)
    return nullcontext(lambda *_: None)


def in_notebook() -> bool:
    """Whether the kernel of a notebook runs this."""
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return getattr(shell, "kernel", None) is not None


class Progress:
    """The `progress` of the solvers: a bar, or plain lines, with `remaining` time. A context manager."""

    def __init__(self, remaining: bool = False):
        self._bar: Any = None
        self._task: Any = None
        self._stage, self._said, self._next = "", "", time.monotonic() + QUIET_S
        self._remaining, self._began = remaining, (0.0, 0)
        self._notebook = in_notebook()
        self._terminal = not self._notebook and sys.stderr.isatty()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_exception) -> None:
        if self._terminal and self._bar is not None:
            self._bar.stop()

    def __call__(self, stage: str, done: int, total: int, left: str = "") -> None:
        """Say how much of a stage is done (total 0: not known). left: what is said of all that is ahead."""
        now = time.monotonic()
        if self._terminal:
            self._draw(stage, done, total, left, now=now)
            return
        if stage != self._stage:
            self._stage, self._began = stage, (now, done)
        if now >= self._next or (stage == self._said and done == total):
            count = f": {done} of {total}" if total else ""
            line = f"{stage}{count}{left or self._left(done, total, now)}"
            if self._notebook:
                self._display(line, done, total)
            else:
                print(line, file=sys.stderr, flush=True)
            self._said = stage * (done != total)  # the last step of what was begun is said too, once
            self._next = now + (NOTEBOOK_EVERY_S if self._notebook else LINE_EVERY_S)

    def _display(self, line: str, done: int, total: int) -> None:
        """Show a state in place of the last one."""
        shown = {"text/plain": line}
        shown["text/html"] = f'<progress max="{total}" value="{done}"></progress> {in_html(line)}'
        if self._bar is None:
            self._bar = sys.modules["IPython"].display.display(shown, raw=True, display_id=True)
        else:
            self._bar.update(shown, raw=True)

    def _left(self, done: int, total: int, now: float) -> str:
        """The time that is left at the mean pace so far."""
        began, before = self._began
        if not self._remaining or not before < done < total:
            return ""
        return f", about {with_time((now - began) * (total - done) / (done - before))} left"

    def _draw(self, stage: str, done: int, total: int, left: str, *, now: float) -> None:
        from rich.markup import escape

        if self._bar is None and now < self._next:
            return
        if self._bar is None:
            from rich.progress import Progress as Bar

            shared = sys.stdout.isatty()  # lines on stdout stand above the bar
            self._bar = Bar(console=_console(sys.stderr), transient=True, redirect_stdout=shared)
            self._bar.start()
            self._task = self._bar.add_task("")
        if stage != self._stage:
            self._stage = stage
            self._bar.reset(self._task)
        self._bar.update(self._task, completed=done, total=total or None, description=escape(stage + left))


def print_table(columns: Sequence[str], rows: Sequence[Sequence[str]], red: Sequence[bool] = ()) -> None:
    """A table on stdout: drawn by rich on a terminal (rows marked red stand out), aligned text elsewhere."""
    if sys.stdout.isatty():
        from rich.box import SIMPLE_HEAD
        from rich.table import Column, Table

        narrow = (
            Column(name, no_wrap=True) for name in columns[1:]
        )  # on a small terminal the first column folds
        table = Table(
            Column(columns[0], min_width=18), *narrow, box=SIMPLE_HEAD, padding=(0, 1, 0, 0), pad_edge=False
        )
        for k, row in enumerate(rows):
            table.add_row(*row, style="bold red" if k < len(red) and red[k] else None)
        _console(sys.stdout, markup=False, emoji=False).print(table)
        return
    print("\n".join(table_lines(columns, rows)))


def table_lines(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """A table as aligned text."""
    widths = [max(map(len, cells)) for cells in zip(columns, *rows, strict=True)]
    return [
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in (columns, *rows)
    ]


def number(value: float | None, digits: int = 4) -> str:
    """A number for the page; a dash where there is none."""
    return "\N{EN DASH}" if value is None else f"{value:.{digits}g}".replace("-", "\N{MINUS SIGN}")


def digits(value: float | None, count: int = 6) -> str:
    """A number for the reader; a dash where there is none."""
    return "-" if value is None or value != value else f"{value:.{count}g}"


def unknown(kind: str, names: Sequence[str], known: Iterable[str], where: str) -> str:
    """A message about names that are not known, with those that look alike; where: how to see all of them."""
    parts = []
    for name in names:
        near = difflib.get_close_matches(name, list(known), n=3, cutoff=0.6)
        near += [one for one in known if name and one.startswith(name) and one not in near]
        hint = f" (did you mean {' or '.join(near[:3])}?)" if near else ""
        parts.append(f"{name!r}{hint}")
    return f"unknown {kind}{'s' * (len(parts) > 1)} {', '.join(parts)}: {where}"
