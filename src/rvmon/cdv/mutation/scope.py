"""What the mutation operators ask of the code around a node."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from functools import cached_property

_DEFINED = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.Lambda)
_WAITS = (ast.Yield, ast.YieldFrom)


class Strings:
    """The strings of a file by what they are used for; one may stand for another of its use.

    Args:
        tree: of the file.
    """

    def __init__(self, tree: ast.Module) -> None:
        self._uses: dict[int, str] = {}
        self._of_use: dict[str, list[str]] = {}
        for node in ast.walk(tree):
            for use, element in _used(node):
                self._uses[id(element)] = use
                known = self._of_use.setdefault(use, [])
                if str(element.value) not in known:
                    known.append(str(element.value))

    def others(self, node: ast.Constant) -> list[str]:
        """The other strings of the same use, from the next in the file on."""
        known = self._of_use.get(self._uses.get(id(node), ""), [])
        if not known:
            return []
        place = known.index(str(node.value))
        return known[place + 1 :] + known[:place]


def _used(node: ast.AST) -> Iterator[tuple[str, ast.Constant]]:
    """The strings right below a node, each with its use."""
    match node:
        case ast.Call(func=function, args=arguments):
            pairs = [(f"{ast.unparse(function)} {at}", one) for at, one in enumerate(arguments)]
        case ast.Return(value=ast.expr() as value):
            pairs = [("return", value)]
        case ast.Compare(left=left, comparators=comparators):
            pairs = [("compare", one) for one in (left, *comparators)]
        case ast.Set(elts=elements):
            pairs = [("element", one) for one in elements]
        case _:
            pairs = []
    for use, one in pairs:
        if isinstance(one, ast.Constant) and isinstance(one.value, str):
            yield use, one


class Scope:
    """A function, or the statement that makes a constant, in its file.

    Args:
        body: its statements.
        strings: of the file.
    """

    def __init__(self, body: Sequence[ast.stmt], strings: Strings) -> None:
        self._body = body
        self._strings = strings

    @cached_property
    def _nodes(self) -> list[ast.AST]:
        """All that belongs to it, in no order."""
        return [node for statement in self._body for node in _below(statement)]

    def alternatives(self, node: ast.Constant) -> list[str]:
        """Strings that may stand for one: the next of its use, of what is returned the next two."""
        return self._strings.others(node)[: 2 if self._is_returned(node) else 1]

    def _is_returned(self, node: ast.Constant) -> bool:
        return any(isinstance(one, ast.Return) and one.value is node for one in self._nodes)

    def further(self, elements: Sequence[ast.expr]) -> list[str]:
        """The next string that a set of strings has not."""
        own = [one for one in elements if isinstance(one, ast.Constant)]
        values = [one.value for one in own]
        others = (other for one in own for other in self._strings.others(one))
        return [other for other in others if other not in values][:1]

    def bound_before(self, name: str, node: ast.stmt) -> bool:
        """Whether a name has a value before a statement gives it one."""
        return any(
            isinstance(one, ast.Name)
            and one.id == name
            and isinstance(one.ctx, ast.Store)
            and one.lineno < node.lineno
            for one in self._nodes
        )

    def holds_all_waits(self, node: ast.AST) -> bool:
        """Whether without a node it would be no generator any more."""
        waits = {id(one) for one in self._nodes if isinstance(one, _WAITS)}
        return bool(waits) and waits <= {id(one) for one in _below(node)}

    def is_top_level(self, node: ast.stmt) -> bool:
        """Whether it is one of its statements, and not part of another."""
        return any(one is node for one in self._body)

    def is_step(self, node: ast.stmt) -> bool:
        """Whether it is one of its statements, and does something."""
        is_text = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
        return self.is_top_level(node) and not is_text

    def returned(self) -> list[str]:
        """The constants that it returns; nothing, once, if it returns no values."""
        returns = [one.value for one in self._nodes if isinstance(one, ast.Return)]
        values = [ast.unparse(one) for one in returns if isinstance(one, ast.Constant)]
        return list(dict.fromkeys(values)) or ([""] if not any(returns) else [])


def _below(node: ast.AST) -> Iterator[ast.AST]:
    """A node and what belongs to it, but for functions and classes that it defines."""
    yield node
    for child in ast.iter_child_nodes(node):
        if not isinstance(child, _DEFINED):
            yield from _below(child)
