"""Packs what attempts require: automata as tables, formulas as networks.

Equal tables are packed once. Letter classes are packed as tables or diagrams. Networks serve
verdicts and robustness.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from enum import IntEnum, auto
from typing import assert_never

from rvmon.core.sections import Listed, Section, Sections
from rvmon.language.checked.arithmetic import UnitRule
from rvmon.language.checked.formula import (
    Arithmetic,
    Compare,
    FieldValue,
    Numeric,
    SignalValue,
    UpdateValue,
    WindowValue,
)
from rvmon.language.checked.formula import Literal as Number
from rvmon.language.checked.specification import CheckedSpec, Requirement
from rvmon.language.checked.window_measures import Dimension
from rvmon.logic.alphabet import Alphabet, LetterClasses, LetterDiagram, Tree
from rvmon.logic.automaton import Automaton, end_clauses
from rvmon.logic.formula import Constant, Literal, Sense
from rvmon.logic.network_plan import Junction, Leaf, NetworkPlan, Node, Shift, Sweep, Window
from rvmon.logic.state_formula import FALSE, TRUE, UNKNOWN, State, events_of
from rvmon.logic.window_chains import Chain, reach_of
from rvmon.trace.schema import Kind
from rvmon.units import parse_unit

_FARTHEST = (1 << 62) - 2
"""The bound, in ticks, to which offsets are clamped; no two instants are farther apart."""

_NEVER = (1 << 63) - 1

_PAST = -1  # the deadline field of a window of the past

_WORSE, _BETTER = 1, 2


class Operator(IntEnum):
    """Kinds of operators."""

    LEAF = 0
    JUNCTION = auto()
    WINDOW = auto()
    SHIFT = auto()
    UNTIL = auto()
    SINCE = auto()


def add_form(
    sections: Sections, plan: NetworkPlan, chain: Chain | None, index: Mapping[State, int]
) -> int:
    """Add the formula of a network; returns its index.

    Args:
        sections: the sections of the plan.
        plan: the network of the formula.
        chain: its description as a chain of windows; `None` if it is not one.
        index: the node of each proposition.
    """
    operators = add_operators(sections, plan, index)
    own: tuple[int, ...] = (*sections.listed(()), -1, -1, -1)
    if chain is not None:
        ends = (-1 if place is None else place for place in (chain.left, chain.excused))
        own = (*sections.listed(chain.places), chain.base, *ends)
    reach = reach_of(plan)
    ticks = _NEVER if reach is None else min(reach, _FARTHEST)
    return sections.add(
        Section.FORMS, ticks, *operators, len(plan.leaves), plan.looks_back, *own, 0
    )


def add_operators(sections: Sections, plan: NetworkPlan, index: Mapping[State, int]) -> Listed:
    """Add the nodes of a network; returns their slice. Arguments are those of `add_form`."""
    first = sections.count(Section.OPERATORS)
    leaves = 0
    for node in plan.nodes:
        _add(sections, plan, node, leaves, index)
        leaves += isinstance(node, Leaf)
    return first, len(plan.nodes)


def _add(
    sections: Sections, plan: NetworkPlan, node: Node, leaves: int, index: Mapping[State, int]
) -> None:
    def add(
        kind: Operator,
        left: int = -1,
        right: int = -1,
        *,
        turned: bool = False,
        kept: bool = False,
        ticks: tuple[int, int, int] = (0, 0, 0),
        operands: Sequence[int] = (),
        values: Sequence[int] = (0, 0, 0),
    ) -> None:
        bounded = (max(-_FARTHEST, min(tick, _FARTHEST)) for tick in ticks)
        listed = sections.listed(operands)
        how = kind, turned, kept, left, right
        sections.add(Section.OPERATORS, *bounded, *how, *listed, *values)

    match node:
        case Leaf(core=core):
            place = -1 if isinstance(core, Constant) else index[core.proposition]
            add(Operator.LEAF, leaves, place, values=_values(core))
        case Junction(operands=operands, every=every):
            add(Operator.JUNCTION, turned=every, operands=operands)
        case Window(operand=operand, low=low, high=high, every=every, over=over):
            ticks = low, high, _PAST if over is None else over
            add(Operator.WINDOW, operand, turned=every, ticks=ticks)
        case Sweep(left=left, right=right, future=future, dual=dual, kept=kept):
            kind = Operator.UNTIL if future else Operator.SINCE
            add(kind, left, right, turned=dual, kept=kept)
        case Shift(operand=operand, offset=offset, opens=opens):
            kept = plan.sweep_of(node).kept
            add(Operator.SHIFT, operand, kept=kept, ticks=(offset, offset, opens))
        case _:
            assert_never(node)


def _values(core: Literal | Constant) -> list[int]:
    """The two-bit reading (pessimistic, optimistic) of a leaf for FALSE, UNKNOWN and TRUE."""
    if isinstance(core, Constant):
        return [(_WORSE + _BETTER) * core.value] * 3
    wanted = TRUE if core.sense is Sense.TRUE else FALSE
    # An unknown literal is false in the pessimistic run and true in the optimistic one; a test of
    # knowledge is false in both.
    unknown = 0 if core.sense is Sense.KNOWN_FALSE else _BETTER
    return [
        unknown if value == UNKNOWN else (_WORSE + _BETTER) * (value == wanted)
        for value in (FALSE, UNKNOWN, TRUE)
    ]


class Measure(IntEnum):
    """The ways to compute the robustness of a leaf."""

    CONSTANT = 0
    TRUTH = auto()
    DENIED = auto()
    DISTANCE = auto()


def add_margin(
    sections: Sections,
    plan: NetworkPlan,
    index: Mapping[State, int],
    spec: CheckedSpec,
    requirement: Requirement,
) -> None:
    """Add the robustness formula of the judge added last."""
    measures = sections.count(Section.MEASURES)
    for _, core in plan.leaves:
        sections.add(Section.MEASURES, *_measure(core, index, spec, requirement), 0)
    operators = add_operators(sections, plan, index)
    count = len(plan.leaves)
    sections.add(Section.MARGINS, *operators, measures, count, plan.looks_back, 0)


def _measure(
    core: Literal | Constant,
    index: Mapping[State, int],
    spec: CheckedSpec,
    requirement: Requirement,
) -> tuple[float, int, int, int]:
    """The measure of a leaf: factor to base units, kind, whether it is negated, and node."""
    if isinstance(core, Constant):
        return 1.0, Measure.CONSTANT, not core.value, -1
    state = core.proposition
    node = index[state]
    if core.sense is Sense.KNOWN_FALSE:
        return 1.0, Measure.DENIED, False, node
    turned = core.sense is not Sense.TRUE
    leaf = state.leaf or state.compared
    if not isinstance(leaf, Compare) or _compares_labels(leaf, spec, requirement):
        return 1.0, Measure.TRUTH, turned, node
    return base_factor(leaf, spec), Measure.DISTANCE, turned, node


def is_followed(core: Literal | Constant, spec: CheckedSpec, requirement: Requirement) -> bool:
    """Whether measuring a leaf needs its node to be kept up to date once all signals are born.

    A distance is computed from the values alone, without the node.
    """
    if isinstance(core, Constant):
        return False
    leaf = core.proposition.leaf
    return (
        core.sense is Sense.KNOWN_FALSE
        or not isinstance(leaf, Compare)
        or bool(events_of(leaf.left, leaf.right))
        or _compares_labels(leaf, spec, requirement)
    )


def _compares_labels(leaf: Compare, spec: CheckedSpec, requirement: Requirement) -> bool:
    """Whether a comparison is between labels, which have no distance."""
    return Kind.LABEL in (spec.kind_of(side, requirement) for side in (leaf.left, leaf.right))


def base_factor(leaf: Compare, spec: CheckedSpec) -> float:
    """The factor from the unit of a comparison to SI base units; 1 for products of units."""
    sides = (leaf.left, leaf.right)
    written: Sequence[str] = [side.unit for side in sides if isinstance(side, Number) and side.unit]
    units = [*written, *(_unit(side, spec) for side in sides)]
    return float(parse_unit(next((unit for unit in units if unit), "")).factor)


def _unit(expression: Numeric, spec: CheckedSpec) -> str:
    """The unit of an expression's value; "" if it has none, or a product of units."""
    match expression:
        case Number(unit=unit):
            return unit
        case SignalValue(name=name) | UpdateValue(name=name):
            return spec.signals[name].type.unit
        case FieldValue(event=event, field=field):
            return spec.events[event].fields[field].unit
        case WindowValue(measured=measured, value=value) if value is not None:
            return _unit(value, spec) if measured.dimension is Dimension.SAME else ""
        case Arithmetic(op=op, args=args) if op.entry.unit in (UnitRule.SAME, UnitRule.TURN):
            return next((unit for arg in args if (unit := _unit(arg, spec))), "")
        case _:
            return ""


class Automata:
    """Packs automata."""

    def __init__(self, sections: Sections) -> None:
        self._sections = sections
        self._packed: dict[int, tuple[Automaton, int]] = {}

    def place(self, automaton: Automaton) -> int:
        """The index of an automaton; equal tables are stored once."""
        known = self._packed.get(id(automaton))
        if known is None:
            known = self._packed[id(automaton)] = automaton, self._place(automaton)
        return known[1]

    def _place(self, automaton: Automaton) -> int:
        width = max(automaton.clocks, 1)
        class_of = automaton.class_of  # empty if a diagram is used instead
        classes = [0] * _is_lone(class_of) if isinstance(class_of, LetterDiagram) else class_of
        cut_first, cuts, strides = _regions(automaton, width)
        clause_first, test_first, tests, ages = _clauses(automaton)
        ints = self._ints
        return self._sections.shared(
            Section.AUTOMATA,
            automaton.initial,
            len(automaton.locations),
            width,
            automaton.classes,
            len(classes),
            len(automaton.time_values),
            max(len(automaton.targets), 1),
            ints(classes),
            ints(automaton.bases),
            ints([len(location.cuts) for location in automaton.locations]),
            ints(strides),
            ints(cut_first),
            self._sections.run(Section.TICKS, cuts),
            ints([max(edge, 0) for edge in automaton.edges]),  # unreachable: any edge will do
            ints(automaton.targets or [0]),
            ints([one for own in automaton.sources or [()] for one in _padded(own, width)]),
            ints(tuple(automaton.time_values)),  # bytes: `array` would take them as raw memory
            ints(clause_first),
            ints(test_first),
            ints(tests),
            self._sections.run(Section.TICKS, ages),
            0,
        )

    def _ints(self, values: Sequence[int]) -> int:
        return self._sections.run(Section.INTS, values)

    def diagram(self, class_of: LetterClasses, alphabet: Alphabet) -> int:
        """The place of the decision diagram for letter classes; −1 if a table is used."""
        if not isinstance(class_of, LetterDiagram) or _is_lone(class_of):
            return -1
        levels = {stride: level for level, stride in enumerate(alphabet.strides)}
        nodes = _decisions(class_of.root)
        offsets, size = dict[int, int](), 0
        for _, children in nodes:
            offsets[id(children)] = size
            size += 8 + len(children)
        first = self._sections.count(Section.INTS)
        words = list[int]()
        for stride, children in nodes:
            level = levels[stride]
            weights = *alphabet.pessimistic[level], *alphabet.optimistic[level]
            words += [level, *(weight // stride for weight in weights), len(children)]
            words += [
                ~child if isinstance(child, int) else first + offsets[id(child[1])]
                for child in children
            ]
        return self._ints(words)


def _decisions(root: Tree) -> list[tuple[int, tuple[Tree, ...]]]:
    """The decision nodes of a diagram, parents before children."""
    found: dict[int, tuple[int, tuple[Tree, ...]]] = {}
    stack = [root]
    while stack:
        node = stack.pop()
        if not isinstance(node, int) and id(node[1]) not in found:
            found[id(node[1])] = node
            stack += node[1]
    # A decision leads only to decisions with smaller strides.
    return sorted(found.values(), key=lambda node: -node[0])


def _is_lone(class_of: LetterClasses) -> bool:
    """Whether a diagram has all letters in one class."""
    return isinstance(class_of, LetterDiagram) and isinstance(class_of.root, int)


def _padded(values: Sequence[int], width: int) -> list[int]:
    return [*values, *[0] * (width - len(values))]


def _regions(automaton: Automaton, width: int) -> tuple[list[int], list[int], list[int]]:
    """Offsets of the cuts per location and clock, all cuts, strides per location and clock."""
    first, cuts, strides = [0], list[int](), list[int]()
    for location, own in zip(automaton.locations, automaton.strides, strict=True):
        strides += _padded(own, width)
        for clock in range(width):
            if clock < len(location.cuts):
                cuts += location.cuts[clock]
            first.append(len(cuts))
    return first, cuts, strides


def _clauses(automaton: Automaton) -> tuple[list[int], list[int], list[int], list[int]]:
    """The rule for the end: first clause per location, first test per clause, tests, ages."""
    clause_first, test_first = [0], [0]
    tests, ages = list[int](), list[int]()
    for location in automaton.locations:
        for clause in end_clauses(location.residual):
            for clock, age, at_end in clause:
                tests += [clock, int(at_end)]
                ages.append(age)
            test_first.append(len(ages))
        clause_first.append(len(test_first) - 1)
    return clause_first, test_first, tests, ages
