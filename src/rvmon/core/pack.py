"""Packs a plan of requirements as the bytes that the core interprets; see native/plan/plan.md.

A plan consists of parts: requirements that share nodes and are judged together.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from math import prod

from rvmon.core.atoms import Atom, Atoms, Names, Programs
from rvmon.core.monitors import SHARED, Judges, Unit
from rvmon.core.nodes import Nodes
from rvmon.core.obligations import Automata, add_form
from rvmon.core.sections import Listed, Numbering, Packed, Section, Sections, bits, packed
from rvmon.errors import RvmonError
from rvmon.language.checked.formula import Compare, Numeric
from rvmon.logic.network_plan import plan_of_all
from rvmon.logic.plan import Plan, Uses
from rvmon.logic.state_formula import events_of, inputs_of
from rvmon.logic.state_graph import keys_of

_WATCH = 8  # the kind of a link that notifies a watch, not a judge
_ITEMS_MOST = 1 << 22  # the most bins and combinations that one part may count

_UNUSED = Uses()


class Part:
    """Packs a part: its nodes, atoms, judges and inputs, and a record that refers to them."""

    def __init__(
        self,
        sections: Sections,
        automata: Automata,
        plan: Plan,
        numbering: Numbering,
        numbers: Sequence[int],
    ) -> None:
        self._sections = sections
        self._plan = plan
        self.names = Names(plan, numbering)
        self._programs = Programs(sections, self.names)
        self._atoms = Atoms(plan, self.names, self._programs)
        self._nodes = Nodes(plan, self.names, self._atoms)
        self._live = [bool(leaves) for leaves in self._nodes.leaves(live=True)]
        self._births: list[int] = [0] * len(self.names.signals)
        self._add(automata, numbers)

    def _add(self, automata: Automata, numbers: Sequence[int]) -> None:
        sections, plan, nodes = self._sections, self._plan, self._nodes
        firsts = {section: sections.count(section) for section in Section}

        def added(section: Section) -> Listed:
            return firsts[section], sections.count(section) - firsts[section]

        judges = Judges(sections, automata, plan, self.names, numbers)
        watched = self._add_groups()
        truths = -1
        if plan.truths:
            truths = added(Section.FORMS)[1]
            network = plan_of_all(plan.truths, plan.gap)
            add_form(sections, network, None, plan.graph.index)
        self._add_nodes(judges, watched)
        self._add_atoms()
        perishable = self._add_signals()
        fields = self._add_events()
        # The order of the fields below is that of `part_plan` in plan.h; the C refuses a plan whose
        # sizes do not agree.
        own: Iterable[int] = SHARED
        if any(rule.captured for rule in plan.rules):
            unit = Unit(plan, numbers[0])
            own = unit.fields(sections, self.names, self._programs, nodes, self._atoms)
        dead = [
            place
            for place, node in enumerate(nodes.all)
            if node.timer >= 0 and place not in nodes.needed
        ]
        sections.add(
            Section.PARTS,
            *added(Section.SIGNALS),
            *added(Section.EVENTS),
            *added(Section.ATOMS),
            *added(Section.NODES),
            *added(Section.JUDGES),
            *added(Section.FORMS),
            len(plan.rules),
            fields,
            nodes.timers,
            nodes.seen,
            nodes.edges,
            nodes.stretches,
            perishable,
            judges.clocks,
            judges.undetermined,
            sum(map(bool, self._births)),
            *sections.listed(nodes.stateful()),
            *sections.listed(judges.networked),
            *own,
            *sections.listed(dead),
            truths,
            *added(Section.WATCHES),
            *added(Section.GROUPS),
            nodes.tallies,
            len(self.names.windows),
        )

    def _phased(self, first: Sequence[int], then: Sequence[int]) -> tuple[int, ...]:
        """Two lists: one in use until all signals are born and triggers determined, one after."""
        return *self._sections.listed(first), *self._sections.listed(then)

    def _add_groups(self) -> dict[int, list[int]]:
        """Add the watches and groups of coverage; returns, by node, the watches it notifies."""
        watched: dict[int, list[int]] = {}
        groups: list[list[int]] = [[] for _ in self._plan.watches]
        first = 0
        for number, group in enumerate(self._plan.groups):
            axes = [number for axis in group.axes for number in (axis.start, len(axis))]
            occasion = -1 if group.occasion is None else group.occasion
            self._sections.add(Section.GROUPS, occasion, first, *self._sections.listed(axes))
            first += prod(map(len, group.axes))
            if first > _ITEMS_MOST:
                raise RvmonError(
                    f"there are more than {_ITEMS_MOST:,} bins and combinations to count: "
                    "split the largest cross up"
                )
            for watch in group.looks_where:
                groups[watch].append(number)
        for number, (state, is_pulse) in enumerate(self._plan.watches):
            place = self._plan.graph.index[state]
            watched.setdefault(place, []).append(number)
            listed = self._sections.listed(groups[number])
            self._sections.add(Section.WATCHES, place, is_pulse, *listed)
        return watched

    def _add_nodes(self, judges: Judges, watched: Mapping[int, Sequence[int]]) -> None:
        sections = self._sections
        for place, node in enumerate(self._nodes.all):
            links = [sections.add(Section.LINKS, *link) for link in judges.links(place)]
            links += (
                sections.add(Section.LINKS, number, _WATCH, *([0] * 6))
                for number in watched.get(place, ())
            )
            sections.add(
                Section.NODES,
                *(node.low, node.high, node.op, node.a, node.b, node.slot, node.timer),
                *sections.listed(node.operands),
                *self._phased(*self._nodes.parents(place)),
                *((links[0], len(links)) if links else (0, 0)),
                *(node.tally, node.most, node.chosen, node.since, 0),
            )

    def _add_atoms(self) -> None:
        sections = self._sections
        shown, live = self._nodes.leaves(live=False), self._nodes.leaves(live=True)
        as_numbers = self._nodes.read_as_numbers
        for number, atom in enumerate(self._atoms.all):
            sections.add(
                Section.ATOMS,
                *(atom.constant, atom.op, atom.compare, atom.input, atom.left, atom.right),
                atom.momentary,
                *sections.listed(atom.events),
                *self._phased(shown[number], live[number]),
                number in as_numbers,
            )

    def _readers(self, count: int, read: Callable[[Atom], Iterable[int]]) -> list[list[int]]:
        """By number of a name, the atoms that read it.

        Args:
            count: the number of names.
            read: the numbers of the names that an atom reads.
        """
        found: list[list[int]] = [[] for _ in range(count)]
        for number, atom in enumerate(self._atoms.all):
            for name in read(atom):
                found[name].append(number)
        return found

    def _alive(self, atoms: Sequence[int]) -> list[int]:
        """The atoms with a node still needed once signals are born and triggers determined."""
        return [number for number in atoms if self._live[number]]

    def _add_signals(self) -> int:
        """Add the signals; returns how many of them can go stale."""
        plan, sections, count = self._plan, self._sections, len(self.names.signals)
        on_change = self._readers(count, lambda atom: atom.values)
        on_update = self._readers(count, lambda atom: atom.updates)
        needs = self._readers(count, lambda atom: atom.lone_signals)
        on_birth: list[list[int]] = [[] for _ in range(count)]
        for place, number, moved in self._nodes.born_with():
            on_birth[number].append(place)
            self._births[number] = max(self._births[number], 1 + moved)
        captured = inputs_of(*self._captured)
        perishable = 0
        for name, number in self.names.signals.items():
            signal = plan.spec.signals[name]
            uses = plan.uses.get(name, _UNUSED)
            perishes = signal.stale_after is not None
            sections.add(
                Section.SIGNALS,
                signal.stale_after or 0,
                self.names.numbering.names[name],
                bits(signal.ignores_nan, uses.marked, uses.history, name in captured),
                self._births[number],
                perishable if perishes else -1,
                *self._phased(on_change[number], self._alive(on_change[number])),
                *self._phased(on_update[number], self._alive(on_update[number])),
                *sections.listed(on_birth[number]),
                *sections.listed(needs[number]),
                0,
            )
            perishable += perishes
        return perishable

    @property
    def _captured(self) -> list[Numeric]:
        """The expressions captured by `let`."""
        return [capture.value for rule in self._plan.rules for capture in rule.requirement.captures]

    def _add_events(self) -> int:
        """Add the events; returns how many fields they have."""
        plan, sections = self._plan, self._sections
        readers = self._readers(len(self.names.events), lambda atom: atom.occurrences)
        compared = [node.leaf for node in plan.graph.nodes if isinstance(node.leaf, Compare)]
        sides = [side for leaf in compared for side in (leaf.left, leaf.right)]
        with_fields = events_of(*sides, *self._captured)
        key = self.names.key
        keyed = self._keyed()
        first = 0
        for name, number in self.names.events.items():
            marked, is_key = plan.uses.get(name, _UNUSED).marked, key and name == key.event
            fields = len(plan.spec.events[name].fields)
            sections.add(
                Section.EVENTS,
                self.names.numbering.names[name],
                bits(marked, name in with_fields, is_key),
                first,
                fields,
                keyed.get(name, -1),
                *self._phased(readers[number], self._alive(readers[number])),
                *sections.listed(readers[number]),
                0,
            )
            first += fields
        return first

    def _keyed(self) -> dict[str, int]:
        """By event, the field that selects the instance; an event without one concerns all."""
        each = next((rule.requirement.for_each for rule in self._plan.rules), None)
        if each is None:
            return {}
        # A field captured by `let` is read wherever its event occurs, in whatever instance.
        states = (state for rule in self._plan.judged for state in rule.states)
        fields = keys_of(self._plan.graph, each, states)
        for event in events_of(*self._captured):
            if event != each.value.event:
                fields.pop(event, None)
        return {event: self.names.field(event, field.field) for event, field in fields.items()}


def pack(plan: Plan) -> Packed:
    """Pack a plan: one part for all requirements without captures, and one for each other one.

    Raises:
        RvmonError: an expression, or the number of bins, exceeds the limits of the core.
    """
    sections = Sections()
    automata = Automata(sections)
    numbering = Numbering(plan.spec)
    number = {id(rule): place for place, rule in enumerate(plan.all_rules)}
    parts = [
        Part(sections, automata, one, numbering, [number[id(rule)] for rule in one.rules])
        for one in (plan, *plan.units)
    ]
    _subscribe(sections, plan, parts)
    sizes = (
        len(plan.signals),
        len(plan.events),
        sum(len(event.fields) for event in plan.spec.events.values()),
        len(plan.all_rules),
        max((len(rule.captured) for rule in plan.all_rules), default=0),
    )
    ids = tuple(rule.requirement.id for rule in plan.all_rules)
    return packed(plan.spec, ids, sections.data(plan.gap or 0, sizes))


def _subscribe(sections: Sections, plan: Plan, parts: list[Part]) -> None:
    """Add the first field of each event, and for each name the parts that read it."""
    first = 0
    sections.add(Section.FIELD_FIRST, first)
    for event in plan.spec.events.values():
        first += len(event.fields)
        sections.add(Section.FIELD_FIRST, first)
    sections.add(Section.SUBSCRIPTION_FIRST, 0)
    names = [(name, [part.names.signals for part in parts]) for name in plan.signals]
    names += [(name, [part.names.events for part in parts]) for name in plan.events]
    for name, numbers in names:
        for part, local in enumerate(numbers):
            if name in local:
                sections.add(Section.SUBSCRIPTIONS, part, local[name])
        sections.add(Section.SUBSCRIPTION_FIRST, sections.count(Section.SUBSCRIPTIONS))
