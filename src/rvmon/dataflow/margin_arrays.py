"""The robustness of a formula along a whole trace, node by node over arrays.

Each node is a step function over the integers: `rvmon.codegen.python_margins` says the same of a
trace that goes by.

Source: Donze, Ferrere and Maler 2013; Bender and Farach-Colton 2000, The LCA problem revisited
(extremes of ranges).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from typing import TYPE_CHECKING, assert_never

import numpy as np

from rvmon.dataflow.margin_end import End, Rest
from rvmon.dataflow.margins import INFINITE
from rvmon.dataflow.nodes import Junction, Leaf, NetworkPlan, Shift, Sweep, Window, operands_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Integers = NDArray[np.int64]
    Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Steps:
    """A step function; where only samples are positions, each has a step of its own.

    Attributes:
        starts: int64[n], the first integer of each step, ascending.
        values: float64[n].
    """

    starts: Integers
    values: Floats

    def at(self, integers: Integers) -> Floats:
        """The values at integers, none of which is before the first step."""
        if self.starts is integers:
            return self.values
        return self.values[np.searchsorted(self.starts, integers, "right") - 1]


@dataclass(frozen=True, slots=True)
class Whole:
    """A trace that has ended.

    Attributes:
        sparse: whether only samples are positions; else all integers are.
        first: the first position.
        last: the last one.
        reached: the instant that time has come to, ticks.
        end: what is assumed of what lies behind.
    """

    sparse: bool
    first: int
    last: int
    reached: int
    end: End


def steps_of(plan: NetworkPlan, leaves: Mapping[int, Steps], whole: Whole) -> Steps:
    """The robustness of a formula.

    Args:
        plan: of the formula, over ticks.
        leaves: by place, those that are no constants.
        whole: the trace.
    """
    found: list[Steps] = []
    for place, node in enumerate(plan.nodes):
        operands = [found[operand] for operand in operands_of(node)]
        match node:
            case Leaf():
                made = leaves[place]
            case Junction():
                starts, values = _aligned(operands)
                made = Steps(starts, reduce(np.minimum if node.every else np.maximum, values))
            case Window():
                made = _window(node, operands[0], whole)
            case Shift():
                shifted = _next_or_last if whole.sparse else _shifted
                made = shifted(node, plan.sweep_of(node), operands[0], whole)
            case Sweep():
                made = _swept(node, operands, whole)
            case _:
                assert_never(node)
        found.append(made)
    return found[-1]


def _aligned(operands: Sequence[Steps]) -> tuple[Integers, Sequence[Floats]]:
    """Functions at all integers at which one of them may change."""
    starts = operands[0].starts
    if any(one.starts is not starts for one in operands):
        starts = _distinct([one.starts for one in operands])
    return starts, [one.at(starts) for one in operands]


def _distinct(parts: Sequence[Integers]) -> Integers:
    """The integers of ascending arrays, ascending, each once."""
    made = np.concatenate(parts)
    made.sort(kind="stable")
    new = np.empty(len(made), bool)
    new[:1] = True
    np.not_equal(made[1:], made[:-1], out=new[1:])
    return made[new]


def _window(node: Window, operand: Steps, whole: Whole) -> Steps:
    nothing = INFINITE if node.every else -INFINITE
    limit = whole.last if node.over is None else min(whole.reached - node.over, whole.last)
    spacing = _spacing(operand.starts) if whole.sparse else 0
    if spacing:
        at = operand.starts
        values = _evenly(operand.values, -(-node.low // spacing), node.high // spacing, node.every)
    else:
        at, left, right = _reaches(node, operand.starts, whole, limit)
        values = _extremes(operand.values, left, right, node.every)
    if node.over is not None and whole.end.pending != nothing:
        values[np.searchsorted(at, limit, "right") :] = whole.end.pending
    return Steps(at, values)


def _spacing(starts: Integers) -> int:
    """The distance of neighbours; 0 where it is not everywhere the same."""
    if len(starts) < 2:
        return 0
    spacing = int(starts[1] - starts[0])
    even = np.array_equal(starts[1:], starts[:-1] + spacing)
    return spacing if even else 0


def _reaches(
    node: Window, starts: Integers, whole: Whole, limit: int
) -> tuple[Integers, Integers, Integers]:
    """Where a window may have another value, and from which step of the operand to which it goes.

    Where the window is empty these have crossed.
    """
    low, high = node.low, node.high
    if whole.sparse:
        left = np.searchsorted(starts, starts + low, "left")
        return starts, left, np.searchsorted(starts, starts + high, "right") - 1
    edges = np.array([whole.first, whole.first - high, whole.last - low + 1, limit + 1])
    at = _distinct([np.sort(edges), starts[1:] - high, starts[1:] - low])
    at = at[(at >= whole.first) & (at <= whole.last)]
    left = np.searchsorted(starts, np.maximum(at + low, whole.first), "right") - 1
    left[at + low > whole.last] = len(starts)
    return at, left, np.searchsorted(starts, np.minimum(at + high, whole.last), "right") - 1


def _evenly(values: Floats, low: int, high: int, every: bool) -> Floats:
    """The extremes of windows from `low` to `high` places further on, both included."""
    choose, nothing = (np.minimum, INFINITE) if every else (np.maximum, -INFINITE)
    count = len(values)
    low, high = max(low, -count), min(high, count)
    if low > high:
        return np.full(count, nothing)
    before, behind = np.full(max(-low, 0), nothing), np.full(max(high, 0), nothing)
    table, step, width = np.concatenate((before, values, behind)), 1, high - low + 1
    while 2 * step <= width:
        table = choose(table[:-step], table[step:])
        step *= 2
    first, last = max(low, 0), max(low, 0) + width - step
    made: Floats = choose(table[first : first + count], table[last : last + count])
    return made


def _extremes(values: Floats, left: Integers, right: Integers, every: bool) -> Floats:
    """The least or greatest values from one place to another, both included, where not crossed."""
    choose = np.minimum if every else np.maximum
    made = np.full(len(left), INFINITE if every else -INFINITE)
    level = np.frexp((right - left + 1).clip(min=0).astype(np.float64))[1] - 1
    step, table = 1, values
    for power in range(int(level.max(initial=-1)) + 1):
        own = np.flatnonzero(level == power)
        made[own] = choose(table[left[own]], table[right[own] + 1 - step])
        table = choose(table[:-step], table[step:])
        step *= 2
    return made


def _shifted(node: Shift, sweep: Sweep, operand: Steps, whole: Whole) -> Steps:
    starts, values = operand.starts - node.offset, operand.values
    if node.offset < 0:
        starts = np.append(whole.first, starts)
        values = np.append(INFINITE if sweep.dual else -INFINITE, values)
    else:
        behind = [(whole.last - node.offset + 1, whole.end.behind(sweep.kept))]
        if whole.end.rest is Rest.END:
            behind.append((whole.end.instant - node.opens + 1, -INFINITE))
        starts = np.append(starts, [start for start, _ in behind])
        values = np.append(values, [value for _, value in behind])
    begin = int(np.searchsorted(starts, whole.first, "right")) - 1
    stop = int(np.searchsorted(starts, whole.last, "right"))
    return Steps(np.maximum(starts[begin:stop], whole.first), values[begin:stop])


def _next_or_last(node: Shift, sweep: Sweep, operand: Steps, whole: Whole) -> Steps:
    """As `_shifted`: an `until` has the value of the next position, a `since` that of the last."""
    at, values = operand.starts, operand.values
    if node.offset < 0:
        before = INFINITE if sweep.dual else -INFINITE
        place = np.searchsorted(at, at + node.offset, "right") - 1
        return Steps(at, np.where(place < 0, before, values[place]))
    place = np.searchsorted(at, at + node.offset, "left")
    made = np.append(values, whole.end.behind(sweep.kept))[place]
    if whole.end.rest is Rest.END:
        made[(place == len(at)) & (at > whole.end.instant - node.opens)] = -INFINITE
    return Steps(at, made)


def _swept(node: Sweep, operands: Sequence[Steps], whole: Whole) -> Steps:
    starts, (stays, meets) = _aligned(operands)
    bound = (np.minimum if node.dual else np.maximum)(stays, meets)
    least, most = (bound, meets) if node.dual else (meets, bound)
    if node.future:
        made = _carried(least[::-1], most[::-1], whole.end.behind(node.kept))[::-1]
    else:
        made = _carried(least, most, INFINITE if node.dual else -INFINITE)
    return Steps(starts, made)


def _carried(least: Floats, most: Floats, value: float) -> Floats:
    """What becomes of a value that is kept between bounds, one pair of them after the other."""
    if (least == -INFINITE).all():
        return np.minimum(np.minimum.accumulate(most), value)
    if (most == INFINITE).all():
        return np.maximum(np.maximum.accumulate(least), value)
    # The bounds of 1, 2, 4, … pairs together, until no more of them matter.
    step = 1
    while step < len(least) and not np.array_equal(least[step:], most[step:]):
        both = [np.clip(before[:-step], least[step:], most[step:]) for before in (least, most)]
        least, most = (
            np.concatenate((own[:step], joined))
            for own, joined in zip((least, most), both, strict=True)
        )
        step *= 2
    made: Floats = np.clip(value, least, most)
    return made
