"""All attempts of a report that were judged by columns, in its order."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from rvmon.monitor.columns.decided import DecidedAttempts
from rvmon.monitor.columns.texts import texts_of
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.attempt_json import attempt_text
from rvmon.verdict.lazy import LazyAttempts
from rvmon.verdict.verdict import Verdict

if TYPE_CHECKING:
    from numpy.typing import NDArray


class JudgedAttempts(LazyAttempts):
    """All attempts of a report, in its order.

    Args:
        parts: the decided ones, by requirement.
        kept: the others, as they are.
        order: int64[n], numbers of the decided ones, part by part, and then of the others.

    Attributes:
        parts: the same.
        kept: the same.
    """

    def __init__(
        self, parts: Sequence[DecidedAttempts], kept: Sequence[Attempt], order: NDArray[np.int64]
    ) -> None:
        self.parts = parts
        self.kept = kept
        self._parts: list[Sequence[Attempt]] = [*parts, kept]
        self._first = np.cumsum([0, *map(len, parts)])
        self._order = order

    def __len__(self) -> int:
        return len(self._order)

    @overload
    def __getitem__(self, index: int) -> Attempt: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Attempt]: ...
    def __getitem__(self, index: int | slice) -> Attempt | Sequence[Attempt]:
        if isinstance(index, slice):
            return tuple(self._attempt(number) for number in self._order[index].tolist())
        return self._attempt(self._order[index].item())

    def __iter__(self) -> Iterator[Attempt]:
        return map(self._attempt, self._order.tolist())

    def of(self, requirement: str, verdict: Verdict) -> Iterator[Attempt]:
        """See `LazyAttempts`."""
        numbers = self._others.get(requirement, {}).get(verdict, [])
        found = np.array(numbers, np.int64) + int(self._first[-2])
        place = self._places.get(requirement)
        if place is not None:
            chosen = np.flatnonzero(_chosen(self.parts[place], verdict))
            found = np.append(found, chosen + int(self._first[place]))
        return map(self._attempt, found[np.argsort(self._rank[found])].tolist())

    @cached_property
    def _places(self) -> Mapping[str, int]:
        """The part of each requirement that has one."""
        return {part.id: place for place, part in enumerate(self.parts)}

    @cached_property
    def _others(self) -> Mapping[str, Mapping[Verdict, list[int]]]:
        """The places among the other attempts, by requirement and verdict."""
        found: dict[str, dict[Verdict, list[int]]] = {}
        for number, one in enumerate(self._parts[-1]):
            found.setdefault(one.requirement, {}).setdefault(one.verdict, []).append(number)
        return found

    @cached_property
    def _rank(self) -> NDArray[np.int64]:
        """Of each number its place in the order."""
        rank = np.empty_like(self._order)
        rank[self._order] = np.arange(len(rank))
        return rank

    def texts(self, origin: int) -> Iterator[tuple[str, str]]:
        """See `LazyAttempts`."""
        names = np.concatenate([_names(part) for part in self._parts])
        texts = np.concatenate([_texts(part, origin) for part in self._parts])
        return zip(names[self._order].tolist(), texts[self._order].tolist(), strict=True)

    def __reduce__(self) -> tuple[Any, ...]:
        """What other processes get: the attempts themselves."""
        return tuple, (tuple(self),)

    def _attempt(self, number: int) -> Attempt:
        part = int(np.searchsorted(self._first, number, "right")) - 1
        return self._parts[part][number - int(self._first[part])]


def _chosen(part: DecidedAttempts, verdict: Verdict) -> NDArray[np.bool_]:
    """Which attempts have a verdict."""
    if verdict is Verdict.INCONCLUSIVE:
        return np.zeros(len(part), bool)
    passed = part.decisions.passed
    return passed if verdict is Verdict.PASS else ~passed


def _names(part: Sequence[Attempt]) -> NDArray[np.object_]:
    """The requirement of each attempt of a part."""
    if isinstance(part, DecidedAttempts):
        # `full` would take a name for an array of text, which has no NUL at its end.
        return np.array([part.id], object).repeat(len(part))
    return np.array([one.requirement for one in part], object)


def _texts(part: Sequence[Attempt], origin: int) -> NDArray[np.object_]:
    """The JSON text of each attempt of a part."""
    if isinstance(part, DecidedAttempts):
        return texts_of(part, origin)
    return np.array([attempt_text(one, origin) for one in part], object)
