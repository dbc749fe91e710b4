"""Differences between the robot of the paper's testbench and the correct one.

Directed tests and planted faults cover their common behaviour.
"""

from dataclasses import replace
from itertools import groupby

import pytest
from msgspec import structs

from handover.driver import Run, run_test
from handover.generator.abstract_test import SendSignal, directed
from handover.robot import behaviour
from handover.robot.handover import STATES
from handover.world import parameters as p
from handover.world.faults import SensorFaults

pytestmark = pytest.mark.campaign

TESTS = {test.name: test for test in directed()}


def instants(run: Run, name: str) -> list[float]:
    return [t / p.NS for t, values in run.samples if values.get(name) is True]


@pytest.mark.parametrize("test", ["released", "legacy-released"])
def test_a_handover_goes_through_all_states(test: str) -> None:
    run = run_test(TESTS[test])
    assert [state for state, _ in groupby(state for _, state in run.states)] == list(STATES)
    assert instants(run, "released")


@pytest.mark.parametrize("signal", ["activateRobot", "humanIsReady"])
def test_one_signal_serves_both_waits(signal: str) -> None:
    """A latched signal, right or wrong, ends both waits."""
    test = TESTS["legacy-any-signal"]
    actions = tuple(
        structs.replace(one, signal=signal) if isinstance(one, SendSignal) else one
        for one in test.actions
    )
    assert instants(run_test(structs.replace(test, actions=actions)), "decide")


def test_it_reads_missing_as_bad_at_once() -> None:
    faults = SensorFaults(dropout=("gaze",))
    run = run_test(structs.replace(TESTS["legacy-released"], faults=faults))
    assert [values["gpl_is_ok"] for _, values in run.samples if "gpl_is_ok" in values] == [False]


def test_its_polls_are_shared_and_slow_down(monkeypatch: pytest.MonkeyPatch) -> None:
    """Both waits share 500 polls of 0.2 s, and each poll subscribes again."""

    def waited_s() -> float:
        run = run_test(TESTS["legacy-one-signal-fast"])
        return instants(run, "timed_out")[0] - instants(run, "informed")[0]

    slow = waited_s()
    plain = replace(behaviour.LEGACY, resubscribes=False)
    monkeypatch.setitem(behaviour.BEHAVIOURS, "legacy", plain)
    assert waited_s() == pytest.approx(0.5 + 470 * 0.2)  # 30 came before
    assert slow > 100


@pytest.mark.parametrize(("timeout_s", "event"), [(3, "timed_out"), (4, "decide")])
def test_its_sensing_times_out_by_a_parameter(
    monkeypatch: pytest.MonkeyPatch, timeout_s: int, event: str
) -> None:
    """The timeout counts from the instant at which it informed the human."""
    monkeypatch.setattr(p, "TIMEOUT_TIME_S", (timeout_s, timeout_s))
    run = run_test(TESTS["legacy-released"])
    assert [name for name in ("timed_out", "decide") if instants(run, name)] == [event]


@pytest.mark.parametrize("robot", ["correct", "legacy"])
def test_it_alone_closes_its_gripper_on_a_hand(robot: str) -> None:
    run = run_test(TESTS["hand-in-the-grip"], robot=robot)
    assert bool(instants(run, "grip_closed")) is (robot == "legacy")
