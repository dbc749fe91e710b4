"""Checks a requirement: from its syntax to trigger, consequent and clauses."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeVar

from msgspec.structs import replace

from rvmon.diagnostics import Span
from rvmon.language.check import normalise
from rvmon.language.check.coverage import present
from rvmon.language.check.ctl import linear_form, property_of
from rvmon.language.check.expressions import Checker
from rvmon.language.check.moving_windows import refuse_moving
from rvmon.language.check.quantities import node_of
from rvmon.language.check.scope import EVERYWHERE, AtTrigger, Moment, Now, Quantity, Scope, typed
from rvmon.language.check.traps import (
    at_start_by_mistake,
    capture_traps,
    on_purpose,
    traps_at_start,
    traps_at_trigger,
)
from rvmon.language.checked import classify
from rvmon.language.checked import formula as rv
from rvmon.language.checked import specification as spec
from rvmon.language.checked.names_read import names_read
from rvmon.language.checked.properties import Property
from rvmon.language.rules import Refusal, Reported, short
from rvmon.language.rules import names as name_rules
from rvmon.language.rules import requirements as rules
from rvmon.language.rules import types as type_rules
from rvmon.language.syntax import items
from rvmon.language.syntax.expressions import Ident, ungrouped
from rvmon.units import PLAIN

_C = TypeVar("_C", bound=items.Clause)

Parts = tuple[spec.Mode, rv.Formula, rv.Formula]  # mode, trigger and consequent


def checked_requirement(checker: Checker, item: items.RequirementItem) -> spec.Requirement:
    """Check a requirement.

    Raises:
        Refusal: it has an error.
        Reported: it has an error that is already recorded.
    """
    policy = _policy(checker, item)
    share = _run_share(checker, item)
    for_each, outer = _instances(checker, item)
    captures, inner = _captures(checker, item, outer)
    ctl = property_of(checker, item)
    trigger = AtTrigger()
    parts = _parts(checker, item, outer, replace(inner, trigger=trigger), ctl)
    mode, when, consequent = _scoped(checker, item, outer, parts)
    if for_each is not None:
        _refuse_fields_in_sums((when, consequent), item.span)
    _warn_of_traps(checker, item, parts, captures)
    texts = {clause.word: clause.text for clause in _clauses(item, items.TextClause)}
    scopes = [clause.span.text for clause in _clauses(item, items.ScopeClause)]
    # The findings of the trigger were collected in `_parts`, while checking the consequent.
    return spec.Requirement(
        item.name.text, mode, when, consequent, item.text, at_end=policy,
        pulse=classify.is_pulse(when), captures=(*captures, *trigger.captures), for_each=for_each,
        source=texts.get("source", ""), rationale=texts.get("rationale", ""),
        severity=texts.get("severity", ""), span=item.span, ctl=ctl,
        tags=tuple(tag for clause in _clauses(item, items.TagsClause) for tag in clause.tags),
        scope=scopes[0] if scopes else "", run_share=share,
    )  # fmt: skip


def _refuse_fields_in_sums(formulas: Iterable[rv.Formula], place: Span) -> None:
    """Refuse windows over fields if it cannot be decided for each occurrence whether it counts.

    With `for each`, several occurrences of an event may coincide. So the number may read fields of
    one event only, and conditions on its fields must be conjuncts (`WindowValue.chosen`).
    """
    for window in classify.windows_of(*formulas):
        events = {value.event for value in rv.fields_in(window.value)} if window.value else None
        if not events:
            continue
        others = (
            part
            for part in classify.subformulas(window.operand)
            if isinstance(part, rv.Compare) and not part.left == part.right == window.value
        )
        if len(events) > 1 or any(not events.isdisjoint(names_read(part)) for part in others):
            raise Refusal(type_rules.sum_of_instances(window.operand.span or place))


def check_clauses(checker: Checker, item: items.RequirementItem) -> None:
    """Report repeated clauses, and local names that are already taken."""
    first: dict[str, Span] = {}
    named: dict[str, Ident] = {}
    for clause in item.clauses:
        if isinstance(clause, items.LetClause | items.ForEachClause):
            _check_name(checker, clause.name, named)
        word = clause.span.text.split(maxsplit=1)[0]
        if word == "let":
            continue
        if word in first:
            checker.report(rules.double_clause(word, clause.span, first[word]))
        first.setdefault(word, clause.span)


def _check_name(checker: Checker, name: Ident, named: dict[str, Ident]) -> None:
    """Report a local name that equals a name of the file or an earlier one of the requirement."""
    declared = checker.table.declared.get(name.text)
    taken = named.setdefault(name.text, name) if declared is None else declared.name
    if taken is not name:
        checker.report(name_rules.double(name.text, "name", name.span, taken.span))


def _parts(
    checker: Checker, item: items.RequirementItem, outer: Scope, inner: Scope, ctl: Property | None
) -> Parts:
    match item.body:
        case items.Bare(formula=expression):
            # The trigger of a bare formula is known only after normalisation.
            formula = checker.top(expression, replace(inner, trigger=None))
            if formula is None:
                raise Reported
            if end := classify.end_part(formula):
                raise Refusal(rules.end_not_alone(end.span or expression.span))
            if at_start_by_mistake(expression, formula):
                checker.report(rules.bare_instant(ungrouped(expression).span))
            return normalise.normalised(formula)
        case items.Triggered():
            return _triggered(checker, item.body, outer, inner)
        case items.ResponseMonitor(within=within, span=span):
            ticks = checker.duration(within, EVERYWHERE)
            if ctl is None:
                raise Refusal(rules.no_property(span))
            return spec.Mode.UPON, *normalise.derived_response(checker.table, ctl, ticks, span)
        case items.WrittenMonitor(span=span):
            if ctl is None:
                raise Refusal(rules.nothing_written(span))
            return normalise.normalised(linear_form(ctl, span, checker.table.time))
        case items.CoverMonitor():
            raise AssertionError("a goal is no requirement")


def _scoped(checker: Checker, item: items.RequirementItem, outer: Scope, parts: Parts) -> Parts:
    """Mode, trigger and consequent, restricted to the `scope` clause."""
    mode, trigger, consequent = parts
    for clause in _clauses(item, items.ScopeClause):
        ends = [
            None if expression is None else present(checker.formula(expression, outer))
            for expression in (clause.opening, clause.closing)
        ]
        if classify.end_part(trigger):
            raise Refusal(rules.end_in_scope(clause.span))
        required = normalise.scoped_consequent(consequent, ends[1], must_close=clause.must_close)
        return mode, normalise.scoped_trigger(trigger, *ends), required
    return parts


def _triggered(checker: Checker, body: items.Triggered, outer: Scope, inner: Scope) -> Parts:
    trigger = checker.top(body.trigger, outer)
    at_once = replace(inner, at_once=body.mode is spec.Mode.UPON)
    consequent = checker.top(body.consequent, at_once)
    if trigger and (ahead := classify.future_part(trigger)):
        checker.report(rules.future_trigger(ahead.span or body.trigger.span))
        raise Reported
    if trigger is None or consequent is None:
        raise Reported
    alone = isinstance(trigger, rv.BoundAtom) and body.mode is spec.Mode.UPON
    for formula, place in ((trigger, body.trigger), (consequent, body.consequent)):
        end = classify.end_part(formula)
        if end and not (alone and formula is trigger):
            raise Refusal(rules.end_not_alone(end.span or place.span))
    _warn(checker, body, trigger, consequent)
    return body.mode, trigger, consequent


def _warn(
    checker: Checker, body: items.Triggered, trigger: rv.Formula, consequent: rv.Formula
) -> None:
    instant = (
        body.mode is spec.Mode.UPON
        and not classify.is_end(trigger)
        and classify.is_timeless(consequent)
    )
    if instant and not on_purpose(body.consequent):
        checker.report(rules.one_instant(body.consequent.span))
    if mixed := classify.mixed_disjunction(trigger):
        pulse, level = (part.span or body.trigger.span for part in mixed)
        checker.report(rules.mixed_trigger(pulse, level, short(level.text)))


def _warn_of_traps(
    checker: Checker, item: items.RequirementItem, parts: Parts, captures: Iterable[spec.Capture]
) -> None:
    mode, trigger, consequent = parts
    time = checker.table.time
    traps = [*traps_at_trigger(trigger, consequent, time, item.span)]
    if not any(_clauses(item, items.ScopeClause)):  # a scope moves the start to its opening
        traps += traps_at_start(mode, trigger, consequent, item.span)
    lets = zip(_clauses(item, items.LetClause), captures, strict=True)
    traps += capture_traps(mode, trigger, lets, time)
    for diagnostic in traps:
        checker.report(diagnostic)


def _policy(checker: Checker, item: items.RequirementItem) -> spec.EndPolicy:
    policies = [str(policy) for policy in spec.EndPolicy]
    for clause in _clauses(item, items.AtEndClause):
        if clause.policy.text in policies:
            return spec.EndPolicy(clause.policy.text)
        checker.report(rules.unknown_policy(clause.policy.span, policies))
    return spec.EndPolicy.DEFAULT


def _run_share(checker: Checker, item: items.RequirementItem) -> spec.RunShare | None:
    for clause in _clauses(item, items.RunShareClause):
        number = clause.share
        if number.value is not None and number.unit == "%" and 0 < number.value < 100:
            return spec.RunShare(clause.at_least, float(number.value))
        checker.report(rules.bad_run_share(number.span))
    return None


def _instances(checker: Checker, item: items.RequirementItem) -> tuple[spec.ForEach | None, Scope]:
    """The `for each` clause, and the scope of the trigger, which has its name."""
    for clause in _clauses(item, items.ForEachClause):
        field = checker.table.field(clause.field.text)
        if field is None:
            # If the name is undeclared, this reports it with a suggestion.
            checker.values((clause.field,), EVERYWHERE)
            raise Refusal(type_rules.argument_kind(clause.field.span, "for each", "an event.field"))
        value, type_ = field
        unit = checker.table.units.get(clause.field.text, PLAIN)
        local = typed(rv.Captured(clause.name.text), type_, unit)
        return spec.ForEach(clause.name.text, value), Scope({clause.name.text: local})
    return None, EVERYWHERE


def _captures(
    checker: Checker, item: items.RequirementItem, outer: Scope
) -> tuple[tuple[spec.Capture, ...], Scope]:
    """The `let` clauses, and the scope of the consequent with their names and `for each`'s."""
    captures = []
    values, names = dict(outer.names), dict(outer.names)
    for clause in _clauses(item, items.LetClause):
        (value,) = checker.values((clause.value,), Scope(values))
        if value == Now():
            captures.append(spec.Capture(clause.name.text, rv.NowValue()))
            names[clause.name.text] = Moment(clause.name.text)
            continue
        if not isinstance(value, Quantity):
            raise Refusal(type_rules.needs_number(clause.value.span))
        node = node_of((value, clause.value.span))
        refuse_moving(checker.table.time, node, clause.value.span)
        captures.append(spec.Capture(clause.name.text, node))
        # A later `let` is evaluated at the same instant, so it reads the value itself. Only the
        # consequent has to read the captured one.
        values[clause.name.text] = value
        names[clause.name.text] = replace(value, node=rv.Captured(clause.name.text), constant=None)
    return tuple(captures), Scope(names)


def _clauses(item: items.RequirementItem, kind: type[_C]) -> Iterable[_C]:
    return (clause for clause in item.clauses if isinstance(clause, kind))
