"""The delay network: requirements that only it can judge, and their reasons."""

from itertools import accumulate

import pytest
from tests.tools.build import actions
from tests.tools.differential import case_of
from tests.tools.drive import drive
from tests.tools.each import each

import rvmon
from rvmon.analysis.plain_english import facts_of
from rvmon.language.checked.specification import TimeModel
from rvmon.monitor.compiled_spec import compile_spec
from rvmon.session import Spec
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile

SECOND = 10**9


def spec_of(requirement, time="held"):
    return rvmon.loads(
        f"spec s\ntime {time}\nsignal a, b : bool\nevent e\nrequirement R1\n  {requirement}\n"
    )


def outcomes(spec, told, end=None):
    """Trigger and decision instants in seconds, with the verdicts; `actions` are in seconds too."""
    monitor = spec.monitor()
    for one in actions(told):
        monitor.step(one.t, one.values)
    found = monitor.finish(end).attempts
    return [(a.triggered / SECOND, a.decided and a.decided / SECOND, a.verdict) for a in found]


@each(
    ("requirement", "judge"),
    [
        ("upon e then within 3 s b", "automaton"),
        ("whenever a then F[2 s, 5 s] b", "windows: as an automaton it would have"),
        ("whenever a then within 3 s b", "automaton"),
        ("upon e then (a and within 3 s b) or (not a and within 2 s b)", "delay network: its"),
        ("upon e then within 5 s for 3 s b", "windows: its automaton would step"),
        ("upon e then within 3 s once (a and within 1 s b)", "delay network: as an automaton"),
    ],
)
def test_the_compiler_picks_it_where_no_automaton_closes(requirement, judge):
    [compiled] = compile_spec(spec_of(requirement).checked).requirements.values()
    assert facts_of(compiled)["judged by"].startswith(judge)


def test_time_alone_may_decide_one_reading_of_an_attempt():
    """It counts as one that cannot pass, whatever its policy for open attempts."""
    spec = spec_of("upon e then eventually[1 s, 3 s] (a and for 1 s a)\n  at end weak")
    assert outcomes(spec, "0; 1 e; 9 b") == outcomes(spec, "0; 1 e", 9) == [(1, None, "I")]


def test_positions_that_decide_nothing_are_settled_together():
    """An episode fails at its instant, however many samples it has, and however far apart."""
    spec = spec_of("whenever a then b", "sampled")
    for last in range(30, 50):
        stamps = list(accumulate(1 + 6 * (k % 7 == 0) for k in range(last)))
        told = "; ".join(f"{t} a {'b' if t < stamps[-1] else '-b'}" for t in stamps)
        assert outcomes(spec, told) == [(stamps[0], stamps[-1], "F")]


def test_the_sample_before_is_kept():
    """An operator that reads the previous sample finds it, however long ago it was."""
    spec = spec_of("upon e then F[1 s, 2 s] rise(F[0 s, 0 s] a)", "sampled")
    for at in range(20, 37):
        told = "; ".join(f"{2 * k} a{' e' * (k == at)}" for k in range(at + 3))
        assert outcomes(spec, told) == [(2 * at, 2 * at + 2 + 1e-9, "F")]


def test_time_decides_under_another_letter_before_the_next_position():
    """An attempt left open by an unknown occurrence is decided at the next one."""
    spec = spec_of("whenever e then F[1 ns, 1 ns] true", "sampled every 4 ns")
    monitor = spec.monitor()
    monitor.step_ns(0, {"e": None})
    monitor.step_ns(1, {"e": True})
    [failed] = monitor.step_ns(10, {})
    assert (failed.decided, failed.at_decision) == (6, {"e": True})


def test_decisions_by_time_alone_are_scheduled():
    """However far ahead, and even if the letter has changed at every sample."""
    monitor = spec_of("upon e then F[1 h, 2 h] for 3 s b").monitor()
    for k in range(50):
        monitor.step(k * 0.01, {"b": k % 2 == 0, "e": True} if k == 7 else {"b": k % 2 == 0})
    assert monitor.next_due == 7_200_070_000_001
    monitor.step(3_700, {"b": True})
    assert monitor.next_due == 3_703_000_000_001
    monitor.step(3_702, {"b": False})
    assert monitor.next_due == 7_200_070_000_001


@pytest.mark.slow
@pytest.mark.parametrize("time", TimeModel)
def test_reasons_are_the_same_later(time):
    said = 0
    for seed in range(10):
        case = case_of(f"asked {seed}", Profile(time=time), TraceProfile())
        found = []
        for at_once in (True, False):
            monitor = Spec(case.spec).monitor(sources=case.names)
            if at_once:
                monitor.on_decided(repr)
            report, _ = drive(monitor, case)
            found.append([repr(one) for one in reversed(report.attempts)])
        assert found[0] == found[1]
        said += len(found[0])
    assert said > 8


@pytest.mark.slow
def test_a_value_that_was_lost_unobserved_fails_nothing():
    """A value was lost since the last evaluation; the next one is at the next change."""
    monitor = spec_of("whenever a then F[2 s, 5 s] F[1 ns, 2 ns] b").monitor()
    for t in range(0, 800 * SECOND, 20 * SECOND):
        monitor.step_ns(t, {"a": True, "b": False})
        monitor.step_ns(t + 1000, {"a": False, "b": None})
        assert monitor.next_due is None or monitor.next_due > t + 1000
        monitor.step_ns(t + 3 * SECOND, {"b": False})
        for n in range(t // SECOND // 20 % 4):
            monitor.step_ns(t + (10 + n) * SECOND, {"b": n % 2 == 0})
    assert [str(one.verdict) for one in monitor.finish().attempts] == ["I"] * 40
