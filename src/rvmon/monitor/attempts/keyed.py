"""The instances of one `for each`: which are open, whom a sample concerns, which are over."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from rvmon.formula.state import Leaf, State, StateOp
from rvmon.monitor.attempts.evaluator import Evaluator
from rvmon.monitor.attempts.instance import Instance, values_in
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.plan.graph import Graph
from rvmon.plan.leaves import captured_names
from rvmon.plan.numbers import events_of
from rvmon.spec.checked.formula import Captured, Compare, CompareOp, EventAtom, FieldValue
from rvmon.spec.checked.specification import ForEach
from rvmon.trace.sample import Scalar, Value

MOST_OPEN = 50_000
"""So many instances of one requirement can be open at once."""

MOST_KNOWN = 10_000
"""So many values that are over are remembered, the latest."""


@dataclass(frozen=True, slots=True)
class Reach:
    """What an instance depends on; worked out once for a requirement.

    Attributes:
        varying: the nodes whose value depends on the instance's, though its event does not occur.
        own: these, and those that read its event.
        fields: by event, the field that has to have the value; else it does not concern it.
        others: the names that concern all instances.
        is_fresh: whether one can be made from what an instance of no value remembers.
        begins: whether nothing starts in it but where its event occurs.
    """

    varying: frozenset[int]
    own: frozenset[int]
    fields: Mapping[str, FieldValue]
    others: frozenset[str]
    is_fresh: bool
    begins: bool


def reach_of(compiled: CompiledRequirement, each: ForEach) -> Reach:
    """What the instances of a requirement depend on.

    Occurrences of its event that an instance of no value sees are unknown, and so are comparisons
    of their fields, with whatever value.
    """
    graph, event = compiled.shared_graph, each.value.event
    leaves = {place: state.leaf for place, state in enumerate(graph.nodes) if state.leaf}
    reads = {place for place, leaf in leaves.items() if each.name in captured_names(leaf)}
    own = frozenset(graph.by_name.get(event, ()))
    varying = _above(graph, reads - own)
    fields = {event: each.value}
    for name, places in graph.by_name.items():
        found = {_compared(leaves[place], name, each.name) for place in places}
        field = found.pop()
        if name != event and not found and field is not None:
            fields[name] = field
    trigger = compiled.obligation.trigger
    return Reach(
        varying,
        _above(graph, reads | own),
        fields,
        frozenset(graph.by_name.keys() - fields.keys()),
        varying.isdisjoint(graph.stateful) and not compiled.network_plan.looks_back,
        trigger is not None and _occurs(trigger, event),
    )


def _above(graph: Graph, leaves: Iterable[int]) -> frozenset[int]:
    """Some nodes and all that depend on them."""
    found = set(leaves)
    for place, operands in enumerate(graph.operands):
        if not found.isdisjoint(operands):
            found.add(place)
    return frozenset(found)


def _compared(leaf: Leaf, event: str, name: str) -> FieldValue | None:
    """The field of an event that a leaf compares with a captured value, if it asks no more."""
    match leaf:
        case Compare(CompareOp.EQ, FieldValue() as field, Captured(name=found)):
            pass
        case Compare(CompareOp.EQ, Captured(name=found), FieldValue() as field):
            pass
        case _:
            return None
    return field if found == name and field.event == event else None


def _occurs(state: State, event: str) -> bool:
    """Whether a state formula is FALSE wherever an event does not occur."""
    match state.leaf:
        case None:
            pass
        case EventAtom(name=name):
            return name == event
        case Compare(left=left, right=right):
            return event in events_of(left, right)
        case _:
            return False
    match state.op:
        case StateOp.AND:
            return any(_occurs(one, event) for one in state.args)
        case StateOp.OR:
            return all(_occurs(one, event) for one in state.args)
        case StateOp.SURE | StateOp.DOUBT:
            return _occurs(state.args[0], event)
        case _:
            return False


class Keyed:
    """The instances of a requirement in one run.

    Args:
        compiled: the requirement.
        each: of it.
        template: the evaluator of the instance of no value.
        instance: that instance.
        is_timed: whether only what changes is looked at; else each sample concerns all.

    Attributes:
        known: the values that occurred, but for those that were forgotten.
        open: the evaluators of those that are not over.
        reach: what they depend on.
    """

    def __init__(
        self,
        compiled: CompiledRequirement,
        each: ForEach,
        template: Evaluator,
        instance: Instance,
        *,
        is_timed: bool,
    ) -> None:
        self.compiled = compiled
        self.each = each
        self.template = template
        self.doubted = instance
        self.known: dict[Scalar, Instance] = {}
        self.open: dict[Scalar, Evaluator] = {}
        self.reach = reach_of(compiled, each)
        self._last_rank = 0
        self._over: dict[Scalar, None] = {}
        self._sees_all = not is_timed or bool(compiled.requirement.captures)

    def instances(self) -> list[Instance]:
        """Those that are known, first those that are over, in the order in which they were."""
        return [self.known[value] for value in (*self._over, *self.open)]

    def take(self, found: Iterable[Instance]) -> None:
        """Know the instances of another run; none of them is open."""
        for one in found:
            self.known[one.value] = one
            self._over[one.value] = None
            self._last_rank = max(self._last_rank, one.rank)

    def values_to_open(self, values: Mapping[str, Value]) -> list[Scalar]:
        """The values of which a sample asks for the instance, and that have no evaluator.

        An occurrence of unknown value may be of any that is known.
        """
        occurring = dict.fromkeys(values_in(self.each.value, values))
        if None in occurring:
            occurring |= self._over
        return [one for one in occurring if one is not None and one not in self.open]

    def opened(self, value: Scalar, evaluator: Evaluator) -> None:
        """Take the evaluator of an instance."""
        self._over.pop(value, None)
        self.open[value] = evaluator

    def instance(self, value: Scalar, t: int) -> Instance:
        """The instance of a value that occurs at `t`."""
        found = self.known.get(value)
        if found is None:
            self._last_rank += 1
            found = self.known[value] = Instance(self._last_rank, self.each.value, value, t)
        return found

    def concerned(self, values: Mapping[str, Value]) -> list[Scalar]:
        """The open instances that a sample concerns."""
        if self._sees_all or not self.reach.others.isdisjoint(values):
            return list(self.open)
        found: dict[Scalar, None] = {}
        for event, field in self.reach.fields.items():
            if event in values:
                found.update(dict.fromkeys(values_in(field, values)))
        return list(self.open) if None in found else [one for one in found if one in self.open]

    def is_over(self, evaluator: Evaluator) -> bool:
        """Whether an instance stands as one would that is made anew when its value occurs next."""
        return (
            self.reach.begins
            and self.reach.is_fresh
            and evaluator.is_quiet
            and evaluator.stands_like(self.template, self.reach.varying)
        )

    def close(self, value: Scalar) -> None:
        """Let go of an instance that is over; its value is remembered for a while."""
        del self.open[value]
        self._over[value] = None
        if len(self._over) > MOST_KNOWN:
            oldest = next(iter(self._over))
            del self._over[oldest], self.known[oldest]
