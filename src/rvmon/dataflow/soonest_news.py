"""When the next that is waited for of a network can become known, whatever letters come.

Until then, or until a leaf takes a value that this hangs on, it need not be worked out what letters
bring: the network sleeps. A window of which all
positions decide has no news before it is over; a junction of which all operands decide has none
before the slowest of them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from rvmon.dataflow.knowledge import Knowledge
from rvmon.dataflow.nodes import Junction, Leaf, NetworkPlan, Node, Shift, Sweep, Window
from rvmon.dataflow.piecewise import FAR
from rvmon.dataflow.ranges import Ranges, around, next_in
from rvmon.formula.core import Constant
from rvmon.trace.time import NEVER

_FEW = 4
"""So many stretches of what is not known of an operand are passed over."""

Delay = tuple[int, int]
"""Ticks that pass at least until a position is known to be true, and until to be false."""

Soonest = Callable[[Knowledge, int, int, int], int]
"""From a network, a side (0: true, 1: false) and the first and last position that matter: an
instant before which no such position that is not known yet becomes known to be so, unless a leaf
takes a value that is watched for."""


def delay_of(plan: NetworkPlan, gap: int | None, letter: Sequence[bool]) -> int:
    """Ticks from a position to the first instant at which its value can be known.

    Args:
        plan: of the network.
        gap: ticks between two positions; `None` if only samples are positions.
        letter: that of the position, the truth of each of the plan's leaves.
    """
    step = gap or 1
    values = {place: value for (place, _), value in zip(plan.leaves, letter, strict=True)}
    later, found = _delays(plan.nodes, step), list[Delay]()
    for place, node in enumerate(plan.nodes):
        match node:
            case Leaf():
                found.append((0, NEVER) if values[place] else (NEVER, 0))
            case Window(operand=operand, low=0, over=int(over)):
                here, then = found[operand], later[operand]
                one = int(node.every)
                soon = min(here[one], step + then[one])
                late = NEVER if here[one] == 0 else over
                found.append((late, soon) if node.every else (soon, late))
            case Junction():
                found.append(_joined(node, found))
            case Sweep(left=left, right=right, future=True):
                met, unmet = int(node.dual), int(not node.dual)
                end = min(found[left][unmet], step + later[left][unmet])
                sides = [0, 0]
                sides[met] = min(found[right][met], step + later[right][met])
                sides[unmet] = max(found[right][unmet], end)
                found.append((sides[0], sides[1]))
            case _:
                found.append(later[place])
    return min(found[-1])


def _joined(node: Junction, found: Sequence[Delay]) -> Delay:
    trues, falses = zip(*(found[operand] for operand in node.operands), strict=True)
    return (max(trues), min(falses)) if node.every else (min(trues), max(falses))


def soonest_of(network: Knowledge) -> Soonest:
    """The function of a network's formula; nothing of it looks back."""
    nodes = network.plan.nodes
    delays = _delays(nodes, network.positions.gap)
    made: list[Soonest] = []
    for place, node in enumerate(nodes):
        match node:
            case Leaf():
                made.append(_leaf(network, place, node))
            case Window():
                made.append(_window(network, place, node, made[node.operand]))
            case Junction():
                made.append(_junction(network, place, node, made, delays[place]))
            case Sweep():
                made.append(_until(network, place, node, made))
            case Shift():
                made.append(_shift(place, node, made[node.operand]))
    return made[-1]


def _delays(nodes: Sequence[Node], gap: int) -> list[Delay]:
    found: list[Delay] = []
    for node in nodes:
        match node:
            case Window(operand=operand, over=int(over)):
                one, every = int(node.every), int(not node.every)
                sides = [0, 0]
                sides[one] = node.low * gap + found[operand][one]
                sides[every] = over
                found.append((sides[0], sides[1]))
            case Junction():
                found.append(_joined(node, found))
            case Sweep(left=left, right=right, future=True):
                met, unmet = int(node.dual), int(not node.dual)
                sides = [0, 0]
                sides[met] = found[right][met]
                sides[unmet] = max(found[left][unmet], found[right][unmet])
                found.append((sides[0], sides[1]))
            case Shift(operand=operand, offset=offset) if offset >= 0:
                true, false = found[operand]
                found.append((offset * gap + true, offset * gap + false))
            case _:
                found.append((0, 0))
    return found


def _now(network: Knowledge) -> int:
    """The last position of which the letter is known."""
    positions = network.positions
    return min((network.grown - 1) // positions.slope, positions.last)


def _leaf(network: Knowledge, place: int, node: Leaf) -> Soonest:
    """A value that the letter does not have is watched for; one that it has goes on."""
    gap = network.positions.gap
    never = int(node.core.value) if isinstance(node.core, Constant) else None
    index = [place for place, _ in network.plan.leaves].index(place)
    known = network.known[place]

    def soonest(network: Knowledge, side: int, first: int, last: int) -> int:
        now = _now(network)
        position = max(first, now + 1)
        if position > last or side == never:
            return NEVER
        if position == now + 1 and around(known[1 - side], now) is not None:
            network.watched.append((index, not side))
            return NEVER
        return position * gap

    return soonest


def _window(network: Knowledge, place: int, node: Window, operand: Soonest) -> Soonest:
    gap, pending = network.positions.gap, network.pending
    low, high, over, one = node.low, node.high, node.over or 0, int(node.every)
    known = network.known[node.operand]

    def soonest(network: Knowledge, side: int, first: int, last: int) -> int:
        first = network.unknown_from(place, max(first, pending[place]))
        if first > last:
            return NEVER
        if side == one:
            return operand(network, side, first + low, last + high) if low <= high else NEVER
        waiting = (network.grown // 2 - over) // gap + 1
        if first >= waiting:
            return first * gap + over
        # It is over, and waits for its operand, as do later ones that share what is not known.
        found = operand(network, side, first + low, last + high)
        waiting, now = network.unknown_from(place, waiting), _now(network)
        for _ in range(_FEW):
            lacking = network.unknown_from(node.operand, waiting + low)
            if lacking > min(waiting + high, now):
                break
            waiting = min(_known_from(known, lacking), now + 1) - low
        return found if waiting > last else min(found, waiting * gap + over)

    return soonest


def _known_from(known: tuple[Ranges, Ranges], integer: int) -> int:
    """The first integer from one on that is known; `FAR` if there is none."""
    return min(next_in(known[0], integer), next_in(known[1], integer))


def _junction(
    network: Knowledge, place: int, node: Junction, made: Sequence[Soonest], delay: Delay
) -> Soonest:
    gap, pending, every = network.positions.gap, network.pending, int(not node.every)
    nodes = network.plan.nodes
    operands = [made[one] for one in node.operands]
    inner = [made[one] for one in node.operands if not isinstance(nodes[one], Leaf)]

    def soonest(network: Knowledge, side: int, first: int, last: int) -> int:
        first = network.unknown_from(place, max(first, pending[place]))
        if first > last:
            return NEVER
        if side != every:
            return min([operand(network, side, first, last) for operand in operands])
        # Up to now the leaves are known, and it is for the others.
        found = min([operand(network, side, first, last) for operand in inner], default=NEVER)
        position = max(first, _now(network) + 1)
        return found if position > last else min(found, position * gap + delay[side])

    return soonest


def _shift(place: int, node: Shift, operand: Soonest) -> Soonest:
    def soonest(network: Knowledge, side: int, first: int, last: int) -> int:
        first = network.unknown_from(place, max(first, network.pending[place]))
        if first > last:
            return NEVER
        return operand(network, side, first + node.offset, last + node.offset)

    return soonest


def _until(network: Knowledge, place: int, node: Sweep, made: Sequence[Soonest]) -> Soonest:
    met, unmet = int(node.dual), int(not node.dual)
    left, right = made[node.left], made[node.right]
    is_leaf = isinstance(network.plan.nodes[node.left], Leaf)
    meets, missed = network.known[node.right][met], network.known[node.right][unmet]
    cut = network.known[node.left][unmet]
    pending, swept = network.pending, network.swept

    def soonest(network: Knowledge, side: int, first: int, last: int) -> int:
        first = network.unknown_from(place, max(first, pending[place]))
        if first > last:
            return NEVER
        start, now = max(first, swept[place]), _now(network)
        if side == met:
            found = right(network, side, start, FAR)
            # Where it is met already, the way there is what it waits for.
            is_met = bool(meets) and meets[-1][1] >= start
            return found if is_leaf or not is_met else min(found, left(network, side, start, FAR))
        if not is_leaf:
            found = left(network, side, start, FAR)
            is_cut = bool(cut) and cut[-1][1] >= start
            return min(found, right(network, side, start, FAR)) if is_cut else found
        # What is known not to be met all the way up to now ends as soon as the way does; of what is
        # swept it may be forgotten that it is known.
        found = right(network, side, start, now)
        ends = last > now or swept[place] > now
        if not ends and (run := around(missed, now)) is not None:
            ends = network.unknown_from(place, max(first, run[0])) <= min(now, last)
        return min(found, left(network, side, now + 1, FAR)) if ends else found

    return soonest
