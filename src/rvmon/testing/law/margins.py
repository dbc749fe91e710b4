"""The robustness of attempts, computed from its definition.

Every position is explicit, and every operator is a minimum of maxima over positions. Each figure is
an interval, as unknown input and all input after the end may be anything. Possible positions cut a
trace into pieces: outside the piece in which an attempt begins, input may be anything, too.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Mapping
from typing import assert_never

from rvmon.language.checked.formula import Binary, BinaryOp, Formula, Interval, Unary, UnaryOp
from rvmon.language.checked.specification import Mode, TimeModel
from rvmon.testing.law.attempts import Start, counts_in_favour
from rvmon.testing.law.decisions import Followings
from rvmon.testing.law.past import is_within, lasted
from rvmon.testing.law.ranges import ANY, BOTTOM, OF_TRUTH, TOP, Past, Range, least, most, negated
from rvmon.testing.law.syntax import is_proposition, is_upon_end
from rvmon.testing.law.truths import EVER
from rvmon.testing.law.word import Truth, Word, truth_of

Key = tuple[str, bool, int]
"""Requirement, whether the attempt is in doubt, and its number."""


def margins(
    followings: Mapping[str, Followings], recorded: Container[Key], time: TimeModel
) -> dict[Key, tuple[float, float, float]]:
    """The robustness of attempts.

    Args:
        followings: the attempts by requirement.
        recorded: the attempts with a record; others are left out.
        time: the time model.

    Returns:
        Lower bound, upper bound, and the lower bound if after the end every opened unbounded `R`
        (`always`) holds. The upper bound of an attempt in doubt is infinite, as it may not have
        been triggered and then has no obligation.

    Source: SEMANTICS, sections 1 (Birth), 2, 3 and 5.
    """
    held = time is TimeModel.HELD
    found = {}
    for name, own in followings.items():
        for attempt in own.attempts:
            in_doubt = attempt.start.sure is None
            key = (name, in_doubt, attempt.doubtful_number if in_doubt else attempt.number)
            if key in recorded:
                low, high = _required(attempt.start, kept=False, held=held)
                kept, _ = _required(attempt.start, kept=True, held=held)
                found[key] = (low, TOP[1] if in_doubt else high, kept)
    return found


def _piece(word: Word, position: int) -> tuple[Word, int]:
    """The piece of sure positions around a position: the word up to its end, and its first one."""
    letters = word.letters
    last = next((k for k in range(position, len(letters)) if not letters[k].sure), None)
    first = next((k + 1 for k in reversed(range(position)) if not letters[k].sure), 0)
    if last is None:
        return word, first
    return Word(letters[:last], None, letters[last].instant), first


def _required(start: Start, *, kept: bool, held: bool) -> Range:
    requirement = start.view.requirement
    favour = counts_in_favour(requirement)
    if not start.word.letters[start.position].sure:
        return ANY
    word, first = _piece(start.word, start.position)
    positions = [k for k in start.positions if k < len(word.letters)]
    over = start.stop is not None and start.stop < len(word.letters)
    past = Past(word, start.captured, first, held=held)
    ranges = _Ranges(word, past, first, favour=favour, kept=kept)

    def consequent(k: int) -> Range:
        return ranges.range(requirement.consequent, k)

    if is_upon_end(requirement) or (requirement.mode is Mode.UPON and start.sure is not None):
        return consequent(start.position)

    def required(k: int) -> Range:
        if start.blurred is not None and k >= start.blurred:
            return ANY
        if requirement.mode is Mode.UPON:
            return most([ANY, consequent(k)])
        excused = negated(past.range(requirement.trigger, k, Truth.FALSE))
        return most([excused, consequent(k)])

    end = over or (kept and len(word.letters) == len(start.word.letters))
    return least([*map(required, positions), TOP if end else ANY])


class _Ranges:
    def __init__(self, word: Word, past: Past, first: int, *, favour: bool, kept: bool) -> None:
        self.letters = word.letters
        self.end = word.end
        self.reached = word.reached
        self.favour = favour
        self.kept = kept
        self.first = first
        self.past = past
        self.known: dict[tuple[int, int, bool], Range] = {}

    def range(self, formula: Formula, i: int, *, positive: bool = True) -> Range:
        key = (id(formula), i, positive)
        if key not in self.known:
            self.known[key] = self._range(formula, i, positive)
        return self.known[key]

    def _range(self, formula: Formula, i: int, positive: bool) -> Range:
        if is_proposition(formula):
            unborn = truth_of(positive) if self.favour else Truth.UNKNOWN
            return self.past.range(formula, i, unborn)
        match formula:
            case Unary():
                return self._unary(formula, i, positive)
            case Binary():
                return self._binary(formula, i, positive)
            case _:
                raise AssertionError("atoms are propositions")

    def _unary(self, formula: Unary, i: int, positive: bool) -> Range:
        window = formula.interval or EVER

        def operand(k: int) -> Range:
            return self.range(formula.operand, k, positive=positive)

        def opposite(k: int) -> Range:
            return negated(self.range(formula.operand, k, positive=not positive))

        match formula.op:
            case UnaryOp.NOT:
                return opposite(i)
            case UnaryOp.NEXT:
                return operand(i + 1) if i + 1 < len(self.letters) else ANY
            case UnaryOp.EVENTUALLY:
                return self._until(_always(TOP), operand, i, window, positive)
            case UnaryOp.ALWAYS:
                return self._release(_always(BOTTOM), operand, i, window, positive)
            case UnaryOp.PREVIOUS:
                return self._before(operand, i, BOTTOM)
            case UnaryOp.ONCE:
                return self._since(_always(TOP), operand, i, window)
            case UnaryOp.HISTORICALLY:
                return negated(self._since(_always(TOP), _not(operand), i, window))
            case UnaryOp.HELD:
                begun = OF_TRUTH[lasted(self.letters, i, window.high or 0)]
                whole = negated(self._since(_always(TOP), _not(operand), i, window))
                return least([begun, whole])
            case UnaryOp.RISE:
                return least([operand(i), self._before(opposite, i, TOP)])
            case UnaryOp.FALL:
                return least([opposite(i), self._before(operand, i, BOTTOM)])
            case _:
                assert_never(formula.op)

    def _binary(self, formula: Binary, i: int, positive: bool) -> Range:
        window = formula.interval or EVER

        def left(k: int) -> Range:
            return self.range(formula.left, k, positive=positive)

        def right(k: int) -> Range:
            return self.range(formula.right, k, positive=positive)

        def not_left(k: int) -> Range:
            return negated(self.range(formula.left, k, positive=not positive))

        def not_right(k: int) -> Range:
            return negated(self.range(formula.right, k, positive=not positive))

        def either(k: int) -> Range:
            return most([left(k), right(k)])

        def both(k: int) -> Range:
            return least([left(k), right(k)])

        match formula.op:
            case BinaryOp.AND:
                return both(i)
            case BinaryOp.OR:
                return either(i)
            case BinaryOp.IMPLIES:
                return most([not_left(i), right(i)])
            case BinaryOp.IFF:
                return most([both(i), least([not_left(i), not_right(i)])])
            case BinaryOp.XOR:
                return most([least([left(i), not_right(i)]), least([not_left(i), right(i)])])
            case BinaryOp.UNTIL:
                return self._until(left, right, i, window, positive)
            case BinaryOp.RELEASE:
                return self._release(left, right, i, window, positive)
            case BinaryOp.WEAK_UNTIL:
                return self._release(right, either, i, window, positive)
            case BinaryOp.STRONG_RELEASE:
                return self._until(right, both, i, window, positive)
            case BinaryOp.SINCE:
                return self._since(left, right, i, window)
            case _:
                assert_never(formula.op)

    def _until(
        self, left: Operand, right: Operand, i: int, window: Interval, positive: bool
    ) -> Range:
        rest = ANY if positive else negated(self._rest(i, window))
        return self._some(left, right, i, window, rest)

    def _release(
        self, left: Operand, right: Operand, i: int, window: Interval, positive: bool
    ) -> Range:
        rest = negated(self._rest(i, window)) if positive else ANY
        return negated(self._some(_not(left), _not(right), i, window, rest))

    def _rest(self, i: int, window: Interval) -> Range:
        opens = self.letters[i].instant + window.low
        opened = window.high is None and self.end is not None and opens <= self.end
        return TOP if self.kept and opened else ANY

    def _some(self, left: Operand, right: Operand, i: int, window: Interval, rest: Range) -> Range:
        now = self.letters[i].instant
        ways = [
            least([right(j), *(left(k) for k in range(i, j))])
            for j in range(i, len(self.letters))
            if is_within(self.letters[j].instant - now, window)
        ]
        if window.high is None or self.reached <= now + window.high:
            ways.append(least([rest, *(left(k) for k in range(i, len(self.letters)))]))
        return most(ways)

    def _since(self, left: Operand, right: Operand, i: int, window: Interval) -> Range:
        now, own = self.letters[i].instant, range(self.first, i + 1)
        ways = [
            least([right(j), *(left(k) for k in range(j + 1, i + 1))])
            for j in own
            if is_within(now - self.letters[j].instant, window)
        ]
        if self.past.reaches_out(i, window):
            ways.append(least([ANY, *map(left, own)]))
        return most(ways)

    def _before(self, operand: Operand, i: int, nothing: Range) -> Range:
        if i == self.first:
            return ANY if i else nothing
        return operand(i - 1)


Operand = Callable[[int], Range]


def _always(value: Range) -> Operand:
    return lambda _: value


def _not(operand: Operand) -> Operand:
    return lambda k: negated(operand(k))
