"""Random formulas, specifications and traces, biased towards cases that monitors get wrong.

This module makes the random choices, and has the names that random specifications declare.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Mapping, Sequence
from typing import Protocol, TypeVar

from rvmon.language.checked.specification import Event, Signal, Type
from rvmon.trace.schema import Kind

T = TypeVar("T")


class Rng(Protocol):
    """A source of integers; `random.Random` is one."""

    def randint(self, a: int, b: int, /) -> int:
        """An integer from `a` to `b`, both included; shrinking leads to `a`."""


def chance(rng: Rng, percent: int) -> bool:
    """True with a probability of `percent`; false is the simplest."""
    return rng.randint(1, 100) > 100 - percent


def pick(rng: Rng, options: Sequence[T]) -> T:
    """One of the options, all equally likely; the first is the simplest."""
    return options[rng.randint(0, len(options) - 1)]


def weighted(rng: Rng, options: Sequence[tuple[int, T]]) -> T:
    """One of the options, in proportion to their weights; the first is the simplest."""
    rest = rng.randint(0, sum(weight for weight, _ in options) - 1)
    for weight, option in options:
        if rest < weight:
            return option
        rest -= weight
    raise AssertionError("the weights add up")


def drawn(rng: Rng, *ways: tuple[int, Callable[[], T]]) -> T:
    """The result of one of several functions, chosen in proportion to their weights."""
    return weighted(rng, ways)()


BOOLS = ("p", "q", "r")
NUMBERS = ("x", "y")
"""A real signal and an integer one."""
LABEL = "mode"
LABELS = ("red", "green", "blue")
EVENTS = ("e", "f")
CARRIER = "g"
"""The event with a payload."""
FIELD = "k"
FURTHER = "h"
"""Another event with a payload."""
SIZE = "m"
WIDE = (-(2**63), -(2**53) - 1, 0, 2**53, 2**53 + 1, 2**62, 2**63 - 1)
"""Whole numbers that a double cannot tell from their neighbours, and 0."""


def signals(
    stale: Mapping[str, int] | None = None, ignoring: Container[str] = ()
) -> dict[str, Signal]:
    """The declared signals; `stale` gives some a time limit in ticks, `ignoring` ignore NaN."""
    kinds = {
        **dict.fromkeys(BOOLS, Type(Kind.BOOL)),
        **dict(zip(NUMBERS, (Type(Kind.REAL), Type(Kind.INT)), strict=True)),
        LABEL: Type(Kind.LABEL, labels=LABELS),
    }
    after = stale or {}
    return {
        name: Signal(name, type_, stale_after=after.get(name), ignores_nan=name in ignoring)
        for name, type_ in kinds.items()
    }


def events() -> dict[str, Event]:
    """The declared events."""
    fields = {CARRIER: {FIELD: Type(Kind.INT)}, FURTHER: {SIZE: Type(Kind.REAL)}}
    return {name: Event(name, fields.get(name, {})) for name in (*EVENTS, CARRIER, FURTHER)}
