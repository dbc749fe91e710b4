"""Models damaged at random: a reader refuses them or reads them, and never stumbles."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from random import Random

from rvmon.errors import ModelError
from rvmon.export.network_dot import network_dot
from rvmon.export.uppaal import uppaal_xml
from rvmon.timed.load import load_network, loads_network
from rvmon.timed.search import Budget
from rvmon.timed.verify import verify

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


def damaged(data: bytes, random: Random, others: Sequence[bytes]) -> bytes:
    """A model with one to five changes of bytes, words or passages.

    Args:
        data: of the model.
        random: the source of all choices.
        others: models that passages are taken from.
    """
    text = bytearray(data)
    for _ in range(random.choice((1, 1, 1, 1, 2, 5))):
        start = random.randrange(len(text) + 1)
        end = min(len(text), start + random.choice((1, 1, 2, 5, 20, 100)))
        match random.randrange(8):
            case 0:
                text[start:end] = bytes(random.randrange(256) for _ in range(random.randint(1, 3)))
            case 1:
                del text[start:end]
            case 2:
                text[start:start] = text[start:end] * random.choice((1, 2, 50))
            case 3 | 4:
                text[start:end] = b" " + random.choice(TOKENS).encode() + b" "
            case 5:
                text[start:start] = random.choice(TOKENS).encode()
            case 6:
                other = random.choice(others)
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
