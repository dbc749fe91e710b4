"""What the core is given: the formulas, inputs and automata of some requirements."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain
from typing import NamedTuple

from rvmon.logic.automaton import Automaton
from rvmon.logic.formula import Core, literals
from rvmon.logic.letters import Alphabet
from rvmon.logic.state_formula import State, Unborn, inputs_of, operands
from rvmon.logic.state_graph import Graph, graph_of
from rvmon.spec.checked.formula import (
    Compare,
    Numeric,
    Probe,
    ProbeAtom,
    UpdateValue,
    WindowValue,
)
from rvmon.spec.checked.specification import CheckedSpec, Requirement
from rvmon.trace.sample import Scalar


@dataclass(frozen=True, slots=True, eq=False)
class PlannedRule:
    """One requirement.

    Attributes:
        requirement: as checked.
        trigger: what starts its attempts; `None` if that is the end of the trace.
        required: by an attempt.
        alphabet: of what it owes.
        automaton: judges its attempts; `None` if a delay network does.
        in_runs: whether its open attempts are kept in runs.
        again: of a `whenever`, not FALSE where an episode goes on after a failure; `None`: nothing
            is asked.
        unborn: of a level `whenever`, TRUE while something of its consequent had no value.
        determined: TRUE as soon as the trigger was TRUE or FALSE; `None` if it always is.
        hidden: judges the attempts in doubt `upon` the trigger; `None` if there are none. Its own
            trigger is UNKNOWN where an attempt in doubt starts, if none runs; it runs until that
            is FALSE.
        noted: the leaves of which a record says the values; they are nodes of the graph.
        doubted: as `hidden`, where it is not known whether there is such an instance.
        running: of an episode with captured values, what is FALSE where it is over.
        blurs: of attempts with captured values, UNKNOWN where another may have begun, whose values
            may be others; `None`: none may.
        blurs_anywhere: whether, of what has a key that is not known, one may have begun anywhere.
        asked: further state formulas that are asked for their values.
        caught: that numbers are known which are captured off windows.
        stepped: whether no chain of windows is to judge it.
        traced: whether somebody asks where attempts go in its automaton; it is stepped.
        measured: what it owes as far as that is measured; `None`: it is not.
    """

    requirement: Requirement
    trigger: State | None
    required: Core
    alphabet: Alphabet
    automaton: Automaton | None
    in_runs: bool = False
    again: State | None = None
    unborn: State | None = None
    determined: State | None = None
    hidden: PlannedRule | None = None
    noted: tuple[State, ...] = ()
    doubted: PlannedRule | None = None
    running: State | None = None
    blurs: State | None = None
    blurs_anywhere: bool = False
    asked: tuple[State, ...] = ()
    caught: tuple[State, ...] = ()
    stepped: bool = False
    traced: bool = False
    measured: Core | None = None

    @property
    def states(self) -> Iterator[State]:
        """The state formulas that are asked for their values."""
        named = (self.trigger, self.again, self.unborn, self.determined, self.running, self.blurs)
        yield from (state for state in named if state is not None)
        yield from self.alphabet.propositions
        yield from self.asked
        yield from self.caught
        for beside in (self.hidden, self.doubted):
            if beside is not None:
                yield from beside.states

    @property
    def captured(self) -> tuple[str, ...]:
        """The names of the values that each attempt has: of `for each`, then of `let`."""
        each = self.requirement.for_each
        names = [capture.name for capture in self.requirement.captures]
        return (*(() if each is None else (each.name,)), *names)

    @property
    def is_apart(self) -> bool:
        """Whether its attempts or instances have values, and so propositions, of their own."""
        return bool(self.captured)


@dataclass(frozen=True, slots=True, eq=False)
class Uses:
    """What is asked of a signal or event beside its present value.

    Attributes:
        history: the last two updates matter (`prev`, `delta`, `rate`, `changed`).
        marked: whether there is an update matters (`updated`, `changed`).
    """

    history: bool = False
    marked: bool = False


class Watch(NamedTuple):
    """A formula that is watched.

    Attributes:
        state: the formula.
        is_pulse: whether it is over at the next position.
    """

    state: State
    is_pulse: bool


@dataclass(frozen=True, slots=True)
class WatchGroup:
    """A coverpoint, or the cross of several: an item of it is a watch of each axis.

    Attributes:
        axes: the numbers of watches; items are counted through from the last axis on.
        occasion: the number of what says where it is looked at; `None`: everywhere.
    """

    axes: tuple[range, ...]
    occasion: int | None

    @property
    def looks_where(self) -> Iterable[int]:
        """The watches that have it look where they change."""
        return chain.from_iterable(self.axes) if self.occasion is None else (self.occasion,)


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """Some requirements of a specification, for one run of the core.

    Attributes:
        spec: gives names, types and the time model.
        rules: in the order of the file.
        graph: their state formulas, shared.
        gap: ticks between two positions; `None` if only samples are positions.
        signals: names of which something is kept; the place of a name is its number.
        events: the same.
        uses: by name, of those that are read, here or by what begins with what is remembered here.
        units: of the requirements with captured values, one each.
        asked: all rules, those of the units among them, in the order of the file.
        truths: formulas of which it is kept where they are true.
        watches: formulas that are bins, or occasions at which bins are looked at.
        groups: what is counted of them.
        constants: captured values that are known while the plan is made; `None` is unknown.
    """

    spec: CheckedSpec
    rules: tuple[PlannedRule, ...]
    graph: Graph
    gap: int | None
    signals: tuple[str, ...]
    events: tuple[str, ...]
    uses: Mapping[str, Uses]
    units: tuple[Plan, ...] = ()
    asked: tuple[PlannedRule, ...] = ()
    truths: tuple[Core, ...] = ()
    watches: tuple[Watch, ...] = ()
    groups: tuple[WatchGroup, ...] = ()
    constants: Mapping[str, Scalar] = field(default_factory=dict)

    @property
    def judges(self) -> Sequence[tuple[int, PlannedRule]]:
        """All that has attempts of its own, with the number of the rule that it belongs to.

        The rules themselves come first, then what judges their attempts in doubt.
        """
        rules = [*enumerate(self.rules)]
        beside = [(owner, one) for owner, rule in rules for one in (rule.hidden, rule.doubted)]
        return rules + [(owner, one) for owner, one in beside if one is not None]

    @property
    def judged(self) -> tuple[PlannedRule, ...]:
        """The rules, then those that judge the attempts in doubt of some of them."""
        return tuple(rule for _, rule in self.judges)


def plan_of(spec: CheckedSpec, rules: Sequence[PlannedRule]) -> Plan:
    """Share the state formulas of requirements and see what they ask of the input."""
    states = (state for rule in rules for state in rule.states)
    captured = [one.value for rule in rules for one in rule.requirement.captures]
    return replace(_shared(spec, states, captured), rules=tuple(rules), asked=tuple(rules))


def plan_in_units(spec: CheckedSpec, rules: Sequence[PlannedRule]) -> Plan:
    """As `plan_of`, those with captured values apart: each attempt or instance is its own run."""
    shared = plan_of(spec, [rule for rule in rules if not rule.is_apart])
    units = tuple(plan_of(spec, [rule]) for rule in rules if rule.is_apart)
    return replace(shared, units=units, asked=tuple(rules))


def plan_of_truths(
    spec: CheckedSpec, formulas: Sequence[Core], captured: Mapping[str, Scalar]
) -> Plan:
    """The plan of what judges nothing: somebody asks where some formulas are true."""
    read = dict.fromkeys(one.proposition for core in formulas for one in literals(core))
    return replace(_shared(spec, read), truths=tuple(formulas), constants=captured)


def plan_of_watches(
    spec: CheckedSpec, watches: Sequence[Watch], groups: Sequence[WatchGroup]
) -> Plan:
    """The plan of what judges nothing: somebody counts where some formulas come true."""
    plan = _shared(spec, (watch.state for watch in watches))
    return replace(plan, watches=tuple(watches), groups=tuple(groups))


def _shared(spec: CheckedSpec, states: Iterable[State], captured: Iterable[Numeric] = ()) -> Plan:
    """The plan of state formulas that nobody asks for yet."""
    graph = graph_of(states)
    names = (tuple(spec.signals), tuple(spec.events))
    return Plan(spec, (), graph, spec.gap, *names, _uses_of(graph, captured))


def _uses_of(graph: Graph, captured: Iterable[Numeric]) -> dict[str, Uses]:
    """What is asked of signals and events."""
    found = {
        name: _uses([graph.nodes[place] for place in places], name)
        for name, places in graph.by_name.items()
    }
    amounts = (node.amount for node in graph.nodes)
    windows = (one.value for one in amounts if isinstance(one, WindowValue))
    # A window reads its number though what is measured can never be, so that no leaf does.
    for expression in (*captured, *(value for value in windows if value is not None)):
        for name in inputs_of(expression):
            found.setdefault(name, Uses())
        for part in operands(expression):
            if isinstance(part, UpdateValue):
                found[part.name] = replace(found[part.name], history=True)
    return found


def _uses(leaves: Sequence[State], name: str) -> Uses:
    return Uses(
        history=any(_asks_history(state, name) for state in leaves),
        marked=any(
            isinstance(state.leaf, ProbeAtom) and state.leaf.probe is not Probe.KNOWN
            for state in leaves
        ),
    )


def _asks_history(state: State, name: str) -> bool:
    leaf = state.leaf
    if isinstance(leaf, ProbeAtom):
        return leaf.probe is Probe.CHANGED
    if isinstance(leaf, Unborn):
        return dict(leaf.signals).get(name, False)
    return isinstance(leaf, Compare) and any(
        isinstance(part, UpdateValue) and part.name == name
        for side in (leaf.left, leaf.right)
        for part in operands(side)
    )
