"""Words requirements in plain English, and lists facts on how they are judged."""

from __future__ import annotations

from typing import assert_never

from rvmon.core.monitors import machine_of
from rvmon.language.checked import formula as formulas
from rvmon.language.checked.classify import has_future
from rvmon.language.checked.formula import Literal as NumericLiteral
from rvmon.language.checked.operators import Tense
from rvmon.language.checked.rewrite import chain
from rvmon.language.checked.specification import EndPolicy, Mode, Requirement
from rvmon.language.print import format_duration, format_numeric
from rvmon.logic.automaton import Automaton
from rvmon.logic.formula import horizon
from rvmon.logic.state_formula import StateOp
from rvmon.logic.state_graph import graph_of
from rvmon.monitor.compile import CompiledRequirement
from rvmon.monitor.requirement_plans import planned_rule
from rvmon.texts import counted, listed

_PROBED = {
    formulas.Probe.KNOWN: ("is known", "is not known"),
    formulas.Probe.UPDATED: ("is updated", "is not updated"),
    formulas.Probe.CHANGED: ("gets another value", "gets no other value"),
}
_AT_END = {
    EndPolicy.DEFAULT: "",
    EndPolicy.STRICT: "What is undecided when the recording ends stays inconclusive.",
    EndPolicy.WEAK: "What is still open when the recording ends counts as met.",
    EndPolicy.STRONG: "What is still open when the recording ends counts as missed.",
    EndPolicy.PASS: "What is undecided when the recording ends passes.",
    EndPolicy.FAIL: "What is undecided when the recording ends fails.",
}


def requirement_in_words(requirement: Requirement) -> list[str]:
    """A requirement as sentences: trigger, consequent, captured values, policy at the end."""
    lines = [f"{_starts(requirement)}:", f"{_required(requirement)}."]
    lines += [
        f"`{capture.name}` is the value of {format_numeric(capture.value)} at the trigger."
        for capture in requirement.captures
        if capture.name != formulas.TRIGGERED
    ]
    if requirement.for_each is not None:
        each = requirement.for_each
        field = format_numeric(each.value)
        lines.append(f"This applies separately to each value `{each.name}` of {field}.")
    if end := _AT_END[requirement.at_end]:
        lines.append(end)
    if requirement.run_share is not None:
        lines.append(f"A campaign decides whether that is so {requirement.run_share}.")
    return lines


def _starts(requirement: Requirement) -> str:
    trigger = requirement.trigger
    match trigger:
        case formulas.BoundAtom(bound=formulas.Bound.START):
            return "Once, from the start of the recording"
        case formulas.BoundAtom(bound=formulas.Bound.END):
            return "Once, when the recording ends"
        case formulas.Constant(value=True) if requirement.mode is Mode.WHENEVER:
            return "At every instant of the recording"
        case _:
            pass
    if requirement.mode is Mode.WHENEVER:
        return f"At every instant at which {in_words(trigger)}"
    if requirement.pulse:
        return f"Each time that {in_words(trigger)}"
    return f"Each time that it becomes true that {in_words(trigger)}"


def _required(requirement: Requirement) -> str:
    text = in_words(requirement.consequent)
    at_once = requirement.mode is Mode.UPON and not has_future(requirement.consequent)
    return f"at that very instant, {text}" if at_once else text


def in_words(formula: formulas.Formula, *, positive: bool = True) -> str:
    """A formula, or its negation, as an English clause.

    >>> never = formulas.Unary(formulas.UnaryOp.NOT, formulas.EventAtom("released"))
    >>> window = formulas.Interval(0, 2 * 10**9)
    >>> in_words(formulas.Unary(formulas.UnaryOp.ALWAYS, never, window))
    'for 2 s, released does not occur'
    """
    match formula:
        case formulas.Constant(value=value):
            return "nothing is required" if value is positive else "the impossible is required"
        case formulas.SignalAtom(name=name):
            return f"{name} is {'true' if positive else 'false'}"
        case formulas.EventAtom(name=name):
            return f"{name} occurs" if positive else f"{name} does not occur"
        case formulas.Compare(left=left, right=NumericLiteral(value=bool())):  # a field of truth
            return f"{format_numeric(left)} is {'true' if positive else 'false'}"
        case formulas.Compare(op=op, left=left, right=right):
            verb = (op if positive else op.denied).wording
            return f"{format_numeric(left)} {verb} {format_numeric(right)}"
        case formulas.ProbeAtom(probe=probe, name=name):
            return f"{name} {_PROBED[probe][0 if positive else 1]}"
        case formulas.BoundAtom(bound=bound):
            what = "the first instant" if bound is formulas.Bound.START else "the last instant"
            return f"it is {'' if positive else 'not '}{what}"
        case formulas.Unary(op=formulas.UnaryOp.NOT, operand=operand):
            return in_words(operand, positive=not positive)
        case formulas.Unary(
            op=formulas.UnaryOp.ONCE,
            operand=formulas.Binary(
                left=formulas.ProbeAtom(probe=formulas.Probe.UPDATED, name=name),
                right=formulas.BoundAtom(bound=formulas.Bound.START),
            ),
        ) if length := _age(formula.interval):
            verb = "was updated in the last" if positive else "has not been updated for"
            return f"{name} {verb} {length}"
        case formulas.Binary(op=formulas.BinaryOp.AND | formulas.BinaryOp.OR as op):
            word = "and" if (op is formulas.BinaryOp.AND) is positive else "or"
            return listed([_clause(part, positive) for part in chain(formula, op)], word)
        case formulas.Unary() | formulas.Binary():
            return _by_entry(formula, positive)
        case formulas.Amount():
            return _amount(formula, positive)
        case formulas.Passed(since=since, after=after, strict=strict):
            op = formulas.CompareOp.GT if strict else formulas.CompareOp.GE
            verb = (op if positive else op.denied).wording
            instants = {None: "the first instant", formulas.TRIGGERED: "the trigger"}
            return f"the time since {instants.get(since, since)} {verb} {format_numeric(after)}"
        case _:
            assert_never(formula)


def _amount(formula: formulas.Amount, positive: bool) -> str:
    of = formula.of
    parts = chain(of.counted or of.operand)
    chosen = [
        part
        for part in parts
        if not (isinstance(part, formulas.Passed) and part.since == formulas.TRIGGERED)
    ]
    back = "so far" if len(chosen) == len(parts) else "since the trigger"
    back = back if of.window is None else f"in the last {format_duration(of.window)}"
    back = back if of.most is None else f"at the last {of.most} updates"
    clauses = [_clause(one, True) for one in chosen] or ["time passes"]
    what = clauses[0] if len(clauses) == 1 else f"({listed(clauses, 'and')})"
    known = "" if positive else "not "
    least = formula.limit.value if isinstance(formula.limit, NumericLiteral) else None
    if isinstance(least, int) and of.value is None:
        counts = of.measured is formulas.Measured.COUNT
        often = f"{least} times" if counts else format_duration(least)
        often = f"more than {often}" if formula.strict else f"{often} or more"
        return f"{'' if counts else 'for '}{known}{often} {back}, {what}"
    op = formulas.CompareOp.GT if formula.strict else formulas.CompareOp.GE
    verb = (op if positive else op.denied).wording
    if of.value is None or isinstance(of.value, NumericLiteral):  # a count, or a sum of constants
        often = "for how long" if of.measured.of_time else "how often"
        amount = f"{often} {what} {back}"
    else:
        amount = f"the {of.measured} of {format_numeric(of.value)} {back}"
    return f"{amount} {verb} {format_numeric(formula.limit)}"


def _by_entry(formula: formulas.Unary | formulas.Binary, positive: bool) -> str:
    """An operator formula in the wording of the operator table."""
    entry = formula.op.entry
    text = entry.wording if positive else entry.denied or f"not so: {entry.wording}"
    return text.format_map(_Parts(formula))


class _Parts(dict[str, str]):
    """The placeholders in the wording of an operator, computed on access."""

    def __init__(self, formula: formulas.Unary | formulas.Binary) -> None:
        super().__init__()
        self._formula = formula
        self._interval = formula.interval or formulas.Interval()

    def __missing__(self, part: str) -> str:
        past = self._formula.op.entry.tense is Tense.PAST
        match part:
            case "some" | "all":
                return _window(self._interval, some=part == "some", past=past)
            case "ago" if self._interval == formulas.Interval():
                return "once "
            case "ago":
                return f"({_window(self._interval, some=True, past=True)}) "
            case "length":
                return format_duration(self._interval.high or 0)
            case "begins" | "ends":
                return _begins(self._operand("it"), part == "begins")
            case _:
                name = part.removeprefix("no_")
                return _clause(self._operand(name), name == part)

    def _operand(self, name: str) -> formulas.Formula:
        operand: formulas.Formula = getattr(self._formula, "operand" if name == "it" else name)
        return operand


def _age(interval: formulas.Interval | None) -> str:
    """The length of a window [0, D], as in the formula of an age; "" for any other window."""
    if interval is None or interval.low or interval.high is None:
        return ""
    return format_duration(interval.high)


def _begins(operand: formulas.Formula, positive: bool) -> str:
    if isinstance(operand, formulas.SignalAtom):
        return f"{operand.name} becomes {'true' if positive else 'false'}"
    return f"it becomes true that {_clause(operand, positive)}"


_EVER = ("always from then on", "at some time"), ("all the time so far", "at some time so far")
_WITHIN = ("for", "within"), ("all the time in the last", "at some time in the last")
"""Windows without bounds, and with an upper bound: of `G` and `F`, then of `H` and `O`."""


def _window(interval: formulas.Interval, *, some: bool, past: bool) -> str:
    """The window of `F` and `O` (`some`), or `G` and `H`, relative to the present."""
    low, high, off = interval.low, interval.high, "ago" if past else "later"
    if high is None:
        return _EVER[past][some] + (f", {format_duration(low)} {off} or more" if low else "")
    if high == low and not past:
        return f"exactly {format_duration(low)} later" if low else "at once"
    if not low:
        return f"{_WITHIN[past][some]} {format_duration(high)}"
    how = "at some time" if some else "all the time from"
    return f"{how} {format_duration(low)} to {format_duration(high)} {off}"


def _clause(formula: formulas.Formula, positive: bool) -> str:
    """A formula inside another one, in brackets unless it is a simple clause."""
    text = in_words(formula, positive=positive)
    inner = formula
    while isinstance(inner, formulas.Unary) and inner.op is formulas.UnaryOp.NOT:
        inner = inner.operand
    plain = not isinstance(inner, formulas.Binary) and not (
        isinstance(inner, formulas.Unary) and ", " in text
    )
    return text if plain else f"({text})"


Facts = dict[str, str]


def facts_of(compiled: CompiledRequirement) -> Facts:
    """Facts on how a requirement is judged, by heading; empty facts are left out."""
    machine = machine_of(planned_rule(compiled), compiled.gap)
    automaton = compiled.automaton if isinstance(machine, Automaton) else None
    chained = not isinstance(machine, Automaton) and machine[1] is not None
    facts = {
        "judged by": _judge(compiled, automaton, chained=chained),
        "decided": _decided(compiled),
        "memory": _memory(compiled, automaton),
    }
    one = compiled.requirement
    facts |= {"looks back": _past(compiled), "source": one.source, "rationale": one.rationale}
    facts |= {"severity": one.severity, "tags": ", ".join(one.tags)}
    return {heading: fact for heading, fact in facts.items() if fact}


def _judge(compiled: CompiledRequirement, automaton: Automaton | None, *, chained: bool) -> str:
    if automaton is None:
        kind = "windows" if chained else "delay network"
        if compiled.automaton is not None:
            return f"{kind}: its automaton would step open attempts one by one, not all at once"
        return f"{kind}: as an automaton it would have {compiled.refusal}"
    return (
        f"automaton of {counted(len(automaton.locations), 'location')}, "
        f"{counted(automaton.clocks, 'clock')}, "
        f"{counted(automaton.classes, 'class', 'classes')} of inputs"
    )


def _decided(compiled: CompiledRequirement) -> str:
    reach = horizon(compiled.obligation.required)
    if reach is None:
        return "no bound: it may stay open until the recording ends"
    return f"{format_duration(reach)} after its trigger at the latest" if reach else "at once"


def _memory(compiled: CompiledRequirement, automaton: Automaton | None) -> str:
    if automaton is None:
        reach = horizon(compiled.obligation.required)
        span = "while an attempt is open" if reach is None else f"over {format_duration(reach)}"
        return f"where its parts are known to hold or not, a stretch per change, {span}"
    one = compiled.requirement
    alone = one.mode is Mode.WHENEVER or one.captured
    if compiled.obligation.trigger is not None and not alone:
        return "16 bytes per open attempt, in runs: those that wait alike take one step together"
    stamps = f", {counted(automaton.clocks, 'time stamp')}" if automaton.clocks else ""
    return f"per open attempt its location{stamps}"


def _past(compiled: CompiledRequirement) -> str:
    """The reach of a requirement's past operators, in words."""
    trigger = compiled.obligation.trigger
    states = [*compiled.alphabet.propositions, *([] if trigger is None else [trigger])]
    nodes = graph_of(states).nodes
    since = [node for node in nodes if node.op is StateOp.SINCE]
    if not since:
        steps = any(node.op is StateOp.PREVIOUS for node in nodes)
        return "to the position before" if steps else ""
    bounds = [node.high for node in since if node.high is not None]
    if len(bounds) < len(since):
        return "over the whole past"
    return f"over the last {format_duration(sum(bounds) if len(bounds) > 1 else bounds[0])} at most"
