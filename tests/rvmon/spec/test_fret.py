"""Every combination of FRET's scopes, conditions and timings is translated as the page says."""

import itertools
import random
import re
from pathlib import Path

import pytest

from rvmon.spec import compile_text
from rvmon.testing import oracle
from rvmon.trace.sample import Sample

PAGE = Path(__file__).parents[3] / "docs" / "reference" / "fret.md"
SCOPES = {
    "null": "",
    "in": "scope after (m) until (not m)",
    "not in": "scope after (not m) until (m)",
    "before": "scope after (start) until (m)",
    "after": "scope after (fall(m))",
}
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
}
N = 2
"""The duration in positions."""


def intervals(scope, m):
    """The stretches of a run that belong to the scope: first and last position, whether closed."""
    last = len(m) - 1
    if scope == "null":
        return [(0, last, False)]
    if scope == "before":
        first = m.index(True) if True in m else None
        if first is None:
            return [(0, last, False)]
        return [(0, first - 1, True)] if first else []
    if scope == "after":
        falls = [k for k in range(1, len(m)) if m[k - 1] and not m[k]]
        return [(falls[0], last, False)] if falls else []
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


def fails(scope, condition, timing, run):
    """FRET's meaning: a stretch, a trigger in it, and no response."""
    return any(
        violates(timing, run["r"], run["s"], t, end, closed)
        for start, end, closed in intervals(scope, run["m"])
        for t in triggers(condition, run["c"], start, end)
    )


@pytest.mark.parametrize("timing", TIMINGS)
@pytest.mark.parametrize("scope", SCOPES)
@pytest.mark.parametrize("condition", CONDITIONS)
def test_translation(scope, condition, timing):
    """The translated requirement fails exactly where FRET's is violated."""
    clause = SCOPES[scope]
    if scope == "before" and timing == "eventually":
        clause = "scope before (m)"
    consequent = TIMINGS[timing].replace("3 s", f"{N} ns").replace("D", "1 ns")
    text = f"""time sampled every 1 ns
signal m, c, r, s : bool
requirement R
  {CONDITIONS[condition]}
  then {consequent}
  {clause}
"""
    spec, _ = compile_text(text)
    dice = random.Random(f"{scope} {condition} {timing}")
    seen = set()
    for number in range(300):
        length = dice.randint(3, 8)
        likely = {name: dice.choice((0.1, 0.4, 0.8)) for name in "mcrs"}
        run = {name: [dice.random() < likely[name] for _ in range(length)] for name in "mcrs"}
        samples = [Sample(t, {name: run[name][t] for name in "mcrs"}) for t in range(length)]
        failed = oracle.evaluate(spec, samples).verdicts["R"] == "F"
        assert failed == fails(scope, condition, timing, run), run
        seen.add(failed)
        if number >= 25 and len(seen) > 1:
            break
    never = timing == "eventually" and scope in ("null", "after")  # no run fails for certain
    assert seen == ({False} if never else {True, False})


def test_page_says_what_is_tested():
    """Every clause, trigger and consequent of the tests stands in the tables of the page."""
    shown = re.findall(r"`([^`]*)`", PAGE.read_text(encoding="utf-8"))
    tested = [*SCOPES.values(), *CONDITIONS.values(), *TIMINGS.values(), "scope before (m)"]
    assert [text for text in tested if text and text not in shown] == []
