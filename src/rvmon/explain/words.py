"""Requirements in plain English: when an attempt starts, and what is owed then."""

from __future__ import annotations

from typing import assert_never

from rvmon.spec.checked.formula import (
    Binary,
    BinaryOp,
    Bound,
    BoundAtom,
    Compare,
    CompareOp,
    Constant,
    EventAtom,
    Formula,
    Interval,
    Probe,
    ProbeAtom,
    SignalAtom,
    Unary,
    UnaryOp,
)
from rvmon.spec.checked.specification import EndPolicy, Mode, Requirement
from rvmon.spec.print.printer import format_duration, format_numeric

_COMPARED = {
    CompareOp.LT: "is below",
    CompareOp.LE: "is at most",
    CompareOp.EQ: "is",
    CompareOp.NE: "is not",
    CompareOp.GE: "is at least",
    CompareOp.GT: "is above",
}
_OPPOSITE = {
    CompareOp.LT: CompareOp.GE,
    CompareOp.LE: CompareOp.GT,
    CompareOp.EQ: CompareOp.NE,
    CompareOp.NE: CompareOp.EQ,
    CompareOp.GE: CompareOp.LT,
    CompareOp.GT: CompareOp.LE,
}
_PROBED = {
    Probe.KNOWN: ("is known", "is not known"),
    Probe.UPDATED: ("is updated", "is not updated"),
    Probe.CHANGED: ("gets another value", "gets no other value"),
}
_AT_END = {
    EndPolicy.DEFAULT: "",
    EndPolicy.STRICT: "What is undecided when the recording ends stays inconclusive.",
    EndPolicy.WEAK: "What is still open when the recording ends counts as met.",
    EndPolicy.STRONG: "What is still open when the recording ends counts as missed.",
    EndPolicy.PASS: "What is undecided when the recording ends passes.",
    EndPolicy.FAIL: "What is undecided when the recording ends fails.",
}
_TEMPORAL = (
    UnaryOp.NEXT,
    UnaryOp.EVENTUALLY,
    UnaryOp.ALWAYS,
    BinaryOp.UNTIL,
    BinaryOp.RELEASE,
    BinaryOp.WEAK_UNTIL,
    BinaryOp.STRONG_RELEASE,
)


def requirement_in_words(requirement: Requirement) -> list[str]:
    """Sentences: when an attempt starts, what is owed, what is captured, what the end does."""
    lines = [f"{_starts(requirement)}:", f"{_owed(requirement)}."]
    lines += [
        f"There, `{capture.name}` is what {format_numeric(capture.value)} was when it started."
        for capture in requirement.captures
    ]
    if requirement.for_each is not None:
        each = requirement.for_each
        field = format_numeric(each.value)
        lines.append(f"All this for each value `{each.name}` of {field} by itself.")
    end = _AT_END[requirement.at_end]
    return [*lines, end] if end else lines


def _starts(requirement: Requirement) -> str:
    trigger = requirement.trigger
    match trigger:
        case BoundAtom(bound=Bound.START):
            return "Once, from the start of the recording"
        case BoundAtom(bound=Bound.END):
            return "Once, when the recording ends"
        case Constant(value=True) if requirement.mode is Mode.WHENEVER:
            return "At every instant of the recording"
        case _:
            pass
    if requirement.mode is Mode.WHENEVER:
        return f"At every instant at which {in_words(trigger)}"
    if requirement.pulse:
        return f"Each time that {in_words(trigger)}"
    return f"Each time that it begins to be so that {in_words(trigger)}"


def _owed(requirement: Requirement) -> str:
    text = in_words(requirement.consequent)
    at_once = requirement.mode is Mode.UPON and not _is_temporal(requirement.consequent)
    return f"at that very instant, {text}" if at_once else text


def _is_temporal(formula: Formula) -> bool:
    match formula:
        case Unary(op=op, operand=operand):
            return op in _TEMPORAL or _is_temporal(operand)
        case Binary(op=op, left=left, right=right):
            return op in _TEMPORAL or _is_temporal(left) or _is_temporal(right)
        case _:
            return False


def in_words(formula: Formula, *, positive: bool = True) -> str:
    """A formula, or its negation, as an English clause.

    >>> released = EventAtom("released")
    >>> in_words(Unary(UnaryOp.ALWAYS, Unary(UnaryOp.NOT, released), Interval(0, 2 * 10**9)))
    'for 2 s, released does not occur'
    """
    match formula:
        case Constant(value=value):
            return "nothing is asked" if value is positive else "the impossible is asked"
        case SignalAtom(name=name):
            return f"{name} is {'true' if positive else 'false'}"
        case EventAtom(name=name):
            return f"{name} occurs" if positive else f"{name} does not occur"
        case Compare(op=op, left=left, right=right):
            verb = _COMPARED[op if positive else _OPPOSITE[op]]
            return f"{format_numeric(left)} {verb} {format_numeric(right)}"
        case ProbeAtom(probe=probe, name=name):
            return f"{name} {_PROBED[probe][0 if positive else 1]}"
        case BoundAtom(bound=bound):
            what = "the first instant" if bound is Bound.START else "the last instant"
            return f"it is {'' if positive else 'not '}{what}"
        case Unary():
            return _unary(formula, positive)
        case Binary():
            return _binary(formula, positive)
        case _:
            assert_never(formula)


def _unary(formula: Unary, positive: bool) -> str:
    op, interval = formula.op, formula.interval or Interval()
    operand = formula.operand
    match op:
        case UnaryOp.NOT:
            return in_words(operand, positive=not positive)
        case UnaryOp.NEXT:
            return f"at the next sample, {_clause(operand, positive)}"
        case UnaryOp.PREVIOUS:
            before = f"at the sample before, {_clause(operand, True)}"
            return before if positive else f"not so: {before}"
        case UnaryOp.EVENTUALLY | UnaryOp.ALWAYS:
            some = (op is UnaryOp.EVENTUALLY) is positive
            return f"{_ahead(interval, some=some)}, {_clause(operand, positive)}"
        case UnaryOp.ONCE if _is_age(operand, interval):
            name = operand.name if isinstance(operand, ProbeAtom) else ""
            span = format_duration(interval.high or 0)
            verb = "was updated in the last" if positive else "has not been updated for"
            return f"{name} {verb} {span}"
        case UnaryOp.ONCE | UnaryOp.HISTORICALLY:
            some = (op is UnaryOp.ONCE) is positive
            return f"{_back(interval, some=some)}, {_clause(operand, positive)}"
        case UnaryOp.RISE | UnaryOp.FALL:
            begins = _begins(operand, op is UnaryOp.RISE)
            return begins if positive else f"it is not the instant at which {begins}"
        case UnaryOp.HELD:
            so_long = f"for the last {format_duration(interval.high or 0)} without a break"
            return f"{'' if positive else 'not '}{so_long}, {_clause(operand, True)}"
        case _:
            assert_never(op)


def _is_age(operand: Formula, interval: Interval) -> bool:
    """Whether `once` of an update speaks of the age of a signal."""
    updated = isinstance(operand, ProbeAtom) and operand.probe is Probe.UPDATED
    return updated and not interval.low and interval.high is not None


def _begins(operand: Formula, positive: bool) -> str:
    if isinstance(operand, SignalAtom):
        return f"{operand.name} becomes {'true' if positive else 'false'}"
    return f"it becomes so that {_clause(operand, positive)}"


def _ahead(interval: Interval, *, some: bool) -> str:
    """The window of `F` or `G`, seen from its instant."""
    low, high = interval.low, interval.high
    if high is None:
        after = "" if not low else f", {format_duration(low)} later or more"
        return f"at some time{after}" if some else f"always from then on{after}"
    if high == low:
        return f"exactly {format_duration(low)} later" if low else "at once"
    if not low:
        return f"within {format_duration(high)}" if some else f"for {format_duration(high)}"
    window = f"{format_duration(low)} to {format_duration(high)} later"
    return f"at some time {window}" if some else f"all the time from {window}"


def _back(interval: Interval, *, some: bool) -> str:
    """The window of `O` or `H`, seen from its instant."""
    low, high = interval.low, interval.high
    if high is None:
        before = "" if not low else f", {format_duration(low)} ago or more"
        return f"at some time so far{before}" if some else f"all the time so far{before}"
    if not low:
        last = f"in the last {format_duration(high)}"
        return f"at some time {last}" if some else f"all the time {last}"
    window = f"{format_duration(low)} to {format_duration(high)} ago"
    return f"at some time {window}" if some else f"all the time from {window}"


def _binary(formula: Binary, positive: bool) -> str:
    left, right = formula.left, formula.right
    match formula.op:
        case BinaryOp.AND | BinaryOp.OR:
            word = "and" if (formula.op is BinaryOp.AND) is positive else "or"
            parts = [_clause(part, positive) for part in _chain(formula, formula.op)]
            return _listed(parts, word)
        case BinaryOp.IMPLIES:
            if positive:
                return f"if {_clause(left, True)}, then {_clause(right, True)}"
            return f"{_clause(left, True)} but {_clause(right, False)}"
        case BinaryOp.IFF | BinaryOp.XOR:
            same = (formula.op is BinaryOp.IFF) is positive
            if same:
                return f"{_clause(left, True)} exactly if {_clause(right, True)}"
            return f"either {_clause(left, True)} or {_clause(right, True)}, not both"
        case BinaryOp.SINCE:
            since = f"{_clause(right, True)} {_ago(formula.interval)}and since then "
            whole = f"{since}{_clause(left, True)}"
            return whole if positive else f"not so: {whole}"
        case _:
            whole = _until(formula)
            return whole if positive else f"not so: {whole}"


def _ago(interval: Interval | None) -> str:
    if interval is None or interval == Interval():
        return "once "
    return f"({_back(interval, some=True)}) "


def _until(formula: Binary) -> str:
    left, right = _clause(formula.left, True), _clause(formula.right, True)
    when = _ahead(formula.interval or Interval(), some=True)
    keep = _ahead(formula.interval or Interval(), some=False)
    match formula.op:
        case BinaryOp.UNTIL:
            return f"{when}, {right}; and until then {left}"
        case BinaryOp.WEAK_UNTIL:
            return f"{keep}, {left}; until {right}, if that comes earlier"
        case BinaryOp.RELEASE:
            return f"{keep}, {right}; up to and at the instant when {left}, if that comes earlier"
        case BinaryOp.STRONG_RELEASE:
            return f"{when}, {left}; until then and at that instant {right}"
        case op:
            raise AssertionError(f"{op} was told above")


def _chain(formula: Formula, op: BinaryOp) -> list[Formula]:
    if isinstance(formula, Binary) and formula.op is op:
        return [*_chain(formula.left, op), *_chain(formula.right, op)]
    return [formula]


def _listed(parts: list[str], word: str) -> str:
    if len(parts) == 2:
        return f"{parts[0]} {word} {parts[1]}"
    return f"{', '.join(parts[:-1])} {word} {parts[-1]}"


def _clause(formula: Formula, positive: bool) -> str:
    """A formula inside another: in brackets unless it is a plain statement."""
    text = in_words(formula, positive=positive)
    inner = formula
    while isinstance(inner, Unary) and inner.op is UnaryOp.NOT:
        inner = inner.operand
    plain = not isinstance(inner, Binary) and not (isinstance(inner, Unary) and ", " in text)
    return text if plain else f"({text})"
