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
from itertools import groupby

from markupsafe import Markup, escape

FUNCTIONS = set("sin cos tan sinh cosh tanh asin acos atan exp log ln max min tr dev sum".split())
SHORT_WORDS = set("at of in is no on to as by so or".split())
WORD = re.compile(r"[A-Za-z][a-z'’-]{2,}|[A-Z]{3,}|[GM]Pa|nm|[a-z]+_[a-z]{3,}")
NAME = re.compile(r"[a-z]{4,}|[A-Z]{3,}")
RAISED = dict(zip("⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻ᵖᵐᵉⁿ", "0123456789+−pmen", strict=True))
LOWERED = dict(zip("₀₁₂₃₄₅₆₇₈₉", "0123456789", strict=True))
OPEN, CLOSE = "([{", ")]}"
TENSORS = "σεΔ"
BRACKET = r"[(\[{]"
FACTOR = r"(?:[^\W_]|[(\[{√∂∫∬Σ½∞|])"
"""How a factor of a product begins."""
SIGNS = tuple(
    (re.compile(pattern), sign)
    for pattern, sign in (
        (">=", "≥"),
        ("<=", "≤"),
        (r"\bmu\b", "μ"),
        (r"\bsigma_", "σ_"),
        (r"\bs(?=[xyz]{2}\b)", "σ_"),
        (r"\bp0\b", "p₀"),
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
    parts = (
        str(with_scripts(part)) if words else f"<math>{_Reader(part).row()}</math>"
        for words, part in _chunks(text)
    )
    return Markup(" ".join(parts))


def _chunks(text: str) -> Iterator[tuple[bool, str]]:
    """Words (True) and symbols in their order; a chunk of symbols ends where the line may break."""
    pieces, marked, depth, breaks = text.replace(",  ", ", \x00 ").split(), [], 0, 0
    for k, piece in enumerate(pieces):
        word = not depth and _is_word(piece, pieces[k + 1 : k + 2])
        if piece == "\x00":
            breaks += 1
            continue
        if not word:
            depth += sum(map(piece.count, OPEN)) - sum(map(piece.count, CLOSE))
        marked.append((word, breaks, piece))
    for (word, _), group in groupby(marked, key=lambda each: each[:2]):
        yield word, " ".join(piece for *_, piece in group)


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
        self._left = text

    def _next(self, pattern: str) -> str:
        """What matches here, taken; empty if nothing does."""
        found = re.match(pattern, self._left)
        self._left = self._left[found.end() :] if found else self._left
        return found.group() if found else ""

    def row(self, until: str = "") -> str:
        """Everything up to the closing bracket, or to the end."""
        out = []
        while self._left and self._left[0] != until:
            out.append(self._quotient())
        return "".join(out)

    def _quotient(self) -> str:
        """A product, or a fraction of two."""
        if self._next(r"\s"):
            return '<mspace width="0.15em"/>'
        top = self._product()
        while top and re.match(f"/{FACTOR}", self._left):
            self._next("/")
            top = [f"<mfrac>{_one(top)}{_one(self._product())}</mfrac>"]
        return "".join(top) or f"<mo>{escape(self._next('.'))}</mo>"

    def _product(self) -> list[str]:
        factors = []
        while re.match(FACTOR, self._left):
            factors.append(self._factor())
        return factors

    def _factor(self) -> str:
        """A number, a symbol, a root or a bracket, with its scripts."""
        base = self._base()
        lower, upper = (_one([each]) if each else "" for each in self._scripts(base))
        tag = f"m{'sub' * bool(lower)}{'sup' * bool(upper)}"
        return f"<{tag}>{base}{lower}{upper}</{tag}>" if lower or upper else base

    def _base(self) -> str:
        if self._next("√"):
            return f"<msqrt>{self._within() if re.match(BRACKET, self._left) else self._factor()}</msqrt>"
        if re.match(BRACKET, self._left):
            sign = self._left[0]
            return f"<mrow><mo>{sign}</mo>{self._within()}<mo>{CLOSE[OPEN.index(sign)]}</mo></mrow>"
        if number := self._next(r"[0-9]+(\.[0-9]+)?"):
            return f"<mn>{number}</mn>"
        if letters := self._next("[A-Za-z]+"):  # a function, or a single symbol
            name = letters if letters in FUNCTIONS or NAME.fullmatch(letters) else letters[0]
            self._left = letters.removeprefix(name) + self._left
            return f"<mi>{name}</mi>"
        sign = self._next("[∫∬Σ|]")
        return f"<mo>{sign}</mo>" if sign else f"<mi>{escape(self._next('.'))}</mi>"

    def _within(self) -> str:
        close = CLOSE[OPEN.index(self._next("."))]
        inner = self.row(close)
        self._next(re.escape(close))
        return inner

    def _scripts(self, base: str) -> tuple[str, str]:
        lower, upper = "", ""
        if base.removeprefix("<mi>")[:1] in TENSORS:
            lower = "".join(f"<mi>{letter}</mi>" for letter in self._next("[xyz]{2}"))
        elif base == "<mi>R</mi>" and (letter := self._next("[xy]")):
            lower = f"<mi>{letter}</mi>"
        while True:
            if self._next("_"):
                lower += self._script()
            elif digit := self._next(f"[{''.join(LOWERED)}]"):
                lower += f"<mn>{LOWERED[digit]}</mn>"
            elif raised := self._next(f"[{''.join(RAISED)}]"):
                upper += _atom(RAISED[raised])
            elif self._next(r"\^"):
                upper += self._within() if re.match(BRACKET, self._left) else self._script()
            elif self._next("['′]"):
                upper += "<mo>′</mo>"
            elif base.startswith("<mi>") and self._next(r"\*"):
                upper += "<mo>*</mo>"
            else:
                return lower, upper

    def _script(self) -> str:
        if run := self._next(r"[−-]?[0-9.]*[0-9]|[A-Za-z0-9]+"):
            return _atom(run)
        return self._factor() if re.match(FACTOR, self._left) else ""


def _one(parts: list[str]) -> str:
    """Several elements as one; brackets around a whole numerator or denominator are not needed."""
    joined = "".join(parts)
    if len(parts) == 1 and joined.startswith("<mrow><mo>(</mo>") and joined.endswith("<mo>)</mo></mrow>"):
        joined = joined.removeprefix("<mrow><mo>(</mo>").removesuffix("<mo>)</mo></mrow>")
    return f"<mrow>{joined}</mrow>"


def _atom(text: str) -> str:
    if re.fullmatch(r"[−-]?[0-9.]+", text):
        return f"<mn>{text}</mn>"
    return f"<mo>{text}</mo>" if text in "+−" else f'<mi mathvariant="normal">{escape(text)}</mi>'
