"""Formulas to core formulas: past and present become propositions, the rest is X, U, R."""

from __future__ import annotations

from collections.abc import Sequence
from typing import assert_never

from rvmon.formula.core import Core, Sense
from rvmon.formula.factory import Factory
from rvmon.formula.four import Reader
from rvmon.formula.obligation import Origin
from rvmon.formula.state import FALSE, TRUE, UNKNOWN, Elapsed, State
from rvmon.spec.checked.formula import (
    Binary,
    BinaryOp,
    Formula,
    Interval,
    Unary,
    UnaryOp,
)
from rvmon.spec.checked.tense import has_future


class Lowering:
    """Brings formulas into core form.

    Args:
        factory: where core formulas are made.
        period: the D of `sampled every D`, ticks; past intervals are cut to its multiples.
        favour: whether what is not born counts in favour of what is owed.

    Attributes:
        origins: where what was made comes from.
    """

    def __init__(self, factory: Factory, period: int | None, favour: bool) -> None:
        self.factory = factory
        self.reader = Reader(factory, period)
        self.favour = favour
        self.origins: dict[Core, Origin] = {}

    def state(self, formula: Formula, positive: bool) -> State:
        """A state formula that is owed, or whose negation is."""
        if not self.favour:
            return self.reader.literal(formula, UNKNOWN)
        return self.reader.literal(formula, TRUE if positive else FALSE)

    def episode(self, trigger: State, implied: Core, consequent: Formula) -> Core:
        """What is implied, up to where the trigger is known to be false; there nothing is."""
        over = self.factory.literal(trigger, Sense.KNOWN_FALSE)
        owed = self.factory.release(over, implied, 0, None)
        for node in (implied, owed):
            self.origins[node] = Origin(consequent, True)
        return owed

    def core(self, formula: Formula, positive: bool) -> Core:
        """A formula, or its negation, in negation normal form."""
        if has_future(formula):
            made = self._core_future(formula, positive)
        else:
            sense = Sense.TRUE if positive else Sense.FALSE
            made = self.factory.literal(self.state(formula, positive), sense)
        self.origins.setdefault(made, Origin(formula, positive))
        return made

    def _core_future(self, formula: Formula, positive: bool) -> Core:
        match formula:
            case Unary(op=UnaryOp.NOT, operand=operand):
                return self.core(operand, not positive)
            case Unary(op=UnaryOp.NEXT, operand=operand):
                return self.factory.next(self.core(operand, positive))
            case Unary(op=UnaryOp.EVENTUALLY, operand=operand, interval=interval):
                ends = (self.factory.constant(positive), self.core(operand, positive))
                return self._until(*ends, interval, positive)
            case Unary(op=UnaryOp.ALWAYS, operand=operand, interval=interval):
                ends = (self.factory.constant(not positive), self.core(operand, positive))
                return self._until(*ends, interval, not positive)
            case Unary(op=op, operand=operand, interval=interval):
                return self._core_past(op, operand, interval, positive)
            case Binary(op=op, left=left, right=right, interval=interval):
                return self._core_binary(op, left, right, interval, positive)
            case _:
                raise AssertionError("only operators have something of the future below them")

    def _core_past(
        self, op: UnaryOp, operand: Formula, interval: Interval | None, positive: bool
    ) -> Core:
        """An operator of the past over something of the future."""
        factory = self.factory
        match op:
            case UnaryOp.PREVIOUS:
                return factory.core_previous(self.core(operand, positive), first=not positive)
            case UnaryOp.ONCE | UnaryOp.HISTORICALLY:
                dual = positive is (op is UnaryOp.HISTORICALLY)
                ends = (factory.constant(not dual), self.core(operand, positive))
                return self._core_since(*ends, interval, dual)
            case UnaryOp.HELD:
                whole = self._core_past(UnaryOp.HISTORICALLY, operand, interval, positive)
                elapsed = factory.leaf(Elapsed(interval.high if interval and interval.high else 0))
                literal = factory.literal(elapsed, Sense.TRUE if positive else Sense.FALSE)
                return (factory.all_of if positive else factory.any_of)([whole, literal])
            case UnaryOp.RISE | UnaryOp.FALL:
                rising = op is UnaryOp.RISE
                now = self.core(operand, positive is rising)
                then = self.core(operand, positive is not rising)
                # Nothing is before the first position: `previous φ` is false there.
                before = factory.core_previous(then, first=positive is rising)
                previous = Unary(UnaryOp.PREVIOUS, operand)
                self.origins.setdefault(before, Origin(previous, positive is not rising))
                return (factory.all_of if positive else factory.any_of)([now, before])
            case _:
                raise AssertionError("other operators were sorted out")

    def _core_since(self, left: Core, right: Core, interval: Interval | None, dual: bool) -> Core:
        low, high = (interval.low, interval.high) if interval else (0, None)
        return self.factory.core_since(left, right, low, high, dual=dual)

    def _core_binary(
        self, op: BinaryOp, left: Formula, right: Formula, interval: Interval | None, positive: bool
    ) -> Core:
        match op:
            case BinaryOp.AND:
                return self._both(left, positive, right, positive, positive)
            case BinaryOp.OR:
                return self._both(left, positive, right, positive, not positive)
            case BinaryOp.IMPLIES:
                return self._both(left, not positive, right, positive, not positive)
            case BinaryOp.IFF | BinaryOp.XOR:
                same = op is BinaryOp.IFF
                first = self._both(left, positive, right, positive is same, positive)
                second = self._both(left, not positive, right, positive is not same, positive)
                join = self.factory.any_of if positive else self.factory.all_of
                return join([first, second])
            case BinaryOp.UNTIL | BinaryOp.RELEASE:
                ends = (self.core(left, positive), self.core(right, positive))
                return self._until(*ends, interval, positive is (op is BinaryOp.UNTIL))
            case BinaryOp.WEAK_UNTIL:  # ψ R (φ or ψ)
                either = self._both(left, positive, right, positive, not positive)
                return self._until(self.core(right, positive), either, interval, not positive)
            case BinaryOp.STRONG_RELEASE:  # ψ U (φ and ψ)
                both = self._both(left, positive, right, positive, positive)
                return self._until(self.core(right, positive), both, interval, positive)
            case BinaryOp.SINCE:
                ends = (self.core(left, positive), self.core(right, positive))
                return self._core_since(*ends, interval, not positive)
            case _:
                assert_never(op)

    def _until(self, left: Core, right: Core, interval: Interval | None, positive: bool) -> Core:
        low, high = (interval.low, interval.high) if interval else (0, None)
        make = self.factory.until if positive else self.factory.release
        return make(left, right, low, high)

    def _both(
        self, left: Formula, left_sign: bool, right: Formula, right_sign: bool, conjunction: bool
    ) -> Core:
        """Both operands or one of them, each with its sign; state formulas become one."""
        args = [
            *flattened(left, left_sign, conjunction),
            *flattened(right, right_sign, conjunction),
        ]
        return self.join_signed(args, conjunction)

    def join_signed(
        self, args: list[tuple[Formula, bool]], conjunction: bool, beside: Sequence[State] = ()
    ) -> Core:
        """All operands, each with its sign, or one of them; `beside` are further ones."""
        factory = self.factory
        present = [(f, sign) for f, sign in args if not has_future(f)]
        parts = [self.core(f, sign) for f, sign in args if has_future(f)]
        if present or beside:
            states = [
                self.state(f, sign) if sign else factory.negation(self.state(f, sign))
                for f, sign in present
            ]
            whole = (factory.state_all if conjunction else factory.state_any)([*beside, *states])
            literal = factory.literal(whole, Sense.TRUE)
            if present:
                self.origins.setdefault(literal, Origin(_spelled(present, conjunction), True))
            parts.append(literal)
        return (factory.all_of if conjunction else factory.any_of)(parts)


def flattened(formula: Formula, sign: bool, conjunction: bool) -> list[tuple[Formula, bool]]:
    """The operands of nested conjunctions (or disjunctions), each with its sign."""
    match formula:
        case Unary(op=UnaryOp.NOT, operand=operand):
            return flattened(operand, not sign, conjunction)
        case Binary(op=BinaryOp.AND, left=left, right=right) if sign is conjunction:
            return [*flattened(left, sign, conjunction), *flattened(right, sign, conjunction)]
        case Binary(op=BinaryOp.OR, left=left, right=right) if sign is not conjunction:
            return [*flattened(left, sign, conjunction), *flattened(right, sign, conjunction)]
        case Binary(op=BinaryOp.IMPLIES, left=left, right=right) if sign is not conjunction:
            return [*flattened(left, not sign, conjunction), *flattened(right, sign, conjunction)]
        case _:
            return [(formula, sign)]


def _spelled(parts: list[tuple[Formula, bool]], conjunction: bool) -> Formula:
    """Formulas with signs as one formula of the language."""
    op = BinaryOp.AND if conjunction else BinaryOp.OR
    signed = [f if sign else Unary(UnaryOp.NOT, f, span=f.span) for f, sign in parts]
    whole = signed[0]
    for part in signed[1:]:
        span = whole.span.to(part.span) if whole.span and part.span else None
        whole = Binary(op, whole, part, span=span)
    return whole
