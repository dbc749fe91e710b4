"""Queries about those runs only of which a premise holds."""

from __future__ import annotations

from rvmon.diagnostics import Span
from rvmon.timed.model.expressions import BinaryOperation, Expression, PathFormula
from rvmon.timed.model.guards import is_linear
from rvmon.timed.model.network import LeadsToFormula
from rvmon.timed.model.operators import BinaryOp, PathOp
from rvmon.timed.model.rules import model_error

_LINEAR = {
    PathOp.EVENTUALLY: (PathOp.EVERY_RUN, PathOp.FINALLY),
    PathOp.INVARIANTLY: (PathOp.EVERY_RUN, PathOp.GLOBALLY),
    PathOp.POSSIBLY: (PathOp.SOME_RUN, PathOp.FINALLY),
    PathOp.POTENTIALLY_ALWAYS: (PathOp.SOME_RUN, PathOp.GLOBALLY),
}


def assuming(asked: Expression | LeadsToFormula, premise: Expression, span: Span) -> PathFormula:
    """A query about those runs only of which a premise holds.

    Raises:
        ModelError: the query is none about whole runs.
    """
    match asked:
        case LeadsToFormula(left, right, None):
            answered = BinaryOperation(BinaryOp.IMPLY, left, PathFormula(PathOp.FINALLY, right))
            quantifier, body = PathOp.EVERY_RUN, PathFormula(PathOp.GLOBALLY, answered)
        case PathFormula(op, inner, None, left) if op in _LINEAR:
            quantifier, linear = _LINEAR[op]
            body = PathFormula(linear, inner, None, left)
        case PathFormula(PathOp.EVERY_RUN | PathOp.SOME_RUN as quantifier, body):
            pass
        case _ if isinstance(asked, LeadsToFormula) or not is_linear(asked):
            fix = "write p --> q, A<> p, or a formula of LTL such as G (p imply F q)"
            raise model_error("TA020", "`assuming` needs a query about whole runs", span, fix)
        case body:
            quantifier = PathOp.EVERY_RUN
    joined = BinaryOp.IMPLY if quantifier is PathOp.EVERY_RUN else BinaryOp.AND
    return PathFormula(quantifier, BinaryOperation(joined, premise, body))
