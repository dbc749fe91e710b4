"""The mutation operators of Python code: one table.

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
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from rvmon.cdv.mutation.scope import Scope

Change = tuple["ast.expr | ast.stmt", str]
"""The node to replace, and the code to put there."""


@dataclass(frozen=True, slots=True)
class Operator:
    """A kind of change.

    Attributes:
        name: in words.
        literature: what the literature calls it, and where; empty: it is ours.
        changes: of a node.
    """

    name: str
    literature: str
    changes: Callable[[ast.AST, Scope], Iterator[Change]]


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


OPERATORS = (
    Operator("comparison", "ROR, relational operator replacement (KO, OLRUZ)", _comparison),
    Operator("and/or", "LCR, logical connector replacement (KO, OLRUZ)", _and_or),
    Operator("dropped operand", "ODL, operator deletion (DOA)", _dropped_operand),
    Operator("dropped not", "COD, conditional operator deletion (DH)", _dropped_not),
    Operator("off by one", "AOD, arithmetic operator deletion (DH)", _off_by_one),
    Operator("operator", "AOR, arithmetic operator replacement (KO, OLRUZ)", _operator),
    Operator("constant", "CRP, constant replacement (KO)", _constant),
    Operator("number", "CRP, constant replacement (KO)", _number),
    Operator("string", "CRP, constant replacement (KO)", _string),
    Operator("swapped branches", "COI, conditional operator insertion (DH)", _swapped_branches),
    Operator("negated condition", "COI, conditional operator insertion (DH)", _negated_condition),
    Operator("function", "", _function),
    Operator("dropped statement", "SDL, statement deletion (KO, DOL)", _dropped_statement),
    Operator("dropped assignment", "SDL, statement deletion (KO, DOL)", _dropped_assignment),
    Operator("dropped block", "SDL, statement deletion (KO, DOL)", _dropped_block),
    Operator("dropped return", "SDL, statement deletion (KO, DOL)", _dropped_return),
    Operator("early return", "RSR, return statement replacement (KO)", _early_return),
    Operator("doubled statement", "", _doubled_statement),
    Operator("wait", "MXT, a wait's time is modified (BCD)", _wait),
)
"""In the order in which they are shown."""
