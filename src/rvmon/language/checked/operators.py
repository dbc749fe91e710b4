"""The operators of formulas: one entry each, which all code that reads formulas uses.

An entry defines its operator in terms of the primitive operators of `Reading`. An interpreter of
formulas implements only these and gets all others. A new operator that can be derived from known
ones is one entry here. `rise`, `fall` and `held` have special cases before birth, see
`logic/three_valued.py`. The oracle has its own, independent definitions, against which these are
tested.
"""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum, StrEnum, auto
from typing import Any, Protocol, Self, TypeVar

from msgspec import Struct

T = TypeVar("T")


class Interval(Struct, frozen=True):
    """The closed interval `[low, high]` of durations in ticks; `high` is `None` if unbounded."""

    low: int = 0
    high: int | None = None


class Connectives(Protocol[T]):
    """An interpretation of the primitive connectives, from which all others are derived."""

    def constant(self, value: bool, /) -> T:
        """`true` or `false`."""

    def no(self, operand: T, /) -> T:
        """`not`."""

    def both(self, left: T, right: T, /) -> T:
        """`and`."""

    def either(self, left: T, right: T, /) -> T:
        """`or`: the dual of `both`."""
        return self.no(self.both(self.no(left), self.no(right)))


class Reading(Connectives[T], Protocol[T]):
    """An interpretation of the primitive operators, with those of time."""

    def next(self, operand: T, /) -> T:
        """`next`."""

    def previous(self, operand: T, /) -> T:
        """`previous`."""

    def until(self, left: T, right: T, window: Interval, /) -> T:
        """`until`."""

    def since(self, left: T, right: T, window: Interval, /) -> T:
        """`since`."""


class Tense(Enum):
    """The instants to which an operator refers."""

    PRESENT = auto()
    PAST = auto()
    FUTURE = auto()


class Window(Enum):
    """The interval that an operator takes."""

    NONE = auto()
    ANY = auto()
    FROM_NOW = auto()  # lower bound 0, because the usual definitions differ for other bounds
    LENGTH = auto()  # `[0, D]`, written as an argument D


PREFIXED, CALLED = 6, 7
"""The precedence levels of prefixes and of calls."""


class Operator(Struct, frozen=True):
    """The entry of an operator."""

    sign: str
    word: str  # the spelling that is printed
    tense: Tense
    window: Window
    level: int  # its precedence; 0 binds loosest
    meaning: Callable[..., Any]  # its value from a `Reading`, the operands and the interval
    # an English clause; `{left}` and `{right}`, or `{it}`, are its operands, `{no_left}` and so on
    # their negations, `{some}` and `{all}` name its interval. If empty,
    # `analysis/plain_english.py` words it in its own way
    wording: str
    denied: str  # the clause of its negation; if empty, "not so" is put before `wording`
    doc: str  # its value in a few words
    dual: str = ""  # the sign of its dual, `not op(not φ)`; empty if it has none
    chained: bool = False  # whether it is associative and written in chains without brackets
    pulse: bool = False  # whether it is true at single instants only
    also: tuple[str, ...] = ()  # other spellings in addition to its word and sign

    @property
    def called(self) -> bool:
        """Whether it is written as a function call."""
        return self.level == CALLED


class _Sign(StrEnum):
    entry: Operator

    def __new__(cls, entry: Operator) -> _Sign:
        """A member: its sign, with its entry."""
        member = str.__new__(cls, entry.sign)
        member._value_ = entry.sign
        member.entry = entry
        return member

    @classmethod
    def of(cls, text: str) -> Self:
        """The operator with a spelling."""
        return next(one for one in cls if text in one.spellings)

    @property
    def spellings(self) -> tuple[str, ...]:
        """All spellings, the printed one first."""
        return tuple(dict.fromkeys((self.entry.word, self.value, *self.entry.also)))


def _eventually(reading: Reading[T], it: T, window: Interval) -> T:
    return reading.until(reading.constant(True), it, window)


def _once(reading: Reading[T], it: T, window: Interval) -> T:
    return reading.since(reading.constant(True), it, window)


def _historically(reading: Reading[T], it: T, window: Interval) -> T:
    return reading.no(_once(reading, reading.no(it), window))


def _held(reading: Reading[T], it: T, window: Interval) -> T:
    """`held`: `historically` for D, and D has passed since the first instant."""
    complete = _once(reading, reading.constant(True), Interval(window.high or 0, None))
    return reading.both(_historically(reading, it, window), complete)


def _release(reading: Reading[T], left: T, right: T, window: Interval) -> T:
    return reading.no(reading.until(reading.no(left), reading.no(right), window))


def _same(reading: Reading[T], left: T, right: T, _: Interval) -> T:
    neither = reading.both(reading.no(left), reading.no(right))
    return reading.either(reading.both(left, right), neither)


class UnaryOp(_Sign):
    """Unary operators; temporal ones except `X Y rise fall` carry an interval (`held`: [0, D]).

    >>> UnaryOp.of("eventually")
    <UnaryOp.EVENTUALLY: 'F'>
    """

    NOT = Operator(
        "!", "not", Tense.PRESENT, Window.NONE, PREFIXED, lambda reading, it, _: reading.no(it),
        "", "", "φ does not hold",
    )  # fmt: skip
    NEXT = Operator(
        "X", "next", Tense.FUTURE, Window.NONE, PREFIXED, lambda reading, it, _: reading.next(it),
        "at the next sample, {it}", "at the next sample, {no_it}",
        "φ at the position after; not in `time held`", dual="X",
    )  # fmt: skip
    EVENTUALLY = Operator(
        "F", "eventually", Tense.FUTURE, Window.ANY, PREFIXED, _eventually,
        "{some}, {it}", "{all}, {no_it}", "φ at some instant from now on", dual="G",
    )  # fmt: skip
    ALWAYS = Operator(
        "G", "always", Tense.FUTURE, Window.ANY, PREFIXED,
        lambda reading, it, window: reading.no(_eventually(reading, reading.no(it), window)),
        "{all}, {it}", "{some}, {no_it}", "φ at all instants from now on", dual="F",
    )  # fmt: skip
    PREVIOUS = Operator(
        "Y", "previous", Tense.PAST, Window.NONE, PREFIXED,
        lambda reading, it, _: reading.previous(it),
        "at the sample before, {it}", "",
        "φ at the position before, false at the first; not in `time held`",
    )  # fmt: skip
    ONCE = Operator(
        "O", "once", Tense.PAST, Window.ANY, PREFIXED, _once,
        "{some}, {it}", "{all}, {no_it}", "φ at some instant up to now", dual="H",
    )  # fmt: skip
    HISTORICALLY = Operator(
        "H", "historically", Tense.PAST, Window.ANY, PREFIXED, _historically,
        "{all}, {it}", "{some}, {no_it}", "φ at all instants up to now", dual="O",
    )  # fmt: skip
    RISE = Operator(
        "rise", "rise", Tense.PAST, Window.NONE, CALLED,
        lambda reading, it, _: reading.both(it, reading.no(reading.previous(it))),
        "{begins}", "it is not the instant at which {begins}", "φ holds and did not right before",
        pulse=True,
    )  # fmt: skip
    FALL = Operator(
        "fall", "fall", Tense.PAST, Window.NONE, CALLED,
        lambda reading, it, _: reading.both(reading.no(it), reading.previous(it)),
        "{ends}", "it is not the instant at which {ends}", "φ does not hold and did right before",
        pulse=True,
    )  # fmt: skip
    HELD = Operator(
        "held", "held", Tense.PAST, Window.LENGTH, CALLED, _held,
        "for the last {length} without a break, {it}",
        "not for the last {length} without a break, {it}", "φ has held for D, all within the run",
    )  # fmt: skip


class BinaryOp(_Sign):
    """Binary operators; the temporal ones carry an interval.

    >>> BinaryOp.of("weak until").entry.word
    'unless'
    """

    AND = Operator(
        "and", "and", Tense.PRESENT, Window.NONE, 4,
        lambda reading, left, right, _: reading.both(left, right),
        "", "", "both hold", chained=True, also=("&", "&&"),
    )  # fmt: skip
    OR = Operator(
        "or", "or", Tense.PRESENT, Window.NONE, 2,
        lambda reading, left, right, _: reading.either(left, right),
        "", "", "one holds, or both", chained=True, also=("|", "||"),
    )  # fmt: skip
    IMPLIES = Operator(
        "->", "->", Tense.PRESENT, Window.NONE, 1,
        lambda reading, left, right, _: reading.either(reading.no(left), right),
        "if {left}, then {right}", "{left} but {no_right}",
        "ψ holds if φ does; groups to the right", also=("implies",),
    )  # fmt: skip
    IFF = Operator(
        "<->", "<->", Tense.PRESENT, Window.NONE, 0, _same,
        "{left} exactly if {right}", "either {left} or {right}, not both", "both hold, or neither",
        chained=True, also=("iff",),
    )  # fmt: skip
    XOR = Operator(
        "xor", "xor", Tense.PRESENT, Window.NONE, 3,
        lambda reading, left, right, window: _same(reading, left, reading.no(right), window),
        "either {left} or {right}, not both", "{left} exactly if {right}",
        "one holds and not the other", chained=True,
    )  # fmt: skip
    UNTIL = Operator(
        "U", "until", Tense.FUTURE, Window.ANY, 5,
        lambda reading, left, right, window: reading.until(left, right, window),
        "{some}, {right}; and until then {left}", "",
        "ψ at some instant from now on, φ at all before it", dual="R",
    )  # fmt: skip
    RELEASE = Operator(
        "R", "R", Tense.FUTURE, Window.ANY, 5, _release,
        "{all}, {right}; up to and at the instant when {left}, if that comes earlier", "",
        "ψ at all instants up to and at one at which φ holds, if there is one", dual="U",
    )  # fmt: skip
    WEAK_UNTIL = Operator(
        "W", "unless", Tense.FUTURE, Window.FROM_NOW, 5,
        lambda reading, left, right, window:
            _release(reading, right, reading.either(left, right), window),
        "{all}, {left}; until {right}, if that comes earlier", "",
        "as `until`, but ψ need not come", dual="M", also=("weak until",),
    )  # fmt: skip
    STRONG_RELEASE = Operator(
        "M", "M", Tense.FUTURE, Window.FROM_NOW, 5,
        lambda reading, left, right, window:
            reading.until(right, reading.both(left, right), window),
        "{some}, {left}; until then and at that instant {right}", "", "as `R`, but φ has to come",
        dual="W",
    )  # fmt: skip
    SINCE = Operator(
        "S", "since", Tense.PAST, Window.ANY, 5,
        lambda reading, left, right, window: reading.since(left, right, window),
        "{right} {ago}and since then {left}", "", "ψ at some instant up to now, φ at all after it",
    )  # fmt: skip

    @property
    def is_kin_of_until(self) -> bool:
        """Whether it is temporal; all of these have the precedence of `until`."""
        return self.entry.level == BinaryOp.UNTIL.entry.level


OPERATORS: tuple[UnaryOp | BinaryOp, ...] = (*UnaryOp, *BinaryOp)  # all operators
