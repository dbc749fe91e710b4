"""Words of linear time in queries, and premises about runs."""

from __future__ import annotations

from rvmon.diagnostics import Span
from rvmon.timed.model.expressions import BinaryOperation, Expression, PathFormula
from rvmon.timed.model.guards import is_linear
from rvmon.timed.model.network import LeadsToFormula
from rvmon.timed.model.operators import BinaryOp, PathOp
from rvmon.timed.model.rules import model_error

LINEAR_WORDS = "AEGFX"
"""What looks like a call and speaks of one run, or of runs."""

_OF_CTL = {
    ("A", PathOp.FINALLY): PathOp.EVENTUALLY,
    ("A", PathOp.GLOBALLY): PathOp.INVARIANTLY,
    ("E", PathOp.FINALLY): PathOp.POSSIBLY,
    ("E", PathOp.GLOBALLY): PathOp.POTENTIALLY_ALWAYS,
}
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


def linear_of(name: str, body: Expression, span: Span) -> Expression:
    """What `G (…)`, `F (…)`, `A (…)`, `E (…)` say; in CTL, if the last two can be said there."""
    match name, body:
        case "G", _:
            return PathFormula(PathOp.GLOBALLY, body)
        case "F", _:
            return PathFormula(PathOp.FINALLY, body)
        case "X", _:
            fix = "EX p, AX p speak of the next action"
            raise model_error("TA020", "time is dense: runs have no next instant", span, fix)
        case _, PathFormula(op, inner, None, left) if (name, op) in _OF_CTL and not any(
            map(is_linear, (inner, left))
        ):
            return PathFormula(_OF_CTL[name, op], inner, None, left)
        case _ if is_linear(body):
            return PathFormula(PathOp(name), body)
        case _:
            fix = f"as in {name} (G F p), {name} (p U q)"
            raise model_error("TA020", f"`{name}` speaks of runs", span, fix)
