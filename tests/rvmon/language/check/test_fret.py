"""Every combination of FRET's scopes, conditions and timings is translated as the page says."""

import itertools
import random
import re
from pathlib import Path

import pytest

from rvmon.language.compile import compile_text
from rvmon.testing import oracle
from rvmon.trace.sample import Sample

PAGE = Path(__file__).parents[4] / "docs" / "how-to" / "write-a-requirement.md"
SCOPES = {
    "null": "",
    "in": "scope after (m) until (not m)",
    "not in": "scope after (not m) until (m)",
    "before": "scope after (start) until (m)",
    "after": "scope after (fall(m))",
    "only in": "scope after (not m) until (m)",
    "only before": "scope after (m)",
    "only after": "scope after (start) until (fall(m))",
}
BEFORE = {"before": "scope before (m)", "only after": "scope before (fall(m))"}
"""The clause for what has to come before the scope closes."""

CONDITIONS = {"null": "upon start", "upon": "upon c", "whenever": "whenever c"}
TIMINGS = {
    "immediately": "immediately r",
    "next": "not next not r",
    "eventually": "eventually r",
    "always": "always r",
    "never": "always not r",
    "within": "r R[3 s, 3 s] r",
    "for": "for 3 s r",
    "after": "(for 3 s not r) and always[3 s + D, 3 s + D] r",
    "until": "r unless s",
    "before": "not s unless (r and not s)",
    "finally": "always (r or next true)",
}
NEGATED = {
    "immediately": "immediately not r",
    "next": "not next r",
    "eventually": "always not r",
    "always": "eventually not r",
    "never": "eventually r",
    "within": "for 3 s not r",
    "for": "(not r) R[3 s, 3 s] (not r)",
    "after": "(r R[3 s, 3 s] r) or for (3 s + D) not r",
    "until": "not s unless (not r and not s)",
    "before": "not r unless s",
    "finally": "always (not r or next true)",
}
TO_THE_END = {"null": "start", "after": "fall(m)", "only before": "m"}
"""Where scopes open that reach to the end of the run, whose last position `finally` means."""

N = 2
"""The duration in positions."""


def intervals(scope, m):
    """The stretches of a run that belong to the scope: first and last position, whether closed."""
    last = len(m) - 1
    falls = [k for k in range(1, len(m)) if m[k - 1] and not m[k]]
    match scope:
        case "null":
            return [(0, last, False)]
        case "before":
            first = m.index(True) if True in m else None
            if first is None:
                return [(0, last, False)]
            return [(0, first - 1, True)] if first else []
        case "after":
            return [(falls[0], last, False)] if falls else []
        case "only before":
            return [(m.index(True), last, False)] if True in m else []
        case "only after":
            return [(0, falls[0] - 1, True)] if falls else [(0, last, False)]
    wanted = [value is (scope == "in") for value in m]
    found = []
    for value, group in itertools.groupby(enumerate(wanted), key=lambda pair: pair[1]):
        positions = [k for k, _ in group]
        if value:
            found.append((positions[0], positions[-1], positions[-1] < last))
    return found


def triggers(condition, c, start, end):
    """Where the response is asked for, inside a stretch."""
    if condition == "null":
        return [start]
    if condition == "whenever":
        return [k for k in range(start, end + 1) if c[k]]
    return [k for k in range(start, end + 1) if c[k] and (k == start or not c[k - 1])]


def violates(timing, r, s, t, end, closed):
    """Whether the response to a trigger at t is missing for certain, in a stretch up to `end`."""
    inside = range(t, end + 1)
    until = range(t, min(t + N, end) + 1)
    match timing:
        case "immediately":
            return not r[t]
        case "next":
            return t + 1 <= end and not r[t + 1]
        case "eventually":
            return closed and not any(r[k] for k in inside)
        case "always":
            return not all(r[k] for k in inside)
        case "never":
            return any(r[k] for k in inside)
        case "within":
            return t + N <= end and not any(r[k] for k in until)
        case "for":
            return not all(r[k] for k in until)
        case "after":
            return any(r[k] for k in until) or (t + N + 1 <= end and not r[t + N + 1])
        case "until":
            return any(not r[k] and not any(s[t : k + 1]) for k in inside)
        case "before":
            return any(s[k] and not any(r[t:k]) for k in inside)
        case "finally":
            return closed and not r[end]


def violates_negated(timing, r, s, t, end, closed):
    """The same for the `only` scopes, outside of which FRET demands the opposite timing."""
    without = [not value for value in r]
    longer = range(t, min(t + N + 1, end) + 1)
    match timing:
        case "immediately" | "next" | "finally":
            return violates(timing, without, s, t, end, closed)
        case "eventually":
            return violates("never", r, s, t, end, closed)
        case "always":
            return violates("eventually", without, s, t, end, closed)
        case "never":
            return violates("eventually", r, s, t, end, closed)
        case "within":
            return violates("for", without, s, t, end, closed)
        case "for":
            return violates("within", without, s, t, end, closed)
        case "after":
            return violates("within", r, s, t, end, closed) and any(r[k] for k in longer)
        case "until":
            return violates("before", without, s, t, end, closed)
        case "before":
            return violates("until", without, s, t, end, closed)


def fails(scope, condition, timing, run):
    """FRET's meaning: a stretch, a trigger in it, and no response."""
    judged = violates_negated if scope.startswith("only") else violates
    return any(
        judged(timing, run["r"], run["s"], t, end, closed or _ends_with_run(scope, timing))
        for start, end, closed in intervals(scope, run["m"])
        for t in triggers(condition, run["c"], start, end)
    )


def _ends_with_run(scope, timing):
    return timing == "finally" and scope in TO_THE_END


def translated(scope, condition, timing):
    """The requirement that the page gives for a combination."""
    negated = scope.startswith("only")
    consequent = (NEGATED if negated else TIMINGS)[timing]
    clause, trigger = SCOPES[scope], CONDITIONS[condition]
    if consequent.startswith("eventually"):
        clause = BEFORE.get(scope, clause)
    if _ends_with_run(scope, timing):
        opened = f"once {TO_THE_END[scope]}"
        asked = f"({opened})" if condition == "null" else f"(once (c and {opened}))"
        trigger, clause = "upon end", ""
        consequent = f"immediately ({asked} -> {'not ' if negated else ''}r)"
    return f"requirement R\n  {trigger}\n  then {consequent}\n  {clause}\n"


@pytest.mark.law
@pytest.mark.parametrize("scope", SCOPES)
@pytest.mark.parametrize("condition", CONDITIONS)
def test_translation(scope, condition):
    """The translated requirement fails exactly where FRET's is violated."""
    required = "always, never" if scope.startswith("only") else "eventually"
    for timing in TIMINGS:
        never = timing in required and scope in TO_THE_END  # no run fails for certain
        requirement = translated(scope, condition, timing).replace("3 s", f"{N} ns")
        head = "time sampled every 1 ns\nsignal m, c, r, s : bool\n"
        spec, _ = compile_text(head + requirement.replace("D", "1 ns"))
        rng = random.Random(f"{scope} {condition} {timing}")
        seen = set()
        for number in range(60 if never else 220):
            length = rng.randint(3, 8)
            likely = {name: rng.choice((0.1, 0.4, 0.8)) for name in "mcrs"}
            run = {name: [rng.random() < likely[name] for _ in range(length)] for name in "mcrs"}
            samples = [Sample(t, {name: run[name][t] for name in "mcrs"}) for t in range(length)]
            failed = oracle.evaluate(spec, samples).verdicts["R"] == "F"
            assert failed == fails(scope, condition, timing, run), run
            seen.add(failed)
            if number >= 8 and len(seen) > 1:
                break
        assert seen == ({False} if never else {True, False})


def test_page_says_what_is_tested():
    shown = re.findall(r"`([^`]*)`", PAGE.read_text(encoding="utf-8"))
    forms = (SCOPES, BEFORE, CONDITIONS, TIMINGS, NEGATED)
    tested = [text for form in forms for text in form.values() if text]
    assert [text for text in tested if text not in shown] == []
    combinations = len(SCOPES) * len(CONDITIONS) * len(TIMINGS)
    at_the_end = "immediately ((once (c and once q)) -> r)"
    assert at_the_end in shown
    assert f"{combinations} combinations" in PAGE.read_text(encoding="utf-8")
