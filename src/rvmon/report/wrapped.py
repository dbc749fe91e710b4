"""Sentences folded for a terminal."""

from __future__ import annotations

import re
import textwrap

_BEFORE_UNIT = re.compile(r"(?<=\d) (?=[a-zµ])")
_TOGETHER = "\N{NO-BREAK SPACE}"


def wrapped(sentence: str, width: int) -> str:
    """A sentence in lines, indented by two columns, from the second on by four.

    A number stays with its unit.

    Args:
        sentence: without line breaks.
        width: columns that a line may take.

    >>> print(wrapped("`released` occurred at 4.75 s, 0.75 s after the trigger", 32))
      `released` occurred at 4.75 s,
        0.75 s after the trigger
    """
    whole = _BEFORE_UNIT.sub(_TOGETHER, sentence)
    lines = textwrap.fill(
        whole,
        width,
        initial_indent="  ",
        subsequent_indent="    ",
        break_on_hyphens=False,
    )
    return lines.replace(_TOGETHER, " ")


def in_short(message: str) -> str:
    r"""What is wrong, of a message that goes on with how to fix it in further lines.

    >>> in_short("there is no column for what is read:\n  `go`, read by R1\n  say which it is")
    'there is no column for what is read: `go`, read by R1'
    """
    first, *rest = message.split("\n")
    return f"{first} {rest[0].strip()}" if rest and first.endswith(":") else first
