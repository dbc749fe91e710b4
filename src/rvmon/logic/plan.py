"""The plan of a run of the core: the formulas, inputs and automata of some requirements."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import chain
from typing import NamedTuple

from msgspec import Struct, field
from msgspec.structs import replace

from rvmon.language.checked import formula as rv
from rvmon.language.checked.specification import CheckedSpec, Requirement
from rvmon.logic.alphabet import Alphabet
from rvmon.logic.automaton import Automaton
from rvmon.logic.formula import Core, literals
from rvmon.logic.state_formula import State, Unborn, inputs_of, operands
from rvmon.logic.state_graph import Graph, graph_of
from rvmon.trace.sample import Scalar


class PlannedRule(Struct, frozen=True, eq=False):
    """One requirement, lowered and ready to be packed."""

    requirement: Requirement
    trigger: State | None  # starts an attempt; `None` if the end of the trace does
    required: Core  # the formula an attempt must satisfy
    alphabet: Alphabet  # of `required`
    automaton: Automaton | None  # judges the attempts; `None` if a network does
    # whether the number of different states of its open attempts may grow without bound
    scatters: bool = False
    # of a `whenever`, not FALSE where an episode resumes after a failure; `None` if it never
    # resumes, or the requirement is not a `whenever`
    again: State | None = None
    # of a level `whenever`, TRUE while a signal of its consequent had no value
    unborn: State | None = None
    # TRUE once the trigger was TRUE or FALSE; `None` if that is not tracked
    determined: State | None = None
    # judges the attempts in doubt of an `upon`; `None` if there are none. An attempt in doubt
    # starts where its trigger is UNKNOWN and none is open, and ends where it is FALSE
    hidden: PlannedRule | None = None
    # the leaves whose values a record shows; they are nodes of the graph
    noted: tuple[State, ...] = ()
    doubted: PlannedRule | None = None  # the same as `hidden`, for an instance that may not exist
    running: State | None = None  # of an episode with captured values, FALSE where it is over
    # of attempts with captured values, UNKNOWN where another attempt, with other values, may have
    # started; `None` if that is impossible
    blurs: State | None = None
    # whether, in an instance with an unknown key, another attempt may have started anywhere
    blurs_anywhere: bool = False
    also_read: tuple[State, ...] = ()  # further state formulas whose values are needed
    captures_known: tuple[State, ...] = ()  # TRUE where the numbers captured from windows are known
    # whether it must be judged by stepping attempts, not as a chain of windows
    stepped: bool = False
    # whether the path of attempts through the automaton is needed; implies `stepped`
    traced: bool = False
    # `required` in the form that preserves robustness; `None` if that is not computed
    measured: Core | None = None

    @property
    def states(self) -> Iterator[State]:
        """The state formulas whose values are needed; may repeat."""
        named = (self.trigger, self.again, self.unborn, self.determined, self.running, self.blurs)
        yield from (state for state in named if state is not None)
        yield from self.alphabet.propositions
        yield from self.also_read
        yield from self.captures_known
        for rule in (self.hidden, self.doubted):
            if rule is not None:
                yield from rule.states

    @property
    def captured(self) -> tuple[str, ...]:
        """The names of the captured values of an attempt: of `for each`, then of `let`."""
        return tuple(self.requirement.captured)


class Uses(Struct, frozen=True, eq=False):
    """The uses of a signal or event in addition to its present value."""

    # whether the last two updates are read (`prev`, `delta`, `rate`, `changed`)
    history: bool = False
    marked: bool = False  # whether it is read that there was an update (`updated`, `changed`)


class Watch(NamedTuple):
    """A formula counted for coverage: a bin, or an occasion to sample bins."""

    state: State
    is_pulse: bool


class WatchGroup(Struct, frozen=True):
    """A coverpoint or a cross; an item is a combination of one watch from each axis."""

    # ranges of watch numbers; items are numbered with the last axis fastest
    axes: tuple[range, ...]
    occasion: int | None  # the watch at which the group is sampled; `None` for every change

    @property
    def looks_where(self) -> Iterable[int]:
        """The watches on whose change the group is sampled."""
        return chain.from_iterable(self.axes) if self.occasion is None else (self.occasion,)


class Plan(Struct, frozen=True, eq=False):
    """Some requirements of a specification, for one run of the core."""

    spec: CheckedSpec  # for names, types and the time model
    rules: tuple[PlannedRule, ...]  # in the order of the file
    graph: Graph  # their state formulas, shared
    gap: int | None  # ticks between two positions; `None` if only samples are positions
    signals: tuple[str, ...]  # all names of the specification; the index of a name is its number
    events: tuple[str, ...]  # the same
    uses: Mapping[str, Uses]  # by name, for all names that are read, also for captured values
    units: tuple[Plan, ...] = ()  # one plan for each requirement with captured values
    # all rules, with those of the units, in the order of the file
    all_rules: tuple[PlannedRule, ...] = ()
    truths: tuple[Core, ...] = ()  # formulas whose truth over the whole trace is kept
    # the bins of coverage, and the occasions at which they are sampled
    watches: tuple[Watch, ...] = ()
    groups: tuple[WatchGroup, ...] = ()  # the coverpoints and crosses over them
    # captured values that are constants of this plan; `None` is unknown
    constants: Mapping[str, Scalar] = field(default_factory=dict)

    @property
    def judges(self) -> Sequence[tuple[int, PlannedRule]]:
        """The rules, then the judges of their attempts in doubt, each with its rule's number."""
        rules = [*enumerate(self.rules)]
        for_doubts = [
            (owner, planned_rule)
            for owner, rule in rules
            for planned_rule in (rule.hidden, rule.doubted)
        ]
        return rules + [(owner, rule) for owner, rule in for_doubts if rule is not None]

    @property
    def judged(self) -> tuple[PlannedRule, ...]:
        """`judges` without the numbers."""
        return tuple(rule for _, rule in self.judges)


def plan_of(spec: CheckedSpec, rules: Sequence[PlannedRule]) -> Plan:
    """The plan of requirements as one unit, with shared state formulas."""
    states = (state for rule in rules for state in rule.states)
    captured = [capture.value for rule in rules for capture in rule.requirement.captures]
    return replace(_shared(spec, states, captured), rules=tuple(rules), all_rules=tuple(rules))


def plan_in_units(spec: CheckedSpec, rules: Sequence[PlannedRule]) -> Plan:
    """As `plan_of`, with a unit of its own for each requirement with captured values.

    Each attempt or instance of a unit is a run of its own.
    """
    # State formulas of rules without captures are evaluated once for all attempts. In a unit each
    # attempt evaluates its own.
    shared = plan_of(spec, [rule for rule in rules if not rule.captured])
    units = tuple(plan_of(spec, [rule]) for rule in rules if rule.captured)
    return replace(shared, units=units, all_rules=tuple(rules))


def plan_of_truths(
    spec: CheckedSpec, formulas: Sequence[Core], captured: Mapping[str, Scalar]
) -> Plan:
    """A plan without requirements that evaluates formulas; `captured` values are constants."""
    read = dict.fromkeys(literal.proposition for core in formulas for literal in literals(core))
    return replace(_shared(spec, read), truths=tuple(formulas), constants=captured)


def plan_of_watches(
    spec: CheckedSpec, watches: Sequence[Watch], groups: Sequence[WatchGroup]
) -> Plan:
    """A plan without requirements that counts coverage: bins and occasions, and their groups."""
    plan = _shared(spec, (watch.state for watch in watches))
    return replace(plan, watches=tuple(watches), groups=tuple(groups))


def _shared(
    spec: CheckedSpec, states: Iterable[State], captured: Iterable[rv.Numeric] = ()
) -> Plan:
    """A plan with only the graph of the state formulas, without rules or watches."""
    graph = graph_of(states)
    names = (tuple(spec.signals), tuple(spec.events))
    return Plan(spec, (), graph, spec.gap, *names, _uses_of(graph, captured))


def _uses_of(graph: Graph, captured: Iterable[rv.Numeric]) -> dict[str, Uses]:
    """By name, the uses of signals and events; `captured` are the expressions of `let`."""
    amounts = (node.amount for node in graph.nodes)
    windows = (amount.value for amount in amounts if isinstance(amount, rv.WindowValue))
    # The number that a window measures is not a leaf of the graph.
    numbers = [*captured, *(value for value in windows if value is not None)]
    history, marked = set[str](), set[str]()
    for node in graph.nodes:
        match node.leaf:
            case rv.ProbeAtom(probe=probe, name=name) if probe is not rv.Probe.KNOWN:
                marked.add(name)
                if probe is rv.Probe.CHANGED:
                    history.add(name)
            case Unborn(signals=signals):
                history.update(name for name, moved in signals if moved)
            case rv.Compare(left=left, right=right):
                numbers += (left, right)
    history.update(part.name for part in operands(*numbers) if isinstance(part, rv.UpdateValue))
    names = dict.fromkeys((*graph.by_name, *inputs_of(*numbers)))
    return {name: Uses(name in history, name in marked) for name in names}
