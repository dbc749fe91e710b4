"""The meaning of each operator, whether its operands are truths or margins.

It is written as SEMANTICS gives it and not taken from the table of operators
(`rvmon.language.checked.operators`), so that errors in the table are found.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from typing import Generic, Protocol, TypeVar, assert_never

from rvmon.language.checked.formula import Binary, BinaryOp, Formula, Interval, Unary, UnaryOp
from rvmon.testing.law.syntax import constant_value, speaks_of_future
from rvmon.testing.law.word import Rest, Truth, Word, negation

V = TypeVar("V")
V_co = TypeVar("V_co", covariant=True)
At = Callable[[int], V]
"""The value of an operand at a position."""
EVER = Interval(0, None)


def is_within(distance: int, interval: Interval) -> bool:
    """Whether a distance in ticks lies in an interval."""
    return interval.low <= distance and (interval.high is None or distance <= interval.high)


class Operators(ABC, Generic[V]):
    """The values of operators at the positions of a word, from those of their operands.

    Args:
        word: the trace.
        rest: the assumption about pending operators.

    Source: SEMANTICS, sections 1 (Birth) and 2.
    """

    def __init__(self, word: Word, rest: Rest) -> None:
        self._letters = word.letters
        self._end = word.end
        self._rest = rest
        self._reached = word.reached
        self._known = len(word.letters)
        self._true, self._false = self.of_truth(Truth.TRUE), self.of_truth(Truth.FALSE)

    @abstractmethod
    def of_truth(self, truth: Truth) -> V:
        """The value of a formula of which only the truth matters."""

    @abstractmethod
    def negation(self, value: V, /) -> V:
        """The value of `not φ`."""

    @abstractmethod
    def both(self, left: V, right: V, /) -> V:
        """The value of `φ and ψ`."""

    @abstractmethod
    def either(self, left: V, right: V, /) -> V:
        """The value of `φ or ψ`."""

    @abstractmethod
    def born_or_false(self, value: V, /) -> V:
        """Read UNBORN as FALSE."""

    @abstractmethod
    def previous(self, operand: At[V], i: int) -> V:
        """The value at the position before; FALSE before the first one."""

    @abstractmethod
    def since(
        self, left: At[V], right: At[V], i: int, interval: Interval, *, can_be_unborn: bool
    ) -> V:
        """Whether `right` held at a position of the window, and `left` at all later ones up to `i`.

        Positions at which an operand is unborn are skipped; if `right` is unborn throughout the
        window, so is the result. If `right` can be unborn and is nowhere TRUE or FALSE in the
        window, the result is UNKNOWN even if `left` is FALSE: a value lost in an outage may have
        been unborn, too.
        """

    @abstractmethod
    def held(self, operand: At[V], i: int, interval: Interval, *, can_be_unborn: bool) -> V:
        """Whether the operand held at all positions of the window, and was born before the window.

        Where the operand is UNKNOWN it may be unborn, so an UNKNOWN value shows no birth.
        """

    def operator(self, formula: Unary | Binary, i: int, sub: Sub[V], *, positive: bool = True) -> V:
        """The value of an operator from the values of its operands.

        `positive`: whether the operator is under an even number of negations.
        """
        if isinstance(formula, Unary):
            return self._unary(formula, i, sub, positive)
        return self._binary(formula, i, sub, positive)

    def _unary(self, formula: Unary, i: int, sub: Sub[V], positive: bool) -> V:
        interval = formula.interval or EVER

        def operand(k: int) -> V:
            return sub(formula.operand, k)

        def below_not(k: int) -> V:
            return sub(formula.operand, k, False)

        match formula.op:
            case UnaryOp.NOT:
                return self.negation(below_not(i))
            case UnaryOp.NEXT:
                return self._next(operand, i, positive)
            case UnaryOp.EVENTUALLY:
                return self._until(self._always_true, operand, i, interval, positive)
            case UnaryOp.ALWAYS:
                return self._release(lambda _: self._false, operand, i, interval, positive)
            case UnaryOp.PREVIOUS:
                return self.previous(operand, i)
            case UnaryOp.ONCE:
                return self.since(self._always_true, operand, i, interval, can_be_unborn=False)
            case UnaryOp.HISTORICALLY:  # not once not φ
                other = self._inverted(operand)
                return self.negation(
                    self.since(self._always_true, other, i, interval, can_be_unborn=False)
                )
            case UnaryOp.HELD:
                can_be_unborn = not speaks_of_future(formula.operand)
                return self.held(operand, i, interval, can_be_unborn=can_be_unborn)
            case UnaryOp.RISE:  # φ and not previous φ
                before = self.born_or_false(self.previous(below_not, i))
                return self.both(operand(i), self.negation(before))
            case UnaryOp.FALL:  # not φ and previous φ
                before = self.born_or_false(self.previous(operand, i))
                return self.both(self.negation(below_not(i)), before)
            case _:
                assert_never(formula.op)

    def _binary(self, formula: Binary, i: int, sub: Sub[V], positive: bool) -> V:
        interval = formula.interval or EVER

        def left(k: int) -> V:
            return sub(formula.left, k)

        def right(k: int) -> V:
            return sub(formula.right, k)

        def not_left(k: int) -> V:
            return self.negation(sub(formula.left, k, False))

        def not_right(k: int) -> V:
            return self.negation(sub(formula.right, k, False))

        def both(k: int) -> V:
            return self.both(left(k), right(k))

        def either(k: int) -> V:
            return self.either(left(k), right(k))

        match formula.op:
            case BinaryOp.AND:
                return both(i)
            case BinaryOp.OR:
                return either(i)
            case BinaryOp.IMPLIES:
                return self.either(not_left(i), right(i))
            case BinaryOp.IFF:
                return self.either(both(i), self.both(not_left(i), not_right(i)))
            case BinaryOp.XOR:
                one = self.both(left(i), not_right(i))
                return self.either(one, self.both(not_left(i), right(i)))
            case BinaryOp.UNTIL:
                lasting = self._lasting(formula.left, left)
                return self._until(lasting, right, i, interval, positive)
            case BinaryOp.RELEASE:
                lasting = self._lasting(formula.left, left)
                return self._release(lasting, right, i, interval, positive)
            case BinaryOp.WEAK_UNTIL:  # ψ R (φ | ψ)
                lasting = self._lasting(formula.right, right)
                return self._release(lasting, either, i, interval, positive)
            case BinaryOp.STRONG_RELEASE:  # ψ U (φ & ψ)
                lasting = self._lasting(formula.right, right)
                return self._until(lasting, both, i, interval, positive)
            case BinaryOp.SINCE:
                lasting = self._lasting(formula.left, left)
                can_be_unborn = not speaks_of_future(formula)
                return self.since(lasting, right, i, interval, can_be_unborn=can_be_unborn)
            case _:
                assert_never(formula.op)

    def _window(self, i: int, interval: Interval) -> Iterator[int]:
        """The positions of a window of the past."""
        now = self._letters[i].instant
        return (k for k in range(i + 1) if is_within(now - self._letters[k].instant, interval))

    def _lasted(self, i: int, duration: int) -> Truth:
        """Whether the trace started at least `duration` ticks before a position."""
        starts = [self._letters[k] for k in self._window(i, Interval(duration, None))]
        if any(letter.sure for letter in starts):
            return Truth.TRUE
        return Truth.UNKNOWN if starts else Truth.FALSE

    def _always_true(self, _: int) -> V:
        return self._true

    def _inverted(self, operand: At[V]) -> At[V]:
        return lambda k: self.negation(operand(k))

    def _lasting(self, part: Formula, operand: At[V]) -> At[V]:
        """An operand that has to last up to some position; a constant needs no positions for that.

        So `true U φ` equals `F φ` across possible positions, too, at which every formula is
        unknown.
        """
        constant = constant_value(part)
        return operand if constant is Truth.UNKNOWN else lambda _: self.of_truth(constant)

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

    def _rest_of_release(self, i: int, interval: Interval) -> Truth:
        if interval.high is not None:
            return self._other_rest()
        opens = self._letters[i].instant + interval.low
        return self.release_rest(opened=self._end is not None and opens <= self._end)

    def _next(self, operand: At[V], i: int, positive: bool) -> V:
        if i + 1 < self._known:
            return operand(i + 1)
        rest = self._other_rest()
        return self.of_truth(rest if positive else negation(rest))

    def _until(self, left: At[V], right: At[V], i: int, interval: Interval, positive: bool) -> V:
        """`left U right`: in negation normal form an `R` if it is under a negation."""
        rest = self._other_rest() if positive else negation(self._rest_of_release(i, interval))
        return self._some(left, right, i, interval, rest)

    def _release(self, left: At[V], right: At[V], i: int, interval: Interval, positive: bool) -> V:
        """`left R right` = `!(!left U !right)`."""
        rest = self._rest_of_release(i, interval) if positive else negation(self._other_rest())
        others = self._inverted(left), self._inverted(right)
        return self.negation(self._some(*others, i, interval, negation(rest)))

    def _some(self, left: At[V], right: At[V], i: int, interval: Interval, rest: Truth) -> V:
        """Whether `right` holds at some position of the window, and `left` from `i` on before it.

        As long as the window is not over, that position may still come; then `rest` counts.
        """
        now = self._letters[i].instant
        value, so_far = self._false, self._true
        for j in range(i, self._known):
            if is_within(self._letters[j].instant - now, interval):
                value = self.either(value, self.both(so_far, right(j)))
            so_far = self.both(so_far, left(j))
            if value == self._true or so_far == self._false:
                return value
        over = interval.high is not None and self._reached > now + interval.high
        return value if over else self.either(value, self.both(so_far, self.of_truth(rest)))


class Sub(Protocol[V_co]):
    """A function for the value of an operand at a position; `same`: it is not negated."""

    def __call__(self, part: Formula, k: int, same: bool = True, /) -> V_co:
        """Evaluate the operand."""
