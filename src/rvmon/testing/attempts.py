"""Where attempts start, what each owes, and when a whenever episode ends."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from rvmon.errors import RvmonError
from rvmon.spec.checked import (
    Bound,
    BoundAtom,
    FieldValue,
    Mode,
    Requirement,
)
from rvmon.testing.kleene import Truth, conjunction, disjunction, negation
from rvmon.testing.numbers import known_scalar, number
from rvmon.testing.pulse import is_pulse
from rvmon.testing.truths import Truths
from rvmon.testing.word import EventState, Letter, Word
from rvmon.trace.sample import Payload, Scalar


@dataclass(frozen=True, slots=True)
class Start:
    """One attempt at its trigger.

    Attributes:
        word: the trace as this instance of the requirement sees it.
        position: of the trigger.
        captured: values of `let` and `for each`.
        stop: the position at which the episode of a `whenever` ends; `None` if none is known.
    """

    word: Word
    position: int
    captured: Mapping[str, Scalar]
    stop: int | None = None


def starts(requirement: Requirement, word: Word) -> list[Start]:
    """All attempts of a requirement on a word, in order of trigger.

    Raises:
        RvmonError: the requirement's `pulse` is not what its trigger's syntax says.

    Source: SEMANTICS, section 3; decision record 1 (Triggers, `whenever`, `for each`).
    """
    if is_pulse(requirement.trigger) != requirement.pulse:
        raise RvmonError(f"requirement {requirement.id}: its trigger's class is not its syntax's")
    found = [
        replace(start, captured={**instance.captured, **_captures(requirement, instance, start)})
        for instance in _instances(requirement, word)
        for start in _starts(requirement, instance)
    ]
    return sorted(found, key=lambda start: start.position)


def obligation(requirement: Requirement, start: Start, truths: Truths) -> Truth:
    """The truth of what an attempt owes, after the prefix that `truths` speaks of.

    Source: SEMANTICS, section 3; decision record 1 (`whenever`).
    """
    if requirement.mode is Mode.UPON or is_upon_end(requirement):
        return truths.truth(requirement.consequent, start.position)
    ended = start.stop is not None and start.stop < truths.known
    last = start.stop if ended and start.stop is not None else truths.known
    owed = [_implication(requirement, truths, k) for k in range(start.position, last)]
    return conjunction([*owed, Truth.TRUE if ended else truths.release_rest(opened=True)])


def _implication(requirement: Requirement, truths: Truths, k: int) -> Truth:
    trigger = truths.truth(requirement.trigger, k, positive=False)
    return disjunction([negation(trigger), truths.truth(requirement.consequent, k)])


@dataclass(frozen=True, slots=True)
class _Instance:
    """A requirement for one value of its `for each`; `first` is where that occurred first."""

    word: Word
    captured: Mapping[str, Scalar]
    first: int = 0


def _instances(requirement: Requirement, word: Word) -> Iterator[_Instance]:
    each = requirement.for_each
    if each is None:
        yield _Instance(word, {})
        return
    first_at: dict[Scalar, int] = {}
    for position, letter in enumerate(word.letters):
        for occurrence in letter.events[each.value.event].occurrences:
            value = _field(occurrence.payload, each.value)
            if value is not None:
                first_at.setdefault(value, position)
    for value, first in first_at.items():
        letters = tuple(_only(letter, each.value, value) for letter in word.letters)
        yield _Instance(replace(word, letters=letters), {each.name: value}, first)


def _field(payload: Payload, field: FieldValue) -> Scalar:
    return known_scalar(payload.get(field.field))


def _only(letter: Letter, field: FieldValue, value: Scalar) -> Letter:
    """The letter with those occurrences of the event only whose field has the value.

    Where the field is not known, it is not known whether the event occurs for the value, nor what
    it says then.
    """
    kept = tuple(
        replace(occurrence, truth=Truth.UNKNOWN, payload={}) if found is None else occurrence
        for occurrence in letter.events[field.event].occurrences
        if (found := _field(occurrence.payload, field)) is None or found == value
    )
    state = EventState(updated=bool(kept), occurrences=kept)
    return replace(letter, events={**letter.events, field.event: state})


def _starts(requirement: Requirement, instance: _Instance) -> Iterator[Start]:
    word = instance.word
    if is_upon_end(requirement):
        if word.letters:
            yield Start(word, len(word.letters) - 1, {})
        return
    truths = Truths(word, instance.captured)
    trigger = [truths.truth(requirement.trigger, k) for k in range(truths.known)]
    running_to = 0
    for k, value in enumerate(trigger):
        edge = requirement.pulse or _rises(trigger, k)
        if value is not Truth.TRUE or not edge or k < max(instance.first, running_to):
            continue
        stop = None
        if requirement.mode is Mode.WHENEVER:
            later = (j for j in range(k, len(trigger)) if trigger[j] is Truth.FALSE)
            stop = next(later, None)
            running_to = len(trigger) if stop is None else stop
        yield Start(word, k, {}, stop)


def _rises(trigger: list[Truth], k: int) -> bool:
    """Whether the trigger was false at the position before, or never known so far."""
    if k and trigger[k - 1] is Truth.FALSE:
        return True
    return all(value is Truth.UNKNOWN for value in trigger[:k])


def _captures(requirement: Requirement, instance: _Instance, start: Start) -> dict[str, Scalar]:
    letter = instance.word.letters[start.position]
    payloads = {
        event: state.occurrences[-1].payload
        for event, state in letter.events.items()
        if state.occurrences
    }
    captured: dict[str, Scalar] = dict(instance.captured)
    for capture in requirement.captures:
        captured[capture.name] = number(capture.value, letter, payloads, captured)
    return captured


def is_upon_end(requirement: Requirement) -> bool:
    """Whether the requirement is judged when the trace is finished."""
    trigger = requirement.trigger
    return isinstance(trigger, BoundAtom) and trigger.bound is Bound.END
