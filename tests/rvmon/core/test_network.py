"""Where no automaton judges in the core: delay networks, and what they foresee."""

import random

import pytest

import rvmon

S = 10**9

FORMS = {
    "later": "whenever p then F[2 s, 5 s] q",
    "between ticks": "whenever p then F[2 s, 5 s] F[1 ns, 2 ns] q",
    "nested": "always (x > 3 -> F[0 s, 4 s] G[0 s, 2 s] y < 3)",
    "behind": "upon e then F[0 s, 3 s] once[0 s, 2 s] (q and within 1 s p)",
    "until": "whenever p then ((F[0 s, 1 s] q) U[1 s, 4 s] G[0 s, 1 s] x < 3)",
    "doubt": "upon known(x) and x > 3 then F[1 s, 3 s] (q and F[1 s, 2 s] p)",
    "end": "upon end then once[0 s, 3 s] (p and F[1 s, 2 s] q)",
    "for ever": "upon e then F[1 s, 2 s] always (p -> F[1 s, 3 s] q)",
}

MODELS = ("held", "sampled", "sampled every 500 ms")


def text_of(form: str, model: str = "held") -> str:
    """A specification with one requirement."""
    return (
        f"spec s\ntime {model}\nsignal p, q : bool\nsignal x, y : real\nevent e\n"
        f"requirement R1\n  {form}\n"
    )


def rows_of(seed: int, count: int, *, lost: bool = True):
    """Samples at irregular instants; some values are lost for a while."""
    rng = random.Random(seed)
    t = 0
    for _ in range(count):
        t += rng.choice([1, 250_000_000, 500_000_000, 500_000_000, 700_000_001, 3 * S])
        values: dict[str, object] = {}
        for name in ("p", "q"):
            if rng.random() < 0.5:
                values[name] = None if lost and rng.random() < 0.1 else rng.random() < 0.4
        for name in ("x", "y"):
            if rng.random() < 0.6:
                values[name] = None if lost and rng.random() < 0.1 else rng.uniform(0, 5)
        if rng.random() < 0.3:
            values["e"] = True
        yield t, values


def told(monitor, rows):
    """What each call returns, and the report."""
    calls = [[bare(one) for one in monitor.step_ns(t, values)] for t, values in rows]
    report = monitor.finish()
    return calls, report.verdicts, [bare(one) for one in report.attempts]


def bare(attempt):
    """An attempt without its reason."""
    return (
        attempt.number,
        attempt.in_doubt,
        attempt.triggered,
        attempt.decided,
        attempt.verdict,
        attempt.decision,
    )


@pytest.mark.parametrize("model", MODELS)
def test_no_window_of_the_past_holds_what_is_taken_of_a_since_before_the_trace(model):
    """`once` was met nowhere before the first position, which is in no window either."""
    form = "upon start then historically[0 s, 5 s] once F[0 s, 3 s] q"
    rows = [(0, {"q": False}), (1 * S, {}), (2 * S, {"q": True})]
    monitor = rvmon.loads(text_of(form, model)).monitor()
    decided = [one for t, values in rows for one in monitor.step_ns(t, values)]
    assert [(str(one.verdict), one.decided) for one in decided] == [("P", 2 * S)]


def test_what_stays_unknown_while_nobody_looks_fails_nothing():
    """A value lost since the network was last asked, which is not until the next change."""
    spec = rvmon.loads(text_of(FORMS["between ticks"]))

    def verdicts_of():
        monitor = spec.monitor()
        for t in range(0, 800 * S, 20 * S):
            monitor.step_ns(t, {"p": True, "q": False})
            monitor.step_ns(t + 1000, {"p": False, "q": None})
            assert monitor.next_due is None or monitor.next_due > t + 1000
            monitor.step_ns(t + 3 * S, {"q": False})
            for n in range(t // S // 20 % 4):
                monitor.step_ns(t + (10 + n) * S, {"q": n % 2 == 0})
        return [str(one.verdict) for one in monitor.finish().attempts]

    assert verdicts_of() == ["I"] * 40


def test_columns_are_judged_alike():
    """Whole columns by the same networks."""
    spec = rvmon.loads(text_of(FORMS["nested"]))
    rng = random.Random(3)
    columns = {
        "t": [0.25 * row for row in range(400)],
        "x": [rng.uniform(0, 5) for _ in range(400)],
        "y": [rng.uniform(0, 4) for _ in range(400)],
    }
    fast = spec.evaluate(columns)
    assert len(fast.attempts) > 20
    rows = [(t, {"x": x, "y": y}) for t, x, y in zip(*columns.values(), strict=True)]
    found = [[bare(one) for one in report.attempts] for report in (fast, spec.evaluate(rows))]
    assert found[0] == found[1]


def test_what_time_alone_decides_is_foreseen():
    """`next_due` is the instant, however far away; then time alone decides."""
    spec = rvmon.loads(text_of("whenever p then F[3600 s, 7200 s] G[1 s, 2 s] q"))
    monitor = spec.monitor()
    assert monitor.step_ns(0, {"p": True, "q": False}) == ()
    assert monitor.step_ns(1, {"p": False}) == ()
    due = monitor.next_due
    assert due == 7201 * S
    assert not monitor.advance_ns(due - 1)
    [failed] = monitor.advance_ns(100_000 * S)
    assert (failed.decided, failed.verdict) == (due, "F")
