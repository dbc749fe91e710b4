"""Attempts that are made when someone looks at them."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Sequence

from rvmon.verdict.attempt import Attempt
from rvmon.verdict.verdict import Verdict

_SHOWN = 3
"""So many attempts stand in the text of many."""


class LazyAttempts(Sequence[Attempt]):
    """Equal to any sequence of the same attempts; its text shows the first few."""

    @abstractmethod
    def __iter__(self) -> Iterator[Attempt]:
        """The attempts, each made as it is asked for."""

    @abstractmethod
    def of(self, requirement: str, verdict: Verdict) -> Iterator[Attempt]:
        """Those of a requirement with one verdict, in their order, each made as it is asked for."""

    @abstractmethod
    def texts(self, origin: int) -> Iterator[tuple[str, str]]:
        """The requirement and the JSON text of each, as `rvmon.verdict.attempt_json` writes it.

        Args:
            origin: the instant from which people count seconds, ticks.
        """

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Sequence):
            return NotImplemented
        return tuple(self) == tuple(other)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        first = ", ".join([*map(repr, self[:_SHOWN]), *["…"][: len(self) - _SHOWN]])
        word = "attempt" if len(self) == 1 else "attempts"
        return f"<{len(self)} {word}: {first}>"
