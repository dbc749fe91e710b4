"""Lead a monitor through a case, as a program that uses it would."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

from rvmon.testing.case import Case
from rvmon.trace.sample import Sample, Value
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.report import Report


class Monitored(Protocol):
    """The part of a monitor that is driven."""

    def step_ns(self, t_ns: int, values: Mapping[str, Value], /) -> Sequence[Attempt]:
        """Take a sample."""

    def advance_ns(self, t_ns: int, /) -> Sequence[Attempt]:
        """Let time pass."""

    def finish_ns(self, t_ns: int | None = None, /) -> Report:
        """End the trace."""


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
    returned = [feed(monitor, action) for action in case.actions]
    return monitor.finish_ns(case.end), returned


def feed(monitor: Monitored, action: Sample | int) -> Sequence[Attempt]:
    """Tell a monitor one action; returns what it decided."""
    if isinstance(action, Sample):
        return monitor.step_ns(action.t, action.values)
    return monitor.advance_ns(action)
