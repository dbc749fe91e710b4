"""Laws are tried on the native core; other tests compare the core with the oracle."""

from collections.abc import Callable, Iterable
from dataclasses import replace

from hypothesis import HealthCheck, settings
from tests.tools.compare import differences
from tests.tools.drive import drive
from tests.tools.forms import Maker

from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import Case
from rvmon.trace.sample import Sample, Value
from rvmon.verdicts.report import Report

TRIED = settings(
    max_examples=20,
    deadline=None,
    suppress_health_check=[HealthCheck.filter_too_much, HealthCheck.too_slow],
)

ONE = Profile(requirements=1, captures=False, for_each=False)
"""One requirement without captured values."""

_MAKE = Maker()
"""Shared by all cases, so that successive cases of a specification are compiled once."""

_BORN = {"p": True, "q": False, "r": True, "x": 1, "y": 0, "mode": "red"}


def is_known(value: Value) -> bool:
    """Whether a value is neither `None` nor NaN."""
    return value is not None and value == value


def known_from_the_first(case: Case) -> Case:
    """The case with a value for each signal in its first sample."""
    [*first] = case.samples[:1]
    if not first:
        return case
    given = {name: value for name, value in first[0].values.items() if is_known(value)}
    start = Sample(first[0].t, {**first[0].values, **_BORN, **given})
    actions = tuple(start if action is first[0] else action for action in case.actions)
    return replace(case, actions=actions, names=None)


def judge(case: Case) -> Report:
    """The report of a monitor that gets every sample, complete and in order."""
    return drive(_MAKE(case), case)[0]


def judged_otherwise(left: Case, right: Case) -> list[str]:
    """The differences between the reports on two cases."""
    return differences(judge(left), judge(right))


def moved(actions: Iterable[Sample | int], to: Callable[[int], int]) -> tuple[Sample | int, ...]:
    """The same actions at other instants."""
    return tuple(
        replace(action, t=to(action.t)) if isinstance(action, Sample) else to(action)
        for action in actions
    )
