"""Ranking of the fields of a recording as sources of a name, by kind, unit and words."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from msgspec import Struct

from rvmon.language.checked.specification import Type
from rvmon.recordings.binding.candidates import ALONG, Candidate, foreign_words, modifiers_of
from rvmon.recordings.binding.vocabulary import (
    AXES,
    EMPTY,
    MODIFIERS,
    OF_SURROUNDINGS,
    ORDINALS,
    SUBJECTS,
    WEAK,
    dimensions_of,
    is_found,
    is_measured_in,
    parts_of,
    words_of,
)
from rvmon.recordings.messages import Topic
from rvmon.recordings.messages.field_meanings import Sort
from rvmon.trace.schema import Kind
from rvmon.units import parse_unit

_FITTING = {
    Kind.BOOL: {Kind.BOOL},
    Kind.INT: {Kind.INT},
    Kind.REAL: {Kind.REAL, Kind.INT},
    Kind.LABEL: {Kind.LABEL, Kind.INT},
}

_REQUESTS = frozenset(
    {"request", "requested", "event", "pressed", "command", "hit", "touched", "triggered"}
)
"""Words in the names of events that add no meaning."""

_EXTREMES = ("minimum", "maximum")
"""Limits; in comments they describe the range of a value, not the value itself."""

_A_WORD = 0.05  # scores differ by less than this if the same words were found

_MOVING = "nav_msgs/msg/Odometry"  # preferred to other types


class Wanted(Struct, frozen=True):
    """A declared name for which a source is sought."""

    words: tuple[str, ...]  # the words of the name
    type: Type | None  # its declared type; `None` for an event
    guess: str = ""  # a note on how a word was interpreted, or ""
    name: str = ""

    @property
    def axis(self) -> str:
        """The axis in the name; "" if it has none."""
        return next((word for word in self.words if word in AXES), "")


def wanted_of(name: str, type_: Type | None, topics: Iterable[Topic]) -> Wanted:
    """Split a name into wanted words; if topics are numbered, `leader` is 1 and `follower` 2."""
    listed = [*topics]
    there = {word for topic in listed for word in words_of(topic.name)}
    fields = {word for topic in listed for leaf in topic.leaves for word in words_of(leaf)}
    words = [part for word in words_of(name) for part in parts_of(word, there | fields)]
    guess = ""
    for place, word in enumerate(words):
        if word in ORDINALS and word not in there and {"1", "2"} <= there:
            words[place] = ORDINALS[word]
            guess = f"`{word}` is taken for number {ORDINALS[word]}"
    if type_ is not None and type_.unit and "A" not in type_.unit:
        # Unless a unit of electric current is declared, `current` means "present".
        words = [word for word in words if word != "current" or len(words) == 1]
    return Wanted(tuple(words), type_, guess, name)


def fitting(wanted: Wanted, candidates: Iterable[Candidate]) -> list[tuple[float, Candidate]]:
    """The candidates that fit a name, with their scores, the best first."""
    type_ = wanted.type
    fit = [
        candidate
        for candidate in candidates
        if (_fits_event(wanted, candidate) if type_ is None else _fits(wanted, type_, candidate))
    ]
    scored = [(score, candidate) for candidate in fit if (score := _score(wanted, candidate))]
    if type_ is not None and type_.unit and any(candidate.states_unit for candidate in fit):
        scored = [
            (score - 0.2 * (not candidate.states_unit), candidate) for score, candidate in scored
        ]
    return sorted(
        scored,
        key=lambda found: (-found[0], found[1].topic.name, len(found[1].value), found[1].value),
    )


def of_same_dimension(wanted: Wanted, candidates: Iterable[Candidate]) -> list[Candidate]:
    """Candidates with the dimension of the declared unit, those with most shared words first."""
    type_ = wanted.type
    if type_ is None or not type_.unit:
        return []
    dimension = parse_unit(type_.unit).dimension
    found = [
        candidate
        for candidate in candidates
        if candidate.meaning.sort is Sort.MEASURED
        and dimension in candidate.dimensions
        and candidate.is_command == ("command" in wanted.words)
        and modifiers_of(candidate) <= {*wanted.words}
    ]
    return sorted(
        found, key=lambda candidate: -len({*wanted.words} & {*candidate.own, *candidate.around})
    )


def is_clear(wanted: Wanted, found: Sequence[tuple[float, Candidate]]) -> bool:
    """Whether the best candidate is clearly better than all others.

    It must be better by a whole word than the same field of another topic. A code must be better by
    a whole word than all others, except those of its own topic if it has exactly the wanted name.
    """
    if not found:
        return False
    best, first = found[0]
    is_exact = words_of(first.value) == [*wanted.words]
    return all(
        score < best - (_A_WORD if _is_alike(first, candidate, is_exact=is_exact) else 1e-9)
        for score, candidate in found[1:]
    )


def _is_alike(first: Candidate, second: Candidate, *, is_exact: bool) -> bool:
    """Whether the first must be better by a whole word: the same field twice, or a code."""
    if first.topic.name == second.topic.name:
        return first.is_code and not is_exact
    return first.is_code or (first.value, first.topic.type) == (second.value, second.topic.type)


def _fits(wanted: Wanted, type_: Type, candidate: Candidate) -> bool:
    """Whether kind, unit, role (command or not), modifiers and axis agree with the name."""
    if candidate.kind not in _FITTING[type_.kind] or candidate.topic.fault:
        return False
    is_odd = candidate.meaning.sort is Sort.QUATERNION
    if is_odd or ("command" in wanted.words) != candidate.is_command:
        return False
    allowed = {word for word in wanted.words if word in MODIFIERS}
    if not (modifiers_of(candidate) - {"command"} <= allowed) or _is_of_another(wanted, candidate):
        return False
    if type_.kind in (Kind.BOOL, Kind.LABEL):
        if not {*AXES, "xy"} & {*candidate.own} <= {*wanted.words}:
            return False
        return candidate.meaning.sort is not Sort.MEASURED
    return _has_axis(wanted, candidate) and _is_in_unit(wanted, type_, candidate)


def _is_of_another(wanted: Wanted, candidate: Candidate) -> bool:
    """Whether a candidate is about a part or another subject that the name does not mention."""
    element = re.search(r"\[([^\[\]]*\D[^\[\]]*)\]$", candidate.value)
    if element is not None:
        return not any(is_found(word, wanted.words) for word in words_of(element[1]))
    subjects = {word for word in foreign_words(candidate) if word in SUBJECTS}
    if "temperature" in wanted.words:  # each part has its own, also the battery
        subjects |= {"battery"} & {*candidate.around}
    if not OF_SURROUNDINGS.isdisjoint(candidate.own):
        subjects -= {"ambient"}
    return not all(is_found(word, wanted.words) for word in subjects)


def _fits_event(wanted: Wanted, candidate: Candidate) -> bool:
    """Whether the last part of a topic has only words of the event; a field except `data` fits."""
    if candidate.value not in ("", "data"):
        return True
    last = words_of(candidate.topic.name.rpartition("/")[2])
    return all(word in EMPTY or is_found(word, wanted.words) for word in last)


def _has_axis(wanted: Wanted, candidate: Candidate) -> bool:
    """Whether a candidate has the axis of the name, or an axis that the words of both imply."""
    if wanted.axis or not candidate.axis:
        return wanted.axis == candidate.axis
    if candidate.value.endswith("linear.x") and "speed" in wanted.words:
        return True  # the speed of a robot is mostly that along x
    there = {*candidate.own, *candidate.implied}
    return not ALONG.isdisjoint({*wanted.words} & there)


def _is_in_unit(wanted: Wanted, type_: Type, candidate: Candidate) -> bool:
    named, there = dimensions_of(wanted.words), candidate.dimensions
    if type_.unit:
        dimension = parse_unit(type_.unit).dimension
        if (named and dimension not in named) or candidate.meaning.sort is Sort.CODE:
            return False
        is_magnetic = dimension == parse_unit("T").dimension
        if candidate.meaning.is_scaled or (is_magnetic and candidate.unit is None):
            return False  # magnetic fields are often scaled by 1000, so the unit must be stated
        return dimension in there if there else candidate.meaning.sort is Sort.OPEN
    return not (named and there) or not named.isdisjoint(there)


def _score(wanted: Wanted, candidate: Candidate) -> float:
    """How well the words of a name are found: 0 if one is missing, less for each foreign word."""
    total = 0.0
    ignorable = EMPTY | (_REQUESTS if wanted.type is None else frozenset())
    required = [word for word in wanted.words if word not in ignorable] or list(wanted.words)
    foreign = [word for word in foreign_words(candidate) if not is_found(word, required)]
    for word in required:
        weight = _weight(word, candidate)
        if not weight and word in WEAK and not foreign:
            weight = 0.3
        if not weight:
            return 0.0
        total += weight
    is_exact = words_of(candidate.value) == [*wanted.words]
    better = (
        0.005 * is_exact
        - 0.01 * (is_exact and not _is_short_for(candidate.value, wanted.name))
        + 0.05 * (candidate.topic.type == _MOVING)
        + 0.02 * candidate.value.startswith("hypot(")
    )
    if wanted.type is not None and wanted.type.kind is candidate.kind is Kind.LABEL:
        better += 0.2  # a text is the label itself, a number only stands for it
    worse = sum(0.02 if word in candidate.own else 0.01 for word in foreign)
    worse += 0.06 * _is_of_another_quantity(candidate, foreign)
    return total / len(required) + better - worse


def _is_of_another_quantity(candidate: Candidate, foreign: Iterable[str]) -> bool:
    """Whether the topic is named after a quantity of another dimension than the candidate's."""
    named = {*words_of(candidate.topic.name)} & {*foreign}
    others = [own for word in named if (own := dimensions_of([word]))]
    return any(own.isdisjoint(candidate.dimensions) for own in others if candidate.dimensions)


def _is_short_for(value: str, name: str) -> bool:
    """Whether a field is a subsequence of a name: `hdg` of `heading`, but not `yaw`."""
    letters = iter(name.casefold())
    return all(letter in letters for letter in value.casefold())


def _weight(word: str, candidate: Candidate) -> float:
    if word.isdigit():
        return float(word in candidate.own or word in candidate.around)
    if word == "command":
        return float(candidate.is_command)
    if word == "minimum" and candidate.value[:4] == "min(":
        return 1.0
    if is_found(word, candidate.own) and is_found(word, words_of(candidate.value)):
        return 1.0
    if word == candidate.value.rpartition(".")[2].replace("_", "").casefold():
        return 1.0
    is_its_unit = candidate.unit is not None and is_measured_in(word, candidate.unit)
    others = (*candidate.own, *candidate.implied, *candidate.around)
    is_commented = word not in _EXTREMES and is_found(word, candidate.comment_words)
    return 0.9 * (is_its_unit or is_commented or is_found(word, others))
