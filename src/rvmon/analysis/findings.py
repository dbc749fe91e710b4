"""Runs all analyses of a specification and reports the results as diagnostics."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence

from msgspec import Struct

from rvmon.analysis.conflicts import Conflict, ConflictSearch, Implication, implications_among
from rvmon.analysis.product import Together
from rvmon.analysis.vacuity import Possible, Subject, possible
from rvmon.diagnostics import Diagnostic, Label, Severity, Span
from rvmon.language.checked.classify import FUTURE, subformulas
from rvmon.language.checked.formula import Binary, BoundAtom, Constant, Formula, Unary
from rvmon.language.checked.specification import CheckedSpec, EndPolicy, Mode, Requirement
from rvmon.language.print import format_duration
from rvmon.language.rules import Rule, finding
from rvmon.texts import listed


class Examination(Struct, frozen=True):
    """The results of all analyses."""

    possible: Mapping[str, Possible]  # by requirement
    conflicts: tuple[Conflict, ...]  # minimal sets that cannot all hold
    implications: tuple[Implication, ...]  # requirements that others make superfluous
    # ids for which it was not decided whether they can trigger, fail and pass
    undecided: tuple[str, ...]
    pairs: int  # the number of pairs that read a common name
    pairs_undecided: int  # the number of these pairs not decided, or not reached in time
    sets_undecided: int  # the number of larger sets examined but not decided
    # all sets of up to this size were examined; `None` if those of any size were
    whole_sets: int | None
    implications_done: bool  # whether every requirement was tested for being implied


def examine(spec: CheckedSpec, subjects: Sequence[Subject], seconds: float) -> Examination:
    """Analyse requirements alone, then in pairs, then in larger sets, until the time is used up."""
    deadline = time.monotonic() + seconds
    results: dict[str, Possible] = {}
    for subject in subjects:
        if time.monotonic() > deadline:
            break
        requirement = subject.requirement
        results[subject.id] = possible(spec, subject.trigger, subject.automaton, requirement.at_end)
    undecided = tuple(
        subject.id
        for subject in subjects
        if (one := results.get(subject.id)) is None
        or (one.trigger is not False and None in (one.trigger, one.fail, one.pass_))
    )
    # A requirement that cannot pass is left out: it would conflict with all others, and imply them.
    sound = [subject for subject in subjects if _is_sound(subject, results)]
    together = Together(spec)
    search = ConflictSearch(together, sound, deadline)
    search.run()
    fallible = [subject for subject in sound if results[subject.id].fail is not False]
    implications, done = implications_among(together, sound, fallible, search.conflicts, deadline)
    return Examination(
        results,
        tuple(search.conflicts),
        tuple(implications),
        undecided,
        search.pairs,
        search.pairs_undecided,
        search.sets_undecided,
        search.whole_sets,
        done,
    )


def _is_sound(subject: Subject, results: Mapping[str, Possible]) -> bool:
    """Whether a requirement has an automaton and, as far as known, can trigger and pass alone."""
    result = results.get(subject.id)
    if result is None or subject.trigger is None or subject.automaton is None:
        return False
    return result.trigger is True and result.pass_ is True


def findings_of(spec: CheckedSpec, examination: Examination) -> list[Diagnostic]:
    """The diagnostics: single requirements in file order, then conflicts, then implications."""
    singles = [
        diagnostic
        for name in spec.requirements
        if name in examination.possible
        for diagnostic in _single(spec, examination, name)
    ]
    conflicts = [_conflict(spec, conflict) for conflict in examination.conflicts]
    implied = [_implied(spec, implication) for implication in examination.implications]
    return [*singles, *conflicts, *implied]


def _single(spec: CheckedSpec, examination: Examination, name: str) -> Iterator[Diagnostic]:
    can, place = examination.possible[name], _places(spec, name)
    if can.trigger is False:
        fix = "its trigger contradicts itself: look at the comparisons in it"
        yield finding(NEVER_TRIGGERS, f"nothing can trigger {name}", *place, fix=fix)
        return
    if can.fail is False:
        fix = _can_fail(spec.requirements[name])
        yield finding(NEVER_FAILS, f"{name} can never fail, whatever comes", *place, fix=fix)
    if can.pass_ is False:
        fix = _can_pass(spec.requirements[name])
        yield finding(NEVER_PASSES, f"{name} can never pass, whatever comes", *place, fix=fix)


def _implied(spec: CheckedSpec, implication: Implication) -> Diagnostic:
    implied, by = implication.implied, implication.by
    return finding(
        IMPLIED,
        f"{implied} fails only where {listed(by, 'or')} fails: it adds nothing",
        *_places(spec, implied, *by),
        fix=f"drop {implied}, or check whether it was meant differently",
    )


def _conflict(spec: CheckedSpec, conflict: Conflict) -> Diagnostic:
    first = conflict.ids[0]
    if set(conflict.ids) == {first}:
        again = format_duration(conflict.offsets[-1])
        message = f"{first} cannot hold once it is triggered again, {again} later"
        fix = "let it hold for a shorter time, or define what a second trigger means"
    else:
        both = "both" if len(conflict.ids) == 2 else "all"
        named = listed(conflict.ids, "and")
        later = ", ".join(_later(conflict))
        when = f", {later}" if later else " at one instant"
        message = f"{named} cannot {both} hold once they are triggered{when}"
        triggers = [spec.requirements[name].trigger for name in conflict.ids]
        triggered = not all(isinstance(one, Constant | BoundAtom) for one in triggers)
        narrow = "narrow one of the triggers" if triggered else "change a bound of one of them"
        fix = f"{narrow}, or settle which one yields"
    return finding(CONFLICT, message, *_places(spec, *dict.fromkeys(conflict.ids)), fix=fix)


def _can_fail(requirement: Requirement) -> str:
    """The advice for a requirement that can never fail."""
    if _has_no_end(requirement.consequent):
        return "give it a deadline with `within`, or write `at end: strong`"
    return "the consequent holds wherever it is evaluated: look at the comparisons in it"


def _has_no_end(formula: Formula) -> bool:
    """Whether a part of a formula is an unbounded future operator."""
    return any(
        isinstance(part, Unary | Binary)
        and part.op in FUTURE
        and (part.interval is None or part.interval.high is None)
        for part in subformulas(formula)
    )


def _can_pass(requirement: Requirement) -> str:
    """The advice for a requirement that can never pass."""
    policy = requirement.at_end
    is_open = requirement.mode is Mode.WHENEVER or _has_no_end(requirement.consequent)
    if policy in (EndPolicy.STRICT, EndPolicy.STRONG, EndPolicy.FAIL) and is_open:
        return (
            f"`at end: {policy}` lets nothing pass that is open at the end: leave it out, or say "
            "for how long with `for`"
        )
    return "the consequent contradicts itself or the trigger, whose instant is included"


def _later(conflict: Conflict) -> Iterator[str]:
    """The clauses for requirements that are triggered after the first one."""
    for name, offset in zip(conflict.ids, conflict.offsets, strict=True):
        if offset:
            yield f"{name} {format_duration(offset)} after {conflict.ids[0]}"


def _places(spec: CheckedSpec, *names: str) -> Iterator[Label]:
    for name in names:
        span = _head(spec.requirements[name])
        if span is not None:
            yield Label(span)


def _head(requirement: Requirement) -> Span | None:
    """The first line of a requirement."""
    span = requirement.span
    if span is None:
        return None
    first = span.text.split("\n", 1)[0].rstrip()
    return Span(span.source, span.start, span.start + len(first))


NEVER_TRIGGERS = Rule("RV070", "never-triggers", Severity.WARNING)
NEVER_FAILS = Rule("RV071", "never-fails", Severity.WARNING)
NEVER_PASSES = Rule("RV072", "never-passes", Severity.WARNING)
CONFLICT = Rule("RV073", "conflict", Severity.WARNING)
IMPLIED = Rule("RV074", "implied", Severity.WARNING)
