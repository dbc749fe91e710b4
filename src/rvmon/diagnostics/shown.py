"""Texts that are not ours, for people to read: nothing in them steers a terminal or hides."""

from __future__ import annotations

import os
import re
import unicodedata

_STEERS_JSON = re.compile(
    "[\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]"  # what JSON itself leaves as it is
)


def shown(text: str) -> str:
    r"""The text with its control and formatting characters written out.

    Names, cells, labels, texts and files' names may hold escapes of a terminal, and signs that turn
    the direction of writing: everything that leaves for people goes through here. Ends of lines
    stay, and every kind of space.

    >>> print(shown("\x1b[31mred\x9b0m \u202eor not"))
    \x1b[31mred\x9b0m \u202eor not
    """
    if text.replace("\n", "").isprintable():
        return text
    return "".join(map(_shown, text))


def shown_line(text: str) -> str:
    r"""The same on one line: ends of lines, too, are written out.

    >>> print(shown_line("one\ntwo"))
    one\ntwo
    """
    return shown(text).replace("\n", r"\n")


def shown_json(text: str) -> str:
    r"""JSON text that reads back the same, with what would steer a terminal escaped as JSON does.

    >>> print(shown_json('"\x9b0m"'))
    "\u009b0m"
    """
    if text.isascii() and "\x7f" not in text:
        return text
    return _STEERS_JSON.sub(lambda found: f"\\u{ord(found[0]):04x}", text)


def _shown(char: str) -> str:
    if char == "\n" or char.isprintable() or unicodedata.category(char) == "Zs":
        return char
    return ascii(char)[1:-1]


def shown_path(path: str | os.PathLike[str]) -> str:
    """A path as text; names of files need not be.

    >>> shown_path("monday.csv")
    'monday.csv'
    """
    return os.fsencode(path).decode("utf-8", "replace")
