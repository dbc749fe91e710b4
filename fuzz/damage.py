"""Randomly damaged inputs, which a reader must refuse or read."""

from __future__ import annotations

import re
from collections.abc import Sequence
from random import Random

TOKENS = b"""
automaton query location invariant start edge when on do select system unit signal weight as
clock chan urgent broadcast committed const int bool typedef forall exists deadlock imply and
or not true false E<> A[] A<> E[] EF AG --> [<=3] -> == != <= >= ++ -- += := ! ? & && ||
( ) { } [ ] , ; : . ' " * / % + - 0 1 -1 7 99999999999999999999 0.5 x y i P0 l0
<template> </template> <location> <nta> </nta> &lt; &gt; &amp; &x; <![CDATA[ ]]> <!-- -->
""".split()
"""Words that have a meaning in the text formats of models, and some that have none."""

_PIECE = re.compile(rb"([A-Za-z_]\w*)|(\d+)|(\s+)|([^\w\s]+)|(_)")
"""The pieces of a text: words, numbers, space, signs."""

_NUMBERS = (b"0", b"1", b"3", b"-1", b"100", b"9999", b"16777216", b"2147483648")


def damaged(data: bytes, random: Random, others: Sequence[bytes]) -> bytes:
    """Replace, delete, repeat or insert one to five passages, also some from other inputs."""
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
    """The pieces of an input, each with its kind."""
    return [(found.lastindex or 0, found[0]) for found in _PIECE.finditer(data)]
