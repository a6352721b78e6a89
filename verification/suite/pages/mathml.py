# SPDX-License-Identifier: MIT
"""Formulas as the cases write them, in one line of text, as MathML; scripts in sentences and titles as HTML.

A line such as `σ_vM ≤ σ_y(ε_p), a³ = 3FR/(4E*)` is read so: letters are single symbols but for names of
functions; `_` and small digits are subscripts, `^` and raised ones superscripts, `*` right after a letter a
star; a slash makes a fraction of what stands around it without a space; words stay words between formulas,
where the line may break.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from markupsafe import Markup, escape

FUNCTIONS = set("sin cos tan sinh cosh tanh asin acos atan exp log ln max min tr dev sum".split())
SHORT_WORDS = set("at of in is no on to as by so or".split())
WORD = re.compile(r"[A-Za-z][a-z'’-]{2,}|[A-Z]{3,}|[GM]Pa|nm|[a-z]+_[a-z]{3,}")
NAME = re.compile(r"[a-z]{4,}|[A-Z]{3,}")
RAISED = dict(zip("⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻ᵖᵐᵉⁿ", "0123456789+−pmen", strict=True))
LOWERED = dict(zip("₀₁₂₃₄₅₆₇₈₉", "0123456789", strict=True))
OPEN, CLOSE = "([{", ")]}"
TENSORS = "σεΔ"
PAIR = re.compile(r"[xyz]{2}")
SIGNS = tuple(
    (re.compile(pattern), sign)
    for pattern, sign in (
        (">=", "≥"),
        ("<=", "≤"),
        (r"\bmu\b", "μ"),
        (r"\bsigma_", "σ_"),
        (r"(?<=[0-9] )um\b", "µm"),
        (r" %", "\N{NO-BREAK SPACE}%"),
    )
)
IN_TEXT = re.compile(r"(?<![\w])([A-Za-zσετνμκδ])_([A-Za-z0-9]+)\b")


def with_scripts(text: str) -> Markup:
    """A sentence in which σ_y0 has its subscript, and what is written in ASCII its sign."""
    for pattern, sign in SIGNS:
        text = pattern.sub(sign, text)
    return Markup(IN_TEXT.sub(r"\1<sub>\2</sub>", str(escape(text))))


def formula(text: str) -> Markup:
    """A line of formulas and words as HTML."""
    parts = []
    for words, symbols in _chunks(text):
        parts.append(f"<math>{_Reader(symbols).row()}</math>" if symbols else str(with_scripts(words)))
    return Markup(" ".join(parts))


def _chunks(text: str) -> Iterator[tuple[str, str]]:
    """(words, "") or ("", symbols), in their order; a chunk of symbols ends where the line may break."""
    pieces = re.split(r"\s+", text.replace(",  ", ", \x00 ").strip())
    words: list[str] = []
    symbols: list[str] = []
    depth = 0
    for k, piece in enumerate(pieces):
        break_here = piece == "\x00"
        if not break_here and not depth and _is_word(piece, pieces[k + 1 : k + 2]):
            if symbols:
                yield "", " ".join(symbols)
                symbols = []
            words.append(piece)
            continue
        if words:
            yield " ".join(words), ""
            words = []
        if break_here:
            if symbols:
                yield "", " ".join(symbols)
            symbols = []
        else:
            symbols.append(piece)
            depth += sum(map(piece.count, OPEN)) - sum(map(piece.count, CLOSE))
    yield (" ".join(words), "") if words else ("", " ".join(symbols))


def _is_word(piece: str, after: list[str]) -> bool:
    bare = piece.strip(",;:.()|")
    if bare in FUNCTIONS:
        return False
    if bare == "a":  # the contact radius, unless a word follows
        return bool(after) and bool(WORD.fullmatch(after[0].strip(",;:.")))
    return bare in SHORT_WORDS or bool(WORD.fullmatch(bare)) or ("/" in bare and _both_words(bare))


def _both_words(text: str) -> bool:
    return all(len(part) > 3 and WORD.fullmatch(part) for part in text.split("/"))


class _Reader:
    """Reads one formula from left to right."""

    def __init__(self, text: str) -> None:
        self._text, self._at = text, 0

    def row(self, until: str = "") -> str:
        """Everything up to the closing bracket, or to the end."""
        out = []
        while self._at < len(self._text) and self._peek() not in (until or "\0"):
            out.append(self._quotient())
        return "".join(out)

    def _peek(self, ahead: int = 0) -> str:
        at = self._at + ahead
        return self._text[at] if at < len(self._text) else ""

    def _take(self) -> str:
        self._at += 1
        return self._text[self._at - 1]

    def _quotient(self) -> str:
        """A product, or a fraction of two."""
        if self._peek().isspace():
            self._take()
            return '<mspace width="0.15em"/>'
        top = self._product()
        while top and self._peek() == "/" and self._starts_factor(1):
            self._take()
            below = self._product()
            top = [f"<mfrac>{_one(top)}{_one(below)}</mfrac>"]
        return "".join(top) or f"<mo>{_escape(self._take())}</mo>"

    def _product(self) -> list[str]:
        factors = []
        while self._starts_factor():
            factors.append(self._factor())
        return factors

    def _starts_factor(self, ahead: int = 0) -> bool:
        letter = self._peek(ahead)
        return bool(letter) and (letter.isalnum() or letter in OPEN or letter in "√∂∫∬Σ½∞" or letter == "|")

    def _factor(self) -> str:
        """A number, a symbol, a root or a bracket, with its scripts."""
        base = self._base()
        lower, upper = self._scripts(base)
        if lower and upper:
            return f"<msubsup>{base}{lower}{upper}</msubsup>"
        if lower:
            return f"<msub>{base}{lower}</msub>"
        return f"<msup>{base}{upper}</msup>" if upper else base

    def _base(self) -> str:
        letter = self._peek()
        if letter == "√":
            self._take()
            return f"<msqrt>{self._within() if self._peek() in OPEN else self._factor()}</msqrt>"
        if letter in OPEN:
            open_, inner = letter, self._within()
            close = CLOSE[OPEN.index(open_)]
            return f"<mrow><mo>{open_}</mo>{inner}<mo>{close}</mo></mrow>"
        if number := re.match(r"[0-9]+(\.[0-9]+)?", self._text[self._at :]):
            self._at += number.end()
            return f"<mn>{number.group()}</mn>"
        if name := re.match(r"[A-Za-z]+", self._text[self._at :]):
            return f"<mi>{self._name(name.group())}</mi>"
        if letter in "∫∬Σ|":
            return f"<mo>{self._take()}</mo>"
        return f"<mi>{_escape(self._take())}</mi>"

    def _name(self, letters: str) -> str:
        """The function that begins here, or a single symbol."""
        name = letters if letters in FUNCTIONS or NAME.fullmatch(letters) else letters[0]
        self._at += len(name)
        return name

    def _within(self) -> str:
        close = CLOSE[OPEN.index(self._take())]
        inner = self.row(close)
        if self._peek() == close:
            self._take()
        return inner

    def _scripts(self, base: str) -> tuple[str, str]:
        lower, upper = "", ""
        tensor = base.removeprefix("<mi>")[:1] in TENSORS and PAIR.match(self._text[self._at :])
        if tensor or (base == "<mi>R</mi>" and self._peek() in ("x", "y")):
            size = 2 if tensor else 1
            lower = "".join(f"<mi>{self._take()}</mi>" for _ in range(size))
        while True:
            if self._peek() == "_":
                self._take()
                lower += self._script()
            elif self._peek() and self._peek() in LOWERED:
                lower += f"<mn>{LOWERED[self._take()]}</mn>"
            elif self._peek() and self._peek() in RAISED:
                upper += _atom(RAISED[self._take()])
            elif self._peek() == "^":
                self._take()
                upper += self._within() if self._peek() in OPEN else self._script()
            elif self._peek() and self._peek() in "'′":
                self._take()
                upper += "<mo>′</mo>"
            elif self._peek() == "*" and base.startswith("<mi>"):
                self._take()
                upper += "<mo>*</mo>"
            else:
                return (_one([lower]) if lower else ""), (_one([upper]) if upper else "")

    def _script(self) -> str:
        run = re.match(r"[−-]?[0-9.]*[0-9]|[A-Za-z0-9]+", self._text[self._at :])
        if run is None:
            return self._factor() if self._starts_factor() else ""
        self._at += run.end()
        return _atom(run.group())


def _one(parts: list[str]) -> str:
    """Several elements as one; brackets around a whole numerator or denominator are not needed."""
    joined = "".join(parts)
    if len(parts) == 1 and joined.startswith("<mrow><mo>(</mo>") and joined.endswith("<mo>)</mo></mrow>"):
        joined = joined.removeprefix("<mrow><mo>(</mo>").removesuffix("<mo>)</mo></mrow>")
    return f"<mrow>{joined}</mrow>"


def _atom(text: str) -> str:
    if re.fullmatch(r"[−-]?[0-9.]+", text):
        return f"<mn>{text}</mn>"
    return f"<mo>{text}</mo>" if text in "+−" else f'<mi mathvariant="normal">{_escape(text)}</mi>'


def _escape(text: str) -> str:
    return str(escape(text))
