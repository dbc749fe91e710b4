"""Every way in which robustness is found, on one case."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

from rvmon.monitor.robustness.monitor import RobustnessMonitor
from rvmon.monitor.robustness.values import Measured
from rvmon.session import Spec
from rvmon.testing.case import Case
from rvmon.testing.compare import Key, key_of
from rvmon.testing.drive import feed

Figures = tuple[float, float, float]
"""The least that robustness can be, the greatest, and what is kept up to the end."""


def by_samples(case: Case) -> Mapping[Key, Figures]:
    """Each attempt's figures, by a monitor that is stepped."""
    monitor = RobustnessMonitor(Spec(case.spec)._compiled, sources=case.names)
    found = [one for action in case.actions for one in feed(monitor, action)]
    return _figures([*found, *monitor.finish_ns(case.end)])


def _figures(found: Iterable[Measured]) -> Mapping[Key, Figures]:
    return {key_of(one): (one.robustness.low, one.robustness.high, one.robustness.kept) for one in found}


WAYS: Mapping[str, Callable[[Case], Mapping[Key, Figures] | None]] = {
    "samples": by_samples,
}
