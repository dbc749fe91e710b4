"""How near a test came to what it did not hit: the preconditions that it met."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from itertools import pairwise

from rvmon.coverage.hits import Hits
from rvmon.coverage.model import STATES, TRANSITIONS, Group, Model, Subject

Goal = tuple[str, str]
"""An item of the model, by its group and name."""

_ARROW = " → "
_PART = re.compile(r"(?:^| × )(?:`([^`]*)`|([^`×]*?))(?= × |$)")


def nearest_tests(
    goals: Iterable[Goal], tests: Sequence[tuple[str, Hits]], model: Model
) -> dict[Goal, str]:
    """The first of the tests that came nearest to each item; none where no test came near.

    Args:
        goals: items that were not hit.
        tests: names, and what each has hit.
        model: what there is to be covered.
    """
    found = {}
    for goal in goals:
        near, name = max(
            ((nearness(goal, hits, model), name) for name, hits in tests),
            key=lambda one: one[0],
            default=(0.0, ""),
        )
        if near:
            found[goal] = name
    return found


def nearness(goal: Goal, hits: Hits, model: Model) -> float:
    """The share of the preconditions of an item that a test met, from 0 to 1.

    Of a combination of bins it is the bins in common with the nearest one that was hit; of a
    transition, that its source was reached; of a statement or branch, how far the test got towards
    its line; of anything else, what it hit of the same group.

    Args:
        goal: what was not hit.
        hits: of the test.
        model: what there is to be covered.
    """
    group = model.groups[goal[0]]
    seen = hits.get(group.name, {})
    match group.subject:
        case Subject.CROSS:
            return _of_cross(group, goal[1], [*seen])
        case Subject.TRANSITIONS:
            return _of_transition(goal, hits)
        case Subject.STATEMENTS | Subject.BRANCHES:
            return _of_code(goal, hits)
        case _:
            wanted = max(1, len(group.items))
            return len(seen) / wanted


def cross_parts(name: str) -> list[str]:
    """The bins that the name of a combination is made of.

    >>> cross_parts("yes × `a × b`")
    ['yes', 'a × b']
    """
    return [quoted or plain for quoted, plain in _PART.findall(name)]


def _of_cross(group: Group, wanted: str, seen: list[str]) -> float:
    bins = cross_parts(wanted)
    met = [
        sum(one == other for one, other in zip(bins, cross_parts(name), strict=False))
        for name in seen
    ]
    return max(met, default=0) / max(1, len(group.axes))


def _of_transition(goal: Goal, hits: Hits) -> float:
    """The way to the source counts: a pair of transitions needs its first one."""
    names = goal[1].split(_ARROW)
    way = names[:-1]
    if goal[0].startswith("`"):  # the automaton of a requirement: its locations stand beside
        places = hits.get(goal[0].replace(" edges", " locations"), {})
        return float(way[-1] in places)
    if len(way) == 1:
        return float(way[0] in hits.get(STATES, {}))
    gone = hits.get(TRANSITIONS, {})
    first, second = (_ARROW.join(pair) for pair in pairwise(names))
    met = (first in gone) + (second in gone)
    # Between both the state may have been entered again and again: the fewer times, the nearer.
    again = gone.get(_ARROW.join((names[1], names[1])))
    return (met + 1 / (1 + (again.count if again else 0))) / 3


def _of_code(goal: Goal, hits: Hits) -> float:
    """A branch needs its line; a line, the lines before it."""
    block = goal[0].partition(" of ")[2]
    lines = {int(line) for line in hits.get(f"statements of {block}", {})}
    line = int(goal[1].partition(_ARROW)[0])
    if line in lines:
        return 1.0
    before = [one for one in lines if one < line]
    return 0.9 / (1 + line - max(before)) if before else 0.0
