"""What every monitor can be told: samples, that time passes, what was lost."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Generic, ParamSpec, TypeVar

from rvmon.errors import TraceError
from rvmon.monitor.core.feed import Feed
from rvmon.trace.time import ticks_of_seconds

P = ParamSpec("P")
T = TypeVar("T")
"""What is decided or settled by a call: attempts, figures."""


class FedMonitor(ABC, Generic[T]):
    """A monitor that is fed a stream of samples.

    Times are seconds in `step`, `advance` and so on, integer ticks of a nanosecond in the methods
    that end in `_ns`.

    Attributes:
        step: a function that takes one sample: its time in seconds, and values by name; otherwise
            as `step_ns`.
        step_ns: the same at ticks, later than all samples before; it returns what the sample
            decided. The values are what was updated or occurred: signals by value, `None` or NaN if
            it became unknown; events `True`, or their payload. It raises `TimeOrderError` if the
            time is not later, or an `advance` ruled it out; `TraceError` for a name or a value that
            the specification does not know, or a time that is no whole number; `OverlapError` if
            another call is under way. In all cases the monitor is as it was.
    """

    step: Callable[[float, Mapping[str, Any]], Sequence[T]]
    step_ns: Callable[[int, Mapping[str, Any]], Sequence[T]]
    _feed: Feed

    @abstractmethod
    def _tell(self, tell: Callable[P, None], *args: P.args, **kwargs: P.kwargs) -> Sequence[T]:
        """Make a call, and no other until it is over; what it decided."""

    @abstractmethod
    def _taken_time(self, t: int) -> int:
        """A time that was given, as a plain integer; it raises if the run is finished."""

    def _take_at(self, t: float, values: Mapping[str, Any]) -> Sequence[T]:
        """Take a sample at seconds."""
        if type(values) is not dict and not isinstance(values, Mapping):
            raise TraceError(f"sample at {t} s: expected values by name, found {values!r}")
        return self.step_ns(ticks_of_seconds(t), values)

    def advance(self, t: float) -> Sequence[T]:
        """Say that no sample before `t` (seconds) will come; see `advance_ns`."""
        return self.advance_ns(ticks_of_seconds(t))

    def advance_ns(self, t_ns: int) -> Sequence[T]:
        """Say that no sample before `t_ns` will come, and return what this decided.

        A sample at `t_ns` stays legal. An instant that time has come to already changes nothing.
        """
        return self._tell(self._advance, t_ns)

    def _advance(self, t: int) -> None:
        self._feed.advance(self._taken_time(t))

    def lose(
        self,
        names: Iterable[str] | None,
        since: float,
        until: float | None = None,
        *,
        why: str = "lost",
    ) -> Sequence[T]:
        """Say that names are lost from `since` on (seconds); see `lose_ns`."""
        end = None if until is None else ticks_of_seconds(until)
        return self.lose_ns(names, ticks_of_seconds(since), end, why=why)

    def lose_ns(
        self,
        names: Iterable[str] | None,
        since_ns: int,
        until_ns: int | None = None,
        *,
        why: str = "lost",
    ) -> Sequence[T]:
        r"""Say that a source may have said anything of some names, and nobody heard it.

        From `since_ns` on these signals and events are unknown, whatever samples say of them: an
        event up to the last instant at which it is lost, a signal up to its first update then or
        later. Under `max delay D` the stretch is wider by D on both sides. What was judged already
        stands; the requirements that read one of the names are not `P` or `NT` any more then.

        Args:
            names: signals and events; `None`: all.
            since_ns: the first instant at which they are lost, ticks.
            until_ns: the last one, to which time has come then; `None`: when `found_ns` says so.
            why: a phrase for people, for the input health: the same for all losses of one kind.

        Returns:
            What this decided.

        Raises:
            UnknownNameError: there is no such signal or event; nothing changed.

        Source: SEMANTICS, sections 1 (Outage) and 6 (Too late).

        >>> from rvmon import loads
        >>> spec = loads("spec s\nevent stop\nrequirement R\n  always not stop\n")
        >>> monitor = spec.monitor()
        >>> _ = monitor.step(0, {"stop": False})
        >>> _ = monitor.lose(["stop"], since=1, until=3, why="the connection was down")
        >>> report = monitor.finish(9)
        >>> print(report.verdicts["R"], report.health[0].remark)
        I the connection was down
        """
        return self._tell(self._lose, names, since_ns, until_ns, why)

    def _lose(self, names: Iterable[str] | None, since: int, until: int | None, why: str) -> None:
        end = None if until is None else self._taken_time(until)
        self._feed.lose(names, self._taken_time(since), end, why)

    def found(self, names: Iterable[str] | None, at: float) -> Sequence[T]:
        """Say that `at` (seconds) is the last instant at which names are lost; see `found_ns`."""
        return self.found_ns(names, ticks_of_seconds(at))

    def found_ns(self, names: Iterable[str] | None, at_ns: int) -> Sequence[T]:
        """Say that `at_ns` is the last instant at which names are lost; otherwise as `lose_ns`.

        Those that are not lost stay as they are.
        """
        return self._tell(self._find, names, at_ns)

    def _find(self, names: Iterable[str] | None, at: int) -> None:
        self._feed.find(names, self._taken_time(at))

    def miss(self, names: Iterable[str] | None = None, *, why: str = "lost") -> Sequence[T]:
        """Say that something was lost between the last sample and the next one.

        It is `lose_ns` from the one to the other, for what arrives damaged and without a stamp.
        Before the first sample nobody knows since when: no requirement is `P` or `NT` then.

        Args:
            names: signals and events that it may have spoken of; `None`: all.
            why: a phrase for people, for the input health: the same for all losses of one kind.
        """
        return self._tell(self._miss, names, why)

    def _miss(self, names: Iterable[str] | None, why: str) -> None:
        self._taken_time(0)
        self._feed.miss(names, why)

    def late(self, names: Iterable[str] | None, t: float, *, why: str = "left out") -> None:
        """Say that a sample at `t` (seconds) came too late; see `late_ns`."""
        self.late_ns(names, ticks_of_seconds(t), why=why)

    def late_ns(self, names: Iterable[str] | None, t_ns: int, *, why: str = "left out") -> None:
        """Say that a sample came behind what has been judged, so that it is not judged.

        The requirements that read one of the names are not `P` or `NT` any more in this run;
        records stay as they were given, and what fails, fails. Under `max delay` the monitor finds
        by itself what is later than that.

        Args:
            names: of the sample; `None`: it cannot be read.
            t_ns: its instant, ticks.
            why: a phrase for people, for the input health: the same for all losses of one kind.

        Raises:
            UnknownNameError: there is no such signal or event; nothing changed.

        Source: SEMANTICS, section 6 (Too late).
        """
        self._tell(self._late, names, t_ns, why)

    def _late(self, names: Iterable[str] | None, t: int, why: str) -> None:
        self._feed.losses.come_late(names, self._taken_time(t), why)
