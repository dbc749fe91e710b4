"""A file into its items, each from its word at a line's start to the next."""

from __future__ import annotations

import re
from itertools import pairwise

from rvmon.spec.syntax.words import ITEM_WORDS

_ITEM = re.compile(
    rf"^[ \t\ufeff]*(?P<word>{'|'.join(ITEM_WORDS)}|max(?=\s+delay))(?!\w|\.\w)"
    r"(?P<named>[ \t]*(?:\w[\w.]*|`[^`\n]*`)[ \t]*:)?",
    re.MULTILINE,
)


def split_items(text: str) -> list[tuple[int, int]]:
    r"""The places `[start, end)` of the items, with what stands before the first one, if anything.

    `property` inside a requirement is a clause of it unless a name and a colon follow.

    >>> split_items("spec a\nevent b")
    [(0, 7), (7, 14)]
    """
    starts: list[int] = []
    inside = ""
    for found in _ITEM.finditer(text):
        word = found["word"]
        if word == "property" and inside == "requirement" and not found["named"]:
            continue
        starts.append(found.start("word"))
        inside = word
    first = starts[0] if starts else len(text)
    places = list(pairwise([*starts, len(text)]))
    return places if _blank(text[:first]) else [(0, first), *places]


def _blank(text: str) -> bool:
    """Whether there are only comments and space."""
    lines = text.replace("\ufeff", "").split("\n")
    return all(line.lstrip().startswith("#") or not line.strip() for line in lines)
