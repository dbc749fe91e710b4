"""What time alone makes of what a network knows, if no further position comes."""

from __future__ import annotations

from functools import cached_property

from rvmon.dataflow.evaluate import evaluated
from rvmon.dataflow.network import Network
from rvmon.dataflow.nodes import Leaf, Sweep, operands_of
from rvmon.dataflow.pieces import FAR, Pieces, clip, soonest, stamp, up_to
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


def known_alone(network: Network, limit: int) -> Known:
    """What comes to be known of the formula if no position comes behind a stamp.

    Source: SEMANTICS 2, Truth after a prefix.
    """
    ahead = network.copy()
    ahead.positions.end((limit - 1) // ahead.positions.slope)
    known: list[Known] = []
    for place, node in enumerate(ahead.plan.nodes):
        true, false = (up_to(pieces, limit) for pieces in ahead.known[place])
        if not isinstance(node, Leaf):
            found = _evaluated(ahead, place, [known[operand] for operand in operands_of(node)])
            true, false = soonest(true, found[0]), soonest(false, found[1])
        known.append((true, false))
    return known[-1]


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


def _evaluated(network: Network, place: int, operands: list[Known]) -> Known:
    node, pending = network.plan.nodes[place], network.pending[place]
    if not isinstance(node, Sweep):
        return evaluated(node, operands, network.positions, (pending, FAR), None)
    start = network.swept[place]
    edge: Carried = None if node.future else network.carried[place]
    true, false = evaluated(node, operands, network.positions, (start, FAR), edge)
    if node.future and pending < start:
        # What lies between only leads on to `start`.
        true, false = _led_on(true, pending, start), _led_on(false, pending, start)
    return clip(true, pending), clip(false, pending)


def _led_on(pieces: Pieces, first: int, start: int) -> Pieces:
    """With the value at `start` from `first` on."""
    at = stamp(pieces, start)
    return pieces if at is None else soonest(pieces, ((first, start - 1, at, 0),))
