"""Step functions over the integers: robustness as it holds for stretches of positions."""

from __future__ import annotations

from collections import deque
from collections.abc import MutableSequence, Sequence

from rvmon.dataflow.piecewise import FAR
from rvmon.dataflow.positions import Positions

Step = tuple[int, int, float]
"""First and last integer, and the value there."""

Steps = Sequence[Step]
"""In order, without gaps between them."""

INFINITE = float("inf")


def add(made: MutableSequence[Step], left: int, right: int, value: float) -> None:
    """Append a step; an empty one is left out, one of the same value is joined to the last."""
    if left > right:
        return
    if made and made[-1][2] == value:
        made[-1] = (made[-1][0], right, value)
    else:
        made.append((left, right, value))


def split(steps: deque[Step], last: int) -> list[Step]:
    """Take the steps up to an integer out of those that wait."""
    made: list[Step] = []
    while steps and steps[0][0] <= last:
        left, right, value = steps.popleft()
        made.append((left, min(right, last), value))
        if right > last:
            steps.appendleft((last + 1, right, value))
    return made


def replaced(steps: Steps, left: int, right: int, value: float) -> list[Step]:
    """With one value from `left` to `right`, both included.

    >>> replaced([(0, 9, 1.0)], 3, 4, 5.0)
    [(0, 2, 1.0), (3, 4, 5.0), (5, 9, 1.0)]
    """
    made: list[Step] = []
    for first, last, own in steps:
        add(made, first, min(last, left - 1), own)
        add(made, max(first, left), min(last, right), value)
        add(made, max(first, right + 1), last, own)
    return made


def at_positions(steps: Steps, positions: Positions, elsewhere: float) -> Steps:
    """With one value at all integers that are no positions."""
    if not steps:
        return steps
    bounded = steps
    if steps[0][0] < positions.first:
        bounded = replaced(bounded, -FAR, positions.first - 1, elsewhere)
    if steps[-1][1] > positions.last:
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


def negated(steps: Steps) -> list[Step]:
    """With the other sign."""
    return [(left, right, -value) for left, right, value in steps]
