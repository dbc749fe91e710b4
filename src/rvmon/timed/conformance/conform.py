"""Whether a recorded run is one of a network's runs, as far as the recording shows.

All symbolic states that explain the recording so far are kept, with a clock for the time since its
start. For each recorded action: close under unrecorded moves, cut to the instant of the action give
or take the tolerance, take the moves with its label; a move with several labels stands for several
actions of one instant. No state left is the first divergence. After the last action the network
must be able to keep quiet until the recording's end.

Source: Krichen and Tripakis, Conformance Testing for Real-Time Systems, Formal Methods in System
Design 34, 2009, section 5 (state estimation); the end as quiescence, as in Tretmans' ioco.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby
from math import inf

from rvmon.timed.conformance.outcome import Allowed, Conformance, Divergence, Recorded
from rvmon.timed.model.network import Network
from rvmon.timed.model.refine import finer
from rvmon.timed.model.rules import model_error
from rvmon.timed.search.explore import Node, explore
from rvmon.timed.search.meter import Meter
from rvmon.timed.search.outcome import UNLIMITED, Budget
from rvmon.timed.zones.dbm import Zone, constrain, cut, normalise
from rvmon.timed.zones.discrete import Move, State
from rvmon.timed.zones.symbolic import Steps, check_clocks, check_start
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
        observed: labels that the recording would show; all others happen unseen. A move has
            the labels of all its edges and the name of its channel: it is recorded as all those of
            them that are observed, at one instant.
        end: ticks since the start; the recording goes on until then.
        tolerance: ticks by which an instant may be off either way.
        budget: when to give up, for each action.

    Raises:
        ModelError: the network has no such unit, or cannot start.
    """
    check_start(network)
    check_clocks(network)
    if network.unit is None or network.unit % RESOLUTION:
        fix = "write its unit of time, such as `unit 50 ms`"
        raise model_error("TA023", "time is not in whole milliseconds", None, fix)
    watcher = _Watcher(finer(network, network.unit // RESOLUTION), observed)
    states = list(watcher.start())
    explained = 0
    for t, group in groupby(actions, lambda action: action.t):
        labels = tuple(action.label for action in group)
        earliest, latest = (t - tolerance) // RESOLUTION, -(-(t + tolerance) // RESOLUTION)
        pending, rest = {labels: states}, labels
        while pending:
            rest = max(pending, key=len)
            states = pending.pop(rest)
            if not rest:
                break
            meter = Meter(budget, None)
            reached = watcher.quiet(states, latest, meter)
            if meter.stopped:
                return Conformance(explained + len(labels) - len(rest), None, meter.stopped)
            for left, after in watcher.fired(reached, rest, earliest, latest):
                pending.setdefault(left, []).append(after)
        explained += len(labels) - len(rest)
        if rest:
            allowed = watcher.allowed(states, end // RESOLUTION, Meter(budget, None))
            return Conformance(explained, Divergence(t, rest[0], allowed))
    meter = Meter(budget, None)
    earliest, latest = (end - tolerance) // RESOLUTION, -(-(end + tolerance) // RESOLUTION)
    if not watcher.reaches(states, earliest, latest, meter) and not meter.stopped:
        allowed = watcher.allowed(states, end // RESOLUTION, meter)
        return Conformance(len(actions), Divergence(end, "", allowed))
    return Conformance(len(actions), None, meter.stopped)


class _Quiet:
    """Moves that nobody sees, up to an instant."""

    def __init__(
        self,
        steps: Steps,
        begin: Sequence[tuple[State, Zone]],
        observed: frozenset[str],
        latest: int,
    ) -> None:
        self.steps = steps
        self.dim = steps.dim
        self.begin = begin
        self.observed = observed
        self.latest = latest

    def start(self) -> Sequence[tuple[State, Zone]]:
        """The states that explain the recording so far."""
        return self.begin

    def successors(self, site: State, zone: Zone) -> Iterator[tuple[Move, State, Zone]]:
        """Unseen moves before the instant is over."""
        dim = self.dim
        for move, state, fresh in self.steps.successors(site, zone):
            if not self.observed.isdisjoint(names_of(move, self.steps.space.network)):
                continue
            if constrain(fresh, dim, 0, dim - 1, float(self.latest)):
                yield move, state, normalise(fresh)


class _Watcher:
    """The network with a last clock that is never reset."""

    def __init__(self, network: Network, observed: frozenset[str]) -> None:
        # The timer is compared with every instant of the recording: it must never be blurred.
        timer = 1 + len(network.clocks)
        self._observed = observed
        self._network = network
        self._steps = Steps(network, 1, [(timer, -inf)], [(timer, inf)])
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
        self,
        states: Sequence[tuple[State, Zone]],
        labels: tuple[str, ...],
        earliest: int,
        latest: int,
    ) -> Iterator[tuple[tuple[str, ...], tuple[State, Zone]]]:
        """The states behind the first of some actions within a range of instants.

        Each comes with the actions that are left: a move with several names stands for all of them.
        """
        timer = self._dim - 1
        for state, zone in states:
            now = zone[:]
            if not cut(now, self._dim, [(timer, 0, -float(earliest)), (0, timer, float(latest))]):
                continue
            for move, target, fresh in self._steps.successors(state, now):
                left = _without(labels, self._seen(move))
                if left is not None:
                    yield left, (target, normalise(fresh))

    def _seen(self, move: Move) -> list[str]:
        return [name for name in names_of(move, self._network) if name in self._observed]

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
                seen, ready = self._seen(move), zone[:]
                if not seen or not cut(ready, self._dim, move.guard):
                    continue
                for label in seen:
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


def _without(labels: tuple[str, ...], names: Sequence[str]) -> tuple[str, ...] | None:
    """The actions left behind a move that is the first of them; `None` if it cannot be."""
    if labels[0] not in names:
        return None
    left = list(labels)
    for name in names:
        if name not in left:
            return None
        left.remove(name)
    return tuple(left)


def names_of(move: Move, network: Network) -> tuple[str, ...]:
    """The names that a move has in recordings: the labels of its edges, and its channel's."""
    first = move.edges[0]
    channel = network.channels[first.channels[0]].name if first.channels else ""
    names = (*(edge.edge.label for edge in move.edges), channel)
    return tuple(dict.fromkeys(name for name in names if name))
