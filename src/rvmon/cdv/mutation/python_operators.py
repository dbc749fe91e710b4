"""The mutation operators of Python code: one table, and what they ask of the code around a node.

Sources of the operators, by the letters that the table cites:

* **KO** King, Offutt 1991, A Fortran Language System for Mutation-Based Software Testing (Mothra).
* **OLRUZ** Offutt, Lee, Rothermel, Untch, Zapf 1996, An Experimental Determination of Sufficient
  Mutant Operators: ROR, LCR, AOR (with ABS and UOI) see nearly what all see.
* **DH** Derezińska, Hałas 2014, Analysis of Mutation Operators for the Python Language.
* **DOA** Delamaro, Offutt, Ammann 2014, Designing Deletion Mutation Operators.
* **DOL** Deng, Offutt, Li 2013, Empirical Evaluation of the Statement Deletion Mutation Operator.
* **BCD** Bradbury, Cordy, Dingel 2006, Mutation Operators for Concurrent Java.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property

_DEFINED = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.Lambda)
_WAITS = (ast.Yield, ast.YieldFrom)


class Strings:
    """The strings of a file by what they are used for; one may stand for another of its use."""

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
    """A function, or the statement that makes a constant, in its file."""

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
        constants = [element for element in elements if isinstance(element, ast.Constant)]
        values = [constant.value for constant in constants]
        others = (other for constant in constants for other in self._strings.others(constant))
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
        waits = {id(t) for t in self._nodes if isinstance(t, _WAITS)}
        return bool(waits) and waits <= {id(t) for t in _below(node)}

    def is_top_level(self, node: ast.stmt) -> bool:
        """Whether it is one of its statements, and not part of another."""
        return any(one is node for one in self._body)

    def is_step(self, node: ast.stmt) -> bool:
        """Whether it is one of its statements, and does something."""
        is_text = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
        return self.is_top_level(node) and not is_text

    def returned(self) -> list[str]:
        """The constants that it returns; nothing, once, if it returns no values."""
        returns = [node.value for node in self._nodes if isinstance(node, ast.Return)]
        values = [ast.unparse(one) for one in returns if isinstance(one, ast.Constant)]
        return list(dict.fromkeys(values)) or ([""] if not any(returns) else [])


def _below(node: ast.AST) -> Iterator[ast.AST]:
    """A node and what belongs to it, but for functions and classes that it defines."""
    yield node
    for child in ast.iter_child_nodes(node):
        if not isinstance(child, _DEFINED):
            yield from _below(child)


Change = tuple["ast.expr | ast.stmt", str]
"""The node to replace, and the code to put there."""

Operator = Callable[[ast.AST, "Scope"], Iterator[Change]]
"""A kind of change: those of a node."""


_COMPARISONS: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.LtE,
    ast.LtE: ast.Lt,
    ast.Gt: ast.GtE,
    ast.GtE: ast.Gt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot,
    ast.IsNot: ast.Is,
    ast.In: ast.NotIn,
    ast.NotIn: ast.In,
}
_ARITHMETIC: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.BitAnd: ast.BitOr,
    ast.BitOr: ast.BitAnd,
    ast.LShift: ast.RShift,
    ast.RShift: ast.LShift,
}
_FUNCTIONS = {"min": "max", "max": "min", "any": "all", "all": "any"}


def _bracketed(new: ast.expr) -> str:
    return f"({ast.unparse(new)})"


def _comparison(node: ast.AST, _: Scope) -> Iterator[Change]:
    match node:
        case ast.Compare(left=left, ops=[op], comparators=[right]) if type(op) in _COMPARISONS:
            flipped = _COMPARISONS[type(op)]()
            yield node, _bracketed(ast.Compare(left, [flipped], [right]))


def _and_or(node: ast.AST, _: Scope) -> Iterator[Change]:
    match node:
        case ast.BoolOp(op=op, values=values):
            other = ast.Or() if isinstance(op, ast.And) else ast.And()
            yield node, _bracketed(ast.BoolOp(other, values))


def _dropped_operand(node: ast.AST, _: Scope) -> Iterator[Change]:
    match node:
        case ast.BoolOp(op=op, values=values):
            for index in range(len(values)):
                kept = values[:index] + values[index + 1 :]
                yield node, _bracketed(kept[0] if len(kept) == 1 else ast.BoolOp(op, kept))


def _dropped_not(node: ast.AST, _: Scope) -> Iterator[Change]:
    match node:
        case ast.UnaryOp(op=ast.Not(), operand=operand):
            yield node, _bracketed(operand)


def _off_by_one(node: ast.AST, _: Scope) -> Iterator[Change]:
    match node:
        case ast.BinOp(left=left, right=ast.Constant(value=1)):
            yield node, _bracketed(left)


def _operator(node: ast.AST, _: Scope) -> Iterator[Change]:
    match node:
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _ARITHMETIC:
            yield node, _bracketed(ast.BinOp(left, _ARITHMETIC[type(op)](), right))


def _constant(node: ast.AST, _: Scope) -> Iterator[Change]:
    match node:
        case ast.Constant(value=bool() as value):
            yield node, f"({not value})"
        case ast.Constant(value=int() as value):
            yield node, f"({value + 1})"


def _number(node: ast.AST, _: Scope) -> Iterator[Change]:
    match node:
        case ast.Constant(value=int() as value) if not isinstance(value, bool):
            yield node, f"({value - 1})"
        case ast.Constant(value=float() as value):
            step = abs(value) / 10 or 0.1
            yield node, f"({value + step:.12g})"
            yield node, f"({value - step:.12g})" if value else "1.0"


def _string(node: ast.AST, scope: Scope) -> Iterator[Change]:
    match node:
        case ast.Constant(value=str()):
            for other in scope.alternatives(node):
                yield node, repr(other)
        case ast.Set(elts=elements):
            for other in scope.further(elements):
                yield node, f"{ast.unparse(node)[:-1]}, {other!r}}}"


def _swapped_branches(node: ast.AST, _: Scope) -> Iterator[Change]:
    match node:
        case ast.IfExp(test=test, body=body, orelse=orelse):
            yield node, _bracketed(ast.IfExp(test, orelse, body))


def _negated_condition(node: ast.AST, _: Scope) -> Iterator[Change]:
    match node:
        case ast.If(test=test) | ast.While(test=test):
            yield test, _bracketed(ast.UnaryOp(ast.Not(), test))


def _function(node: ast.AST, _: Scope) -> Iterator[Change]:
    match node:
        case ast.Call(func=ast.Name(id=name), args=args, keywords=keywords) if name in _FUNCTIONS:
            yield node, _bracketed(ast.Call(ast.Name(_FUNCTIONS[name]), args, keywords))


def _dropped_statement(node: ast.AST, _: Scope) -> Iterator[Change]:
    match node:
        case ast.Expr(value=ast.Call()) | ast.AugAssign() | ast.Break() | ast.Continue():
            yield node, "pass"


def _dropped_assignment(node: ast.AST, scope: Scope) -> Iterator[Change]:
    match node:
        case ast.Assign(targets=[ast.Attribute() | ast.Subscript()]):
            yield node, "pass"
        case ast.Assign(targets=[ast.Name(id=name)]) if scope.bound_before(name, node):
            yield node, "pass"


def _dropped_block(node: ast.AST, scope: Scope) -> Iterator[Change]:
    match node:
        case ast.If() | ast.For() | ast.While() if not scope.holds_all_waits(node):
            yield node, "pass"
        case ast.Expr(value=ast.YieldFrom()) if not scope.holds_all_waits(node):
            yield node, "pass"


def _dropped_return(node: ast.AST, scope: Scope) -> Iterator[Change]:
    match node:
        case ast.Return() if not scope.is_top_level(node):
            yield node, "pass"


def _early_return(node: ast.AST, scope: Scope) -> Iterator[Change]:
    if isinstance(node, ast.stmt) and scope.is_step(node) and not scope.holds_all_waits(node):
        for value in scope.returned()[-1:]:
            yield node, f"return {value}".strip()


def _doubled_statement(node: ast.AST, _: Scope) -> Iterator[Change]:
    match node:
        case ast.Expr(value=ast.Call()):
            yield node, f"{ast.unparse(node)}; {ast.unparse(node)}"


def _wait(node: ast.AST, _: Scope) -> Iterator[Change]:
    match node:
        case ast.Expr(value=ast.Yield(value=ast.expr() as wait)):
            yield wait, "0.0"
            yield wait, f"2 * ({ast.unparse(wait)})"


OPERATORS: Mapping[str, Operator] = {
    "comparison": _comparison,  # ROR, relational operator replacement (KO, OLRUZ)
    "and/or": _and_or,  # LCR, logical connector replacement (KO, OLRUZ)
    "dropped operand": _dropped_operand,  # ODL, operator deletion (DOA)
    "dropped not": _dropped_not,  # COD, conditional operator deletion (DH)
    "off by one": _off_by_one,  # AOD, arithmetic operator deletion (DH)
    "operator": _operator,  # AOR, arithmetic operator replacement (KO, OLRUZ)
    "constant": _constant,  # CRP, constant replacement (KO)
    "number": _number,  # CRP, constant replacement (KO)
    "string": _string,  # CRP, constant replacement (KO)
    "swapped branches": _swapped_branches,  # COI, conditional operator insertion (DH)
    "negated condition": _negated_condition,  # COI, conditional operator insertion (DH)
    "function": _function,
    "dropped statement": _dropped_statement,  # SDL, statement deletion (KO, DOL)
    "dropped assignment": _dropped_assignment,  # SDL, statement deletion (KO, DOL)
    "dropped block": _dropped_block,  # SDL, statement deletion (KO, DOL)
    "dropped return": _dropped_return,  # SDL, statement deletion (KO, DOL)
    "early return": _early_return,  # RSR, return statement replacement (KO)
    "doubled statement": _doubled_statement,
    "wait": _wait,  # MXT, a wait's time is modified (BCD)
}
"""In the order in which they are shown."""
