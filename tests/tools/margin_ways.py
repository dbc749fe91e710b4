"""Every way in which robustness is found, on one case."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

from rvmon.monitor import CompiledSpec
from rvmon.monitor.compiled.refusal import of_measured_c
from rvmon.monitor.robustness.compiled import measuring_library
from rvmon.monitor.robustness.monitor import RobustnessMonitor
from rvmon.monitor.robustness.values import Measured
from rvmon.testing.case import Case
from rvmon.testing.compare import Key, key_of
from rvmon.testing.drive import feed

Figures = tuple[float, float, float]
"""The least that robustness can be, the greatest, and what is kept up to the end."""

Way = Callable[[CompiledSpec, Case], Mapping[Key, Figures] | None]
"""Gives each attempt its figures; `None` if it does not measure such cases."""


def by_samples(compiled: CompiledSpec, case: Case) -> Mapping[Key, Figures]:
    """By a monitor that is stepped."""
    return _stepped(RobustnessMonitor(compiled, sources=case.names), case)


def by_compiled(compiled: CompiledSpec, case: Case) -> Mapping[Key, Figures] | None:
    """The same in C."""
    requirements = [*compiled.requirements.values()]
    if any(map(of_measured_c, requirements)):
        return None
    measuring_library(compiled, requirements, optimised=False)
    return _stepped(RobustnessMonitor(compiled, sources=case.names, engine="c"), case)


def _stepped(monitor: RobustnessMonitor, case: Case) -> Mapping[Key, Figures]:
    found = [one for action in case.actions for one in feed(monitor, action)]
    return _figures([*found, *monitor.finish_ns(case.end)])


def _figures(found: Iterable[Measured]) -> Mapping[Key, Figures]:
    bounds = ((key_of(one), one.robustness) for one in found)
    return {key: (one.low, one.high, one.kept) for key, one in bounds}


WAYS: Mapping[str, Way] = {"samples": by_samples, "c": by_compiled}
