"""The truth of formulas after a prefix, computed from the definitions of their operators."""

from __future__ import annotations

from collections.abc import Mapping
from typing import assert_never

from rvmon.language.checked import formula as rv
from rvmon.testing.law.amounts import UNKNOWN, Past
from rvmon.testing.law.numbers import as_ticks, compare, number
from rvmon.testing.law.operators import At, Operators, is_within
from rvmon.testing.law.syntax import is_composed
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


class Truths(Operators[Truth]):
    """The truth of formulas at positions of a word, after a prefix of it.

    A truth other than UNKNOWN is final: it stays the same for longer prefixes, so it is cached.

    Args:
        word: the trace.
        captured: the values of `let` and `for each`.
        rest: the assumption about pending operators.
        favour: whether an unborn proposition counts as met; otherwise it is UNKNOWN.

    Source: SEMANTICS, sections 1 (Birth) and 2; decision record 4.
    """

    negation = staticmethod(negation)
    both = staticmethod(both)
    either = staticmethod(either)
    born_or_false = staticmethod(born_or_false)

    def __init__(
        self,
        word: Word,
        captured: Mapping[str, Scalar],
        rest: Rest = Rest.UNKNOWN,
        *,
        favour: bool = False,
    ) -> None:
        super().__init__(word, rest)
        self._captured = captured
        self._favour = favour
        self._settled: dict[tuple[int, int, bool], Truth] = {}
        self._pending: dict[tuple[int, int, bool], Truth] = {}
        self._states: dict[tuple[int, int], Truth] = {}
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

    def truth(self, formula: rv.Formula, i: int, *, positive: bool = True) -> Truth:
        """The truth of a required formula at a known position: never UNBORN.

        Args:
            formula: any formula.
            i: the position.
            positive: whether the formula is under an even number of negations, which decides how
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

    def _truth(self, formula: rv.Formula, i: int, positive: bool) -> Truth:
        if is_composed(formula):

            def sub(part: rv.Formula, k: int, same: bool = True) -> Truth:
                return self.truth(part, k, positive=positive is same)

            return self.operator(formula, i, sub, positive=positive)
        value = self.state(formula, i)
        if value is not Truth.UNBORN:
            return value
        return truth_of(positive) if self._favour else Truth.UNKNOWN

    def state(self, formula: rv.Formula, i: int) -> Truth:
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

    def _state(self, formula: rv.Formula, i: int) -> Truth:
        letter = self._letters[i]
        match formula:
            case rv.Constant(value=value):
                return truth_of(value)
            case rv.SignalAtom(name=name):
                state = letter.signals[name]
                if state.value is None:
                    return Truth.UNKNOWN if state.born else Truth.UNBORN
                return truth_of(bool(state.value))
            case rv.EventAtom(name=name):
                return disjunction(o.truth for o in letter.events[name].occurrences)
            case rv.Compare(left=left, right=right) if rv.windows_in(left, right):
                return Past(self._letters, self._captured, self.state).compared(formula, i)
            case rv.Compare():
                return compare(formula, letter, self._captured)
            case rv.ProbeAtom(probe=probe, name=name):
                return probed(probe, name, letter)
            case rv.BoundAtom(bound=bound):
                if bound is rv.Bound.END:
                    raise ValueError("`end` stands alone as a trigger, never inside a formula")
                return self._is_first(i)
            case rv.Unary() | rv.Binary():
                return self.operator(formula, i, lambda part, k, _=True: self.state(part, k))
            case rv.Amount():
                return Past(self._letters, self._captured, self.state).truth(formula, i)
            case rv.Passed():
                return self._passed(formula, i)
            case _:
                assert_never(formula)

    def settled(self, expression: rv.Numeric, i: int) -> rv.Numeric:
        """An expression with each window replaced by its value at a position."""
        past = Past(self._letters, self._captured, self.state)
        return past.settled(expression, i) if self._letters[i].sure else UNKNOWN

    def _passed(self, formula: rv.Passed, i: int) -> Truth:
        """Whether enough time has passed; UNKNOWN if that depends on when the trace started."""
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

    def of_truth(self, truth: Truth) -> Truth:
        """The truth itself."""
        return truth

    def previous(self, operand: At[Truth], i: int) -> Truth:
        """See `Operators`."""
        return operand(i - 1) if i else Truth.FALSE

    def since(
        self,
        left: At[Truth],
        right: At[Truth],
        i: int,
        interval: rv.Interval,
        *,
        can_be_unborn: bool,
    ) -> Truth:
        """See `Operators`."""
        shows_birth = {Truth.TRUE, Truth.FALSE} if can_be_unborn else {*Truth} - {Truth.UNBORN}
        now = self._letters[i].instant
        value, so_far = Truth.FALSE, Truth.TRUE
        seen: set[Truth] = set()
        for j in range(i, -1, -1):
            if is_within(now - self._letters[j].instant, interval):
                there = right(j)
                seen.add(there)
                if there is not Truth.UNBORN:
                    value = either(value, both(so_far, there))
            so_far = both(so_far, born_or_true(left(j)))
            if value is Truth.TRUE or (so_far is Truth.FALSE and seen & shows_birth):
                return value
        return disjunction(seen) if seen and not seen & shows_birth else value

    def held(
        self, operand: At[Truth], i: int, interval: rv.Interval, *, can_be_unborn: bool
    ) -> Truth:
        """See `Operators`."""
        values = [operand(k) for k in self._window(i, interval)]
        if can_be_unborn and not {Truth.TRUE, Truth.FALSE}.intersection(values):
            return disjunction(values)
        long_enough = self._lasted(i, interval.high or 0)
        return conjunction([long_enough, *map(born_or_false, values)])
