"""Every way in which robustness is found, on one case."""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from tests.tools.compare import Key
from tests.tools.doors import content_of, whole

from rvmon.monitor.robustness import Measured, Robustness, RobustnessMonitor
from rvmon.session import Spec
from rvmon.testing.case import Case
from rvmon.trace.sample import Sample

Figures = tuple[float, float, float]
"""The least that robustness can be, the greatest, and what is kept up to the end."""


@dataclass(frozen=True, slots=True)
class Way:
    """A way to find robustness.

    Attributes:
        measure: gives each attempt its figures.
        adapted: the case that is like another one and can be measured so.
    """

    measure: Callable[[Spec, Case], Mapping[Key, Figures]]
    adapted: Callable[[Case], Case] = lambda case: case


def by_samples(spec: Spec, case: Case) -> Mapping[Key, Figures]:
    """By a monitor that is stepped."""
    return _stepped(RobustnessMonitor(spec._compiled, sources=case.names), case)


def by_arrays(spec: Spec, case: Case) -> Mapping[Key, Figures]:
    """As a recording in columns."""
    samples = case.samples
    columns: dict[str, Any] = {"t_ns": np.array([one.t for one in samples], np.int64)}
    for name in sorted(case.names or ()):
        columns[name] = np.array([one.values[name] for one in samples])
    until = None if case.end is None else case.end * 1e-9
    found = spec.robustness(columns, until=until, allow_missing=True)
    bounds = {(name, False, n): one for (name, n), one in found.attempts.items()}
    return _bounds(bounds | {(name, True, n): one for (name, n), one in found.doubtful.items()})


def in_columns(case: Case) -> Case:
    """A case each sample of which says something of all names, as rows do."""
    content = whole(content_of(random.Random(len(case.actions)), case))
    samples = tuple(Sample(t, cells) for t, cells in content.rows)
    return replace(case, actions=samples, names=frozenset(content.columns))


def _stepped(monitor: RobustnessMonitor, case: Case) -> Mapping[Key, Figures]:
    found: list[Measured] = []
    for action in case.actions:
        if isinstance(action, Sample):
            found += monitor.step_ns(action.t, action.values)
        else:
            found += monitor.advance_ns(action)
    found += monitor.finish_ns(case.end)
    return _bounds(
        {(one.requirement, one.in_doubt, one.number or 0): one.robustness for one in found}
    )


def _bounds(found: Mapping[Key, Robustness]) -> Mapping[Key, Figures]:
    return {key: (one.low, one.high, one.kept) for key, one in found.items()}


WAYS: Mapping[str, Way] = {
    "samples": Way(by_samples),
    "arrays": Way(by_arrays, in_columns),
}
