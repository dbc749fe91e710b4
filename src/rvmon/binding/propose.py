"""A binding that is proposed by names and types."""

from __future__ import annotations

import json
import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass

from rvmon.readers.messages.topic import Topic
from rvmon.spec.checked.specification import CheckedSpec, Type
from rvmon.trace.schema import Kind
from rvmon.units.table import base_unit, parse_unit

_LIKENESS = 0.45
"""Of the words of a name, at least this share has to be found in a topic and field."""

_KIN = {
    "speed": {"velocity", "vel", "twist"},
    "velocity": {"speed", "vel", "twist"},
    "distance": {"range", "dist"},
    "obstacle": {"range", "distance", "scan"},
    "heading": {"yaw", "orientation"},
    "yaw": {"heading", "orientation"},
    "position": {"pose", "point"},
    "state": {"status", "mode"},
    "mode": {"state", "status"},
    "stop": {"estop", "halt"},
}
"""Words that people use for the same."""

_EMPTY = frozenset({"data", "value"})
"""Words that say nothing of what a field is."""

_FITTING = {
    Kind.BOOL: {Kind.BOOL},
    Kind.INT: {Kind.INT},
    Kind.REAL: {Kind.REAL, Kind.INT},
    Kind.LABEL: {Kind.LABEL, Kind.INT},
}

_IGNORED = re.compile(r"^header\.|covariance")
"""Fields that are proposed for nothing."""

_MOST_OTHERS = 3


@dataclass(frozen=True, slots=True)
class Candidate:
    """What may feed a name.

    Attributes:
        topic: of the messages.
        value: an expression; empty: each message is an occurrence.
        kind: of the value; `None` of each message.
        score: how well it fits, 0 to 1.
    """

    topic: str
    value: str
    kind: Kind | None
    score: float


@dataclass(frozen=True, slots=True)
class Proposal:
    """What is proposed for a specification and a recording.

    Attributes:
        text: of the binding, TOML.
        unmatched: the names for which nothing was found.
    """

    text: str
    unmatched: tuple[str, ...]


def propose(spec: CheckedSpec, topics: Mapping[str, Topic]) -> Proposal:
    """Find for each declared name the topic and field whose words and type are most like it."""
    lines = ['clock = "log"  # or "header": the stamps of the headers count']
    missed: list[str] = []
    for name, signal in spec.signals.items():
        found = _ranked(name, _of_signal(signal.type, topics))
        if found:
            lines += ["", *_signal_lines(name, signal.type, found, topics)]
        else:
            missed.append(name)
    for name, event in spec.events.items():
        found = _ranked(name, _of_event(topics))
        if found:
            lines += ["", *_event_lines(name, event.fields, found, topics)]
        else:
            missed.append(name)
    for name in missed:
        what = f"signal, {_written(spec.signals[name].type)}" if name in spec.signals else "event"
        lines += ["", f"# Nothing was found for `{name}` ({what}):", f"# [bind.{_key(name)}]"]
        lines += ['# topic = "…"', '# value = "…"']
    return Proposal("\n".join(lines) + "\n", tuple(missed))


def _of_signal(type_: Type, topics: Mapping[str, Topic]) -> Iterator[Candidate]:
    for topic in topics.values():
        for leaf, kind in topic.leaves.items():
            if kind in _FITTING[type_.kind] and not _IGNORED.search(leaf):
                yield Candidate(topic.name, leaf.replace("[]", "[0]"), kind, 0.0)
            if type_.kind is Kind.REAL and leaf.endswith("orientation.w"):
                yield Candidate(topic.name, f"yaw({leaf[:-2]})", kind, 0.0)
            if type_.kind is Kind.REAL and leaf.endswith("linear.x"):
                yield Candidate(topic.name, f"hypot({leaf}, {leaf[:-1]}y)", kind, 0.0)


def _of_event(topics: Mapping[str, Topic]) -> Iterator[Candidate]:
    for topic in topics.values():
        flags = [leaf for leaf, kind in topic.leaves.items() if kind is Kind.BOOL]
        if len(flags) == 1 and "[" not in flags[0]:
            yield Candidate(topic.name, flags[0], Kind.BOOL, 0.0)
        elif not topic.fault:
            yield Candidate(topic.name, "", None, 0.0)


def _ranked(name: str, candidates: Iterator[Candidate]) -> list[Candidate]:
    """Those that are like the name, the best first."""
    scored = [Candidate(one.topic, one.value, one.kind, _likeness(name, one)) for one in candidates]
    return sorted(
        (one for one in scored if one.score >= _LIKENESS),
        key=lambda one: (-one.score, len(_words(one.value)), one.topic, one.value),
    )


def _likeness(name: str, candidate: Candidate) -> float:
    """How many of the words of a name stand in topic and field; a little less for many others."""
    wanted = _words(name)
    there = [*_words(candidate.topic), *_words(candidate.value)]
    share = sum(_found(word, there) for word in wanted) / max(1, len(wanted))
    others = sum(not _found(word, wanted) for word in dict.fromkeys(there) if word not in _EMPTY)
    # The last step of a path says most of what it is.
    last = _words(candidate.value)[-1:] if "(" not in candidate.value else ["yaw", "speed"]
    bonus = 0.1 * any(_found(word, wanted) for word in last)
    return share and share + bonus - 0.02 * others


def _found(word: str, there: Collection[str]) -> float:
    if word in there:
        return 1.0
    if not _KIN.get(word, set()).isdisjoint(there):
        return 0.9
    long = [one for one in there if min(len(one), len(word)) > 3]
    return 0.7 * any(one.startswith(word) or word.startswith(one) for one in long)


def _words(name: str) -> list[str]:
    """The words of a name, in lower case.

    >>> _words("/base/handDistance.twist_x")
    ['base', 'hand', 'distance', 'twist', 'x']
    """
    return [word.casefold() for word in re.findall(r"[A-Z]?[^\W\d_A-Z]+|[A-Z]+", name)]


def _signal_lines(
    name: str, type_: Type, found: list[Candidate], topics: Mapping[str, Topic]
) -> Iterator[str]:
    best = found[0]
    yield f"[bind.{_key(name)}]  # {_written(type_)}"
    yield f"topic = {_text(best.topic)}  # {topics[best.topic].type}"
    yield f"value = {_text(best.value)}"
    if type_.unit and (unit := _base(type_.unit)):
        yield f"unit = {_text(unit)}  # a guess, as ROS has it: write the unit of the field"
    if type_.kind is Kind.LABEL and best.kind is Kind.INT:
        listed = ", ".join(f"{number} = {_text(one)}" for number, one in enumerate(type_.labels))
        yield f"labels = {{ {listed} }}  # a guess: which number stands for which?"
    yield from _others(found)


def _event_lines(
    name: str, fields: Mapping[str, Type], found: list[Candidate], topics: Mapping[str, Topic]
) -> Iterator[str]:
    best = found[0]
    topic = topics[best.topic]
    yield f"[bind.{_key(name)}]  # event"
    yield f"topic = {_text(best.topic)}  # {topic.type}"
    if best.value:
        yield f"value = {_text(best.value)}  # occurs with each message of which this is true"
        yield 'on = "change"  # only with the first of several'
    payload = {}
    for field, type_ in fields.items():
        own = [
            Candidate(topic.name, leaf, kind, 0.0)
            for leaf, kind in topic.leaves.items()
            if kind in _FITTING[type_.kind] and "[" not in leaf
        ]
        ranked = _ranked(field, iter(own))
        if ranked:
            payload[field] = ranked[0].value
        else:
            yield f"# Nothing was found for its field `{field}`."
    if payload:
        listed = ", ".join(f"{_key(field)} = {_text(value)}" for field, value in payload.items())
        yield f"fields = {{ {listed} }}"
    yield from _others(found)


def _base(unit: str) -> str:
    """The unit without factor of the same kind, in which messages of ROS are by convention.

    Source: ROS Enhancement Proposal 103, Standard Units of Measure.
    """
    return base_unit(dict(parse_unit(unit).dimension)).symbol


def _others(found: list[Candidate]) -> Iterator[str]:
    for one in found[1 : 1 + _MOST_OTHERS]:
        value = f", value = {_text(one.value)}" if one.value else ""
        yield f"# or topic = {_text(one.topic)}{value}"


def _written(type_: Type) -> str:
    if type_.kind is Kind.LABEL:
        return f"{{{', '.join(type_.labels)}}}"
    return f"{type_.kind} [{type_.unit}]" if type_.unit else str(type_.kind)


def _key(name: str) -> str:
    parts = name.split(".")
    return ".".join(one if re.fullmatch(r"[A-Za-z0-9_-]+", one) else _text(one) for one in parts)


def _text(text: str) -> str:
    """A text as TOML writes it, which escapes as JSON does."""
    return json.dumps(text, ensure_ascii=False)
