"""The page's translations of all FRET combinations of scope, condition and timing are correct."""

import itertools
import random
import re
from pathlib import Path

import pytest

from rvmon.language.compile import compile_text
from rvmon.testing import oracle
from rvmon.trace.sample import Sample

PAGE = Path(__file__).parents[4] / "docs" / "how-to" / "write-a-requirement.md"
TEXT = PAGE.read_text(encoding="utf-8").partition("## Requirements written for FRET")[2]


def table(heading):
    """The rows of a table of the page: FRET's word, then the code spans of the other cells."""
    part = TEXT.partition(f"### {heading}\n\n")[2].partition("\n\n")[0]
    for line in part.splitlines()[2:]:
        name, *cells = (re.findall(r"`([^`]+)`", cell) for cell in line.split("|")[1:-1])
        yield re.sub(r" (m|c|s|3 s)$", "", name[0]) if name else "null", cells


SCOPES = {name: codes for name, [codes] in table("Scope")}
"""The clause, and the words and the clause for what has to come before the scope closes."""

CONDITIONS = {name: trigger for name, [[trigger]] in table("Condition")}
TIMINGS = {name: (required, opposite) for name, [[required], [opposite]] in table("Timing")}
TO_THE_END = {"null": "start", "after": "fall(m)", "only before": "m"}
"""Where scopes open that reach to the end of the run, whose last position `finally` means."""

N = 2
"""The duration in positions."""


def intervals(scope, m):
    """The intervals of a run in the scope: first and last position, and whether it is closed."""
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
    """The positions of an interval at which the response is required."""
    if condition == "null":
        return [start]
    if condition == "whenever":
        return [k for k in range(start, end + 1) if c[k]]
    return [k for k in range(start, end + 1) if c[k] and (k == start or not c[k - 1])]


def violates(timing, r, s, t, end, closed):
    """Whether the response to a trigger at t is certainly missing in an interval up to `end`."""
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
    """The same for the `only` scopes: outside them FRET demands the opposite timing."""
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
    """Whether FRET's requirement fails: an interval has a trigger without a response."""
    judged = violates_negated if scope.startswith("only") else violates
    return any(
        judged(timing, run["r"], run["s"], t, end, closed or _ends_with_run(scope, timing))
        for start, end, closed in intervals(scope, run["m"])
        for t in triggers(condition, run["c"], start, end)
    )


def _ends_with_run(scope, timing):
    return timing == "finally" and scope in TO_THE_END


def translated(scope, condition, timing):
    """The page's requirement for a combination."""
    negated = scope.startswith("only")
    consequent = TIMINGS[timing][negated]
    clause, trigger = (*SCOPES[scope], "")[0], CONDITIONS[condition]
    if consequent.startswith("eventually") and "eventually" in SCOPES[scope]:
        clause = SCOPES[scope][-1]
    if _ends_with_run(scope, timing):
        at_end = re.search(r"`(immediately \(\(once .*)`, without", TEXT)[1]
        consequent = at_end.replace(" q", f" {TO_THE_END[scope]}")
        if condition == "null":
            consequent = re.sub(r"once \(c and (.*)\)(?=\) ->)", r"\1", consequent)
        consequent = consequent.replace("-> r", "-> not r" if negated else "-> r")
        trigger, clause = "upon end", ""
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


def test_the_page_has_all_combinations():
    assert f"{len(SCOPES) * len(CONDITIONS) * len(TIMINGS)} combinations" in TEXT
