"""Names that no specification declares, as data brings them."""

from __future__ import annotations

from collections import Counter

MOST_NAMES = 1_000
"""So many names are told apart."""

MORE = "… and more"
"""What counts for all other names."""


def bound(ignored: Counter[str]) -> None:
    """Of many names, count all but the first together.

    >>> seen = Counter({f"name{number}": 1 for number in range(MOST_NAMES + 5)})
    >>> bound(seen)
    >>> len(seen) - MOST_NAMES, seen["name0"], seen[MORE]
    (1, 1, 5)
    """
    if len(ignored) > MOST_NAMES + 1:
        further = [name for name in list(ignored)[MOST_NAMES:] if name != MORE]
        ignored[MORE] += sum(ignored.pop(name) for name in further)
