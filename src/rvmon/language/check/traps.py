"""Finds requirements whose own wording makes them fail, or captures values by mistake."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from rvmon.diagnostics import Diagnostic, Span
from rvmon.language.checked import formula as rv
from rvmon.language.checked.classify import (
    FIRST,
    Facts,
    facts_of,
    is_pulse,
    is_timeless,
    subformulas,
    truth_at,
)
from rvmon.language.checked.specification import Capture, Mode, TimeModel
from rvmon.language.print import format_duration, format_formula
from rvmon.language.rules import requirements as rules
from rvmon.language.syntax.expressions import Expression, Immediately, ungrouped
from rvmon.language.syntax.items import LetClause

_FIRST = "at the first instant"


def traps_at_trigger(
    trigger: rv.Formula, consequent: rv.Formula, time: TimeModel, span: Span
) -> Iterator[Diagnostic]:
    """Find parts that are required at the trigger and cannot hold there.

    Trigger and consequent are those before a scope is applied; `span` is the place to report for
    parts without one.
    """
    facts = {
        about: truth for about, truth in facts_of(trigger).items() if about is not rv.Bound.START
    }
    for part in _required_at_once(consequent):
        # Constant formulas are reported by the analysis.
        if truth_at(part, {}) is None:
            yield from _at_trigger(part, facts, time, part.span or span)


def traps_at_start(
    mode: Mode, trigger: rv.Formula, consequent: rv.Formula, span: Span
) -> Iterator[Diagnostic]:
    """Find parts that are required from the start of the run on and cannot hold there.

    Arguments as of `traps_at_trigger`.
    """
    always = mode is Mode.WHENEVER and isinstance(trigger, rv.Constant) and trigger.value
    if not always and not (isinstance(trigger, rv.BoundAtom) and trigger.bound is rv.Bound.START):
        return
    for part in _required_at_once(consequent):
        place = part.span or span
        if truth_at(part, {}) is not None:
            continue
        if always and isinstance(part, rv.Unary) and part.op.entry.pulse:
            fix = "an edge is one instant: say what follows it, `upon … then …`"
            when = "at the second instant at the latest" if part.op is rv.UnaryOp.RISE else _FIRST
            yield rules.false_at_first(place, when, fix)
        elif truth_at(part, FIRST) is False:
            yield rules.false_at_first(place, _FIRST, _later(part))


def capture_traps(
    mode: Mode, trigger: rv.Formula, captures: Iterable[tuple[LetClause, Capture]], time: TimeModel
) -> Iterator[Diagnostic]:
    """Find captures whose value is not the one that a reader expects."""
    occurring = {name for name, truth in facts_of(trigger).items() if truth}
    for clause, capture in captures:
        for field in rv.fields_in(capture.value):
            if field.event not in occurring:
                yield rules.no_value(clause.span, field.event)
                break
        else:
            if mode is Mode.WHENEVER and not (is_pulse(trigger) and time is TimeModel.HELD):
                shown = "" if isinstance(trigger, rv.Constant) else format_formula(trigger)
                yield rules.captured_once(clause.span, shown)


def _required_at_once(formula: rv.Formula) -> Iterator[rv.Formula]:
    """The parts of a required formula that must hold at the very instant it is required."""
    match formula:
        case rv.Binary(op=rv.BinaryOp.AND, left=left, right=right):
            yield from _required_at_once(left)
            yield from _required_at_once(right)
        case rv.Unary(op=rv.UnaryOp.ALWAYS, operand=operand, interval=window) if not (
            window and window.low
        ):
            yield from _required_at_once(operand)
        case _:
            yield formula


def _at_trigger(
    part: rv.Formula, facts: Facts, time: TimeModel, place: Span
) -> Iterator[Diagnostic]:
    """Report a required part that is false by the facts of the trigger."""
    if isinstance(part, rv.Binary) and part.op in (rv.BinaryOp.UNTIL, rv.BinaryOp.WEAK_UNTIL):
        left, right = truth_at(part.left, facts), truth_at(part.right, facts)
        late = part.interval is not None and part.interval.low > 0
        if left is False and (late or right is not True) and truth_at(part.left, {}) is None:
            escape = "" if late or right is False else format_formula(part.right)
            shown = format_formula(part.left)
            yield rules.false_at_trigger(place, shown, escape, _from_later_on(part, time))
    elif truth_at(part, facts) is False:
        fix = "let the consequent start a tick later: `always[1 ns, …] …`"
        if time is not TimeModel.HELD:
            fix = "let the consequent start at the next position: `next (…)`"
        yield rules.false_at_trigger(place, format_formula(part), "", fix)


def _from_later_on(part: rv.Binary, time: TimeModel) -> str:
    """The fix that lets `a until b` or `a unless b` start after the trigger."""
    if time is not TimeModel.HELD:
        return f"let it start at the next position: `next ({format_formula(part)})`"
    low, high = (part.interval.low, part.interval.high) if part.interval else (0, None)
    end = "inf)" if high is None else f"{format_duration(high)}]"
    left, right = _operand(part.left), _operand(part.right)
    later = f"{right} R[1 ns, {end} {left}"
    if part.op is rv.BinaryOp.UNTIL:
        window = "" if not low and high is None else f"[{format_duration(low)}, {end}"
        later = f"({later}) and eventually{window} {right}"
    return f"let it start a tick later: `{later}`"


def _later(part: rv.Formula) -> str:
    """The fix that requires a part only where there is enough past for it to look at."""
    due = max(map(_reach, subformulas(part)))
    if not due:
        return f"leave out the first instant: `start or {_operand(part)}`"
    start = format_duration(due)
    return f"let it start after that time: `always[{start}, inf) {_operand(part)}`"


def _reach(part: rv.Formula) -> int:
    """The ticks that must have passed before an operator of the past can be true."""
    match part:
        case rv.Unary(op=rv.UnaryOp.HELD, interval=window) if window is not None:
            return window.high or 0
        case (
            rv.Unary(op=rv.UnaryOp.ONCE, interval=rv.Interval(low=low))
            | rv.Binary(op=rv.BinaryOp.SINCE, interval=rv.Interval(low=low))
        ):
            return low
        case _:
            return 0


def _operand(formula: rv.Formula) -> str:
    """The text of a formula as an operand of a temporal operator."""
    text = format_formula(formula)
    is_call = isinstance(formula, rv.Unary) and formula.op.entry.called
    return text if is_call or isinstance(formula, rv.Atom) else f"({text})"


def at_start_by_mistake(expression: Expression, formula: rv.Formula) -> bool:
    """Whether a bare formula has no temporal operator and reads neither `start` nor `end`."""
    if on_purpose(expression) or not is_timeless(formula):
        return False
    return not any(isinstance(part, rv.BoundAtom) for part in subformulas(formula))


def on_purpose(expression: Expression) -> bool:
    """Whether the expression is marked by `immediately`, so that one instant is intended."""
    return isinstance(ungrouped(expression), Immediately)
