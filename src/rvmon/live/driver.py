"""The driver: passes samples to the monitors of robots and advances their time; never sleeps."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from os import PathLike, fspath
from threading import Condition, Lock, RLock
from typing import TYPE_CHECKING

from rvmon.errors import RvmonError, TraceError
from rvmon.language.checked.names_read import several, source_names
from rvmon.live.clock import FAR_NS, Clock, WallClock, refuse_far
from rvmon.live.robot import Judgement, Robot, Status, Watch, with_delay
from rvmon.live.sample_queue import Dropped, Gap, NewRun, Offered, OutageReport, Timers, Waiting
from rvmon.monitor.listeners import checked
from rvmon.trace.sample import HealthKind
from rvmon.trace.time import format_ticks, whole_ticks
from rvmon.verdicts import Verdict

if TYPE_CHECKING:
    from rvmon.live.sample_queue import Entry, Values
    from rvmon.session import Spec
    from rvmon.verdicts.report import Report

_log = logging.getLogger("rvmon.live")
_input_log = logging.getLogger("rvmon.live.input")

_BATCH = 1_000  # the most entries judged in one call of `work`; `status` may wait that long
_PATIENCE_NS = 2_000_000  # silence after which time is advanced; until then a sample may do it


class Driver:
    r"""Judges samples of any number of robots as they are offered and as time passes.

    `offer` may be called from any thread. The owner of the driver calls `work` whenever `wake` was
    called, and after the seconds that `work` returned. No input stops the driver: a sample that a
    monitor refuses is counted and logged to `rvmon.live.input`, and its names become unknown.

    Args:
        spec: the specification for each robot.
        clock: the clock; default a `WallClock`.
        only: ids of the requirements; default all.
        sources: the names that can arrive; default all.
        keep: the most records kept per requirement and verdict; `None`: all.
        lag_ns: the longest delay of samples with their own stamps. Samples within it are sorted, so
            decisions come that much later. Default: the `max delay` of the specification, or 0.
        room: the most samples in the queue. A sample that finds it full is lost: its signals become
            unknown until their next value, and its events at its instant, so no verdict uses them.
        most_robots: the most robots; samples of further robots are refused.
        on_judged: called with each attempt that passes or fails.
        on_failure: called with each attempt that fails.
        on_report: called with the name of the robot and the report of each run that ends.

    Attributes:
        wake: to be set to a function that schedules `work`; it is called from any thread.
        errors: the number of callbacks that raised; the exceptions were logged.
        most_robots, turned_away: the limit, and whether a robot was refused by it.

    Raises:
        RvmonError: `room`, `most_robots` or `keep` is not a count, or a callback not a function.
        UnknownNameError: `only` or `sources` has an unknown name.

    >>> from rvmon import loads
    >>> from rvmon.live import Driver, SimulatedClock
    >>> spec = loads("spec s\nevent a, b\nrequirement R\n  upon a\n  then within 2 s b\n")
    >>> clock = SimulatedClock()
    >>> driver = Driver(spec, clock=clock, on_failure=lambda one: print(one.attempt.name))
    >>> _ = driver.offer({"a": True})
    >>> _ = driver.work()
    >>> clock.set_ns(2_000_000_001)
    >>> _ = driver.work()
    R#1
    """

    def __init__(
        self,
        spec: Spec,
        *,
        clock: Clock | None = None,
        only: Iterable[str] | None = None,
        sources: Iterable[str] | None = None,
        keep: int | None = 1_000,
        lag_ns: int | None = None,
        room: int = 10_000,
        most_robots: int = 1_000,
        on_judged: Callable[[Judgement], object] | None = None,
        on_failure: Callable[[Judgement], object] | None = None,
        on_report: Callable[[str, Report], object] | None = None,
    ) -> None:
        for name, count in (("room", room), ("most_robots", most_robots)):
            if type(count) is not int or count < 1:
                raise RvmonError(f"{name}={count!r}: expected a whole number of at least 1")
        if isinstance(spec, str | PathLike):
            raise RvmonError(f"a file, not a specification: use `rvmon.load({fspath(spec)!r})`")
        for callback in filter(None, (on_judged, on_failure, on_report)):
            checked(callback, "a judgement, or a robot's name and its report")
        self._clock = WallClock() if clock is None else clock
        self._runs_by_itself = isinstance(self._clock, WallClock)
        self._only, self._sources = several(only), several(sources)
        self._keep, self._asked_lag, self.most_robots = keep, lag_ns, most_robots
        self._on_judged, self._on_failure, self._on_report = on_judged, on_failure, on_report
        self.wake: Callable[[], object] = int
        self.errors, self.turned_away = 0, False
        self._lock = Lock()  # guards the queue and the last stamp given
        self._has_room = Condition(self._lock)
        self._working = RLock()  # guards the monitors; reentrant, as callbacks may call `status`
        self._is_working = self._is_closed = False
        self._stamped = -(1 << 62)
        self._robots: dict[str, Robot] = {}
        self._patience = _PATIENCE_NS if self._runs_by_itself else 0
        self._timers = Timers()
        self._watch, self._lag = self._watching(spec)
        self._waiting = Waiting(room)
        self._clock.on_change(self._clock_was_set)

    def _watching(self, spec: Spec) -> tuple[Watch, int]:
        """The watch of a specification, and the lag in ns; errors as for the constructor."""
        lag = (spec.checked.max_delay or 0) if self._asked_lag is None else self._asked_lag
        # Stamps from elsewhere may be equal; the samples of equal stamps have to be merged.
        settle = "now" if self._runs_by_itself and not lag else "next"
        watch = Watch(spec, with_delay(spec, lag), self._only, self._sources, settle, self._keep)
        watch.monitor()
        return watch, lag

    @property
    def spec(self) -> Spec:
        """The current specification."""
        return self._watch.spec

    def offer(
        self, values: Values, *, robot: str = "", t_ns: int | None = None, wait: bool = False
    ) -> bool:
        """Queue a sample.

        Args:
            values: the updates and occurrences, as for `Monitor.step`.
            robot: the name of the robot.
            t_ns: its stamp, ns; default the current time.
            wait: whether to block while the queue is full; for readers of files or pipes, which
                must not run in the thread that calls `work`.

        Returns:
            Whether it was queued; if not, the queue is full or there are too many robots, and the
            sample is lost.

        Raises:
            TraceError: `values` is not a mapping, or the stamp is invalid or of another epoch.
            RvmonError: the driver was closed.
        """
        if not isinstance(values, Mapping):
            raise TraceError(f"expected values by name, found {values!r}")
        if t_ns is not None:
            t_ns = whole_ticks(t_ns)
            if self._runs_by_itself:
                refuse_far(t_ns, self._clock.now_ns())
        kept = dict(values)
        with self._has_room:
            while wait and self._waiting.is_full and not self._is_closed:
                self._has_room.wait()
            if self._is_closed:
                raise RvmonError("the monitors are closed and take no further samples")
            if not self._is_room_for(robot):
                return False
            if t_ns is None:
                t_ns = max(self._clock.now_ns(), self._stamped)
                self._stamped = t_ns + self._runs_by_itself  # a wall clock gives distinct stamps
            was_empty = not len(self._waiting)
            is_queued = self._waiting.put(Offered(robot, t_ns, kept))
        if was_empty:  # otherwise a woken worker takes this sample, too
            self.wake()
        return is_queued

    def lose(
        self,
        names: Iterable[str] | None = None,
        *,
        robot: str | None = None,
        since_ns: int | None = None,
        is_over: bool = False,
        why: str = "lost",
    ) -> None:
        """Report an outage of names.

        Args:
            names: signals and events; `None`: all.
            robot: the robot; `None`: every known robot.
            since_ns: the last instant at which updates were sure to arrive, ns; default now. The
                lag widens the outage, as `max delay` does.
            is_over: whether the outage has ended by now; otherwise `found` ends it.
            why: a phrase for the input health; the same for all losses of one kind.

        Raises:
            UnknownNameError: a name is not declared.
        """
        self._report(OutageReport.LOST, names, robot, why, since_ns, is_over=is_over)

    def found(self, names: Iterable[str] | None = None, *, robot: str | None = None) -> None:
        """Report that the outage of names ends now; arguments as for `lose`."""
        self._report(OutageReport.FOUND, names, robot, "")

    def miss(
        self, names: Iterable[str] | None = None, *, robot: str | None = None, why: str = "lost"
    ) -> None:
        """Report that input was lost between a robot's last sample and its next one."""
        self._report(OutageReport.MISSED, names, robot, why)

    def _report(
        self,
        kind: OutageReport,
        names: Iterable[str] | None,
        robot: str | None,
        why: str,
        since: int | None = None,
        *,
        is_over: bool = False,
    ) -> None:
        some = source_names(self.spec.checked, names)
        with self._lock:
            now = max(self._clock.now_ns(), self._stamped)
            if kind is not OutageReport.MISSED:  # samples offered from now on get later stamps
                self._stamped = now + self._runs_by_itself
            first = now if since is None else min(since, now)
            last = now if is_over else None
            if kind is OutageReport.FOUND and not self._runs_by_itself:
                first = now + 1  # a sample stamped `now` may have been sent before the lost ones
            for one in [*self._waiting.robots] if robot is None else [robot]:
                if self._is_room_for(one):
                    self._waiting.put_gap(Gap(one, kind, some, first, last, why))
        self.wake()

    def _is_room_for(self, robot: str) -> bool:
        known = self._waiting.robots
        if robot in known or len(known) < self.most_robots:
            return True
        if not self.turned_away:
            _input_log.warning("robot %r is one too many: at most %d", robot, self.most_robots)
        self.turned_away = True
        return False

    def replace_spec(self, spec: Spec) -> None:
        """Judge later samples by another specification; each robot starts a new run.

        Raises:
            UnknownNameError: it lacks a name of `only` or `sources`; the current one stays.
        """
        with self._driving():
            watching, former = self._watching(spec), self._watch
            with self._has_room:
                entries = self._waiting.take(len(self._waiting))
                self._watch, self._lag = watching
                self._has_room.notify_all()
            for entry in entries:  # offered before, so the previous specification judges them
                self._take(entry, former)
            for robot in self._robots.values():
                robot.end()
                robot.start(self._watch)

    def status(self, *, most_open: int | None = None) -> dict[str, Status]:
        """The status of each robot, in one consistent state.

        Args:
            most_open: the most records of open attempts per robot, the oldest of each requirement
                first; default all. A record takes a tenth of a millisecond.
        """
        with self._working:
            now = self._clock.now_ns()
            return {name: robot.status(now, most_open) for name, robot in self._robots.items()}

    @property
    def now_ns(self) -> int:
        """The current instant, ns, by the clock of this driver."""
        return self._clock.now_ns()

    @property
    def waiting(self) -> int:
        """The number of entries in the queue: samples, losses and reports on outages."""
        return len(self._waiting)

    def _clock_was_set(self, before: int, now: int) -> None:
        if now < before or now - before > FAR_NS:  # by years: a clock that started at 0 was set
            with self._lock:
                self._stamped = now
                way = f"back by {format_ticks(before - now)}" if now < before else "on by years"
                self._waiting.put_new_run(f"a new run began: the clock went {way}")
        self.wake()

    def work(self) -> float | None:
        """Judge queued samples, and advance time.

        Returns:
            The seconds after which to call it again, unless `wake` is called earlier; `None`: only
            after `wake`.
        """
        with self._driving():
            return self._work()

    @contextmanager
    def _driving(self) -> Iterator[None]:
        """Exclusive use of the monitors; refuses callbacks, which run in mid-step."""
        with self._working:
            if self._is_working:
                raise RvmonError("a callback cannot drive, close or change its own driver")
            self._is_working = True
            try:
                yield
            finally:
                self._is_working = False

    def _work(self) -> float | None:
        with self._has_room:
            entries = self._waiting.take(_BATCH)
            more = len(self._waiting) > 0
            now = self._clock.now_ns()
            if not more:  # samples offered from now on get no earlier stamp than `now`
                self._stamped = max(self._stamped, now)
            self._has_room.notify_all()
        for entry in entries:
            self._take(entry, self._watch)
        return 0.0 if more else self._pass_to(now)

    def _take(self, entry: Entry, watch: Watch) -> None:
        if isinstance(entry, NewRun):
            _input_log.warning("%s", entry.why)
            for name, known in self._robots.items():
                known.restart(HealthKind.CLOCK, entry.why)
                self._timers.forget(name)
            return
        robot = self._robots.get(entry.robot)
        if robot is None:
            _log.info("%sis watched", _heading(entry.robot))
            robot = self._robots[entry.robot] = Robot(entry.robot, watch, self._judged, self._ended)
        match entry:
            case Offered(t=t, values=values):
                if why := robot.take(t, values):
                    _input_log.warning("%srefused a sample: %s", _heading(entry.robot), why)
            case Dropped(last=t, count=count):
                _input_log.warning("%slost %d samples: no room", _heading(entry.robot), count)
                robot.drop(entry)
            case Gap():
                robot.hear(entry)
        if robot.last is not None:
            self._timers.set(entry.robot, robot.last + self._lag + self._patience)

    def _pass_to(self, now: int) -> float | None:
        """Advance the robots that are due by `now`; returns the seconds to the next one."""
        for t, name in self._timers.take_due(now):
            robot = self._robots[name]
            quiet = (t if robot.last is None else robot.last) + self._lag + self._patience
            if quiet > now:  # a sample arrived since, which has advanced time
                self._timers.set(name, quiet)
                continue
            robot.pass_to(now - self._lag)
            if (due := robot.due) is not None:  # at least `now + 1`, or this loop would not end
                self._timers.set(name, max(due + self._lag, now + 1))
        first = self._timers.first
        return None if first is None else self._clock.seconds_until(first)

    def close(self) -> dict[str, tuple[Report, ...]]:
        """Judge queued samples, end all runs now, and refuse further samples.

        Returns:
            By robot, the reports of its latest runs, in order; a second call returns the same.
        """
        with self._driving():
            with self._has_room:
                was_closed, self._is_closed = self._is_closed, True
                self._has_room.notify_all()
            if not was_closed:
                while len(self._waiting):
                    self._work()
                now = self._clock.now_ns() - self._lag
                for robot in self._robots.values():
                    robot.pass_to(now)
                    robot.end()
            return {name: tuple(robot.reports) for name, robot in self._robots.items()}

    def _judged(self, judgement: Judgement) -> None:
        if judgement.attempt.verdict is Verdict.FAIL:
            _log.warning("%s%s", _heading(judgement.robot), judgement.attempt)
            self._call(self._on_failure, judgement)
        self._call(self._on_judged, judgement)

    def _ended(self, robot: str, report: Report) -> None:
        _log.info("%sa run ended", _heading(robot))
        self._call(self._on_report, robot, report)

    def _call(self, callback: Callable[..., object] | None, *what: object) -> None:
        if callback is None:
            return
        try:
            callback(*what)
        except Exception:  # noqa: BLE001 - a failing callback must not stop the monitors
            self.errors += 1
            _log.exception("a callback failed")


def _heading(robot: str) -> str:
    return f"{robot}: " if robot else ""
