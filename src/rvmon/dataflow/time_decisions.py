"""What time alone makes of what a network knows, if no further position comes."""

from __future__ import annotations

from functools import cached_property

from rvmon.dataflow.evaluate import evaluated
from rvmon.dataflow.network import Network
from rvmon.dataflow.nodes import Leaf, Shift, Sweep, Window, operands_of
from rvmon.dataflow.piecewise import FAR, Pieces, clip, soonest, stamp, up_to
from rvmon.dataflow.positions import Positions
from rvmon.dataflow.ranges import Range
from rvmon.dataflow.sweep import Carried, Known


class Moment:
    """How a network stands once time has come to a stamp, for all that is asked of it then.

    Args:
        network: what is known; it stays as it is.
        now: the stamp.

    Attributes:
        network: what is known then.
    """

    def __init__(self, network: Network, now: int) -> None:
        self.network = network.copy()
        self.network.grow(now)

    @cached_property
    def alone(self) -> Known:
        """What comes to be known of the formula if no further position comes."""
        return known_alone(self.network, self.network.grown)


def known_alone(network: Network, limit: int, on: Range = (-FAR, FAR)) -> Known:
    """What comes to be known of the formula if no position comes behind a stamp.

    Args:
        network: what is known.
        limit: the stamp.
        on: the positions that are asked for.

    Source: SEMANTICS 2, Truth after a prefix.
    """
    positions = network.positions.copy()
    positions.end((limit - 1) // positions.slope)
    asked = _asked(network, positions, limit, on)
    known: list[Known] = []
    for place, node in enumerate(network.plan.nodes):
        if asked[place][0] > asked[place][1]:
            known.append(((), ()))
            continue
        true, false = (up_to(side, limit) for side in network.pieces(place, asked[place]))
        if not isinstance(node, Leaf):
            operands = [known[operand] for operand in operands_of(node)]
            found = _evaluated(network, positions, place, operands, asked[place])
            true, false = soonest(true, found[0]), soonest(false, found[1])
        known.append((true, false))
    return known[-1]


def _asked(network: Network, positions: Positions, limit: int, on: Range) -> list[Range]:
    """Per node, the integers that matter for the formula on a stretch."""
    nodes = network.plan.nodes
    asked: list[Range] = [(FAR, -FAR)] * len(nodes)
    asked[-1] = on
    for place in range(len(nodes) - 1, -1, -1):
        node, (first, last) = nodes[place], asked[place]
        if first > last:
            continue
        low = high = 0
        if isinstance(node, Window):
            low, high = node.low, node.high
        elif isinstance(node, Shift):
            low = high = node.offset
        elif isinstance(node, Sweep) and node.future:
            first, last = (max(end, network.swept[place]) for end in (first, last))
            cut = network.side(node.left, not node.dual, (last, FAR))
            last = _first_of(cut, positions, last, limit)
        elif isinstance(node, Sweep):
            first = network.swept[place]
        first, last = max(first + low, -FAR), min(last + high, FAR)
        for operand in operands_of(node):
            its_first, its_last = asked[operand]
            asked[operand] = min(first, its_first), max(last, its_last)
        if isinstance(node, Sweep):
            asked[place] = min(asked[place][0], first), max(asked[place][1], last)
    return asked


def _first_of(pieces: Pieces, positions: Positions, integer: int, limit: int) -> int:
    """The first position from an integer on at which something is known at a stamp; or `FAR`."""
    for left, right, at, slope in clip(pieces, integer):
        position = positions.following(max(left, integer))
        if position <= min(right, positions.last) and at + slope * position <= limit:
            return position
    return FAR


def settled(alone: Known, position: int) -> tuple[int, bool] | None:
    """The last instant before time alone settles the formula at a position, and its value then.

    Args:
        alone: as `known_alone` gives it, for a stamp at which the value is not known.
        position: as the network counts them.

    Returns:
        `None` if time alone does not settle it.
    """
    for value, pieces in zip((True, False), alone, strict=True):
        if (found_at := stamp(pieces, position)) is not None:
            return found_at // 2 - 1, value
    return None


def _evaluated(
    network: Network, positions: Positions, place: int, operands: list[Known], on: Range
) -> Known:
    node, first = network.plan.nodes[place], max(network.pending[place], on[0])
    if first > on[1]:
        return (), ()
    if not isinstance(node, Sweep):
        return evaluated(node, operands, positions, (first, on[1]), None)
    start = max(network.swept[place], first) if node.future else network.swept[place]
    edge: Carried = None if node.future else network.carried[place]
    true, false = evaluated(node, operands, positions, (start, max(on[1], start)), edge)
    if node.future and first < start:
        # What lies between only leads on to `start`.
        true, false = _led_on(true, first, start), _led_on(false, first, start)
    return clip(true, first), clip(false, first)


def _led_on(pieces: Pieces, first: int, start: int) -> Pieces:
    """With the value at `start` from `first` on."""
    at = stamp(pieces, start)
    return pieces if at is None else soonest(pieces, ((first, start - 1, at, 0),))
