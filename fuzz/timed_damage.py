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

_PIECE = re.compile(rb"([A-Za-z_]\w*)|(\d+)|(\s+)|([^\w\s]+)|(_)")
"""What a model is made of: words, numbers, space, signs."""

_NUMBERS = (b"0", b"1", b"3", b"-1", b"100", b"9999", b"16777216", b"2147483648")


def damaged(data: bytes, random: Random, others: Sequence[bytes]) -> bytes:
    """A model with one to five changes of pieces: of another kind, none, often, from elsewhere.

    Args:
        data: of the model.
        random: the source of all choices.
        others: models that pieces are taken from.
    """
    pieces = _pieces(data)
    for _ in range(random.choice((1, 1, 1, 1, 2, 5))):
        other = _pieces(random.choice(others))
        at, begin = random.randrange(len(pieces)), random.randrange(len(other))
        end = at + random.choice((1, 1, 1, 2, 5, 20))
        kind, passage = pieces[at][0], pieces[at:end]
        alike = [one for one in other if one[0] == kind] or passage
        noise = random.choice((random.choice(TOKENS), random.choice(_NUMBERS), random.randbytes(2)))
        instead = random.choice(
            (
                [random.choice(alike), *passage[1:]],
                [random.choice(alike), *passage[1:]],
                [],
                passage * random.choice((2, 3, 51)),
                [(0, noise)],
                [(0, b" %b " % noise), *passage],
                other[begin : begin + random.choice((2, 8, 40))],
            )
        )
        pieces[at:end] = instead or ([] if len(pieces) > len(passage) else passage)
    return b"".join(text for _, text in pieces)


def _pieces(data: bytes) -> list[tuple[int, bytes]]:
    """The pieces of a model, each with its kind."""
    return [(found.lastindex or 0, found[0]) for found in _PIECE.finditer(data)]


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
