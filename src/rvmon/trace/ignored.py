"""Names that no specification declares, as data brings them."""

from __future__ import annotations

from collections import Counter

MOST_NAMES = 1_000
"""So many names are told apart."""

MORE = "… and more"
"""What counts for all other names."""


class Ignored(Counter[str]):
    """How often each name came; of many, all but the first are counted together.

    >>> seen = Ignored()
    >>> for number in range(MOST_NAMES + 5):
    ...     seen[f"name{number}"] += 1
    >>> len(seen) - MOST_NAMES, seen["name0"], seen[MORE]
    (1, 1, 5)
    """

    def __setitem__(self, name: str, count: int) -> None:
        """Set the count of a name, or add it to that of all others."""
        if name not in self and len(self) >= MOST_NAMES:
            name, count = MORE, self[MORE] + count
        super().__setitem__(name, count)
