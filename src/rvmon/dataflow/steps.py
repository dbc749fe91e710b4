"""Step functions over the integers: robustness as it holds for stretches of positions.

Min and max stand in the place of `and` and `or`; windows are met by a monotonic wedge, so that each
operator costs a pass over the steps of its operands, however long its window.

Source: Donze, Ferrere and Maler 2013, Efficient robust monitoring for STL; Lemire 2006 (the wedge).
"""

from __future__ import annotations

from bisect import bisect_right
from collections import deque
from collections.abc import Sequence
from operator import itemgetter

from rvmon.dataflow.pieces import FAR
from rvmon.dataflow.positions import Positions

Step = tuple[int, int, float]
"""First and last integer, and the value there."""

Steps = Sequence[Step]
"""From `-FAR` to `FAR` without gaps."""

INFINITE = float("inf")


def constant(value: float) -> Steps:
    """The same everywhere."""
    return ((-FAR, FAR, value),)


def value_at(steps: Steps, integer: int) -> float:
    """The value at an integer."""
    return steps[bisect_right(steps, integer, key=itemgetter(0)) - 1][2]


def add(made: list[Step], left: int, right: int, value: float) -> None:
    """Append a step; one of the same value is joined to the last."""
    if left > right:
        return
    if made and made[-1][2] == value:
        made[-1] = (made[-1][0], right, value)
    else:
        made.append((left, right, value))


def of_changes(changes: Sequence[tuple[int, float]]) -> Steps:
    """A function that takes each value from its integer on, and the first one before as well."""
    made: list[Step] = []
    left = -FAR
    for index, (_, value) in enumerate(changes):
        right = changes[index + 1][0] - 1 if index + 1 < len(changes) else FAR
        add(made, left, right, value)
        left = right + 1
    return made


def extreme(one: Steps, other: Steps, *, greatest: bool) -> Steps:
    """The greater of two functions, or the lesser."""
    choose = max if greatest else min
    made: list[Step] = []
    i = j = 0
    left = -FAR
    while left <= FAR:
        right = min(one[i][1], other[j][1])
        add(made, left, right, choose(one[i][2], other[j][2]))
        i += one[i][1] == right
        j += other[j][1] == right
        left = right + 1
    return made


def moved(steps: Steps, offset: int) -> Steps:
    """At each integer the value `offset` further on."""
    return [
        (
            left - offset if left > -FAR else left,
            right - offset if right < FAR else right,
            value,
        )
        for left, right, value in steps
    ]


def replaced(steps: Steps, left: int, right: int, value: float) -> Steps:
    """With one value from `left` to `right`, both included."""
    made: list[Step] = []
    for first, last, own in steps:
        add(made, first, min(last, left - 1), own)
        add(made, max(first, left), min(last, right), value)
        add(made, max(first, right + 1), last, own)
    return made


def at_positions(steps: Steps, positions: Positions, elsewhere: float) -> Steps:
    """With one value at all integers that are no positions."""
    bounded = replaced(steps, -FAR, positions.first - 1, elsewhere)
    bounded = replaced(bounded, positions.last + 1, FAR, elsewhere)
    if not positions.sparse:
        return bounded
    made: list[Step] = []
    for left, right, value in bounded:
        start = left
        for position in () if value == elsewhere else positions.within(left, right):
            add(made, start, position - 1, elsewhere)
            add(made, position, position, value)
            start = position + 1
        add(made, start, right, elsewhere)
    return made


def over_window(steps: Steps, low: int, high: int, *, greatest: bool) -> Steps:
    """At i the greatest value (or the least) from i + low to i + high; `low` is at most `high`."""
    made: list[Step] = []
    wedge: deque[tuple[int, float]] = deque()
    done = -FAR
    for left, right, value in (*steps, (FAR + high + 1, FAR, 0.0)):
        entered = left - high if left > -FAR else left
        while wedge and done < entered and done <= FAR:
            last, best = wedge[0]
            until = min(last, entered - 1, FAR)
            add(made, done, until, best)
            done = max(done, until + 1)
            if last < entered:
                wedge.popleft()
        while wedge and (wedge[-1][1] <= value if greatest else wedge[-1][1] >= value):
            wedge.pop()
        wedge.append((right - low if right < FAR else FAR, value))
    return made


def until(stays: Steps, meets: Steps, tail: float) -> Steps:
    """U(i) = max(meets(i), min(stays(i), U(i + 1))), with `tail` at infinity."""
    parts: list[Step] = []
    i, j = len(stays) - 1, len(meets) - 1
    right, value = FAR, tail
    while right >= -FAR:
        left = max(stays[i][0], meets[j][0])
        value = max(meets[j][2], min(stays[i][2], value))
        parts.append((left, right, value))
        i -= stays[i][0] == left
        j -= meets[j][0] == left
        right = left - 1
    made: list[Step] = []
    for step in reversed(parts):
        add(made, *step)
    return made


def since(stays: Steps, meets: Steps) -> Steps:
    """S(i) = max(meets(i), min(stays(i), S(i − 1))), with minus infinity before all."""
    made: list[Step] = []
    i = j = 0
    left, value = -FAR, -INFINITE
    while left <= FAR:
        right = min(stays[i][1], meets[j][1])
        value = max(meets[j][2], min(stays[i][2], value))
        add(made, left, right, value)
        i += stays[i][1] == right
        j += meets[j][1] == right
        left = right + 1
    return made


def negated(steps: Steps) -> Steps:
    """With the other sign."""
    return [(left, right, -value) for left, right, value in steps]
