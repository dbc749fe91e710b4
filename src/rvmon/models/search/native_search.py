"""Calls the native search, and turns the path that it finds into a run."""

from __future__ import annotations

from array import array
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property
from math import inf
from typing import TYPE_CHECKING, NamedTuple

from rvmon.models import model_error
from rvmon.models.network import Guard, Network
from rvmon.models.network.guards import conjunction
from rvmon.models.runs import STRICT, Atom, Ending, Run, Zone
from rvmon.models.runs import timing as timings
from rvmon.models.runs.moves import Space, State, atoms_of, pieces_of
from rvmon.models.search.budget import Meter
from rvmon.models.search.search_plan import Plan, Seek, Sought
from rvmon.native import extension
from rvmon.native.sources import ZONES_FOLDER

if TYPE_CHECKING:
    from rvmon.native import _zones

    search = _zones.search
else:
    search = extension("_zones", ZONES_FOLDER, "the search of models").search

_UNBOUNDED = (1 << 63) - 1
_NOWHERE = -(1 << 63)


class _State(IntEnum):
    ENDED = 1
    FOUND = 2
    STOPPED = 3
    FAILED = 4
    NO_MEMORY = 5
    TOO_LARGE = 6


class _Step(IntEnum):
    MOVE = 0
    CROSSING = 1
    MARK = 2


_ENDINGS = (
    *(Ending.REACHED, Ending.DEADLOCK, Ending.IDLE),
    *(Ending.TIME_LOCK, Ending.LOOP, Ending.ZENO_LOOP),
)
"""In the order of their numbers in `zones.h`."""


@dataclass(frozen=True, slots=True)
class Answer:
    """The result of a search."""

    run: Run | None  # a run to the goal; `None` if there is none or the search was stopped
    improper: bool  # whether a run that stays inside was rejected because time stops on it
    # If there is a watcher and the goal was not found: for each location of the watcher that was
    # reached, the infimum and the supremum (`inf`: unbounded) of the last clock there.
    spans: Mapping[int, tuple[float, float]]


def seek(network: Network, sought: Sought, meter: Meter, *, proper_only: bool = False) -> Answer:
    """Search for a run.

    Args:
        network: the network to search.
        sought: the kind of run.
        meter: limits and counts the search.
        proper_only: whether a run that stays inside must let time diverge.

    Raises:
        ModelError: a run leaves the range of a variable, or times grow too large.
    """
    plan = Plan(network, sought)
    paths = _Paths(network, plan, sought)

    def diverges(path: bytes, loop: int, head: bytes) -> int:
        # C calls this for each loop that it cannot judge itself. That is rare, and needs relations
        # between rounds, which are here.
        steps = paths.walk(path)[1][loop:]
        return time_passes(steps, _zone(array("q", head)), paths.dim)

    state, ending, loop, improper, visited, stored, _, _, path, parts, spans = search(
        plan.numbers, plan.costs, meter.look, diverges, meter.left, -1, proper_only
    )
    meter.add(visited, stored)
    match _State(state):
        case _State.NO_MEMORY:
            meter.stop("memory ran out")
        case _State.STOPPED:
            meter.stop_at_states()
        case _State.FAILED:
            paths.fail(path, sought)
        case _State.TOO_LARGE:
            fix = "choose a larger unit of time"
            raise model_error("TA019", "times grow too large in this network", None, fix)
        case _State.FOUND:
            run = paths.run(path, parts, _ENDINGS[ending], loop)
            return Answer(run, bool(improper), {})
        case _State.ENDED:
            pass
    return Answer(None, bool(improper), _spans(array("q", spans)))


def _spans(numbers: Sequence[int]) -> dict[int, tuple[float, float]]:
    pairs = enumerate(zip(numbers[::2], numbers[1::2], strict=True))
    return {
        place: (-(low >> 1), inf if high == _UNBOUNDED else high >> 1)
        for place, (low, high) in pairs
        if low > _NOWHERE
    }


def _zone(numbers: Sequence[int]) -> Zone:
    """A zone of the native search in the representation of this package."""
    return [
        inf if number == _UNBOUNDED else (number >> 1) - (0.0 if number & 1 else STRICT)
        for number in numbers
    ]


class _Walked(NamedTuple):
    """A step of a path, the piece after it, and the index in the path at which it ends."""

    end: int
    piece: int
    step: timings.PathStep


def _common_length(first: bytes, second: bytes) -> int:
    """The length of the common prefix of two byte strings, by bisection."""
    low, high = 0, min(len(first), len(second))
    while low < high:
        middle = (low + high + 1) // 2
        if first[low:middle] == second[low:middle]:
            low = middle
        else:
            high = middle - 1
    return low


class _Paths:
    """Replays paths of the native search on the network."""

    def __init__(self, network: Network, plan: Plan, sought: Sought) -> None:
        self._network = network
        self._plan = plan
        self.dim = 1 + len(network.clocks) + sought.has_timer
        late = sought.kind in (Seek.LATE, Seek.LATE_AFTER)
        self._timers = [self.dim - 1] if late else []
        self._path = b""
        self._walked: list[_Walked] = []

    @cached_property
    def _space(self) -> Space:
        return Space(self._network)

    @property
    def _start(self) -> State:
        start = self._space.initial()
        assert start is not None, "the network can start"
        return start

    def run(self, path: bytes, parts: bytes, ending: Ending, loop: int) -> Run:
        """The run along a path, which ends in the first of some zones that it can reach."""
        last, steps = self.walk(path)
        for part in self._parts(parts):
            marked = [*steps, timings.mark_step(last, part)]
            if timings.timing_of(marked) is not None:
                steps = marked
                break
        if ending is Ending.DEADLOCK and last.is_time_bounded:
            ending = Ending.TIME_LOCK
        shown = self._network.original or self._network
        return timings.make_run(shown, self._start, steps, ending, None if loop < 0 else loop)

    def fail(self, path: bytes, sought: Sought) -> None:
        """Raise the error of the model at the end of a path where the search failed."""
        state, _ = self.walk(path)
        for move in self._space.moves(state):
            self._space.moves(move.target)
            self._ask(move.target, sought)
        self._ask(state, sought)
        raise AssertionError("the native search failed where the rules do not")

    def _ask(self, state: State, sought: Sought) -> None:
        labels = [] if sought.automaton is None else [s.label for s in sought.automaton.states]
        for formula in (sought.goal, sought.inside, *map(conjunction, labels)):
            if formula is not None:
                pieces_of(formula)(state.locations, state.values)

    def walk(self, path: bytes) -> tuple[State, list[timings.PathStep]]:
        """Replay a path.

        The prefix that it shares with the path before is not replayed again: a depth-first search
        finds many loops after the same steps.

        Returns:
            The last state and the steps.
        """
        numbers = array("i", path)
        common = _common_length(self._path, path) // numbers.itemsize
        while self._walked and self._walked[-1].end > common:
            self._walked.pop()
        self._path = path
        state, piece, at = self._start, numbers[0], 1
        if self._walked:
            at, piece, step = self._walked[-1]
            state = step.state
        while at < len(numbers):
            kind, piece_after, number, count = numbers[at : at + 4]
            at += 4 + count
            here = self._constraint(self._plan.inside, piece, state)
            match _Step(kind):
                case _Step.MOVE:
                    edges = [self._plan.edges[edge] for edge in numbers[at - count : at]]
                    bounds, at = numbers[at : at + 4 * number], at + 4 * number
                    step = self._move(state, edges, (*_bounds(bounds), *here), piece_after)
                case _Step.CROSSING:
                    there = self._constraint(self._plan.inside, piece_after, state)
                    leave = here if number else _rounded(here, uppers=True)
                    enter = _rounded(there, uppers=False) if number else there
                    step = timings.crossing_step(state, leave, enter)
                case _Step.MARK:
                    holds = self._constraint(self._plan.goal, number, state)
                    there = self._constraint(self._plan.inside, piece_after, state)
                    step = timings.mark_step(state, (*holds, *there), self._timers)
            state, piece = step.state, piece_after
            self._walked.append(_Walked(at, piece, step))
        return state, [walked.step for walked in self._walked]

    def _move(
        self, state: State, edges: Sequence[tuple[int, int]], leave: timings.Piece, piece_after: int
    ) -> timings.PathStep:
        move = self._space.step(state, edges)
        assert move is not None, "the native search made it"
        if move.failure is not None:
            raise move.failure
        enter = self._constraint(self._plan.inside, piece_after, move.target)
        return timings.move_step(state, move, leave, enter)

    def _constraint(
        self, alternatives: Sequence[Guard], number: int, state: State
    ) -> timings.Piece:
        """The bounds of an alternative in a state; none for index −1."""
        if number < 0:
            return ()
        return atoms_of(alternatives[number].clocks, None)(state.locations, state.values)

    def _parts(self, parts: bytes) -> Iterator[timings.Piece]:
        numbers, entries = array("q", parts), self.dim * self.dim
        for at in range(0, len(numbers), entries):
            zone = _zone(numbers[at : at + entries])
            yield tuple(
                (x, y, zone[x * self.dim + y])
                for x in range(self.dim)
                for y in range(self.dim)
                if x != y and zone[x * self.dim + y] < inf
            )


def _bounds(numbers: Sequence[int]) -> Iterator[Atom]:
    """Decode the bounds that a move needs in addition to its guards."""
    for x, y, number, closed in zip(*[iter(numbers)] * 4, strict=True):
        yield x, y, number - (0.0 if closed else STRICT)


def _rounded(constraint: timings.Piece, *, uppers: bool) -> timings.Piece:
    """A piece with its strict upper or lower bounds made non-strict: time crosses at the bound."""
    return tuple(
        (x, y, float(-(-bound // 1)) if (x == 0 if uppers else y == 0) else bound)
        for x, y, bound in constraint
    )


def time_passes(loop: Sequence[timings.TimedStep], head: Zone, dim: int) -> bool:
    """Whether time diverges on a loop: more rounds can take longer.

    The loop starts and ends in the symbolic state `head`. Each of its steps, at least one, waits
    only as long as some clock allows: otherwise a run could stay without the loop.

    If time does not diverge, the longest total time of all rounds stops growing, which shows when
    there are more rounds than clocks.

    Source: Tripakis, Verifying Progress in Timed Systems, 1999 (strong non-Zenoness).
    """
    sure = surely_passes(loop)
    if sure is not None:
        return sure
    rounds = 1 << dim.bit_length()
    return _longest(loop, head, rounds) < _longest(loop, head, 2 * rounds)


def surely_passes(loop: Sequence[timings.TimedStep]) -> bool | None:
    """Whether time diverges on a loop; `None` if its bounds alone do not tell."""
    highest: dict[int, float] = {}
    for step in loop:
        for clock, value in step.resets:
            highest[clock] = max(value, highest.get(clock, 0.0))
    bounds = [bound for step in loop for bound in (*step.leave, *step.enter)]
    if any(x == 0 and y not in highest for x, y, _ in bounds):
        return False  # a clock that is never reset stays below a number
    if any(y == 0 and x in highest and -bound >= highest[x] + 1 for x, y, bound in bounds):
        return True  # each round takes at least one unit from the reset to the bound
    return None


def _longest(loop: Sequence[timings.TimedStep], head: Zone, rounds: int) -> float:
    """The longest total time of some rounds from `head`, rounded up to whole units; may be inf."""
    timing = timings.timing_of([*loop] * rounds, head)
    assert timing is not None, "a loop of symbolic states can be repeated"
    longest = float(timing.relation((0, len(loop) * rounds))[0, 1])
    return longest if longest == inf else -(-longest // timing.scale)
