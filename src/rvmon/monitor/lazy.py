"""Attempts that are made when someone looks at them."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Sequence

from rvmon.verdict.attempt import Attempt

_SHOWN = 3
"""So many attempts stand in the text of many."""


class LazyAttempts(Sequence[Attempt]):
    """Equal to any sequence of the same attempts; its text shows the first few."""

    @abstractmethod
    def __iter__(self) -> Iterator[Attempt]:
        """The attempts, each made as it is asked for."""

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Sequence):
            return NotImplemented
        return tuple(self) == tuple(other)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        first = ", ".join([*map(repr, self[:_SHOWN]), *["…"][: len(self) - _SHOWN]])
        return f"<{len(self)} attempts: {first}>"
