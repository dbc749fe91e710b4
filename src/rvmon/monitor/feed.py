"""The input side of every monitor: samples in order of time, the passing of time, and outages."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Generic, TypeVar

from rvmon import native
from rvmon.errors import SnapshotError, TraceError, UnknownNameError
from rvmon.language.checked.specification import CheckedSpec
from rvmon.monitor.health import Losses, of_intake
from rvmon.monitor.intake import Intake, Turn, Validator, refuse_earlier
from rvmon.monitor.packed_plan import PlannedCore
from rvmon.trace.sample import Health, Sample, Value
from rvmon.trace.time import ticks_of_seconds


def refuse_settle(settle: str) -> None:
    """Check the option `settle`, which says when a sample is complete.

    Raises:
        UnknownNameError: `settle` is neither `now` nor `next`.
    """
    if settle not in ("now", "next"):
        raise UnknownNameError(f"settle={settle!r}: expected 'now' or 'next'")


class Feed:
    """Validates samples, holds back the incomplete ones, and passes the others to the core.

    Raises:
        UnknownNameError: `settle`, which says when a sample is complete, is neither `now` nor
            `next`.
    """

    def __init__(
        self,
        checked: CheckedSpec,
        planned: PlannedCore,
        core: native.Monitor,
        sources: frozenset[str] | None,
        settle: str,
    ) -> None:
        refuse_settle(settle)
        delay = checked.max_delay or 0
        self._intake = Intake(delay, checked.events) if delay or settle == "next" else None
        self.losses = Losses(checked, planned, core, self._intake)
        self._planned = planned
        self._core = core
        self._validator = Validator(checked, sources, planned.single_payloads)

    @property
    def is_direct(self) -> bool:
        """Whether the core may take the next sample directly: none is held back or awaited."""
        return self._intake is None and not self.losses.awaits_sample

    def is_too_late(self, t: int) -> bool:
        """Whether a sample at `t` exceeds `max delay`."""
        return self._intake is not None and self._intake.is_too_late(t)

    def check(self, t: int, values: Mapping[str, Any]) -> Mapping[str, Value]:
        """The sample at `t` ticks as the core takes it.

        Raises:
            TraceError: it is not as declared, or has a number too large for the core.
        """
        return self._planned.plain(t, self._validator.check(t, values))

    def take(self, t: int, values: Mapping[str, Value]) -> None:
        """Take a sample at `t` ticks; `values` come from `check`.

        Raises:
            TimeOrderError: it is not later than what has been judged; nothing changed.
        """
        if self._intake is None:
            # Before anything changes: if an outage were ended for a sample that is then refused,
            # that could not be undone.
            _, last, reached = self._core.times()
            refuse_earlier(t, last, reached)
        if self.losses.awaits_sample:
            self._turn(self.losses.end_missed(t))
        if self._intake is None:
            self._judge(t, values)
        else:
            self._judge_all(self._intake.take(t, values))
            # `max delay` excludes samples before the floor, so time has passed up to there, and
            # windows may be decided although no sample came.
            self._core.advance(self._intake.floor)

    def advance(self, t: int) -> None:
        """Note that no sample before `t` (ticks) will come."""
        if self._intake is not None:
            self._judge_all(self._intake.settle(t))
        self._core.advance(t)

    def close(self, end: int | None) -> None:
        """Note that no further sample will come; the trace continues to `end` (ticks) if given."""
        _, last, reached = self._core.times()
        last = last if self._intake is None else self._intake.newest
        later = [t for t in (end, None if reached is None else reached - 1) if t is not None]
        # An outage of `miss` that nothing ends may have any length.
        if last is not None and all(t <= last for t in later):
            self.losses.miss_end(last)
        if self._intake is not None:
            self._judge_all(self._intake.close())

    def lose(self, names: Iterable[str] | None, since: int, until: int | None, why: str) -> None:
        """Start an outage, and end it if `until` is given; see `FedMonitor.lose_ns`."""
        self._turn(self.losses.lose(names, since, until, why))

    def find(self, names: Iterable[str] | None, at: int) -> None:
        """End the outage of names at `at` (ticks, inclusive)."""
        self._turn(self.losses.find(names, at))

    def miss(self, names: Iterable[str] | None, why: str) -> None:
        """Start an outage at the last sample, to end with the next one."""
        _, last, _ = self._core.times()
        since = last if self._intake is None else self._intake.newest
        self._turn(self.losses.miss(names, since, why))

    def _turn(self, turns: Sequence[Turn]) -> None:
        """Apply turns now or, if samples are held back, in order with the samples."""
        if self._intake is None:
            self._judge_all(turns)
        else:
            self._intake.turn(turns)

    def _judge_all(self, settled: Sequence[Sample | Turn]) -> None:
        for entry in settled:
            if isinstance(entry, Turn):
                self.losses.turn(entry)
            else:
                self._judge(entry.t, self._with_single_payloads(entry))

    def _with_single_payloads(self, sample: Sample) -> Mapping[str, Value]:
        """The values of a merged sample, with several payloads merged where one can be judged.

        Fields that differ between the payloads are unknown.
        """
        values = sample.values
        for name in self._planned.single_payloads.intersection(values):
            if isinstance(payloads := values[name], tuple) and len(payloads) > 1:
                shared = {
                    field: value if all(one.get(field) == value for one in payloads) else None
                    for field, value in payloads[0].items()
                }
                values = {**values, name: shared}
                if self._intake is not None and None in shared.values():
                    self._intake.conflicts.add(name, sample.t)
        return values

    def _judge(self, t: int, values: Mapping[str, Value]) -> None:
        if not self._core.judge(t, values, True):
            raise ValueError("the core refused a sample that was validated")

    def health(self) -> list[Health]:
        """The findings of intake, then those about outages and late samples."""
        held = [] if self._intake is None else of_intake(self._intake)
        return [*held, *self.losses.health()]

    def state(self) -> Mapping[str, Any]:
        """The state of intake and losses as JSON values."""
        held = None if self._intake is None else self._intake.state()
        return {"intake": held, "losses": self.losses.state()}

    def restore_state(self, state: Mapping[str, Any]) -> None:
        """Restore a state from `state`.

        Raises:
            SnapshotError: the state comes from a run with other options.
        """
        intake = state["intake"]
        if (intake is None) != (self._intake is None):
            raise SnapshotError(
                "the snapshot is damaged: it holds back samples that are not expected"
            )
        if self._intake is not None:
            self._intake.restore_state(intake, self.check, self.losses.known)
        self.losses.restore_state(state["losses"])


T = TypeVar("T")  # the result of a call: a decided attempt, or a final robustness figure


class FedMonitor(ABC, Generic[T]):
    """A monitor that is fed a stream of samples.

    Times are seconds in `step`, `advance` and so on, and integer ticks (nanoseconds) in the methods
    whose names end in `_ns`.
    """

    # Takes one sample: its time in seconds, and its values by name; otherwise like `step_ns`.
    step: Callable[[float, Mapping[str, Any]], Sequence[T]]
    # Takes one sample, stamped in ticks and later than all before, and returns what it decided;
    # more than 4,096 attempts come as a sequence that makes each on access. The values are updates
    # and occurrences: for a signal its value, or `None` or NaN if it became unknown; for an event
    # `True` or its payload. As in recordings, 0 and 1 are accepted as truth values, and 3.0 as a
    # whole number, where these are declared. Raises `TimeOrderError` if the time is not later or
    # was excluded by `advance`; `TraceError` for a name or value unknown to the specification, or a
    # time that is not a whole number; `OverlapError` if another call is in progress. In all these
    # cases the monitor is unchanged.
    step_ns: Callable[[int, Mapping[str, Any]], Sequence[T]]
    _feed: Feed

    @abstractmethod
    def _tell(self, tell: Callable[[], None]) -> Sequence[T]:
        """Run `tell` exclusively; returns what it decided."""

    @abstractmethod
    def _checked_time(self, t: int) -> int:
        """A time argument as a plain integer; raises `TraceError` if the run is finished."""

    def _take_at(self, t: float, values: Mapping[str, Any]) -> Sequence[T]:
        """Take a sample at `t` seconds."""
        if type(values) is not dict and not isinstance(values, Mapping):
            raise TraceError(f"sample at {t} s: expected values by name, found {values!r}")
        return self.step_ns(ticks_of_seconds(t), values)

    def advance(self, t: float) -> Sequence[T]:
        """State that no sample before `t` (seconds) will come; see `advance_ns`."""
        return self.advance_ns(ticks_of_seconds(t))

    def advance_ns(self, t_ns: int) -> Sequence[T]:
        """State that no sample before `t_ns` will come; returns what this decided.

        A sample at `t_ns` stays legal. An instant before the present one has no effect.
        """
        return self._tell(lambda: self._feed.advance(self._checked_time(t_ns)))

    def lose(
        self,
        names: Iterable[str] | None,
        since: float,
        until: float | None = None,
        *,
        why: str = "lost",
    ) -> Sequence[T]:
        """Report an outage of names from `since` on (seconds); see `lose_ns`."""
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
        r"""Report an outage: a stretch in which updates of some names may have been lost.

        Within it these signals and events are unknown, whatever samples arrive: an event until the
        end of the outage, a signal until its first update at or after that end. Under
        `max delay D` the outage is wider by D on both sides. Instants that have already been
        evaluated are not evaluated again, but requirements that read one of the names are no longer
        `P` or `NT`.

        Args:
            names: signals and events; `None`: all.
            since_ns: the first instant of the outage, ticks.
            until_ns: the last instant, ticks; `None`: until `found_ns` reports it.
            why: a phrase for the input health; use the same for all losses of one kind.

        Returns:
            The results that this decided.

        Raises:
            UnknownNameError: a name is not declared; nothing changed.

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
            end = None if until_ns is None else self._checked_time(until_ns)
            self._feed.lose(names, self._checked_time(since_ns), end, why)

        return self._tell(lose)

    def found(self, names: Iterable[str] | None, at: float) -> Sequence[T]:
        """Report that the outage of names ended at `at` (seconds); see `found_ns`."""
        return self.found_ns(names, ticks_of_seconds(at))

    def found_ns(self, names: Iterable[str] | None, at_ns: int) -> Sequence[T]:
        """Report that `at_ns` is the last instant of the outage of names; otherwise like `lose_ns`.

        Names without an outage are not affected.
        """
        return self._tell(lambda: self._feed.find(names, self._checked_time(at_ns)))

    def miss(self, names: Iterable[str] | None = None, *, why: str = "lost") -> Sequence[T]:
        """Report that input without a usable stamp was lost between the last sample and the next.

        This is `lose_ns` from the last sample to the next. The outage has no known start before the
        first sample, and no known end after the last sample unless time advances or `finish` names
        a later end. In both cases no requirement that reads one of the names is `P` or `NT` any
        more.

        Args:
            names: signals and events that it may have updated; `None`: all.
            why: a phrase for the input health; use the same for all losses of one kind.
        """

        def miss() -> None:
            self._checked_time(0)
            self._feed.miss(names, why)

        return self._tell(miss)

    def late(self, names: Iterable[str] | None, t: float, *, why: str = "left out") -> None:
        """Report a sample at `t` (seconds) that came too late; see `late_ns`."""
        self.late_ns(names, ticks_of_seconds(t), why=why)

    def late_ns(self, names: Iterable[str] | None, t_ns: int, *, why: str = "left out") -> None:
        """Report a sample that came after its instant had been evaluated, and was left out.

        Requirements that read one of its names are no longer `P` or `NT` in this run; records
        already given stay, and failures still count. Under `max delay` the monitor itself reports
        samples that exceed the delay.

        Args:
            names: the names of the sample; `None` if it cannot be read.
            t_ns: its instant, ticks.
            why: a phrase for the input health; use the same for all losses of one kind.

        Raises:
            UnknownNameError: a name is not declared; nothing changed.

        Source: SEMANTICS, section 6 (Too late).
        """
        self._tell(lambda: self._feed.losses.come_late(names, self._checked_time(t_ns), why))
