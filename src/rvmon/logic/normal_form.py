"""Lowers formulas to core formulas: X, U and R over propositions of past and present.

`expanded` then splits these propositions further, into literals over single leaves.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

from msgspec import Struct

from rvmon.language.checked import formula as rv
from rvmon.language.checked.classify import has_future
from rvmon.language.checked.formula import Constant as ConstantLeaf
from rvmon.language.checked.rewrite import rewritten
from rvmon.language.checked.specification import Requirement
from rvmon.logic import formula as mtl
from rvmon.logic.formula import Constant as CoreConstant
from rvmon.logic.state_formula import FALSE, TRUE, UNKNOWN, Elapsed, State, StateOp, reads_fields
from rvmon.logic.three_valued import Reader


class Origin(Struct, frozen=True):
    """The source of a core formula: a formula of the specification, or its negation."""

    formula: rv.Formula
    positive: bool


class Lowering:
    """Lowers formulas to core form.

    Args:
        factory: makes the core formulas.
        period: the D of `sampled every D`, ticks; past intervals are cut to its multiples.
        favour: whether unborn propositions count in favour of the requirement.
        measured: see `rvmon.logic.three_valued.Reader`.
        sampled: whether only samples are positions.
        opened: whether lower bounds of `G` and `R` are taken as 0.
    """

    def __init__(
        self,
        factory: mtl.Factory,
        period: int | None,
        favour: bool,
        *,
        measured: bool = False,
        sampled: bool = False,
        opened: bool = False,
    ) -> None:
        self.factory = factory
        held = period is None and not sampled
        self.reader = Reader(factory, period, measured=measured, held=held)
        self.favour = favour
        self._may_lack_position = sampled
        self._measured = measured
        self._from_zero = opened
        self.origins: dict[mtl.Core, Origin] = {}  # the source of each core formula made so far
        self._made_up: dict[int, rv.Formula] = {}

    def state(self, formula: rv.Formula, positive: bool) -> State:
        """The state formula of `formula`; `positive` says whether it or its negation is required.

        The sign decides which value of unborn propositions is in favour of the requirement.
        """
        if not self.favour:
            return self.reader.literal(formula, UNKNOWN)
        return self.reader.literal(formula, TRUE if positive else FALSE)

    def episode(self, trigger: State, implied: mtl.Core, requirement: Requirement) -> mtl.Core:
        """`implied` at every position until the trigger is known to be false."""
        over = self.factory.literal(trigger, mtl.Sense.KNOWN_FALSE)
        self.origins.setdefault(over, Origin(requirement.trigger, False))
        required = self.factory.release(over, implied, 0, None)
        for node in (implied, required):
            self.origins[node] = Origin(requirement.consequent, True)
        return required

    def core(self, formula: rv.Formula, positive: bool) -> mtl.Core:
        """A formula, or its negation, in negation normal form."""
        if isinstance(formula, rv.Constant):
            return self.factory.constant(formula.value is positive)
        made_up = id(formula) in self._made_up
        if made_up or has_future(formula):
            made = self._core_future(formula, positive)
        else:
            sense = mtl.Sense.TRUE if positive else mtl.Sense.FALSE
            made = self.factory.literal(self.state(formula, positive), sense)
        if not made_up or _keeps_origin(formula):
            self.origins.setdefault(made, Origin(formula, positive))
        return made

    def _core_future(self, formula: rv.Formula, positive: bool) -> mtl.Core:
        match formula:
            case rv.Unary(op=rv.UnaryOp.NOT, operand=operand):
                return self.core(operand, not positive)
            case rv.Unary(op=rv.UnaryOp.NEXT, operand=operand):
                return self.factory.next(self.required(self.core(operand, positive)))
            case rv.Unary(op=rv.UnaryOp.PREVIOUS, operand=operand):
                before = self._if_position_exists(self.core(operand, positive))
                return self.factory.core_previous(before, first=not positive)
            case rv.Binary(op=rv.BinaryOp.AND | rv.BinaryOp.OR as op, left=left, right=right):
                conjunction = positive is (op is rv.BinaryOp.AND)
                args = [*flattened(left, positive, conjunction)]
                args += flattened(right, positive, conjunction)
                return self.join_signed(args, conjunction)
            case rv.Binary(op=rv.BinaryOp.UNTIL, left=left, right=right, interval=interval):
                ends = (self.core(left, positive), self.core(right, positive))
                return self._until(*ends, interval, positive)
            case rv.Binary(op=rv.BinaryOp.SINCE, left=left, right=right, interval=interval):
                ends = (self.core(left, positive), self.core(right, positive))
                return self._since(*ends, interval, not positive)
            # For robustness `held` keeps a test of its own for the elapsed time: the trace may have
            # started before an outage, across which nothing else is measured.
            case rv.Unary(
                op=rv.UnaryOp.HELD, operand=operand, interval=rv.Interval() as window
            ) if self._measured:
                whole = rv.Unary(rv.UnaryOp.HISTORICALLY, operand, window)
                self._made_up[id(whole)] = whole
                elapsed = self.factory.leaf(Elapsed(window.high or 0))
                also = elapsed if positive else self.factory.negation(elapsed)
                return self.join_signed([(whole, positive)], positive, [also])
            case rv.Unary() | rv.Binary():
                return self._core_future(self._rewritten(formula), positive)
            case _:
                raise AssertionError("an atom has no future operator below it")

    def _rewritten(self, formula: rv.Unary | rv.Binary) -> rv.Formula:
        """The formula in primitive operators; new nodes are recorded, as they have no origin."""
        made = rewritten(formula)
        own = (formula.operand,) if isinstance(formula, rv.Unary) else (formula.left, formula.right)
        waiting = [made]
        while waiting:
            node = waiting.pop()
            if all(node is not operand for operand in own):
                self._made_up[id(node)] = node
                if isinstance(node, rv.Unary):
                    waiting.append(node.operand)
                elif isinstance(node, rv.Binary):
                    waiting += (node.left, node.right)
        return made

    def _since(
        self, left: mtl.Core, right: mtl.Core, interval: rv.Interval | None, dual: bool
    ) -> mtl.Core:
        low, high = (interval.low, interval.high) if interval else (0, None)
        # `once` and `historically` have a constant on the left, which needs no position to be true.
        if left is not self.factory.constant(not dual):
            left = self._if_position_exists(left)
        right = self._if_position_exists(right)
        return self.factory.core_since(left, right, low, high, dual=dual)

    def _until(
        self, left: mtl.Core, right: mtl.Core, interval: rv.Interval | None, positive: bool
    ) -> mtl.Core:
        low, high = (interval.low, interval.high) if interval else (0, None)
        if self._from_zero and not positive:
            low = 0
        make = self.factory.until if positive else self.factory.release
        if not isinstance(left, CoreConstant):
            left = self.required(left)
        if low > 0 or right is not self.factory.constant(positive):
            right = self.required(right)
        return make(left, right, low, high)

    def required(self, operand: mtl.Core) -> mtl.Core:
        """An operand as required at a later position, which may not exist in an outage."""
        return self._if_position_exists(operand) if self._may_lack_position else operand

    def _if_position_exists(self, operand: mtl.Core) -> mtl.Core:
        """`operand`, but unknown where there may be no position; literals already are."""
        factory = self.factory
        # Robustness is only computed where positions surely exist.
        if isinstance(operand, mtl.Literal) or self._measured:
            return operand
        exists = factory.leaf(Elapsed(0))  # true; unknown where there may be no position
        whole = factory.all_of([factory.literal(exists, mtl.Sense.TRUE), operand])
        made = factory.any_of([whole, factory.literal(exists, mtl.Sense.FALSE)])
        if operand in self.origins:
            self.origins.setdefault(made, self.origins[operand])
        return made

    def join_signed(
        self, args: list[tuple[rv.Formula, bool]], conjunction: bool, further: Sequence[State] = ()
    ) -> mtl.Core:
        """The conjunction, or disjunction, of signed operands and of the states in `further`.

        All operands without future operators are joined into a single proposition.
        """
        factory = self.factory
        # They share one proposition, because each proposition multiplies the letters of the
        # automaton.
        present = [(f, sign) for f, sign in args if not has_future(f)]
        parts = [self.core(f, sign) for f, sign in args if has_future(f)]
        if present or further:
            states = [
                self.state(f, sign) if sign else factory.negation(self.state(f, sign))
                for f, sign in present
            ]
            whole = (factory.state_all if conjunction else factory.state_any)([*further, *states])
            literal = factory.literal(whole, mtl.Sense.TRUE)
            if present:
                self.origins.setdefault(literal, Origin(_rejoined(present, conjunction), True))
            parts.append(literal)
        return (factory.all_of if conjunction else factory.any_of)(parts)


def _keeps_origin(formula: rv.Formula) -> bool:
    """Whether a rewritten node is an origin: the `Y` that `rise` and `fall` expand to."""
    return isinstance(formula, rv.Unary) and formula.op is rv.UnaryOp.PREVIOUS


def flattened(formula: rv.Formula, sign: bool, conjunction: bool) -> list[tuple[rv.Formula, bool]]:
    """The operands of nested conjunctions (or disjunctions), each with its sign.

    Negations are pushed inwards: `a -> b` is the disjunction of `a` (negative) and `b`.
    """
    match formula:
        case rv.Unary(op=rv.UnaryOp.NOT, operand=operand):
            return flattened(operand, not sign, conjunction)
        case rv.Binary(op=rv.BinaryOp.AND | rv.BinaryOp.OR as op, left=left, right=right) if (
            sign is conjunction
        ) is (op is rv.BinaryOp.AND):
            return [*flattened(left, sign, conjunction), *flattened(right, sign, conjunction)]
        case rv.Binary(op=rv.BinaryOp.IMPLIES, left=left, right=right) if sign is not conjunction:
            return [*flattened(left, not sign, conjunction), *flattened(right, sign, conjunction)]
        case _:
            return [(formula, sign)]


def _rejoined(parts: list[tuple[rv.Formula, bool]], conjunction: bool) -> rv.Formula:
    """Signed formulas joined to one formula of the language, for display."""
    op = rv.BinaryOp.AND if conjunction else rv.BinaryOp.OR
    signed = [f if sign else rv.Unary(rv.UnaryOp.NOT, f, span=f.span) for f, sign in parts]
    whole = signed[0]
    for part in signed[1:]:
        span = whole.span.to(part.span) if whole.span and part.span else None
        whole = rv.Binary(op, whole, part, span=span)
    return whole


def expanded(core: mtl.Core) -> mtl.Core:
    """The formula with its propositions expanded, so that literals read leaves.

    Two-valued tests of knowledge (`sure`, doubt, KNOWN_FALSE, `φ and not φ`) stay whole, and so do
    measured windows and comparisons.
    """
    return _Expanding().core(core)


class _Expanding:
    def __init__(self) -> None:
        self.factory = mtl.Factory()
        self.core = cache(self._core)

    def _core(self, core: mtl.Core) -> mtl.Core:
        factory = self.factory
        match core:
            case mtl.Literal(sense=mtl.Sense.KNOWN_FALSE, proposition=state):
                return factory.literal(state, mtl.Sense.KNOWN_FALSE)
            case mtl.Literal(proposition=state, sense=sense):
                return self.state(state, sense is mtl.Sense.TRUE)
            case mtl.Release(left=mtl.Literal(sense=mtl.Sense.KNOWN_FALSE) as over, right=right):
                # An episode: its end satisfies `R` at that position too, whatever the robustness.
                ended = self.core(over)
                return factory.release(ended, factory.any_of([ended, self.core(right)]), 0, None)
            case _:
                return factory.rebuilt(core, self.core)

    def state(self, state: State, positive: bool) -> mtl.Core:
        factory = self.factory
        match state.op:
            case StateOp.LEAF if isinstance(state.leaf, ConstantLeaf):
                return factory.constant(state.leaf.value is positive)
            case StateOp.NOT:
                return self.state(state.args[0], not positive)
            case StateOp.AND | StateOp.OR if state.op is StateOp.OR or not _tests_unknown(state):
                join = factory.all_of if (state.op is StateOp.AND) is positive else factory.any_of
                return join(self.state(arg, positive) for arg in state.args)
            case StateOp.PREVIOUS:
                return factory.core_previous(
                    self.state(state.args[0], positive), first=not positive
                )
            case StateOp.SINCE:
                left, right = (self.state(arg, positive) for arg in state.args)
                return factory.core_since(left, right, state.low, state.high, dual=not positive)
            case _:
                return factory.literal(state, mtl.Sense.TRUE if positive else mtl.Sense.FALSE)


def _tests_unknown(state: State) -> bool:
    """Whether a conjunction is `φ and not φ`, by which `three_valued` tests for unknown."""
    args = set(state.args)
    denied = (arg.args[0] for arg in state.args if arg.op is StateOp.NOT)
    return any(
        args.issuperset(one.args if one.op is StateOp.AND else (one,))
        for one in denied
        if one.op is not StateOp.LEAF
        # The author of a specification may also conjoin an atom with its negation. Only a test of
        # ours reads both with the same value before the birth of the signals.
        or (isinstance(one.leaf, rv.Compare) and (one.unborn != UNKNOWN or reads_fields(one.leaf)))
    )
