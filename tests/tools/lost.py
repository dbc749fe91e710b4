"""What a monitor is told of a case with outages: which names are lost, and found, and when."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby

from rvmon.testing.case import Case
from rvmon.trace.sample import Sample


@dataclass(frozen=True, slots=True)
class Lost:
    """From an instant on, some names are lost.

    Attributes:
        names: of signals and events; there may be none.
        t: ticks.
    """

    names: tuple[str, ...]
    t: int


@dataclass(frozen=True, slots=True)
class Found:
    """An instant is the last at which some names are lost.

    Attributes:
        names: of signals and events; there may be none.
        t: ticks.
    """

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
