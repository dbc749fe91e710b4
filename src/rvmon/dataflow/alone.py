"""What time alone makes of what a network knows, if no further position comes."""

from __future__ import annotations

from rvmon.dataflow.evaluate import evaluated
from rvmon.dataflow.network import Network
from rvmon.dataflow.nodes import Leaf, Sweep, operands_of
from rvmon.dataflow.pieces import FAR, Pieces, clip, soonest, stamp, up_to
from rvmon.dataflow.sweep import Carried, Known


def settled_alone(network: Network, position: int, limit: int) -> tuple[int, bool] | None:
    """The value of the formula at a position, and the last instant before time alone settles it.

    Args:
        network: what is known.
        position: as the network counts them; its value is not known at `limit`.
        limit: the stamp behind which nothing more comes.

    Returns:
        `None` if time alone does not settle it.

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
    for value, pieces in zip((True, False), known[-1], strict=True):
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
