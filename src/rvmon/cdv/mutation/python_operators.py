"""The mutation operators of Python code, and the context of a node that they need.

Sources of the operators, with the abbreviations used in comments:

* **KO** King, Offutt 1991, A Fortran Language System for Mutation-Based Software Testing (Mothra).
* **OLRUZ** Offutt, Lee, Rothermel, Untch, Zapf 1996, An Experimental Determination of Sufficient
  Mutant Operators: ROR, LCR, AOR (with ABS and UOI) are nearly as effective as all operators.
* **DH** Derezińska, Hałas 2014, Analysis of Mutation Operators for the Python Language.
* **DOA** Delamaro, Offutt, Ammann 2014, Designing Deletion Mutation Operators.
* **DOL** Deng, Offutt, Li 2013, Empirical Evaluation of the Statement Deletion Mutation Operator.
* **BCD** Bradbury, Cordy, Dingel 2006, Mutation Operators for Concurrent Java.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import TypeVar

_T = TypeVar("_T")

_DEFINED = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.Lambda)
_WAITS = (ast.Yield, ast.YieldFrom)


class Strings:
    """The strings of a file by their use; a mutant replaces one by another of the same use."""

    def __init__(self, tree: ast.Module) -> None:
        self._uses: dict[int, str] = {}
        self._of_use: dict[str, list[str]] = {}
        for node in ast.walk(tree):
            for use, element in _strings_used(node):
                self._uses[id(element)] = use
                known = self._of_use.setdefault(use, [])
                if str(element.value) not in known:
                    known.append(str(element.value))

    def others(self, node: ast.Constant) -> list[str]:
        """The other strings of the same use: the later ones of the file, then the earlier ones."""
        known = self._of_use.get(self._uses.get(id(node), ""), [])
        if not known:
            return []
        place = known.index(str(node.value))
        return known[place + 1 :] + known[:place]


def _strings_used(node: ast.AST) -> Iterator[tuple[str, ast.Constant]]:
    """The strings that are direct parts of a node, each with its use."""
    match node:
        case ast.Call(func=function, args=arguments):
            pairs = [
                (f"{ast.unparse(function)} {at}", argument) for at, argument in enumerate(arguments)
            ]
        case ast.Return(value=ast.expr() as value):
            pairs = [("return", value)]
        case ast.Compare(left=left, comparators=comparators):
            pairs = [("compare", one) for one in (left, *comparators)]
        case ast.Set(elts=elements):
            pairs = [("element", element) for element in elements]
        case _:
            pairs = []
    for use, one in pairs:
        if isinstance(one, ast.Constant) and isinstance(one.value, str):
            yield use, one


class Scope:
    """The body of a function, or the statement that assigns a constant.

    Args:
        body: its statements.
        strings: the strings of the whole file.
    """

    def __init__(self, body: Sequence[ast.stmt], strings: Strings) -> None:
        self._body = body
        self._strings = strings

    @cached_property
    def _nodes(self) -> list[ast.AST]:
        """All nodes of the scope."""
        return [node for statement in self._body for node in _own_nodes(statement)]

    def alternatives(self, node: ast.Constant) -> list[str]:
        """Replacements of a string: the next one of the same use, or two if it is returned."""
        returned = any(isinstance(one, ast.Return) and one.value is node for one in self._nodes)
        return self._strings.others(node)[: 2 if returned else 1]

    def further(self, elements: Sequence[ast.expr]) -> list[str]:
        """The next string of the same use that a set does not contain; a list of at most one."""
        constants = [element for element in elements if isinstance(element, ast.Constant)]
        values = [constant.value for constant in constants]
        others = (other for constant in constants for other in self._strings.others(constant))
        return [other for other in others if other not in values][:1]

    def bound_before(self, name: str, node: ast.stmt) -> bool:
        """Whether a name is assigned above a statement, so that dropping this leaves it defined."""
        return any(
            isinstance(one, ast.Name)
            and one.id == name
            and isinstance(one.ctx, ast.Store)
            and one.lineno < node.lineno
            for one in self._nodes
        )

    def holds_all_waits(self, node: ast.AST) -> bool:
        """Whether a node holds every `yield`: without it the function would not be a generator."""
        return bool(self._waits) and self._waits <= {id(one) for one in _own_nodes(node)}

    @cached_property
    def _waits(self) -> set[int]:
        return {id(one) for one in self._nodes if isinstance(one, _WAITS)}

    def is_top_level(self, node: ast.stmt) -> bool:
        """Whether a statement is directly in the body, and not nested in another statement."""
        return any(one is node for one in self._body)

    def returned(self) -> list[str]:
        """The constants that the function returns, as source; `[""]` if it returns no values."""
        returns = [node.value for node in self._nodes if isinstance(node, ast.Return)]
        values = [ast.unparse(one) for one in returns if isinstance(one, ast.Constant)]
        return list(dict.fromkeys(values)) or ([""] if not any(returns) else [])


def _own_nodes(node: ast.AST) -> Iterator[ast.AST]:
    """A node and all below it, without nested functions and classes."""
    yield node
    for child in ast.iter_child_nodes(node):
        if not isinstance(child, _DEFINED):
            yield from _own_nodes(child)


Change = tuple[str, "ast.expr | ast.stmt", str]
"""The name of the operator, the node to replace, and the new code."""


def either_way(*pairs: tuple[_T, _T]) -> dict[_T, _T]:
    """Map each element of a pair to the other."""
    return {one: other for pair in pairs for one, other in (pair, pair[::-1])}


_COMPARISONS: dict[type[ast.cmpop], type[ast.cmpop]] = either_way(
    *((ast.Lt, ast.LtE), (ast.Gt, ast.GtE), (ast.Eq, ast.NotEq)),
    *((ast.Is, ast.IsNot), (ast.In, ast.NotIn)),
)
_ARITHMETIC: dict[type[ast.operator], type[ast.operator]] = either_way(
    *((ast.Add, ast.Sub), (ast.Mult, ast.Div)),
    *((ast.BitAnd, ast.BitOr), (ast.LShift, ast.RShift)),
)
_FUNCTIONS = either_way(("min", "max"), ("any", "all"))


def _bracketed(new: ast.expr) -> str:
    return f"({ast.unparse(new)})"


def changes_of(node: ast.expr | ast.stmt, scope: Scope) -> Iterator[Change]:
    """All changes of a node; comments cite the papers for operators taken from one."""
    match node:
        # ROR, relational operator replacement (KO, OLRUZ)
        case ast.Compare(left=left, ops=[op], comparators=[right]) if type(op) in _COMPARISONS:
            flipped = ast.Compare(left, [_COMPARISONS[type(op)]()], [right])
            yield "comparison", node, _bracketed(flipped)
        # LCR, logical connector replacement (KO, OLRUZ); ODL, operator deletion (DOA)
        case ast.BoolOp(op=op, values=values):
            other = ast.Or() if isinstance(op, ast.And) else ast.And()
            yield "and/or", node, _bracketed(ast.BoolOp(other, values))
            for index in range(len(values)):
                kept = values[:index] + values[index + 1 :]
                left = kept[0] if len(kept) == 1 else ast.BoolOp(op, kept)
                yield "dropped operand", node, _bracketed(left)
        # COD, conditional operator deletion (DH)
        case ast.UnaryOp(op=ast.Not(), operand=operand):
            yield "dropped not", node, _bracketed(operand)
        # AOD, arithmetic operator deletion (DH); AOR, its replacement (KO, OLRUZ)
        case ast.BinOp(left=left, op=op, right=right):
            if isinstance(right, ast.Constant) and right.value == 1:
                yield "off by one", node, _bracketed(left)
            if type(op) in _ARITHMETIC:
                yield "operator", node, _bracketed(ast.BinOp(left, _ARITHMETIC[type(op)](), right))
        # CRP, constant replacement (KO), extended to numbers and strings
        case ast.Constant(value=bool() as value):
            yield "constant", node, f"({not value})"
        case ast.Constant(value=int() as value):
            yield "constant", node, f"({value + 1})"
            yield "number", node, f"({value - 1})"
        case ast.Constant(value=float() as value):
            step = abs(value) / 10 or 0.1
            yield "number", node, f"({value + step:.12g})"
            yield "number", node, f"({value - step:.12g})" if value else "1.0"
        case ast.Constant(value=str()):
            for text in scope.alternatives(node):
                yield "string", node, repr(text)
        case ast.Set(elts=elements):
            for text in scope.further(elements):
                yield "string", node, f"{ast.unparse(node)[:-1]}, {text!r}}}"
        # COI, conditional operator insertion (DH), as is "negated condition" below
        case ast.IfExp(test=test, body=body, orelse=orelse):
            yield "swapped branches", node, _bracketed(ast.IfExp(test, orelse, body))
        case ast.Call(func=ast.Name(id=name), args=args, keywords=keywords) if name in _FUNCTIONS:
            call = ast.Call(ast.Name(_FUNCTIONS[name]), args, keywords)
            yield "function", node, _bracketed(call)
        case ast.stmt():
            yield from _changes_of_statement(node, scope)


def _changes_of_statement(node: ast.stmt, scope: Scope) -> Iterator[Change]:
    if isinstance(node, ast.If | ast.While):
        yield "negated condition", node.test, _bracketed(ast.UnaryOp(ast.Not(), node.test))
    is_needed = scope.holds_all_waits(node)
    match node:
        # SDL, statement deletion (KO, DOL), as are all "dropped …" below
        case ast.Expr(value=ast.Call()) | ast.AugAssign() | ast.Break() | ast.Continue():
            yield "dropped statement", node, "pass"
        case ast.Assign(targets=[ast.Attribute() | ast.Subscript()]):
            yield "dropped assignment", node, "pass"
        case ast.Assign(targets=[ast.Name(id=name)]) if scope.bound_before(name, node):
            yield "dropped assignment", node, "pass"
        case ast.If() | ast.For() | ast.While() | ast.Expr(value=ast.YieldFrom()) if not is_needed:
            yield "dropped block", node, "pass"
        case ast.Return() if not scope.is_top_level(node):
            yield "dropped return", node, "pass"
    is_text = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    if scope.is_top_level(node) and not (is_text or is_needed):
        # RSR, return statement replacement (KO)
        for value in scope.returned()[-1:]:
            yield "early return", node, f"return {value}".strip()
    match node:
        case ast.Expr(value=ast.Call()):
            yield "doubled statement", node, f"{ast.unparse(node)}; {ast.unparse(node)}"
        # MXT, modification of a wait's time (BCD)
        case ast.Expr(value=ast.Yield(value=ast.expr() as wait)):
            yield "wait", wait, "0.0"
            yield "wait", wait, f"2 * ({ast.unparse(wait)})"
