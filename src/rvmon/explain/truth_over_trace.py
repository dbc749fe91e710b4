"""The truth of formulas over a whole recording, in spans of ticks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import assert_never

from rvmon.explain.spans import FOREVER, Spans, both, holds, outside, since, union, until
from rvmon.explain.state_truths import Truth, state_truths
from rvmon.formula.core import Constant as CoreConstant
from rvmon.formula.core import Literal, Sense
from rvmon.formula.factory import Factory
from rvmon.formula.lower import lower
from rvmon.formula.state import State
from rvmon.monitor.attempts.instance import Instance
from rvmon.spec.checked.formula import (
    Binary,
    Bound,
    BoundAtom,
    Formula,
    Interval,
    Unary,
    UnaryOp,
)
from rvmon.spec.checked.reading import read
from rvmon.spec.checked.specification import CheckedSpec, Mode, Requirement, TimeModel
from rvmon.spec.checked.tense import has_future
from rvmon.trace.sample import Sample, Scalar
from rvmon.verdict.attempt import Attempt


def subformulas(formula: Formula, depth: int) -> Iterator[tuple[int, Formula]]:
    """The formula, then what it is made of; a negation of an atom is not taken apart."""
    yield depth, formula
    match formula:
        case Unary(operand=Unary() | Binary() as operand):
            yield from subformulas(operand, depth + 1)
        case Unary(op=op, operand=operand) if op is not UnaryOp.NOT:
            yield from subformulas(operand, depth + 1)
        case Binary(left=left, right=right):
            yield from subformulas(left, depth + 1)
            yield from subformulas(right, depth + 1)
        case _:
            pass


class Eye:
    """Sees the truth of formulas over a recording.

    Positions are ticks in held time; else a truth lasts from its position to the next, and only
    the position itself counts as one at which something came true.
    """

    def __init__(
        self,
        spec: CheckedSpec,
        requirement: Requirement,
        samples: Sequence[Sample],
        end: int,
        attempt: Attempt,
        names: frozenset[str] | None,
    ) -> None:
        self.end = end
        self.begin = samples[0].t
        self.captured = attempt.captured
        self.factory = Factory()
        self.period = spec.period
        self.requirement = requirement
        self.states: dict[int, State | bool] = {}
        formulas = [requirement.trigger, requirement.consequent]
        for whole in formulas:
            for _, formula in subformulas(whole, 0):
                self._note(formula)
        roots = [state for state in self.states.values() if isinstance(state, State)]
        self.log = state_truths(
            spec,
            roots,
            samples,
            end,
            instance_of(requirement, attempt.captured, self.begin),
            attempt.captured,
            names,
        )
        self.positions = positions_of(spec, samples, end)
        self.made: dict[int, Truth] = {}

    def _note(self, formula: Formula) -> None:
        """Bring what speaks of present and past only into the form that the flow reads."""
        if has_future(formula) or formula == BoundAtom(Bound.END):
            return
        plain = replace(self.requirement, mode=Mode.UPON, consequent=formula)
        plain = replace(plain, trigger=BoundAtom(Bound.START))
        owed = lower(plain, self.factory, self.period).owed
        match owed:
            case Literal(proposition=proposition, sense=Sense.TRUE):
                self.states[id(formula)] = proposition
            case Literal(proposition=proposition):
                self.states[id(formula)] = self.factory.negation(proposition)
            case CoreConstant(value=value):
                self.states[id(formula)] = value
            case _:
                raise AssertionError("a state formula is a literal or a constant")

    def truth(self, formula: Formula) -> Truth:
        """Where a formula is true."""
        known = self.made.get(id(formula))
        if known is None:
            # Behind the end nothing is known, not even of `true`.
            found = self._truth(formula)
            sure = both(found.sure, ((self.begin, self.end),))
            known = Truth(sure, union([*found.may, (self.end + 1, FOREVER)]))
            self.made[id(formula)] = known
        return known

    def _truth(self, formula: Formula) -> Truth:
        state = self.states.get(id(formula))
        if isinstance(state, bool):
            return self.constant(state)
        if state is not None:
            return self.log[state]
        match formula:
            case Unary() | Binary():
                return read(formula, self.truth, self)
            case _:
                return Truth((), ((self.begin, FOREVER),))

    # The operators that all others are made of.

    def constant(self, value: bool) -> Truth:
        """A constant."""
        whole: Spans = ((self.begin, FOREVER),) if value else ()
        return Truth(whole, whole)

    def no(self, truth: Truth) -> Truth:
        """A negation."""
        return Truth(
            outside(truth.may, self.begin, FOREVER), outside(truth.sure, self.begin, FOREVER)
        )

    def both(self, left: Truth, right: Truth) -> Truth:
        """A conjunction."""
        return Truth(both(left.sure, right.sure), both(left.may, right.may))

    def either(self, left: Truth, right: Truth) -> Truth:
        """A disjunction."""
        return Truth(union([*left.sure, *right.sure]), union([*left.may, *right.may]))

    def until(self, left: Truth, right: Truth, window: Interval) -> Truth:
        """Some position of the window."""
        sure = self._until_of(left.sure, right.sure, window.low, window.high)
        may = self._until_of(left.may, right.may, window.low, window.high)
        # A window that ends with the recording is not over: it may yet be met.
        longer = None if window.high is None else window.high + 1
        unseen: Spans = ((self.end + 1, FOREVER),)
        open_ = self._until_of(left.may, both(right.may, unseen), window.low, longer)
        return Truth(sure, union([*may, *open_]))

    def _until_of(self, left: Spans, right: Spans, low: int, high: int | None) -> Spans:
        if self.positions is None:
            return until(left, right, low, high)
        return self._lasting(until(left, self._at_positions(right), low, high))

    def since(self, left: Truth, right: Truth, window: Interval) -> Truth:
        """The same, backwards."""
        return Truth(
            self._since_of(left.sure, right.sure, window),
            self._since_of(left.may, right.may, window),
        )

    def _since_of(self, left: Spans, right: Spans, window: Interval) -> Spans:
        if self.positions is None:
            return since(left, right, window.low, window.high)
        met = self._at_positions(right)
        return self._lasting(since(left, met, window.low, window.high))

    def previous(self, operand: Truth) -> Truth:
        """At the position before."""
        return Truth(self._previous_of(operand.sure), self._previous_of(operand.may))

    def _previous_of(self, spans: Spans) -> Spans:
        if self.positions is None:
            return union((low + 1, high + 1) for low, high in spans)
        edges = [*self.positions, self.end + 1]
        kept = [
            (here, after - 1)
            for before, here, after in zip(edges, edges[1:], edges[2:], strict=False)
            if holds(spans, before)
        ]
        return union([*kept, *self._behind(spans)])

    def next(self, operand: Truth) -> Truth:
        """At the position after."""
        return Truth(self._next_of(operand.sure), self._next_of(operand.may))

    def _next_of(self, spans: Spans) -> Spans:
        steps = pairwise([*(self.positions or ()), self.end + 1])
        kept = [(here, after - 1) for here, after in steps if holds(spans, after)]
        return union([*kept, *self._behind(spans)])

    def _at_positions(self, spans: Spans) -> Spans:
        """Of a set only the positions; behind the last one all ticks may be one."""
        positions = self.positions or ()
        return union([*((p, p) for p in positions if holds(spans, p)), *self._behind(spans)])

    def _lasting(self, spans: Spans) -> Spans:
        """The truth at each position, until the next."""
        steps = pairwise([*(self.positions or ()), self.end + 1])
        kept = [(here, after - 1) for here, after in steps if holds(spans, here)]
        return union([*kept, *self._behind(spans)])

    def _behind(self, spans: Spans) -> Spans:
        """What of a set lies behind the end of the recording."""
        return both(spans, ((self.end + 1, FOREVER),))


def instance_of(
    requirement: Requirement, captured: Mapping[str, Scalar], begin: int
) -> Instance | None:
    """The instance of a `for each` that an attempt belongs to, by what it captured."""
    each = requirement.for_each
    return None if each is None else Instance(1, each.value, captured[each.name], begin)


def positions_of(spec: CheckedSpec, samples: Sequence[Sample], end: int) -> Sequence[int] | None:
    """The positions; `None` where every tick is one."""
    match spec.time:
        case TimeModel.HELD:
            return None
        case TimeModel.SAMPLED:
            return [sample.t for sample in samples]
        case TimeModel.CLOCKED:
            period = spec.period or 1
            return range(-(-samples[0].t // period) * period, end + 1, period)
        case _:
            assert_never(spec.time)
