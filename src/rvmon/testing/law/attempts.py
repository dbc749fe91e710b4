"""The starts of attempts, the formula that each requires, and the ends of `whenever` episodes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import assert_never

from rvmon.language.checked import formula as rv
from rvmon.language.checked.specification import Mode, Requirement
from rvmon.testing.law import word as law
from rvmon.testing.law.numbers import events_of, is_born, known_scalar, number
from rvmon.testing.law.syntax import by_and_or, is_upon_end, subformulas
from rvmon.testing.law.truths import Truths
from rvmon.trace.sample import Payload, Scalar


def is_pulse(formula: rv.Formula, *, negated: bool = False) -> bool:
    """Whether the negation normal form of a trigger (or of its negation) is a pulse.

    Source: SEMANTICS, section 3 (Requirements, `upon`).

    >>> sensed, ready = rv.EventAtom("sensed"), rv.SignalAtom("ready")
    >>> is_pulse(rv.Binary(rv.BinaryOp.AND, sensed, ready))
    True
    >>> is_pulse(rv.Unary(rv.UnaryOp.NOT, sensed))
    False
    """
    match formula:
        case rv.Constant(value=value):
            return value is negated
        case rv.EventAtom():
            return not negated
        case rv.Compare(left=left, right=right):
            return not negated and bool(events_of(left, right))
        case rv.ProbeAtom(probe=probe):
            return not negated and probe is not rv.Probe.KNOWN
        case rv.SignalAtom() | rv.BoundAtom() | rv.Amount() | rv.Passed():
            return False
        case rv.Unary(op=rv.UnaryOp.NOT, operand=operand):
            return is_pulse(operand, negated=not negated)
        case rv.Unary(op=op):
            return not negated and op in (rv.UnaryOp.RISE, rv.UnaryOp.FALL)
        case rv.Binary(op=rv.BinaryOp.AND | rv.BinaryOp.OR as op):
            # Of a conjunction, one operand suffices; of a disjunction, all have to be pulses.
            enough = any if (op is rv.BinaryOp.AND) is not negated else all
            return enough(is_pulse(part, negated=negated) for part in (formula.left, formula.right))
        case rv.Binary():
            spelled = by_and_or(formula)
            return spelled is not formula and is_pulse(spelled, negated=negated)
        case _:
            assert_never(formula)


@dataclass(frozen=True, slots=True, eq=False)
class Start:
    """The start of an attempt."""

    view: View  # the requirement, or the instance of it, on the trace
    position: int  # the position of the trigger; for an attempt in doubt, the first possible one
    # the positions at which the consequent is required; of a `whenever`, those of its episode
    positions: Sequence[int]
    captured: Mapping[str, Scalar]  # values of `let` and `for each`
    blurred: int | None  # the position from which on its `let` values are unknown
    stop: int | None = None  # the first position after its episode; `None` if it is not over
    # the first of its positions at which the trigger is TRUE; `None` if it is in doubt
    sure: int | None = None

    @property
    def word(self) -> law.Word:
        """The trace with the occurrences of this instance."""
        return self.view.word

    @property
    def triggered(self) -> int:
        """The instant of the trigger, ticks."""
        return self.word.letters[self.position].instant

    @property
    def may_be_over(self) -> bool:
        """Whether it is an episode that lasts to the end of the trace but may have ended before."""
        if self.view.requirement.mode is Mode.UPON or self.stop is not None:
            return False
        return any(self.view.trigger[k] is law.Truth.UNKNOWN for k in self.positions)

    def restarted(self, position: int) -> Start:
        """The rest of the episode as a new attempt."""
        rest = [k for k in self.positions if k >= position]
        known = (k for k in rest if self.blurred is None or k < self.blurred)
        return replace(self, position=position, positions=rest, sure=self.view.first_true(known))


class View:
    """A requirement, or an instance of it, on a word, with the truth of its formulas there.

    Args:
        requirement: the checked requirement.
        word: the trace, with the occurrences of this instance.
        captured: the value of its `for each`, by name.
        first: the first position at which an attempt can start.
        doubted: whether the instance may not exist.
    """

    def __init__(
        self,
        requirement: Requirement,
        word: law.Word,
        captured: Mapping[str, Scalar] | None = None,
        first: int = 0,
        *,
        doubted: bool = False,
    ) -> None:
        self.requirement = requirement
        self.word = word
        self.captured = captured or {}
        self.first = first
        self.doubted = doubted
        self._readings: dict[law.Rest, Readings] = {}

    def readings(self, rest: law.Rest = law.Rest.UNKNOWN) -> Readings:
        """The truth of formulas under an assumption about pending operators."""
        return self._readings.setdefault(rest, Readings(self.word, rest))

    @cached_property
    def trigger(self) -> Sequence[law.Truth]:
        """The truth of the trigger at each position; UNBORN counts as FALSE."""
        if is_upon_end(self.requirement):
            return [law.Truth.FALSE for _ in self.word.letters]
        return [law.Truth.FALSE if truth is law.Truth.UNBORN else truth for truth in self._trigger]

    @property
    def is_determined(self) -> bool:
        """Whether the trigger was ever TRUE or FALSE."""
        if is_upon_end(self.requirement):
            return bool(self.word.letters)
        return any(truth in (law.Truth.TRUE, law.Truth.FALSE) for truth in self._trigger)

    @cached_property
    def _trigger(self) -> Sequence[law.Truth]:
        truths = Truths(self.word, self.captured)
        return [truths.state(self.requirement.trigger, k) for k in range(len(self.word.letters))]

    def edge(self, k: int) -> law.Truth:
        """Whether an attempt `upon` the trigger starts at a position."""
        now = self.trigger[k]
        if self.requirement.pulse:
            return now
        return law.conjunction([now, law.negation(self.trigger[k - 1]) if k else law.Truth.TRUE])

    def stretch(self, k: int) -> tuple[Sequence[int], int | None]:
        """The positions from `k` on at which the trigger is not FALSE, and the first after them."""
        later = (j for j in range(k, len(self.trigger)) if self.trigger[j] is law.Truth.FALSE)
        stop = next(later, None)
        return range(k, len(self.trigger) if stop is None else stop), stop

    def start_at(self, position: int, positions: Sequence[int], stop: int | None) -> Start:
        """An attempt that captures its values at `position`."""
        captured = self._captures(position)
        lets = [capture.name for capture in self.requirement.captures]
        hidden = (k for k in positions if self.doubted or self.edge(k) is law.Truth.UNKNOWN)
        other = (k for k in hidden if not _same(captured, self._captures(k), lets))
        blurred = next(other, None) if lets else None
        known = (k for k in positions if blurred is None or k < max(blurred, position + 1))
        return Start(self, position, positions, captured, blurred, stop, self.first_true(known))

    def first_true(self, positions: Iterable[int]) -> int | None:
        """The first of some positions at which the trigger is certainly TRUE, or `None`."""
        if self.doubted:
            return None
        return next((k for k in positions if self.trigger[k] is law.Truth.TRUE), None)

    def _captures(self, position: int) -> dict[str, Scalar]:
        letter = self.word.letters[position]
        payloads = {
            event: state.occurrences[-1].payload
            for event, state in letter.events.items()
            if state.occurrences
        }
        captured: dict[str, Scalar] = dict(self.captured)
        for capture in self.requirement.captures:
            value = capture.value
            if rv.windows_in(value):
                value = Truths(self.word, captured).settled(value, position)
            captured[capture.name] = number(value, letter, payloads, captured)
        return captured

    def is_unborn(self, position: int) -> bool:
        """Whether a signal that the consequent reads has had no value up to a position."""
        letter = self.word.letters[position]
        for part in subformulas(self.requirement.consequent):
            if isinstance(part, rv.SignalAtom) and not letter.signals[part.name].born:
                return True
            if isinstance(part, rv.Compare) and not is_born(part, letter):
                return True
        return False


def _same(one: Mapping[str, Scalar], other: Mapping[str, Scalar], names: Iterable[str]) -> bool:
    return all(one[name] is not None and one[name] == other[name] for name in names)


class Readings:
    """The truth of formulas on a word, cached by captured values."""

    def __init__(self, word: law.Word, rest: law.Rest) -> None:
        self._word = word
        self._rest = rest
        self._reached = word.reached
        self._truths: dict[tuple[object, ...], Truths] = {}

    def reach(self, reached: int) -> None:
        """Evaluate on the prefix known at the instant `reached`; instants must not decrease."""
        self._reached = reached
        for truths in self._truths.values():
            truths.reach(reached)

    def of(self, captured: Mapping[str, Scalar], *, favour: bool = False) -> Truths:
        """The truth of formulas under captured values; `favour` as in `Truths`."""
        key = (favour, *((name, type(value), value) for name, value in captured.items()))
        found = self._truths.get(key)
        if found is None:
            found = self._truths[key] = Truths(self._word, captured, self._rest, favour=favour)
            found.reach(self._reached)
        return found


def obligation(start: Start, readings: Readings) -> law.Truth:
    """The truth of an attempt's obligation after the prefix that the readings have reached.

    Source: SEMANTICS, sections 1 (Birth) and 3 (Doubt, `whenever`); decision record 4.
    """
    requirement, view = start.view.requirement, start.view
    if is_upon_end(requirement):
        value = readings.of(start.captured).truth(requirement.consequent, start.position)
        return law.Truth.UNKNOWN if value is law.Truth.FALSE and start.sure is None else value
    truths = readings.of(start.captured)
    ended = start.stop is not None and start.stop < truths.known
    required = [_required(start, readings, k) for k in start.positions if k < truths.known]
    if requirement.mode is Mode.UPON and start.sure is not None:
        return required[0]
    blurred = start.blurred is not None and start.blurred < truths.known
    rest = law.Truth.UNKNOWN if blurred else truths.release_rest(opened=True)
    value = law.conjunction([*required, law.Truth.TRUE if ended else rest])
    if value is law.Truth.FALSE and start.sure is None:
        return law.Truth.UNKNOWN
    if value is law.Truth.TRUE and counts_in_favour(requirement):
        last = start.stop if ended and start.stop is not None else truths.known - 1
        return law.Truth.UNKNOWN if view.is_unborn(last) else value
    return value


def _required(start: Start, readings: Readings, k: int) -> law.Truth:
    requirement = start.view.requirement
    if start.blurred is not None and k >= start.blurred:
        return law.Truth.UNKNOWN
    truths = readings.of(start.captured, favour=counts_in_favour(requirement))
    consequent = truths.truth(requirement.consequent, k)
    if requirement.mode is Mode.UPON:
        return consequent
    return law.disjunction([law.negation(start.view.trigger[k]), consequent])


def counts_in_favour(requirement: Requirement) -> bool:
    """Whether unborn propositions count as met: in the episodes of a level `whenever`."""
    return requirement.mode is Mode.WHENEVER and not requirement.pulse


def starts_upon(view: View) -> list[Start]:
    """The attempts of a requirement `upon` a trigger, including those in doubt."""
    if is_upon_end(view.requirement):
        last = len(view.word.letters) - 1
        if last < view.first:
            return []
        sure = None if view.doubted else last
        return [replace(view.start_at(last, [last], None), sure=sure)]
    found = []
    edges = [view.edge(k) for k in range(len(view.trigger))]
    k = view.first
    while k < len(edges):
        stretch, stop = view.stretch(k)
        certain = [] if view.doubted else [j for j in stretch if edges[j] is law.Truth.TRUE]
        found += [view.start_at(j, [j], j + 1) for j in certain]
        hidden = [j for j in stretch if edges[j] is not law.Truth.FALSE and j not in certain]
        if hidden:
            one = view.start_at(hidden[0], hidden, stop)
            found.append(replace(one, sure=None))
        k = (stretch[-1] if stretch else k) + 1
    return found


def views(requirement: Requirement, word: law.Word) -> list[View]:
    """The instances of a requirement on a word: one per value of `for each`, otherwise one.

    The first instance of a `for each` is for occurrences with an unknown value; it may not exist.

    Source: SEMANTICS, section 3 (Doubt); decision record 1 (`for each`).
    """
    each = requirement.for_each
    if each is None:
        return [View(requirement, word)]
    first_at: dict[Scalar, int] = {}
    for position, letter in enumerate(word.letters):
        for occurrence in letter.events[each.value.event].occurrences:
            first_at.setdefault(_field(occurrence.payload, each.value), position)
    return [
        View(
            requirement,
            replace(
                word, letters=tuple(_only(letter, each.value, value) for letter in word.letters)
            ),
            {each.name: value},
            first_at.get(value, len(word.letters)),
            doubted=value is None,
        )
        for value in (None, *(value for value in first_at if value is not None))
    ]


def _field(payload: Payload, field: rv.FieldValue) -> Scalar:
    return known_scalar(payload.get(field.field))


def _only(letter: law.Letter, field: rv.FieldValue, value: Scalar) -> law.Letter:
    """The letter with only those occurrences of the event whose field has the value.

    If the field is unknown, so is the occurrence for this value, and its payload.
    """
    whole = letter.events[field.event]
    kept = tuple(
        replace(occurrence, truth=law.Truth.UNKNOWN, payload={}) if found is None else occurrence
        for occurrence in whole.occurrences
        if (found := _field(occurrence.payload, field)) is None or found == value
    )
    # Apart from lost occurrences, occurrences for other values do not update this instance.
    updated = (
        whole.updated if len(kept) > whole.lost else law.Truth.UNKNOWN if kept else law.Truth.FALSE
    )
    only = {field.event: law.EventState(updated, kept, whole.lost)}
    return replace(letter, events={**letter.events, **only})
