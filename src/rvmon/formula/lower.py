"""Checked formulas to core formulas: past and present become propositions, the rest is X, U, R."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import assert_never

from rvmon.errors import RvmonError
from rvmon.formula.core import And, Core, Literal, Next, Or, Previous, Release, Sense, Since, Until
from rvmon.formula.core import Constant as CoreConstant
from rvmon.formula.factory import Factory
from rvmon.formula.four import Four, Reader
from rvmon.formula.numeric import signals_of
from rvmon.formula.state import FALSE, TRUE, UNKNOWN, Elapsed, Lapsed, State, StateOp, Unborn
from rvmon.spec.checked.formula import (
    Binary,
    BinaryOp,
    Bound,
    BoundAtom,
    Compare,
    Constant,
    Formula,
    Interval,
    Probe,
    ProbeAtom,
    SignalAtom,
    Unary,
    UnaryOp,
)
from rvmon.spec.checked.specification import Mode, Requirement
from rvmon.spec.checked.tense import subformulas

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
        trigger: starts an attempt; `None` where it is the end of the trace. What is not born is
            FALSE for it.
        owed: what an attempt owes from its trigger on; of an episode, all that it owes.
        origins: for explanations, where the parts of `owed` come from.
        running: of an episode, what is FALSE where it is over; with captured values also where it
            is not known any more which these are.
        again: of an episode, not FALSE where what is owed has not failed at once: there it goes on
            after a failure; `None` where it does not, as the future stands below the past.
        unborn: of an episode, where something of its consequent had no value yet.
        told: TRUE as soon as the trigger was TRUE or FALSE; `None` if it always is.
        hidden: what an attempt in doubt owes, as an episode whose trigger is UNKNOWN where one may
            start; `None` if the trigger is never unknown.
        doubted: the same where it is not known whether there is such an instance at all.
        doubt: of an episode with captured values, UNKNOWN where another may have begun.
    """

    trigger: State | None
    owed: Core
    origins: Mapping[Core, Origin]
    running: State | None = None
    again: State | None = None
    unborn: State | None = None
    told: State | None = None
    hidden: Obligation | None = None
    doubted: Obligation | None = None
    doubt: State | None = None


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
    favour = requirement.mode is Mode.WHENEVER and not requirement.pulse
    lowering = _Lowering(factory, period, favour)
    match requirement.trigger:
        case BoundAtom(bound=Bound.END):
            return Obligation(None, lowering.core(requirement.consequent, True), lowering.origins)
        case formula if has_future(formula):
            raise UnmonitorableError("its trigger speaks of the future")
    four = lowering.reader.four(requirement.trigger)
    trigger = four.read(FALSE)
    told = _told(four, factory)
    if requirement.mode is Mode.WHENEVER:
        parts = _flat(requirement.consequent, True, False)
        running = _running(trigger, requirement, factory)
        implied = lowering.join_signed(parts, False, [factory.negation(running)])
        owed = lowering.episode(running, implied, requirement.consequent)
        ahead = lowering.core(requirement.consequent, True)
        again = None if _looks_back(ahead) else _at_once(ahead, factory)
        unborn = _unborn(requirement.consequent, factory) if favour else None
        doubt = None
        if requirement.captures:
            doubt = factory.doubt(trigger, pulse=requirement.pulse, every=False)
        return Obligation(
            trigger, owed, lowering.origins, running, again, unborn, told, doubt=doubt
        )
    owed = lowering.core(requirement.consequent, True)

    def hidden(every: bool) -> Obligation:
        doubt = factory.doubt(trigger, pulse=requirement.pulse, every=every)
        running = _running(doubt, requirement, factory)
        here = factory.state_any([factory.negation(running), factory.sure(running)])
        either = factory.any_of([factory.literal(here, Sense.TRUE), owed])
        whole = lowering.episode(running, either, requirement.consequent)
        return Obligation(doubt, whole, lowering.origins, running)

    return Obligation(
        trigger,
        owed,
        lowering.origins,
        told=told,
        hidden=hidden(False) if _may_be_unknown(trigger) else None,
        doubted=hidden(True) if requirement.for_each is not None else None,
    )


def _running(trigger: State, requirement: Requirement, factory: Factory) -> State:
    if not requirement.captures:
        return trigger
    return factory.state_all([trigger, factory.negation(factory.leaf(Lapsed()))])


def _told(trigger: Four, factory: Factory) -> State | None:
    """TRUE as soon as a trigger was TRUE or FALSE; `None` if it is from the first position on."""
    if not _may_be_unknown(trigger.missing):
        return None
    known = factory.sure(factory.negation(trigger.missing))
    return factory.since(factory.state_true, known, 0, None)


def _may_be_unknown(state: State) -> bool:
    match state.leaf:
        case None:
            return state.op is not StateOp.SURE and any(map(_may_be_unknown, state.args))
        case Constant() | BoundAtom() | Elapsed() | Unborn() | Lapsed():
            return False
        case ProbeAtom(probe=probe):
            return probe is Probe.CHANGED
        case _:
            return True


def _unborn(consequent: Formula, factory: Factory) -> State | None:
    """Where something that a consequent reads had no value yet; `None` if it reads no signal."""
    found: dict[str, bool] = {}
    for atom in subformulas(consequent):
        if isinstance(atom, SignalAtom | Compare):
            for name, moved in signals_of(atom).items():
                found[name] = found.get(name, False) or moved
    return factory.leaf(Unborn(tuple(sorted(found.items())))) if found else None


def _looks_back(core: Core) -> bool:
    match core:
        case Since() | Previous():
            return True
        case And(args=args) | Or(args=args):
            return any(map(_looks_back, args))
        case Until(left=left, right=right) | Release(left=left, right=right):
            return _looks_back(left) or _looks_back(right)
        case Next(operand=operand):
            return _looks_back(operand)
        case Literal() | CoreConstant():
            return False
        case _:
            assert_never(core)


def _at_once(core: Core, factory: Factory) -> State:
    """A state formula that is FALSE where a position alone makes what is owed there FALSE.

    The windows of all that has to be kept up are taken to open at once.

    Source: SEMANTICS, section 3 (After a failure).
    """

    def of(part: Core) -> State:
        return _at_once(part, factory)

    match core:
        case CoreConstant(value=value):
            return factory.state_true if value else factory.state_false
        case Literal(proposition=proposition, sense=sense):
            return proposition if sense is Sense.TRUE else factory.negation(proposition)
        case And(args=args):
            return factory.state_all(map(of, args))
        case Or(args=args):
            return factory.state_any(map(of, args))
        case Next():
            return factory.state_true
        case Until(left=left, right=right, low=low):
            return of(left) if low else factory.state_any([of(left), of(right)])
        case Release(right=right):
            return of(right)
        case Since() | Previous():
            raise AssertionError("what looks back is asked otherwise")
        case _:
            assert_never(core)


class _Lowering:
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

    # Future.

    def core(self, formula: Formula, positive: bool) -> Core:
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
        args = [*_flat(left, left_sign, conjunction), *_flat(right, right_sign, conjunction)]
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
