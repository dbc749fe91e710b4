"""The open attempts of a rule as numbers that its compiled counterpart goes on from, and back."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import islice
from typing import Any

from rvmon.codegen.c_online import NEVER as C_NEVER
from rvmon.formula.state import UNKNOWN
from rvmon.monitor.attempts.attempt_judge import Open
from rvmon.monitor.attempts.network_judge import WAITING, NetworkJudge
from rvmon.monitor.attempts.network_letters import Noted
from rvmon.monitor.online.unit_clerks import reopened
from rvmon.runtime.bulk import BulkRule, Run, packed, unpacked
from rvmon.runtime.rule import Rule
from rvmon.runtime.solo import SoloRule
from rvmon.runtime.table import next_cut
from rvmon.runtime.values import NEVER, PASSED


def bounded(word: int) -> int:
    """An instant as compiled code has it, where `NEVER` is its own."""
    return C_NEVER if word > C_NEVER else word


def instant(word: int) -> int:
    """An instant of compiled code."""
    return NEVER if word == C_NEVER else word


def signed(word: int) -> int:
    """A word of 64 bits, as it stands among numbers that have a sign."""
    return word - (1 << 64) if word >> 63 else word


def is_plain(rule: Rule) -> bool:
    """Whether no attempt of a rule is in doubt, or will be."""
    if rule.hidden:
        return not (rule.attempts or rule.running or rule.watches or rule.before == UNKNOWN)
    if rule.clouded or rule.looking or rule.before == UNKNOWN:
        return False
    if any(
        not one.sure or one.clouded or one.void or one.better or one.doubt for one in rule.attempts
    ):
        return False
    tokens = [one.token for one in rule.attempts]
    if isinstance(rule, NetworkJudge):
        return rule.lent() is not None and all(token[0] == WAITING for token in tokens)
    cuts = rule.machine.cuts_of
    return 0 <= rule.letter < len(rule.machine.class_of) and all(
        PASSED < location < len(cuts) and len(anchors) == len(cuts[location])
        for location, anchors in tokens
    )


def begins_with_letters(rule: Rule) -> bool:
    """Whether all letters are noted that the oldest attempt of windows has seen."""
    attempts: list[Open] = rule.undecided()
    letters = (isinstance(rule, NetworkJudge) and rule.lent()) or ()
    return not attempts or any(t <= attempts[0].triggered for t, _ in letters[:1])


def rule_words(rule: Rule, count: int) -> Iterator[int]:
    """The state of a rule; `count`: the number of its last attempt."""
    attempts: list[Open] = rule.undecided()
    failed_at = NEVER if rule.failed_at is None else rule.failed_at
    yield from (rule.before, int(rule.running), count, bounded(rule.due), int(rule.restless))
    yield from (int(rule.slides), rule.position, rule.letter, bounded(failed_at), len(attempts))
    for one in attempts:
        location, anchors = one.token
        yield from (one.triggered, one.number, location, packed(one.seen))
        yield int(one.triggered == rule.current)
        if not isinstance(rule, NetworkJudge):
            yield from anchors
    if isinstance(rule, NetworkJudge):
        letters = rule.lent() or ()
        yield len(letters)
        for t, letter in letters:
            yield from (t, signed(sum(true << leaf for leaf, true in enumerate(letter))))


def letters_of(words: Iterable[int], leaves: int) -> list[Noted]:
    """The letters that were noted: of each its instant, then a bit for each leaf."""
    each = iter(words)
    return [
        (t, tuple([bool(word >> leaf & 1) for leaf in range(leaves)]))
        for t, word in zip(each, each, strict=True)
    ]


def take_rule(rule: Rule, words: Iterator[int], reached: int, limit: int) -> int:
    """Have a rule go on; returns the number of its last attempt.

    Args:
        rule: as it was when its state was lent.
        words: as `rule_words` has them.
        reached: the instant that time has come to.
        limit: the stamp of that, by which one knows whether its letter is known.
    """
    before, running, count, due, restless = (next(words) for _ in range(5))
    slides, position, letter, failed_at, size = (next(words) for _ in range(5))
    rule.before, rule.running = before, bool(running)
    rule.position, rule.letter, rule.other = position, letter, letter
    rule.slides = bool(slides)
    rule.failed_at = None if failed_at == C_NEVER else failed_at
    rule.current = None
    found = []
    for _ in range(size):
        triggered, number, location, seen, is_current = (next(words) for _ in range(5))
        clocks = () if isinstance(rule, NetworkJudge) else rule.machine.cuts_of[location]
        anchors = tuple([next(words) for _ in clocks])
        if is_current:
            rule.current = triggered
        found.append((triggered, number, (location, anchors), seen))
    if isinstance(rule, NetworkJudge):
        leaves, plan = len(rule.leaves), rule.plan
        own = [
            reopened(number, t, (WAITING, (t,)), unpacked(seen, leaves))
            for t, number, _, seen in found
        ]
        noted = islice(words, 2 * next(words))
        rule.take_back(own, letters_of(noted, len(plan.leaves)), limit)
        return count
    rule.due, rule.restless = (instant(due), bool(restless)) if found else (NEVER, False)
    # The compiled monitor asks some attempts sooner than has to be.
    if rule.gap is None or isinstance(rule, BulkRule):
        stepped_to = reached if rule.gap is None else position
        _see_when_due(rule, [token for _, _, token, _ in found], stepped_to)
    _hold(rule, found)
    return count


def _see_when_due(rule: Rule, tokens: Sequence[Any], reached: int) -> None:
    """Work out when the attempts of a rule are due, all of which are as they were at `reached`."""
    machine, t = rule.machine, rule.position
    leads_on = any(not machine.stays(token, t, rule.letter) for token in tokens)
    ages = any(machine.row(token, t) != machine.row(token, reached) for token in tokens)
    rule.restless = leads_on or ages
    cuts = [next_cut(machine, token, reached) for token in tokens]
    rule.due = t + 1 if leads_on and t == reached else min(cuts, default=NEVER)


def _hold(rule: Rule, found: Sequence[tuple[int, int, Any, int]]) -> None:
    """Give a rule its open attempts, in runs where it has such."""
    rule.runs, rule.attempts = {}, []
    leaves = len(rule.clerk.leaves)
    is_solo = isinstance(rule, SoloRule) and len(found) == 1 and found[0][2][0] == rule.place
    for triggered, number, token, seen in found:
        location = token[0]
        if isinstance(rule, BulkRule):
            rule.runs.setdefault(location, Run()).append(triggered, number, seen)
        elif is_solo:
            rule.runs[location] = (triggered, number, unpacked(seen, leaves))
        else:
            rule.attempts.append(rule.clerk.reopened(rule, number, triggered, token, seen))
