"""Figures of robustness."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, overload

from rvmon.verdict.attempt import Attempt, Decision, measured_attempt
from rvmon.verdict.verdict import Verdict


@dataclass(frozen=True, slots=True)
class Robustness:
    """How far a formula is from the other truth value, in base units.

    Attributes:
        low: the least that it can be, whatever is not known and whatever had come after the end.
        high: the greatest.
        kept: the least, if all is well behind the end that only has to be kept up.
    """

    low: float
    high: float
    kept: float

    def of(self, attempt: Attempt) -> float | None:
        """The figure for a decided attempt: its distance from the other verdict, at least."""
        match attempt.decision, attempt.verdict:
            case Decision.OPEN, _:
                return None
            case _ if self.low == self.high:
                return self.low
            case Decision.HELD_TO_END, _:
                return self.kept
            case Decision.PREFIX, Verdict.PASS:
                return self.low
            case Decision.PREFIX, Verdict.FAIL:
                return self.high
            case _:
                return None


@dataclass(frozen=True, slots=True)
class Measured:
    """A figure of a run.

    Attributes:
        requirement: its id.
        number: of the attempt; `None` for what the requirement owes at a position, as in a stream.
        t: the instant of the trigger, or of the position, ticks.
        robustness: the figure.
        in_doubt: whether it is not known that there was a trigger.
    """

    requirement: str
    number: int | None
    t: int
    robustness: Robustness
    in_doubt: bool = False


_FIELDS = (
    *((Measured, name) for name in ("requirement", "number", "t", "robustness", "in_doubt")),
    *((Robustness, name) for name in ("low", "high", "kept")),
)
"""In the order of `module_margins.h`."""

FIGURES = Measured, Robustness, tuple(getattr(type_, name) for type_, name in _FIELDS)
"""What the core makes figures of: types, and what sets their fields."""


class Stream(Sequence[tuple[int, Robustness]]):
    """Figures at instants, as arrays; each is made when it is asked for.

    Args:
        times: int64[n] ticks.
        low: float64[n]; so are the others.
        high: as in `Robustness`.
        kept: as in `Robustness`.
    """

    def __init__(self, times: Any, low: Any, high: Any, kept: Any) -> None:
        self.times, self.low, self.high, self.kept = times, low, high, kept

    def __len__(self) -> int:
        return len(self.times)

    def __iter__(self) -> Iterator[tuple[int, Robustness]]:
        figures = map(Robustness, self.low.tolist(), self.high.tolist(), self.kept.tolist())
        return zip(self.times.tolist(), figures, strict=True)

    @overload
    def __getitem__(self, place: int) -> tuple[int, Robustness]: ...

    @overload
    def __getitem__(self, place: slice) -> Stream: ...

    def __getitem__(self, place: int | slice) -> tuple[int, Robustness] | Stream:
        found = [one[place] for one in (self.times, self.low, self.high, self.kept)]
        if isinstance(place, slice):
            return Stream(*found)
        t, *figures = (one.item() for one in found)
        return t, Robustness(*figures)


Key = tuple[str, int]
"""Requirement and number of an attempt."""


@dataclass(frozen=True, slots=True)
class Margins:
    """The robustness of all attempts of a run.

    Attributes:
        attempts: by requirement and number.
        doubtful: those in doubt that have a record, the same way.
        streams: by requirement, at the instants of samples: the robustness of what it owes there.
            Requirements with `let` or `for each` have none: it would depend on the attempt.
    """

    attempts: Mapping[Key, Robustness]
    doubtful: Mapping[Key, Robustness]
    streams: Mapping[str, Sequence[tuple[int, Robustness]]]

    def of(self, attempt: Attempt) -> Attempt:
        """An attempt with its figure."""
        figures = self.doubtful if attempt.in_doubt else self.attempts
        found = figures.get((attempt.requirement, attempt.number))
        return attempt if found is None else measured_attempt(attempt, found.of(attempt))
