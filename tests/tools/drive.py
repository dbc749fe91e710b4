"""Lead a monitor through a case, as a program that uses it would."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any, Protocol

from rvmon.testing.generate.trace import Case
from rvmon.trace.sample import Sample, Value
from rvmon.verdicts.attempt import Attempt
from rvmon.verdicts.report import Report


class Monitored(Protocol):
    """The part of a monitor that is driven."""

    def step_ns(self, t_ns: int, values: Mapping[str, Value], /) -> Sequence[Attempt]: ...

    def advance_ns(self, t_ns: int, /) -> Sequence[Attempt]: ...

    def lose_ns(self, names: Iterable[str], since: int, /) -> Any: ...

    def found_ns(self, names: Iterable[str], at: int, /) -> Any: ...

    def finish_ns(self, t_ns: int | None = None, /) -> Report: ...


def drive(monitor: Any, case: Case) -> tuple[Any, list[Any]]:
    """Tell a `Monitored`, or one of robustness, a case to its end; the report, what calls returned.

    Now and then nobody says that what was lost was found.
    """
    end = open_at_end(case) if len(case.actions) % 2 else None
    returned = []
    for action in told(case):
        match action:
            case Lost(names, t):
                returned.append(monitor.lose_ns(names, t))
            case Found(names, t) if t != end:
                returned.append(monitor.found_ns(names, t))
            case Sample() | int():
                returned.append(feed(monitor, action))
    return monitor.finish_ns(case.end if end is None else end), returned


def feed(monitor: Monitored, action: Sample | int) -> Sequence[Attempt]:
    """Tell a monitor one action; returns what it decided."""
    if isinstance(action, Sample):
        return monitor.step_ns(action.t, action.values)
    return monitor.advance_ns(action)


@dataclass(frozen=True, slots=True)
class Lost:
    """From an instant on, some names are lost."""

    names: tuple[str, ...]
    t: int


@dataclass(frozen=True, slots=True)
class Found:
    """An instant is the last at which some names are lost."""

    names: tuple[str, ...]
    t: int


Told = Sample | int | Lost | Found


def told(case: Case) -> Iterator[Told]:
    """The actions of a case, and what was lost and found between them.

    What is lost from the instant of a sample on is told before it, and what is found there, too.
    """
    calls = _calls(case)
    for action in case.actions:
        t = action.t if isinstance(action, Sample) else action - 1
        while calls and calls[0].t <= t:
            yield calls.pop(0)
        yield action
    yield from calls


def open_at_end(case: Case) -> int | None:
    """The end of a case at which something is lost still, to try that nobody says it was found."""
    last = max((outage.last for outage in case.outages), default=None)
    later = [action.t if isinstance(action, Sample) else action for action in case.actions]
    if last is None or any(t > last for t in (*later, last if case.end is None else case.end)):
        return None
    return last


def _calls(case: Case) -> list[Lost | Found]:
    """In order; of stretches of one name that overlap nothing is told in between."""
    found: list[tuple[int, int, bool, str]] = []
    for name in (*case.spec.signals, *case.spec.events, ""):
        for number, (first, last) in enumerate(_stretches(case, name)):
            found += [(first, 2 * number, True, name), (last, 2 * number + 1, False, name)]
    calls: list[Lost | Found] = []
    for (t, _, lost, _), group in groupby(sorted(found), key=lambda one: (*one[:3], one[3] > "")):
        names = tuple(name for *_, name in group if name)
        calls.append(Lost(names, t) if lost else Found(names, t))
    return calls


def _stretches(case: Case, name: str) -> Sequence[tuple[int, int]]:
    """The outages of a name, those that overlap in more than an instant as one.

    Those of nothing are of the name "".
    """
    found: list[tuple[int, int]] = []
    own = [one for one in case.outages if name in one.names or not (name or one.names)]
    for first, last in sorted((one.first, one.last) for one in own):
        if found and first < found[-1][1]:
            found[-1] = (found[-1][0], max(found[-1][1], last))
        else:
            found.append((first, last))
    return found
