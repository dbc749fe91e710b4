"""A requirement's monitor as an automaton that watches a network.

The monitor follows at most one attempt, and any action that triggers the requirement may start it.
This choice is nondeterministic, so every attempt of every run is followed on some path. The monitor
steps at each action, with the names of the action as events and the signals as they are after it.
Between actions it steps without events: once just after the action, and whenever an age passes a
bound of its window. It steps through the actions of one instant one by one, where a recording would
show one sample.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from enum import Enum
from itertools import product

from rvmon.language.checked.formula import Bound, BoundAtom
from rvmon.logic.automaton import FAILED, NOW, PASSED, Automaton
from rvmon.logic.lower import Obligation
from rvmon.models.network import Network
from rvmon.models.network import expressions as ex
from rvmon.models.network.derived import Watcher
from rvmon.models.network.evaluate import evaluator
from rvmon.models.network.guards import conjunction, disjunction
from rvmon.models.requirement_propositions import (
    Ages,
    Edge,
    Labelling,
    NotExpressibleError,
    Region,
    Tables,
    bounds_of,
    events_of,
    negated,
)

MOST_STEPS = 20
"""A monitor that still moves after so many steps at one instant changes at every instant."""

_LOST = -2  # in place of a location: the monitor changes at every instant, and is not followed


class Phase(Enum):
    """The phases of the watcher between two moves."""

    START = "the run has just started: without an attempt, or with the one that starts here"
    IDLE = "no attempt is followed, and the trigger does not hold"
    READY = "no attempt is followed, and the trigger holds"
    FRESH = "the monitor has just stepped at an action; no time has passed since"
    HELD = "time passes and nothing changes"


@dataclass(frozen=True, slots=True)
class _Site:
    """A location of the watcher."""

    phase: Phase
    location: int = -1  # of the monitor; -1 if no attempt is followed
    # for each clock of the monitor, the clock of the watcher that represents it
    clocks: tuple[int, ...] = ()
    region: Region = ()  # while time passes: for each clock, how many bounds its age has passed

    @property
    def held(self) -> _Held:
        """The state of the monitor while it waits here."""
        return self.location, self.clocks, self.region

    @property
    def waits(self) -> bool:
        """Whether time passes here while the attempt is open."""
        return self.phase is Phase.HELD and not self.is_decided

    @property
    def is_decided(self) -> bool:
        """Whether the attempt has passed, has failed or is not followed any more."""
        return self.location in (FAILED, PASSED, _LOST)


_Held = tuple[int, tuple[int, ...], Region]
"""The state of a waiting monitor: its location, the clocks in use, and their region."""


class Observed:
    """A network with the monitor of one requirement.

    Args:
        network: with a unit of time.
        obligation: the trigger and the required formula.
        pulse: whether the trigger starts an attempt wherever it holds.
        automaton: the monitor of the required formula.
        signals: the expression of each signal over locations and variables.
        labels: the labels of the network's actions, which serve as events.

    Raises:
        NotExpressibleError: the requirement refers to something that the network does not have, or
            a window does not end at a whole number of units.
    """

    def __init__(
        self,
        network: Network,
        obligation: Obligation,
        pulse: bool,
        automaton: Automaton,
        signals: dict[str, ex.Expression],
        labels: frozenset[str],
    ) -> None:
        self._automaton = automaton
        self._pulse = pulse
        alphabet = automaton.alphabet
        required = [
            name for proposition in alphabet.propositions for name in events_of(proposition)
        ]
        # whether the required formula reads events, which only actions have
        self.reads_events = bool(required)
        trigger = obligation.trigger
        bound = None if trigger is None or not isinstance(trigger.leaf, BoundAtom) else trigger.leaf
        read = [*required, *([] if trigger is None or bound else events_of(trigger))]
        for name in read:
            if name not in labels:
                raise NotExpressibleError(f"the network has no action `{name}`")
        count = max(1, automaton.clocks)
        self._watcher = Watcher(network, read, [""] * (count + 1))
        self._clocks = range(self._watcher.clock, self._watcher.clock + count)
        self._since = self._watcher.clock + count
        """The clock that the watcher resets in each step."""
        now = Labelling(signals, self._watcher.has)
        between = Labelling(signals, lambda _name: ex.FALSE)
        # the trigger at an action, and between actions
        self._triggers = ex.FALSE if trigger is None or bound else now.expression(trigger)
        self._lasting = ex.FALSE if trigger is None or bound else between.expression(trigger)
        propositions = [now.expression(proposition) for proposition in alphabet.propositions]
        self._tables = Tables(automaton, propositions, network.unit or 1)
        self._sites: dict[_Site, int] = {}
        self._waiting: list[_Site] = []
        self._place(_Site(Phase.START))
        at_start = [a.initial for a in network.automata], [
            *(v.initial for v in network.variables), *(0 for _ in read)
        ]  # fmt: skip
        self._is_ready = bool(evaluator(self._lasting)(*at_start))
        self._first: _Site | None = None
        if self._is_ready or (bound is not None and bound.bound is Bound.START):
            letter = self._tables.class_of(lambda expression: evaluator(expression)(*at_start))
            edge = self._tables.edge(automaton.initial, (), letter)
            assert edge is not None, "every letter may start a run"
            self._first, _ = self._fresh(edge, ())
        for site in self._waiting:  # grows meanwhile
            self._expand(site)
        self.network = self._watcher.network()
        # An attempt is followed, or has ended as the name says.
        self.triggered = self._where(lambda site: site.location >= 0)
        # no monitor of this kind can follow the attempt
        self.lost = self._where(lambda site: site.location == _LOST)
        # an attempt is followed and not decided
        self.is_open = self._where(lambda site: site.location > PASSED, at_start=False)
        # the same, and the attempt stays open if time diverges without actions
        self.rests = self._where(
            lambda site: site.waits and self._tables.is_last(site.location, site.region),
            at_start=False,
        )
        self.passed = self._where(lambda site: site.location == PASSED)
        self.failed = self._where(lambda site: site.location == FAILED)

    # Locations of the watcher.

    def _place(self, site: _Site) -> int:
        """The index of a site. A new site is queued for expansion."""
        place = self._sites.get(site)
        if place is None:
            urgent = site.phase is Phase.FRESH and not site.is_decided
            kind = ex.LocationKind.URGENT if urgent else ex.LocationKind.NORMAL
            bounds = self._tables.highest(*site.held) if site.waits else ()
            place = self._sites[site] = self._watcher.add_location(bounds, kind)
            self._waiting.append(site)
        return place

    def _where(self, counts: Callable[[_Site], bool], *, at_start: bool = True) -> ex.Expression:
        """Whether the watcher is in a site that counts."""
        places = []
        for site, place in self._sites.items():
            shown = self._first if site.phase is Phase.START and at_start else site
            if shown is not None and counts(shown):
                there = self._watcher.is_in(place)
                if site.phase is Phase.HELD and site.is_decided:  # decided once time has passed
                    there = ex.BinaryOperation(ex.BinaryOp.AND, there, self._after())
                places.append(there)
        return disjunction(places)

    def _after(self) -> ex.ClockCompare:
        """Whether time has passed since the watcher's last step."""
        return ex.ClockCompare(self._since, ex.ClockOp.GT, ex.Constant(0))

    def _expand(self, site: _Site) -> None:
        """Add the edges that leave a site."""
        place = self._sites[site]
        match site.phase:
            case Phase.START:
                self._follow_none(place, self._is_ready)
                if self._first is not None and not self._first.is_decided:
                    at_once = ex.ClockCompare(self._since, ex.ClockOp.LE, ex.Constant(0))
                    self._follow(place, self._first, (at_once,))
            case Phase.IDLE | Phase.READY:
                self._follow_none(place, site.phase is Phase.READY)
            case Phase.FRESH | Phase.HELD if not site.is_decided:
                self._follow(place, site, (self._after(),) if site.phase is Phase.HELD else ())
            case _:
                pass  # a decided site has no successors

    def _follow_none(self, place: int, is_ready: bool) -> None:
        """Add moves without an attempt, and those that start one."""
        held, resets = self._lasting, (self._since,)
        self._watcher.add_edge(place, self._place(_Site(Phase.IDLE)), negated(held), (), resets)
        if held != ex.FALSE:
            self._watcher.add_edge(place, self._place(_Site(Phase.READY)), held, (), resets)
        if self._pulse or not is_ready:
            for letters, edge in self._tables.edges(self._automaton.initial, ()):
                when = conjunction((self._triggers, letters))
                if when != ex.FALSE:
                    site, started = self._fresh(edge, ())
                    self._watcher.add_edge(place, self._place(site), when, (), started)

    def _follow(self, place: int, site: _Site, room: tuple[ex.ClockCompare, ...]) -> None:
        """Add moves with an attempt, and the steps between: after an action, or at a bound."""
        regions = [*self._tables.regions(site.location, site.region)]
        for region in regions:
            bounds = (*room, *self._tables.exact(site.location, site.clocks, region))
            for letters, edge in self._tables.edges(site.location, region):
                fresh, started = self._fresh(edge, site.clocks)
                self._watcher.add_edge(place, self._place(fresh), letters, bounds, started)
        # The state does not change within an instant, so all steps of an instant have one letter.
        waits: dict[tuple[tuple[ex.ClockCompare, ...], _Held], set[int]] = {}
        for region, letter in product(regions, range(self._automaton.classes)):
            for way in self._held((site.location, site.clocks, region), letter, {}, 0):
                if site.phase is not Phase.HELD or way[1] != site.held:
                    waits.setdefault(way, set()).add(letter)
        for (bounds, held), classes in waits.items():
            self._wait(place, self._tables.letters(classes), (*room, *bounds), held)

    def _wait(
        self, place: int, letters: ex.Expression, bounds: tuple[ex.ClockCompare, ...], held: _Held
    ) -> None:
        location, clocks, region = held
        numbers, started = self._started(clocks)
        site = _Site(Phase.HELD, location, numbers, region)
        self._watcher.add_edge(place, self._place(site), letters, bounds, started, watches=False)

    def _fresh(self, edge: Edge, clocks: Sequence[int]) -> tuple[_Site, list[int]]:
        """The site of the monitor after a step at an action; the clocks that the step resets."""
        target, sources = edge
        numbers, started = self._started([NOW if s == NOW else clocks[s] for s in sources])
        if target <= PASSED:
            return _Site(Phase.FRESH, target), [self._since]
        return _Site(Phase.FRESH, target, numbers), started

    def _started(self, clocks: Sequence[int]) -> tuple[tuple[int, ...], list[int]]:
        """The clocks, with a free one in place of `NOW`; the clocks that must be reset."""
        if NOW not in clocks:
            return tuple(clocks), [self._since]
        free = next(clock for clock in self._clocks if clock not in clocks)
        return tuple(free if c == NOW else c for c in clocks), [free, self._since]

    def _held(
        self, held: _Held, letter: int, ages: Ages, steps: int
    ) -> Iterator[tuple[tuple[ex.ClockCompare, ...], _Held]]:
        """The states in which the monitor waits after an instant, with the bounds on each way."""
        if steps > MOST_STEPS:
            yield bounds_of(ages), (_LOST, (), ())
            return
        location, clocks, region = held
        narrowed = self._tables.just_after(location, clocks, region, ages)
        edge = self._tables.edge(location, region, letter)
        if narrowed is None or edge is None:
            return
        target, sources = edge
        after = tuple(NOW if source == NOW else clocks[source] for source in sources)
        if target <= PASSED:
            yield bounds_of(narrowed), (target, (), ())
        elif target == location and sources == tuple(range(len(sources))):
            yield bounds_of(narrowed), held
        else:
            for further in self._tables.regions(target):
                yield from self._held((target, after, further), letter, narrowed, steps + 1)
