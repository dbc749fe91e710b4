"""Names of a specification as identifiers of C, and as its strings and comments."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence

_CORES = "rv"
"""What the identifiers of the core itself start with."""
_PLAIN = frozenset(range(0x20, 0x7F)) - frozenset(map(ord, '"?\\'))
"""The bytes that mean themselves within a string; a `?` may begin a trigraph."""


def prefix_of(name: str) -> str:
    """What all identifiers of a specification start with.

    >>> prefix_of("Base v2"), prefix_of("2nd"), prefix_of("rv"), prefix_of("名前")
    ('base_v2', 'spec_2nd', 'spec_rv', 'spec')
    """
    made = _safe(name).lower()
    return made if made and made[0].isalpha() and made != _CORES else f"spec_{made}".rstrip("_")


def identifiers(names: Sequence[str]) -> list[str]:
    """A different identifier for each name, to be put behind a prefix.

    Names of which the same would be left get their number, whose `n` no other identifier has.

    >>> identifiers(["speed", "the speed", "the_speed", "名前"])
    ['SPEED', 'THE_SPEED_n1', 'THE_SPEED_n2', 'n3']
    """
    made = [_safe(name).upper() for name in names]
    count = Counter(made)
    return [
        one if one and count[one] == 1 else f"{one}_n{number}".lstrip("_")
        for number, one in enumerate(made)
    ]


def string(text: str) -> str:
    r"""A string literal with the text in UTF-8.

    >>> print(string('a "b" ??/ ä'))
    "a \042b\042 \077\077/ \303\244"
    """
    data = text.encode("utf-8", "surrogatepass")
    return '"' + "".join(chr(one) if one in _PLAIN else f"\\{one:03o}" for one in data) + '"'


def _safe(name: str) -> str:
    """What is left of a name: ASCII letters and digits, words with one line between them."""
    return re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")
