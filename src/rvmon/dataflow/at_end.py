"""What the rule for the end of a trace makes of what a network knows."""

from __future__ import annotations

from collections.abc import Sequence

from rvmon.dataflow.evaluate import evaluated
from rvmon.dataflow.network import Network
from rvmon.dataflow.nodes import Leaf, Shift, Sweep, operands_of
from rvmon.dataflow.piecewise import FAR, PAST, Pieces, as_past, clip, soonest, stamp, up_to
from rvmon.dataflow.sweep import Carried, Known


def held_at_end(network: Network, end: int, reached: int) -> Pieces:
    """The positions at which the rule for the end of a trace makes the formula true.

    To be asked last: the network learns that no position comes behind the end.

    Args:
        network: what is known.
        end: the last instant of the trace.
        reached: the instant that time has come to.

    Source: SEMANTICS 3, The end.
    """
    limit = max(2 * reached, 2 * end + 1)
    network.grow(limit)
    network.positions.end(end // network.positions.gap)
    held: list[Pieces] = []
    for place, node in enumerate(network.plan.nodes):
        true: Pieces = up_to(network.pieces(place)[0], limit)
        if not isinstance(node, Leaf):
            found = up_to(
                _at_end(network, place, [(held[o], ()) for o in operands_of(node)]), limit
            )
            if isinstance(node, Shift):
                found = clip(found, -FAR, (end - node.opens) // network.positions.gap)
            true = soonest(true, clip(found, network.pending[place]))
        held.append(as_past(true))
    return held[-1]


def _at_end(network: Network, place: int, operands: Sequence[Known]) -> Pieces:
    """Where a node is true, if all is well behind the end that only has to be kept up."""
    node, pending = network.plan.nodes[place], network.pending[place]
    if not isinstance(node, Sweep):
        return evaluated(node, operands, network.positions, (pending, FAR), None)[0]
    start = network.swept[place]
    edge: Carried = network.carried[place]
    if node.future:
        edge = (True, PAST) if node.kept else None
    true, _ = evaluated(node, operands, network.positions, (start, FAR), edge)
    if node.future and stamp(true, start) is not None:
        # What lies between only leads on to `start`.
        true = soonest(true, ((min(pending, start), start, PAST, 0),))
    return true
