"""Packs the judges of requirements, and the links by which nodes notify them.

For a requirement with captured values (`let`, `for each`), each attempt or instance is a run of its
own, forked from the state of the run that started it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache, cached_property
from typing import assert_never

from rvmon.core.atoms import Atoms, Names, Programs
from rvmon.core.nodes import NodeOp, Nodes
from rvmon.core.obligations import Automata, add_form, add_margin
from rvmon.core.sections import Section, Sections, bits
from rvmon.language.checked.formula import NowValue
from rvmon.language.checked.specification import EndPolicy, Mode
from rvmon.logic.automaton import Automaton
from rvmon.logic.network_plan import NetworkPlan, plan_of
from rvmon.logic.plan import Plan, PlannedRule
from rvmon.logic.state_formula import State, StateOp
from rvmon.logic.state_graph import (
    Reach,
    graph_of,
    names_of,
    reach_of,
    starts_with_attempt,
    varying,
)
from rvmon.logic.window_chains import Chain, chain_of
from rvmon.verdicts import Verdict
from rvmon.verdicts.attempt import DECISIONS, VERDICTS, Decision

_OPEN = (Verdict.INCONCLUSIVE, Decision.OPEN)


def settle_at_end(
    policy: EndPolicy, *, held: bool, cannot_pass: bool, cannot_fail: bool
) -> tuple[Verdict, Decision]:
    """The verdict of an attempt that is undecided at the end of the trace, and its decision.

    Args:
        policy: `at end` of its requirement.
        held: whether it is true if every opened unbounded `R` counts as true and every other
            pending operator as unknown.
        cannot_pass: whether, because of unknown input, it could not have become true.
        cannot_fail: the same for false.

    Source: SEMANTICS, section 3, The end.

    >>> settle_at_end(EndPolicy.FAIL, held=True, cannot_pass=False, cannot_fail=False)[0].value
    'F'
    """
    match policy:
        case EndPolicy.DEFAULT:
            return (Verdict.PASS, Decision.HELD_TO_END) if held else _OPEN
        case EndPolicy.STRICT:
            return _OPEN
        case EndPolicy.WEAK:
            return _OPEN if cannot_pass else (Verdict.PASS, Decision.POLICY)
        case EndPolicy.STRONG:
            return _OPEN if cannot_fail else (Verdict.FAIL, Decision.POLICY)
        case EndPolicy.PASS | EndPolicy.FAIL:
            if cannot_pass or cannot_fail:
                return _OPEN
            settled = Verdict.PASS if policy is EndPolicy.PASS else Verdict.FAIL
            return settled, Decision.POLICY
        case _:
            assert_never(policy)


_LETTER, _TRIGGER, _DETERMINED = 1, 2, 4

_NOTHING = ((0, 0, 0), (0, 0, 0))

Weights = tuple[Sequence[int], Sequence[int]]
"""The summands of a letter for FALSE, UNKNOWN and TRUE, in the pessimistic and optimistic run."""


class Judges:
    """Packs the judges of a part.

    Attributes:
        networked: the numbers of the judges that are networks or chains.
        clocks: the most clocks of an automaton; a network needs 1, for its position.
        undetermined: the number of judges that track whether their trigger was ever TRUE or FALSE.
    """

    def __init__(
        self,
        sections: Sections,
        automata: Automata,
        plan: Plan,
        names: Names,
        numbers: Sequence[int],
    ) -> None:
        self._sections = sections
        self._names = names
        self._plan = plan
        self._index = plan.graph.index
        self.networked: list[int] = []
        self.clocks = 1
        self._links: dict[int, dict[int, tuple[int, Weights]]] = {}
        self.undetermined = sum(rule.determined is not None for _, rule in plan.judges)
        for number, (owner, rule) in enumerate(plan.judges):
            place = form = diagram = -1
            match machine_of(rule, plan.gap):
                case Automaton() as automaton:
                    place = automata.place(automaton)
                    diagram = automata.diagram(automaton.class_of, rule.alphabet)
                    self.clocks = max(self.clocks, automaton.clocks)
                case network, chain:
                    form = len(self.networked)
                    self.networked.append(number)
                    add_form(sections, network, chain, self._index)
            tabled = place >= 0 and diagram < 0
            self._hear(number, rule, tabled=tabled)
            self._add(number, rule, owner, numbers[owner], (place, form, diagram))
            if rule.measured is not None:
                network = plan_of(rule.measured, plan.gap)
                add_margin(sections, network, self._index, plan.spec, rule.requirement)

    def links(self, place: int) -> Iterator[tuple[int, ...]]:
        """The links from a node to judges, as records of `LINKS`."""
        for judge, (kind, (worse, better)) in self._links.get(place, {}).items():
            yield (judge, kind, *worse, *better)

    def _hear(self, number: int, rule: PlannedRule, *, tabled: bool) -> None:
        alphabet = rule.alphabet
        for place, state in enumerate(alphabet.propositions):
            weights = _NOTHING
            if tabled:
                weights = alphabet.pessimistic[place], alphabet.optimistic[place]
            self._link(state, number, _LETTER, weights)
        self._link(rule.trigger, number, _TRIGGER)
        self._link(rule.running, number, _TRIGGER)
        self._link(rule.determined, number, _DETERMINED)

    def _link(
        self, state: State | None, number: int, kind: int, weights: Weights = _NOTHING
    ) -> None:
        if state is not None:
            own = self._links.setdefault(self._index[state], {})
            before, known = own.get(number, (0, weights))
            own[number] = before | kind, known

    def _place(self, state: State | None) -> int:
        return -1 if state is None else self._index[state]

    def _add(
        self,
        number: int,
        rule: PlannedRule,
        owner: int,
        requirement: int,
        judged_by: tuple[int, int, int],
    ) -> None:
        place = self._place
        running = rule.running if rule.requirement.captures else rule.trigger
        self._sections.add(
            Section.JUDGES,
            *map(place, (rule.trigger, rule.again, rule.unborn, rule.determined)),
            place(running),
            place(rule.blurs),
            owner,
            requirement,
            _flags(rule, is_hidden=number >= len(self._plan.rules)),
            *judged_by,
            *self._sections.listed([self._index[state] for state in rule.alphabet.propositions]),
            *self._sections.listed([self._index[state] for state in rule.noted]),
            *self._sections.listed(self._names_noted(rule)),
            *outcomes(rule.requirement.at_end),
        )

    def _names_noted(self, rule: PlannedRule) -> list[int]:
        """The numbers of the names that leaves of notes read; events are numbered after signals."""
        signals, events = self._names.signals, self._names.events
        leaves = [state.leaf for state in rule.noted if state.leaf is not None]
        read = {name for leaf in leaves for name in names_of(leaf)}
        return sorted(
            [signals[name] for name in read & signals.keys()]
            + [len(signals) + events[name] for name in read & events.keys()]
        )


def machine_of(rule: PlannedRule, gap: int | None) -> Automaton | tuple[NetworkPlan, Chain | None]:
    """The machine that judges a rule: an automaton, or a network, with its chain if it is one.

    If open attempts would scatter over an automaton, which steps each state separately, a network
    or chain is preferred, as it judges all attempts at once.
    """
    if rule.automaton is not None and (rule.stepped or not rule.scatters):
        return rule.automaton
    network = plan_of(rule.required, gap)
    chain = None if rule.stepped else chain_of(network, gap)
    nested = chain is not None and len(chain.windows) > 1
    # Two cases for the automaton nevertheless. Episodes do not overlap, so their clocks ascend and
    # the automaton steps them together. In sampled time an outage may hide any number of samples,
    # and an automaton reads its letter at each instant.
    episodic = rule.requirement.mode is Mode.WHENEVER
    if rule.automaton is not None and (episodic or gap is None) and not nested:
        return rule.automaton
    return network, chain


def _flags(rule: PlannedRule, *, is_hidden: bool) -> int:
    is_episodic = is_hidden or rule.requirement.mode is Mode.WHENEVER
    return bits(rule.requirement.pulse, is_episodic, is_hidden, rule.blurs_anywhere, rule.traced)


@cache
def outcomes(policy: EndPolicy) -> tuple[int, ...]:
    """The outcomes of an undecided attempt at the end, each as verdict + 4 × decision.

    Indexed by bits, the arguments of `settle_at_end`: held (1), cannot pass (2), cannot fail (4).
    """
    # The core knows no policies: it gets this table of eight outcomes.
    found = []
    for state in range(8):
        verdict, decision = settle_at_end(
            policy,
            held=bool(state & 1),
            cannot_pass=bool(state & 2),
            cannot_fail=bool(state & 4),
        )
        found.append(VERDICTS.index(verdict) + 4 * DECISIONS.index(decision))
    return tuple(found)


SHARED = (0, 0, -1, 0, 0, 0, -1, -1, *([0] * 10))
"""The unit fields of a part without captured values."""


class Unit:
    """A requirement with captured values."""

    def __init__(self, plan: Plan, number: int) -> None:
        self._plan = plan
        (self._rule,) = plan.rules
        self._number = number
        self._requirement = self._rule.requirement

    def fields(
        self, sections: Sections, names: Names, programs: Programs, nodes: Nodes, atoms: Atoms
    ) -> Iterator[int]:
        """The fields of its part record in plan.h, from `captured` to `lapsed`."""
        key = names.key
        yield len(self._rule.captured)
        yield self._requirement.for_each is not None
        yield self._number
        yield self._flags
        yield from self._starters
        yield -1 if key is None else names.events[key.event]
        yield -1 if key is None else names.field(key.event, key.field)
        graph = self._plan.graph
        vary = sorted(varying(graph))
        # What depends on captured values is evaluated anew in each attempt; everything else is
        # shared with the run that starts it.
        lapsed = [place for place, node in enumerate(nodes.all) if node.op is NodeOp.LAPSED]
        lists: Sequence[Sequence[int]] = (
            [programs.place(capture.value) for capture in self._requirement.captures],
            [number for number, atom in enumerate(atoms.all) if atom.captured],
            [one for one in vary if one not in graph.stateful or self._forgets(graph.nodes[one])],
            vary,
            lapsed,
        )
        for places in lists:
            yield from sections.listed(places)

    @property
    def _flags(self) -> int:
        reach = self._reach
        replays, fresh = self._replays, self._is_fresh
        forgets = fresh and reach is not None and reach.starts
        keeps_past = replays or (reach is not None and not fresh)
        captured = [capture.value for capture in self._requirement.captures]
        captures_now = any(isinstance(value, NowValue) for value in captured)
        return bits(replays, fresh, forgets, keeps_past, captures_now)

    def _forgets(self, state: State) -> bool:
        """Whether a stateful node carries no memory into a new attempt."""
        starts = not self._replays and starts_with_attempt(state)
        return state.op is StateOp.PASSED or starts

    @cached_property
    def _replays(self) -> bool:
        """Whether an attempt with captures depends on samples before its trigger."""
        if not self._requirement.captures:
            return False
        judged = [rule for _, rule in self._plan.judges]
        return self._looks_back or any(
            graph_of(_consequent(rule)).remembers_captured for rule in judged
        )

    @cached_property
    def _looks_back(self) -> bool:
        plan = self._plan
        cores = [one for _, rule in plan.judges for one in (rule.required, rule.measured)]
        return any(plan_of(one, plan.gap).looks_back for one in cores if one is not None)

    @cached_property
    def _reach(self) -> Reach | None:
        each = self._requirement.for_each
        if each is None:
            return None
        states = [state for _, rule in self._plan.judges for state in self._shared(rule)]
        looks_back = self._looks_back
        return reach_of(graph_of(states), each, self._rule.trigger, looks_back=looks_back)

    @property
    def _is_fresh(self) -> bool:
        """Whether a new instance can be forked from the current state of the root run.

        In clocked time the root run, between two ticks, has already moved to the letter of the next
        tick, so the previous value of a trigger, which an edge needs, is gone. That does not matter
        if attempts start independently of the previous value.
        """
        reach = self._reach
        if reach is None or not reach.is_fresh:
            return False
        no_edge = self._requirement.pulse or self._requirement.mode is Mode.WHENEVER
        return self._plan.gap in (None, 1) or (reach.starts and no_edge)

    def _shared(self, rule: PlannedRule) -> Iterator[State]:
        """The state formulas evaluated by an instance, not by its attempts."""
        if not self._requirement.captures:
            yield from rule.states
        named = (rule.trigger, rule.determined, rule.blurs)
        yield from (state for state in named if state is not None)
        yield from rule.captures_known

    @property
    def _starters(self) -> tuple[int, int]:
        """The judges that start attempts in the root run, and those in instances, as bit sets."""
        bits = {rule: 1 << index for index, (_, rule) in enumerate(self._plan.judges)}
        known = bits[self._rule]
        hidden, doubted = self._rule.hidden, self._rule.doubted
        if hidden is not None:
            known |= bits[hidden]
        if doubted is not None and self._requirement.mode is Mode.UPON:
            return bits[doubted], known
        return known, known


def _consequent(rule: PlannedRule) -> Iterator[State]:
    """The state formulas evaluated by an attempt."""
    yield from rule.alphabet.propositions
    yield from rule.also_read
    named = [rule.again, rule.unborn]
    if rule.requirement.mode is Mode.WHENEVER:
        named += [rule.trigger, rule.running]
    yield from (state for state in named if state is not None)
