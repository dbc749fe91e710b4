"""Checked formulas to core formulas: past and present become propositions, the rest is X, U, R."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import assert_never

from rvmon.errors import RvmonError
from rvmon.formula.core import Core, Sense
from rvmon.formula.factory import Factory
from rvmon.formula.state import Elapsed, State
from rvmon.spec.checked import (
    Atom,
    Binary,
    BinaryOp,
    Bound,
    BoundAtom,
    Compare,
    Constant,
    EventAtom,
    Formula,
    Interval,
    Mode,
    ProbeAtom,
    Requirement,
    SignalAtom,
    Unary,
    UnaryOp,
)

_FUTURE = {
    UnaryOp.NEXT,
    UnaryOp.EVENTUALLY,
    UnaryOp.ALWAYS,
    BinaryOp.UNTIL,
    BinaryOp.RELEASE,
    BinaryOp.WEAK_UNTIL,
    BinaryOp.STRONG_RELEASE,
}


class UnmonitorableError(RvmonError):
    """A formula is beyond all engines; the message says which part of it."""


@dataclass(frozen=True, slots=True)
class Origin:
    """What a core formula was made from: a formula of the spec, or its negation."""

    formula: Formula
    positive: bool


@dataclass(frozen=True, slots=True)
class Obligation:
    """A requirement in core form.

    Attributes:
        trigger: starts an attempt; `None` where it is the end of the trace.
        owed: what an attempt owes from its trigger on; of an episode, all that it owes.
        origins: for explanations, where the parts of `owed` come from.
    """

    trigger: State | None
    owed: Core
    origins: Mapping[Core, Origin]


def has_future(formula: Formula) -> bool:
    """Whether a formula speaks of later positions."""
    match formula:
        case Unary(op=op, operand=operand):
            return op in _FUTURE or has_future(operand)
        case Binary(op=op, left=left, right=right):
            return op in _FUTURE or has_future(left) or has_future(right)
        case _:
            return False


def lower(requirement: Requirement, factory: Factory, period: int | None = None) -> Obligation:
    """Bring a requirement into core form.

    Args:
        requirement: as checked.
        factory: where its formulas are made; shared by the requirements of a spec.
        period: the D of `sampled every D`, ticks; past intervals are cut to its multiples.

    Raises:
        UnmonitorableError: the trigger speaks of the future.
    """
    lowering = _Lowering(factory, period)
    match requirement.trigger:
        case BoundAtom(bound=Bound.END):
            trigger = None
        case formula:
            trigger = lowering.state(formula)
    owed = lowering.core(requirement.consequent, True)
    if requirement.mode is Mode.WHENEVER and trigger is not None:
        # (θ -> ψ) W "θ is known to be false"; where that holds, θ -> ψ does.
        over = factory.literal(trigger, Sense.KNOWN_FALSE)
        implied = lowering.join([requirement.trigger], False, [requirement.consequent], True)
        owed = factory.release(over, implied, 0, None)
        for node in (implied, owed):
            lowering.origins[node] = Origin(requirement.consequent, True)
    return Obligation(trigger, owed, lowering.origins)


class _Lowering:
    def __init__(self, factory: Factory, period: int | None) -> None:
        self.factory = factory
        self.period = period
        self.origins: dict[Core, Origin] = {}

    # Present and past.

    def state(self, formula: Formula) -> State:
        factory = self.factory
        match formula:
            case Unary(op=op, operand=operand, interval=interval):
                if op in _FUTURE:
                    raise UnmonitorableError("its trigger speaks of the future")
                return self._state_unary(op, self.state(operand), interval)
            case Binary(op=op, left=left, right=right, interval=interval):
                if op in _FUTURE:
                    raise UnmonitorableError("its trigger speaks of the future")
                return self._state_binary(op, self.state(left), self.state(right), interval)
            case Constant(value=value):
                return factory.state_true if value else factory.state_false
            case _:
                return factory.leaf(_without_span(formula))

    def _state_unary(self, op: UnaryOp, arg: State, interval: Interval | None) -> State:
        factory = self.factory
        match op:
            case UnaryOp.NOT:
                return factory.negation(arg)
            case UnaryOp.PREVIOUS:
                return factory.previous(arg)
            case UnaryOp.ONCE:
                return self._since(factory.state_true, arg, interval)
            case UnaryOp.HISTORICALLY:
                return self._historically(arg, interval)
            case UnaryOp.RISE:
                return factory.state_all([arg, factory.negation(factory.previous(arg))])
            case UnaryOp.FALL:
                return factory.state_all([factory.negation(arg), factory.previous(arg)])
            case UnaryOp.HELD:
                duration = interval.high if interval and interval.high else 0
                elapsed = factory.leaf(Elapsed(duration))
                return factory.state_all([self._historically(arg, interval), elapsed])
            case UnaryOp.NEXT | UnaryOp.EVENTUALLY | UnaryOp.ALWAYS:
                raise AssertionError("future operators were sorted out")
            case _:
                assert_never(op)

    def _historically(self, arg: State, interval: Interval | None) -> State:
        factory = self.factory
        return factory.negation(self._since(factory.state_true, factory.negation(arg), interval))

    def _since(self, left: State, right: State, interval: Interval | None) -> State:
        low, high = (interval.low, interval.high) if interval else (0, None)
        if self.period:
            low = -(-low // self.period) * self.period
            high = None if high is None else high // self.period * self.period
        if high is not None and low > high:
            return self.factory.state_false
        return self.factory.since(left, right, low, high)

    def _state_binary(
        self, op: BinaryOp, left: State, right: State, interval: Interval | None
    ) -> State:
        factory = self.factory
        negation = factory.negation
        match op:
            case BinaryOp.AND:
                return factory.state_all([left, right])
            case BinaryOp.OR:
                return factory.state_any([left, right])
            case BinaryOp.IMPLIES:
                return factory.state_any([negation(left), right])
            case BinaryOp.IFF | BinaryOp.XOR:
                other = right if op is BinaryOp.IFF else negation(right)
                both = factory.state_all([left, other])
                neither = factory.state_all([negation(left), negation(other)])
                return factory.state_any([both, neither])
            case BinaryOp.SINCE:
                return self._since(left, right, interval)
            case BinaryOp.UNTIL | BinaryOp.RELEASE | BinaryOp.WEAK_UNTIL | BinaryOp.STRONG_RELEASE:
                raise AssertionError("future operators were sorted out")
            case _:
                assert_never(op)

    # Future.

    def core(self, formula: Formula, positive: bool) -> Core:
        if has_future(formula):
            made = self._core_future(formula, positive)
        else:
            sense = Sense.TRUE if positive else Sense.FALSE
            made = self.factory.literal(self.state(formula), sense)
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
        args = [*_flat(left, left_sign, conjunction), *_flat(right, right_sign, conjunction)]
        return self.join_signed(args, conjunction)

    def join(
        self, left: Iterable[Formula], left_sign: bool, right: Iterable[Formula], right_sign: bool
    ) -> Core:
        """One of all operands, each with its sign."""
        args = [part for f in left for part in _flat(f, left_sign, False)]
        args += [part for f in right for part in _flat(f, right_sign, False)]
        return self.join_signed(args, False)

    def join_signed(self, args: list[tuple[Formula, bool]], conjunction: bool) -> Core:
        factory = self.factory
        present = [(f, sign) for f, sign in args if not has_future(f)]
        parts = [self.core(f, sign) for f, sign in args if has_future(f)]
        if present:
            states = [
                self.state(f) if sign else factory.negation(self.state(f)) for f, sign in present
            ]
            whole = (factory.state_all if conjunction else factory.state_any)(states)
            literal = factory.literal(whole, Sense.TRUE)
            self.origins.setdefault(literal, Origin(_spelled(present, conjunction), True))
            parts.append(literal)
        return (factory.all_of if conjunction else factory.any_of)(parts)


def _flat(formula: Formula, sign: bool, conjunction: bool) -> list[tuple[Formula, bool]]:
    """The operands of nested conjunctions (or disjunctions), each with its sign."""
    match formula:
        case Unary(op=UnaryOp.NOT, operand=operand):
            return _flat(operand, not sign, conjunction)
        case Binary(op=BinaryOp.AND, left=left, right=right) if sign is conjunction:
            return [*_flat(left, sign, conjunction), *_flat(right, sign, conjunction)]
        case Binary(op=BinaryOp.OR, left=left, right=right) if sign is not conjunction:
            return [*_flat(left, sign, conjunction), *_flat(right, sign, conjunction)]
        case Binary(op=BinaryOp.IMPLIES, left=left, right=right) if sign is not conjunction:
            return [*_flat(left, not sign, conjunction), *_flat(right, sign, conjunction)]
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


def _without_span(atom: Atom) -> SignalAtom | EventAtom | Compare | ProbeAtom | BoundAtom:
    match atom:
        case Constant():
            raise AssertionError("constants are no leaves")
        case SignalAtom() | EventAtom() | Compare() | ProbeAtom() | BoundAtom():
            return replace(atom, span=None)
        case _:
            assert_never(atom)
