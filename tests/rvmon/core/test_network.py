"""Where no automaton judges in the core: delay networks, and what they foresee."""

import pytest

import rvmon

S = 10**9


def spec_of(requirement: str, model: str = "held") -> rvmon.Spec:
    """A specification with one requirement."""
    return rvmon.loads(
        f"spec s\ntime {model}\nsignal p, q : bool\nrequirement R1\n  {requirement}\n"
    )


@pytest.mark.parametrize("model", ["held", "sampled", "sampled every 500 ms"])
def test_no_window_of_the_past_holds_what_is_taken_of_a_since_before_the_trace(model):
    """`once` was met nowhere before the first position, which is in no window either."""
    form = "upon start then historically[0 s, 5 s] once F[0 s, 3 s] q"
    rows = [(0, {"q": False}), (1 * S, {}), (2 * S, {"q": True})]
    monitor = spec_of(form, model).monitor()
    decided = [one for t, values in rows for one in monitor.step_ns(t, values)]
    assert [(str(one.verdict), one.decided) for one in decided] == [("P", 2 * S)]


def test_what_stays_unknown_while_nobody_looks_fails_nothing():
    """A value lost since the network was last asked, which is not until the next change."""
    monitor = spec_of("whenever p then F[2 s, 5 s] F[1 ns, 2 ns] q").monitor()
    for t in range(0, 800 * S, 20 * S):
        monitor.step_ns(t, {"p": True, "q": False})
        monitor.step_ns(t + 1000, {"p": False, "q": None})
        assert monitor.next_due is None or monitor.next_due > t + 1000
        monitor.step_ns(t + 3 * S, {"q": False})
        for n in range(t // S // 20 % 4):
            monitor.step_ns(t + (10 + n) * S, {"q": n % 2 == 0})
    assert [str(one.verdict) for one in monitor.finish().attempts] == ["I"] * 40
