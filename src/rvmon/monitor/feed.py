"""What every monitor can be told: samples in order of time, that time passes, what was lost."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Generic, TypeVar

from rvmon import native
from rvmon.errors import SnapshotError, TraceError
from rvmon.monitor.health import Losses, of_intake
from rvmon.monitor.intake import Intake, Turn, Validator, refuse_earlier
from rvmon.monitor.planned import PlannedCore
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.trace.sample import Health, Sample, Value
from rvmon.trace.time import ticks_of_seconds


class Feed:
    """Checks samples, holds back those that cannot be judged yet, and has the core judge them."""

    def __init__(
        self,
        checked: CheckedSpec,
        planned: PlannedCore,
        core: native.Monitor,
        sources: frozenset[str] | None,
        settle: str,
    ) -> None:
        delay = checked.max_delay or 0
        self._intake = Intake(delay, checked.events) if delay or settle == "next" else None
        self.losses = Losses(checked, planned, core, self._intake)
        self._planned = planned
        self._core = core
        self.check = Validator(checked, sources, planned.single_payloads).check

    @property
    def is_direct(self) -> bool:
        """Whether the core may take the next sample itself, as there is no more to do with it."""
        return self._intake is None and not self.losses.awaits_sample

    def is_too_late(self, t: int) -> bool:
        """Whether a sample at an instant comes later than it may be late."""
        return self._intake is not None and self._intake.is_too_late(t)

    def take(self, t: int, values: Mapping[str, Value]) -> None:
        """Take a sample, at ticks.

        Raises:
            TimeOrderError: it comes behind what was judged; nothing changed.
        """
        if self._intake is None:
            _, last, reached = self._core.times()
            refuse_earlier(t, last, reached)
        if self.losses.awaits_sample:
            self._turn(self.losses.end_missed(t))
        if self._intake is None:
            self._judge(t, values)
        else:
            self._judge_all(self._intake.take(t, values))
            self._core.advance(self._intake.floor)

    def advance(self, t: int) -> None:
        """Learn that no sample before an instant will come."""
        if self._intake is not None:
            self._judge_all(self._intake.settle(t))
        self._core.advance(t)

    def close(self) -> None:
        """Learn that no sample will come."""
        if self._intake is not None:
            self._judge_all(self._intake.close())

    def lose(self, names: Iterable[str] | None, since: int, until: int | None, why: str) -> None:
        """Have names lost; see `rvmon.monitor.feed.FedMonitor.lose_ns`."""
        self._turn(self.losses.lose(names, since, until, why))

    def find(self, names: Iterable[str] | None, at: int) -> None:
        """Have them lost no more behind an instant."""
        self._turn(self.losses.find(names, at))

    def miss(self, names: Iterable[str] | None, why: str) -> None:
        """Have them lost between the last sample and the next."""
        _, last, _ = self._core.times()
        since = last if self._intake is None else self._intake.newest
        self._turn(self.losses.miss(names, since, why))

    def _turn(self, turns: Sequence[Turn]) -> None:
        """Have names lost or found now, or when what is held back is judged so far."""
        if self._intake is None:
            self._judge_all(turns)
        else:
            self._intake.turn(turns)

    def _judge_all(self, settled: Sequence[Sample | Turn]) -> None:
        for one in settled:
            if isinstance(one, Turn):
                self.losses.turn(one)
            else:
                self._judge(one.t, one.values)

    def _judge(self, t: int, values: Mapping[str, Value]) -> None:
        if not self._core.judge(t, self._planned.plain(t, values), True):
            raise ValueError("the core does not take a sample that was checked")

    def health(self) -> list[Health]:
        """What was found of samples on their way, and what was lost."""
        held = [] if self._intake is None else of_intake(self._intake)
        return [*held, *self.losses.health()]

    def state(self) -> Mapping[str, Any]:
        """What is held back and lost, as JSON has it."""
        held = None if self._intake is None else self._intake.state()
        return {"intake": held, "losses": self.losses.state()}

    def take_up(self, state: Mapping[str, Any]) -> None:
        """Go on from what `state` gave.

        Raises:
            SnapshotError: it fits no such run.
        """
        intake = state["intake"]
        if (intake is None) != (self._intake is None):
            raise SnapshotError("the snapshot is damaged: it holds samples back that nobody awaits")
        if self._intake is not None:
            self._intake.take_up(intake, self.check, self.losses.known)
        self.losses.take_up(state["losses"])


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
            decided, of more than 4,096 attempts a sequence that makes each as it is read. The
            values are what was updated or occurred: signals by value, `None` or NaN if it became
            unknown; events `True`, or their payload. It raises `TimeOrderError` if the
            time is not later, or an `advance` ruled it out; `TraceError` for a name or a value that
            the specification does not know, or a time that is no whole number; `OverlapError` if
            another call is under way. In all cases the monitor is as it was.
    """

    step: Callable[[float, Mapping[str, Any]], Sequence[T]]
    step_ns: Callable[[int, Mapping[str, Any]], Sequence[T]]
    _feed: Feed

    @abstractmethod
    def _tell(self, tell: Callable[[], None]) -> Sequence[T]:
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
        return self._tell(lambda: self._feed.advance(self._taken_time(t_ns)))

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

        def lose() -> None:
            end = None if until_ns is None else self._taken_time(until_ns)
            self._feed.lose(names, self._taken_time(since_ns), end, why)

        return self._tell(lose)

    def found(self, names: Iterable[str] | None, at: float) -> Sequence[T]:
        """Say that `at` (seconds) is the last instant at which names are lost; see `found_ns`."""
        return self.found_ns(names, ticks_of_seconds(at))

    def found_ns(self, names: Iterable[str] | None, at_ns: int) -> Sequence[T]:
        """Say that `at_ns` is the last instant at which names are lost; otherwise as `lose_ns`.

        Those that are not lost stay as they are.
        """
        return self._tell(lambda: self._feed.find(names, self._taken_time(at_ns)))

    def miss(self, names: Iterable[str] | None = None, *, why: str = "lost") -> Sequence[T]:
        """Say that something was lost between the last sample and the next one.

        It is `lose_ns` from the one to the other, for what arrives damaged and without a stamp.
        Before the first sample nobody knows since when: no requirement is `P` or `NT` then.

        Args:
            names: signals and events that it may have spoken of; `None`: all.
            why: a phrase for people, for the input health: the same for all losses of one kind.
        """

        def miss() -> None:
            self._taken_time(0)
            self._feed.miss(names, why)

        return self._tell(miss)

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
        self._tell(lambda: self._feed.losses.come_late(names, self._taken_time(t_ns), why))
