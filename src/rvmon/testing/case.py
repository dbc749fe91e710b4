"""A specification with a trace to judge, as test data."""

from __future__ import annotations

from dataclasses import dataclass

from rvmon.spec.checked.specification import CheckedSpec
from rvmon.testing.law.outage import Outage
from rvmon.trace.sample import Sample


@dataclass(frozen=True, slots=True)
class Case:
    """One thing to compare a monitor and the law on.

    Attributes:
        spec: what to judge by.
        actions: what a monitor is given, in order: a sample, or the instant of an `advance`.
        end: what it is given by `finish`, ticks.
        names: the names that have a source; `None`: all.
        outages: what was lost, in any order; no monitor can be told yet.
    """

    spec: CheckedSpec
    actions: tuple[Sample | int, ...]
    end: int | None = None
    names: frozenset[str] | None = None
    outages: tuple[Outage, ...] = ()

    @property
    def samples(self) -> tuple[Sample, ...]:
        """The samples alone."""
        return tuple(action for action in self.actions if isinstance(action, Sample))

    @property
    def advances(self) -> tuple[int, ...]:
        """The instants of `advance` alone."""
        return tuple(action for action in self.actions if isinstance(action, int))
