"""Whether a network has a run that explains a recording.

The recording becomes an automaton that watches the network. It waits for each action in turn, and
compares a clock that is never reset with the instant of the action, plus or minus the tolerance. It
ignores moves without observed labels; a move with several labels explains several actions of one
instant. The first divergence is the first action that no run reaches. After the last action the
network must be able to stay silent until the end of the recording.

Source: Krichen and Tripakis, Conformance Testing for Real-Time Systems, Formal Methods in System
Design 34, 2009, section 5 (state estimation). Silence at the end is quiescence as in Tretmans'
ioco.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import combinations, groupby

from rvmon.models import model_error
from rvmon.models.network import Network, check_clocks
from rvmon.models.network import expressions as ex
from rvmon.models.network.derived import Watcher, finer
from rvmon.models.network.evaluate import Evaluator
from rvmon.models.network.guards import conjunction
from rvmon.models.runs import Action, Position, Run
from rvmon.models.runs.moves import check_start
from rvmon.models.search.budget import UNLIMITED, Budget, Meter
from rvmon.models.search.native_search import seek
from rvmon.models.search.search_plan import Seek, Sought
from rvmon.trace.sample import Sample
from rvmon.trace.time import TICKS_PER_UNIT

RESOLUTION = TICKS_PER_UNIT["ms"]  # instants of recordings are rounded to this, outwards


@dataclass(frozen=True, slots=True)
class Allowed:
    """An action that the network allows at a divergence."""

    label: str  # of the action; empty: nothing more until the end of the recording
    earliest: int  # ticks since the start
    latest: int | None  # ticks; `None` if there is no latest instant


@dataclass(frozen=True, slots=True)
class Divergence:
    """The point at which a recording stops being a run of the network."""

    at: int  # ticks since the start
    # the action that no run can do at this instant; empty at the end of the recording, if every run
    # would have done something before
    label: str
    allowed: tuple[Allowed, ...]  # the actions possible at this point


@dataclass(frozen=True, slots=True)
class Conformance:
    """The answer for one recording."""

    explained: int  # number of leading actions that one run of the network does at these instants
    divergence: Divergence | None  # `None` if the recording conforms
    undecided: str = ""  # the budget that ended the search; empty if the search was complete

    @property
    def conforms(self) -> bool | None:
        """Whether some run explains the whole recording; `None` if this was not decided."""
        return None if self.undecided else self.divergence is None


def conform(
    network: Network,
    actions: Sequence[Recorded],
    *,
    observed: frozenset[str],
    end: int,
    tolerance: int,
    budget: Budget = UNLIMITED,
) -> Conformance:
    """Compare one recording with a network.

    Args:
        network: with a unit of time that is a whole number of milliseconds.
        actions: in order of time; all their labels are in `observed`.
        observed: labels that the recording would show; all other labels stay invisible. A move has
            the labels of all its edges and the name of its channel, and is recorded as one action
            for each observed label, all at one instant.
        end: ticks from the start to the end of the recording.
        tolerance: ticks by which an instant may deviate in either direction.
        budget: limits of the search for a run, and of the search for the actions allowed instead.

    Raises:
        ModelError: the network has no such unit, cannot start, or the recording is too long.
    """
    check_start(network)
    check_clocks(network)
    if network.unit is None or network.unit % RESOLUTION:
        fix = "write its unit of time, such as `unit 50 ms`"
        raise model_error("TA023", "time is not in whole milliseconds", None, fix)
    if end + tolerance >= ex.MAX_TIME * RESOLUTION:
        fix = "compare a shorter part, with --until"
        raise model_error("TA019", "the recording is longer than 24 days", None, fix)
    fine, labels = finer(network, network.unit // RESOLUTION), tuple(sorted(observed))
    most = len(network.automata) + 1
    chain, meter = _chain_of(actions, end, tolerance, most), Meter(budget, None)
    watcher = _follower(fine, labels, chain, most)
    over = watcher.add_location()  # the end, after the last place
    bound = ex.ClockCompare(watcher.clock, ex.ClockOp.GE, ex.Constant(max(0, chain[-1].earliest)))
    watcher.add_edge(over - 1, over, ex.TRUE, [bound], watches=False)
    spans = seek(watcher.network(), Sought(Seek.GOAL, ex.FALSE), meter).spans
    if over in spans:
        return Conformance(len(actions), None)
    reached = max(spans, default=0)  # places are in order of progress
    place = chain[reached]
    if meter.stopped:
        return Conformance(place.explained, None, meter.stopped)
    # Actions possible at the divergence, up to the end of the recording.
    ahead = [*chain[:reached], replace(place, latest=end // RESOLUTION, left=())]
    allowed = _allowed(fine, labels, ahead, most, Meter(budget, None))
    label = place.left[0] if place.left else ""
    return Conformance(place.explained, Divergence(place.t, label, allowed))


@dataclass(frozen=True, slots=True)
class _Place:
    """A position in a recording, at which some run has explained everything before."""

    t: int  # the instant of the next actions, in ticks
    left: tuple[str, ...]  # the actions of this instant not explained yet; none at the end
    explained: int  # the number of actions explained so far
    # earliest, latest: the instant minus and plus the tolerance, in milliseconds
    earliest: int
    latest: int
    next: int | None  # index of the first place after this instant; `None` at the end


def _chain_of(actions: Sequence[Recorded], end: int, tolerance: int, most: int) -> list[_Place]:
    """The places of a recording. Those of one instant are adjacent, with fewer and fewer left."""
    chain: list[_Place] = []
    explained = 0

    def add(t: int, choices: Sequence[tuple[str, ...]], *, last: bool = False) -> None:
        earliest, latest = (t - tolerance) // RESOLUTION, -(-(t + tolerance) // RESOLUTION)
        after = None if last else len(chain) + len(choices)
        for left in choices:
            done = explained + len(choices[0]) - len(left)
            chain.append(_Place(t, left, done, earliest, latest, after))

    for t, group in groupby(actions, lambda action: action.t):
        labels = tuple(action.label for action in group)
        add(t, sorted(_remainders(labels, most), key=len, reverse=True))
        explained += len(labels)
    add(end, [()], last=True)
    return chain


def _remainders(labels: tuple[str, ...], most: int) -> set[tuple[str, ...]]:
    """The sets of actions of one instant that may remain, from all of them down to a single one."""
    found, waiting = {labels}, [labels]
    while waiting:
        for _, left in _first_moves(waiting.pop(), most):
            if left and left not in found:
                found.add(left)
                waiting.append(left)
    return found


def _first_moves(
    labels: tuple[str, ...], most: int
) -> list[tuple[tuple[str, ...], tuple[str, ...]]]:
    """Sets of at most `most` names by which one move explains the first action; what remains."""
    found = []
    others = tuple(dict.fromkeys(name for name in labels[1:] if name != labels[0]))
    for count in range(min(len(others), most - 1) + 1):
        for more in combinations(others, count):
            left = list(labels)
            for name in (labels[0], *more):
                left.remove(name)
            found.append(((labels[0], *more), tuple(left)))
    return found


def _follower(
    network: Network, labels: Sequence[str], chain: Sequence[_Place], most: int
) -> Watcher:
    """Build the automaton that follows a recording up to the last of the given places."""
    watcher = Watcher(network, labels, [""])
    for place in chain:
        until = ex.ClockCompare(watcher.clock, ex.ClockOp.LE, ex.Constant(place.latest))
        watcher.add_location([until])
    numbers = {(place.t, place.left): number for number, place in enumerate(chain)}
    named: dict[tuple[str, ...], ex.Expression] = {(): _has_exactly(watcher, labels, ())}
    for number, place in enumerate(chain):
        watcher.add_edge(number, number, named[()])
        since = ex.ClockCompare(watcher.clock, ex.ClockOp.GE, ex.Constant(max(0, place.earliest)))
        for names, left in _first_moves(place.left, most) if place.left else ():
            target = numbers.get((place.t, left)) if left else place.next
            if target is not None and target < len(chain):
                when = named.setdefault(names, _has_exactly(watcher, labels, names))
                watcher.add_edge(number, target, when, [since])
    return watcher


def _has_exactly(watcher: Watcher, labels: Iterable[str], names: Sequence[str]) -> ex.Expression:
    """Whether a move has exactly these of the observed names."""
    return conjunction(
        watcher.has(name) if name in names else ex.UnaryOperation(ex.UnaryOp.NOT, watcher.has(name))
        for name in labels
    )


def _allowed(
    network: Network, labels: Sequence[str], chain: Sequence[_Place], most: int, meter: Meter
) -> tuple[Allowed, ...]:
    """The actions possible at the last place, each with its earliest and latest instant."""
    watcher, last = _follower(network, labels, chain, most), len(chain) - 1
    end = ex.ClockCompare(watcher.clock, ex.ClockOp.GE, ex.Constant(chain[-1].latest))
    names = {watcher.add_location(kind=ex.LocationKind.URGENT): label for label in labels}
    for place, label in names.items():
        watcher.add_edge(last, place, watcher.has(label))
        # These loops only matter for their bounds, which keep the clock exact up to `end` here.
        for op in (ex.ClockOp.GE, ex.ClockOp.LE):
            watcher.add_edge(place, place, ex.TRUE, [replace(end, op=op)], watches=False)
    over = watcher.add_location(kind=ex.LocationKind.URGENT)
    watcher.add_edge(last, over, ex.TRUE, [end], watches=False)
    spans = seek(watcher.network(), Sought(Seek.GOAL, ex.FALSE), meter).spans
    found = [
        Allowed(names[place], round(low) * RESOLUTION, round(high) * RESOLUTION)
        for place, (low, high) in sorted(spans.items(), key=lambda one: one[1])
        if place in names
    ]
    if over in spans:
        found.append(Allowed("", chain[-1].latest * RESOLUTION, None))
    return tuple(found)


@dataclass(frozen=True, slots=True)
class Recorded:
    """An action of a recording: its label, and its instant in ticks since the start."""

    t: int
    label: str


def labels_of(network: Network) -> tuple[str, ...]:
    """All names that the actions of a network may have in recordings, in order of appearance."""
    names = dict.fromkeys(
        name
        for automaton in network.automata
        for edge in automaton.edges
        for name in (edge.label, network.channels[edge.sync.slot.first].name if edge.sync else "")
    )
    return tuple(name for name in names if name)


def actions_in(
    samples: Iterable[Sample], labels: frozenset[str]
) -> tuple[list[Recorded], int, frozenset[str]]:
    """The actions of a recording that have one of some labels.

    Returns:
        The actions with their ticks since the first sample; the ticks from the first to the last
        sample; the labels that occurred.
    """
    actions: list[Recorded] = []
    first = last = None
    for sample in samples:
        first = sample.t if first is None else first
        last = sample.t
        actions += [
            Recorded(sample.t - first, name)
            for name, value in sample.values.items()
            if name in labels and value is not None and value is not False
        ]
    length = 0 if first is None or last is None else last - first
    return actions, length, frozenset(action.label for action in actions)


def recording_of(
    network: Network, run: Run, signals: Mapping[str, Evaluator]
) -> tuple[list[Sample], int]:
    """A run as it would be recorded: its signals at each action, the actions' labels as events.

    The network has a unit of time; `signals` are expressions over its locations and variables.

    Returns:
        The samples, actions at one instant in one of them; the instant at which the run ends.
    """

    def read(position: Position) -> dict[str, int]:
        return {n: value(position.locations, position.values) for n, value in signals.items()}

    unit, now = network.unit or 1, Fraction(0)
    samples: dict[int, dict[str, int | bool]] = {0: {**read(run.start)}}
    for step in run.steps:
        now += step.delay
        if step.action is not None:
            at = samples.setdefault(round(now * unit), {})
            at.update(read(step.position) | dict.fromkeys(_names(network, step.action), True))
    return [Sample(t, values) for t, values in samples.items()], round(now * unit)


def _names(network: Network, action: Action) -> list[str]:
    sync = action.edges[0][1].sync
    channel = network.channels[sync.slot.first].name if sync is not None else ""
    return [name for name in (*(edge.label for _, edge in action.edges), channel) if name]
