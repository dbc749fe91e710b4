"""Attempts that wait for the value of a position in a delay network."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterator, Sequence

from rvmon.dataflow.network import Network
from rvmon.dataflow.ranges import Range
from rvmon.monitor.attempts.attempt_judge import Open


def position_of(attempt: Open) -> int:
    """The instant of the position whose value is an attempt's."""
    position: int = attempt.token[1][0]
    return position


def learnt(attempts: Sequence[Open], network: Network) -> Iterator[Range]:
    """The attempts, by first and last index, whose value became known last in a network."""
    gap = network.positions.gap
    if not attempts:
        return
    oldest, youngest = (position_of(attempts[end]) // gap for end in (0, -1))
    for pieces in network.news[-2:]:
        start, position = 0, oldest
        for left, right, _, _ in pieces:
            if right < position:
                continue
            if left > youngest:
                break
            if left > position:
                start = bisect_left(attempts, left * gap, start, key=position_of)
                position = position_of(attempts[start]) // gap
                if right < position:
                    continue
            end = bisect_right(attempts, right * gap, start, key=position_of)
            yield start, end - 1
            if end == len(attempts):
                break
            start, position = end, position_of(attempts[end]) // gap
