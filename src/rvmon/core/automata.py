"""Packs automata as integer tables, equal tables once, and letter classes as diagrams."""

from __future__ import annotations

from collections.abc import Sequence

from rvmon.core.sections import Section, Sections
from rvmon.logic.alphabet import Alphabet, LetterClasses, LetterDiagram, Tree
from rvmon.logic.automaton import Automaton, end_clauses


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
            ints(tuple(automaton.time_values)),  # as numbers, not as bytes
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
    # Strides grow with the level, and a decision only leads to lower levels.
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
