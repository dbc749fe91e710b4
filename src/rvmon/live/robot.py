"""One monitored robot: its monitor, its runs, and the outages of its input."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import msgspec
from msgspec import structs

from rvmon.errors import TimeOrderError, TraceError
from rvmon.language.checked.names_read import requirement_ids
from rvmon.live.sample_queue import Dropped, Gap, OutageReport, Values
from rvmon.session import Spec
from rvmon.trace.sample import Health, HealthKind
from rvmon.trace.time import format_ticks
from rvmon.verdicts import Verdict, fold
from rvmon.verdicts.attempt import Attempt
from rvmon.verdicts.serialise import seconds

if TYPE_CHECKING:
    from rvmon.monitor.monitor import Monitor
    from rvmon.verdicts.report import Report


@dataclass(frozen=True, slots=True)
class Judgement:
    """A decided attempt of a robot.

    Attributes:
        robot: the name of the robot; "" if there is only one.
        run: the number of the run, from 1.
        attempt: the record.
    """

    robot: str
    run: int
    attempt: Attempt

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON and messages; instants in ns, and in s since the run's origin."""
        attempt = self.attempt
        return {
            "robot": self.robot,
            "run": self.run,
            "requirement": attempt.requirement,
            "attempt": attempt.name,
            "verdict": attempt.verdict.value,
            "triggered": attempt.triggered,
            "decided": attempt.decided,
            **seconds(attempt),
            "reason": attempt.reason,
        }

    def to_json(self) -> str:
        """`to_dict` as JSON text."""
        return msgspec.json.encode(self.to_dict()).decode()


@dataclass(frozen=True, slots=True)
class Watch:
    """The options with which robots are monitored."""

    spec: Spec  # the specification
    judging: Spec  # the specification with a `max delay` of at least the lag
    only: Sequence[str] | None  # ids of the requirements; `None`: all
    sources: Sequence[str] | None  # the names that can arrive; `None`: all
    settle: str  # as for `Spec.monitor`
    keep: int | None  # the most records kept per requirement and verdict; `None`: all

    @property
    def ids(self) -> tuple[str, ...]:
        """The ids of the judged requirements, in the order of the file."""
        return requirement_ids(self.spec.checked, self.only) or tuple(self.spec.requirements)

    def monitor(self) -> Monitor:
        """Create a monitor for a run."""
        return self.judging.monitor(
            only=self.only, sources=self.sources, settle=self.settle, keep=self.keep
        )


def with_delay(spec: Spec, delay: int) -> Spec:
    """The specification with a `max delay` of at least `delay`, ns."""
    if delay <= (spec.checked.max_delay or 0):
        return spec
    return Spec(structs.replace(spec.checked, max_delay=delay))


@dataclass(frozen=True, slots=True)
class Status:
    """The status of a robot at an instant.

    Attributes:
        robot: its name; "" if there is only one.
        run: the number of the current run, from 1.
        since: the instant of its first sample, ns; `None` before it.
        now: the current instant, ns.
        verdicts: by requirement, the verdict so far over all runs.
        counts: by requirement and verdict, the number of attempts so far.
        open_counts: by requirement, the number of open attempts; requirements without any may be
            absent.
        open: the records of open attempts: all, or as many as requested.
        samples: the number of samples judged, over all runs.
        lost: the number of samples lost or refused.
        refusal: the reason of the latest refusal; "" if there was none.
    """

    robot: str
    run: int
    since: int | None
    now: int
    verdicts: Mapping[str, Verdict]
    counts: Counter[tuple[str, Verdict]]
    open_counts: Mapping[str, int]
    open: tuple[Attempt, ...]
    samples: int
    lost: int
    refusal: str


class Robot:
    """One robot and its consecutive runs, each with its own monitor.

    Args:
        name: the name of the robot.
        watch: the options of its monitors.
        judged: called with each decided attempt; must not raise.
        ended: called with the name and the report of each run that ends; must not raise.
    """

    KEPT_REPORTS = 10

    def __init__(
        self,
        name: str,
        watch: Watch,
        judged: Callable[[Judgement], None],
        ended: Callable[[str, Report], None],
    ) -> None:
        self.name = name
        self.run = 0  # the number of the current run, from 1
        # the reports of the latest runs that have ended
        self.reports: deque[Report] = deque(maxlen=self.KEPT_REPORTS)
        self._judged = judged
        self._ended = ended
        self._samples = self._lost = 0
        self._refusal = ""
        self._down: dict[str | None, str] = {}  # open outages: name (`None`: all) to reason
        self.start(watch)

    def start(self, watch: Watch) -> None:
        """Start anew: verdicts and counts of earlier runs are discarded."""
        self._before: dict[str, set[Verdict]] = {name: set() for name in watch.ids}
        self._counts: Counter[tuple[str, Verdict]] = Counter()
        self._start_run(watch)

    def _start_run(self, watch: Watch) -> None:
        self._watch = watch
        self._monitor = watch.monitor()
        self._monitor.on_decided(self._hear)
        self.run += 1
        self.floor: int | None = None  # samples before this instant, ns, are too late
        self._is_held_back = False
        self._since: int | None = None
        self.last: int | None = None  # the instant of the latest sample, ns
        self._why: Health | None = None
        self._has_outages_to_repeat = bool(self._down)

    def _hear(self, attempt: Attempt) -> None:
        self._counts[attempt.requirement, attempt.verdict] += 1
        self._judged(Judgement(self.name, self.run, attempt))

    def restart(self, kind: HealthKind, why: str) -> None:
        """End the current run at its present instant, with a health entry, and start another."""
        self._why = Health(kind, "samples", 1, self.floor, self._watch.ids, why)
        self.end()
        self._start_run(self._watch)

    def end(self) -> Report:
        """End the current run at its present instant; returns its report."""
        report = self._monitor.finish_ns()
        if self._why is not None:
            report = replace(report, health=(*report.health, self._why))
        for name, verdict in report.verdicts.items():
            self._before[name].add(verdict)
        self.reports.append(report)
        self._ended(self.name, report)
        return report

    def take(self, t: int, values: Values) -> str:
        """Judge a sample.

        Args:
            t: its instant, ns.
            values: as for `Monitor.step_ns`.

        Returns:
            Why it was refused, which makes its names unknown at its instant; "" if it was accepted.
        """
        self._repeat_outages(t)
        is_too_late = self._monitor.is_too_late(t)
        try:
            self._monitor.step_ns(t, values)
        except TraceError as error:
            self._refusal = str(error)
            self._lost += 1
            names = self._declared(values)
            if isinstance(error, TimeOrderError):
                # No `_note_instant`: the current instant is already later.
                self._monitor.late_ns(names, t)
            else:
                self._monitor.lose_ns(names, t, t, why="refused")
                self._note_instant(t)
            return self._refusal
        if is_too_late:
            self._refusal = f"sample at {format_ticks(t)}: it exceeds the allowed delay"
            self._lost += 1
            return self._refusal
        self._samples += 1
        self._note_instant(t)
        return ""

    def drop(self, dropped: Dropped) -> None:
        """Report the samples that found the queue full to the monitor, as an outage."""
        self._lost += dropped.count
        self._repeat_outages(dropped.first)
        why = "came faster than they were evaluated"
        names = self._declared(dropped.names)
        self._monitor.lose_ns(names, dropped.first, dropped.last, why=why)
        self._note_instant(dropped.last)

    def hear(self, gap: Gap) -> None:
        """Pass a report on an outage to the monitor."""
        # It may contain names of a specification that was replaced since.
        names = None if gap.names is None else self._declared(gap.names)
        if gap.kind is OutageReport.FOUND:
            self._down = (
                {} if names is None else {n: w for n, w in self._down.items() if n not in names}
            )
            self._monitor.found_ns(names, gap.since)
            self._note_instant(gap.since)
            return
        self._lost += 1
        if gap.kind is OutageReport.MISSED:
            self._monitor.miss(names, why=gap.why)
            return
        self._repeat_outages(gap.since)
        if gap.until is None:
            self._down |= dict.fromkeys((None,) if names is None else names, gap.why)
        self._monitor.lose_ns(names, gap.since, gap.until, why=gap.why)
        self._note_instant(gap.since if gap.until is None else gap.until)

    def _repeat_outages(self, t: int) -> None:
        """Repeat the outages that were open when the previous run ended, at `t`."""
        if self._has_outages_to_repeat:
            self._has_outages_to_repeat = False
            for name, why in self._down.items():
                self._monitor.lose_ns(None if name is None else self._declared([name]), t, why=why)

    def _declared(self, names: Iterable[str]) -> list[str]:
        checked = self._watch.spec.checked
        return [name for name in names if name in checked.signals or name in checked.events]

    def _note_instant(self, t: int) -> None:
        """Advance the bookkeeping to the instant of a sample or of a loss."""
        self.last = t if self.last is None else max(self.last, t)
        self._since = t if self._since is None else self._since
        self._is_held_back = self._watch.settle == "next"
        floor = self.last if self._is_held_back else self.last + 1
        self.floor = floor if self.floor is None else max(self.floor, floor)

    def pass_to(self, t: int) -> None:
        """Tell the monitor that no sample before `t` (ns) will come."""
        if self.floor is not None and t > self.floor:
            self._monitor.advance_ns(t)
            self.floor = t
            self._is_held_back = False

    @property
    def due(self) -> int | None:
        """The next instant, ns, at which time alone may decide something."""
        if self._is_held_back and self.floor is not None:
            return self.floor + 1  # a sample held back is judged then
        return self._monitor.next_due

    def status(self, t: int, most: int | None) -> Status:
        """The status at `t` (ns), with at most `most` records of open attempts."""
        now = self._monitor.verdicts
        counts, records = self._monitor.open_counts(most)
        return Status(
            robot=self.name,
            run=self.run,
            since=self._since,
            now=t,
            verdicts={name: fold([*self._before[name], now[name]]) for name in self._watch.ids},
            counts=self._counts.copy(),
            open_counts=counts,
            open=tuple(records),
            samples=self._samples,
            lost=self._lost,
            refusal=self._refusal,
        )
