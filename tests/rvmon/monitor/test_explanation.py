"""What a record says of its verdict."""

import pytest
from tests.tools.each import each

import rvmon

HEAD = """spec s
time held
signal near, slow : bool input
signal distance : real [m] input stale after 1 s
event go input
event released, held_it output
"""


def run(requirement, samples, end=None):
    spec = rvmon.loads(f"{HEAD}requirement R\n{requirement}\n")
    monitor = spec.monitor()
    for t, values in samples:
        monitor.step(t, values)
    return spec, monitor.finish(end).attempts


CASES = {
    "a deadline is missed": (
        "upon go\nthen within 3 s released",
        [(1, {}), (12.1, {"go": True})],
        20,
        "`released` had to occur between 11.1 s and 14.1 s, and did not; "
        "it had never occurred before",
        "within 3 s released",
        (12_100_000_000, 15_100_000_000),
    ),
    "it was true before": (
        "upon go\nthen within 3 s released",
        [(1, {"released": True}), (12, {"go": True})],
        20,
        "`released` had to occur between 11 s and 14 s, and did not; it had last occurred at 0 s",
        "within 3 s released",
        (12_000_000_000, 15_000_000_000),
    ),
    "what must not happen happens": (
        "upon go\nthen for 2 s not released",
        [(4, {"go": True}), (4.75, {"released": True})],
        None,
        "`released` occurred at 0.75 s, 0.75 s after the trigger; "
        "it was not to occur from 0 s to 2 s",
        "for 2 s not released",
        (4_000_000_000, 6_000_000_000),
    ),
    "what must stay ends": (
        "upon go\nthen for 2 s near",
        [(4, {"go": True, "near": True}), (5, {"near": False})],
        None,
        "`near` became false at 1 s, 1 s after the trigger; it had to stay true until 2 s",
        "for 2 s near",
        (4_000_000_000, 6_000_000_000),
    ),
    "an invariant is broken": (
        "always (near -> slow)",
        [(0, {"near": False, "slow": False}), (3, {"near": True})],
        None,
        "`slow` was false at 3 s; it had to be true then",
        "slow",
        (3_000_000_000, None),
    ),
    "until is cut off": (
        "upon go\nthen near until released",
        [(0, {"near": True, "go": True}), (2, {"near": False})],
        None,
        "`near` became false at 2 s, 2 s after the trigger; it had to stay true until `released`",
        "near until released",
        (0, None),
    ),
    "the inner obligation is to blame": (
        "upon go\nthen (within 2 s released) and always (near -> within 1 s slow)",
        [(0, {"go": True, "released": True, "slow": False}), (4, {"near": True})],
        9,
        "`slow` had to come true between 4 s and 5 s, and did not; it had never been true before",
        "within 1 s slow",
        (4_000_000_000, 5_000_000_000),
    ),
}


@each("name", CASES)
def test_a_failure_names_obligation_window_and_place(name):
    requirement, samples, end, reason, blamed, window = CASES[name]
    spec, attempts = run(requirement, samples, end)
    [failed] = [a for a in attempts if a.verdict == "F"]
    assert failed.reason == reason
    assert failed.blame.window == window
    text = spec.checked.source.text[failed.blame.start : failed.blame.end]
    assert text == failed.blame.subformula == blamed


def test_the_blamed_sample_is_the_one_that_changed_the_value():
    """A value that has been wrong for long is blamed on the sample that made it so."""
    samples = [(1, {"near": True}), (5, {"go": True})]
    _, [failed] = run("upon go\nthen for 2 s not near", samples)
    assert failed.blame.at == (10**9,)


@each("required", ["false since near", "slow since near", "once near"])
@each("time", ["held", "sampled", "sampled every 1 s"])
def test_a_proposition_of_which_the_past_is_asked_too_is_shown_as_it_stands(required, time):
    """Not as it stood when all was born, from when on some of what is asked rests."""
    head = HEAD.replace("held", time, 1)
    monitor = rvmon.loads(f"{head}requirement R\nupon near\nthen {required}\n").monitor()
    for t, near in enumerate([False, True, False, True, None, True, False]):
        monitor.step(t, {"near": near, "slow": True})
    found = [(one.in_doubt, one.at_trigger["near"]) for one in monitor.finish().attempts]
    assert {(False, True)} <= {*found} <= {(False, True), (True, None)}


@pytest.mark.parametrize("told", ["{} and {}", "{1} and {0}"])
def test_a_known_that_is_asked_for_is_shown(told):
    """Not what a sum compares with itself to see whether its limit is born, under the same text."""
    told = told.format("count(go, 4 s) >= level", "known(level)")
    text = f"{HEAD}signal level : int\nrequirement R\n  upon go\n  then {told}\n"
    monitor = rvmon.loads(text).monitor()
    monitor.step(0, {"distance": 1.0})
    (failed,) = monitor.step(1, {"go": True})
    assert failed.at_trigger["known(level)"] is False
    assert failed.at_decision["known(level)"] is False


def test_propositions_are_shown_at_trigger_and_decision():
    _, [failed] = run("upon go\nthen within 1 s (released and near)", [(0, {"go": True})], 5)
    assert failed.at_trigger == {"go": True, "released": False, "near": None}
    assert failed.at_decision == {"go": False, "released": False, "near": None}


def test_what_only_the_past_asks_of_is_unknown_until_it_has_a_value():
    """The past takes it for a truth until then; the first value may be of that same truth."""
    required = "upon go\nthen (historically level > 1) and near"
    text = f"{HEAD}signal level : int\nrequirement R\n{required}\n"
    monitor = rvmon.loads(text).monitor()
    monitor.step(0, {"near": False})
    found = monitor.step(1, {"go": True})
    monitor.step(2, {"level": 0})
    found += monitor.step(3, {"go": True})
    assert [one.at_trigger["level > 1"] for one in found] == [None, False]
    assert [one.at_decision["level > 1"] for one in found] == [None, False]


def test_an_undecided_attempt_says_what_is_owed_and_till_when():
    samples = [(1, {"go": True})]
    _, [left] = run("upon go\nthen within 3 s released", samples, 2)
    assert (
        left.reason
        == "still required when the recording ended at 1 s: `within 3 s released` by 3 s; "
        "a recording more than 2 s longer would have decided it"
    )
    assert left.deadline == 4 * 10**9


def test_of_an_attempt_in_doubt_it_is_not_said_how_long_it_would_take():
    """It has no deadline of its own, whereas what it would owe has one."""
    samples = [(0, {"near": False}), (1, {"near": float("nan")})]
    _, [left] = run("upon near\nthen within 3 s released", samples)
    assert (
        left.reason
        == "still required when the recording ended at 1 s: `within 3 s released` by 4 s; "
        "`near` was not known from 1 s on: given as unknown at 1 s"
    )
    assert left.deadline is None


def test_what_time_has_ruled_out_is_owed_no_more():
    """An I leaves out what time alone has settled, also where no position came with it."""
    monitor = rvmon.loads(
        "spec s\ntime sampled\nsignal p, q : bool\nevent go\n"
        "requirement R1\n  upon go\n  then (within 3 ns p) or (within 9 ns q)\n"
    ).monitor()
    monitor.step_ns(0, {"p": False, "q": False, "go": True})
    monitor.advance_ns(6)
    [left] = monitor.finish_ns().attempts
    assert left.required == "`within 9 ns q` by 9 ns"


def test_what_is_owed_is_told_once():
    """What is required at each position, and required now, stands once, with its deadline."""
    text = "spec s\nsignal p, q : bool\nrequirement R1\n  whenever p\n  then within 5 s q\n"
    monitor = rvmon.loads(text).monitor()
    monitor.step(0, {"p": False, "q": False})
    monitor.step(2, {"p": True})
    [required] = monitor.open
    assert required.required == "`within 5 s q` by 7 s"


@pytest.mark.parametrize("advances", [(), (10**9,), (2 * 10**9,), (2 * 10**9 + 1,)])
def test_a_run_that_time_alone_takes_on_and_decides_is_told_as_it_was(advances):
    """The record names the window that closed, however time was told to pass."""
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
    """What releases an obligation has a window of its own, which time alone closes."""
    monitor = rvmon.loads(
        "spec s\ntime sampled\nsignal p, q : bool\nrequirement R1\n"
        "  upon start then (q M (always[0 ns, 1 ns] p))\n"
    ).monitor()
    monitor.step_ns(0, {"p": True, "q": False})
    monitor.step_ns(2, {"p": True, "q": True})
    (attempt,) = monitor.step_ns(5, {"p": False})
    assert (attempt.decided, attempt.deadline) == (4, 3)


UNKNOWN = {
    "stale": (
        [(0, {"distance": 1.0}), (2, {"go": True}), (4, {"distance": 1.0})],
        "`distance` was not known from 1 s to 4 s: no update for 1 s (stale)",
    ),
    "NaN": (
        [(0, {"distance": 1.0}), (0.5, {"distance": float("nan")}), (2, {"go": True})],
        "`distance` was not known from 0.5 s on: NaN at 0.5 s",
    ),
    "None, and stale after that": (
        [(0, {"distance": 1.0}), (0.5, {"distance": None}), (2, {"go": True}), (3, {})],
        "`distance` was not known from 0.5 s on: given as unknown at 0.5 s",
    ),
    "not yet": (
        [(0, {}), (2, {"go": True}), (2.5, {"distance": None}), (2.75, {"distance": 1.0})],
        "`distance` had no value before 2.75 s",
    ),
    "never": ([(0, {"near": True}), (2, {"go": True})], "`distance` never had a value"),
}


@pytest.mark.parametrize("name", UNKNOWN)
def test_an_attempt_that_the_input_left_open_says_from_when_to_when_and_why(name):
    """The cause of an I is the stretch over which a signal was not known."""
    samples, told = UNKNOWN[name]
    _, [left] = run("upon go\nthen immediately distance > 5 cm", samples)
    assert left.reason == f"left open by the input: {told}"


def test_what_was_not_known_when_a_run_was_interrupted_may_end_after_that():
    spec = rvmon.loads(f"{HEAD}requirement R\nupon go\nthen immediately distance > 5 cm\n")
    first = spec.monitor()
    first.step(0, {"distance": 1.0})
    first.step(2, {"go": True})
    second = spec.restore(first.snapshot())
    second.step(4, {"distance": 1.0})
    [left] = second.finish().attempts
    assert "from 1 s to 4 s" in left.reason


def test_a_name_without_a_source_is_said_to_have_none():
    spec = rvmon.loads(f"{HEAD}requirement R\nupon go\nthen immediately near\n")
    monitor = spec.monitor(sources=["go"])
    monitor.step(0, {"go": True})
    [left] = monitor.finish().attempts
    assert left.reason == "left open by the input: `near` has no source"


def test_what_is_owed_in_a_loop_is_that_of_now():
    """Positions at which the same is required again are passed over: the window moves on."""
    text = "requirement R\nupon start\nthen eventually always[1 ns, 1 ns] start"
    monitor = rvmon.loads(f"spec s\ntime sampled every 1 ns\n{text}\n").monitor()
    monitor.step_ns(0, {})
    for now in range(1, 6):
        monitor.advance_ns(now)
        [left] = monitor.open
        assert left.required.startswith(f"`always[1 ns, 1 ns] start` until {now} ns, or ")
        assert left.deadline == now


@pytest.mark.parametrize(
    ("requirement", "over"),
    [
        ("whenever near\nthen within 3 s released", "`near` was false at 2 s"),
        ("always (near -> within 3 s released)", "`near` was false at 2 s"),
        ("whenever not slow\nthen within 3 s released", "`slow` was true at 2 s"),
    ],
)
def test_what_ended_an_episode_is_named(requirement, over):
    """The trigger as it is written, not a proposition."""
    samples = [
        (0, {"near": True, "slow": False}),
        (2, {"near": False, "slow": True, "released": True}),
    ]
    _, (attempt,) = run(requirement, samples, 9)
    assert attempt.verdict is rvmon.Verdict.PASS
    assert attempt.reason == f"{over}; after that no obligation was left"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("mode", "required", "samples", "reason", "blamed"),
    [
        (
            "upon",
            "near until slow until[1 s, 2 s] near",
            [(0, {"near": False, "slow": False}), (1, {}), (4, {})],
            "`near` was false at 0 s; it had to stay true until `slow until[1 s, 2 s] near`",
            "near until slow until[1 s, 2 s] near",
        ),
        (
            "upon",
            "within 1 s always near",
            [(0, {"near": False}), (1, {}), (4, {})],
            "`always near` had to come true between 0 s and 1 s, and did not",
            "within 1 s always near",
        ),
        (
            "whenever",
            "fall(always[1 s, 3 s] near)",
            [(0, {"near": True}), (1, {})],
            "`fall(always[1 s, 3 s] near)` could be fulfilled no more at 0 s",
            "fall(always[1 s, 3 s] near)",
        ),
    ],
)
def test_parts_that_samples_decide_are_named_as_they_are_written(
    mode, required, samples, reason, blamed
):
    head = HEAD.replace("time held", "time sampled")
    spec = rvmon.loads(f"{head}requirement R\n{mode} start then {required}\n")
    (attempt,) = spec.evaluate(samples).attempts
    assert attempt.verdict is rvmon.Verdict.FAIL
    assert attempt.reason == reason
    place = attempt.blame
    assert place.subformula == spec.checked.source.text[place.start : place.end] == blamed


def test_what_one_record_shows_is_its_own():
    spec = rvmon.loads("signal p : bool\nevent e\nrequirement R\n  upon e then p\n")
    monitor = spec.monitor()
    first, second = (monitor.step(t, {"p": True, "e": True})[0] for t in (0, 1))
    first.at_trigger.clear()
    first.at_decision.clear()
    assert second.at_trigger
    assert second.at_decision == {"e": True, "p": True}
