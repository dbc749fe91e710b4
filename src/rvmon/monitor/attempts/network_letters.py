"""The letters of a delay network, by the truth of the state formulas that its leaves read."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Sequence
from operator import itemgetter

from rvmon.dataflow.journal import Journal
from rvmon.dataflow.network import Network
from rvmon.dataflow.nodes import NetworkPlan
from rvmon.formula.core import Constant, Sense
from rvmon.formula.state import FALSE, TRUE, UNKNOWN
from rvmon.plan.graph import Graph

Letters = tuple[Sequence[bool], Sequence[bool]]
"""The truth of a plan's leaves, the unknown taken for the worse and for the better."""

Noted = tuple[int, Sequence[bool]]
"""An instant and the letter from there on."""

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


_LEAST = 64
"""So many letters are noted at least before it is looked which of them still matter."""


class Clear:
    """The letters since nothing is unknown, as far as they may matter.

    Args:
        reach: ticks after which a position does not matter any more; `None`: none are noted.
        gap: ticks between two positions; `None` if only samples are positions.
    """

    def __init__(self, reach: int | None, gap: int | None) -> None:
        self._reach, self._gap = reach, gap
        self.forget()

    def forget(self) -> None:
        """Begin anew."""
        self.noted: list[Noted] = []
        self._most = _LEAST

    def note(self, t: int, letters: Letters) -> None:
        """Take the letters at a position."""
        if letters[0] != letters[1] or self._reach is None:
            self.noted.clear()
            return
        noted = self.noted
        if not noted or noted[-1][1] != letters[0] or self._gap is None:
            noted.append((t, letters[0]))
        if len(noted) > self._most:
            self._forget_before(t - self._reach)

    def _forget_before(self, t: int) -> None:
        """Keep the letters from `t` on; where all instants are positions, the first one at `t`."""
        noted = self.noted
        count = max(bisect_right(noted, t, key=itemgetter(0)), 1)
        at, letter = noted[count - 1]
        self.noted = [(at if self._gap is None else max(t, at), letter), *noted[count:]]
        self._most = _LEAST + 2 * len(self.noted)

    def is_over(self, t: int) -> bool:
        """Whether at `t` all that was unknown is too long ago to matter."""
        return self._reach is not None and bool(self.noted) and t - self.noted[0][0] > self._reach


def journal_of(
    plan: NetworkPlan, gap: int | None, noted: Sequence[Noted], first: int | None
) -> Journal:
    """A journal of the letters that attempts may depend on.

    Args:
        plan: of the network.
        gap: ticks between two positions; `None` if only samples are positions.
        noted: the letters.
        first: the instant of the first position that is waited for; `None`: none is.
    """
    t, letter = noted[0]
    network = Network(plan, gap)
    if first is not None and first < t:
        network.begin_at(t // (gap or 1), first // (gap or 1), letter)
    return Journal(network, noted)
