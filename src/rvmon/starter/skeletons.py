"""Requirements that hold of the recording, to start from."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal
from itertools import islice

from rvmon.spec.checked.formula import Literal, SignalAtom
from rvmon.spec.print.printer import format_duration, format_formula, format_numeric
from rvmon.starter.column import Column, Profile
from rvmon.trace.schema import Kind
from rvmon.trace.time import TICKS_PER_SECOND

MOST_CANDIDATES = 12
"""Names that are tried as trigger and as response."""

FEWEST = 2
"""Requirements that are written at least."""

_MOST_RANGES = 3
_MOST_SOURCES = 2

_OFTEN = 3
"""An event that comes so many times as often as another does not answer it."""


@dataclass(frozen=True, slots=True)
class Skeleton:
    """A requirement as text.

    Attributes:
        title: in words.
        body: its lines.
        remark: where its numbers come from.
        names: that it reads.
    """

    title: str
    body: tuple[str, ...]
    remark: str
    names: tuple[str, ...]


def skeletons_of(profile: Profile) -> list[Skeleton]:
    """Requirements that the recording itself meets, those that say most first."""
    found = [*_responses(profile.columns), *_ranges(profile.columns), *_sources(profile.columns)]
    others = _others(profile)
    bodies = {one.body for one in found}
    return found + list(
        islice((one for one in others if one.body not in bodies), max(0, FEWEST - len(found)))
    )


def name_text(name: str) -> str:
    """A name as the language writes it.

    >>> name_text("speed"), name_text("for")
    ('speed', '`for`')
    """
    return format_formula(SignalAtom(name))


def _ranges(columns: Sequence[Column]) -> Iterator[Skeleton]:
    """The ranges of numbers that change: one of each topic, those with a unit first."""
    changing = sorted((one for one in columns if one.changes), key=lambda one: not one.shape.unit)
    first = {one.shape.source or one.name: one for one in reversed(changing)}
    yield from map(_range, [one for one in changing if one in first.values()][:_MOST_RANGES])


def _sources(columns: Sequence[Column]) -> Iterator[Skeleton]:
    """How often what is reported comes: one signal of each topic."""
    signals = [one for one in columns if not one.is_event and one.updates > 1]
    first = {one.shape.source or one.name: one for one in reversed(signals)}
    chosen = [one for one in signals if one in first.values()]
    chosen.sort(key=lambda one: one.changes)
    yield from map(_freshness, chosen[:_MOST_SOURCES])


def _others(profile: Profile) -> Iterator[Skeleton]:
    """What can be said of any recording."""
    yield from (_range(column) for column in profile.columns if column.is_finite)
    yield from (_happens(column, profile) for column in profile.columns if column.instants)
    yield from (_ever(column) for column in profile.columns)


def _responses(columns: Sequence[Column]) -> Iterator[Skeleton]:
    """The pair of which the second follows the first always, and earliest."""
    candidates = [column for column in columns if column.instants][:MOST_CANDIDATES]
    found = []
    for trigger in candidates:
        for response in candidates:
            often = len(response.instants) > _OFTEN * len(trigger.instants)
            once = len(trigger.instants) < FEWEST
            if response is not trigger and not often and not once:
                wait = _longest_wait(trigger.instants, response.instants)
                if wait:
                    found.append((not trigger.is_event, wait, trigger, response))
    for _, wait, trigger, response in sorted(found, key=lambda one: one[:2])[:1]:
        limit = round_up(wait)
        yield Skeleton(
            f"After {trigger.name}, {response.name} comes in time",
            (f"upon {_occurrence(trigger)}", f"then within {limit} {name_text(response.name)}"),
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


def _occurrence(column: Column) -> str:
    return name_text(column.name) if column.is_event else f"rise({name_text(column.name)})"


def _range(column: Column) -> Skeleton:
    name = name_text(column.name)
    low, high = (
        format_numeric(_literal(outward(value or 0, up=up), column))
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
    """A number of three digits that is not within it.

    >>> outward(2.99994, up=True), outward(0.123456, up=False), outward(0.35, up=False)
    (3.0, 0.123, 0.35)
    """
    if isinstance(value, int):
        return value
    exact = Decimal(repr(value))
    place = Decimal(1).scaleb(exact.adjusted() - 2)
    rounded = exact.quantize(place, ROUND_CEILING if up else ROUND_FLOOR)
    made = float(rounded)
    return made if (made >= value if up else made <= value) else value


def _literal(value: float, column: Column) -> Literal:
    number = int(value) if column.shape.kind is Kind.INT else float(value)
    return Literal(number, column.shape.unit)


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
    """A duration of one or two digits that is at least this long.

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
