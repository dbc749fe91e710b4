"""Vacuity: whether a requirement can trigger, fail and pass at all."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Iterator
from itertools import product

from msgspec import Struct

from rvmon.analysis.combinations import combinations_of
from rvmon.language.checked.formula import BoundAtom, Constant
from rvmon.language.checked.specification import CheckedSpec, EndPolicy, Mode, Requirement
from rvmon.logic.automaton import FAILED, NOW, PASSED, Automaton, row_of
from rvmon.logic.clock_regions import region_bounds, regions_between
from rvmon.logic.state_formula import FALSE, TRUE, State

_STARTED = -1  # the pseudo-region of a clock that was started at this position

Regions = tuple[int, ...]
"""For each clock of a location, the number of its cuts that its age has reached."""


class Subject(Struct, frozen=True, eq=False):
    """A requirement to be analysed."""

    requirement: Requirement  # as checked
    trigger: State | None  # starts an attempt; `None` if the end of the trace does
    automaton: Automaton | None  # `None` if the requirement has none
    names: frozenset[str]  # the signals and events that it reads

    @property
    def id(self) -> str:
        """The requirement's id."""
        return self.requirement.id

    @property
    def is_always(self) -> bool:
        """Whether its trigger is `whenever true`, so that an attempt is open at every instant."""
        trigger = self.requirement.trigger
        always = isinstance(trigger, Constant) and trigger.value
        return always and self.requirement.mode is Mode.WHENEVER

    @property
    def starts_late(self) -> bool:
        """Whether an attempt can start after the first instant."""
        return not self.is_always and not isinstance(self.requirement.trigger, BoundAtom)

    @property
    def starts_again(self) -> bool:
        """Whether an attempt starts at every instant at which its trigger holds."""
        return self.requirement.pulse and self.requirement.mode is Mode.UPON


class Possible(Struct, frozen=True):
    """What a requirement can do: `False` is proved, `None` means not decided."""

    trigger: bool | None = None  # whether an attempt can start
    fail: bool | None = None  # whether one can fail
    pass_: bool | None = None  # whether one can pass


def possible(
    spec: CheckedSpec, trigger: State | None, automaton: Automaton | None, policy: EndPolicy
) -> Possible:
    """The possible behaviour of a requirement, by reachability on its automaton.

    `trigger` is `None` if the end of the trace is the trigger, `automaton` is `None` if there is
    none.

    The search over-approximates: past operators and complex comparisons are treated as free
    propositions, and ages may cross their bounds in any order.

    Source: AUTOMATA 2, regions after Alur and Dill 1994.
    """
    if automaton is None:
        combinations = None if trigger is None else combinations_of(spec, [trigger])
        return Possible(trigger=None if combinations is None else (True,) in combinations)
    propositions = automaton.alphabet.propositions
    states = [*propositions, *([] if trigger is None else [trigger])]
    combinations = combinations_of(spec, states)
    if combinations is None:
        return Possible()
    first = {v for v in combinations if trigger is None or v[-1]}
    if not first:
        return Possible(trigger=False)
    # The exploration covers every run, and perhaps more. So "cannot fail" is proved and becomes a
    # finding, while "can fail" is not proved and not reported.
    width = len(propositions)
    reach = _Reach(automaton, spec.gap)
    reach.run(
        {automaton_letter(automaton, v[:width]) for v in first},
        {automaton_letter(automaton, v[:width]) for v in combinations},
    )
    undecided = bool(reach.rows)
    fail = reach.failed or (undecided and policy in (EndPolicy.STRONG, EndPolicy.FAIL))
    held = policy is EndPolicy.DEFAULT and any(automaton.end_values[row] for row in reach.rows)
    settled = policy in (EndPolicy.WEAK, EndPolicy.PASS)
    return Possible(True, fail, reach.passed or held or (undecided and settled))


def automaton_letter(automaton: Automaton, truths: Iterable[bool]) -> int:
    """The class of the letter with these truth values, all of which are known."""
    weights = automaton.alphabet.pessimistic
    letter = sum(
        digits[TRUE] if truth else digits[FALSE]
        for digits, truth in zip(weights, truths, strict=True)
    )
    return automaton.class_of[letter]


class _Reach:
    """The reachable rows of an automaton.

    The age of a clock that was just started is known exactly; of other clocks only the region is.
    """

    def __init__(self, automaton: Automaton, gap: int | None) -> None:
        self.automaton = automaton
        self.gap = gap
        self.rows: set[int] = set()  # the reachable rows of undecided locations
        self.failed = False  # whether an attempt can fail
        self.passed = False  # whether one can pass

    def run(self, first: set[int], letters: set[int]) -> None:
        """Explore from the trigger, with letter classes `first` there and `letters` afterwards."""
        waiting = list(self._step(self.automaton.initial, (), first))
        seen = set(waiting)
        while waiting:
            location, clocks = waiting.pop()
            self._visit(location, tuple(max(clock, 0) for clock in clocks))
            cuts = self.automaton.locations[location].cuts
            for later in product(*map(self._later, clocks, cuts)):
                self._visit(location, later)
                for reached in self._step(location, later, letters):
                    if reached not in seen:
                        seen.add(reached)
                        waiting.append(reached)

    def _visit(self, location: int, regions: Regions) -> None:
        row = row_of(self.automaton, location, regions)
        self.rows.add(row)
        self.failed |= self.automaton.time_values[row] == FALSE
        self.passed |= self.automaton.time_values[row] == TRUE

    def _later(self, clock: int, cuts: tuple[int, ...]) -> range:
        """The regions in which a clock may be at the next position."""
        if self.gap is None:
            return range(max(clock, 0), len(cuts) + 1)
        if clock == _STARTED:
            region = bisect_right(cuts, self.gap)
            return range(region, region + 1)
        low, high = region_bounds(cuts, clock)
        return regions_between(cuts, low + self.gap, high + self.gap)

    def _step(
        self, location: int, regions: Regions, letters: Iterable[int]
    ) -> Iterator[tuple[int, tuple[int, ...]]]:
        automaton = self.automaton
        row = row_of(automaton, location, regions)
        for letter in letters:
            edge = automaton.edges[row * automaton.classes + letter]
            if edge < 0:
                continue
            target = automaton.targets[edge]
            if target <= PASSED:
                self.failed |= target == FAILED
                self.passed |= target == PASSED
                continue
            ours = automaton.locations[location].cuts
            theirs = automaton.locations[target].cuts
            kept = (
                self._kept(source, regions, ours, cuts)
                for source, cuts in zip(automaton.sources[edge], theirs, strict=True)
            )
            for clocks in product(*kept):
                yield target, clocks

    def _kept(
        self,
        source: int,
        regions: Regions,
        ours: tuple[tuple[int, ...], ...],
        cuts: tuple[int, ...],
    ) -> Iterable[int]:
        """The possible regions of a clock after an edge, relative to the cuts of the target."""
        if source == NOW:
            return (_STARTED,)
        return regions_between(cuts, *region_bounds(ours[source], regions[source]))
