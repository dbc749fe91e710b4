"""Triggers, episodes, captured values, instances: worked out by hand from SEMANTICS 3."""

from dataclasses import replace
from typing import Any

import pytest
from tests.tools.build import (
    always,
    compared,
    e,
    end,
    eventually,
    f,
    g,
    k,
    no,
    once,
    p,
    q,
    requirement,
    rise,
    spec_of,
    timeline,
    true,
    two,
    x,
)
from tests.tools.each import each

from rvmon.errors import RvmonError
from rvmon.language.checked import classify
from rvmon.language.checked.formula import Captured, Formula
from rvmon.language.checked.specification import Capture, ForEach, Requirement, TimeModel
from rvmon.testing.law.attempts import is_pulse
from rvmon.testing.oracle import evaluate
from rvmon.trace.sample import Sample
from rvmon.verdicts import Verdict


def starts(judge: Any, trigger: Formula, **told: Any) -> list[int]:
    attempts = judge(requirement(true, upon=trigger), **told)
    return [int(attempt.split()[0]) for attempt in attempts]


@each(
    ("row", "expected"),
    [
        ("0.1.0.1", [2, 6]),
        # Not born before counts as an edge, unknown after known does not.
        ("u.1", [2]),
        ("0u1", []),
        # A repeated value is no edge.
        ("0.1.1", [2]),
    ],
)
def test_levels_start_at_edges(judge: Any, row: str, expected: list[int]) -> None:
    """`upon` a level starts where it becomes true, not at a recovery of the input."""
    for time in (TimeModel.HELD, TimeModel.SAMPLED):
        assert starts(judge, p, p=row, time=time) == expected


def test_recovery_from_staleness(judge: Any) -> None:
    """A signal that comes back true after being stale starts nothing."""
    assert starts(judge, p, p="1....1", stale={"p": 2}) == [0]
    assert starts(judge, p, p="1.0..1", stale={"p": 2}) == [0, 5]
    assert starts(judge, p, p="1.0...1", stale={"p": 2}) == [0]


@each(
    ("trigger", "rows", "expected"),
    [
        # A pulse starts an attempt wherever it holds.
        (e, {"e": ".11.1"}, [1, 2, 4]),
        # A disjunction with a level is a level.
        (two(e, "or", p), {"e": ".11.1", "p": "0"}, [1, 4]),
        (once(e, 0, 1), {"e": ".11..1"}, [1, 5]),
    ],
)
def test_pulses_and_levels(judge: Any, trigger: Formula, rows: Any, expected: Any) -> None:
    """Pulses start at every occurrence, all else at edges."""
    assert starts(judge, trigger, **rows, end=5) == expected


@each(
    ("trigger", "expected"),
    [
        (true, False),
        (no(compared(k, ">", 3)), False),
        (two(e, "->", p), False),
        (two(e, "<->", f), False),
        (two(e, "xor", f), True),
        # Its negation normal form is (!e | !f) & (e | f).
        (no(two(e, "<->", f)), True),
        (rise(p), True),
        (two(p, "S", e), False),
    ],
)
def test_pulse_by_syntax(trigger: Formula, expected: bool) -> None:
    """The class of a trigger is that of its negation normal form, for the law as in a check."""
    assert is_pulse(trigger) is classify.is_pulse(trigger) is expected


def test_pulse_is_cross_checked() -> None:
    """A requirement that says otherwise than its syntax is refused."""
    wrong = replace(requirement(p, upon=e), pulse=False)
    with pytest.raises(RvmonError, match="R: its trigger's class"):
        evaluate(spec_of(wrong), timeline(p="1"))


CAPTURED = (Capture("v", x),)
EACH = ForEach("id", k)
EPISODES, OF_A_PULSE = requirement(q, whenever=p), requirement(q, whenever=e)
IN_TIME = requirement(eventually(q, 0, 3), whenever=p)
ANSWERED, AT_END = requirement(eventually(p, 0, 3), upon=e), requirement(p, upon=end)
HIGHER = requirement(eventually(compared(x, ">", Captured("v")), 0, 3), upon=e, captures=CAPTURED)
NO_HIGHER = requirement(compared(x, "<=", Captured("v")), whenever=p, captures=CAPTURED)
OWN_VALUE = requirement(eventually(compared(x, "==", Captured("id")), 0, 2), upon=g, for_each=EACH)
NOT_AGAIN = requirement(always(no(g), 1, 4), upon=g, for_each=EACH)


@each(
    ("required", "rows", "expected"),
    [
        # An episode of p, q required throughout.
        # From 1 to 2 q is required and given; at 3 the episode ends.
        (EPISODES, {"p": "01.0", "q": "01"}, ["1 P 3"]),
        (EPISODES, {"p": "01.0", "q": "010"}, ["1 F 2"]),
        # Further samples make no further attempts.
        (EPISODES, {"p": "01.0", "q": "01", "x": "123456"}, ["1 P 3"]),
        # An unknown trigger starts an episode and ends none; q is required there if it held.
        (EPISODES, {"p": "1u10", "q": "1"}, ["0 P 3"]),
        # What is required but not known leaves the episode open, unless something else fails.
        (EPISODES, {"p": "1..0", "q": "1u1"}, ["0 I"]),
        # Running at the end: held to it.
        (EPISODES, {"p": "1", "q": "1", "end": 4}, ["0 P 4 held"]),
        # A failed episode goes on where what is required has not failed at once.
        (EPISODES, {"p": "1..01", "q": "0"}, ["0 F 0", "4 F 4"]),
        (EPISODES, {"p": "1.1.1", "q": "01"}, ["0 F 0", "1 P 4 held"]),
        (EPISODES, {"p": "1....0", "q": "0101"}, ["0 F 0", "1 F 2", "3 P 5"]),
        # An episode of a pulse starts where it holds and none is running.
        (OF_A_PULSE, {"e": ".11.1", "q": "1", "end": 5}, ["1 P 3", "4 P 5"]),
        # `whenever p then F[0,3] q` is settled when p has ended and nothing is required.
        # Required at 0 only; the episode is over at 1, q comes in time.
        (IN_TIME, {"p": "10", "q": "0..1"}, ["0 P 3"]),
        # Required at 0 to 2, q at 3 answers all; at 4 only those from 1 on.
        (IN_TIME, {"p": "1..0", "q": "0..1"}, ["0 P 3"]),
        # A second episode while the first still owes.
        (IN_TIME, {"p": "1010", "q": "0...1"}, ["0 F 4", "2 P 4"]),
        (IN_TIME, {"p": "1010", "q": "0...0", "end": 5}, ["0 F 4", "2 F 6"]),
        # Attempts overlap freely and are judged each by its own window.
        (ANSWERED, {"p": "0...1", "e": "1.1"}, ["0 F 4", "2 P 4"]),
        (ANSWERED, {"p": "0.....1", "e": "11"}, ["0 F 4", "1 F 5"]),
        # Decided attempts come by instant, then by number; the undecided last.
        # Triggered at 0, q false: waits until 4. At 1 q is true at once. At 5 it is false again.
        (
            requirement(two(q, "or", eventually(p, 0, 3)), upon=e),
            {"p": "0", "q": "010", "e": "11...1", "end": 7},
            ["1 P 1", "0 F 4", "5 I"],
        ),
        # In `sampled` time the next sample ends the episode of an event.
        (OF_A_PULSE, {"e": "1", "q": "1....1", "time": TimeModel.SAMPLED}, ["0 P 5"]),
        # A bare `always` is one episode that the end of the trace closes.
        (requirement(q, whenever=true), {"q": "1..", "end": 4}, ["0 P 4 held"]),
        (requirement(q, whenever=true), {"q": "1..0"}, ["0 F 3"]),
        # `let v = x` keeps the value of x at the trigger for the life of the attempt.
        (HIGHER, {"x": "5.6", "e": "1"}, ["0 P 2"]),
        # Each attempt has its own value: 5 and 6.
        (HIGHER, {"x": "5.67", "e": "1.1"}, ["0 P 2", "2 P 3"]),
        (HIGHER, {"x": "5.6", "e": "1.1", "end": 9}, ["0 P 2", "2 F 6"]),
        (HIGHER, {"x": "u5", "e": "1", "end": 9}, ["0 I"]),
        # An episode captures where it starts.
        (NO_HIGHER, {"x": "535", "p": "1..0"}, ["0 P 3"]),
        (NO_HIGHER, {"x": "5362", "p": "01.0"}, ["1 F 2"]),
        # `for each id in g.k`: instance 1 waits for x = 1 from 0 on, instance 2 for x = 2.
        (OWN_VALUE, {"g": "1.2", "x": "0.2", "end": 9}, ["2 P 2", "0 F 3"]),
        # In the instance of 1 only g with 1 occurs; one whose field is not known may be anybody's.
        (NOT_AGAIN, {"g": "1.2", "end": 9}, ["0 P 5", "2 P 7"]),
        (NOT_AGAIN, {"g": "1.v", "end": 9}, ["0 I"]),
        # No attempt of an instance starts before its value has occurred.
        (requirement(true, upon=p, for_each=EACH), {"p": "01.0.1.0", "g": "...7"}, ["5 P 5"]),
        # `upon end` is judged at the last instant, when the trace is finished.
        (AT_END, {"p": "0.1", "end": 4}, ["4 P 4"]),
        (AT_END, {"p": "1.0"}, ["2 F 2"]),
        (AT_END, {"p": "0", "advances": [7]}, ["6 F 6"]),
        (AT_END, {"p": "1......0", "end": 8, "time": TimeModel.CLOCKED, "period": 3}, ["8 P 8"]),
        (AT_END, {"p": "0.1", "end": 8, "time": TimeModel.SAMPLED}, ["8 P 8"]),
        (requirement(always(p), upon=end), {"p": "0.1", "end": 4}, ["4 P 4 held"]),
        (requirement(eventually(q, 0, 2), upon=end), {"q": "0", "end": 4}, ["4 I"]),
        (requirement(once(p), upon=end), {"p": "010", "end": 9}, ["9 P 9"]),
        # Without a sample there is no position, whatever time passes.
        (AT_END, {}, []),
        (requirement(p), {"advances": [5], "end": 9}, []),
    ],
)
def test_attempts(judge: Any, required: Requirement, rows: Any, expected: list[str]) -> None:
    """`whenever p then …` is one attempt per episode of p."""
    assert judge(required, **rows) == expected


def test_let_is_recorded() -> None:
    """The report holds what was captured; `None` if it was not known."""
    required = requirement(true, upon=e, captures=(*CAPTURED, Capture("w", k)))
    report = evaluate(spec_of(required), timeline(x="5.6", e="1.1", g="..7"))
    captured = [attempt.captured for attempt in report.attempts]
    assert captured == [{"v": 5, "w": None}, {"v": 6, "w": 7}]


def test_for_each_sees_both() -> None:
    """Two payloads at one instant start an attempt each, in their order."""
    required = requirement(true, upon=g, for_each=EACH)
    report = evaluate(spec_of(required), [Sample(0, {"g": ({"k": 2}, {"k": 1})})])
    assert [(a.number, a.captured) for a in report.attempts] == [(1, {"id": 2}), (2, {"id": 1})]


def test_fold() -> None:
    """F if any attempt failed, else I if any is, else P if any passed, else NT."""
    required = [
        requirement(eventually(p, 0, 2), upon=e, name="failed"),
        requirement(eventually(p, 0, 9), upon=e, name="open"),
        requirement(true, upon=e, name="passed"),
        requirement(true, upon=f, name="idle"),
    ]
    report = evaluate(spec_of(*required), timeline(p="1.0", e="1..1..1", r="......1"))
    assert report.verdicts == {
        "failed": Verdict.FAIL,
        "open": Verdict.INCONCLUSIVE,
        "passed": Verdict.PASS,
        "idle": Verdict.NOT_TRIGGERED,
    }
    assert report.counts["failed"] == {"P": 1, "F": 1, "I": 1}
    assert report.end == 6
