"""Lead a monitor through a case, as a program that uses it would."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Protocol, cast

from rvmon.testing.case import Case
from rvmon.trace.sample import Sample, Value
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.report import Report
from tests.tools.lost import Found, Lost, open_at_end, told


class Monitored(Protocol):
    """The part of a monitor that is driven."""

    def step_ns(self, t_ns: int, values: Mapping[str, Value], /) -> Sequence[Attempt]:
        """Take a sample."""

    def advance_ns(self, t_ns: int, /) -> Sequence[Attempt]:
        """Let time pass."""

    def finish_ns(self, t_ns: int | None = None, /) -> Report:
        """End the trace."""


class Losing(Monitored, Protocol):
    """A monitor that can be told of outages."""

    def lose(self, names: Iterable[str], since: int, /) -> bool:
        """Lose some names."""

    def found(self, names: Iterable[str], at: int, /) -> bool:
        """Find them again."""


class OnlineMonitor(Monitored, Protocol):
    """A monitor that can be asked at any time."""

    @property
    def open(self) -> Sequence[Attempt]:
        """The attempts that are undecided now."""

    @property
    def next_due(self) -> int | None:
        """The next instant at which time alone can decide something."""


def drive(monitor: Monitored, case: Case) -> tuple[Report, list[Sequence[Attempt]]]:
    """Tell a monitor the actions of a case, then finish.

    Returns:
        The report, and what each action returned.
    """
    if case.outages:
        return drive_losing(cast(Losing, monitor), case)
    returned = [feed(monitor, action) for action in case.actions]
    return monitor.finish_ns(case.end), returned


def drive_losing(monitor: Losing, case: Case) -> tuple[Report, list[Sequence[Attempt]]]:
    """The same with what was lost; now and then nobody says that it was found.

    Raises:
        AssertionError: the monitor takes what was lost for judged already.
    """
    end = open_at_end(case) if len(case.actions) % 2 else None
    returned = []
    for action in told(case):
        match action:
            case Lost(names, t):
                assert monitor.lose(names, t), f"nothing can be lost at {t}"
            case Found(names, t) if t != end:
                assert monitor.found(names, t), f"nothing can be found at {t}"
            case Sample() | int():
                returned.append(feed(monitor, action))
    return monitor.finish_ns(case.end if end is None else end), returned


def feed(monitor: Monitored, action: Sample | int) -> Sequence[Attempt]:
    """Tell a monitor one action; returns what it decided."""
    if isinstance(action, Sample):
        return monitor.step_ns(action.t, action.values)
    return monitor.advance_ns(action)
