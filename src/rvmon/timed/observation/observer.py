"""A requirement's monitor as a further component of a network.

The monitor follows one attempt, which begins at any action that triggers it, or not: so every
attempt of every run is followed by some path. It steps at each action, with the action's names as
events and the signals as they are behind it, and between actions as time passes, with no event:
once just behind the action, and wherever an age passes a bound of its window. Actions at one
instant are stepped one after the other, where a recording would show one sample.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from enum import Enum
from itertools import product
from math import ceil, inf

from rvmon.logic.automaton import FAILED, NOW, PASSED, Automaton, row_of
from rvmon.logic.lower import Obligation
from rvmon.spec.checked.formula import Bound, BoundAtom
from rvmon.timed.conformance.conform import names_of
from rvmon.timed.model.network import Network
from rvmon.timed.observation.propositions import Labelling, NotExpressibleError, speaks_of_events
from rvmon.timed.zones.dbm import STRICT, Zone, cut, delay, normalise, reset, zero
from rvmon.timed.zones.discrete import Move, State
from rvmon.timed.zones.symbolic import Steps, fire, settle_in
from rvmon.timed.zones.zone_unions import Constraint

MOST_STEPS = 20
"""A monitor that still moves after so many steps at one instant is moved by time itself."""


class Phase(Enum):
    """Where the monitor is between two positions."""

    IDLE = "no attempt is followed"
    FRESH = "an action has just been stepped, no time has passed since"
    HELD = "time passes, nothing changes"


@dataclass(frozen=True, slots=True)
class ObservedSite:
    """A state of the network with one of the monitor; decided ones have no region.

    Attributes:
        location: of the monitor.
        region: per clock of the monitor the number of bounds that its age has passed.
    """

    state: State
    phase: Phase
    location: int = -1
    region: tuple[int, ...] = ()
    uppers: tuple[tuple[int, float], ...] = field(default=(), compare=False)
    lowers: tuple[tuple[int, float], ...] = field(default=(), compare=False)


@dataclass(frozen=True, slots=True)
class MonitorStep:
    """A step of the monitor: what must hold of its clocks, and where they come from after it."""

    constraint: Constraint
    sources: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class ObservedLink:
    """A move of the network, or time that brings the monitor on.

    Attributes:
        move: `None`: only time.
        steps: of the monitor, all at the same instant.
    """

    move: Move | None
    steps: tuple[MonitorStep, ...] = ()


@dataclass(frozen=True, slots=True)
class _Cut:
    """A bound of a window: ages behind `number` units are in the next region, or from it on."""

    number: int
    behind: bool


class Observed:
    """The product of a network with the monitor of one requirement.

    Args:
        network: with a unit of time.
        obligation: trigger and what is required.
        pulse: whether the trigger starts an attempt wherever it holds.
        automaton: of what is required.
        labelling: values of the propositions.
        ticks: whether there is one more clock.

    Attributes:
        steps: of the network.
        base: the monitor's first clock.
        since: the time since the last action.
        tick: the last clock; with `ticks` nothing here reads it.

    Raises:
        NotExpressibleError: a window does not end at a whole number of units.
    """

    def __init__(
        self,
        network: Network,
        obligation: Obligation,
        pulse: bool,
        automaton: Automaton,
        labelling: Labelling,
        ticks: bool = False,
    ) -> None:
        self._network = network
        self._automaton = automaton
        self._labelling = labelling
        self._trigger = obligation.trigger
        self._pulse = pulse
        clocks = max(1, automaton.clocks)
        self.steps = Steps(network, observers=clocks + 1 + ticks)
        self.dim = self.steps.dim
        self.base = 1 + len(network.clocks)
        self.since = self.base + clocks
        self.tick = self.dim - 1
        unit = network.unit or 1
        self._cuts = [
            tuple(tuple(_cut(ticks, unit) for ticks in cuts) for cuts in location.cuts)
            for location in automaton.locations
        ]

    @property
    def reads_events(self) -> bool:
        """Whether what is required speaks of events, which actions alone have."""
        propositions = self._automaton.alphabet.propositions
        return any(map(speaks_of_events, propositions))

    # The search.

    def start(self) -> Iterator[tuple[ObservedSite, Zone]]:
        """The initial state, with an attempt that begins there or without."""
        for state, zone in self.steps.start():
            yield self._site(state, Phase.IDLE), zone
            if self._starts_at_once(state):
                letter = self._labelling.letter(self._automaton.alphabet, state, ())
                for step, target in self._stepped(self._automaton.initial, letter):
                    yield self._site(state, Phase.FRESH, target), self._moved(zero(self.dim), step)

    def successors(
        self, site: ObservedSite, zone: Zone
    ) -> Iterator[tuple[ObservedLink, ObservedSite, Zone]]:
        """All moves, and what time does to the monitor."""
        if site.phase is not Phase.IDLE and site.location <= PASSED:
            return
        for move in self.steps.space.moves(site.state):
            fresh = fire(move, zone, self.dim)
            if fresh is not None:
                yield from self._behind(site, move, fresh)
        if site.phase is not Phase.IDLE and site.state.delays:
            yield from self._later(site, zone)

    def rests(self, site: ObservedSite) -> bool:
        """Whether time can pass for ever in a site and its attempt stays open."""
        places = zip(self._cuts[site.location], site.region, strict=False)
        return (
            site.phase is Phase.HELD
            and site.location > PASSED
            and site.state.delays
            and not site.state.invariant
            and all(place == len(cuts) for cuts, place in places)
        )

    def most(self, site: ObservedSite) -> list[float]:
        """For each clock the largest number that matters behind a site; −inf if there is none."""
        most = [-inf] * self.dim
        for clock, number in (*((c, -u) for c, u in site.state.uppers), *site.state.lowers):
            most[clock] = max(most[clock], number)
        for location in self._cuts:
            for clock, cuts in enumerate(location, start=self.base):
                most[clock] = max(most[clock], *(float(one.number) for one in cuts), -inf)
        most[self.since] = 0.0
        most[self.tick] = 1.0
        return most

    # Actions.

    def _behind(
        self, site: ObservedSite, move: Move, zone: Zone
    ) -> Iterator[tuple[ObservedLink, ObservedSite, Zone]]:
        target, labels = move.target, names_of(move, self._network)
        invariant = [(0, clock, bound) for clock, bound in target.invariant]
        if site.phase is Phase.IDLE:
            later = zone[:]
            if settle_in(target, later, self.dim):
                yield ObservedLink(move), self._site(target, Phase.IDLE), normalise(later)
            if not self._starts(site.state, target, labels):
                return
        location = self._automaton.initial if site.phase is Phase.IDLE else site.location
        letter = self._labelling.letter(self._automaton.alphabet, target, labels)
        for step, reached in self._stepped(location, letter):
            now = zone[:]
            if cut(now, self.dim, (*invariant, *step.constraint)):
                now = self._moved(now, step)
                reset(now, self.dim, self.since, 0.0)
                link = ObservedLink(move, (step,))
                yield link, self._site(target, Phase.FRESH, reached), normalise(now)

    def _starts_at_once(self, state: State) -> bool:
        trigger = self._trigger
        if trigger is None:
            return False
        if isinstance(trigger.leaf, BoundAtom):
            return trigger.leaf.bound is Bound.START
        return self._labelling.reader(trigger)(state, ())

    def _starts(self, before: State, after: State, labels: tuple[str, ...]) -> bool:
        trigger = self._trigger
        if trigger is None or isinstance(trigger.leaf, BoundAtom):
            return False
        holds = self._labelling.reader(trigger)
        return holds(after, labels) and (self._pulse or not holds(before, ()))

    # Time.

    def _later(
        self, site: ObservedSite, zone: Zone
    ) -> Iterator[tuple[ObservedLink, ObservedSite, Zone]]:
        """What the monitor does as time passes: just behind an action, or at the next bound."""
        letter = self._labelling.letter(self._automaton.alphabet, site.state, ())
        instant = zone[:]
        # The monitor steps behind the instant: some time must be able to pass.
        room = [(0, clock, ceil(bound) - STRICT) for clock, bound in site.state.invariant]
        if not cut(instant, self.dim, room):
            return
        for steps, location, region, now in self._held_steps(site.location, letter, instant, ()):
            if (location, region) == (site.location, site.region) and site.phase is Phase.HELD:
                continue
            target = self._site(site.state, Phase.HELD, location, region)
            inside = self._settled(target, now)
            if inside is not None:
                yield ObservedLink(None, steps), target, inside

    def _held_steps(
        self, location: int, letter: int, zone: Zone, done: tuple[MonitorStep, ...]
    ) -> Iterator[tuple[tuple[MonitorStep, ...], int, tuple[int, ...], Zone]]:
        """The steps of the monitor just behind an instant, until it only waits."""
        if location <= PASSED:
            yield done, location, (), zone
            return
        if len(done) > MOST_STEPS:
            raise NotExpressibleError("its monitor is moved by time itself")
        for region in self._regions(location):
            now = zone[:]
            constraint = self._just_behind(location, region)
            if not cut(now, self.dim, constraint):
                continue
            now = normalise(now)
            target, sources = self._edge(location, region, letter)
            if target < 0:
                continue
            if target == location and sources == tuple(range(len(sources))):
                yield (*done, MonitorStep(constraint, sources)), location, region, now
                continue
            step = MonitorStep(constraint, sources)
            yield from self._held_steps(target, letter, self._moved(now, step), (*done, step))

    def _settled(self, site: ObservedSite, zone: Zone) -> Zone | None:
        """The delays that stay in a held site; decided ones need none."""
        inside = zone[:]
        if site.location > PASSED:
            invariant = [(0, clock, bound) for clock, bound in site.state.invariant]
            delay(inside, self.dim)
            constraint = (*self.held(site.location, site.region), (self.since, 0, -STRICT))
            if not cut(inside, self.dim, (*invariant, *constraint)):
                return None
        return normalise(inside)

    # The monitor's tables.

    def _stepped(self, location: int, letter: int) -> Iterator[tuple[MonitorStep, int]]:
        """The monitor's steps with a letter at an instant, one for each region of its clocks."""
        for region in self._regions(location):
            target, sources = self._edge(location, region, letter)
            if target >= 0:
                yield MonitorStep(self._exact(location, region), sources), target

    def _edge(
        self, location: int, region: tuple[int, ...], letter: int
    ) -> tuple[int, tuple[int, ...]]:
        automaton = self._automaton
        row = row_of(automaton, location, region)
        edge = automaton.edges[row * automaton.classes + automaton.class_of[letter]]
        return (-1, ()) if edge < 0 else (automaton.targets[edge], automaton.sources[edge])

    def _regions(self, location: int) -> Iterator[tuple[int, ...]]:
        return product(*(range(len(cuts) + 1) for cuts in self._cuts[location]))

    def _exact(self, location: int, region: tuple[int, ...]) -> Constraint:
        """The ages in a region."""
        atoms = []
        for clock, (cuts, place) in enumerate(zip(self._cuts[location], region, strict=True)):
            index = self.base + clock
            if place:
                low = cuts[place - 1]
                atoms.append((index, 0, -low.number - (STRICT if low.behind else 0.0)))
            if place < len(cuts):
                high = cuts[place]
                atoms.append((0, index, high.number - (0.0 if high.behind else STRICT)))
        return tuple(atoms)

    def _just_behind(self, location: int, region: tuple[int, ...]) -> Constraint:
        """The ages from which any delay, however short, leads into a region."""
        return self._between(location, region, at_low=0.0, at_high=STRICT)

    def held(self, location: int, region: tuple[int, ...]) -> Constraint:
        """The ages that time passes through in a region, up to the next bound."""
        return self._between(location, region, at_low=STRICT, at_high=0.0)

    def _between(
        self, location: int, region: tuple[int, ...], *, at_low: float, at_high: float
    ) -> Constraint:
        atoms = []
        for clock, (cuts, place) in enumerate(zip(self._cuts[location], region, strict=True)):
            index = self.base + clock
            if place:
                atoms.append((index, 0, -cuts[place - 1].number - at_low))
            if place < len(cuts):
                atoms.append((0, index, cuts[place].number - at_high))
        return tuple(atoms)

    def _moved(self, zone: Zone, step: MonitorStep) -> Zone:
        """A zone whose monitor clocks come from others; those that are not needed are 0."""
        old = list(range(self.dim))
        for clock in range(self.base, self.since):
            number = clock - self.base
            source = step.sources[number] if number < len(step.sources) else NOW
            old[clock] = 0 if source == NOW else self.base + source
        dim = self.dim
        return [zone[x * dim + y] for x in old for y in old]

    def _site(
        self, state: State, phase: Phase, location: int = -1, region: tuple[int, ...] = ()
    ) -> ObservedSite:
        if phase is Phase.IDLE or location <= PASSED:
            return ObservedSite(state, phase, location, (), state.uppers, state.lowers)
        largest = [
            (self.base + clock, float(cuts[-1].number))
            for clock, cuts in enumerate(self._cuts[location])
            if cuts
        ]
        uppers = (*state.uppers, *((clock, -number) for clock, number in largest))
        lowers = (*state.lowers, *largest, (self.since, 0.0))
        return ObservedSite(state, phase, location, region, uppers, lowers)


def _cut(ticks: int, unit: int) -> _Cut:
    if ticks % unit == 0:
        return _Cut(ticks // unit, behind=False)
    if ticks % unit == 1:
        return _Cut(ticks // unit, behind=True)
    raise NotExpressibleError("a window does not end at a whole number of the model's units")


def is_failed(site: ObservedSite) -> bool:
    """Whether the followed attempt has failed."""
    return site.phase is not Phase.IDLE and site.location == FAILED


def is_passed(site: ObservedSite) -> bool:
    """Whether the followed attempt has passed."""
    return site.phase is not Phase.IDLE and site.location == PASSED
