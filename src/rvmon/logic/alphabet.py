"""Letters: the valuations of propositions that a formula can tell apart, and their classes.

The partition into classes is computed on reduced ordered multi-valued decision diagrams.

Source: Bryant, Graph-based algorithms for Boolean function manipulation, 1986.
"""

from __future__ import annotations

from array import array
from collections.abc import Callable, Mapping, Sequence
from enum import IntEnum
from functools import cache, partial
from typing import TypeAlias

from msgspec import Struct

from rvmon.logic.formula import Core, Literal, Sense, literals
from rvmon.logic.residual import Atom, Residual, decided
from rvmon.logic.state_formula import State


class TruthValue(IntEnum):
    """The value of a proposition in the pessimistic or the optimistic run of an attempt."""

    FALSE = 0
    TRUE = 1
    UNKNOWN_PESSIMISTIC = 2
    UNKNOWN_OPTIMISTIC = 3


_TRUE_IN = {
    Sense.TRUE: frozenset({TruthValue.TRUE, TruthValue.UNKNOWN_OPTIMISTIC}),
    Sense.FALSE: frozenset({TruthValue.FALSE, TruthValue.UNKNOWN_OPTIMISTIC}),
    Sense.KNOWN_FALSE: frozenset({TruthValue.FALSE}),
}


def holds(sense: Sense, truth: TruthValue) -> bool:
    """Whether a literal of this sense is true where its proposition has this truth in a run."""
    return truth in _TRUE_IN[sense]


class Alphabet(Struct, frozen=True):
    """Encodes the values of the propositions at a position as a letter, a number below `size`.

    A letter is the sum of one entry per proposition of `pessimistic` (or `optimistic`), taken at
    the proposition's value.
    """

    propositions: tuple[State, ...]  # in the order of their digits
    # per proposition and digit, a representative of the truths that share the digit
    truths: tuple[tuple[TruthValue, ...], ...]
    strides: tuple[int, ...]  # per proposition, the weight of its digit
    # per proposition, the summands for FALSE, UNKNOWN and TRUE in that run
    pessimistic: tuple[tuple[int, int, int], ...]
    optimistic: tuple[tuple[int, int, int], ...]  # the same for the optimistic run
    size: int  # the number of letters

    def valuation(self, letter: int) -> dict[State, TruthValue]:
        """The truth of each proposition in a letter."""
        return {
            proposition: truths[letter // stride % len(truths)]
            for proposition, truths, stride in zip(
                self.propositions, self.truths, self.strides, strict=True
            )
        }


def alphabet_of(formula: Core) -> Alphabet:
    """The smallest alphabet for a formula.

    A proposition that is read in one sense only needs just two digits, even if it may be unknown.
    """
    senses: dict[State, set[Sense]] = {}
    for literal in literals(formula):
        senses.setdefault(literal.proposition, set()).add(literal.sense)
    propositions = tuple(sorted(senses, key=lambda state: state.id))
    stride = 1
    strides, all_truths, pessimistic, optimistic = [], [], [], []
    for proposition in propositions:
        truths, digit = _digits(frozenset(senses[proposition]))
        strides.append(stride)
        all_truths.append(truths)
        low, high = digit[TruthValue.FALSE] * stride, digit[TruthValue.TRUE] * stride
        pessimistic.append((low, digit[TruthValue.UNKNOWN_PESSIMISTIC] * stride, high))
        optimistic.append((low, digit[TruthValue.UNKNOWN_OPTIMISTIC] * stride, high))
        stride *= len(truths)
    return Alphabet(
        propositions, tuple(all_truths), tuple(strides), tuple(pessimistic), tuple(optimistic),
        stride,
    )  # fmt: skip


@cache
def _digits(
    senses: frozenset[Sense],
) -> tuple[tuple[TruthValue, ...], Mapping[TruthValue, int]]:
    """One digit per set of truths that the senses cannot tell apart."""
    seen: dict[tuple[bool, ...], int] = {}
    truths: list[TruthValue] = []
    digit: dict[TruthValue, int] = {}
    ordered = sorted(senses)
    for truth in TruthValue:
        look = tuple(holds(sense, truth) for sense in ordered)
        if look not in seen:
            seen[look] = len(truths)
            truths.append(truth)
        digit[truth] = seen[look]
    return tuple(truths), digit


Tree = int | tuple[int, tuple["Tree", ...]]
"""A class, or the stride of a digit with a tree for each value of the digit."""


class LetterDiagram(Struct, frozen=True, eq=False):
    """A decision diagram from letters to classes; it tests only the digits that matter."""

    root: Tree

    def __getitem__(self, letter: int) -> int:
        """The class of a letter."""
        node = self.root
        while not isinstance(node, int):
            stride, children = node
            node = children[letter // stride % len(children)]
        return node

    def renamed(self, classes: Sequence[int]) -> LetterDiagram:
        """The diagram with its classes renumbered."""
        made: dict[int, Tree] = {}

        def rename(node: Tree) -> Tree:
            if isinstance(node, int):
                return classes[node]
            found = made.get(id(node))
            if found is None:
                found = made[id(node)] = joined(node[0], tuple(map(rename, node[1])))
            return found

        return LetterDiagram(rename(self.root))


LetterClasses: TypeAlias = "array[int] | LetterDiagram"  # the class of each letter


def joined(stride: int, children: tuple[Tree, ...]) -> Tree:
    """A decision between subtrees, or the subtree if all are the same."""
    first = children[0]
    return first if all(child == first for child in children[1:]) else (stride, children)


Edge = tuple[int, tuple[int, ...]]  # target location and the sources of its clocks
MOST_TABLED = 1 << 16  # the most letters whose classes are kept in a table instead of a diagram


class Node(Struct, frozen=True, eq=False):
    """A decision, or a leaf; equal nodes are the same object."""

    level: int  # the proposition decided on, by its place in the alphabet; −1 for a leaf
    children: tuple[Node, ...] = ()  # per digit of that proposition
    edge: Edge | None = None  # of a leaf


Choice = tuple[int, frozenset[Atom], list[frozenset[Atom]]]
"""The place of a proposition in the alphabet, its literals, and per digit the true ones."""


class Diagrams:
    """Makes the diagrams of a construction; the alphabet's last proposition is decided first."""

    def __init__(self, alphabet: Alphabet) -> None:
        self.alphabet = alphabet
        self._node = cache(Node)
        self._choices = cache(partial(_choices_among, alphabet))

    def of(self, opened: Residual, leaf: Callable[[Residual], Edge]) -> Node:
        """The diagram of a residual in which literals are still open atoms.

        `leaf` returns the edge of a residual without literals.
        """
        atoms = frozenset[Atom]().union(*opened)
        read = frozenset(atom for atom in atoms if isinstance(atom[0], Literal))
        choices = self._choices(read)
        return self._of(opened, leaf, choices, len(choices) - 1, {})

    def _of(
        self,
        opened: Residual,
        leaf: Callable[[Residual], Edge],
        choices: list[Choice],
        place: int,
        made: dict[Residual, Node],
    ) -> Node:
        found = made.get(opened)
        if found is not None:
            return found
        # Skip propositions that the residual no longer reads.
        while place >= 0 and all(map(choices[place][1].isdisjoint, opened)):
            place -= 1
        if place < 0:
            found = self._node(-1, (), leaf(opened))
        else:
            level, atoms, trues = choices[place]
            children = tuple(
                self._of(decided(opened, true, atoms - true), leaf, choices, place - 1, made)
                for true in trues
            )
            first = children[0]
            same = all(child is first for child in children)
            found = first if same else self._node(level, children, None)
        made[opened] = found
        return found

    def classes(
        self, roots: Sequence[Node], limit: int
    ) -> tuple[LetterClasses, int, list[tuple[Edge, ...]]]:
        """Partitions letters into classes: two are in one class if every diagram maps them alike.

        Returns:
            The class of each letter, the number of classes, and per class the edge of each root.

        Raises:
            TooManyClassesError: the limit was exceeded.
        """
        product = _Product(self.alphabet, limit)
        diagram = LetterDiagram(product.tree(tuple(roots)))
        found: LetterClasses = diagram
        # The core looks up a class at each change of a proposition; with a table that is one load.
        if self.alphabet.size <= MOST_TABLED:
            found = array("H", map(diagram.__getitem__, range(self.alphabet.size)))
        edges = [
            tuple(node.edge for node in leaf if node.edge is not None) for leaf in product.leaves
        ]
        return found, len(product.leaves), edges


def _choices_among(alphabet: Alphabet, read: frozenset[Atom]) -> list[Choice]:
    senses: dict[State, dict[Atom, Sense]] = {}
    for atom in read:
        if isinstance(literal := atom[0], Literal):
            senses.setdefault(literal.proposition, {})[atom] = literal.sense
    pairs = zip(alphabet.propositions, alphabet.truths, strict=True)
    found: list[Choice] = []
    for level, (proposition, truths) in enumerate(pairs):
        if own := senses.get(proposition):
            true = [
                frozenset(atom for atom, sense in own.items() if holds(sense, truth))
                for truth in truths
            ]
            found.append((level, frozenset(own), true))
    return found


class TooManyClassesError(Exception):
    """The table of an automaton outgrew its limit."""


class _Product:
    def __init__(self, alphabet: Alphabet, limit: int) -> None:
        self.alphabet = alphabet
        self.limit = limit
        self.leaves: dict[tuple[Node, ...], int] = {}
        self.trees: dict[tuple[Node, ...], Tree] = {}

    def tree(self, nodes: tuple[Node, ...]) -> Tree:
        """The classes of all letters over the propositions on which some of the nodes decide."""
        level = max([node.level for node in nodes])
        if level < 0:
            found = self.leaves.setdefault(nodes, len(self.leaves))
            if len(self.leaves) * len(nodes) > self.limit:
                raise TooManyClassesError
            return found
        known = self.trees.get(nodes)
        if known is None:
            lower = (
                tuple(node.children[digit] if node.level == level else node for node in nodes)
                for digit in range(len(self.alphabet.truths[level]))
            )
            children = tuple(map(self.tree, lower))
            known = self.trees[nodes] = joined(self.alphabet.strides[level], children)
        return known
