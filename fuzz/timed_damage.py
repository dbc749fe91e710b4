"""Models damaged at random: a reader refuses them or reads them, and never stumbles."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from random import Random

from rvmon.errors import ModelError
from rvmon.models.language.load import load_network, loads_network
from rvmon.models.search.budget import Budget
from rvmon.models.search.verify import verify
from rvmon.models.uppaal_xml import network_dot, uppaal_xml

SMALL = Budget(states=300, seconds=5.0)
"""What each query of a damaged model may cost."""

TOKENS = b"""
automaton query location invariant start edge when on do select system unit signal weight as
clock chan urgent broadcast committed const int bool typedef forall exists deadlock imply and
or not true false E<> A[] A<> E[] EF AG --> [<=3] -> == != <= >= ++ -- += := ! ? & && ||
( ) { } [ ] , ; : . ' " * / % + - 0 1 -1 7 99999999999999999999 0.5 x y i P0 l0
<template> </template> <location> <nta> </nta> &lt; &gt; &amp; &x; <![CDATA[ ]]> <!-- -->
""".split()
"""Words that both text forms give a meaning to, and some that they do not."""

_NUMBERS = (b"0", b"1", b"3", b"-1", b"100", b"9999", b"16777216", b"2147483648")
_KINDS = {
    re.compile(rb"[A-Za-z_]\w*"): None,
    re.compile(rb"\d+"): _NUMBERS,
    re.compile(rb"[<>=!]=|<|>|\+|-|\*|&&|\|\|"): None,
}
"""What is changed for another of its kind: of another model, or of these."""


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
    if random.random() < 0.4:
        lines = text.splitlines(keepends=True) or [b""]
        place = random.randrange(len(lines))
        lines[place : place + 1] = random.choice(([], [lines[place], random.choice(lines)]))
        return b"".join(lines)
    pattern, own = random.choice([*_KINDS.items()])
    found, fresh = [*pattern.finditer(text)], own or pattern.findall(other)
    if not found or not fresh:
        return text
    start, end = random.choice(found).span()
    instead = random.choice(fresh)
    return text[:start] + bytes(instead) + text[end:]


def _change_bytes(text: bytes, random: Random, other: bytes) -> bytes:
    """Whatever bytes can suffer: other ones, none, many times the same, a passage elsewhere."""
    start = random.randrange(len(text) + 1)
    end = min(len(text), start + random.choice((1, 1, 2, 5, 20, 100)))
    begin, to = random.randrange(len(other) + 1), random.randrange(start + 1)
    passage, token = text[start:end], random.choice(TOKENS)
    if random.random() < 1 / 7:
        return text[:to] + passage + text[to:start] + text[end:]
    instead = random.choice(
        (
            random.randbytes(random.randint(1, 3)),
            b"",
            passage * random.choice((2, 3, 51)),
            b" %b " % token,
            token + passage,
            other[begin : begin + random.choice((5, 30, 200))],
        )
    )
    return text[:start] + instead + text[end:]


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
