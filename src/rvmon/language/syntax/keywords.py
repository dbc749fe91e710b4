"""The keywords of the language, and the split of a file into items at these words."""

from __future__ import annotations

import re
from itertools import pairwise

from rvmon.language.checked.operators import PREFIXED, BinaryOp, UnaryOp

ITEM_WORDS = (
    *("spec", "time", "import", "signal", "event", "define", "const", "requirement", "property"),
    *("cover", "coverpoint", "cross"),
)
"""Words that start an item. `max delay` also does, but `max` alone is a function."""

_PREFIXES = [op for op in UnaryOp if op.entry.level == PREFIXED and op is not UnaryOp.NOT]
_INFIXES = [op for op in BinaryOp if op.is_kin_of_until]
OPERATOR_TERMINALS = {
    **{op.name: op.spellings for op in BinaryOp if op not in _INFIXES},
    "TEMPORAL": tuple(text for op in _PREFIXES for text in op.spellings),
    "INFIX": tuple(text for op in _INFIXES for text in op.spellings),
}
"""The grammar's terminals for operators, each with all spellings."""

_TEMPORAL_WORDS = (
    *OPERATOR_TERMINALS["TEMPORAL"],
    *("within", "for", "immediately"),
    *("A", "E", "AG", "AF", "AX", "EG", "EF", "EX"),
)
_OTHER_WORDS = (
    *("upon", "whenever", "then", "if", "else", "not", "start", "end", "true", "false"),
    *(text for op in BinaryOp if op not in _INFIXES for text in op.spellings if text.isalpha()),
)

RESERVED = frozenset((*ITEM_WORDS, *_TEMPORAL_WORDS, *_OTHER_WORDS))
"""Words that are names only in backticks."""

INFIX_WORDS = frozenset(" ".join(OPERATOR_TERMINALS["INFIX"]).split())
"""Words of operators between formulas. Where an operand is expected they are names."""

CLAUSE_WORDS = frozenset(
    {
        *("source", "rationale", "severity", "tags", "scope", "at", "let", "monitor", "in"),
        *("goal", "weight", "ignore", "illegal"),
    }
)
"""Words that start a clause of an item; elsewhere they are names."""

NOT_UNITS = RESERVED | INFIX_WORDS | CLAUSE_WORDS | frozenset(("input", "output", "stale", "of"))
"""Words that are never read as the unit of a number before them."""

_ITEM = (  # compiled on first use, as most starts of `rvmon` split no text
    rf"^[ \t\ufeff]*(?P<word>{'|'.join(ITEM_WORDS)}|max(?=\s+delay))(?!\w|\.\w)"
    r"(?P<named>[ \t]*(?:\w[\w.]*|`[^`\n]*`)[ \t]*:)?"
)


def split_items(text: str) -> list[tuple[int, int]]:
    r"""The ranges `[start, end)` of the items; text before the first item is a range of its own.

    `property` inside a requirement is one of its clauses unless a name and a colon follow.

    >>> split_items("spec a\nevent b")
    [(0, 7), (7, 14)]
    """
    starts: list[int] = []
    inside = ""
    for head in re.finditer(_ITEM, text, re.MULTILINE):
        word = head["word"]
        if word == "property" and inside == "requirement" and not head["named"]:
            continue
        starts.append(head.start("word"))
        inside = word
    first = starts[0] if starts else len(text)
    places = list(pairwise([*starts, len(text)]))
    return places if _blank(text[:first]) else [(0, first), *places]


def _blank(text: str) -> bool:
    """Whether a text consists of comments and white space."""
    lines = text.replace("\ufeff", "").split("\n")
    return all(line.lstrip().startswith("#") or not line.strip() for line in lines)
