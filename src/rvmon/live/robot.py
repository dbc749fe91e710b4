"""One robot that is watched: its monitor, its runs, what of its data was lost."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from rvmon.errors import TimeOrderError, TraceError
from rvmon.live.status import Status
from rvmon.live.waiting import Lost, Values
from rvmon.spec.checked.selection import requirements_asked
from rvmon.trace.health import Health, HealthKind
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.verdict import Verdict, fold

if TYPE_CHECKING:
    from rvmon.monitor import Monitor
    from rvmon.session import Spec
    from rvmon.verdict.report import Report

_SAME = 40
"""Remarks that begin alike to so many characters are counted together."""


@dataclass(frozen=True, slots=True)
class Judgement:
    """An attempt of a robot that was decided.

    Attributes:
        robot: its name; empty if there is one only.
        run: the number of its run, from 1.
        attempt: the record.
    """

    robot: str
    run: int
    attempt: Attempt

    def to_dict(self) -> dict[str, Any]:
        """As plain values, for JSON and messages: instants in ns."""
        attempt = self.attempt
        return {
            "robot": self.robot,
            "run": self.run,
            "requirement": attempt.requirement,
            "attempt": attempt.name,
            "verdict": attempt.verdict.value,
            "triggered": attempt.triggered,
            "decided": attempt.decided,
            "reason": attempt.reason,
        }


@dataclass(frozen=True, slots=True)
class Watch:
    """How robots are watched.

    Attributes:
        spec: what they must do.
        only: ids of the requirements; `None`: all.
        sources: the names that can arrive; `None`: all.
        settle: as for `Spec.monitor`.
        keep: so many records of each verdict are kept per requirement.
    """

    spec: Spec
    only: Sequence[str] | None
    sources: Sequence[str] | None
    settle: str
    keep: int | None

    @property
    def ids(self) -> tuple[str, ...]:
        """Of the requirements that are judged, in the order of the file."""
        return requirements_asked(self.spec.checked, self.only) or tuple(self.spec.requirements)

    def monitor(self) -> Monitor:
        """A monitor for a run."""
        return self.spec.monitor(
            only=self.only, sources=self.sources, settle=self.settle, keep=self.keep
        )


class Robot:
    """One robot: runs, one after the other, each with a monitor of its own.

    Args:
        name: of the robot.
        watch: how it is watched.
        judged: called with what is decided; it raises nothing.
        ended: called with the name and the report of each run that ended; it raises nothing.

    Attributes:
        run: the number of the run that is under way, from 1.
        last: the instant of the latest sample, ns; `None` before the first.
        floor: no sample before this instant, ns, is taken any more; `None` before the first.
        reports: of the newest runs that have ended.
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
        self.run = 0
        self.reports: deque[Report] = deque(maxlen=self.KEPT_REPORTS)
        self._judged = judged
        self._ended = ended
        self._samples = self._lost = 0
        self._refusal = ""
        self.begin(watch)

    def begin(self, watch: Watch) -> None:
        """Begin to watch it: what earlier runs showed counts no more."""
        self._before: dict[str, set[Verdict]] = {name: set() for name in watch.ids}
        self._counts: Counter[tuple[str, Verdict]] = Counter()
        self._begin(watch)

    def _begin(self, watch: Watch) -> None:
        self._watch = watch
        self._monitor = watch.monitor()
        self._monitor.on_decided(self._hear)
        self.run += 1
        self.floor: int | None = None
        self._is_held_back = False
        self._since: int | None = None
        self.last: int | None = None
        self._health: dict[tuple[HealthKind, str], Health] = {}

    def _hear(self, attempt: Attempt) -> None:
        self._counts[attempt.requirement, attempt.verdict] += 1
        self._judged(Judgement(self.name, self.run, attempt))

    def restart(self, kind: HealthKind, why: str) -> None:
        """End the run that is under way where it has come to, and begin another."""
        self._note(kind, 1, self.floor, why)
        self.end()
        self._begin(self._watch)

    def end(self) -> Report:
        """End the run that is under way where it has come to."""
        report = self._monitor.finish_ns()
        report = replace(report, health=(*report.health, *self._health.values()))
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
            Why it was refused; what it spoke of is unknown then. Empty: it was taken.
        """
        try:
            self._step(t, values)
        except TraceError as error:
            self._refusal = str(error)
            self._lose_one(t, values, is_late=isinstance(error, TimeOrderError))
            return self._refusal
        self._samples += 1
        return ""

    def lose(self, lost: Lost) -> None:
        """Have unknown what was lost for want of room."""
        self._lost += lost.count
        self._note(HealthKind.DROPPED, lost.count, lost.t, "came faster than they were evaluated")
        if lost.moments is None:
            self._run_lost_much()
            return
        signals = self._watch.spec.checked.signals
        at = {lost.t: {name: None for name in lost.names if name in signals}}
        for t, names in lost.moments:
            at.setdefault(t, {}).update(dict.fromkeys(names))
        for t, values in at.items():
            self._step(t, values)

    def _run_lost_much(self) -> None:
        """Begin a run, as nobody can say when what may have happened; nothing has passed then."""
        for seen in self._before.values():
            seen.add(Verdict.INCONCLUSIVE)
        self.restart(HealthKind.DROPPED, "so much was lost that a new run began")

    def _lose_one(self, t: int, values: Values, *, is_late: bool) -> None:
        """What a sample held is unknown, from its instant on or, if that is over, from now on."""
        self._lost += 1
        kind = HealthKind.LATE if is_late else HealthKind.DROPPED
        self._note(kind, 1, t, "left out" if is_late else f"refused, as {self._refusal}")
        checked = self._watch.spec.checked
        names = {name: None for name in values if name in checked.signals or name in checked.events}
        self._step(t if self.floor is None else max(t, self.floor), names)

    def _step(self, t: int, values: Values) -> None:
        self._monitor.step_ns(t, values)
        self.last = t
        self._since = t if self._since is None else self._since
        self._is_held_back = self._watch.settle == "next"
        self.floor = t if self._is_held_back else t + 1

    def _note(self, kind: HealthKind, count: int, first: int | None, remark: str) -> None:
        known = self._health.get((kind, remark[:_SAME]))
        if known is None:
            known = Health(kind, "samples", 0, first, self._watch.ids, remark)
        self._health[kind, remark[:_SAME]] = replace(known, count=known.count + count)

    def pass_to(self, t: int) -> None:
        """Learn that no sample before an instant will come."""
        if self.floor is not None and t > self.floor:
            self._monitor.advance_ns(t)
            self.floor = t
            self._is_held_back = False

    @property
    def due(self) -> int | None:
        """The next instant, ns, at which time alone may decide something."""
        if self._is_held_back and self.floor is not None:
            return self.floor + 1  # the sample is judged then
        return self._monitor.next_due

    def status(self, t: int, most: int | None) -> Status:
        """How it stands at an instant, with so many records of what is open."""
        now = self._monitor.verdicts
        owed, records = self._monitor.owed(most)
        return Status(
            robot=self.name,
            run=self.run,
            since=self._since,
            now=t,
            verdicts={name: fold([*self._before[name], now[name]]) for name in self._watch.ids},
            counts=self._counts.copy(),
            owed=owed,
            open=tuple(records),
            samples=self._samples,
            lost=self._lost,
            refusal=self._refusal,
        )
