"""Two requirements that hold of the recording, to start from."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice

from rvmon.spec.checked.formula import Literal, SignalAtom
from rvmon.spec.print.printer import format_duration, format_formula, format_numeric
from rvmon.starter.column import Column, Profile
from rvmon.trace.schema import Kind
from rvmon.trace.time import TICKS_PER_SECOND

MOST_CANDIDATES = 12
"""Names that are tried as trigger and as response."""

MANY = 2
"""How many requirements are written."""


@dataclass(frozen=True, slots=True)
class Skeleton:
    """A requirement as text.

    Attributes:
        title: in words.
        body: its lines.
        remark: where its numbers come from.
    """

    title: str
    body: tuple[str, ...]
    remark: str


def skeletons_of(profile: Profile) -> list[Skeleton]:
    """Requirements that the recording itself meets, those that say most first."""
    return list(islice(_all(profile), MANY))


def name_text(name: str) -> str:
    """A name as the language writes it.

    >>> name_text("speed"), name_text("for")
    ('speed', '`for`')
    """
    return format_formula(SignalAtom(name))


def _all(profile: Profile) -> Iterator[Skeleton]:
    yield from _responses(profile.columns)
    numbers = [column for column in profile.columns if column.low is not None]
    yield from (_range(column) for column in numbers[:1])
    signals = [column for column in profile.columns if not column.is_event and column.updates > 1]
    signals.sort(key=lambda column: column in numbers[:1])
    yield from (_freshness(column) for column in signals)
    yield from (_happens(column, profile) for column in profile.columns if column.instants)
    yield from (_ever(column) for column in profile.columns)


def _responses(columns: Sequence[Column]) -> Iterator[Skeleton]:
    """The pair of which the second follows the first always, and soonest."""
    candidates = [column for column in columns if column.instants][:MOST_CANDIDATES]
    found = []
    for trigger in candidates:
        for response in candidates:
            if response is not trigger:
                wait = _longest_wait(trigger.instants, response.instants)
                if wait:
                    found.append((not trigger.is_event, wait, trigger, response))
    for _, wait, trigger, response in sorted(found, key=lambda one: one[:2])[:1]:
        limit = round_up(wait)
        yield Skeleton(
            f"After {trigger.name}, {response.name} comes in time",
            (f"upon {_occurrence(trigger)}", f"then within {limit} {name_text(response.name)}"),
            f"the longest wait in the recording was {wait / TICKS_PER_SECOND:.6g} s",
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
    low, high = (format_numeric(_literal(value, column)) for value in (column.low, column.high))
    bounds = f"{name} >= {low} and {name} <= {high}"
    body = f"known({name}) -> {bounds}" if column.gaps_in_value else bounds
    return Skeleton(
        f"{column.name} stays in its range",
        (f"always ({body})",),
        "the least and the greatest value in the recording",
    )


def _literal(value: float | None, column: Column) -> Literal:
    number = value or 0
    return Literal(int(number) if column.shape.kind is Kind.INT else float(number))


def _freshness(column: Column) -> Skeleton:
    name = name_text(column.name)
    fresh = f"age({name}) <= {round_up(column.longest_silence)}"
    silence = column.longest_silence / TICKS_PER_SECOND
    return Skeleton(
        f"{column.name} keeps coming",
        (f"always (known({name}) -> {fresh})" if column.gaps_in_value else f"always {fresh}",),
        f"the longest silence in the recording was {silence:.6g} s",
    )


def _happens(column: Column, profile: Profile) -> Skeleton:
    wait = column.instants[0] - profile.start
    limit = round_up(max(wait, 1))
    return Skeleton(
        f"{column.name} comes soon after the start",
        ("upon start", f"then within {limit} {name_text(column.name)}"),
        f"in the recording it came after {wait / TICKS_PER_SECOND:.6g} s",
    )


def _ever(column: Column) -> Skeleton:
    name = name_text(column.name)
    return Skeleton(
        f"{column.name} comes at some time",
        (f"eventually {name}" if column.is_event else f"eventually known({name})",),
        "replace it by what you mean",
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
