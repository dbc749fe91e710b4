"""What becomes known of a node of a network, from what became known of its operands.

Each function binds a node of one network to the lists that hold what is known of it and of its
operands, and returns what works out its news. A position is reported once.
"""

from __future__ import annotations

from collections.abc import Callable

from rvmon.dataflow.knowledge import Knowledge, add_news
from rvmon.dataflow.nodes import Junction, Shift
from rvmon.dataflow.piecewise import EVER, Pieces, clip, latest, shift, soonest
from rvmon.dataflow.ranges import merged, on_stretch, outside, within

Work = Callable[[int, int], None]
"""Works out the news of a node from one stamp to another."""


def junction_work(network: Knowledge, place: int, node: Junction) -> Work:
    """All of the operands, or one of them."""
    some, every = int(node.every), int(not node.every)
    news, known = network.news, network.known
    own_some, own_every = known[place][some], known[place][every]
    out_some, out_every = 2 * place + some, 2 * place + every
    some_of = [2 * operand + some for operand in node.operands]
    every_of = [(2 * operand + every, known[operand][every]) for operand in node.operands]

    def work(_before: int, _limit: int) -> None:
        pieces: Pieces = ()
        for index in some_of:
            if found := news[index]:
                pieces = soonest(pieces, found) if pieces else found
        if pieces:
            add_news(news, out_some, own_some, outside(pieces, own_some))
        changed = [index for index, _ in every_of if news[index]]
        if len(changed) == 1 or (len(changed) == 2 and _apart(*map(news.__getitem__, changed))):
            for index in changed:
                add_news(news, out_every, own_every, where_all(index))
        elif changed:
            for on in merged(piece[:2] for index in changed for piece in news[index]):
                pieces = clip(EVER, *on)
                for index, ranges in every_of:
                    pieces = latest(pieces, on_stretch(ranges, news[index], on))
                add_news(news, out_every, own_every, pieces)

    def where_all(index: int) -> Pieces:
        """Where the others are known, too, of what became known of one operand."""
        pieces = news[index]
        for other, ranges in every_of:
            if other != index:
                if not ranges or ranges[-1][1] < pieces[0][0]:
                    return ()
                if not (pieces := within(pieces, ranges)):
                    return ()
        return pieces

    return work


def _apart(one: Pieces, other: Pieces) -> bool:
    """Whether all positions of one are before those of the other."""
    return one[-1][1] < other[0][0] or other[-1][1] < one[0][0]


def shift_work(network: Knowledge, place: int, node: Shift) -> Work:
    """The operand further on."""
    news, positions = network.news, network.positions
    sides = [
        (2 * node.operand + side, 2 * place + side, network.known[place][side]) for side in (0, 1)
    ]

    def work(_before: int, _limit: int) -> None:
        for given, out, own in sides:
            if news[given]:
                found = positions.cells(shift(news[given], node.offset))
                add_news(news, out, own, outside(found, own))

    return work
