"""Formulas, specifications and traces in few words, for tests by hand.

>>> spec = spec_of(requirement(eventually(p, 0, 3), upon=e))
>>> [sample.t for sample in timeline(p="0..1", e=".1..")]
[0, 1, 3]
"""

from collections.abc import Callable, Container, Mapping
from functools import partial
from typing import Any

from msgspec.structs import replace

from rvmon.language.checked.formula import (
    Binary,
    BinaryOp,
    Bound,
    BoundAtom,
    Compare,
    CompareOp,
    Constant,
    EventAtom,
    FieldValue,
    Formula,
    Interval,
    Literal,
    Numeric,
    Probe,
    ProbeAtom,
    SignalAtom,
    SignalValue,
    Unary,
    UnaryOp,
)
from rvmon.language.checked.operators import Window
from rvmon.language.checked.specification import (
    CheckedSpec,
    Event,
    Mode,
    Requirement,
    Signal,
    TimeModel,
    Type,
)
from rvmon.testing.generate import BOOLS, CARRIER, FIELD, LABEL, LABELS, NUMBERS, events, signals
from rvmon.testing.law.attempts import is_pulse
from rvmon.trace.sample import Sample, Value
from rvmon.trace.schema import Kind

p, q, r = (SignalAtom(name) for name in BOOLS)
e, f, g = EventAtom("e"), EventAtom("f"), EventAtom(CARRIER)
x, y = (SignalValue(name) for name in NUMBERS)
k = FieldValue(CARRIER, FIELD)
start, end = BoundAtom(Bound.START), BoundAtom(Bound.END)
true, false = Constant(True), Constant(False)


def no(formula: Formula) -> Formula:
    """`not formula`."""
    return Unary(UnaryOp.NOT, formula)


def timed(op: UnaryOp, formula: Formula, low: int = 0, high: int | None = None) -> Formula:
    """A temporal operator with the interval `[low, high]`."""
    return Unary(op, formula, Interval(low, high))


eventually = partial(timed, UnaryOp.EVENTUALLY)
always = partial(timed, UnaryOp.ALWAYS)
once = partial(timed, UnaryOp.ONCE)
historically = partial(timed, UnaryOp.HISTORICALLY)
following = partial(Unary, UnaryOp.NEXT)
previous = partial(Unary, UnaryOp.PREVIOUS)
rise = partial(Unary, UnaryOp.RISE)
fall = partial(Unary, UnaryOp.FALL)


def held(formula: Formula, duration: int) -> Formula:
    """`held(formula, duration)`."""
    return timed(UnaryOp.HELD, formula, 0, duration)


def two(left: Formula, op: str, right: Formula, *interval: int | None) -> Formula:
    """`left op right`; a temporal operator may be given `low` and `high`.

    >>> two(p, "U", q, 0, 3).interval
    Interval(low=0, high=3)
    """
    found = BinaryOp.of(op)
    if found.entry.window is Window.NONE:
        return Binary(found, left, right)
    low, high = interval if interval else (0, None)
    return Binary(found, left, right, Interval(low or 0, high))


def with_operands(formula: Formula, change: Callable[[Formula], Formula]) -> Formula:
    """The formula with its operands changed; a proposition as it is."""
    match formula:
        case Unary(operand=operand):
            return replace(formula, operand=change(operand))
        case Binary(left=left, right=right):
            return replace(formula, left=change(left), right=change(right))
        case _:
            return formula


def scaled(formula: Formula, factor: int) -> Formula:
    """The formula with all its bounds so many times as large."""
    formula = with_operands(formula, lambda operand: scaled(operand, factor))
    if isinstance(formula, Unary | Binary) and (window := formula.interval) is not None:
        high = None if window.high is None else window.high * factor
        return replace(formula, interval=Interval(window.low * factor, high))
    return formula


def compared(left: Numeric, op: str, right: Numeric | float | str) -> Formula:
    """`left op right` of numbers or labels."""
    other = Literal(right) if isinstance(right, int | float | str) else right
    return Compare(CompareOp(op), left, other)


def probe(which: str, name: str) -> Formula:
    """`known(name)`, `updated(name)` or `changed(name)`."""
    return ProbeAtom(Probe(which), name)


def requirement(
    consequent: Formula,
    *,
    upon: Formula | None = None,
    whenever: Formula | None = None,
    name: str = "R",
    **rest: Any,
) -> Requirement:
    """A requirement; `upon start` if no trigger is given."""
    mode = Mode.UPON if whenever is None else Mode.WHENEVER
    trigger = upon or whenever or start
    return Requirement(name, mode, trigger, consequent, pulse=is_pulse(trigger), **rest)


def spec_of(
    *requirements: Requirement,
    time: TimeModel = TimeModel.HELD,
    period: int | None = None,
    stale: Mapping[str, int] | None = None,
    ignoring: Container[str] = (),
) -> CheckedSpec:
    """A specification over the test vocabulary."""
    return CheckedSpec(
        name="test",
        title="",
        time=time,
        signals=signals(stale, ignoring),
        events=events(),
        requirements={found.id: found for found in requirements},
        period=period,
    )


def spec_over(
    kinds: Mapping[str, Kind | None], requirement: Requirement, time: TimeModel
) -> CheckedSpec:
    """A specification of one requirement over these signals alone; a kind of `None`: an event."""
    signals = {name: Signal(name, Type(kind)) for name, kind in kinds.items() if kind is not None}
    events = {name: Event(name) for name, kind in kinds.items() if kind is None}
    return CheckedSpec("test", "", time, signals, events, {requirement.id: requirement})


def timeline(**rows: str) -> tuple[Sample, ...]:
    """Samples from one row of characters per name, one character per tick from 0.

    `.` says nothing; `u` is `None`, `n` NaN. For booleans and events `1` and `0`; for numbers a
    digit; for the label its first letter; for the event with a payload a digit, which is its
    field, `t`: it occurs without a payload, `v`: with the field `None`.
    """
    samples = []
    for t in range(max(map(len, rows.values()), default=0)):
        row_at = {name: row[t] for name, row in rows.items() if t < len(row) and row[t] != "."}
        if row_at:
            samples.append(Sample(t, {name: _value(name, c) for name, c in row_at.items()}))
    return tuple(samples)


def actions(text: str) -> tuple[Sample | int, ...]:
    """What a monitor is given, in few words: instants with what is so, `!` behind an `advance`.

    `p` is true or occurs, `-p` is false, `?p` unknown; `x=2.5` is a number, and `g=1` an event with
    that field, `g=1/0` with two, `g=?` with one that is unknown, `g=1,2` twice.

    >>> actions("0 p -q x=1; 4!; 9 ?p g=3")[0].values
    {'p': True, 'q': False, 'x': 1.0}
    """
    found: list[Sample | int] = []
    for one in text.split(";"):
        instant, *words = one.split()
        if instant.endswith("!"):
            found.append(int(instant[:-1]))
        else:
            found.append(Sample(int(instant), dict(map(_said, words))))
    return tuple(found)


def _said(word: str) -> tuple[str, Value]:
    name, sign, text = word.partition("=")
    if not sign:
        return name.lstrip("-?"), {"-": False, "?": None}.get(name[0], True)
    if name in (*NUMBERS, "z", "unread"):
        return name, float(text)
    payloads = [
        {
            field: None if one == "?" else int(one)
            for field, one in zip("km", own.split("/"), strict=False)
            if one
        }
        for own in text.split(",")
    ]
    return name, payloads[0] if len(payloads) == 1 else tuple(payloads)


def _value(name: str, character: str) -> Value:
    match character:
        case "u":
            return None
        case "n":
            return float("nan")
    if name in NUMBERS:
        return int(character)
    if name == LABEL:
        return next(label for label in LABELS if label[0] == character)
    if name == CARRIER and character == "v":
        return {FIELD: None}
    if name == CARRIER and character.isdigit():
        return {FIELD: int(character)}
    return character in "1t"
