"""Robustness figures of attempts, and a monitor that computes them online."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, overload

from msgspec import Struct

from rvmon.errors import TraceError
from rvmon.monitor.compiled_spec import CompiledSpec
from rvmon.monitor.feed import FedMonitor, Feed
from rvmon.monitor.listeners import OneCall
from rvmon.monitor.packed_plan import planned_core
from rvmon.native import Bounds, Figure
from rvmon.trace.time import ticks_of_seconds, whole_ticks
from rvmon.verdicts import Verdict
from rvmon.verdicts.attempt import Attempt, Decision, measured_attempt


@dataclass(frozen=True, slots=True)
class Robustness(Bounds):
    """Bounds on the robustness of a formula, in SI base units.

    Attributes:
        low: lower bound over all values of unknown input and all continuations of the trace.
        high: upper bound, likewise.
        kept: lower bound if every opened unbounded `R` (`always`) continues to hold after the end.
    """

    low: float
    high: float
    kept: float

    def of(self, attempt: Attempt) -> float | None:
        """The robustness of a decided attempt, or the bound that is nearer to the other verdict.

        `None` for attempts left open or settled by a policy, and where the bounds contradict the
        verdict because the decisive input lies outside the measured part of the trace.
        """
        match attempt.decision, attempt.verdict:
            case Decision.OPEN, _:
                return None
            case _ if self.low == self.high:
                return self.low
            case Decision.HELD_TO_END, _:
                return self.kept
            case Decision.PREFIX, Verdict.PASS if self.low >= 0:
                return self.low
            case Decision.PREFIX, Verdict.FAIL if self.high <= 0:
                return self.high
            case _:
                return None


@dataclass(frozen=True, slots=True)
class Measured(Figure):
    """The robustness of one attempt, or at one position.

    Attributes:
        requirement: its id.
        number: the number of the attempt; `None` for the robustness at a position (a stream).
        t: the instant of the trigger, or of the position, ticks.
        robustness: the bounds.
        in_doubt: whether the attempt is in doubt.
    """

    requirement: str
    number: int | None
    t: int
    robustness: Robustness = field()
    in_doubt: bool = False


FIGURES = Measured, Robustness
"""The types of the records that the core fills with figures."""


class Stream(Sequence[tuple[int, Robustness]]):
    """A sequence of figures held as arrays; each object is made on access.

    Args:
        pieces: the sequence in pieces, each the arrays `times`, `low`, `high` and `kept`.
    """

    def __init__(self, pieces: Sequence[Sequence[Any]]) -> None:
        self._pieces = pieces
        self._length = sum(len(piece[0]) for piece in pieces)

    @cached_property
    def times(self) -> Any:
        """int64[n] ticks."""
        return self._joined(0)

    @cached_property
    def low(self) -> Any:
        """float64[n], as in `Robustness`."""
        return self._joined(1)

    @cached_property
    def high(self) -> Any:
        """float64[n], as in `Robustness`."""
        return self._joined(2)

    @cached_property
    def kept(self) -> Any:
        """float64[n], as in `Robustness`."""
        return self._joined(3)

    def _joined(self, column: int) -> Any:
        import numpy as np

        return np.concatenate([piece[column] for piece in self._pieces])

    def __len__(self) -> int:
        return self._length

    def __iter__(self) -> Iterator[tuple[int, Robustness]]:
        for times, *bounds in self._pieces:
            figures = map(Robustness, *(one.tolist() for one in bounds))
            yield from zip(times.tolist(), figures, strict=True)

    @overload
    def __getitem__(self, place: int) -> tuple[int, Robustness]: ...

    @overload
    def __getitem__(self, place: slice) -> Stream: ...

    def __getitem__(self, place: int | slice) -> tuple[int, Robustness] | Stream:
        columns = [column[place] for column in (self.times, self.low, self.high, self.kept)]
        if isinstance(place, slice):
            return Stream([columns])
        t, *figures = (column.item() for column in columns)
        return t, Robustness(*figures)


Key = tuple[str, int]
"""Requirement and number of an attempt."""


class Margins(Struct, frozen=True):
    """The robustness of all attempts of a run.

    Attributes:
        attempts: by requirement and number of the attempt.
        doubtful: the same for attempts in doubt that have a record.
        streams: by requirement, its robustness at the instants of samples. Requirements with `let`
            or `for each` have no stream, as it would depend on the attempt.
    """

    attempts: Mapping[Key, Robustness]
    doubtful: Mapping[Key, Robustness]
    streams: Mapping[str, Sequence[tuple[int, Robustness]]]

    def of(self, attempt: Attempt) -> Attempt:
        """An attempt with its robustness set."""
        figures = self.doubtful if attempt.in_doubt else self.attempts
        figure = figures.get((attempt.requirement, attempt.number))
        return attempt if figure is None else measured_attempt(attempt, figure.of(attempt))


class RobustnessMonitor(FedMonitor[Measured]):
    """Measures robustness online; made by `Spec.robustness_monitor`.

    Each call returns the figures that became final. A sample that exceeds `max delay` is refused;
    late input does not change figures already returned.

    Args:
        compiled: the specification.
        only: ids of the requirements; `None`: all.
        settle: `now` or `next`, as for a monitor.
        sources: the names that can arrive; `None`: all.
        streams: whether to measure every position besides the attempts.

    Raises:
        UnknownNameError: `settle` is neither `now` nor `next`.
    """

    def __init__(
        self,
        compiled: CompiledSpec,
        only: Sequence[str] | None = None,
        settle: str = "now",
        sources: frozenset[str] | None = None,
        *,
        streams: bool = False,
    ) -> None:
        checked = compiled.checked
        self._planned = planned_core(compiled, only, measured=True)
        absent = frozenset() if sources is None else frozenset(self._planned.numbers) - sources
        self._core = self._planned.monitor(absent, self._take_at, self._take)
        self._feed = Feed(checked, self._planned, self._core, sources, settle)
        self._core.measure(FIGURES, streams)
        self._one_call = OneCall(self._core)
        self._is_over = False
        self._attend()

    def _attend(self) -> None:
        """Bind `step` to the core, unless the feed holds samples."""
        core: Any = self._core  # after `measure`, its steps return figures
        if self._feed.is_direct:
            self.step, self.step_ns = core.step, core.step_ns
        else:
            self.step, self.step_ns = self._take_at, self._take

    def _take(self, t_ns: int, values: Mapping[str, Any]) -> Sequence[Measured]:
        """Take a sample that the core handed back."""
        return self._tell(lambda: self._step(t_ns, values))

    def _tell(self, tell: Callable[[], None]) -> Sequence[Measured]:
        """Run `tell` exclusively; returns the figures that became final."""
        return self._one_call(self._settled, tell)

    def _settled(self, tell: Callable[[], None]) -> Sequence[Measured]:
        tell()
        self._attend()
        return self._core.figures()

    def _step(self, t_ns: int, values: Mapping[str, Any]) -> None:
        t_ns = self._checked_time(t_ns)
        self._feed.take(t_ns, self._feed.check(t_ns, values))

    @property
    def open(self) -> Sequence[Measured]:
        """The current bounds on the figures of open attempts; they only tighten."""
        return self._one_call(self._core.open_figures)

    def finish(self, t: float | None = None) -> Sequence[Measured]:
        """End the run at `t` seconds, if that is later than everything so far; see `finish_ns`."""
        return self.finish_ns(None if t is None else ticks_of_seconds(t))

    def finish_ns(self, t_ns: int | None = None) -> Sequence[Measured]:
        """End the run, at `t_ns` if that is later than everything so far.

        Returns:
            The remaining figures; nothing on a second call.
        """
        return self._one_call(self._finish, t_ns)

    def _finish(self, t_ns: int | None) -> Sequence[Measured]:
        if self._is_over:
            return ()
        if t_ns is not None:
            t_ns = whole_ticks(t_ns)
        self._feed.close(t_ns)
        self._core.finish(t_ns)
        self._is_over = True
        return self._core.figures()

    def _checked_time(self, t: int) -> int:
        """See `FedMonitor`."""
        if self._is_over:
            raise TraceError("the run is finished: make a monitor for the next")
        return whole_ticks(t)
