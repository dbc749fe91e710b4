"""The explanations in records of verdicts."""

import pytest
from tests.tools.build import actions
from tests.tools.drive import feed
from tests.tools.each import each

import rvmon

S = 1_000_000_000
HEAD = """signal near, slow : bool input
signal x : real [m] input stale after 1 s
signal y : real
event go input
event released output
requirement R
"""


def run(requirement, told, end=None, time="held"):
    """A specification, and the attempts of its monitor with `actions` at whole seconds."""
    spec = rvmon.loads(f"time {time}\n{HEAD}{requirement}\n")
    monitor = spec.monitor()
    for one in actions(told):
        monitor.step(one.t, one.values)
    return spec, monitor.finish(end).attempts


FAILED = {
    "a deadline is missed": (
        *("upon go\nthen within 3 s released", "1; 12 go", 20),
        "`released` had to occur between 11 s and 14 s, and did not; it had never occurred before",
        *("within 3 s released", (12 * S, 15 * S)),
    ),
    "it was true before": (
        *("upon go\nthen within 3 s released", "1 released; 12 go", 20),
        "`released` had to occur between 11 s and 14 s, and did not; it had last occurred at 0 s",
        *("within 3 s released", (12 * S, 15 * S)),
    ),
    "what must not happen happens": (
        *("upon go\nthen for 2 s not released", "4 go; 5 released", None),
        "`released` occurred at 1 s, 1 s after the trigger; it was not to occur from 0 s to 2 s",
        *("for 2 s not released", (4 * S, 6 * S)),
    ),
    "what must stay ends": (
        *("upon go\nthen for 2 s near", "4 go near; 5 -near", None),
        "`near` became false at 1 s, 1 s after the trigger; it had to stay true until 2 s",
        *("for 2 s near", (4 * S, 6 * S)),
    ),
    "an invariant is broken": (
        *("always (near -> slow)", "0 -near -slow; 3 near", None),
        *("`slow` was false at 3 s; it had to be true then", "slow", (3 * S, None)),
    ),
    "until is cut off": (
        *("upon go\nthen near until released", "0 near go; 2 -near", None),
        "`near` became false at 2 s, 2 s after the trigger; it had to stay true until `released`",
        *("near until released", (0, None)),
    ),
    "the inner obligation is to blame": (
        "upon go\nthen (within 2 s released) and always (near -> within 1 s slow)",
        *("0 go released -slow; 4 near", 9),
        "`slow` had to come true between 4 s and 5 s, and did not; it had never been true before",
        *("within 1 s slow", (4 * S, 5 * S)),
    ),
    "an until within an until": (
        *("upon start then near until slow until[1 s, 2 s] near", "0 -near -slow; 1; 4", None),
        "`near` was false at 0 s; it had to stay true until `slow until[1 s, 2 s] near`",
        *("near until slow until[1 s, 2 s] near", (0, None)),
    ),
    "what has to begin in time": (
        *("upon start then within 1 s always near", "0 -near; 1; 4", None),
        "`always near` had to come true between 0 s and 1 s, and did not",
        *("within 1 s always near", (0, S)),
    ),
    "a fall of the future": (
        *("whenever start then fall(always[1 s, 3 s] near)", "0 near; 1", None),
        "`fall(always[1 s, 3 s] near)` could no longer be fulfilled at 0 s",
        *("fall(always[1 s, 3 s] near)", (0, 0)),
    ),
}
TIMES = ("held", "sampled", "sampled every 1 s", "sampled every 500 ms")
"""What is said is the same in each: all is told at whole seconds."""


@each("time", TIMES)
@each("name", FAILED)
def test_a_failure_names_obligation_window_and_place(time, name):
    requirement, told, end, reason, blamed, window = FAILED[name]
    spec, attempts = run(requirement, told, end, time)
    [failed] = [a for a in attempts if a.verdict == "F"]
    assert failed.reason == reason
    assert failed.blame.window == window
    text = spec.checked.source.text[failed.blame.start : failed.blame.end]
    assert text == failed.blame.subformula == blamed


def test_the_blamed_sample_is_the_one_that_changed_the_value():
    """A value that has been wrong for long is blamed on the sample that set it."""
    _, [failed] = run("upon go\nthen for 2 s not near", "1 near; 5 go")
    assert failed.blame.at == (10**9,)


@each("required", ["false since near", "slow since near", "once near"])
@each("time", ["held", "sampled", "sampled every 1 s"])
def test_a_proposition_that_the_past_reads_too_is_shown_with_its_present_value(required, time):
    """Not as it stood when all was born, from when on some of what is asked rests."""
    told = "0 -near slow; 1 near; 2 -near; 3 near; 4 ?near; 5 near; 6 -near"
    _, attempts = run(f"upon near then {required}", told, time=time)
    found = [(one.in_doubt, one.at_trigger["near"]) for one in attempts]
    assert {(False, True)} <= {*found} <= {(False, True), (True, None)}


@pytest.mark.parametrize("told", ["{} and {}", "{1} and {0}"])
def test_a_requested_known_is_shown(told):
    """Not what a sum compares with itself to see whether its limit is born, under the same text."""
    required = told.format("count(go, 4 s) >= y", "known(y)")
    _, [failed] = run(f"upon go then {required}", "0 x=1; 1 go")
    assert failed.at_trigger["known(y)"] is failed.at_decision["known(y)"] is False


def test_propositions_are_shown_at_trigger_and_decision():
    _, [failed] = run("upon go\nthen within 1 s (released and near)", "0 go", 5)
    assert failed.at_trigger == {"go": True, "released": False, "near": None}
    assert failed.at_decision == {"go": False, "released": False, "near": None}


def test_what_only_the_past_asks_of_is_unknown_until_it_has_a_value():
    """The past takes it for a truth until then; the first value may be of that same truth."""
    told = "0 -near; 1 go; 2 y=0; 3 go"
    _, found = run("upon go\nthen (historically y > 1) and near", told)
    assert [one.at_trigger["y > 1"] for one in found] == [None, False]
    assert [one.at_decision["y > 1"] for one in found] == [None, False]


LEFT = {
    "what is owed, and till when": (
        *("upon go\nthen within 3 s released", "1 go", 2),
        "still required when the recording ended at 1 s: `within 3 s released` by 3 s; "
        "a recording more than 2 s longer would have decided it",
    ),
    "a deadline within what has none": (
        *("always (near -> within 3 s released)", "0 -near; 1 near", 2),
        "still required when the recording ended at 2 s: `within 3 s released` by 4 s",
    ),
    "windows in a window": (
        *("upon go\nthen within 5 s for 3 s near", "0 -near; 1 go; 3", None),
        "still required when the recording ended at 3 s: `within 5 s for 3 s near` by 6 s; "
        "a recording more than 6 s longer would have decided it",
    ),
    "the future of a past": (
        "upon go\nthen within 3 s once (near and within 1 s slow)",
        *("0 -near -slow; 1 go; 2 near", None),
        "still required when the recording ended at 2 s: `within 3 s once (near and within 1 s "
        "slow)` by 4 s; a recording more than 3 s longer would have decided it",
    ),
    "in doubt, of which it is not said how long it would take": (
        *("upon near\nthen within 3 s released", "0 -near; 1 ?near", None),
        "still required when the recording ended at 1 s: `within 3 s released` by 4 s; "
        "`near` was not known from 1 s on: given as unknown at 1 s",
    ),
    "stale": (
        *("upon go\nthen x > 5 cm", "0 x=1; 2 go; 4 x=1", None),
        "left open by the input: `x` was not known from 1 s to 4 s: no update for 1 s (stale)",
    ),
    "NaN": (
        *("upon go\nthen x > 5 cm", "0 x=1; 1 x=nan; 3 go", None),
        "left open by the input: `x` was not known from 1 s on: NaN at 1 s",
    ),
    "None, and stale after that": (
        *("upon go\nthen x > 5 cm", "0 x=1; 1 ?x; 2 go; 3", None),
        "left open by the input: `x` was not known from 1 s on: given as unknown at 1 s",
    ),
    "not yet": (
        *("upon go\nthen x > 5 cm", "0; 2 go; 3 ?x; 4 x=1", None),
        "left open by the input: `x` had no value before 4 s",
    ),
    "never": (
        *("upon go\nthen x > 5 cm", "0 near; 2 go", None),
        "left open by the input: `x` never had a value",
    ),
    "an episode that its trigger ended": (
        *("whenever near\nthen within 3 s released", "0 near -slow; 2 -near slow released", 9),
        "`near` was false at 2 s; after that no obligation was left",
    ),
    "an episode of an implication": (
        *("always (near -> within 3 s released)", "0 near -slow; 2 -near slow released", 9),
        "`near` was false at 2 s; after that no obligation was left",
    ),
    "an episode of a negation": (
        *("whenever not slow\nthen within 3 s released", "0 near -slow; 2 -near slow released", 9),
        "`slow` was true at 2 s; after that no obligation was left",
    ),
}


DEADLINES = {"what is owed, and till when": 4 * S}
DEADLINES |= {"a deadline within what has none": 4 * S}
DEADLINES |= {"windows in a window": 6 * S, "the future of a past": 4 * S}


@each("time", TIMES)
@each("name", LEFT)
def test_reasons_of_open_attempts_and_ended_episodes(time, name):
    """The cause of an I is the time over which a signal was unknown."""
    requirement, told, end, reason = LEFT[name]
    _, [left] = run(requirement, told, end, time)
    assert left.reason == reason
    if left.verdict == "I":  # an attempt in doubt has no deadline of its own
        assert left.deadline == DEADLINES.get(name)


@each(
    ("time", "required", "told", "owed"),
    [
        # Parts settled by time alone are left out, also without a position at that time.
        (
            *("sampled", "upon e then (within 3 ns p) or (within 9 ns q)"),
            *("0 -p -q e; 6!", "`within 9 ns q` by 9 ns"),
        ),
        # An obligation of each position, and of now, is listed once with its deadline.
        ("held", "whenever p then within 5 ns q", "0 -p -q; 2 p", "`within 5 ns q` by 7 ns"),
    ],
)
def test_what_is_still_owed_is_told_once(time, required, told, owed):
    names = "signal p, q : bool\nevent e\n"
    monitor = rvmon.loads(f"time {time}\n{names}requirement R\n  {required}\n").monitor()
    for one in actions(told):
        feed(monitor, one)
    [left] = monitor.open
    assert left.required == owed


@pytest.mark.parametrize("advances", [(), (10**9,), (2 * 10**9,), (2 * 10**9 + 1,)])
def test_the_reason_of_a_decision_by_time_alone(advances):
    """The record names the window that closed, however time was advanced."""
    monitor = rvmon.loads(
        "spec s\nsignal p, r : bool\nrequirement R1\n"
        "  upon start then eventually[2 s, 2 s] (p until r)\n"
    ).monitor()
    monitor.step(0, {"p": False, "r": False})
    for t in advances:
        monitor.advance_ns(t)
    (attempt,) = monitor.finish(5).attempts
    assert attempt.reason.endswith(" had to come true at 2 s, and did not")
    assert (attempt.decided, attempt.deadline) == (2 * 10**9 + 1, 2 * 10**9)
    assert attempt.blame.window == (2 * 10**9, 2 * 10**9)


def test_the_deadline_of_what_ends_an_obligation_is_that_of_its_window():
    """The release of an obligation has a window of its own, which time alone closes."""
    monitor = rvmon.loads(
        "spec s\ntime sampled\nsignal p, q : bool\nrequirement R1\n"
        "  upon start then (q M (always[0 ns, 1 ns] p))\n"
    ).monitor()
    monitor.step_ns(0, {"p": True, "q": False})
    monitor.step_ns(2, {"p": True, "q": True})
    (attempt,) = monitor.step_ns(5, {"p": False})
    assert (attempt.decided, attempt.deadline) == (4, 3)


def test_what_was_not_known_when_a_run_was_interrupted_may_end_after_that():
    spec = rvmon.loads(f"{HEAD}upon go\nthen x > 5 cm\n")
    first = spec.monitor()
    first.step(0, {"x": 1.0})
    first.step(2, {"go": True})
    second = spec.restore(first.snapshot())
    second.step(4, {"x": 1.0})
    [left] = second.finish().attempts
    assert "from 1 s to 4 s" in left.reason


def test_a_name_without_a_source_is_said_to_have_none():
    spec = rvmon.loads(f"{HEAD}upon go\nthen near\n")
    monitor = spec.monitor(sources=["go"])
    monitor.step(0, {"go": True})
    [left] = monitor.finish().attempts
    assert left.reason == "left open by the input: `near` has no source"


def test_a_recurring_obligation_is_that_of_now():
    """Positions with the same obligation are skipped: its window moves on."""
    text = "requirement R\nupon start\nthen eventually always[1 ns, 1 ns] start"
    monitor = rvmon.loads(f"spec s\ntime sampled every 1 ns\n{text}\n").monitor()
    monitor.step_ns(0, {})
    for now in range(1, 6):
        monitor.advance_ns(now)
        [left] = monitor.open
        assert left.required.startswith(f"`always[1 ns, 1 ns] start` until {now} ns, or ")
        assert left.deadline == now


def test_what_one_record_shows_is_its_own():
    spec = rvmon.loads("signal p : bool\nevent e\nrequirement R\n  upon e then p\n")
    monitor = spec.monitor()
    first, second = (monitor.step(t, {"p": True, "e": True})[0] for t in (0, 1))
    first.at_trigger.clear()
    first.at_decision.clear()
    assert second.at_trigger
    assert second.at_decision == {"e": True, "p": True}


def test_a_payload_that_is_too_large_has_no_history():
    """Its comparison is false wherever the event does not occur, so earlier truths mean nothing."""
    spec = rvmon.loads(
        "event pick(f: real)\nrequirement R\n  upon pick then immediately pick.f <= 10\n"
    )
    [failed] = spec.evaluate([(0, {}), (1, {"pick": {"f": 20.0}})]).attempts
    assert failed.reason == "`pick.f <= 10` was false at 1 s; it had to be true then"
