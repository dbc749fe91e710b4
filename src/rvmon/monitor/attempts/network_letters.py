"""The letters of a delay network, by the truth of the state formulas that its leaves read."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from operator import itemgetter

from rvmon.dataflow.nodes import NetworkPlan
from rvmon.formula.core import Constant, Sense
from rvmon.formula.state import FALSE, TRUE, UNKNOWN
from rvmon.plan.graph import Graph

Letters = tuple[Sequence[bool], Sequence[bool]]
"""The truth of a plan's leaves, the unknown taken for the worse and for the better."""

_MOST = 256
"""So many letters are kept."""

_VALUES = (FALSE, UNKNOWN, TRUE)

_TRUTHS = {
    sense: (
        tuple(value == (TRUE if sense is Sense.TRUE else FALSE) for value in _VALUES),
        tuple(
            value == (TRUE if sense is Sense.TRUE else FALSE)
            or (value == UNKNOWN and sense is not Sense.KNOWN_FALSE)
            for value in _VALUES
        ),
    )
    for sense in Sense
}
"""By sense and value, whether a leaf is true, the unknown taken for the worse and the better."""


def letter_reader(plan: NetworkPlan, graph: Graph) -> Callable[[Sequence[int]], Letters]:
    """What gives the letters.

    Args:
        plan: of the network.
        graph: the state formulas, of whose values it is a function.
    """
    reads = tuple(
        (-1, (core.value,), (core.value,))
        if isinstance(core, Constant)
        else (graph.index[core.proposition], *_TRUTHS[core.sense])
        for _, core in plan.leaves
    )

    made: dict[object, Letters] = {}
    places = {place for place, _, _ in reads if place >= 0}
    seen: Callable[[Sequence[int]], object] = itemgetter(*places) if places else len

    def read(values: Sequence[int]) -> Letters:
        key = seen(values)
        found = made.get(key)
        if found is None:
            if len(made) >= _MOST:
                made.clear()
            found = made[key] = (
                tuple([worse[values[place] if place >= 0 else 0] for place, worse, _ in reads]),
                tuple([better[values[place] if place >= 0 else 0] for place, _, better in reads]),
            )
        return found

    return read
