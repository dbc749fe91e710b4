"""Models damaged at random: a reader refuses them or reads them, and never stumbles."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from random import Random

from rvmon.errors import ModelError
from rvmon.export.uppaal import network_dot, uppaal_xml
from rvmon.timed.language.load import load_network, loads_network
from rvmon.timed.search.meter import Budget
from rvmon.timed.search.verify import verify

SMALL = Budget(states=300, seconds=5.0)
"""What each query of a damaged model may cost."""

_WORDS = """
automaton query location invariant start edge when on do select system unit signal weight as
clock chan urgent broadcast committed const int bool typedef forall exists deadlock imply and
or not true false E<> A[] A<> E[] EF AG --> [<=3] -> == != <= >= ++ -- += := ! ? & && ||
( ) { } [ ] , ; : . ' " * / % + - 0 1 -1 7 99999999999999999999 0.5 x y i P0 l0
<template> </template> <location> <nta> </nta> &lt; &gt; &amp; &x; <![CDATA[ ]]> <!-- -->
"""
TOKENS = tuple(_WORDS.split())
"""Words that both text forms give a meaning to, and some that they do not."""


_WORD = re.compile(rb"[A-Za-z_]\w*")
_NUMBER = re.compile(rb"\d+")
_SIGN = re.compile(rb"[<>=!]=|<|>|\+|-|\*|&&|\|\|")
_NUMBERS = (b"0", b"1", b"3", b"-1", b"100", b"9999", b"16777216", b"2147483648")


def damaged(data: bytes, random: Random, others: Sequence[bytes]) -> bytes:
    """A model with one to five changes, of bytes, passages and lines, or of words and numbers.

    Args:
        data: of the model.
        random: the source of all choices.
        others: models that passages and words are taken from.
    """
    text = data
    change = random.choice((_change_bytes, _change_words, _change_words))
    for _ in range(random.choice((1, 1, 1, 1, 2, 5))):
        text = change(text, random, random.choice(others))
    return text


def _change_words(text: bytes, random: Random, other: bytes) -> bytes:
    """A word for another word, a number for a number, a sign for a sign, or lines moved about."""
    match random.randrange(5):
        case 0:
            return _swapped(_WORD, text, random, _WORD.findall(other))
        case 1:
            return _swapped(_NUMBER, text, random, _NUMBERS)
        case 2:
            return _swapped(_SIGN, text, random, _SIGN.findall(other))
        case 3:
            lines = text.splitlines(keepends=True)
            lines.insert(random.randrange(len(lines) + 1), random.choice(lines or [b""]))
            return b"".join(lines)
        case _:
            lines = text.splitlines(keepends=True)
            if lines:
                del lines[random.randrange(len(lines))]
            return b"".join(lines)


def _swapped(
    pattern: re.Pattern[bytes], text: bytes, random: Random, fresh: Sequence[bytes]
) -> bytes:
    found = list(pattern.finditer(text))
    if not found or not fresh:
        return text
    place = random.choice(found)
    return text[: place.start()] + random.choice(fresh) + text[place.end() :]


def _change_bytes(data: bytes, random: Random, other: bytes) -> bytes:
    """Whatever bytes can suffer: other ones, none, many times the same, a passage elsewhere."""
    text = bytearray(data)
    start = random.randrange(len(text) + 1)
    end = min(len(text), start + random.choice((1, 1, 2, 5, 20, 100)))
    match random.randrange(7):
        case 0:
            text[start:end] = bytes(random.randrange(256) for _ in range(random.randint(1, 3)))
        case 1:
            del text[start:end]
        case 2:
            text[start:start] = text[start:end] * random.choice((1, 2, 50))
        case 3:
            text[start:end] = b" " + random.choice(TOKENS).encode() + b" "
        case 4:
            text[start:start] = random.choice(TOKENS).encode()
        case 5:
            begin = random.randrange(len(other) + 1)
            text[start:end] = other[begin : begin + random.choice((5, 30, 200))]
        case _:
            to = random.randrange(len(text) + 1)
            passage = text[start:end]
            del text[start:end]
            text[to:to] = passage
    return bytes(text)


def survives(path: Path) -> str:
    """Read a file as a model and do with it what can be done; how far that went.

    Any exception but `ModelError` is a fault of the reader, or of the checker, and is not caught.

    Returns:
        `refused`, `stopped` (a query or a run of it is refused) or `checked`.
    """
    try:
        network = load_network(path)
    except ModelError as error:
        return _told(error, "refused")
    network_dot(network)
    try:
        loads_network(uppaal_xml(network))
        for query in network.queries[:3]:
            verify(network, query, budget=SMALL)
    except ModelError as error:
        return _told(error, "stopped")
    return "checked"


def _told(error: ModelError, end: str) -> str:
    if not error.diagnostics:
        raise error  # people would see nothing
    return end
