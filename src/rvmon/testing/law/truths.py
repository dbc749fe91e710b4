"""The truth of formulas after a prefix, computed from the definitions of their operators.

The meaning of each operator is written here as SEMANTICS gives it, and not taken from the table of
operators (`rvmon.language.checked.operators`), so that errors of the table are found.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol, assert_never

from rvmon.language.checked.formula import (
    Amount,
    Binary,
    BinaryOp,
    Bound,
    BoundAtom,
    Compare,
    Constant,
    EventAtom,
    Formula,
    Interval,
    Numeric,
    Passed,
    ProbeAtom,
    SignalAtom,
    Unary,
    UnaryOp,
    windows_in,
)
from rvmon.testing.law.amounts import UNKNOWN, Past
from rvmon.testing.law.numbers import as_ticks, compare, number
from rvmon.testing.law.past import (
    Operand,
    always_false,
    always_true,
    held,
    historically,
    inverted,
    is_within,
    since,
    unless_constant,
)
from rvmon.testing.law.syntax import is_proposition, speaks_of_future
from rvmon.testing.law.word import (
    Rest,
    Truth,
    Word,
    born_or_false,
    born_or_true,
    both,
    conjunction,
    disjunction,
    either,
    negation,
    probed,
    truth_of,
)
from rvmon.trace.sample import Scalar

EVER = Interval(0, None)


class Truths:
    """The truth of formulas at positions of a word, after a prefix of it.

    A truth other than UNKNOWN is final: it stays the same for longer prefixes, so it is cached.

    Args:
        word: the trace.
        captured: values of `let` and `for each`.
        rest: the assumption about pending operators.
        favour: whether an unborn proposition counts as met; else it is UNKNOWN.

    Source: SEMANTICS, sections 1 (Birth) and 2; decision record 4.
    """

    def __init__(
        self,
        word: Word,
        captured: Mapping[str, Scalar],
        rest: Rest = Rest.UNKNOWN,
        *,
        favour: bool = False,
    ) -> None:
        self._letters = word.letters
        self._end = word.end
        self._captured = captured
        self._rest = rest
        self._favour = favour
        self._settled: dict[tuple[int, int, bool], Truth] = {}
        self._pending: dict[tuple[int, int, bool], Truth] = {}
        self._states: dict[tuple[int, int], Truth] = {}
        self._reached = word.reached
        self._known = 0
        self.reach(word.reached)

    def reach(self, reached: int) -> None:
        """Evaluate on the prefix known at the instant `reached`.

        After the first evaluation, instants must not decrease.
        """
        self._reached = reached
        self._known = sum(letter.instant <= reached for letter in self._letters)
        self._pending.clear()

    @property
    def known(self) -> int:
        """The number of known positions."""
        return self._known

    def truth(self, formula: Formula, i: int, *, positive: bool = True) -> Truth:
        """The truth of a required formula at a known position: never UNBORN.

        Args:
            formula: any formula.
            i: the position.
            positive: whether an even number of negations stands above the formula; it decides how
                pending operators and unborn propositions count.
        """
        if not self._letters[i].sure:
            return Truth.UNKNOWN
        key = (id(formula), i, positive)
        value = self._settled.get(key)
        if value is None:
            value = self._pending.get(key)
        if value is None:
            value = self._truth(formula, i, positive)
            (self._pending if value is Truth.UNKNOWN else self._settled)[key] = value
        return value

    def _truth(self, formula: Formula, i: int, positive: bool) -> Truth:
        if is_proposition(formula):
            value = self.state(formula, i)
            if value is not Truth.UNBORN:
                return value
            return truth_of(positive) if self._favour else Truth.UNKNOWN

        def sub(part: Formula, k: int, same: bool = True) -> Truth:
            return self.truth(part, k, positive=positive is same)

        return self._composed(formula, i, positive, sub)

    def state(self, formula: Formula, i: int) -> Truth:
        """The truth of a formula of the present and past at a position; it may be UNBORN.

        At a possible position every formula is UNKNOWN, even a constant.
        """
        if not self._letters[i].sure:
            return Truth.UNKNOWN
        key = (id(formula), i)
        value = self._states.get(key)
        if value is None:
            value = self._states[key] = self._state(formula, i)
        return value

    def _state(self, formula: Formula, i: int) -> Truth:
        letter = self._letters[i]
        match formula:
            case Constant(value=value):
                return truth_of(value)
            case SignalAtom(name=name):
                state = letter.signals[name]
                if state.value is None:
                    return Truth.UNKNOWN if state.born else Truth.UNBORN
                return truth_of(bool(state.value))
            case EventAtom(name=name):
                return disjunction(o.truth for o in letter.events[name].occurrences)
            case Compare(left=left, right=right) if windows_in(left, right):
                return Past(self._letters, self._captured, self.state).compared(formula, i)
            case Compare():
                return compare(formula, letter, self._captured)
            case ProbeAtom(probe=probe, name=name):
                return probed(probe, name, letter)
            case BoundAtom(bound=bound):
                if bound is Bound.END:
                    raise ValueError("`end` stands alone as a trigger, never inside a formula")
                return self._is_first(i)
            case Unary() | Binary():
                return self._composed(formula, i, True, lambda part, k, _=True: self.state(part, k))
            case Amount():
                return Past(self._letters, self._captured, self.state).truth(formula, i)
            case Passed():
                return self._passed(formula, i)
            case _:
                assert_never(formula)

    def settled(self, expression: Numeric, i: int) -> Numeric:
        """An expression with each window replaced by its value at a position."""
        past = Past(self._letters, self._captured, self.state)
        return past.settled(expression, i) if self._letters[i].sure else UNKNOWN

    def _passed(self, formula: Passed, i: int) -> Truth:
        """Whether enough time has passed; UNKNOWN if that depends on when the trace began."""
        after = number(formula.after, self._letters[i], {}, self._captured)
        since = 0 if formula.since is None else self._captured[formula.since]
        if not isinstance(after, int | float) or not isinstance(since, int):
            unborn = self.state(formula.known, i) is Truth.UNBORN
            return Truth.UNBORN if unborn else Truth.UNKNOWN
        ticks = since + as_ticks(after) + formula.strict
        firsts = [letter.instant for letter in self._letters if letter.sure][:1]
        firsts += [self._letters[0].instant] if not self._letters[0].sure else []
        late = {self._letters[i].instant - first >= ticks for first in firsts}
        return truth_of(late.pop()) if len(late) == 1 else Truth.UNKNOWN

    def _is_first(self, i: int) -> Truth:
        """Whether a position is the first one."""
        before = {letter.sure for letter in self._letters[:i]}
        return Truth.FALSE if True in before else Truth.UNKNOWN if before else Truth.TRUE

    def release_rest(self, opened: bool) -> Truth:
        """The assumed truth of a pending unbounded `R`; `opened`: whether its window has opened."""
        match self._rest:
            case Rest.UNKNOWN:
                return Truth.UNKNOWN
            case Rest.END:
                return Truth.TRUE if opened else Truth.UNKNOWN
            case Rest.WEAK:
                return Truth.TRUE
            case Rest.STRONG:
                return Truth.FALSE

    def _other_rest(self) -> Truth:
        """The assumed truth of any other pending operator."""
        return self.release_rest(opened=False)

    def _composed(self, formula: Formula, i: int, positive: bool, sub: Sub) -> Truth:
        """The truth of an operator from the truths of its operands."""
        match formula:
            case Unary():
                return self._unary(formula, i, positive, sub)
            case Binary():
                return self._binary(formula, i, positive, sub)
            case _:
                raise AssertionError("atoms are not composed")

    def _unary(self, formula: Unary, i: int, positive: bool, sub: Sub) -> Truth:
        interval = formula.interval or EVER

        def operand(k: int) -> Truth:
            return sub(formula.operand, k)

        def negated(k: int) -> Truth:
            return negation(sub(formula.operand, k, False))

        match formula.op:
            case UnaryOp.NOT:
                return negated(i)
            case UnaryOp.NEXT:
                return self._next(operand, i, positive)
            case UnaryOp.EVENTUALLY:
                return self._until(always_true, operand, i, interval, positive)
            case UnaryOp.ALWAYS:
                return self._release(always_false, operand, i, interval, positive)
            case UnaryOp.PREVIOUS:
                return operand(i - 1) if i else Truth.FALSE
            case UnaryOp.ONCE:
                return since(self._letters, always_true, operand, i, interval)
            case UnaryOp.HISTORICALLY:
                return historically(self._letters, operand, i, interval)
            case UnaryOp.HELD:
                can_be_unborn = not speaks_of_future(formula.operand)
                return held(self._letters, operand, i, interval, can_be_unborn=can_be_unborn)
            case UnaryOp.RISE:  # φ and not previous φ
                before = born_or_true(negated(i - 1)) if i else Truth.TRUE
                return conjunction([operand(i), before])
            case UnaryOp.FALL:  # not φ and previous φ
                before = born_or_false(operand(i - 1)) if i else Truth.FALSE
                return conjunction([negated(i), before])
            case _:
                assert_never(formula.op)

    def _binary(self, formula: Binary, i: int, positive: bool, sub: Sub) -> Truth:
        interval = formula.interval or EVER

        def left(k: int) -> Truth:
            return sub(formula.left, k)

        def right(k: int) -> Truth:
            return sub(formula.right, k)

        def not_left(k: int) -> Truth:
            return negation(sub(formula.left, k, False))

        def not_right(k: int) -> Truth:
            return negation(sub(formula.right, k, False))

        match formula.op:
            case BinaryOp.AND:
                return conjunction([left(i), right(i)])
            case BinaryOp.OR:
                return disjunction([left(i), right(i)])
            case BinaryOp.IMPLIES:
                return disjunction([not_left(i), right(i)])
            case BinaryOp.IFF:
                same = conjunction([left(i), right(i)])
                return disjunction([same, conjunction([not_left(i), not_right(i)])])
            case BinaryOp.XOR:
                one = conjunction([left(i), not_right(i)])
                return disjunction([one, conjunction([not_left(i), right(i)])])
            case BinaryOp.UNTIL:
                lasting = unless_constant(formula.left, left, Truth.TRUE)
                return self._until(lasting, right, i, interval, positive)
            case BinaryOp.RELEASE:
                lasting = unless_constant(formula.left, left, Truth.FALSE)
                return self._release(lasting, right, i, interval, positive)
            case BinaryOp.WEAK_UNTIL:  # ψ R (φ | ψ)
                lasting = unless_constant(formula.right, right, Truth.FALSE)
                return self._release(
                    lasting, lambda k: disjunction([left(k), right(k)]), i, interval, positive
                )
            case BinaryOp.STRONG_RELEASE:  # ψ U (φ & ψ)
                lasting = unless_constant(formula.right, right, Truth.TRUE)
                return self._until(
                    lasting, lambda k: conjunction([left(k), right(k)]), i, interval, positive
                )
            case BinaryOp.SINCE:
                lasting = unless_constant(formula.left, left, Truth.TRUE)
                can_be_unborn = not speaks_of_future(formula)
                return since(
                    self._letters, lasting, right, i, interval, can_be_unborn=can_be_unborn
                )
            case _:
                assert_never(formula.op)

    def _next(self, operand: Operand, i: int, positive: bool) -> Truth:
        if i + 1 < self._known:
            return operand(i + 1)
        rest = self._other_rest()
        return rest if positive else negation(rest)

    def _until(
        self, left: Operand, right: Operand, i: int, interval: Interval, positive: bool
    ) -> Truth:
        """`left U right`: in negation normal form an `R` if it stands below a negation."""
        if positive:
            return self._some(left, right, i, interval, self._other_rest())
        rest = self._rest_of_release(i, interval)
        return self._some(left, right, i, interval, negation(rest))

    def _release(
        self, left: Operand, right: Operand, i: int, interval: Interval, positive: bool
    ) -> Truth:
        """`left R right` = `!(!left U !right)`."""
        rest = self._rest_of_release(i, interval) if positive else negation(self._other_rest())
        until = self._some(inverted(left), inverted(right), i, interval, negation(rest))
        return negation(until)

    def _rest_of_release(self, i: int, interval: Interval) -> Truth:
        if interval.high is not None:
            return self._other_rest()
        opens = self._letters[i].instant + interval.low
        return self.release_rest(opened=self._end is not None and opens <= self._end)

    def _some(
        self, left: Operand, right: Operand, i: int, interval: Interval, rest: Truth
    ) -> Truth:
        """Some position of the window has `right`, and all before it, from `i` on, have `left`.

        As long as the window is not over, that position may be yet to come: then `rest` counts.
        """
        now = self._letters[i].instant
        value, so_far = Truth.FALSE, Truth.TRUE
        for j in range(i, self._known):
            if is_within(self._letters[j].instant - now, interval):
                value = either(value, both(so_far, right(j)))
            so_far = both(so_far, left(j))
            if value is Truth.TRUE or so_far is Truth.FALSE:
                return value
        over = interval.high is not None and self._reached > now + interval.high
        return value if over else disjunction([value, conjunction([so_far, rest])])


class Sub(Protocol):
    """Gives the truth of an operand at a position; `same`: no negation stands above it."""

    def __call__(self, part: Formula, k: int, same: bool = True, /) -> Truth:
        """Evaluate the operand."""
