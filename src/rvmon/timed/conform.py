"""Whether a recorded run is one of a network's runs, as far as the recording shows.

All symbolic states that explain the recording so far are kept, with a clock for the time since its
start. For each recorded action: close under unrecorded moves, cut to the instant of the action give
or take the tolerance, take the moves with its label. No state left is the first divergence. After
the last action the network must be able to keep quiet until the recording's end.

Source: Krichen and Tripakis, Conformance Testing for Real-Time Systems, Formal Methods in System
Design 34, 2009, section 5 (state estimation); the end as quiescence, as in Tretmans' ioco.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import inf

from rvmon.timed.conformance import Allowed, Conformance, Divergence, Recorded
from rvmon.timed.discrete import Move, State
from rvmon.timed.explore import explore
from rvmon.timed.meter import Meter
from rvmon.timed.model import Constant, Network
from rvmon.timed.pieces import Piece
from rvmon.timed.refine import finer
from rvmon.timed.rules import model_error
from rvmon.timed.search import UNLIMITED, Budget, Node
from rvmon.timed.start import check_start
from rvmon.timed.symbolic import Steps
from rvmon.timed.zones import Zone, constrain, cut, normalise
from rvmon.trace.time import TICKS_PER_UNIT

RESOLUTION = TICKS_PER_UNIT["ms"]
"""Instants of recordings are rounded to this, outwards."""


def conform(
    network: Network,
    actions: Sequence[Recorded],
    *,
    observed: frozenset[str],
    end: int,
    tolerance: int,
    budget: Budget = UNLIMITED,
) -> Conformance:
    """Hold one recording against a network.

    Args:
        network: with a unit of time that is a whole number of milliseconds.
        actions: in order of time; all their labels are observed.
        observed: labels that the recording would show; all others happen unseen. The label of a
            move is that of its first edge with one, else the name of its channel.
        end: ticks since the start; the recording goes on until then.
        tolerance: ticks by which an instant may be off either way.
        budget: when to give up, for each action.

    Raises:
        ModelError: the network has no such unit, or cannot start.
    """
    check_start(network)
    if network.unit is None or network.unit % RESOLUTION:
        mend = "write its unit of time, such as `unit 50 ms`"
        raise model_error("TA023", "time is not in whole milliseconds", None, mend)
    watcher = _Watcher(finer(network, network.unit // RESOLUTION), observed)
    states = list(watcher.start())
    for number, action in enumerate(actions):
        earliest = (action.t - tolerance) // RESOLUTION
        latest = -(-(action.t + tolerance) // RESOLUTION)
        meter = Meter(budget, None)
        reached = watcher.quiet(states, latest, meter)
        if meter.stopped:
            return Conformance(number, None, meter.stopped)
        after = list(watcher.fired(reached, action.label, earliest, latest))
        if not after:
            allowed = watcher.allowed(states, end // RESOLUTION, meter)
            return Conformance(number, Divergence(action.t, action.label, allowed))
        states = after
    meter = Meter(budget, None)
    earliest, latest = (end - tolerance) // RESOLUTION, -(-(end + tolerance) // RESOLUTION)
    if not watcher.reaches(states, earliest, latest, meter) and not meter.stopped:
        allowed = watcher.allowed(states, end // RESOLUTION, meter)
        return Conformance(len(actions), Divergence(end, "", allowed))
    return Conformance(len(actions), None, meter.stopped)


@dataclass(frozen=True, slots=True)
class _Quiet:
    """Moves that nobody sees, up to an instant."""

    steps: Steps
    begin: Sequence[tuple[State, Zone]]
    observed: frozenset[str]
    latest: int

    @property
    def dim(self) -> int:
        """One more than the number of clocks, the timer included."""
        return self.steps.dim

    def start(self) -> Sequence[tuple[State, Zone]]:
        """The states that explain the recording so far."""
        return self.begin

    def successors(self, site: State, zone: Zone) -> Iterator[tuple[Move, State, Zone]]:
        """Unseen moves before the instant is over."""
        dim = self.dim
        for move, state, fresh in self.steps.successors(site, zone):
            if label_of(move, self.steps.space.network) in self.observed:
                continue
            if constrain(fresh, dim, 0, dim - 1, float(self.latest)):
                yield move, state, normalise(fresh)

    def goal(self, _site: State, _zone: Zone) -> Piece | None:
        """Nothing: all states are wanted."""
        return None


class _Watcher:
    """The network with a last clock that is never reset."""

    def __init__(self, network: Network, observed: frozenset[str]) -> None:
        # The timer is compared with every instant of the recording: it must never be blurred.
        timer = 1 + len(network.clocks)
        self._observed = observed
        self._network = network
        self._steps = Steps(network, Constant(1), 1, [(timer, -inf)], [(timer, inf)])
        self._dim = self._steps.dim

    def start(self) -> Iterator[tuple[State, Zone]]:
        """The initial state."""
        return self._steps.start()

    def quiet(
        self, states: Sequence[tuple[State, Zone]], latest: int, meter: Meter
    ) -> list[tuple[State, Zone]]:
        """All states that unseen moves lead to, up to an instant."""
        begin = []
        for state, zone in states:
            cut_zone = zone[:]
            if constrain(cut_zone, self._dim, 0, self._dim - 1, float(latest)):
                begin.append((state, normalise(cut_zone)))
        kept: list[Node[State, Move]] = []
        problem = _Quiet(self._steps, begin, self._observed, latest)
        explore(problem, meter, kept.append)
        return [(node.site, node.zone) for node in kept if not node.covered]

    def fired(
        self, states: Sequence[tuple[State, Zone]], label: str, earliest: int, latest: int
    ) -> Iterator[tuple[State, Zone]]:
        """The states behind an action within a range of instants."""
        timer = self._dim - 1
        for state, zone in states:
            now = zone[:]
            if not cut(now, self._dim, [(timer, 0, -float(earliest)), (0, timer, float(latest))]):
                continue
            for move, target, fresh in self._steps.successors(state, now):
                if label_of(move, self._network) == label:
                    yield target, normalise(fresh)

    def reaches(
        self, states: Sequence[tuple[State, Zone]], earliest: int, latest: int, meter: Meter
    ) -> bool:
        """Whether some run can be quiet until an instant of a range."""
        timer = self._dim - 1
        return any(
            constrain(zone[:], self._dim, timer, 0, -float(earliest))
            for _, zone in self.quiet(states, latest, meter)
        )

    def allowed(
        self, states: Sequence[tuple[State, Zone]], end: int, meter: Meter
    ) -> tuple[Allowed, ...]:
        """What some run can do next, with the earliest and the latest instant of each."""
        timer = self._dim - 1
        spans: dict[str, tuple[float, float]] = {}
        for state, zone in self.quiet(states, end, meter):
            for move in self._steps.space.moves(state):
                label, ready = label_of(move, self._network), zone[:]
                if label in self._observed and cut(ready, self._dim, move.guard):
                    low, high = spans.get(label, (inf, 0.0))
                    spans[label] = (
                        min(low, -ready[timer * self._dim]), max(high, ready[timer])
                    )  # fmt: skip
        found = [
            Allowed(label, round(low) * RESOLUTION, round(high) * RESOLUTION)
            for label, (low, high) in sorted(spans.items(), key=lambda item: item[1])
        ]
        if self.reaches(states, end, end, meter):
            found.append(Allowed("", end * RESOLUTION, None))
        return tuple(found)


def label_of(move: Move, network: Network) -> str:
    """The name that a move has in recordings; empty if it has none."""
    for edge in move.edges:
        if edge.edge.label:
            return edge.edge.label
    first = move.edges[0]
    return network.channels[first.channels[0]].name if first.channels else ""
