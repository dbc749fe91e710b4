"""Text and JSON values to the values that a declared kind takes."""

from __future__ import annotations

import sys
from contextlib import suppress
from typing import assert_never

from rvmon.errors import TraceError
from rvmon.trace.sample import Scalar
from rvmon.trace.schema import Kind
from rvmon.trace.stamps import is_whole

TRUE_WORDS = frozenset({"true", "True", "TRUE", "1"})
FALSE_WORDS = frozenset({"false", "False", "FALSE", "0"})


def scalar_of_text(text: str, kind: Kind) -> Scalar:
    """Read one cell of text.

    Args:
        text: not empty; `nan` (any case) reads as NaN for reals.
        kind: the declared kind of the signal or field.

    Raises:
        TraceError: the text is no value of that kind; the caller adds the place.

    >>> scalar_of_text("1", Kind.BOOL), scalar_of_text("1", Kind.REAL)
    (True, 1.0)
    """
    match kind:
        case Kind.BOOL:
            if text in TRUE_WORDS:
                return True
            if text in FALSE_WORDS:
                return False
        case Kind.INT | Kind.REAL:
            # Python reads 1_000 as a number; no recording means it.
            with suppress(ValueError):
                if "_" not in text:
                    return int(text) if kind is Kind.INT else float(text)
            if kind is Kind.INT and is_whole(text):
                most = sys.get_int_max_str_digits()
                raise TraceError(f"`{shorten(text)}` has more than {most} digits: is it a number?")
        case Kind.LABEL:
            return text
        case _:
            assert_never(kind)
    raise TraceError(f"`{shorten(text)}` is not {DESCRIPTION[kind]}")


DESCRIPTION = {
    Kind.BOOL: "a truth value (true, false, 1 or 0)",
    Kind.INT: "a whole number",
    Kind.REAL: "a number",
    Kind.LABEL: "a label",
}


def shorten(text: str, width: int = 40) -> str:
    """The text on one line, cut to `width` characters, with unprintable ones escaped.

    >>> shorten("a" * 50, 5)
    'aaaa…'
    """
    line = "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text[: width + 1])
    return line if len(line) <= width else line[: width - 1] + "…"
