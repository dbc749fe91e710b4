"""Proposal of a binding, by the meaning of fields, their words, and the values in a recording."""

from __future__ import annotations

import json
import re
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from math import inf

from msgspec import Struct

from rvmon.language.checked.specification import CheckedSpec, Type
from rvmon.recordings.binding.candidates import (
    Candidate,
    Range,
    candidates_of,
    events_of,
    ranges_of,
)
from rvmon.recordings.binding.rank import fitting, is_clear, of_same_dimension, wanted_of
from rvmon.recordings.messages.file import MessageFile, TopicNames, names_in
from rvmon.trace.schema import Kind
from rvmon.units import base_unit, parse_unit, unit_table

_MOST = 4  # the most candidates that are shown for a name

_LARGE = {"rad": 360, "m": 9_000, "degC": 200, "V": 999, "A": 999, "m/s": 999, "": 100}
"""By plain unit, a limit: larger integers must be in a smaller unit, which is not known."""

_WHOLE = 1.5  # a ratio is below this; larger values are per cent
_TURN = 7  # an angle of at most one turn is below this in radians; larger values are degrees

Ranked = list[tuple[float, Candidate]]
Ranges = Mapping[tuple[str, str], Range]


class Proposal(Struct, frozen=True):
    """The binding proposed for a specification and a recording."""

    text: str  # the binding as TOML
    unmatched: tuple[str, ...]  # the names left open
    # groups of names that are fed by the same field
    shared: tuple[tuple[str, ...], ...]
    unlabelled: tuple[str, ...]  # label signals fed by numbers whose labels are not known


def propose(spec: CheckedSpec, source: MessageFile) -> Proposal:
    """Propose a source for each declared name: a field with the same words, kind and dimension.

    A name is left open if no field fits, or if several fit equally well.
    """
    topics = source.topics
    seen = names_in(source)
    everything = [
        candidate
        for topic in topics.values()
        if not topic.fault
        for candidate in candidates_of(topic, seen[topic.name])
    ]
    types = {name: signal.type for name, signal in spec.signals.items()}
    found: dict[str, Ranked] = {}
    wanted = {name: wanted_of(name, type_, topics.values()) for name, type_ in types.items()}
    wanted |= {name: wanted_of(name, None, topics.values()) for name in spec.events}
    for name, target in wanted.items():
        found[name] = fitting(target, everything if name in types else events_of(topics))
    near = {
        name: of_same_dimension(wanted[name], everything)[:_MOST]
        for name in types
        if not found[name]
    }
    shown = [candidate for own in found.values() for _, candidate in own[: 2 * _MOST]]
    ranges = ranges_of(source, [*shown, *(candidate for own in near.values() for candidate in own)])
    found = {name: _with_values(own, ranges, types.get(name)) for name, own in found.items()}
    chosen = {
        name: own[0][1]
        for name, own in found.items()
        if is_clear(wanted[name], own) and not _is_idle(own, ranges)
    }
    lines = ['clock = "log"  # or "header": times are the stamps in the headers']
    for name, candidate in chosen.items():
        lines += ["", f"[bind.{_key(name)}]  # {_described(types.get(name))}"]
        if guess := wanted[name].guess:
            lines.append(f"# A guess: {guess}.")
        lines.append(f"topic = {_text(candidate.topic.name)}")
        lines.append(f"type = {_text(candidate.topic.type)}")
        if candidate.value:
            lines.append(f"value = {_text(candidate.value)}{_range(candidate, ranges)}")
        if name in types:
            lines += _signal_lines(types[name], candidate, ranges)
        else:
            lines += _event_lines(spec.events[name].fields, candidate)
        lines += [f"# or {_place(other, ranges)}" for _, other in found[name][1:_MOST]]
    missed = [name for name in found if name not in chosen]
    for name in missed:
        lines += ["", *_open_lines(name, types.get(name), found[name], near.get(name, ()), ranges)]
    unlabelled = [
        name for name, candidate in chosen.items() if _has_codes(types.get(name), candidate)
    ]
    return Proposal("\n".join(lines) + "\n", tuple(missed), _shared(chosen), tuple(unlabelled))


def _has_codes(type_: Type | None, candidate: Candidate) -> bool:
    return type_ is not None and type_.kind is Kind.LABEL and candidate.kind is not Kind.LABEL


def _with_values(found: Ranked, ranges: Ranges, type_: Type | None) -> Ranked:
    """Drop candidates that are raw, and those without a value unless no others are left."""
    if type_ is not None and type_.unit:
        found = [one for one in found if not _is_raw(one[1], type_.unit, ranges)]
    kept = [one for one in found if (own := ranges.get(one[1].key)) is None or own.count]
    return kept or found


def _is_raw(candidate: Candidate, unit: str, ranges: Ranges) -> bool:
    """Whether a candidate is an integer without a stated unit, too large for the plain unit."""
    own = ranges.get(candidate.key)
    if own is None or own.high is None or own.low is None or candidate.unit is not None:
        return False
    plain = _plain_unit(parse_unit(unit).dimension)
    return candidate.kind is Kind.INT and max(own.high, -own.low) > _LARGE.get(plain, inf)


def _is_idle(found: Ranked, ranges: Ranges) -> bool:
    """Whether the best candidate is a number that never changes, and another one does change."""
    best, *others = (ranges.get(candidate.key, Range()) for _, candidate in found)
    return best.is_constant and any(own.low != own.high for own in others)


def _range(candidate: Candidate, ranges: Ranges) -> str:
    own = ranges.get(candidate.key)
    return f"  # {own}" if own is not None else ""


def _place(candidate: Candidate, ranges: Ranges) -> str:
    value = f", value = {_text(candidate.value)}" if candidate.value else ""
    return f"topic = {_text(candidate.topic.name)}{value}{_range(candidate, ranges)}"


def _signal_lines(type_: Type, candidate: Candidate, ranges: Ranges) -> Iterator[str]:
    values = ranges.get(candidate.key, Range())
    if type_.unit:
        symbol, remark = _unit_of(type_.unit, candidate, max(values.high or 0, -(values.low or 0)))
        yield f"unit = {_text(symbol)}{remark}"
        if symbol == "1" and not remark and (values.high or 0) > _WHOLE:
            yield f'# It looks like per cent: then value = "1 * {candidate.value}", unit = "%"'
    if _has_codes(type_, candidate):
        there = f": it holds {', '.join(map(str, values.first))}" if values.first else ""
        listed = ", ".join(f"0 = {_text(label)}" for label in type_.labels[:1])
        yield f"# labels = {{ {listed} }}  # which number stands for which{there}"


def _unit_of(declared: str, candidate: Candidate, largest: float) -> tuple[str, str]:
    """The unit of a value, and a remark unless the messages state it.

    `largest`: the greatest absolute value seen.
    """
    dimension = parse_unit(declared).dimension
    units = [unit.symbol or "1" for unit in candidate.meaning.units if unit.dimension == dimension]
    if units:
        return units[0], ""
    if candidate.unit is not None:
        return candidate.unit.symbol, "  # by the name of the field"
    is_plain = declared not in ("", "1") and parse_unit(declared).factor == 1
    plain = declared if is_plain else _plain_unit(dimension) or "1"
    if (plain == "1" and largest > _WHOLE) or (plain == "rad" and largest > _TURN):
        return {"1": "%", "rad": "deg"}[plain], "  # a guess: by its values"
    return plain, "  # a guess: the messages do not say"


def _plain_unit(dimension: tuple[tuple[str, int], ...]) -> str:
    """The unit of a dimension without a factor: one with its own name, or a product of base units.

    >>> _plain_unit(parse_unit("mV").dimension), _plain_unit(parse_unit("km/h").dimension)
    ('V', 'm/s')
    """
    named = [
        name
        for name, unit in unit_table().items()
        if unit.dimension == dimension and unit.factor == 1 and name != "J"  # may be a torque
    ]
    return min(named, key=len, default=base_unit(dict(dimension)).symbol)


def _event_lines(fields: Mapping[str, Type], candidate: Candidate) -> Iterator[str]:
    if candidate.value:
        yield 'on = "change"  # only the first of several in a row that are true'
    payload = {}
    for name, type_ in fields.items():
        wanted = wanted_of(name, type_, ())
        ranked = fitting(wanted, candidates_of(candidate.topic, TopicNames()))
        if is_clear(wanted, ranked):
            payload[name] = ranked[0][1].value
        else:
            yield f"# Nothing was found for its field `{name}`."
    if payload:
        listed = ", ".join(f"{_key(field)} = {_text(value)}" for field, value in payload.items())
        yield f"fields = {{ {listed} }}"


def _open_lines(
    name: str, type_: Type | None, found: Ranked, near: Sequence[Candidate], ranges: Ranges
) -> Iterator[str]:
    what = _described(type_)
    if found:
        yield f"# Several sources fit `{name}` ({what}) equally well: choose one."
    elif near:
        yield f"# Nothing has a name like `{name}` ({what}). These are measured in such a unit:"
    else:
        yield f"# Nothing was found for `{name}` ({what}):"
    yield f"# [bind.{_key(name)}]"
    for candidate in [candidate for _, candidate in found[:_MOST]] or near:
        yield f"# {_place(candidate, ranges)}"
    if not found and not near:
        yield '# topic = "…"'
        yield '# value = "…"'


def _shared(chosen: Mapping[str, Candidate]) -> tuple[tuple[str, ...], ...]:
    names: dict[tuple[str, str], list[str]] = defaultdict(list)
    for name, candidate in chosen.items():
        names[candidate.key].append(name)
    return tuple(tuple(own) for own in names.values() if len(own) > 1)


def _described(type_: Type | None) -> str:
    if type_ is None:
        return "event"
    if type_.kind is Kind.LABEL:
        return f"{{{', '.join(type_.labels)}}}"
    return f"{type_.kind} [{type_.unit}]" if type_.unit else str(type_.kind)


def _key(name: str) -> str:
    parts = name.split(".")
    return ".".join(
        part if re.fullmatch(r"[A-Za-z0-9_-]+", part) else _text(part) for part in parts
    )


def _text(text: str) -> str:
    """A text as a TOML string, which has the same escapes as JSON."""
    return json.dumps(text, ensure_ascii=False)
