"""The online monitor of a specification: a run of the core, with intake, callbacks and reports."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from heapq import nsmallest
from typing import Any, NoReturn

from rvmon import native
from rvmon.errors import RvmonError, SnapshotError, TraceError
from rvmon.language.checked.names_read import requirement_ids
from rvmon.monitor.compiled_spec import CompiledSpec
from rvmon.monitor.feed import FedMonitor, Feed
from rvmon.monitor.health import health_of_run
from rvmon.monitor.listeners import Callback, Listeners, OneCall, capped, not_passed
from rvmon.monitor.packed_plan import PlannedCore, planned_core
from rvmon.monitor.snapshot import Options, document_of, restored_state, snapshot_of
from rvmon.trace.time import ticks_of_seconds, whole_ticks
from rvmon.verdicts import Verdict, fold
from rvmon.verdicts.attempt import VERDICTS, Attempt
from rvmon.verdicts.report import Report


class Monitor(FedMonitor[Attempt]):
    """Judges a stream of samples; made by `build_monitor`.

    On the fast path `step` is a method of the C object itself. It hands a sample to Python only if
    the sample is not a `dict` of plain values, or if the core refuses it.

    Args:
        planned: the plan of the requirements.
        compiled: the specification.
        options: the options of `build_monitor`.

    Attributes:
        compiled: the specification.
        options: the options of `build_monitor`.
    """

    def __init__(self, planned: PlannedCore, compiled: CompiledSpec, options: Options) -> None:
        checked, sources = compiled.checked, options.sources
        self.options = options
        self.compiled = compiled
        self._planned = planned
        declared = frozenset((*checked.signals, *checked.events))
        self._absent = frozenset() if sources is None else declared - sources
        self._core = planned.monitor(self._absent, self._take_at, self._take_refused, self._many)
        if options.keep is not None:
            self._core.keep(options.keep)
        self._listeners = Listeners()
        self._one_call = OneCall(self._core)
        self._start_run()

    @property
    def core(self) -> native.Monitor:
        """The run of the core."""
        return self._core

    def reset(self) -> None:
        """Discard the run; the next sample starts another. Callbacks stay registered."""
        self._one_call(self._start_run)

    def _start_run(self) -> None:
        checked, options = self.compiled.checked, self.options
        self._feed = Feed(checked, self._planned, self._core, options.sources, options.settle)
        self._report: Report | None = None
        self._one_call.interrupted = None
        self._core.reset()
        self._one_call.note_times()
        self._attend()

    def _attend(self) -> None:
        """Bind `step` to the core, unless callbacks are registered or the feed holds samples."""
        if self._feed.is_direct and not self._listeners:
            # The bound method of the C object itself: a wrapper in Python would take longer than
            # most steps.
            self.step, self.step_ns = self._core.step, self._core.step_ns
        else:
            self.step, self.step_ns = self._take_at, self._take

    def _take(self, t_ns: int, values: Mapping[str, Any]) -> Sequence[Attempt]:
        """Take a sample, and call the callbacks."""
        if self._feed.is_direct:
            decided = self._core.step_ns(t_ns, values)
        else:
            decided = self._one_call(self._step, t_ns, values)
        self._listeners.call(decided)
        return decided

    def _take_refused(self, t_ns: int, values: Mapping[str, Any]) -> Sequence[Attempt]:
        """Take a sample that the core handed back; the core's `step` returns the result."""
        return self._one_call(self._step, t_ns, values)

    def _many(self, raw: tuple[bytes, bytes, bytes, Any]) -> Sequence[Attempt]:
        from rvmon.monitor.records import recorded  # imports NumPy, which short runs do not need

        return recorded(self._planned, raw, self._core.times()[0] or 0)

    def _step(self, t_ns: int, values: Mapping[str, Any]) -> Sequence[Attempt]:
        t_ns = self._checked_time(t_ns)
        checked = self._one_call.unchanging(self._feed.check, t_ns, values)
        if self._feed.is_too_late(t_ns):
            self._feed.losses.come_late(checked, t_ns, "left out")
        else:
            self._feed.take(t_ns, checked)
            self._attend()
        return self._core.flush()

    def is_too_late(self, t_ns: int) -> bool:
        """Whether a sample at `t_ns` exceeds `max delay`: `step` leaves it out and reports it."""
        return self._feed.is_too_late(t_ns)

    def on_decided(self, callback: Callback) -> Callable[[], None]:
        r"""Register a callback for each attempt that passes or fails.

        `step`, `advance` and `finish` call it before they return, in the calling thread, for each
        attempt in the order in which they return them. The callback may use the monitor. An
        attempt that ends undecided appears only in the report. Exceptions from callbacks propagate
        after all callbacks have been called for all attempts (several as an `ExceptionGroup`); the
        sample has been evaluated nevertheless. Callbacks survive `reset` but are not part of
        snapshots: register them again after `Spec.restore`.

        Returns:
            A function without arguments that unregisters the callback; idempotent.

        Raises:
            RvmonError: `callback` is not callable, or a coroutine function.

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
        """Register a callback for each attempt that fails; otherwise like `on_decided`."""
        return self._listeners.add(callback, self._attend, failures_only=True)

    def _tell(self, tell: Callable[[], None]) -> Sequence[Attempt]:
        """Run `tell` exclusively, and call the callbacks with what it decided."""
        decided = self._one_call(self._decided, tell)
        self._listeners.call(decided)
        return decided

    def _decided(self, tell: Callable[[], None]) -> Sequence[Attempt]:
        tell()
        self._attend()
        return self._core.flush()

    def _checked_time(self, t: int) -> int:
        """A time argument as a plain integer.

        Raises:
            TraceError: the run is finished, or the time is not a whole number.
        """
        if self._report is not None:
            raise TraceError("the run is finished: call reset() before the next")
        return whole_ticks(t)

    def finish(self, t: float | None = None) -> Report:
        """End the run at `t` seconds, if that is later than everything so far; see `finish_ns`."""
        return self.finish_ns(None if t is None else ticks_of_seconds(t))

    def finish_ns(self, t_ns: int | None = None) -> Report:
        """End the run and judge it.

        Args:
            t_ns: the end of the trace in ticks, if that is later than everything so far.

        Returns:
            The report; a second call returns the same.
        """
        report, decided = self._one_call(self._finish, t_ns)
        self._listeners.call(decided)
        return report

    def _finish(self, t_ns: int | None) -> tuple[Report, Sequence[Attempt]]:
        if self._report is not None:
            return self._report, ()
        if t_ns is not None:
            t_ns = self._checked_time(t_ns)
        self._feed.close(t_ns)
        end = self._core.finish(t_ns)
        decided = self._core.flush()
        self._one_call.note_times()
        report, interrupted = self._reported(end), self._one_call.interrupted
        self._report = report if interrupted is None else capped(report, interrupted)
        return self._report, decided

    def _reported(self, end: int | None) -> Report:
        """The report of the finished run."""
        from rvmon.monitor.records import report_of_run  # imports NumPy, which steps do not need

        report = report_of_run(self._planned, self._core, self._one_call.began or 0, end)
        health = health_of_run(self._planned, self._core, self._absent, self._feed.health())
        return replace(report, health=health)

    @property
    def verdicts(self) -> Mapping[str, Verdict]:
        r"""The verdict of each requirement so far: the fold of the attempts decided by now.

        `F` if an attempt has failed, else `P` if one has passed, else `NT`. Undecided attempts do
        not count, so `finish` may turn a `P` or `NT` into `I` or `F`; an `F` is final. After
        `finish` these are the verdicts of the report. After a call was interrupted, every
        requirement that has not failed is `I`.
        Cost: linear in the attempts decided since the previous call.

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
        return self._one_call(self._verdicts)

    def _verdicts(self) -> Mapping[str, Verdict]:
        if self._report is not None:
            return self._report.verdicts
        so_far = (Verdict.FAIL, Verdict.PASS)
        verdicts = {}
        for name, (*counts, determined) in zip(
            self._planned.packed.ids, self._core.counts(), strict=True
        ):
            seen = [verdict for verdict in so_far if counts[VERDICTS.index(verdict)]]
            # A requirement that passed was triggered; then only late input leaves it undetermined.
            verdicts[name] = fold(seen, complete=bool(determined or not seen))
        return verdicts if self._one_call.interrupted is None else not_passed(verdicts)

    def snapshot(self) -> bytes:
        """The state of the run as bytes, from which `Spec.restore` makes an equivalent monitor.

        It contains open attempts, current values, held-back samples and all records so far, but no
        code. It can be restored only with the same specification and version of rvmon.

        Raises:
            SnapshotError: the run is finished.
        """
        return self._one_call(self._snapshot)

    def __reduce__(self) -> NoReturn:
        """Refuse to pickle or copy the monitor, as its state lives in the core; see `snapshot`.

        Raises:
            RvmonError: always.
        """
        raise RvmonError(
            "a monitor can be neither pickled nor copied: monitor.snapshot() returns the run as "
            "bytes, and spec.restore(data) makes a monitor from them, in this process or another"
        )

    def _snapshot(self) -> bytes:
        if self._report is not None:
            raise SnapshotError("the run is finished: keep its report, or call reset()")
        state = {"interrupted": self._one_call.interrupted, **self._feed.state()}
        return snapshot_of(self.compiled, self.options, self._planned, self._core, state)

    def restore_state(self, document: Mapping[str, Any]) -> None:
        """Continue the run of a snapshot in this fresh monitor, made with the same options.

        Raises:
            SnapshotError: the snapshot does not fit this monitor.
        """
        state = restored_state(document, self._planned, self._core)
        interrupted = state["interrupted"]
        self._one_call.interrupted = None if interrupted is None else whole_ticks(interrupted)
        self._feed.restore_state(state)
        self._attend()
        self._one_call.note_times()

    @property
    def open(self) -> Sequence[Attempt]:
        """The attempts that are undecided now."""
        return self.open_counts()[1]

    def open_counts(self, most: int | None = None) -> tuple[Mapping[str, int], Sequence[Attempt]]:
        """The number of open attempts per requirement, and the attempts as in `open`.

        With `most`, at most that many attempts: the oldest of each instance, oldest first.
        """
        return self._one_call(self._open_counts, most)

    def _open_counts(self, most: int | None) -> tuple[Mapping[str, int], Sequence[Attempt]]:
        attempts = () if self._report is not None else self._core.open()
        if most is None:
            return Counter(attempt.requirement for attempt in attempts), attempts
        oldest: dict[object, Attempt] = {}
        for attempt in attempts:
            # One instance with thousands of attempts must not crowd out the others.
            each = self._planned.instance(attempt)
            if each not in oldest or attempt.triggered < oldest[each].triggered:
                oldest[each] = attempt
        chosen = nsmallest(most, oldest.values(), key=lambda attempt: attempt.triggered)
        return Counter(attempt.requirement for attempt in attempts), chosen

    @property
    def next_due(self) -> int | None:
        """The next instant (ticks) at which time alone can decide an attempt; `None` if none."""
        return self._one_call(self._next_due)

    def _next_due(self) -> int | None:
        reached = self._one_call.reached
        if reached is None or self._report is not None:
            return None
        due = self._core.next_due()
        return None if due is None else max(due, reached + 1)


def build_monitor(
    compiled: CompiledSpec,
    *,
    only: Iterable[str] | None = None,
    settle: str = "now",
    sources: Iterable[str] | None = None,
    keep: int | None = None,
) -> Monitor:
    """Build a monitor from a compiled specification.

    Args:
        compiled: from `compile_spec`; any number of monitors can share it.
        only: ids of the requirements to judge; default all.
        settle: `now` judges each sample at once; `next` merges samples with equal stamps and judges
            each when the next stamp settles it.
        sources: the signals and events that can arrive; the others are unknown throughout.
        keep: how many records to keep per requirement and verdict, the newest; default all.

    Raises:
        UnknownNameError: `only` has an unknown requirement, or `settle` is neither `now` nor
            `next`.
        RvmonError: a requirement exceeds the limits of the core; `keep` is not a count.
    """
    if keep is not None and (type(keep) is not int or keep < 0):
        raise RvmonError(f"keep={keep!r}: expected a whole number from 0 on, or None to keep all")
    given = None if sources is None else frozenset(sources)
    planned = planned_core(compiled, requirement_ids(compiled.checked, only))
    return Monitor(planned, compiled, Options(settle, given, keep))


def restore(compiled: CompiledSpec, data: bytes) -> Monitor:
    """A monitor that continues the run of a snapshot.

    Raises:
        SnapshotError: the bytes are not a snapshot, or one of another specification or version.
    """
    document = document_of(compiled, data)
    try:
        sources = document["sources"]
        if sources is not None and not all(isinstance(source, str) for source in sources):
            raise TypeError("names are texts")
        monitor = build_monitor(
            compiled,
            only=document["only"],
            settle=document["settle"],
            sources=sources,
            keep=document["keep"],
        )
        monitor.restore_state(document)
    except SnapshotError:
        raise
    except (RvmonError, ArithmeticError, AttributeError, LookupError, TypeError, ValueError):
        raise SnapshotError("the snapshot is damaged: its content fits no monitor") from None
    return monitor
