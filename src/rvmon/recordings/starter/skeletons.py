"""Skeletons: requirements that a recording meets, and a starter specification made of them."""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Iterator, Sequence
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal
from itertools import islice
from math import isfinite
from pathlib import Path

from msgspec import Struct

from rvmon.language.checked.formula import Literal, SignalAtom
from rvmon.language.formatter import format_text
from rvmon.language.print import format_duration, format_formula, format_numeric
from rvmon.recordings.rows import LEAP
from rvmon.recordings.starter.observed_values import Column, Profile, reasons_of
from rvmon.trace.schema import Kind
from rvmon.trace.time import TICKS_PER_SECOND

MOST_CANDIDATES = 12  # the most names that are tried as trigger and as response
FEWEST = 2  # at least this many requirements are written

_MOST_RANGES = 3
_MOST_SOURCES = 2

_OFTEN = 3  # an event that is more frequent than another by this factor is no response to it


class Skeleton(Struct, frozen=True):
    """A requirement as text."""

    title: str
    body: tuple[str, ...]
    remark: str
    names: tuple[str, ...]


def skeletons_of(profile: Profile) -> list[Skeleton]:
    """Requirements that the recording itself meets, the most informative first."""
    found = [*_responses(profile.columns), *_ranges(profile.columns), *_sources(profile.columns)]
    others = _others(profile)
    bodies = {skeleton.body for skeleton in found}
    return found + list(
        islice((other for other in others if other.body not in bodies), max(0, FEWEST - len(found)))
    )


def name_text(name: str) -> str:
    """A name as the language writes it.

    >>> name_text("speed"), name_text("for")
    ('speed', '`for`')
    """
    return format_formula(SignalAtom(name))


def _ranges(columns: Sequence[Column]) -> Iterator[Skeleton]:
    """Skeletons about the ranges of changing numbers: one per topic, those with a unit first."""
    changing = sorted(
        (column for column in columns if column.changes), key=lambda column: not column.shape.unit
    )
    first = {column.shape.source or column.name: column for column in reversed(changing)}
    yield from map(
        _range, [column for column in changing if column in first.values()][:_MOST_RANGES]
    )


def _sources(columns: Sequence[Column]) -> Iterator[Skeleton]:
    """Skeletons about the age of signals: one signal per topic."""
    signals = [
        column
        for column in columns
        if not column.is_event and column.updates > 1 and column.longest_silence <= LEAP
    ]
    first = {signal.shape.source or signal.name: signal for signal in reversed(signals)}
    chosen = [signal for signal in signals if signal in first.values()]
    chosen.sort(key=lambda column: column.changes)
    yield from map(_freshness, chosen[:_MOST_SOURCES])


def _others(profile: Profile) -> Iterator[Skeleton]:
    """Skeletons that fit any recording."""
    yield from (_range(column) for column in profile.columns if column.is_finite)
    yield from (
        _happens(column, profile)
        for column in profile.columns
        if column.instants and column.instants[0] - profile.start <= LEAP
    )
    yield from (_ever(column) for column in profile.columns)


def _responses(columns: Sequence[Column]) -> Iterator[Skeleton]:
    """A skeleton of the trigger and response with the shortest longest wait, if there are any.

    The response must follow each occurrence of the trigger. Triggers that are events come first.
    """
    candidates = [column for column in columns if column.instants][:MOST_CANDIDATES]
    found = []
    for trigger in candidates:
        for response in candidates:
            often = len(response.instants) > _OFTEN * len(trigger.instants)
            once = len(trigger.instants) < FEWEST
            if response is not trigger and not often and not once:
                wait = _longest_wait(trigger.instants, response.instants)
                if wait and wait <= LEAP:
                    found.append((not trigger.is_event, wait, trigger, response))
    for _, wait, trigger, response in sorted(found, key=lambda one: one[:2])[:1]:
        limit, name = round_up(wait), name_text(trigger.name)
        upon = f"upon {name}" if trigger.is_event else f"upon rise({name})"
        yield Skeleton(
            f"After {trigger.name}, {response.name} comes in time",
            (upon, f"then within {limit} {name_text(response.name)}"),
            f"the longest wait in the recording was {wait / TICKS_PER_SECOND:.6g} s",
            (trigger.name, response.name),
        )


def _longest_wait(triggers: Sequence[int], responses: Sequence[int]) -> int | None:
    """The longest time from a trigger to the next response; `None` if one was not answered."""
    longest = 0
    for t in triggers:
        index = bisect_left(responses, t)
        if index == len(responses):
            return None
        longest = max(longest, responses[index] - t)
    return longest


def _range(column: Column) -> Skeleton:
    name = name_text(column.name)
    made, unit = int if column.shape.kind is Kind.INT else float, column.shape.unit
    low, high = (
        format_numeric(Literal(made(outward(value or 0, up=up)), unit))
        for value, up in ((column.low, False), (column.high, True))
    )
    bounds = f"{name} >= {low} and {name} <= {high}"
    body = f"known({name}) -> {bounds}" if column.gaps_in_value else bounds
    return Skeleton(
        f"{column.name} stays in its range",
        (f"always ({body})",),
        f"it was between {column.low:.6g} and {column.high:.6g}",
        (column.name,),
    )


def outward(value: float, *, up: bool) -> float:
    """Round a number outwards to three digits: up, or down.

    >>> outward(2.99994, up=True), outward(0.123456, up=False), outward(0.35, up=False)
    (3.0, 0.123, 0.35)
    """
    if isinstance(value, int):
        return value
    exact = Decimal(repr(value))
    place = Decimal(1).scaleb(exact.adjusted() - 2)
    rounded = exact.quantize(place, ROUND_CEILING if up else ROUND_FLOOR)
    made = float(rounded)
    return made if isfinite(made) else value


def _freshness(column: Column) -> Skeleton:
    name = name_text(column.name)
    fresh = f"age({name}) <= {round_up(column.longest_silence)}"
    silence = column.longest_silence / TICKS_PER_SECOND
    return Skeleton(
        f"{column.name} keeps coming",
        (f"always (known({name}) -> {fresh})" if column.gaps_in_value else f"always {fresh}",),
        f"the longest silence in the recording was {silence:.6g} s",
        (column.name,),
    )


def _happens(column: Column, profile: Profile) -> Skeleton:
    wait = column.instants[0] - profile.start
    limit = round_up(max(wait, 1))
    return Skeleton(
        f"{column.name} comes soon after the start",
        ("upon start", f"then within {limit} {name_text(column.name)}"),
        f"in the recording it came after {wait / TICKS_PER_SECOND:.6g} s",
        (column.name,),
    )


def _ever(column: Column) -> Skeleton:
    name = name_text(column.name)
    return Skeleton(
        f"{column.name} comes at some time",
        (f"eventually {name}" if column.is_event else f"eventually known({name})",),
        "replace it by what you mean",
        (column.name,),
    )


def round_up(ticks: int) -> str:
    """Round a duration (ticks) up to one or two digits, as text.

    >>> round_up(1_234_000_000), round_up(730_000_000), round_up(2_000_000_000), round_up(70)
    ('1.5 s', '800 ms', '2 s', '80 ns')
    """
    scale = 1
    while scale * 10 <= ticks:
        scale *= 10
    steps = (10, 15, 20, 30, 40, 50, 60, 80, 100)
    rounded = next(scale * step // 10 for step in steps if scale * step // 10 >= ticks)
    if rounded > TICKS_PER_SECOND and rounded % TICKS_PER_SECOND:
        return f"{rounded / TICKS_PER_SECOND:.6g} s"
    return format_duration(rounded)


_LONGEST = 4_000_000_000 * TICKS_PER_SECOND  # the longest `max delay`; rows are sorted all the same
_LISTED = 6  # the most names that are listed for a reason why they are not declared


def starter_text(profile: Profile) -> str:
    """A starter specification in the canonical layout, which runs on the recording unchanged."""
    skeletons = skeletons_of(profile)
    read = {name for skeleton in skeletons for name in skeleton.names}
    lines = [*_header(profile), ""]
    lines += [_declaration(column) for column in profile.columns if column.name in read]
    for number, skeleton in enumerate(skeletons, 1):
        lines += ["", *_requirement(f"R{number}", skeleton)]
    others = [column for column in profile.columns if column.name not in read]
    if others:
        # As comments: the checker would warn of declarations that no requirement reads.
        lines += ["", "# Other names: remove the `#` before those that a requirement reads."]
        lines += [f"# {_declaration(column)}" for column in others]
    if profile.left_out:
        lines += ["", "# What cannot be declared, and why:"]
        plain = {_plain(name): why for name, why in profile.left_out.items()}
        lines += [f"#   {reason}" for reason in reasons_of(plain, _LISTED)]
    return format_text("\n".join(lines) + "\n")


def _header(profile: Profile) -> Iterator[str]:
    file = Path(profile.path).name
    stem = re.sub(r"\W", "_", Path(profile.path).stem) or "recording"
    span = (profile.end - profile.start) / TICKS_PER_SECOND
    name = stem if stem[0].isalpha() else f"recording_{stem}"
    yield f"# From {_plain(file)}: {profile.samples} samples in {span:.6g} s."
    units = (
        "" if any(column.shape.unit for column in profile.columns) else "units (`real [m/s]`) and "
    )
    yield f"# The types are guessed; add {units}roles (`input`, `output`)."
    yield f'spec {name_text(name)} "{_plain(stem)}"'
    yield "time held"
    if profile.lateness:
        late = profile.lateness / TICKS_PER_SECOND
        delay = round_up(min(profile.lateness, _LONGEST))
        yield f"max delay {delay}  # stamps go back by up to {late:.6g} s"


def _declaration(column: Column) -> str:
    remark = "; ".join(_remarks(column))
    line = _declared(column)
    return f"{line}  # {remark}" if remark else line


def _declared(column: Column) -> str:
    name, shape = name_text(column.name), column.shape
    if shape.kind is None:
        fields = ", ".join(f"{field}: {kind}" for field, kind in shape.fields.items())
        return f"event  {name}({fields})" if fields else f"event  {name}"
    if shape.kind is Kind.LABEL:
        return f"signal {name} : {{{', '.join(map(name_text, shape.labels))}}}"
    unit = f" [{shape.unit}]" if shape.unit else ""
    return f"signal {name} : {shape.kind}{unit}"


def _remarks(column: Column) -> Iterator[str]:
    if column.is_event:
        yield f"{column.occurrences} times" if column.occurrences != 1 else "once"
        if column.guessed_event:
            yield "a guess: true in single samples"
        return
    if column.low is not None and column.high is not None:
        low, high = f"{column.low:.6g}", f"{column.high:.6g}"
        yield f"always {low}" if column.low == column.high else f"{low} … {high}"
    if column.rate:
        gap = format_duration(column.longest_gap)
        if len(gap) > 8:
            gap = f"{column.longest_gap / TICKS_PER_SECOND:.3g} s"
        yield f"{column.rate:.3g} Hz, longest gap {gap}"
    elif column.updates == 1:
        yield "one value"
    elif not column.updates:
        yield "no value"


def _requirement(name: str, skeleton: Skeleton) -> Iterator[str]:
    yield f'requirement {name} "{_plain(skeleton.title)}"'
    for line in skeleton.body:
        yield f"  {line}"
    yield f"  # {skeleton.remark}"


def _plain(text: str) -> str:
    """Replace the characters that could end a line, a comment or a string."""
    return "".join(char if char.isprintable() and char not in '"\\' else "_" for char in text)
