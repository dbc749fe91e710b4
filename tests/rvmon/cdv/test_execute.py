"""Whatever a test does, it has a result, and the others are played."""

import os

import msgspec
import pytest
from tests.rvmon.cdv.conftest import needs_fork

from rvmon import cdv
from rvmon.cdv.campaign_plan import plan
from rvmon.cdv.outcome_counts import summarise
from rvmon.cdv.play import execute
from rvmon.cdv.tables import verdict_table
from rvmon.coverage import Ending
from rvmon.errors import RvmonError
from rvmon.session import load

pytestmark = [pytest.mark.process, needs_fork]

BAD = {
    "kill": (Ending.LOST, "its process was killed by signal SIGKILL"),
    "exit": (Ending.LOST, "its process ended, with exit code 5"),
    "crash": (Ending.CRASHED, "ZeroDivisionError: by zero"),
    "go back": (Ending.CRASHED, "TimeOrderError: sample at -1 ns is not after"),
    "end early": (Ending.CRASHED, "before its last sample"),
}
"""What a test does, how it ends, and what is said; of one that hangs, `test_replay_pages.py`."""

TESTS = [(does.replace(" ", "-"), {"does": does}) for does in BAD]
GOOD = [(f"good-{number}", {"level": float(number)}) for number in range(8)]
MIXED = [*GOOD[:3], *TESTS[:2], *GOOD[3:6], *TESTS[2:], *GOOD[6:]]


def test_bad_tests_have_results_and_the_others_are_played(campaign, spec):
    """A test without a result counts nowhere; the number of processes changes nothing."""
    chosen = plan(campaign(*MIXED))
    results = execute(chosen, jobs=1)
    assert results.played == execute(chosen, jobs=3).played
    assert not results.cut_short
    assert [one.job.test.name for one in results.played] == [name for name, _ in MIXED]
    found = {one.job.test.name: one.outcome for one in results.played}
    for (name, _), (ending, error) in zip(TESTS, BAD.values(), strict=True):
        assert found[name].ending is ending
        assert error in found[name].error
    assert {found[name].ending for name, _ in GOOD} == {Ending.COMPLETED}
    assert found["good-6"].verdicts == {"T1": "F", "T2": "P", "T3": "P"}
    assert set(found["kill"].verdicts.values()) == {"I"}
    table = verdict_table(summarise(results, {"toy": load(spec)}), "toy")
    assert table.groups[0].counts["T3"] == {"P": 9, "F": 0, "NT": 0, "I": 4}
    assert any("kill was lost" in note for note in table.notes)


def test_states_and_transitions_are_hits(campaign):
    (one,) = execute(plan(campaign(GOOD[0])), jobs=1).played
    states, transitions = one.outcome.hits["states"], one.outcome.hits["transitions"]
    assert {name: (hit.count, hit.first) for name, hit in states.items()} == {
        "down": (2, 0),
        "up": (1, 1_000_000_000),
    }
    assert list(transitions) == ["down → up", "up → down"]
    assert one.outcome.figures == {"metres": 2.0}


def test_a_control_is_played_beside_its_test(campaign, spec):
    def lower(test):
        return None if test.level < 5 else msgspec.structs.replace(test, level=0.0)

    control = cdv.Control("lowered", lower)
    results = execute(plan(campaign(GOOD[1], GOOD[6], control=control)), jobs=1)
    assert [one.control is None for one in results.played] == [True, False]
    figures = summarise(results, {"toy": load(spec)}).robots["toy"]
    assert figures.strategies["climbs"].counts["T1"]["F"] == 1
    assert figures.controls["climbs"]["T1"]["F"] == 0


def test_a_system_that_cannot_be_made_is_told(campaign, spec):
    def broken():
        raise OSError("no simulator")

    robots = {"toy": cdv.Robot(broken, spec)}
    with pytest.raises(RvmonError, match=r"robot `toy`: its system cannot be made: OSError"):
        execute(plan(campaign(GOOD[0], robots=robots)), jobs=1)


@pytest.mark.parametrize(
    ("test", "control", "told"),
    [
        (("rusty", {"mutation": "rust"}), None, "no mutation `rust`"),
        (GOOD[0], cdv.Control("less", lambda _: 1 / 0), "`good-0`: its control cannot be made: Z"),
    ],
)
def test_a_test_that_cannot_be_played_is_an_error(campaign, test, control, told):
    """It is a mistake of its author, not a result."""
    with pytest.raises(cdv.TestError, match=told):
        execute(plan(campaign(test, control=control)), jobs=1)


@pytest.mark.parametrize(
    ("run", "told"),
    [
        (lambda: None, "`play` returned None, which is not a Run"),
        (lambda: cdv.Run(1.5), "end_ns must be an int, not 1.5"),
        (lambda: cdv.Run(1, figures={"m": "far"}), "figure `m` must be a number, not 'far'"),
        (lambda: cdv.Run(1, states=["up"]), "a state must be given as (ns, name), not 'up'"),
    ],
)
def test_a_run_that_is_none_is_a_crash(campaign, spec, run, told):
    class Odd:
        def play(self, test, observer):
            return run() if test.name == "odd" else cdv.Run(1)

    chosen = campaign(("odd", {}), ("good", {}), robots={"toy": cdv.Robot(Odd, spec)})
    odd, good = (one.outcome for one in execute(plan(chosen), jobs=1).played)
    assert (odd.ending, good.ending) == (Ending.CRASHED, Ending.COMPLETED)
    assert told in odd.error


def test_output_and_working_directory_of_a_system_are_isolated(campaign, spec, capfd):
    """Its output does not mix with results; the next test starts in the original directory."""
    home = os.getcwd()

    class Wanderer:
        def play(self, test, observer):
            print("I am in", os.getcwd())
            os.chdir("/")
            return cdv.Run(1)

    chosen = campaign(("one", {}), ("two", {}), robots={"toy": cdv.Robot(Wanderer, spec)})
    execute(plan(chosen), jobs=1)
    printed = capfd.readouterr()
    assert (printed.out, printed.err) == ("", f"I am in {home}\n" * 2)
