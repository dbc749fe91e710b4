"""The class of each letter: a table where letters are few, else a diagram of what matters."""

from __future__ import annotations

from array import array
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

Tree = int | tuple[int, tuple["Tree", ...]]
"""A class; or the stride of a digit, and a tree for each value of it."""


@dataclass(frozen=True, slots=True, eq=False)
class LetterDiagram:
    """Looks up the class of a letter by its digits, those only that matter.

    Attributes:
        root: of the diagram; equal parts are the same object.
    """

    root: Tree

    def __getitem__(self, letter: int) -> int:
        """The class of a letter."""
        node = self.root
        while not isinstance(node, int):
            stride, children = node
            node = children[letter // stride % len(children)]
        return node

    def renamed(self, classes: Sequence[int]) -> LetterDiagram:
        """The same with other numbers for the classes."""
        made: dict[int, Tree] = {}

        def rename(node: Tree) -> Tree:
            if isinstance(node, int):
                return classes[node]
            found = made.get(id(node))
            if found is None:
                found = made[id(node)] = joined(node[0], tuple(map(rename, node[1])))
            return found

        return LetterDiagram(rename(self.root))


LetterClasses: TypeAlias = "array[int] | LetterDiagram"
"""The class of each letter."""


def joined(stride: int, children: tuple[Tree, ...]) -> Tree:
    """A decision, or its only outcome."""
    first = children[0]
    return first if all(child == first for child in children[1:]) else (stride, children)
