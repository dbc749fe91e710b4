"""The online monitor of a specification."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, NoReturn

from rvmon.errors import RvmonError, SnapshotError, TraceError
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.inputs.health import HealthLog
from rvmon.monitor.inputs.intake import Intake
from rvmon.monitor.inputs.order import refuse_earlier
from rvmon.monitor.inputs.validate import Validator
from rvmon.monitor.online.evaluators import Evaluators
from rvmon.monitor.online.listeners import Callback, Listeners
from rvmon.monitor.online.one_call import OneCall
from rvmon.monitor.online.options import Options
from rvmon.monitor.online.owed import owed_now
from rvmon.monitor.online.retention import Kept
from rvmon.monitor.online.snapshot import put_back, snapshot
from rvmon.monitor.online.torn import capped, not_passed
from rvmon.monitor.records.ledger import Ledger
from rvmon.runtime.values import NEVER
from rvmon.spec.checked.specification import TimeModel
from rvmon.trace.sample import Sample, Value
from rvmon.trace.time import ticks_of_seconds, whole_ticks
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.report import Report, report_of
from rvmon.verdict.verdict import Verdict

Step = Callable[[int, Mapping[str, Any]], Sequence[Attempt]]


class Monitor:
    """Judges a stream of samples; made by `rvmon.monitor.build`.

    Times are seconds in `step`, `advance` and `finish`, integer ticks of a nanosecond in the
    methods that end in `_ns`.

    Attributes:
        judged_by: the engines that judge its requirements, as its report says them.
        step: a function that takes one sample: its time in seconds, and values by name; otherwise
            as `step_ns`.
        step_ns: the same at ticks, later than all samples before; it returns the attempts that the
            sample decided. The values are what was updated or occurred: signals by value, `None` or
            NaN if it became unknown; events `True`, or their payload. It raises `TimeOrderError` if
            the time is not later, or an `advance` ruled it out; `TraceError` for a
            name or a value that the specification does not know, or a time that is no whole number;
            `OverlapError` if another call is under way. In all cases the monitor is as it was.
            Where a monitor runs generated code, this is a function of it.
    """

    step: Callable[[float, Mapping[str, Any]], Sequence[Attempt]]
    step_ns: Step

    STATE: tuple[str, ...] = (
        *("_ledger", "_kept", "_evaluators"),
        *("_intake", "_health", "_last", "_reached", "_torn"),
    )

    judged_by = ""

    def __init__(
        self,
        compiled: CompiledSpec,
        requirements: Sequence[CompiledRequirement],
        engine: str,
        settle: str,
        sources: frozenset[str] | None,
        keep: int | None,
    ) -> None:
        self.options = Options(compiled, requirements, engine, settle, sources, keep)
        single = frozenset().union(*(one.single_payloads for one in requirements))
        self._validator = Validator(compiled.checked, sources, single)
        self._listeners = Listeners()
        self.one_call = OneCall(self)
        self.step, self.step_ns = self._take_at, self._take
        self._begin()

    def _enter(self) -> None:
        """Begin a call: learn what was done without one."""

    def _leave(self) -> None:
        """End a call."""

    def reset(self) -> None:
        """Forget the run; the next sample starts another. Callbacks stay."""
        self.one_call(self._begin)

    def _begin(self) -> None:
        self._ledger = Ledger()
        self._evaluators = self._make_evaluators()
        self._kept = Kept(self._ledger, self.options.keep)
        delay = self.options.compiled.checked.max_delay or 0
        holds_back = delay or self.options.settle == "next"
        self._intake = Intake(delay, self.options.compiled.checked.events) if holds_back else None
        self._health = HealthLog()
        self._last: int | None = None
        self._reached: int | None = None
        self._report: Report | None = None
        self._torn: int | None = None
        self._attend()

    def _attend(self) -> None:
        """Have what is decided heard of, if it is to be reported or bounded."""

    def _make_evaluators(self) -> Evaluators:
        return Evaluators(
            self.options.compiled.checked,
            self.options.requirements,
            self.options.engine,
            self.options.sources,
            self._ledger,
        )

    def _take_at(self, t: float, values: Mapping[str, Any]) -> Sequence[Attempt]:
        """Take a sample at seconds."""
        if type(values) is not dict and not isinstance(values, Mapping):
            raise TraceError(f"sample at {t} s: expected values by name, found {values!r}")
        return self.step_ns(ticks_of_seconds(t), values)

    def _take(self, t_ns: int, values: Mapping[str, Any]) -> Sequence[Attempt]:
        """Take a sample by the way of every monitor."""
        decided = self.one_call(self._step, t_ns, values)
        self._listeners.call(decided)
        return decided

    def _step(self, t_ns: int, values: Mapping[str, Any]) -> Sequence[Attempt]:
        t_ns = self._taken_time(t_ns)
        if self._intake is not None:
            checked = self.one_call.spare(self._validator.check, t_ns, values)
            ready = self._intake.take(t_ns, checked)
            return self._settled(ready, self._intake.floor)
        refuse_earlier(t_ns, self._last, self._reached)
        self._judge(t_ns, self.one_call.spare(self._validator.check, t_ns, values))
        return self._flush()

    def _flush(self) -> Sequence[Attempt]:
        """What was decided since the last call."""
        decided = self._ledger.flush()
        self._kept.bound(self._evaluators)
        return decided

    def on_decided(self, callback: Callback) -> Callable[[], None]:
        r"""Have a function called with each attempt that passes or fails, as it is decided.

        `step`, `advance` and `finish` call it when all their records are made, in the order in
        which they return them, in the thread that called them; it may look at the monitor. An
        attempt that ends undecided is only in the report. What a callback raises comes out of
        that call when all callbacks were called for all attempts (several errors as an
        `ExceptionGroup`); the sample was taken nevertheless. Callbacks stay over `reset`, and are
        no part of snapshots: register them again after `Spec.restore`.

        Args:
            callback: takes an attempt.

        Returns:
            A function without arguments that ends this; to call it again does nothing.

        Raises:
            RvmonError: it cannot be called.

        >>> from rvmon import loads
        >>> spec = loads("spec s\nsignal x : real\nrequirement R1\n  always x <= 3\n")
        >>> monitor = spec.monitor()
        >>> stop = monitor.on_decided(lambda attempt: print(attempt.name, attempt.verdict.name))
        >>> for t, x in enumerate([1, 4, 2]):
        ...     _ = monitor.step(t, {"x": x})
        R1#1 FAIL
        >>> _ = monitor.finish(5)
        R1#2 PASS
        >>> stop()
        """
        return self._listeners.add(callback, self._attend, failures_only=False)

    def on_failure(self, callback: Callback) -> Callable[[], None]:
        """Have a function called with each attempt that fails; otherwise as `on_decided`."""
        return self._listeners.add(callback, self._attend, failures_only=True)

    def _judge(self, t: int, values: Mapping[str, Value]) -> None:
        self._evaluators.through(t - 1)
        try:
            self._evaluators.instances.admit(t, values)
        except TraceError:
            self._pass_to(t)
            raise
        self._health.note(t, values)
        self._evaluators.sample(t, values)
        self._last = self._reached = t

    def _settled(self, samples: Sequence[Sample], floor: int) -> Sequence[Attempt]:
        """Judge samples that were held back, then let time come to `floor`."""
        for sample in samples:
            self._judge(sample.t, sample.values)
        self._pass_to(floor)
        return self._flush()

    def advance(self, t: float) -> Sequence[Attempt]:
        """Say that no sample before `t` (seconds) will come; see `advance_ns`."""
        return self.advance_ns(ticks_of_seconds(t))

    def advance_ns(self, t_ns: int) -> Sequence[Attempt]:
        """Say that no sample before `t_ns` will come, and return the attempts that this decided.

        A sample at `t_ns` stays legal. An instant that time has come to already changes nothing.
        """
        decided = self.one_call(self._advance, t_ns)
        self._listeners.call(decided)
        return decided

    def _advance(self, t_ns: int) -> Sequence[Attempt]:
        t_ns = self._taken_time(t_ns)
        held_back = () if self._intake is None else self._intake.settle(t_ns)
        return self._settled(held_back, t_ns)

    def _pass_to(self, t: int) -> None:
        if self._reached is None or t > self._reached:
            self._evaluators.through(t - 1)
            self._evaluators.reach(t)
            self._reached = t

    def _taken_time(self, t: int) -> int:
        """A time that was given, as a plain integer."""
        if self._report is not None:
            raise TraceError("the run is finished: call reset() before the next")
        return whole_ticks(t)

    def finish(self, t: float | None = None) -> Report:
        """End the run, at `t` seconds if that is later than all so far; see `finish_ns`."""
        return self.finish_ns(None if t is None else ticks_of_seconds(t))

    def finish_ns(self, t_ns: int | None = None) -> Report:
        """End the run and judge it.

        Args:
            t_ns: the end of the trace in ticks, if it is later than all so far.

        Returns:
            The report; the same again if the run was finished before.
        """
        report, decided = self.one_call(self._finish, t_ns)
        self._listeners.call(decided)
        return report

    def _finish(self, t_ns: int | None) -> tuple[Report, Sequence[Attempt]]:
        if self._report is not None:
            return self._report, ()
        if t_ns is not None:
            t_ns = self._taken_time(t_ns)
        for sample in () if self._intake is None else self._intake.close():
            self._judge(sample.t, sample.values)
        report, decided = self._conclude(t_ns)
        if self._torn is not None:
            report = capped(report, self._torn)
        self._report = replace(report, engine=self.judged_by)
        return self._report, decided

    def _conclude(self, t_ns: int | None) -> tuple[Report, Sequence[Attempt]]:
        """Judge the run that ends, all samples of which were taken; also what this decided."""
        end = self._end(t_ns)
        if end is not None:
            reached = end if self._reached is None else max(end, self._reached)
            self._evaluators.through(end)
            self._evaluators.finish(end, reached)
        decided = self._ledger.close()
        self._kept.trim()
        report = report_of(
            self._names,
            self._ledger.attempts,
            dropped=self._kept.dropped,
            incomplete=self._evaluators.undetermined(),
            health=self._health.report(
                self.options.requirements, self._evaluators.arrivals, self._intake
            ),
            origin=self._health.began or 0,
            end=end,
        )
        return report, decided

    @property
    def _names(self) -> list[str]:
        return [compiled.requirement.id for compiled in self.options.requirements]

    @property
    def verdicts(self) -> Mapping[str, Verdict]:
        r"""The verdict of each requirement so far: the fold of the attempts decided by now.

        `F` if an attempt has failed, else `P` if one has passed, else `NT`. What is undecided does
        not count, so that this is not what `finish` would say: it may call a run `I` or `F` that
        is `P` or `NT` so far. An `F` stays. Once the run is finished these are the report's. After
        a call that an interrupt tore, what has not failed is `I`.
        A call costs what was decided since the last one.

        >>> from rvmon import loads
        >>> spec = loads("spec s\nsignal x : real\nrequirement R1\n  always x <= 3\n")
        >>> monitor = spec.monitor()
        >>> for t, x in enumerate([1, 4, 2]):
        ...     _ = monitor.step(t, {"x": x})
        ...     print(monitor.verdicts["R1"])
        NT
        F
        F
        """
        return self.one_call(self._verdicts)

    def _verdicts(self) -> Mapping[str, Verdict]:
        if self._report is not None:
            return self._report.verdicts
        found = self._verdicts_so_far()
        return found if self._torn is None else not_passed(found)

    def _verdicts_so_far(self) -> Mapping[str, Verdict]:
        """What was decided by now; the core counts its own."""
        return self._kept.verdicts(self._names)

    def _end(self, t: int | None) -> int | None:
        """The last instant of the trace; `None` if there was no sample."""
        if self._last is None:
            return None
        known = [self._last]
        if t is not None:
            known.append(t)
        is_sampled = self.options.compiled.checked.time is TimeModel.SAMPLED
        if self._reached is not None and not is_sampled:
            known.append(self._reached - 1)
        return max(known)

    @property
    def evaluators(self) -> Evaluators:
        """What judges the run."""
        return self._evaluators

    def snapshot(self) -> bytes:
        """The run as bytes, from which `Spec.restore` makes a monitor that goes on alike.

        It holds the open attempts, held values, samples held back and all records so far, and no
        code; another specification or version refuses it.

        Raises:
            SnapshotError: the run is finished.
        """
        return self.one_call(self._put_away)

    def __reduce__(self) -> NoReturn:
        """Refused: pickles and copies would share or lack what is under way.

        Raises:
            RvmonError: always; it says what to do.
        """
        raise RvmonError(
            "a monitor is neither pickled nor copied: monitor.snapshot() gives the run as bytes, "
            "and spec.restore(data) makes a monitor of them, in this process or another"
        )

    def _put_away(self) -> bytes:
        if self._report is not None:
            raise SnapshotError("the run is finished: keep its report, or call reset()")
        if self._torn is not None:
            self._flush()  # what the torn call has decided is not lost
        return self._written()

    def _written(self) -> bytes:
        """The run as bytes; nothing that it decided is still to be given out."""
        self._kept.tidy(self._evaluators)
        return snapshot(self.options, self._evaluators, self)

    def take_up(self, document: Mapping[str, Any]) -> None:
        """Go on as the run of a snapshot; this monitor was just made as that was.

        Args:
            document: from `rvmon.monitor.online.snapshot.document_of`.

        Raises:
            SnapshotError: it fits no such monitor, as far as that can be seen.
        """
        put_back(document, self.options, self._evaluators, self)

    @property
    def open(self) -> Sequence[Attempt]:
        """The attempts that are undecided now."""
        return self.owed()[1]

    def owed(self, most: int | None = None) -> tuple[Mapping[str, int], Sequence[Attempt]]:
        """How many attempts of each requirement are open, and `open` or the oldest of it."""
        return self.one_call(self._owed, most)

    def _owed(self, most: int | None) -> tuple[Mapping[str, int], Sequence[Attempt]]:
        if self._reached is None:
            return {}, []
        known = self._reached == self._last
        self._evaluators.take_along(self._reached - (not known))
        return owed_now(self._evaluators, self._ledger, 2 * self._reached + known, most)

    @property
    def next_due(self) -> int | None:
        """The next instant (ticks) at which time alone can decide something."""
        return self.one_call(self._next_due)

    def _next_due(self) -> int | None:
        if self._reached is None or self._report is not None:
            return None
        found = min(evaluator.next_decision for evaluator in self._evaluators.all)
        return max(found, self._reached + 1) if found < NEVER else None
